"""What holds of any study of radiation, what it may be done on, and what it says."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, SceneError
from heliform.engines.core.scene import Body, Material, Mesh, Plane, Scene, Surface, plane_receiver
from heliform.engines.core.unwrap import unwrap
from heliform.engines.sun import gathering
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.gathering import gather, unobstructed
from heliform.engines.sun.hourly import hourly_skies
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.periods import Period
from heliform.engines.sun.radiation import Radiation, study_radiation
from heliform.engines.sun.sensors import on_plane
from heliform.engines.sun.site import Site
from heliform.engines.sun.weights import finer, sources_of
from sun.floors import BOSTON, QUICK, SUMMER, facing, floor, total
from sun.shades import MATTE, box
from sun.weather_files import cloudy, epw_rows, write_epw

# What must always hold


@pytest.fixture(scope="module")
def shaded():
    """A floor under a table, some boxes about it."""
    bodies = [box("Table", (1.5, 1.5, 0.1), (0, 0, 1.2))]
    bodies += [box("Box", (0.7, 0.7, 1.5), (2 * x, 2 * y, 1.05)) for x, y in ((1, 0), (0, -1))]
    return Scene(tuple(bodies), (), (floor(12, 4.0),))


def test_heating_and_cooling_make_up_the_year(shaded):
    of = {
        span: study_radiation(shaded, replace(QUICK, period=Period(span=span), accuracy=0.0))
        for span in ("year", "heating season", "cooling season")
    }
    for name in ("sun_hours", "direct", "diffuse", "total", "open"):
        parts = total(of["heating season"], name) + total(of["cooling season"], name)
        assert parts == pytest.approx(total(of["year"], name), rel=2e-5)


def test_twice_the_light_gives_twice_as_much(shaded):
    sensors = on_plane(np.eye(4), 3, 3, 0.5)
    sources = sources_of(clear_weather(BOSTON), BOSTON, SUMMER)
    more = replace(sources, direct=2 * sources.direct, diffuse=3 * sources.diffuse)
    occluders = Occluders(shaded.bodies)
    once, twice = (gather(occluders, sensors, s) for s in (sources, more))
    assert twice.direct == pytest.approx(2 * once.direct)
    assert twice.diffuse == pytest.approx(3 * once.diffuse)


def test_a_model_that_is_turned_with_its_site_has_the_same_maps(shaded):
    """The model's +Y to the east: what stood south of the floor stands where −X was."""
    turned = replace(BOSTON, north=90.0)
    quarter = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    bodies = tuple(replace(b, mesh=b.mesh.moved(quarter)) for b in shaded.bodies)
    there = study_radiation(Scene(bodies, (), shaded.receivers), replace(QUICK, site=turned))
    here = study_radiation(shaded, QUICK)
    assert total(there) == pytest.approx(np.rot90(total(here), -1), rel=1e-3)


@pytest.fixture(scope="module")
def true(shaded):
    """As `QUICK` has it, but with every sun."""
    return study_radiation(shaded, replace(QUICK, accuracy=0.0))


@pytest.mark.parametrize(
    ("accuracy", "error", "hourly"), [(0.5, 0.004, 0.008), (1.0, 0.008, 0.012), (3.0, 0.02, 0.025)]
)
def test_merged_suns_are_near_to_the_true_ones(shaded, true, accuracy, error, hourly):
    """Root mean square of the map and mean of the hours, of the direct irradiation's mean."""
    merged = study_radiation(shaded, replace(QUICK, accuracy=accuracy))
    off = total(merged, "direct") - total(true, "direct")
    assert np.sqrt((off**2).mean()) < error * total(true, "direct").mean()
    off = np.abs(merged.hourly["direct"] - true.hourly["direct"])
    assert off.mean() < hourly * true.hourly["direct"].mean()
    assert any("suns are merged" in note for note in merged.meta["notes"])
    assert merged.meta["accuracy"] <= accuracy


def test_the_hours_make_up_the_maps(shaded):
    result = study_radiation(shaded, QUICK)
    for name in ("direct", "diffuse", "open"):
        sums = result.hourly[name].sum() / 1000
        assert sums == pytest.approx(result.maps[0].mean(name), rel=2e-4)


def test_a_weathers_hours_may_be_cut_finer():
    weather = cloudy()
    fine = finer(weather, 4)
    assert len(fine.times) == 4 * 8760
    assert (np.diff(fine.times) == np.timedelta64(15, "m")).all()
    for name in ("direct_normal", "diffuse_horizontal", "global_horizontal"):
        energy = getattr(fine, name) @ fine.hours
        assert energy == pytest.approx(getattr(weather, name) @ weather.hours, rel=1e-12)
    skies = [hourly_skies(w, BOSTON) for w in (weather, fine)]
    beam = [sky.direct @ sky.hours for sky in skies]
    assert beam[0] < 0.9995 * weather.direct_normal.sum() < beam[1]


def test_any_number_of_sensors_is_summed_in_parts(shaded, monkeypatch):
    whole = study_radiation(shaded, Radiation(period=SUMMER))
    monkeypatch.setattr(gathering, "_RAYS", 20_000)
    parts = study_radiation(shaded, Radiation(period=SUMMER))
    for name, values in whole.maps[0].maps.items():
        assert parts.maps[0].maps[name] == pytest.approx(values, rel=1e-5)
    assert parts.meta["notes"] == whole.meta["notes"]
    assert parts.hourly["direct"] == pytest.approx(whole.hourly["direct"], rel=1e-5)


@pytest.mark.parametrize("latitude", [90.0, -90.0, 70.0])
def test_sites_far_up_have_a_sun_that_stays(latitude):
    site = replace(BOSTON, latitude=latitude)
    light = study_radiation(Scene(receivers=(floor(1),)), Radiation(site=site, period=SUMMER))
    dark = Radiation(site=site, period=Period(span="winter solstice"))
    night = study_radiation(Scene(receivers=(floor(1),)), dark)
    assert total(light, "sun_hours")[0, 0] == 24
    assert total(night, "sun_hours")[0, 0] == 0
    assert total(night)[0, 0] < 1e-3
    assert 5 < total(light)[0, 0] < 15


# Receivers


def cube(resolution=48, sides="front"):
    mesh = box("Cube", (1, 1, 1), (0, 0, 0.5)).mesh.triangles()
    return Surface("Cube", mesh, unwrap(mesh, resolution), resolution, resolution, sides)


def test_a_mesh_is_a_receiver_by_its_unwrapped_map():
    result = study_radiation(Scene(receivers=(cube(),)), replace(QUICK, ground_reflectance=0.0))
    (one,) = result.maps
    weather = clear_weather(BOSTON)
    sources = sources_of(weather, BOSTON, Period(), subdivision=1, ground_reflectance=0)
    sides = [(0, 0), (90, 0), (90, 90), (90, 180), (90, 270), (180, 0)]
    truth = sum(unobstructed(facing(*side), sources).irradiation[0] for side in sides)
    assert one.area.sum() == pytest.approx(6, rel=1e-6)
    assert one.integral("total") == pytest.approx(truth, rel=0.01)
    assert np.isnan(one.maps["total"][one.area == 0]).all()


def test_both_sides_of_a_receiver_gather():
    pose = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
    plane = Plane(width=1, length=1, resolution=2, sides="both")
    wall = plane_receiver("Wall", plane, pose)  # its front looks to −Y
    (one,) = study_radiation(Scene(receivers=(wall,)), QUICK).maps
    assert one.maps["total"].shape == (2, 2, 2)
    front, back = (v["direct"].mean() for _, v in one.sides())
    assert front > 10 * back > 0
    assert [side for side, _ in one.sides()] == ["front", "back"]


def test_faces_without_area_leave_no_sensor():
    mesh = Mesh(
        np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 0, 0.0]]),
        np.array([[0, 1, 2], [0, 1, 3]], np.int32),
    )
    sheet = Surface("Sheet", mesh, unwrap(mesh, 8), 8, 8)
    (one,) = study_radiation(Scene(receivers=(sheet,)), Radiation(period=SUMMER)).maps
    assert one.area.sum() == pytest.approx(0.5)
    assert np.isfinite(one.maps["total"][one.area > 0]).all()
    texture = np.zeros((1, 3, 2))
    nothing = Surface("Line", Mesh(mesh.vertices, mesh.faces[1:]), texture, 8, 8)
    with pytest.raises(SceneError, match="“Line” has no area"):
        study_radiation(Scene(receivers=(nothing,)), Radiation(period=SUMMER))


def test_a_pane_keeps_some_of_the_light_and_none_of_the_hours():
    glass = box("Pane", (50, 50, 0.01), (0, 0, 1), Material(kind="dielectric", ior=1.5))
    scene = Scene((glass,), (), (floor(1),))
    record = Radiation(period=SUMMER)
    under, bare = (study_radiation(s, record) for s in (scene, replace(scene, bodies=())))
    assert total(under, "sun_hours") == pytest.approx(total(bare, "sun_hours"))
    assert 0.85 < (total(under) / total(bare)).item() < 0.92
    assert any("straight through clear glass" in note for note in under.meta["notes"])


# What is said


def test_notes_say_what_to_beware_of(tmp_path):
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    down[2, 3] = 3.0
    plane = Plane(width=1, length=1, resolution=2)
    inside = floor(2, 0.2)
    scene = Scene(
        (box("Block", (1, 1, 1), (0, 0, 0)),), (), (inside, plane_receiver("Lid", plane, down))
    )
    notes = " ".join(study_radiation(scene, QUICK).meta["notes"])
    assert "No weather file is given" in notes
    assert "“Lid” looks down" in notes
    assert "4 of 8 sensors lie inside “Block”" in notes
    assert "returns 20 % of the light" in notes


def test_a_weather_file_brings_its_place_and_its_gaps(tmp_path):
    turin = Site(latitude=45.0, longitude=8.0, elevation=250.0, utc_offset=1.0)
    rows = epw_rows(cloudy(turin))
    rows[4000][13:16] = ["9999"] * 3
    file = write_epw(tmp_path / "turin.epw", cloudy(turin), rows)
    record = replace(QUICK, weather_file=str(file), site=replace(BOSTON, north=30.0))
    result = study_radiation(Scene(receivers=(floor(1),)), record)
    assert result.meta["site"]["latitude"] == 45.0
    assert result.meta["site"]["north"] == 30.0
    notes = " ".join(result.meta["notes"])
    assert "that of 45.00° N, 8.00° E" in notes
    assert "interval" in notes
    assert total(result)[0, 0] == pytest.approx(
        cloudy(turin).global_horizontal.sum() / 1000, rel=5e-3
    )


def test_a_place_in_the_southwest_is_named_so(tmp_path):
    rio = Site(latitude=-22.9, longitude=-43.2, utc_offset=-3.0)
    file = write_epw(tmp_path / "rio.epw", cloudy(rio))
    record = replace(QUICK, weather_file=str(file))
    notes = study_radiation(Scene(receivers=(floor(1),)), record).meta["notes"]
    assert any("that of 22.90° S, 43.20° W;" in note for note in notes)


def test_a_period_in_another_place_or_at_night_speaks_of_itself():
    scene = Scene(receivers=(floor(1),))
    summer = Period(span="cooling season")
    record = replace(QUICK, site=replace(BOSTON, latitude=60.2), period=summer)
    assert any("Boston's dates" in n for n in study_radiation(scene, record).meta["notes"])
    night = Period(span="winter solstice", first_hour=22.0, last_hour=2.0)
    dark = study_radiation(scene, replace(QUICK, period=night))
    assert any("never above the horizon" in note for note in dark.meta["notes"])
    assert not any("left out" in note for note in dark.meta["notes"])
    assert total(dark) == pytest.approx(0)


def test_cleaner_air_lets_more_sun_through():
    scene = Scene(receivers=(floor(1),))
    clean, dull = (
        study_radiation(scene, replace(QUICK, site=replace(BOSTON, turbidity=value)))
        for value in (2.0, 6.0)
    )
    assert total(dull)[0, 0] < 0.9 * total(clean)[0, 0]
    assert clean.meta["source"].endswith("turbidity 2")
    assert clean.meta["site"]["turbidity"] == 2.0


def test_what_cannot_be_studied_is_said():
    with pytest.raises(SceneError, match="add a receiver"):
        study_radiation(Scene(), Radiation())
    with pytest.raises(FileError):
        study_radiation(Scene(receivers=(floor(),)), Radiation(weather_file="nowhere.epw"))
    bad = Body("Bad", Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32)), MATTE)
    with pytest.raises(SceneError, match="“Bad” has no faces"):
        study_radiation(Scene((bad,), (), (floor(),)), Radiation())


MANY = """
import resource, sys
import numpy as np
from heliform.engines.core.scene import Body, Material, Mesh, Plane, Scene, plane_receiver
from heliform.engines.sun import Radiation, study_radiation
corners = np.array([[0.0, 0, 3], [3, 0, 3], [3, 3, 3], [0, 3, 3]])
roof = Body("Roof", Mesh(corners, np.array([[0, 1, 2, 3]], np.int32)), Material(kind="diffuse"))
plane = plane_receiver("Floor", Plane(width=20, length=20, resolution=int(sys.argv[1])), np.eye(4))
result = study_radiation(Scene((roof,), (), (plane,)), Radiation(accuracy=0.0))
kilobytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(result.meta["directions"], kilobytes / (1 << 20 if sys.platform == "darwin" else 1 << 10))
"""


@pytest.mark.slow
@pytest.mark.parametrize("side", [316, 1000])
def test_a_million_sensors_take_no_more_memory_than_fits(side):
    """Bits alone for all of 10⁶ sensors and 6,878 directions would take 860 MB."""
    pytest.importorskip("resource")
    done = subprocess.run(
        [sys.executable, "-c", MANY, str(side)], capture_output=True, text=True, check=True
    )
    directions, megabytes = map(float, done.stdout.split())
    assert directions == 4428 + 2305 + 145
    assert megabytes < 700
