"""The sun's path as lines to be drawn."""

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.sun.path import sun_path
from heliform.engines.sun.position import direction_of, sun_times
from heliform.engines.sun.site import Site

BOSTON = Site()


def altitudes(points: np.ndarray) -> np.ndarray:
    return np.degrees(np.arcsin(points[:, 2]))


def line(site: Site, label: str) -> np.ndarray:
    (found,) = (line.points for line in sun_path(site) if line.label == label)
    return found


def test_lines_are_on_the_unit_dome_above_the_horizon():
    for site in (BOSTON, Site(latitude=-75.0), Site(latitude=90.0), Site(latitude=0.0)):
        for path in sun_path(site):
            assert len(path.points) > 1
            assert np.linalg.norm(path.points, axis=1) == pytest.approx(1)
            assert path.points[:, 2].min() >= 0


def test_boston_has_an_arc_a_month_and_a_loop_an_hour_of_light():
    path = sun_path(BOSTON)
    days = [line.label for line in path if line.kind == "day"]
    assert len(days) == 12
    assert {"20 March", "21 June", "23 September", "21 December", "21 August"} <= set(days)
    assert [line.label for line in path if line.kind == "hour"] == [f"{h} h" for h in range(5, 20)]


def test_the_solstices_arcs_culminate_at_the_tropics():
    for label, declination in (("21 June", 23.43), ("21 December", -23.43), ("20 March", 0.0)):
        top = altitudes(line(BOSTON, label)).max()
        assert top == pytest.approx(90 - 42.3603 + declination, abs=0.15)


def test_an_arc_runs_from_sunrise_to_sunset():
    arc = line(BOSTON, "21 June")
    assert arc[[0, -1], 2] == pytest.approx(0, abs=1e-12)
    assert arc[0, 0] > 0 > arc[-1, 0]
    azimuth = np.degrees(np.arctan2(arc[0, 0], arc[0, 1]))
    assert azimuth == pytest.approx(57.0, abs=0.6)
    hours = 10 / 60 * (len(arc) - 2)
    day = sun_times(np.array(["2019-06-21"], "datetime64[D]"), BOSTON).day_length[0]
    assert hours == pytest.approx(day, abs=0.4)


def test_a_noon_loop_is_an_analemma():
    """A figure of eight about the meridian, twice the obliquity high."""
    loop = line(Site(longitude=-75.0), "12 h")
    assert loop[0] == pytest.approx(loop[-1], abs=2e-3)
    assert np.ptp(altitudes(loop)) == pytest.approx(2 * 23.43, abs=0.1)
    ahead = 4 * np.degrees(np.arcsin(-loop[:, 0]))  # minutes, times the cosine of declination
    assert ahead.min() == pytest.approx(-14.2 * np.cos(np.radians(14.5)), abs=0.1)
    assert ahead.max() == pytest.approx(16.4 * np.cos(np.radians(15.0)), abs=0.1)


def test_where_the_sun_does_not_set_an_arc_goes_round():
    path = {line.label: line.points for line in sun_path(Site(latitude=80.0, longitude=0.0))}
    assert "21 December" not in path
    june = path["21 June"]
    turns = np.unwrap(np.arctan2(june[:, 0], june[:, 1]))
    assert abs(turns[-1] - turns[0]) == pytest.approx(2 * np.pi, abs=0.01)


def test_the_path_turns_with_the_model():
    here, turned = (line(Site(north=north), "21 June") for north in (0.0, 50.0))
    top = here[here[:, 2].argmax()]
    azimuth = np.degrees(np.arctan2(*top[:2]))
    expected = direction_of(azimuth - 50.0, np.degrees(np.arcsin(top[2])))
    assert turned[here[:, 2].argmax()] == pytest.approx(expected, abs=1e-9)


def test_a_site_off_the_earth_has_no_path():
    with pytest.raises(ParameterError, match="latitude"):
        sun_path(Site(latitude=-90.5))
