"""Sun hours and irradiation against closed forms and pvlib."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pvlib
import pytest
from heliform.engines.core.scene import Body, Material, Plane, Scene, plane_receiver
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.gathering import gather, unobstructed
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.periods import Period
from heliform.engines.sun.radiation import Radiation, study_radiation
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.site import Site
from heliform.engines.sun.weights import sources_of, weather_of
from sun.floors import BOSTON, SUMMER, facing, floor, total
from sun.shades import box, level, sheet
from sun.weather_files import cloudy

EQUATOR = Site(latitude=0.0, longitude=0.0, elevation=0.0, utc_offset=0.0)
EQUINOX = Period(span="spring equinox")


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


# What bodies reflect


def on_a_level(period):
    """Irradiation of level ground in an open field in kWh/m²."""
    hourly = sources_of(*weather_of(BOSTON, ""), period).hourly
    return (hourly.direct @ np.maximum(hourly.sun[:, 2], 0) + hourly.diffuse.sum()) / 1000


def test_a_wide_ceiling_reflects_what_the_ground_does():
    """Under it nothing else comes to what looks up: both shares of what falls on the ground."""
    ceiling = level("Ceiling", 4e3, 4e3, 2.0, Material(kind="diffuse", reflectance=0.7))
    record = Radiation(period=SUMMER, bounces=1, ground_reflectance=0.3, error=0.01)
    result = study_radiation(Scene((ceiling,), (), (floor(1, 0.01),)), record)
    truth = 0.7 * 0.3 * on_a_level(SUMMER)
    assert total(result)[0, 0] == pytest.approx(truth, rel=0.01)
    assert result.hourly["reflected"].sum() / 1000 == pytest.approx(truth, rel=0.01)


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
    ghi = on_a_level(SUMMER)
    for index, share in enumerate((1.0, 0.5)):
        got = total(result, "reflected", index)[0, 0]
        assert got == pytest.approx(0.4 * share * ghi, rel=0.02)
        parts = sum(total(result, name, index) for name in ("direct", "diffuse", "reflected"))
        assert total(result, "total", index) == pytest.approx(parts)
    assert result.hourly["reflected"].sum() / 1000 == pytest.approx(0.75 * 0.4 * ghi, rel=0.02)
    again = study_radiation(Scene((wide,), (), receivers), record)
    assert total(again, "reflected") == total(result, "reflected")
    assert any("known to" in note for note in result.meta["notes"])


def test_a_shiny_floor_reflects_both_shares_hour_by_hour():
    """What it scatters is of the sun where it stands, what it mirrors of patches around."""
    shiny = Material(kind="plastic", reflectance=0.5, specularity=0.3)
    wide = Body("Pond", level("Pond", 4e3, 4e3, 0.0).mesh, shiny)
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    down[2, 3] = 2.0
    plane = plane_receiver("Down", Plane(width=0.01, length=0.01, resolution=1), down)
    record = Radiation(period=SUMMER, bounces=1, ground_reflectance=0.0, error=0.01)
    result = study_radiation(Scene((wide,), (), (plane,)), record)
    found = total(result, "reflected")[0, 0]
    assert found == pytest.approx((0.3 + 0.7 * 0.5) * on_a_level(SUMMER), rel=0.02)
    assert result.hourly["reflected"].sum() / 1000 == pytest.approx(found, rel=1e-4)
