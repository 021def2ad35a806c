"""Sunlight that surfaces reflect, against closed forms: found by shadow rays, or in mirrors."""

import numpy as np
import pytest
from heliform.engines.core.scene import Material
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.coefficients import Sought, blocks, daylight_coefficients
from heliform.engines.sun.dome import Dome
from heliform.engines.sun.hourly import hourly_skies
from heliform.engines.sun.illuminance import course_of
from heliform.engines.sun.scattered_suns import APART, MANY, scattered_suns
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.shadow_rays import aims_at
from heliform.engines.sun.suns import merged_suns
from heliform.engines.sun.surroundings import Surroundings
from sun.rooms import BOSTON, form_factors, matte, sphere
from sun.shades import box, level, sheet, unit

UP, DOWN = [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]
SUNS = np.array([unit(s) for s in ([0.3, 0.2, 0.8], [-0.5, 0.1, 0.3], [0.0, -0.9, 0.1])])
DOME = Dome(1, BOSTON)
WIDE = 1e4


def sunlit(bodies, points, normals, suns=SUNS, bounces=1, *, paths=1 << 14, **more):
    """What sensors have of suns of 1 lx, without any sky."""
    aims = aims_at(np.asarray(suns), np.ones(len(suns)), np.ones(len(suns), bool))
    dark = np.zeros((3, DOME.count, 1))
    sought = Sought(dark, 1e-9, paths, aims, np.ones((len(suns), 1)))
    around, sensors = Surroundings(tuple(bodies)), at_points(points, normals)
    return daylight_coefficients(around, sensors, DOME, bounces, sought, **more)


def facing_wall(reflectance=0.6):
    """A wall of 3 × 2 m in the plane y = 0, its corners, and what looks at it from the south."""
    corners = np.array([[-1.5, 0, 0], [1.5, 0, 0], [1.5, 0, 2], [-1.5, 0, 2]], float)
    return sheet("wall", corners.tolist(), matte(reflectance)), corners


def test_a_sunlit_wall_gives_what_its_view_factor_says():
    wall, corners = facing_wall()
    points = np.array([[0, -1.0, 1.0], [0.7, -2.0, 0.4], [-1.0, -0.5, 1.5]])
    normals = np.tile([0.0, 1, 0], (3, 1))
    suns = [unit(s) for s in ([0.2, -1, 0.7], [-0.8, -0.3, 0.4], [0.2, 1, 0.5])]
    seen = form_factors(points, normals, corners[None])[:, 0]
    expected = 0.6 * np.outer(seen, np.maximum(np.array(suns) @ [0, -1, 0], 0))
    found = sunlit([wall], points, normals, suns, paths=1 << 17)
    assert found.suns == pytest.approx(expected, rel=0.01, abs=1e-9)
    assert found.value[:, 0] == pytest.approx(expected.sum(axis=1), rel=0.01)
    assert not sunlit([wall], points, normals, suns, bounces=0).suns.any()


def test_a_wall_in_the_shade_gives_none():
    wall, _ = facing_wall()
    shade = box("shade", [9, 0.1, 9], [0, -3.0, 0], Material(kind="absorber"))
    low = [unit([0.0, -1, 0.2]), unit([0.0, -0.1, 1])]
    found = sunlit([wall, shade], [[0, -1.0, 1.0]], [[0.0, 1, 0]], low)
    assert found.suns[0, 0] == 0
    assert found.suns[0, 1] > 0


def test_a_wide_floor_gives_exactly_its_share():
    # Every path is scattered where the same sun shines: only which sun it asks is left to chance.
    found = sunlit([level("floor", WIDE, WIDE, 0.0, matte(0.4))], [[0, 0, 1.0]], [DOWN])
    assert found.suns[0] == pytest.approx(0.4 * SUNS[:, 2], rel=0.005)


def polarised(cosine, depth=0.0, ior=1.52):
    """What a pane lets through of s- and of p-polarised light (2, …), ``depth`` its optical one."""
    inner = np.sqrt(1 - (1 - cosine**2) / ior**2)
    s = ((cosine - ior * inner) / (cosine + ior * inner)) ** 2
    p = ((inner - ior * cosine) / (inner + ior * cosine)) ** 2
    kept = np.exp(-depth / inner)
    return np.array([kept * (1 - r) ** 2 / (1 - (kept * r) ** 2) for r in (s, p)])


def hemisphere():
    """What a pane lets through of light that comes by the cosine law."""
    node, weight = np.polynomial.legendre.leggauss(64)
    cosine = (node + 1) / 2
    return float(weight @ (cosine * polarised(cosine).mean(axis=0)))


GLASS = Material(kind="dielectric", ior=1.52)


def panes(count, thick=True, material=GLASS):
    if not thick:
        return [level(f"pane {n}", WIDE, WIDE, 2.0 + n, material) for n in range(count)]
    size = [WIDE, WIDE, 0.01]
    return [box(f"pane {n}", size, [0, 0, 2.0 + n], material) for n in range(count)]


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("thick", [True, False])
def test_sun_through_panes_and_off_a_floor(count, thick):
    floor = level("floor", WIDE, WIDE, 0.0, matte(0.4))
    found = sunlit([floor, *panes(count, thick)], [[0, 0, 1.0]], [DOWN])
    through = (polarised(SUNS[:, 2]) ** count).mean(axis=0)
    assert found.suns[0] == pytest.approx(0.4 * SUNS[:, 2] * through, rel=0.006)


def test_tinted_glass_takes_its_part():
    floor = level("floor", WIDE, WIDE, 0.0, matte(0.4))
    tinted = Material(kind="dielectric", ior=1.52, absorption=30.0)
    found = sunlit([floor, *panes(1, material=tinted)], [[0, 0, 1.0]], [DOWN])
    through = polarised(SUNS[:, 2], 30 * 0.01).mean(axis=0)
    assert found.suns[0] == pytest.approx(0.4 * SUNS[:, 2] * through, rel=0.01)


def test_a_screen_scatters_the_sun_and_lets_none_straight_through():
    floor = level("floor", WIDE, WIDE, 0.0, matte(0.4))
    screened = 0.1 * hemisphere() * SUNS[:, 2]
    above = sunlit(panes(1), [[0, 0, 1.0]], [UP], bounces=0, veil=0.1)
    assert above.suns[0] == pytest.approx(screened, rel=0.01)
    below = sunlit([floor, *panes(1)], [[0, 0, 1.0]], [DOWN], veil=0.1, paths=1 << 15)
    assert below.suns[0] == pytest.approx(0.4 * screened, rel=0.02)
    # A second pane farther out is crossed straight.
    two = sunlit(panes(2), [[0, 0, 1.0]], [UP], bounces=0, veil=0.1).suns[0]
    far = 0.1 * hemisphere() * SUNS[:, 2] * polarised(SUNS[:, 2]).mean(axis=0)
    assert two == pytest.approx(far, rel=0.01)


@pytest.mark.parametrize("bounces", [1, 2, 6])
def test_a_sphere_that_the_sun_shines_into_has_light_of_as_many_bounces(bounces):
    # What enters is spread evenly by each reflection: E = Φ / 4π · Σ ρ^k (1 − f)^(k − 1).
    share, reflectance = 0.2, 0.8
    body, points, normals = sphere(reflectance, share, rings=180, sectors=240)
    opening = np.pi * (1 - (1 - 2 * share) ** 2)
    suns = [unit([0.2, 0.1, 1.0])]
    some = slice(5000, None, 800)
    k = np.arange(1, bounces + 1)
    series = (reflectance**k * (1 - share) ** (k - 1)).sum()
    expected = opening * suns[0][2] / (4 * np.pi) * series
    found = sunlit([body], points[some], normals[some], suns, bounces, paths=1 << 15)
    assert found.suns.mean() == pytest.approx(expected, rel=0.01)


def test_a_mirror_hands_on_what_a_wall_scatters():
    # A mirror on the ground shows the wall upside down.
    wall, corners = facing_wall()
    mirror = level("mirror", WIDE, WIDE, -1e-3, Material(kind="mirror", reflectance=0.9))
    point, normal = np.array([[0, -1.0, 1.0]]), np.array([unit([0, 0.5, -1.0])])
    sun = unit([0.2, -1, 0.7])
    # On the image below the ground; the wall itself is seen by a part of the sensor's half space.
    image = corners * [1, 1, -1] - [0, 0, 2e-3]
    seen = form_factors(point, normal, image[None])[0, 0]
    alone = sunlit([wall], point, normal, [sun], paths=1 << 16).suns[0, 0]
    found = sunlit([wall, mirror], point, normal, [sun], 2, paths=1 << 16)
    direct = 0.6 * -sun[1] * 0.9 * seen
    # The sun in the mirror lights the wall as well; that is of the mirrored sun, not of these.
    assert found.suns[0, 0] - alone == pytest.approx(direct, rel=0.02)


def noon(accuracy=0.0, days=slice(None, None, 30)):
    mask = np.zeros(8760, bool)
    mask[np.flatnonzero(np.arange(8760) % 24 == 12)[days]] = True
    weather = clear_weather(BOSTON)
    dome = Dome(2, BOSTON)
    course = course_of(weather, BOSTON, dome, mask, accuracy=accuracy, ground_reflectance=0.2)
    return course, hourly_skies(weather, BOSTON, "light", mask)


@pytest.mark.parametrize("specularity", [0.0, 0.3, 1.0])
def test_what_is_mirrored_is_neither_lost_nor_counted_twice(specularity):
    # On a floor that mirrors some and scatters the rest, what looks down gets both.
    course, hourly = noon()
    shiny = Material(kind="plastic", reflectance=0.5, specularity=specularity)
    floor = Surroundings((level("floor", WIDE, WIDE, 0.0, shiny),))
    whole = np.ones((len(course.hours), 1))
    light = course.normal(whole)
    aims = course.aims(light[:, 0], whole[:, 0] > 0)
    sought = Sought(course.luminances(whole), 1e-9, 1 << 18, aims, light)
    sensors = at_points([[0, 0, 1.0]], [DOWN])
    found = daylight_coefficients(floor, sensors, course.dome, 1, sought)
    hours = course.light(found, np.zeros((1, len(course.hours)), np.float32))[0]
    returned = specularity + (1 - specularity) * 0.5
    falling = hourly.diffuse + hourly.direct * hourly.sun[:, 2]
    assert hours.sum() == pytest.approx(returned * falling.sum(), rel=0.012)
    assert hours.sum() == pytest.approx(found.value[0, 0], rel=1e-4)
    assert found.suns.any() == (specularity < 1)
    assert found.mirrored.any() == (specularity > 0)


def test_the_interval_holds_the_truth_as_often_as_it_says():
    wall, corners = facing_wall()
    random = np.random.default_rng(2)
    points = random.uniform([-1.5, -3, 0], [1.5, -1, 2], (1000, 3))
    normals = np.tile([0.0, 1, 0], (len(points), 1))
    suns = np.array([unit(s) for s in random.uniform([-1, -1, 0], [1, -0.1, 1], (40, 3))])
    seen = form_factors(points, normals, corners[None])[:, 0]
    truth = 0.6 * seen[:, None] * (suns @ [0, -1, 0]).sum()
    found = sunlit([wall], points, normals, suns, paths=8192)
    held = np.abs(found.value - truth) <= found.half_width
    assert held.mean() == pytest.approx(0.95, abs=0.025)
    assert found.value.mean() == pytest.approx(truth.mean(), rel=0.002)
    # And each sun by itself has its own light.
    own = 0.6 * seen.mean() * (suns @ [0, -1, 0])
    assert found.suns.mean(axis=0) == pytest.approx(own, rel=0.06)


def test_the_same_seed_finds_the_same_and_another_does_not():
    wall, _ = facing_wall()
    args = [wall], np.tile([[0, -1.0, 1.0]], (50, 1)), np.tile([0.0, 1, 0], (50, 1)), -SUNS
    first, again, other = (sunlit(*args, paths=2048, seed=s) for s in (3, 3, 4))
    assert np.array_equal(first.suns, again.suns)
    assert not np.array_equal(first.suns, other.suns)
    # Sensors at the same place are sent other rays, of which few sums differ.
    assert len(np.unique(first.suns[:, 1])) > 10


def test_without_suns_none_are_aimed_at():
    assert aims_at(SUNS, np.ones(3), np.zeros(3, bool)) is None
    assert aims_at(np.zeros((0, 3)), np.zeros(0), np.zeros(0, bool)) is None


def test_chances_go_by_light_and_leave_none_out():
    light, asked = np.array([1000.0, 0.0, 10.0, 5.0]), np.array([True, True, True, False])
    aims = aims_at(np.tile(SUNS[0], (4, 1)), light, asked)
    assert aims.chances.sum() == 1
    assert aims.chances == pytest.approx([0.5 / 1.01 + 1 / 6, 1 / 6, 0.0051 + 1 / 6, 0], abs=4e-4)
    assert np.array_equal(np.bincount(aims.table, minlength=4) / len(aims.table), aims.chances)
    many = aims_at(np.tile(SUNS[0], (50_000, 1)), np.eye(1, 50_000)[0], np.ones(50_000, bool))
    assert (many.chances > 0).all()
    assert many.chances.sum() == 1


def test_few_suns_stand_where_they_are_and_many_share_those_around():
    course, _ = noon()
    assert course.scattered is course.suns
    weather = clear_weather(BOSTON)
    hourly = hourly_skies(weather, BOSTON, "light")
    energy = hourly.direct * hourly.hours
    suns = merged_suns(hourly.sun, energy, 0.0)
    assert len(suns.directions) > 4000
    few = scattered_suns(suns, hourly.sun, energy)
    assert len(few.directions) < 2 * MANY
    up = hourly.sun[:, 2] > 0
    assert few.weights.sum(axis=0) == pytest.approx(up.astype(float), abs=1e-12)
    shares = few.weights.tocoo()
    cosine = np.einsum("ki,ki->k", few.directions[shares.row], hourly.sun[shares.col])
    assert np.degrees(np.arccos(cosine.min())) < 1.5 * APART
    # On the mean, over a sun's neighbours, the light comes from where it does.
    middle = (few.weights.T @ few.directions)[up]
    away = np.degrees(
        np.arccos(np.clip(np.einsum("ti,ti->t", unit(middle), hourly.sun[up]), -1, 1))
    )
    assert np.sqrt(np.mean(away**2)) < 1.5


def test_a_year_of_suns_takes_no_more_memory():
    for sources in (577, 5023, 50_000):
        longest = max(rows.stop - rows.start for rows in blocks(100_000, sources))
        assert longest * sources <= 1 << 22
