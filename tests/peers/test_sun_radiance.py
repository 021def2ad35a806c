"""Sun hours, irradiation and illuminance as Radiance's rcontrib and rtrace find them."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.sun.bounces import Dome, Surroundings
from heliform.engines.sun.coefficients import Sought, daylight_coefficients
from heliform.engines.sun.gathering import gather
from heliform.engines.sun.hourly import hourly_skies
from heliform.engines.sun.illuminance import course_of, overcast
from heliform.engines.sun.luminance import horizontal_integral
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.patches import patches_of
from heliform.engines.sun.periods import Period
from heliform.engines.sun.position import sun_position
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.sky_matrix import cumulative
from heliform.engines.sun.suns import true_suns
from heliform.engines.sun.visibility import visible
from heliform.engines.sun.weights import sources_of
from numpy.testing import assert_allclose
from peers.skies import gendaymtx, typical_year
from peers.sun_scenes import (
    disc,
    enclosure,
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
EDGE = 2e-5  # m: single precision in a scene of 12 m, with a margin


@pytest.fixture(params=list(SCENES))
def scene(request, tmp_path):
    """Bodies, few sensors and many, and a folder with the scene for Radiance."""
    bodies, few, many = SCENES[request.param]
    write_scene(tmp_path, bodies)
    return bodies, few, many, tmp_path


def at_edges(occluders, sensors, directions, cells):
    """Which of the cells, (sensor, direction), change when the sensor moves by `EDGE`."""
    sensor, direction = cells
    found = np.zeros(len(sensor), bool)
    for turn in np.arange(8) * np.pi / 4:
        step = EDGE * np.array([np.cos(turn), np.sin(turn), 0.0])
        moved = at_points(sensors.points + step, sensors.normals)
        for k, (i, j) in enumerate(zip(sensor, direction, strict=True)):
            near = [
                visible(occluders, one.some(np.array([i])), directions[j : j + 1]).seen[0, 0] & 1
                for one in (moved, sensors)
            ]
            found[k] |= near[0] != near[1]
    return found


def same_hours(bodies, sensors, folder, directions):
    """Compare sensor by sensor which suns are seen; returns how many differ."""
    occluders = Occluders(bodies)
    write_suns(folder, directions)
    theirs = sun_coefficients(folder, sensors, len(directions)) > 0
    ours = visible(occluders, sensors, directions).values() > 0
    assert 0.02 < ours.mean() < 0.98
    differ = np.nonzero(ours != theirs)
    assert len(differ[0]) < 1e-4 * ours.size
    assert at_edges(occluders, sensors, directions, differ).all()
    return len(differ[0])


def test_the_suns_that_sensors_see_are_the_same(scene):
    """Every sun of every 23rd day; where one differs, an edge passes within hundredths of a mm."""
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
    assert_allclose(ours[lit], theirs[lit], rtol=0.01)
    assert np.median(np.abs(ours[lit] / theirs[lit] - 1)) < 1e-4


def by_patches(bodies, sensors, folder, samples, error):
    """Annual kWh/m² (N,): ours over whole patches, ours from their middles, Radiance's; open."""
    patches, dome = patches_of(2), Dome(2, SITE_YEAR.site)
    write_sky(folder)
    average = gendaymtx(SITE_YEAR, 2, "-O1", "-A")[1:, 0]
    theirs = patch_coefficients(folder, sensors, 2, samples) @ average * 8.76
    year = cumulative(SITE_YEAR, SITE_YEAR.site, 2)
    sky = np.append(year, 0.0)[None, :, None].repeat(2, axis=0)
    found = daylight_coefficients(Surroundings(bodies), sensors, dome, 0, Sought(sky, error))
    normal = year * patches.solid_angles
    middles = visible(Occluders(bodies), sensors, patches.directions).dot(normal)
    return found.value[:, 0], middles, theirs, normal @ patches.directions[:, 2]


def test_a_year_on_the_same_patches_is_within_2_percent(scene):
    """Whole patches on both sides, sun spread on them: gendaymtx and rcontrib against ours."""
    bodies, few, _, folder = scene
    ours, middles, theirs, level = by_patches(bodies, few, folder, 16384, 0.0015)
    lit = theirs > 0.1 * level
    assert lit.mean() > 0.5
    assert_allclose(ours[lit], theirs[lit], rtol=0.02)
    # A patch that is one direction shades all or nothing.
    assert 0.005 < (middles[lit] / theirs[lit] - 1).std() < 0.04


@pytest.mark.slow
def test_a_year_on_the_same_patches_at_2500_sensors_is_within_2_percent(scene):
    bodies, _, many, folder = scene
    ours, _, theirs, level = by_patches(bodies, many, folder, 65536, 0.0015)
    lit = theirs > 0.1 * level
    assert_allclose(ours[lit], theirs[lit], rtol=0.02)


def test_the_study_with_merged_suns_is_near_true_suns_and_whole_patches(scene):
    """The defaults against every hour's own sun and an area-sampled sky of 577 patches."""
    bodies, few, _, folder = scene
    weather, site = SITE_YEAR, SITE_YEAR.site
    true = sources_of(weather, site, Period(), accuracy=0.0, ground_reflectance=0.0)
    suns = len(true.suns.directions)
    write_suns(folder, true.directions[:suns], true.direct[:suns])
    write_sky(folder)
    sky = true.diffuse[suns:] / true.patches.solid_angles
    theirs = sun_irradiance(folder, few) + patch_coefficients(folder, few, 2, 4096) @ sky
    merged = sources_of(weather, site, Period(), ground_reflectance=0.0)
    found = gather(Occluders(bodies), few, merged)
    exact = gather(Occluders(bodies), few, true)
    assert_allclose(exact.direct, sun_irradiance(folder, few), rtol=0.01, atol=1.0)
    level = (true.direct + true.diffuse) @ np.maximum(true.directions[:, 2], 0)
    lit = theirs > 0.1 * level
    error = (found.direct + found.diffuse)[lit] / theirs[lit] - 1
    assert abs(error.mean()) < 0.01
    assert error.std() < 0.02


def coefficients(bodies, sensors, dome, skies, error=0.002):
    return daylight_coefficients(Surroundings(bodies), sensors, dome, 4, Sought(skies, error))


def test_four_bounces_under_an_overcast_sky_are_within_2_percent(scene):
    """With what Radiance sets for speed, -lw 1e-4 or so, it would be 1 to 5 % darker."""
    bodies, few, _, folder = scene
    some = few.some(slice(None, None, 4))
    bright = f"if(Dz, {9 / (7 * np.pi)} * (1 + 2 * Dz) / 3, {GROUND / np.pi})"
    write_daylight(folder, bright)
    theirs = illuminance(folder, some, 4, 4096)
    dome = Dome(2, SITE_YEAR.site)
    sky = overcast(dome, GROUND)
    found = coefficients(bodies, some, dome, np.stack([sky, sky])[:, :, None])
    assert_allclose(found.value[:, 0], theirs, rtol=0.02)
    # What bounces is a good part of it.
    straight = found.straight @ sky
    assert (straight < 0.95 * found.value[:, 0]).all()


@pytest.mark.parametrize("hour", [12, 16])
def test_four_bounces_on_a_clear_day_are_within_5_percent(scene, hour):
    """Sky, sun, and the reflected sun, which ours has from patches 3° wide."""
    bodies, few, _, folder = scene
    some = few.some(slice(None, None, 4))
    site = SITE_YEAR.site
    clear = replace(
        SITE_YEAR,
        direct_normal=np.full(8760, 800.0),
        diffuse_horizontal=np.full(8760, 90.0),
    )
    mask = np.arange(8760) == 171 * 24 + hour
    dome = Dome(4, site)
    course = course_of(clear, site, dome, mask, accuracy=0.0, ground_reflectance=GROUND)
    hourly = hourly_skies(clear, site, "light", mask)
    scale = hourly.diffuse[0] / horizontal_integral(hourly.skies)[0]
    sky = perez_brightness(hourly.skies, scale)
    write_daylight(folder, f"if(Dz, {sky}, {course.sky[-1, 0]})", hourly.sun[0], hourly.direct[0])
    theirs = illuminance(folder, some, 4, 4096)
    found = coefficients(bodies, some, dome, course.luminances(np.ones((1, 1))))
    direct = course.sunlight(Occluders(bodies), some)
    ours = course.light(found, direct)[:, 0]
    assert sun_position(clear.times[mask], site).altitude[0] > 30
    assert_allclose(ours, theirs, rtol=0.05)
    assert ours.max() > 5 * ours.min()
