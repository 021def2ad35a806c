"""Each receiver of a study of daylight is a place by itself, with figures of its front."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from heliform.engines.core.scene import Material, Receiver, Scene
from heliform.engines.sun.daylight import Daylight, WorkingHours, illuminance_at, study_daylight
from heliform.engines.sun.rooms import rooms_of, told_of
from heliform.engines.sun.sensors import of_receiver
from sun.rooms import matte
from sun.shades import box
from sun.weather_files import cloudy, epw_rows, write_epw

YEAR = Daylight(subdivision=1, accuracy=8.0, error=0.1, paths=2048, period=WorkingHours())
NOON = dataclasses.replace(YEAR, period=WorkingHours(span="months", first_month=6, last_month=6))
STANDARDS = ("sda", "ase", "en17037", "blinds")


def plane(name="desk", size=3.0, at=(0.0, 0.0, 0.8), count=4, **more):
    corner = np.array(at, float) - [size / 2, size / 2, 0.0]
    edges = np.array([size, 0, 0]), np.array([0, size, 0])
    return Receiver(name, corner, *edges, count, count, **more)


def room(floor=True, glazed=True, sill=0.0, inner=()):
    """A room of 4 × 4 × 3 m whose south side is glass above the sill, or open."""
    size, height, t = 4.0, 3.0, 0.2
    s = size / 2
    bodies = [
        box("ceiling", [size + 2 * t, size + 2 * t, t], [0, 0, height + t / 2], matte(0.8)),
        box("west", [t, size, height], [-s - t / 2, 0, height / 2], matte(0.5)),
        box("east", [t, size, height], [s + t / 2, 0, height / 2], matte(0.5)),
        box("north", [size + 2 * t, t, height], [0, s + t / 2, height / 2], matte(0.5)),
        *inner,
    ]
    if floor:
        bodies.append(box("floor", [size + 2 * t, size + 2 * t, t], [0, 0, -t / 2], matte(0.2)))
    if sill:
        bodies.append(box("sill", [size, t, sill], [0, -s - t / 2, sill / 2], matte(0.5)))
    if glazed:
        glass = Material(kind="dielectric", ior=1.52)
        pane = [size, 0.006, height - sill]
        bodies.append(box("pane", pane, [0, -s - t / 2, (height + sill) / 2], glass))
    return tuple(bodies)


def study(bodies, *receivers, record=YEAR, **changes):
    scene = Scene(tuple(bodies), (), receivers)
    return study_daylight(scene, dataclasses.replace(record, **changes), seed=1)


def of_standards(figures, prefix=""):
    own = {n.removeprefix(prefix): f["value"] for n, f in figures.items() if n.startswith(prefix)}
    return {name: value for name, value in own.items() if name.startswith(STANDARDS)}


def test_notes_name_their_receiver_once():
    tower = box("tower", [2, 2, 2], [0, 0, 0.8], matte(0.5))
    scene = Scene((tower,), (), (plane("desk"), plane("bench", 1.0, (9, 0, 0.8))))
    first, second = map(of_receiver, scene.receivers)
    flat = "“desk”: 1 face has no area and no sensor."
    parts = (dataclasses.replace(first, notes=(flat,)), second)
    buried = "1 of 16 sensors lie inside “tower” and see nothing."
    years = (SimpleNamespace(notes=(buried,)), SimpleNamespace(notes=()))
    said = list(told_of(scene, rooms_of(scene, parts, YEAR), years))
    assert said == [flat, f"“desk”: {buried}"]


def test_a_place_in_the_dark_takes_nothing_from_one_in_the_light():
    block = box("block", [2, 2, 1], [10, 0, 0.8], matte(0.5))
    found = study((block,), plane("bright"), plane("dark", 1.0, (10, 0, 0.8)))
    bright, dark = (of_standards(found.figures(), f"{name}.") for name in ("bright", "dark"))
    assert bright["sda_300_50_without_blinds"] == bright["ase_1000_250"] == 100
    assert dark["sda_300_50_without_blinds"] == dark["ase_1000_250"] == 0
    assert not of_standards(found.figures())
    assert any("“dark”: 16 of 16 sensors lie inside “block”" in n for n in found.meta["notes"])
    assert any("mean illuminance on “bright”" in n for n in found.meta["notes"])


def test_the_back_of_a_receiver_is_no_floor():
    front, both = (
        of_standards(study((), plane(sides=sides)).figures()) for sides in ("front", "both")
    )
    assert front == both
    assert both["ase_1000_250"] == 100


@pytest.mark.parametrize("sides", ["front", "both"])
def test_a_roof_outdoors_moves_no_blinds_in_the_room(sides):
    desk, roof = plane(sides=sides), plane("roof", 4.0, (0, 0, 3.5))
    alone = of_standards(study(room(), desk, blinds=True).figures())
    found = study(room(), desk, roof, blinds=True)
    beside, above = (of_standards(found.figures(), f"{r.name}.") for r in (desk, roof))
    assert beside["blinds_closed"] == alone["blinds_closed"] > 500
    assert beside["ase_1000_250"] == alone["ase_1000_250"]
    assert beside["en17037_level"] == alone["en17037_level"]
    assert above["blinds_closed"] == 0
    assert above["sda_300_50"] == 100
    # The mean of both by area: 9 m² of desk, twice where both sides gather, and 16 m² of roof.
    means = [one.mean("illuminance") for one in found.maps]
    weights = [18.0 if sides == "both" else 9.0, 16.0]
    counted = found.hourly["illuminance"]
    assert counted.mean() == pytest.approx(np.average(means, weights=weights), rel=1e-4)


def test_a_picked_sensor_has_the_blinds_of_its_own_receiver():
    desk, roof = plane(), plane("roof", 4.0, (0, 0, 3.5))
    scene = Scene(room(), (), (roof, desk))
    record = dataclasses.replace(NOON, blinds=True)
    maps = study_daylight(scene, record).maps
    for one, receiver in zip(maps, scene.receivers, strict=True):
        sensor = of_receiver(receiver).some(np.array([5]))
        _, light = illuminance_at(scene, record, sensor)
        assert light.mean() == pytest.approx(one.maps["illuminance"].ravel()[5], rel=0.1)


def test_a_month_of_weather_has_no_figures_of_a_year(tmp_path):
    weather = cloudy()
    rows = [row for row in epw_rows(weather) if int(row[1]) == 12]
    file = write_epw(tmp_path / "december.epw", weather, rows, period="12/ 1,12/31")
    found = study(room(), plane(), weather_file=str(file))
    assert not of_standards(found.figures())
    said = [note for note in found.meta["notes"] if "left out" in note]
    assert any("The weather is of 31 days" in note for note in said)


@pytest.mark.parametrize(("floor", "reflectance", "ground", "said"), [
    (False, 0.0, 0.2, True),
    (True, 0.0, 0.2, False),
    (False, 0.2, 0.2, False),
    (False, 0.0, 0.0, False),
])  # fmt: skip
def test_ground_that_shines_through_a_work_plane_is_said(floor, reflectance, ground, said):
    desk = plane(reflectance=reflectance)
    found = study(room(floor), desk, record=NOON, ground_reflectance=ground)
    notes = [note for note in found.meta["notes"] if "No floor lies below" in note]
    assert len(notes) == said
    if said:
        assert notes[0].startswith("No floor lies below “desk”: ")


def test_the_share_of_a_plane_without_a_floor_is_told_and_the_open_field_is_none():
    slab = box("slab", [2.0, 4.0, 0.1], [-1.0, 0, -0.05], matte(0.2))
    found = study((*room(floor=False), slab), plane(), record=NOON)
    assert any("No floor lies below 50 % of “desk”" in note for note in found.meta["notes"])
    assert not any("No floor" in n for n in study((), plane(), record=NOON).meta["notes"])


def test_one_plane_measures_and_two_measure():
    one = study((), plane(), record=NOON).meta["notes"]
    two = study((), plane(), plane("shelf"), record=NOON).meta["notes"]
    assert any(note.startswith("“desk” only measures and blocks no light") for note in one)
    assert any(note.startswith("“desk”, “shelf” only measure and block no light") for note in two)


def test_a_room_without_a_pane_has_no_point_for_sunlight_and_says_so():
    found = study(room(glazed=False), plane())
    assert "en17037_level" in found.figures()
    assert "en17037_sunlight_hours" not in found.figures()
    assert any("No pane gives on to “desk”" in note for note in found.meta["notes"])


def test_a_period_of_one_hour_is_a_point_in_time():
    noon = WorkingHours(
        span="dates", first_month=6, first_day=21, last_month=6, last_day=21,
        first_hour=12.0, last_hour=13.0,
    )  # fmt: skip
    found = study((), plane(), period=noon)
    assert len(found.times) == 1
    assert found.maps[0].mean("illuminance") == pytest.approx(found.hourly["illuminance"][0])
    assert 8e4 < found.hourly["illuminance"][0] < 1.3e5


def test_no_light_but_the_ground_s_comes_into_a_closed_room_without_a_floor():
    closed = room(floor=False, glazed=False, inner=[box("south", [4.4, 0.2, 3], [0, -2.1, 1.5])])
    found = study(closed, plane(), record=NOON)
    assert found.maps[0].mean("daylight_factor") > 1
    assert any("No floor lies below “desk”" in note for note in found.meta["notes"])
    slab = box("slab", [4.4, 4.4, 0.1], [0, 0, -0.05], matte(0.2))
    assert study((*closed, slab), plane(), record=NOON).maps[0].mean("illuminance") < 1
