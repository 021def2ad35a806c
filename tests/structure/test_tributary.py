"""Loads on cells reach the members: every newton, with its moment."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure.model import NO_NODE
from heliform.engines.structure.tributary import tributary_of
from structure.waffles import model, waffle

DOWN = np.array([0.0, 0.0, -1.0])


def force_and_moment(frame, line):
    """Resultant of line loads (M, 2, 3) by Gauss's rule of two points, exact for a cubic."""
    places = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3)
    ends, lengths = frame.ends(), frame.lengths()
    force, moment = np.zeros(3), np.zeros(3)
    for t in places:
        load = ((1 - t) * line[:, 0] + t * line[:, 1]) * lengths[:, None] / 2
        force += load.sum(axis=0)
        moment += np.cross((1 - t) * ends[:, 0] + t * ends[:, 1], load).sum(axis=0)
    return np.concatenate([force, moment])


def polygon(points):
    """One cell with a member along each of its sides."""
    count = len(points)
    cell = [*range(count), NO_NODE][:4]
    sides = [(i, (i + 1) % count) for i in range(count)]
    nodes = np.column_stack([points, np.zeros(count)]) if len(points[0]) == 2 else points
    return model(nodes, sides, [cell])


def shares_by_counting(points, count=1200):
    """Area of a convex polygon nearest to each side, by points of a fine grid."""
    points = np.asarray(points, float)
    low, high = points.min(axis=0), points.max(axis=0)
    step = (high - low) / count
    x, y = np.meshgrid(*(low[k] + (np.arange(count) + 0.5) * step[k] for k in (0, 1)))
    along = np.roll(points, -1, axis=0) - points
    along /= np.linalg.norm(along, axis=1)[:, None]
    away = np.array(
        [a[0] * (y - p[1]) - a[1] * (x - p[0]) for a, p in zip(along, points, strict=True)]
    )
    nearest = np.where((away >= 0).all(axis=0), away.argmin(axis=0), -1)
    return np.array([(nearest == k).sum() for k in range(len(points))]) * step.prod()


@pytest.mark.parametrize("triangles", [False, True])
def test_a_pressure_keeps_its_force_and_moment_on_any_plane_grid(triangles):
    rng = np.random.default_rng(4)
    made = waffle(7, 5, triangles=triangles)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    nodes = made.frame.nodes + [[1.2, 1.2, 0.0]] * rng.uniform(-1, 1, (len(made.frame.nodes), 3))
    frame = replace(made.frame, nodes=nodes @ turn.T + rng.normal(size=3))
    tributary = tributary_of(frame, made.cells)
    pressures = rng.normal(size=(len(made.cells), 3))
    found = force_and_moment(frame, tributary.line_loads(pressures))
    forces = pressures * tributary.areas[:, None]
    moment = np.cross(tributary.centres, forces).sum(axis=0)
    expected = np.concatenate([forces.sum(axis=0), moment])
    assert found == pytest.approx(expected, abs=1e-10 * np.abs(forces).sum() * 30)


def test_areas_and_centroids_are_those_of_the_polygons():
    kite = polygon([(0, 0), (3, -1), (5, 0), (3, 1)])
    tributary = tributary_of(kite.frame, kite.cells)
    assert tributary.areas == pytest.approx([5.0])
    assert tributary.centres[0] == pytest.approx([8 / 3, 0, 0])
    triangle = polygon([(0, 0), (3, 0), (0, 6)])
    assert tributary_of(triangle.frame, triangle.cells).centres[0] == pytest.approx([1, 2, 0])


def test_a_rectangle_gives_its_long_sides_a_trapezium_and_its_short_ones_a_triangle():
    made = polygon([(0, 0), (4, 0), (4, 2), (0, 2)])
    tributary = tributary_of(made.frame, made.cells)
    assert tributary.members == pytest.approx([3.0, 1.0, 3.0, 1.0])
    line = tributary.line_loads(np.array([DOWN]))
    assert line[:, :, 2] == pytest.approx(-np.array([[0.75] * 2, [0.5] * 2] * 2))
    assert line[:, :, :2] == pytest.approx(0)


@pytest.mark.parametrize(
    "points",
    [
        [(0, 0), (3, 0), (4, 1.5), (1, 1.5)],  # a parallelogram
        [(0, 0), (2, -1), (4, 0), (2, 1)],  # a rhombus
        [(0, 0), (2, 0), (1, np.sqrt(3))],  # an equilateral triangle
    ],
)
def test_shares_of_a_balanced_cell_are_the_areas_nearest_to_each_side(points):
    made = polygon(points)
    tributary = tributary_of(made.frame, made.cells)
    counted = shares_by_counting(points)
    line = tributary.line_loads(np.array([DOWN]))
    if len(points) == 3 or (points[0] == (0, 0) and points[1][1]):
        assert tributary.members == pytest.approx(counted, abs=1e-2)
    assert tributary.members.sum() == pytest.approx(counted.sum(), abs=1e-2)
    assert (line[..., 2] <= 1e-12).all()


def test_a_side_without_a_member_leaves_its_share_to_the_others():
    square = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)]
    beams = model(square, [(0, 1), (2, 3)], [[0, 1, 2, 3]])
    tributary = tributary_of(beams.frame, beams.cells)
    assert tributary.members == pytest.approx([2.0, 2.0])
    three = model(square, [(0, 1), (1, 2), (2, 3)], [[0, 1, 2, 3]])
    tributary = tributary_of(three.frame, three.cells)
    line = tributary.line_loads(np.array([DOWN]))
    expected = [0, 0, -4, -4, 4, 0]
    assert force_and_moment(three.frame, line) == pytest.approx(expected, abs=1e-12)
    single = model(square, [(1, 2)], [[0, 1, 2, 3]])
    line = tributary_of(single.frame, single.cells).line_loads(np.array([DOWN]))
    assert line[0] == pytest.approx(np.array([[0, 0, -2.0], [0, 0, -2.0]]))


def test_a_cell_without_members_is_refused_by_name():
    square = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0)]
    made = model(square, [(0, 2)], [[0, 1, 2, 3]])
    with pytest.raises(SceneError, match=r"Cell 0 \(nodes 0, 1, 2, 3\) has no member"):
        tributary_of(made.frame, made.cells)


def test_loads_do_not_depend_on_how_members_or_cells_are_numbered():
    made = waffle(3, 3, height=lambda x, y: 0.02 * x * y)
    frame = made.frame
    pressures = np.arange(27.0).reshape(9, 3)
    line = tributary_of(frame, made.cells).line_loads(pressures)
    flipped = replace(frame, members=frame.members[:, ::-1])
    turned = tributary_of(flipped, np.roll(made.cells, 1, axis=1)).line_loads(pressures)
    assert turned[:, ::-1] == pytest.approx(line, abs=1e-12)


def test_a_symmetric_roof_is_loaded_symmetrically():
    made = waffle(6, 4, height=lambda x, y: 0.01 * x * (30 - x) + 0.02 * y * (20 - y))
    carried = tributary_of(made.frame, made.cells).members
    middles = made.frame.ends().mean(axis=1)
    mirrored = [15, 10, 0] + (middles - [15, 10, 0]) * [-1, 1, 1]
    partner = np.abs(mirrored[:, None] - middles).sum(axis=2).argmin(axis=1)
    assert carried == pytest.approx(carried[partner], rel=1e-12)


def test_plan_area_is_exact_on_a_warped_surface():
    made = waffle(9, 6, height=lambda x, y: 4 * np.sin(x / 4) * np.cos(y / 3))
    tributary = tributary_of(made.frame, made.cells)
    assert (tributary.areas * tributary.slopes).sum() == pytest.approx(600.0, rel=1e-13)
    weight = tributary.slopes[:, None] * DOWN
    found = force_and_moment(made.frame, tributary.line_loads(weight))
    assert found[:3] == pytest.approx([0, 0, -600.0], rel=1e-12, abs=1e-9)


def test_a_cell_with_a_reflex_corner_keeps_force_and_moment():
    made = polygon([(0, 0), (4, 0), (1, 1), (0, 4)])
    tributary = tributary_of(made.frame, made.cells)
    line = tributary.line_loads(np.array([DOWN]))
    centre = tributary.centres[0]
    assert tributary.areas == pytest.approx([4.0])
    expected = [0, 0, -4, -4 * centre[1], 4 * centre[0], 0]
    assert force_and_moment(made.frame, line) == pytest.approx(expected, abs=1e-12)


def test_members_shortened_by_offsets_carry_the_same_force():
    made = waffle(2, 2)
    offsets = np.zeros((len(made.frame.members), 2, 3))
    along = made.frame.axes()[:, 0]
    offsets[:, 0], offsets[:, 1] = 0.5 * along, -0.5 * along
    short = replace(made.frame, offsets=offsets)
    line = tributary_of(short, made.cells).line_loads(np.tile(DOWN, (4, 1)))
    assert force_and_moment(short, line)[2] == pytest.approx(-600.0, rel=1e-13)
