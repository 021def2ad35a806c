"""Sun hours, irradiation and illuminance as Radiance's rcontrib and rtrace find them."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.sun import hourly
from heliform.engines.sun.coefficients import Sought, daylight_coefficients
from heliform.engines.sun.dome import Dome
from heliform.engines.sun.gathering import gather
from heliform.engines.sun.illuminance import course_of, overcast
from heliform.engines.sun.luminance import horizontal_integral
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.patches import patches_of
from heliform.engines.sun.periods import Period
from heliform.engines.sun.sky_matrix import cumulative
from heliform.engines.sun.suns import true_suns
from heliform.engines.sun.surroundings import Surroundings
from heliform.engines.sun.visibility import visible
from heliform.engines.sun.weights import sources_of
from peers.skies import gendaymtx, radiance_position, radiance_sun, typical_year
from peers.sun_scenes import (
    enclosure,
    free,
    illuminance,
    in_enclosure,
    patch_coefficients,
    perez_brightness,
    sheets,
    sun_coefficients,
    sun_irradiance,
    under_waffle,
    waffle,
    write_daylight,
    write_scene,
    write_sky,
    write_suns,
)

pytestmark = pytest.mark.peer
SITE_YEAR = typical_year()
FLOOR = sheets("Floor", [[(-6, -6, 0), (6, -6, 0), (6, 6, 0), (-6, 6, 0)]], 0.2)
SCENES = {
    "waffle": ((waffle(), FLOOR), under_waffle(7), under_waffle(50)),
    "enclosure": (enclosure(), in_enclosure(0.12), in_enclosure(0.017)),
}
GROUND = 0.2
EDGE = 3e-4  # m


def errors(ours, theirs):
    """Ours ÷ theirs − 1, whose figures `pytest -s` shows."""
    found = ours / theirs - 1
    spread, worst = np.sqrt((found**2).mean()), np.abs(found).max()
    print(f"\nmean {found.mean():+.2%}, RMS {spread:.2%}, worst {worst:.2%} of {len(found):,}")
    return found


@pytest.fixture(params=list(SCENES))
def scene(request, tmp_path):
    """Bodies, few sensors and many, and a folder with the scene for Radiance."""
    bodies, few, many = SCENES[request.param]
    write_scene(tmp_path, bodies)
    return bodies, few, many, tmp_path


def same_hours(bodies, sensors, folder, directions):
    """Compare sensor by sensor which suns are seen.

    Where they differ, the ray passes an edge so closely that a shift by `EDGE` would decide.
    """
    write_suns(folder, directions)
    theirs = sun_coefficients(folder, sensors, len(directions)) > 0
    ours = visible(Occluders(bodies), sensors, directions).values() > 0
    assert 0.02 < ours.mean() < 0.98
    sensor, direction = np.nonzero(ours != theirs)
    assert len(sensor) < 2e-4 * ours.size
    towards, origins = directions[direction], sensors.origins[sensor]
    exact = free(bodies, origins, towards)
    near = np.zeros(len(sensor), bool)
    for step in EDGE * np.concatenate([np.eye(3), -np.eye(3)]):
        near |= free(bodies, origins + step, towards) != exact
    assert near.all()
    print(f"\n{len(sensor):,} of {ours.size:,} cells differ")
    # Double precision is with ours.
    assert (ours[sensor, direction] == exact).sum() >= 0.95 * len(exact)


def test_the_suns_that_sensors_see_are_the_same(scene):
    """Every sun of every 23rd day; where one differs, an edge passes within 0.3 mm."""
    bodies, few, _, folder = scene
    chosen = SITE_YEAR.times[np.arange(8760) // 24 % 23 == 0]
    same_hours(bodies, few, folder, true_suns(chosen, SITE_YEAR.site).directions)


@pytest.mark.slow
def test_the_suns_of_a_whole_year_are_the_same(scene):
    bodies, _, many, folder = scene
    directions = true_suns(SITE_YEAR, SITE_YEAR.site).directions
    assert len(directions) > 4300
    assert len(many) >= 2500
    same_hours(bodies, many, folder, directions)


def test_a_year_on_the_same_directions_is_the_same(scene):
    """A sky whose patches shine from their middles, as suns for Radiance, with the sun on them."""
    bodies, few, _, folder = scene
    patches = patches_of(2)
    normal = cumulative(SITE_YEAR, SITE_YEAR.site, 2) * patches.solid_angles
    write_suns(folder, patches.directions, normal)
    theirs = sun_irradiance(folder, few)
    ours = visible(Occluders(bodies), few, patches.directions).dot(normal)
    lit = theirs > 0.1 * (normal @ patches.directions[:, 2])
    assert lit.mean() > 0.5
    error = np.abs(errors(ours[lit], theirs[lit]))
    assert error.max() < 0.01
    assert np.median(error) < 1e-4


@pytest.fixture
def radiance_year(monkeypatch):
    """The year under the sun of gendaymtx, which is up to 1° off, with no beam by night."""
    at, altitude = radiance_position(SITE_YEAR), radiance_sun(SITE_YEAR)[1]
    monkeypatch.setattr(hourly, "sun_position", lambda *_, **__: at)
    return replace(SITE_YEAR, direct_normal=np.where(altitude > 0, SITE_YEAR.direct_normal, 0.0))


def by_patches(year, bodies, sensors, folder, samples, paths):
    """Annual kWh/m² (N,): ours, Radiance's, and the open sky's."""
    patches, dome = patches_of(2), Dome(2, SITE_YEAR.site)
    write_sky(folder)
    average = gendaymtx(year, 2, "-O1", "-A")[1:, 0]
    theirs = patch_coefficients(folder, sensors, 2, samples) @ average * 8.76
    light = cumulative(year, SITE_YEAR.site, 2)
    sky = np.append(light, 0.0)[None, :, None].repeat(3, axis=0)
    found = daylight_coefficients(Surroundings(bodies), sensors, dome, 0, Sought(sky, 1e-4, paths))
    level = (light * patches.solid_angles) @ patches.directions[:, 2]
    return found.value[:, 0], theirs, level


def test_a_year_on_the_same_patches_is_within_2_percent(scene, radiance_year):
    """Whole patches on both sides, sun spread on them: gendaymtx and rcontrib against ours."""
    bodies, few, _, folder = scene
    some = few.some(slice(None, None, 3))
    ours, theirs, level = by_patches(radiance_year, bodies, some, folder, 16384, 1 << 16)
    lit = theirs > 0.1 * level
    assert lit.mean() > 0.4
    assert np.abs(errors(ours[lit], theirs[lit])).max() < 0.02


@pytest.mark.slow
def test_a_year_on_the_same_patches_at_2500_sensors_is_within_2_percent(scene, radiance_year):
    bodies, _, many, folder = scene
    ours, theirs, level = by_patches(radiance_year, bodies, many, folder, 32768, 1 << 18)
    lit = theirs > 0.1 * level
    error = errors(ours[lit], theirs[lit])
    assert abs(error.mean()) < 0.002
    assert np.sqrt((error**2).mean()) < 0.005
    assert np.abs(error).max() < 0.02


def test_the_study_is_near_true_suns_and_whole_patches(scene):
    """Suns merged to 1° and patches that are a direction each, against every hour's own sun and
    an area-sampled sky: within 2 % in the finest sky, and near it in the default."""
    bodies, every, _, folder = scene
    few = every.some(slice(None, None, 3))
    weather, site = SITE_YEAR, SITE_YEAR.site
    true = sources_of(weather, site, Period(), accuracy=0.0, ground_reflectance=0.0)
    suns = len(true.suns.directions)
    write_suns(folder, true.directions[:suns], true.direct[:suns])
    write_sky(folder)
    sky = true.diffuse[suns:] / true.patches.solid_angles
    direct = sun_irradiance(folder, few)
    matrix = patch_coefficients(folder, few, 2, 16384)
    theirs = direct + matrix @ sky
    level = (true.direct + true.diffuse) @ np.maximum(true.directions[:, 2], 0)
    lit = theirs > 0.1 * level
    occluders = Occluders(bodies)
    sunny = direct > 0.1 * level
    assert np.abs(errors(gather(occluders, few, true).direct[sunny], direct[sunny])).max() < 0.005
    # What it costs Radiance itself to have the sun on patches.
    spread = matrix @ cumulative(weather, site, 2)
    assert 0.005 < np.sqrt((errors(spread[lit], theirs[lit]) ** 2).mean()) < 0.05
    off = []
    for subdivision in (2, 4):
        merged = sources_of(
            weather, site, Period(), subdivision=subdivision, ground_reflectance=0.0
        )
        found = gather(occluders, few, merged)
        off.append(errors((found.direct + found.diffuse)[lit], theirs[lit]))
    coarse, fine = (np.sqrt((error**2).mean()) for error in off)
    assert fine < coarse < 0.02
    assert np.abs(off[1]).max() < 0.02


def followed(bodies, sensors, dome, skies, paths, **suns):
    """Coefficients of four bounces from so many paths a sensor."""
    sought = Sought(skies, 1e-4, paths, **suns)
    return daylight_coefficients(Surroundings(bodies), sensors, dome, 4, sought)


def test_four_bounces_under_an_overcast_sky_are_within_1_percent(scene):
    """With -lw 3e-6 instead of 1e-8, Radiance would drop so much of it as to be 1 to 5 % darker."""
    bodies, few, _, folder = scene
    some = few.some(slice(None, None, 6))
    bright = f"if(Dz, {9 / (7 * np.pi)} * (1 + 2 * Dz) / 3, {GROUND / np.pi})"
    write_daylight(folder, bright)
    theirs = illuminance(folder, some, 4, 65536)
    dome = Dome(2, SITE_YEAR.site)
    sky = overcast(dome, GROUND)
    found = followed(bodies, some, dome, np.stack([sky] * 3)[:, :, None], 1 << 17)
    assert np.abs(errors(found.value[:, 0], theirs)).max() < 0.01
    # Without what bounces, they would not be.
    assert (found.straight @ sky < 0.99 * found.value[:, 0]).all()
    assert (found.straight @ sky < 0.95 * theirs).any()


def on_a_clear_day(bodies, sensors, folder, hour):
    """Compare illuminance in the hour before ``hour`` on 21 June."""
    site, chosen = SITE_YEAR.site, np.arange(8760) == 171 * 24 + hour
    beam, diffuse = np.full(8760, 800.0), np.full(8760, 90.0)
    clear = replace(SITE_YEAR, direct_normal=beam, diffuse_horizontal=diffuse)
    dome = Dome(2, site)
    course = course_of(clear, site, dome, chosen, accuracy=0.0, ground_reflectance=GROUND)
    now = hourly.hourly_skies(clear, site, "light", chosen)
    sky = perez_brightness(now.skies, now.diffuse[0] / horizontal_integral(now.skies)[0])
    write_daylight(folder, f"if(Dz, {sky}, {course.sky[-1, 0]})")
    theirs = illuminance(folder, sensors, 4, 65536)
    write_daylight(folder, "0", now.sun[0], now.direct[0])
    theirs += illuminance(folder, sensors, 3, 65536)
    whole, suns = np.ones((1, 1)), course.normal(np.ones((1, 1)))
    aims = course.aims(suns[:, 0], np.array([True]))
    found = followed(bodies, sensors, dome, course.luminances(whole), 1 << 16, aims=aims, suns=suns)
    direct = course.sunlight(Occluders(bodies), sensors)
    ours = course.light(found, direct)[:, 0]
    assert (direct > 0).any()
    assert (direct == 0).any()
    assert np.abs(errors(ours, theirs)).max() < 0.03


def test_four_bounces_on_a_clear_day_are_within_3_percent(scene):
    """Sky, sun, and the reflected sun, at its own place in both."""
    bodies, few, _, folder = scene
    on_a_clear_day(bodies, few.some(slice(None, None, 8)), folder, 16)


@pytest.mark.slow
@pytest.mark.parametrize("hour", [9, 12, 16])
def test_four_bounces_at_several_hours_are_within_3_percent(scene, hour):
    bodies, few, _, folder = scene
    on_a_clear_day(bodies, few.some(slice(None, None, 8)), folder, hour)
