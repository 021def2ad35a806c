"""Daylight coefficients against closed forms, radiosity, and their own error."""

import numpy as np
import pytest
from heliform.engines.core.scene import Material
from heliform.engines.sun import patches
from heliform.engines.sun.cie_sky import cie_sky
from heliform.engines.sun.coefficients import (
    Sought,
    daylight_coefficients,
    open_patches,
)
from heliform.engines.sun.dome import Dome
from heliform.engines.sun.illuminance import overcast
from heliform.engines.sun.luminance import horizontal_integral, relative_luminance
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.site import Site, to_world
from heliform.engines.sun.surroundings import Surroundings
from sun.rooms import BOSTON, matte, sphere, traced, well, well_light
from sun.shades import box, level, sheet, unit

UP, DOWN = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]
GLASS = Material(kind="dielectric", ior=1.52)


def uneven(dome):
    """A sky that no plane sees without chance, so that all the paths asked for are followed."""
    sky = np.random.default_rng(0).uniform(size=(dome.count, 1))
    return np.stack([sky] * 3)


def assert_near(found, expected, paths):
    """Each patch to five standard errors of a count, which strata only make smaller."""
    doubt = np.sqrt(np.pi * np.maximum(expected, 1e-5) / paths)
    assert (np.abs(found - expected) < 5 * doubt).all()
    # And all of them together are no farther off than chance has it.
    assert np.mean(((found - expected) / doubt) ** 2) < 1.3


def cosine_fan(normal, count=1200):
    """Directions (count², 3) spread evenly by the cosine about a normal."""
    u, v = np.stack(np.meshgrid(*2 * [(np.arange(count) + 0.5) / count])).reshape(2, -1)
    around = np.sqrt(u)[:, None] * np.stack([np.cos(2 * np.pi * v), np.sin(2 * np.pi * v)], 1)
    n = unit(normal)
    x = unit(np.cross(n, np.eye(3)[np.abs(n).argmin()]))
    return np.sqrt(1 - u)[:, None] * n + around @ np.stack([x, np.cross(n, x)])


@pytest.mark.parametrize("subdivision", [1, 2, 4])
def test_open_patches_give_pi_together_and_what_their_centres_do(subdivision):
    dome, sky = Dome(subdivision, BOSTON), patches.patches_of(subdivision)
    found = open_patches(dome)
    assert found.sum() == pytest.approx(np.pi, rel=1e-12)
    near = sky.solid_angles * sky.directions[:, 2]
    assert found[:-2] == pytest.approx(near[:-1], rel=0.01)


def test_an_open_plane_gets_each_patch_s_share():
    dome = Dome(1, BOSTON)
    found = traced([], [[0, 0, 0]], [UP], skies=uneven(dome), paths=1 << 20)
    assert_near(found.straight[0], open_patches(dome), found.paths)
    assert found.straight.sum() == pytest.approx(np.pi, rel=1e-6)
    assert not found.scattered.any()


@pytest.mark.parametrize("north", [0.0, 40.0, -110.0])
def test_a_tilted_plane_in_a_turned_model_finds_the_patches_that_numpy_does(north):
    site = Site(north=north)
    dome, normal = Dome(2, site), unit([0.5, -0.3, 0.4])
    sought = Sought(uneven(dome), 1e-9, 1 << 19)
    sensors = at_points([[0, 0, 0]], [normal])
    found = daylight_coefficients(Surroundings(()), sensors, dome, 0, sought).straight[0]
    which = patches.patch_at(to_world(cosine_fan(normal), site), 2)
    expected = np.pi * np.bincount(np.where(which < 0, dome.count - 1, which)) / len(which)
    assert found[-1] == pytest.approx(expected[-1], abs=2e-3)
    assert_near(found, expected, 1 << 19)


def test_the_daylight_factor_outdoors_is_one():
    dome = Dome(2, BOSTON)
    sky = overcast(dome, 0.2)
    sought = Sought(np.stack([sky] * 3)[:, :, None], 1e-9, 1 << 18)
    sensors = at_points([[0, 0, 0]], [UP])
    found = daylight_coefficients(Surroundings(()), sensors, dome, 4, sought)
    assert found.value[0, 0] == pytest.approx(1, abs=3 * found.error[0, 0])
    assert found.error[0, 0] < 5e-4


def roof_light(size=1.0, height=3.0):
    """A black roof as far as one sees, with a square opening in its middle."""
    a, b = size / 2, 1e3
    black = Material(kind="absorber")
    spans = [(-b, -a, -b, b), (a, b, -b, b), (-a, a, -b, -a), (-a, a, a, b)]
    return [
        sheet("roof", [(x, y, height), (X, y, height), (X, Y, height), (x, Y, height)], black)
        for x, X, y, Y in spans
    ]


def sky_component(x, size=1.0, height=3.0):
    """The sky component of a roof opening on the floor, x m off its middle, under CIE sky 1."""
    node, weight = np.polynomial.legendre.leggauss(32)
    u, v = np.meshgrid(node * size / 2, node * size / 2)
    towards = np.stack([u - x, v, np.full_like(u, height)], axis=-1).reshape(-1, 3)
    distance = np.linalg.norm(towards, axis=1)
    towards /= distance[:, None]
    sky = cie_sky(1)
    bright = relative_luminance(sky, towards)[:, 0] / horizontal_integral(sky)[0]
    area = np.outer(weight, weight).ravel() * size**2 / 4
    return float(area @ (bright * towards[:, 2] ** 2 / distance**2))


def test_an_unglazed_roof_opening_has_the_sky_component_of_cie_171():
    # CIE 171:2006, 5.9, sky 1 and 1 m × 1 m: 2.33 % at G, 1.75 m from the middle.
    assert 100 * sky_component(1.75) == pytest.approx(2.33, abs=0.006)
    dome = Dome(4, BOSTON)
    centres = patches.patches_of(4).directions
    sky = np.append(relative_luminance(cie_sky(1), centres)[:, 0], 0)
    sky /= open_patches(dome) @ sky
    sought = Sought(np.stack([sky] * 3)[:, :, None], 1e-9, 1 << 18)
    places = [[0, 0, 0], [1, 0, 0], [1.75, 0, 0]]
    sensors = at_points(places, [UP] * 3, offset=1e-4)
    found = daylight_coefficients(Surroundings(tuple(roof_light())), sensors, dome, 4, sought)
    expected = [sky_component(x) for x, _, _ in places]
    assert found.value[:, 0] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("reflectance", [0.5, 0.8, 0.95])
def test_a_sphere_with_an_opening_integrates_its_light(reflectance):
    # E = π f / (1 − ρ (1 − f)), and Σ of as many terms of that series as there are bounces.
    share = 0.1
    body, points, normals = sphere(reflectance, share)
    some = slice(100, None, 500)
    for bounces in (0, 2, 40):
        found = traced([body], points[some], normals[some], bounces)
        ratio = reflectance * (1 - share)
        expected = np.pi * share * (1 - ratio ** (bounces + 1)) / (1 - ratio)
        chance = np.sqrt(np.sum(found.error**2)) / len(found.error)
        assert chance < 0.006 * expected
        mean = found.value.mean()
        assert mean == pytest.approx(expected, abs=4 * chance + 1e-3 * expected), bounces
        assert found.given_up.mean() == pytest.approx(ratio ** (bounces + 1), abs=0.01)


def test_a_white_room_in_an_even_world_is_as_bright_as_the_world():
    bodies = [*well(2.0, 1.0, 1.0), box("block", [0.3, 0.4, 0.5], [0.3, 0.2, 0.3], matte(1.0))]
    places, normals = [[-0.5, 0, 0.0], [0.9, 0.9, 0.5], [0, 0, 0.9]], [UP, [-1, 0, 0], DOWN]
    found = traced(bodies, places, normals, 250, paths=1 << 13)
    assert found.value[:, 0] == pytest.approx(np.pi, rel=2e-3)


@pytest.mark.parametrize("reflectance", [0.3, 0.7])
def test_an_open_box_has_the_light_of_radiosity(reflectance):
    points = np.array([[0.0, 0, 0], [0.8, 0.8, 0], [0.2, 1.0, 0.7]])
    normals = np.array([UP, UP, [0.0, -1, 0]])
    straight, total = well_light(2.0, 1.5, reflectance, points, normals)
    found = traced(well(2.0, 1.5, reflectance), points, normals, 60, paths=1 << 16)
    assert found.straight.sum(axis=1) == pytest.approx(straight, rel=0.01)
    assert found.value[:, 0] == pytest.approx(total, rel=0.01)
    reflected = found.scattered.sum(axis=1)
    assert reflected == pytest.approx(total - straight, rel=0.02)


def test_all_light_that_enters_a_box_is_absorbed_or_leaves():
    reflectance, size, height, count = 0.6, 2.0, 1.0, 16
    middle = (np.arange(count) + 0.5) / count
    u, v = (a.ravel() for a in np.meshgrid(middle, middle))
    points, normals, areas = [], [], []
    for body in well(size, height, reflectance):
        a, b, _, d = body.mesh.vertices
        normal = unit(np.cross(b - a, d - a))
        normal *= np.sign(([0, 0, height / 2] - a) @ normal)
        points.append(a + u[:, None] * (b - a) + v[:, None] * (d - a))
        normals.append(np.tile(normal, (len(u), 1)))
        areas.append(np.full(len(u), np.linalg.norm(np.cross(b - a, d - a)) / len(u)))
    floor = points[0] + [0, 0, height - 1e-3]
    found = traced(
        well(size, height, reflectance),
        np.concatenate([*points, floor]),
        np.concatenate([*normals, np.tile(DOWN, (len(u), 1))]),
        60,
        paths=2048,
    )
    inside, lid = found.value[: -len(u), 0], found.scattered[-len(u) :].sum(axis=1)
    absorbed = (1 - reflectance) * (inside @ np.concatenate(areas))
    leaving = lid.sum() * size**2 / len(u)
    assert absorbed + leaving == pytest.approx(np.pi * size**2, rel=0.004)


def floor_seen_askew(material):
    """What a sensor that looks east and down finds of the sky by a wide floor, and its paths."""
    dome = Dome(1, BOSTON)
    sensor = [[0, 0, 1.0]], [unit([1.0, 0, -1])]
    found = traced(
        [level("floor", 1e3, 1e3, 0.0, material)], *sensor, skies=uneven(dome), paths=1 << 18
    )
    fan = cosine_fan([1.0, 0, -1])
    down = fan[fan[:, 2] < -1e-6]
    share = len(down) / len(fan)
    mirrored = np.bincount(patches.patch_at(down * [1, 1, -1], 1), minlength=145) / len(fan)
    return found, share, np.pi * mirrored, open_patches(dome)[:-1]


def test_a_mirror_shows_the_sky_the_other_way_round():
    found, _, mirrored, _ = floor_seen_askew(Material(kind="mirror", reflectance=0.9))
    assert_near(found.mirrored[0, :-1] / 0.9, mirrored, found.paths)


def test_plastic_returns_its_gloss_as_a_mirror_and_the_rest_of_its_colour():
    plastic = Material(kind="plastic", reflectance=0.5, specularity=0.2)
    found, share, mirrored, even_sky = floor_seen_askew(plastic)
    assert_near(found.mirrored[0, :-1], 0.2 * mirrored, found.paths)
    assert_near(found.scattered[0, :-1], 0.8 * 0.5 * share * even_sky, found.paths)


def slab(cosine, ior):
    """What a clear pane lets through, all its reflections included."""
    inner = np.sqrt(1 - (1 - cosine**2) / ior**2)
    s = ((cosine - ior * inner) / (cosine + ior * inner)) ** 2
    p = ((inner - ior * cosine) / (inner + ior * cosine)) ** 2
    return ((1 - s) / (1 + s) + (1 - p) / (1 + p)) / 2


@pytest.mark.parametrize("thick", [True, False])
def test_a_pane_lets_an_even_sky_through_as_fresnel_says(thick):
    node, weight = np.polynomial.legendre.leggauss(64)
    cosine = (node + 1) / 2
    expected = 2 * (weight / 2) @ (cosine * slab(cosine, 1.52))
    pane = level("pane", 1e4, 1e4, 1.0, GLASS)
    if thick:
        pane = box("pane", [1e4, 1e4, 0.01], [0, 0, 1.0], GLASS)
    found = traced([pane], [[0, 0, 0.5]], [UP], paths=1 << 17)
    assert found.straight.sum() / np.pi == pytest.approx(expected, rel=1e-3)


def test_a_screen_scatters_once_whatever_the_panes_before_it():
    panes = [box(n, [1e4, 1e4, 0.01], [0, 0, z], GLASS) for n, z in (("in", 1.0), ("out", 1.1))]
    sensor = [[0, 0, 0.5]], [UP]
    one = traced(panes[:1], *sensor, veil=0.1).value[0, 0]
    node, weight = np.polynomial.legendre.leggauss(64)
    cosine = (node + 1) / 2
    hemisphere = 2 * (weight / 2) @ (cosine * slab(cosine, 1.52))
    # On the way in the sky's light crosses the pane once, with the screen behind it.
    assert one / np.pi == pytest.approx(0.1 * hemisphere, rel=2e-3)
    two = traced(panes, *sensor, veil=0.1, paths=1 << 17)
    assert two.value[0, 0] / np.pi == pytest.approx(0.1 * hemisphere**2, rel=2e-3)
    assert not two.straight.any()


@pytest.mark.parametrize("thick", [True, False])
def test_ground_glass_scatters_what_clear_glass_lets_through(thick):
    ground = Material(kind="dielectric", ior=1.52, roughness=0.3)
    node, weight = np.polynomial.legendre.leggauss(64)
    cosine = (node + 1) / 2
    hemisphere = 2 * (weight / 2) @ (cosine * slab(cosine, 1.52))
    size = [1e4, 1e4, 0.01]
    pane = box("pane", size, [0, 0, 1], ground) if thick else level("pane", 1e4, 1e4, 1, ground)
    # Light from the zenith alone arrives from all of the pane.
    zenith = np.zeros((3, 146, 1))
    zenith[:, 144] = 1
    found = traced([pane], [[0, 0, 0.5]], [UP], bounces=0, skies=zenith, paths=1 << 17)
    assert not found.straight.any()
    share = open_patches(Dome(1, BOSTON))[144]
    assert found.value[0, 0] == pytest.approx(share * hemisphere, rel=0.05)
    even_sky = traced([pane], [[0, 0, 0.5]], [UP], bounces=0, paths=1 << 15)
    assert even_sky.value[0, 0] == pytest.approx(np.pi * hemisphere, rel=3e-3)
    assert any("“pane” is ground glass" in note for note in Surroundings((pane,)).told())


def test_a_screen_before_ground_glass_scatters_once():
    ground = Material(kind="dielectric", ior=1.52, roughness=0.3)
    sensor = [level("pane", 1e4, 1e4, 1.0, ground)], [[0, 0, 0.5]], [UP]
    bare, screened = (traced(*sensor, veil=veil).value[0, 0] for veil in (0.0, 0.1))
    assert screened == pytest.approx(0.1 * bare, rel=5e-3)


def test_a_hole_that_few_paths_find_is_within_what_is_told():
    """Of a thousand paths a tenth of one finds it; none found is not none there."""
    dome = Dome(1, BOSTON)
    bodies, truth = Surroundings(tuple(roof_light(0.05))), 0.05**2 / 3.0**2
    sensors = at_points([[0, 0, 0]], [UP], offset=1e-4)
    held = []
    for seed in range(40):
        sought = Sought(np.ones((3, dome.count, 1)), 0.02, 1 << 13)
        found = daylight_coefficients(bodies, sensors, dome, 0, sought, seed=seed)
        assert found.half_width[0, 0] > 0
        held.append(abs(found.value[0, 0] - truth) <= found.half_width[0, 0])
    assert sum(held) >= 36


def test_the_same_seed_finds_the_same_and_another_does_not():
    args = (well(2.0, 1.0, 0.6), [[0, 0, 0.0]], [UP], 4)
    first, again, other = (traced(*args, paths=2048, seed=s) for s in (3, 3, 4))
    assert np.array_equal(first.scattered, again.scattered)
    assert not np.array_equal(first.scattered, other.scattered)


def test_the_interval_holds_the_truth_as_often_as_it_says():
    share, reflectance = 0.3, 0.7
    body, points, normals = sphere(reflectance, share, rings=120, sectors=192)
    some = np.random.default_rng(1).choice(len(points), 1000, replace=False)
    found = traced([body], points[some], normals[some], 40, paths=2048)
    truth = np.pi * share / (1 - reflectance * (1 - share))
    held = np.abs(found.value - truth) <= found.half_width
    assert held.mean() == pytest.approx(0.95, abs=0.02)
    # And the error that is told is the one that there is.
    real = np.sqrt(np.mean((found.value - truth) ** 2))
    assert np.sqrt(np.mean(found.error**2)) == pytest.approx(real, rel=0.06)


def test_four_times_the_paths_halve_the_error():
    body, points, normals = sphere(0.7, 0.3)
    points, normals = points[9::18], normals[9::18]
    truth = np.pi * 0.3 / (1 - 0.7 * 0.7)
    few, many = (traced([body], points, normals, 40, paths=p) for p in (2048, 8192))
    errors = [np.sqrt(np.mean((found.value - truth) ** 2)) for found in (few, many)]
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.15)


def test_rounds_go_on_until_the_error_is_what_was_asked():
    args = (well(2.0, 2.0, 0.6), [[0, 0, 0.0], [0.5, 0.5, 0]], [UP, UP], 4)
    for asked in (0.02, 0.005):
        found = traced(*args, error=asked, paths=1 << 20)
        reached = np.sqrt(np.mean(found.half_width**2)) / found.value.mean()
        assert reached < 1.4 * asked
    assert found.rounds > 8
    assert traced(*args, error=1e-9, paths=1 << 14).paths == 1 << 14
