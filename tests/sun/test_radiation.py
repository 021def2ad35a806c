"""Sun hours and irradiation against closed forms, pvlib, and what must always hold."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pvlib
import pytest
from heliform.engines.core.errors import FileError, SceneError
from heliform.engines.core.scene import (
    Body,
    Material,
    Mesh,
    Plane,
    Scene,
    Surface,
    plane_receiver,
)
from heliform.engines.core.unwrap import unwrap
from heliform.engines.sun import gathering
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.gathering import gather, unobstructed
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.periods import Period
from heliform.engines.sun.radiation import Radiation, study_radiation
from heliform.engines.sun.sensors import at_points, on_plane
from heliform.engines.sun.site import Site
from heliform.engines.sun.weights import finer, sources_of, weather_of
from sun.shades import MATTE, box, level, sheet
from sun.weather_files import cloudy, epw_rows, write_epw

BOSTON = Site()
EQUATOR = Site(latitude=0.0, longitude=0.0, elevation=0.0, utc_offset=0.0)
SUMMER = Period(span="summer solstice")
EQUINOX = Period(span="spring equinox")
RNG = np.random.default_rng(5)


def floor(resolution=4, size=1.0, at=(0, 0, 0), **named):
    pose = np.eye(4)
    pose[:3, 3] = at
    return plane_receiver(
        "Floor", Plane(width=size, length=size, resolution=resolution, **named), pose
    )


def facing(tilt, azimuth):
    """A sensor that looks ``tilt`` off the zenith towards ``azimuth``, in degrees."""
    lean, turn = np.radians([tilt, azimuth])
    normal = [np.sin(lean) * np.sin(turn), np.sin(lean) * np.cos(turn), np.cos(lean)]
    return at_points([[0, 0, 0]], [normal], offset=1e-6)


def total(result, name="total", receiver=0):
    return result.maps[receiver].maps[name].astype(float)


@pytest.fixture(scope="module", params=["clear", "cloudy"])
def weather(request):
    return clear_weather(BOSTON) if request.param == "clear" else cloudy()


# In an open field


def test_an_open_floor_has_the_weathers_global_irradiation(weather):
    got = unobstructed(facing(0, 0), sources_of(weather, BOSTON, Period())).irradiation
    assert got[0] == pytest.approx(weather.global_horizontal.sum() / 1000, rel=3e-3)


@pytest.mark.parametrize(("tilt", "azimuth"), [(30, 180), (90, 180), (90, 90), (90, 0), (60, 250)])
def test_tilted_planes_have_what_perezs_model_of_them_says(weather, tilt, azimuth):
    """pvlib's Perez 1990 sums three parts of the sky; here it is Perez 1993's sky in patches."""
    times = pd.DatetimeIndex(weather.times).tz_localize("UTC")
    sun = pvlib.solarposition.get_solarposition(times, BOSTON.latitude, BOSTON.longitude, 10)
    theirs = pvlib.irradiance.get_total_irradiance(
        *(tilt, azimuth, sun.apparent_zenith, sun.azimuth),
        *(weather.direct_normal, weather.global_horizontal, weather.diffuse_horizontal),
        dni_extra=pvlib.irradiance.get_extra_radiation(times),
        airmass=pvlib.atmosphere.get_relative_airmass(sun.apparent_zenith),
        albedo=0.2,
        model="perez",
    ).fillna(0)
    sources = sources_of(weather, BOSTON, Period())
    got = unobstructed(facing(tilt, azimuth), sources).irradiation
    assert got[0] == pytest.approx(theirs.poa_global.sum() / 1000, rel=0.025)
    true = sources_of(weather, BOSTON, Period(), accuracy=0)
    beam = replace(true, diffuse=0 * true.diffuse)
    direct = unobstructed(facing(tilt, azimuth), beam).irradiation
    assert direct[0] == pytest.approx(theirs.poa_direct.sum() / 1000, rel=5e-3, abs=0.2)


def test_the_ground_lights_what_looks_down_and_half_of_what_stands():
    weather = clear_weather(BOSTON)
    given = {rho: sources_of(weather, BOSTON, Period(), ground_reflectance=rho) for rho in (0, 0.3)}

    def got(sensor, rho):
        return unobstructed(sensor, given[rho]).irradiation[0]

    ceiling, wall = facing(180, 0), facing(90, 130)
    level = got(facing(0, 0), 0)
    assert got(ceiling, 0) == 0
    assert got(ceiling, 0.3) == pytest.approx(0.3 * level, rel=2e-3)
    assert got(wall, 0.3) - got(wall, 0) == pytest.approx(0.15 * level, rel=0.01)


def test_without_bodies_nothing_is_shaded():
    result = study_radiation(Scene(receivers=(floor(),)), Radiation())
    assert total(result, "open") == pytest.approx(total(result), rel=1e-5)
    assert total(result, "shading") == pytest.approx(0, abs=1e-5)
    hours = np.count_nonzero(sources_of(*weather_of(BOSTON, ""), Period()).hourly.sun[:, 2] > 0)
    assert total(result, "sun_hours") == pytest.approx(hours)
    ghi = clear_weather(BOSTON).global_horizontal / 1000
    hourly = (result.hourly["direct"] + result.hourly["diffuse"]) / 1000
    assert hourly.sum() == pytest.approx(total(result).mean(), rel=1e-4)
    assert np.abs(hourly - ghi).max() < 0.02  # hours of sunrise; sines of the middle elsewhere


# Closed forms


@pytest.mark.parametrize("away", [0.7, 2.0, 5.0])
def test_sun_hours_beside_a_long_wall(away):
    """At the equator, at the equinox, the sun goes from east to west over the zenith."""
    wall = sheet("Wall", [[0, -3e3, 0], [0, 3e3, 0], [0, 3e3, 2], [0, -3e3, 2]])
    record = Radiation(site=EQUATOR, period=EQUINOX, accuracy=0.0, suns_per_hour=12)
    result = study_radiation(Scene((wall,), (), (floor(1, 1e-3, (-away, 0, 0)),)), record)
    truth = 12.12 - np.degrees(np.arctan2(2, away)) / 15  # day and refraction at both horizons
    assert total(result, "sun_hours")[0, 0] == pytest.approx(truth, abs=1.2 / 12)


def test_sun_hours_under_an_overhang():
    """A wall that looks south sees the sun below the edge: tan of its profile angle < depth⁻¹."""
    overhang = sheet("Shade", [[-99, 0, 1], [99, 0, 1], [99, -0.8, 1], [-99, -0.8, 1]])
    sources = sources_of(clear_weather(BOSTON), BOSTON, Period(), accuracy=0)
    _, y, z = sources.directions[: len(sources.suns.directions)].T
    truth = np.count_nonzero((y < 0) & (z * 0.8 < -y))
    found = gather(Occluders([overhang]), facing(90, 180), sources)
    assert found.hours[0] == pytest.approx(truth, abs=2)


def uniform(sources):
    """The same directions, with a sky of radiance 1/π and nothing else."""
    suns, ground = len(sources.suns.directions), len(sources.ground)
    even = np.concatenate([np.zeros(suns), sources.patches.solid_angles / np.pi, np.zeros(ground)])
    return replace(sources, direct=0 * even, diffuse=even)


@pytest.fixture(scope="module")
def even_sky():
    weather = clear_weather(BOSTON)
    return uniform(sources_of(weather, BOSTON, EQUINOX, subdivision=4, accuracy=3))


def test_an_even_sky_beside_a_long_wall(even_sky):
    wall = sheet("Wall", [[0, -4e3, 0], [0, 4e3, 0], [0, 4e3, 4], [0, -4e3, 4]])
    away = np.array([1.0, 4.0, 12.0])
    sensors = at_points(away[:, None] * [1, 0, 0], np.tile([0, 0, 1.0], (3, 1)))
    found = gather(Occluders([wall]), sensors, even_sky)
    truth = (1 + np.cos(np.arctan2(4, away))) / 2
    assert found.diffuse == pytest.approx(truth, abs=4e-3)


def test_an_even_sky_under_an_overhang(even_sky):
    """Half of the cosine of the angle at which the overhang ends, off the horizon."""
    overhang = sheet("Shade", [[-4e3, 0, 1], [4e3, 0, 1], [4e3, -2, 1], [-4e3, -2, 1]])
    found = gather(Occluders([overhang]), facing(90, 180), even_sky)
    assert found.diffuse[0] == pytest.approx(np.sin(np.arctan2(1, 2)) / 2, abs=5e-3)


def test_a_box_with_one_opening_sees_what_its_configuration_factor_says(even_sky):
    """Under the middle of a square opening [Howell, configuration factor B-3]."""
    half, height = 1.0, 1.5
    lids = ((-5, -5, 5, -1), (-5, 1, 5, 5), (-5, -1, -1, 1), (1, -1, 5, 1))
    room = [
        box("Room", (10, 10, 0.1), (0, 0, -0.06)),
        *(box("Wall", (0.1, 10, height), (5 * side, 0, height / 2)) for side in (-1, 1)),
        *(box("Wall", (10, 0.1, height), (0, 5 * side, height / 2)) for side in (-1, 1)),
        *(
            sheet("Roof", [[x, y, height] for x, y in ((a, b), (c, b), (c, d), (a, d))])
            for a, b, c, d in lids
        ),
    ]
    a = half / height
    root = np.sqrt(1 + a * a)
    truth = 4 * 2 * a / root * np.arctan(a / root) / (2 * np.pi)
    found = gather(Occluders(room), facing(0, 0), even_sky)
    assert found.diffuse[0] == pytest.approx(truth, abs=0.01)


# What must always hold


@pytest.fixture(scope="module")
def shaded():
    """A floor under a table, some boxes about it."""
    bodies = [box("Table", (1.5, 1.5, 0.1), (0, 0, 1.2))]
    bodies += [box("Box", (0.7, 0.7, 1.5), (2 * x, 2 * y, 1.05)) for x, y in ((1, 0), (0, -1))]
    return Scene(tuple(bodies), (), (floor(12, 4.0),))


def test_heating_and_cooling_make_up_the_year(shaded):
    of = {
        span: study_radiation(shaded, Radiation(period=Period(span=span), accuracy=0.0))
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
    there = study_radiation(
        Scene(bodies, (), shaded.receivers), Radiation(site=turned, ground_reflectance=0.0)
    )
    here = study_radiation(shaded, Radiation(ground_reflectance=0.0))
    assert total(there) == pytest.approx(np.rot90(total(here), -1), rel=1e-3)


@pytest.mark.parametrize(
    ("accuracy", "error", "hourly"), [(0.5, 0.004, 0.008), (1, 0.008, 0.012), (3, 0.02, 0.025)]
)
def test_merged_suns_are_near_to_the_true_ones(shaded, accuracy, error, hourly):
    """Root mean square of the map and mean of the hours, of the direct irradiation's mean."""
    true, merged = (study_radiation(shaded, Radiation(accuracy=a)) for a in (0.0, accuracy))
    off = total(merged, "direct") - total(true, "direct")
    assert np.sqrt((off**2).mean()) < error * total(true, "direct").mean()
    off = np.abs(merged.hourly["direct"] - true.hourly["direct"])
    assert off.mean() < hourly * true.hourly["direct"].mean()
    assert any("suns are merged" in note for note in merged.meta["notes"])
    assert np.radians(merged.meta["accuracy"]) <= np.radians(accuracy)


def test_the_hours_make_up_the_maps(shaded):
    result = study_radiation(shaded, Radiation())
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
    lost = [sources_of(w, BOSTON, Period()).hourly for w in (weather, fine)]
    beam = [h.direct @ h.hours for h in lost]
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


# What bodies reflect


def test_a_wide_matte_floor_reflects_its_share():
    """To what looks down all of it, to what stands half [a plane to a wide one]."""
    wide = Body(
        "Lawn", level("Lawn", 4e3, 4e3, 0.0).mesh, Material(kind="diffuse", reflectance=0.4)
    )
    down, stands = np.diag([1.0, -1.0, -1.0, 1.0]), np.eye(4)
    stands[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    planes = Plane(width=0.01, length=0.01, resolution=1)
    down[2, 3] = stands[2, 3] = 2.0
    stands[0, 3] = 9.0
    receivers = (plane_receiver("Down", planes, down), plane_receiver("Wall", planes, stands))
    record = Radiation(period=SUMMER, bounces=2, ground_reflectance=0.0, error=0.01)
    result = study_radiation(Scene((wide,), (), receivers), record)
    level_total = sources_of(*weather_of(BOSTON, ""), SUMMER).hourly
    sun = level_total.direct @ np.maximum(level_total.sun[:, 2], 0)
    ghi = (sun + level_total.diffuse.sum()) / 1000
    for index, share in enumerate((1.0, 0.5)):
        got = total(result, "reflected", index)[0, 0]
        assert got == pytest.approx(0.4 * share * ghi, rel=0.02)
        parts = sum(total(result, name, index) for name in ("direct", "diffuse", "reflected"))
        assert total(result, "total", index) == pytest.approx(parts)
    assert result.hourly["reflected"].sum() / 1000 == pytest.approx(0.75 * 0.4 * ghi, rel=0.02)
    again = study_radiation(Scene((wide,), (), receivers), record)
    assert total(again, "reflected") == total(result, "reflected")
    assert any("known to" in note for note in result.meta["notes"])


# Receivers


def cube(resolution=48, sides="front"):
    mesh = box("Cube", (1, 1, 1), (0, 0, 0.5)).mesh.triangles()
    return Surface("Cube", mesh, unwrap(mesh, resolution), resolution, resolution, sides)


def test_a_mesh_is_a_receiver_by_its_unwrapped_map():
    result = study_radiation(Scene(receivers=(cube(),)), Radiation(ground_reflectance=0.0))
    (one,) = result.maps
    sources = sources_of(clear_weather(BOSTON), BOSTON, Period(), ground_reflectance=0)
    sides = [(0, 0), (90, 0), (90, 90), (90, 180), (90, 270), (180, 0)]
    truth = sum(unobstructed(facing(*side), sources).irradiation[0] for side in sides)
    assert one.area.sum() == pytest.approx(6, rel=1e-6)
    assert one.integral("total") == pytest.approx(truth, rel=0.01)
    assert np.isnan(one.maps["total"][one.area == 0]).all()


def test_both_sides_of_a_receiver_gather():
    pose = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
    plane = Plane(width=1, length=1, resolution=2, sides="both")
    wall = plane_receiver("Wall", plane, pose)  # its front looks to −Y
    (one,) = study_radiation(Scene(receivers=(wall,)), Radiation()).maps
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
    notes = " ".join(study_radiation(scene, Radiation()).meta["notes"])
    assert "No weather file is given" in notes
    assert "“Lid” looks down" in notes
    assert "4 of 8 sensors lie inside “Block”" in notes
    assert "returns 20 % of the light" in notes


def test_a_weather_file_brings_its_place_and_its_gaps(tmp_path):
    turin = Site(latitude=45.0, longitude=8.0, elevation=250.0, utc_offset=1.0)
    rows = epw_rows(cloudy(turin))
    rows[4000][13:16] = ["9999"] * 3
    file = write_epw(tmp_path / "turin.epw", cloudy(turin), rows)
    record = Radiation(weather_file=str(file), site=replace(BOSTON, north=30.0))
    result = study_radiation(Scene(receivers=(floor(1),)), record)
    assert result.meta["site"]["latitude"] == 45.0
    assert result.meta["site"]["north"] == 30.0
    notes = " ".join(result.meta["notes"])
    assert "that of 45.00° N, 8.00° E" in notes
    assert "interval" in notes
    assert total(result)[0, 0] == pytest.approx(
        cloudy(turin).global_horizontal.sum() / 1000, rel=5e-3
    )


def test_what_cannot_be_studied_is_said():
    with pytest.raises(SceneError, match="add a receiver"):
        study_radiation(Scene(), Radiation())
    with pytest.raises(FileError):
        study_radiation(Scene(receivers=(floor(),)), Radiation(weather_file="nowhere.epw"))
    bad = Body("Bad", Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32)), MATTE)
    with pytest.raises(SceneError, match="“Bad” has no faces"):
        study_radiation(Scene((bad,), (), (floor(),)), Radiation())
