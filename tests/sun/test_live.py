"""A sun study that follows a model: the same as afresh, whatever moves."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Plane, Scene, plane_receiver
from heliform.engines.sun import live as live_module
from heliform.engines.sun import rays
from heliform.engines.sun.live import LiveSun
from heliform.engines.sun.periods import Period
from heliform.engines.sun.radiation import Radiation, study_radiation
from sun.shades import box

RECORD = Radiation(subdivision=1, accuracy=3.0, period=Period(span="cooling season"))
FLOOR = plane_receiver("Floor", Plane(width=4, length=4, resolution=8), np.eye(4))
TOWER = box("Tower", (1, 1, 6), (3, -3, 3))


def scene(height, *receivers):
    return Scene((TOWER, box("Roof", (2, 2, 0.2), (0, 0.3, height))), (), receivers or (FLOOR,))


def same(live, fresh):
    for one, other in zip(live.maps, fresh.maps, strict=True):
        assert list(one.maps) == list(other.maps)
        for name, values in one.maps.items():
            assert values == pytest.approx(other.maps[name], rel=1e-5, nan_ok=True)


def test_what_is_live_is_what_is_computed_afresh():
    live = LiveSun(moving=("Roof",))
    for height in (1.0, 1.4, 2.5):
        result = live.radiation(scene(height), RECORD)
        same(result, study_radiation(scene(height), RECORD))
        assert not result.hourly
        assert not len(result.times)
    other = replace(RECORD, period=Period(span="winter solstice"), accuracy=0.0)
    same(live.radiation(scene(2.5), other), study_radiation(scene(2.5), other))


def test_receivers_may_move_and_come_and_go():
    live = LiveSun()
    pose = np.eye(4)
    pose[:3, 3] = (0.2, 0.1, 0.5)
    moved = plane_receiver("Floor", Plane(width=3, length=4, resolution=6), pose)
    second = replace(moved, name="Table", origin=moved.origin + np.array([0, 0, 5.0]))
    for receivers in ((FLOOR,), (moved,), (moved, second), (second,), (FLOOR, FLOOR)):
        given = scene(1.2, *receivers)
        same(live.radiation(given, RECORD), study_radiation(given, RECORD))


def test_the_hours_are_there_where_they_are_asked_for():
    result = LiveSun().radiation(scene(1.2), RECORD, hourly=True)
    fresh = study_radiation(scene(1.2), RECORD)
    assert (result.times == fresh.times).all()
    for name, values in fresh.hourly.items():
        assert result.hourly[name] == pytest.approx(values, rel=1e-5, abs=1e-6)


def test_only_what_moves_is_traced_again(monkeypatch):
    live = LiveSun(moving=("Roof",))
    live.radiation(scene(1.0), RECORD)
    lit, sent = [], []
    light_of, unblocked = live_module.light_of, rays.unblocked
    monkeypatch.setattr(live_module, "light_of", lambda r: lit.append(r) or light_of(r))

    def noted(soup, *rest, **named):
        sent.extend(body.name for body in soup.bodies)
        return unblocked(soup, *rest, **named)

    monkeypatch.setattr(rays, "unblocked", noted)
    live.radiation(scene(1.1), RECORD)
    assert sent == ["Roof"]
    assert not lit
    live.radiation(scene(1.1), replace(RECORD, open=False))
    assert len(lit) == 1


def test_more_sensors_than_can_be_kept_are_summed_all_the_same(monkeypatch):
    kept = LiveSun().radiation(scene(1.0), RECORD)
    monkeypatch.setattr("heliform.engines.sun.visibility.MOST_BYTES", 1000)
    monkeypatch.setattr("heliform.engines.sun.gathering._RAYS", 4000)
    same(LiveSun().radiation(scene(1.0), RECORD), kept)


def test_a_scene_without_receivers_is_said():
    with pytest.raises(SceneError, match="add a receiver"):
        LiveSun().radiation(Scene((TOWER,)), RECORD)
