"""The loft: derivatives, closed forms, and the sizes that are asked for."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.glass import PRESETS, Plan, Wall, wall_loft
from heliform.engines.glass.loft import Loft
from heliform.engines.glass.outline import outline

LOBED = Plan(amplitude_1=0.1, period_2=5, amplitude_2=0.03, phase_2=40.0)
SIX = Plan(radius=0.08, period_1=6, amplitude_1=0.05)
LOFTS = {
    "straight": Wall(plan=LOBED),
    "twisted": Wall(plan=LOBED, twist=120.0),
    "tapered": Wall(plan=LOBED, scale=0.6, twist=-30.0),
    "blended": Wall(plan=LOBED, to_top=True, top=SIX, twist=20.0, scale=1.2),
}


def circle(radius, z=None, count=400, start=0.0, centre=(0.0, 0.0)):
    t = start + np.arange(count) * (2 * np.pi / count)
    plan = np.column_stack([centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t)])
    return plan if z is None else np.column_stack([plan, np.full(count, z)])


STACK = [circle(r, z) for r, z in ((0.1, 0.0), (0.12, 0.05), (0.07, 0.12), (0.09, 0.2))]


def every():
    lofts = {name: wall_loft(wall) for name, wall in LOFTS.items()}
    return lofts | {"stack": wall_loft(Wall(twist=10.0), STACK)}


@pytest.mark.parametrize("name", [*LOFTS, "stack"])
def test_derivatives_are_those_of_the_surface(name):
    loft = every()[name]
    random = np.random.default_rng(7)
    turn, z = random.uniform(-2, 40, 500), random.uniform(0.01, 0.19, 500)
    place, e = loft.at(turn, z), 1e-6
    along = (loft.at(turn + e, z).points - loft.at(turn - e, z).points) / (2 * e)
    rise = (loft.at(turn, z + e).points - loft.at(turn, z - e).points) / (2 * e)
    assert place.along == pytest.approx(along, abs=1e-6)
    assert place.rise == pytest.approx(rise, abs=1e-6)
    assert np.array_equal(place.rise[..., 2], np.ones(500))
    tangent = place.along[:, :2] / np.hypot(*place.along[:, :2].T)[:, None]
    assert np.einsum("ni,ni->n", tangent, place.normal) == pytest.approx(0.0, abs=1e-12)
    assert np.hypot(*place.normal.T) == pytest.approx(1.0)
    heading = np.unwrap(
        [np.angle(loft.at(turn + d, z).along @ (1, 1j, 0)) for d in (-e, e)], axis=0
    )
    bend = np.diff(heading, axis=0)[0] / (2 * e) / np.hypot(*place.along[:, :2].T)
    assert place.curvature == pytest.approx(bend, abs=1e-3)


@pytest.mark.parametrize("name", [*LOFTS, "stack"])
def test_normals_look_outward_and_turns_repeat(name):
    loft = every()[name]
    turn = np.arange(2048) / 2048
    for z in (0.0, loft.height / 3, loft.height):
        place = loft.at(turn, z)
        inside = np.einsum("ni,ni->n", place.points[:, :2], place.normal)
        assert inside.mean() > 0
        assert loft.at(turn + 7, z).points == pytest.approx(place.points, abs=1e-12)


def test_turns_and_heights_broadcast():
    loft = wall_loft(LOFTS["blended"])
    turn, z = np.linspace(0, 1, 5), np.linspace(0, 0.2, 3)
    grid = loft.at(turn, z[:, None])
    assert grid.points.shape == (3, 5, 3)
    assert grid.curvature.shape == (3, 5)
    assert grid.normal.shape == (3, 5, 2)
    for row, height in enumerate(z):
        assert grid.points[row] == pytest.approx(loft.at(turn, height).points, abs=1e-15)
    assert wall_loft(Wall()).at(turn, z[:, None]).points.shape == (3, 5, 3)


def test_a_blend_begins_and_ends_in_its_plans():
    wall = replace(LOFTS["blended"], twist=0.0, scale=1.0)
    loft, turn = wall_loft(wall), np.linspace(0, 1, 50)
    for z, plan in ((0.0, LOBED), (wall.height, SIX)):
        alone = wall_loft(Wall(plan=plan))
        assert loft.at(turn, z).points[:, :2] == pytest.approx(alone.at(turn, 0).points[:, :2])
    assert loft.at(0.0, [0.0, wall.height]).points[:, 1] == pytest.approx(0.0, abs=1e-12)


def test_a_twist_turns_and_a_scale_grows():
    plain, turn = wall_loft(Wall(plan=LOBED)), np.linspace(0, 1, 30)
    loft = wall_loft(Wall(plan=LOBED, twist=90.0, scale=0.5))
    base = plain.at(turn, 0.0).points
    top = loft.at(turn, 0.2)
    assert top.points[:, :2] == pytest.approx(0.5 * np.column_stack([-base[:, 1], base[:, 0]]))
    assert top.curvature == pytest.approx(2 * plain.at(turn, 0.0).curvature)
    assert loft.length(0.1) == pytest.approx(0.75 * plain.length(0.0))


def test_a_cone_has_the_slope_curvature_and_length_of_a_cone():
    loft = wall_loft(Wall(plan=Plan(radius=0.1), scale=0.5, height=0.2))
    z = np.linspace(0, 0.2, 7)
    place = loft.at(0.3, z)
    radius = 0.1 - 0.25 * z
    assert np.hypot(*place.points[:, :2].T) == pytest.approx(radius)
    assert np.einsum("ni,ni->n", place.rise[:, :2], place.normal) == pytest.approx(-0.25)
    assert place.curvature == pytest.approx(1 / radius, rel=1e-4)
    assert loft.length(z) == pytest.approx(2 * np.pi * radius, rel=1e-9)


def test_a_stack_goes_through_its_curves_at_their_heights():
    loft = wall_loft(Wall(height=0.4), [np.add(c, [0, 0, 0.03]) for c in reversed(STACK)])
    assert loft.height == pytest.approx(0.2)
    for curve in STACK:
        place = loft.at(np.linspace(0, 1, 9), curve[0, 2])
        assert np.hypot(*place.points[:, :2].T) == pytest.approx(np.hypot(*curve[0, :2]), rel=1e-9)
    radii = np.hypot(*loft.at(0.0, np.linspace(0, 0.2, 400)).points[:, :2].T)
    assert np.abs(np.diff(radii, 2)).max() < 1e-5


def test_a_stack_of_a_cone_is_a_cone():
    loft = wall_loft(Wall(), [circle(0.1 - 0.2 * z, z) for z in (0.0, 0.03, 0.1, 0.2)])
    z = np.linspace(0, 0.2, 33)
    assert np.hypot(*loft.at(0.6, z).points[:, :2].T) == pytest.approx(0.1 - 0.2 * z)


def test_two_curves_at_one_height_rise_to_the_walls_own():
    loft = wall_loft(Wall(height=0.15), [circle(0.1), circle(0.06)])
    assert loft.height == 0.15
    assert np.hypot(*loft.at(0.2, 0.15).points[:2]) == pytest.approx(0.06)


def test_where_a_drawn_curve_starts_does_not_twist_the_wall():
    t = np.arange(600) * (2 * np.pi / 600)
    lobed = np.column_stack([np.cos(t), np.sin(t)]) * (0.1 + 0.01 * np.cos(3 * t))[:, None]
    lobed[:, 0] += 0.01 * np.cos(t)
    still = wall_loft(Wall(), [lobed, 0.8 * lobed])
    begun_elsewhere = wall_loft(Wall(), [lobed, 0.8 * np.roll(lobed, 171, axis=0)])
    at = np.linspace(0, 1, 40), 0.17
    assert begun_elsewhere.at(*at).points == pytest.approx(still.at(*at).points, abs=5e-4)


@pytest.mark.parametrize(
    "wall",
    [
        Wall(plan=LOBED),
        Wall(plan=LOBED, scale=0.7),
        Wall(plan=LOBED, scale=1.4),
        Wall(plan=LOBED, to_top=True, top=SIX),
        Wall(plan=Plan(period_1=8, amplitude_1=0.45)),
        Wall(plan=Plan(period_1=8, amplitude_1=0.45), overlap="hull"),
    ],
)
def test_width_and_depth_are_measured_over_the_outer_faces(wall):
    loft = wall_loft(replace(wall, width=0.25, depth=0.2))
    turn = np.arange(20_000) / 20_000
    sizes = []
    for z in np.linspace(0, loft.height, 21):
        place = loft.at(turn, z)
        outer = place.points[:, :2] + wall.thickness / 2 * place.normal
        sizes.append(np.ptp(outer, axis=0))
    assert np.max(sizes, axis=0) == pytest.approx([0.25, 0.2], abs=2e-6)


def test_the_width_of_a_drawn_curve_can_be_asked_for_too():
    loft = wall_loft(Wall(width=0.3), [circle(0.1)])
    points = loft.at(np.arange(8192) / 8192, 0).points
    assert np.ptp(points, axis=0)[:2] == pytest.approx([0.292, 0.2], abs=1e-6)


@pytest.mark.parametrize("name", ["blended", "stack"])
def test_the_length_of_a_section_is_that_of_its_polygon(name):
    loft = every()[name]
    for z in np.linspace(0, loft.height, 5):
        points = loft.at(np.arange(50_000) / 50_000, z).points
        polygon = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1).sum()
        assert loft.length(z) == pytest.approx(polygon, rel=1e-7)
    many = np.linspace(0, loft.height, 1000)
    assert loft.length(many)[::50] == pytest.approx(loft.length(many[::50]), rel=1e-6)


def test_only_a_wall_that_does_not_change_is_prismatic():
    assert {name for name, loft in every().items() if loft.prismatic} == {"straight"}
    assert Loft((outline(circle(0.1)),), np.zeros(1), 0.2).prismatic


def test_presets_make_walls_without_notes():
    for wall in PRESETS.values():
        assert wall_loft(wall).notes == ()


def test_an_overlap_is_noted_once():
    plan = Plan(period_1=8, amplitude_1=0.45)
    assert len(wall_loft(Wall(plan=plan, to_top=True, top=plan)).notes) == 1
    assert "would run into itself" in wall_loft(Wall(plan=plan)).notes[0]


EIGHT = circle(0.1) * [1, 0] + np.column_stack([np.zeros(400), 0.05 * np.sin(2 * np.arange(400))])


@pytest.mark.parametrize(
    ("wall", "curves", "said"),
    [
        (Wall(), [circle(0.1)[:250]], "is open"),
        (Wall(), [EIGHT[:, ::-1]], "crosses itself|open"),
        (Wall(), [circle(0.1, 0.0), circle(0.1, 0.1), circle(0.1, 0.1)], "at z 100 mm; give each"),
        (Wall(), [circle(0.003)], "no room for a wall of 8 mm"),
        (Wall(width=0.006), [], "holds no wall of 8 mm"),
        (Wall(thickness=0.1), [], "out of bounds"),
        (Wall(plan=Plan(period_1=0)), [], "glass.wall.plan"),
        (Wall(plan=Plan(amplitude_1=0.6, amplitude_2=0.5)), [], "reach the middle"),
    ],
)
def test_a_wall_that_cannot_be_is_refused_in_a_sentence(wall, curves, said):
    with pytest.raises(ParameterError, match=said):
        wall_loft(wall, curves)
