"""Roofs: counts, symmetry, the surface they lie on, columns, openings and folds."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure.crossing import crossing_triangles
from heliform.engines.structure.folds import check_sheet, triangles_of
from heliform.engines.structure.frame import FIXED, HINGED
from heliform.engines.structure.grid import Opening, cell_edges, grid_of
from heliform.engines.structure.model import NO_NODE
from heliform.engines.structure.roof import (
    GROUPS,
    Columns,
    Roof,
    control_points,
    roof_model,
    topology_key,
)
from heliform.engines.structure.surface import Net, evaluate, net_of, positions_at
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

RNG = np.random.default_rng(3)
ROUND = Opening(size_u=0.3, size_v=0.4)


def moved(points):
    """A net that moves the points {(row, column): (x, y, z)}."""
    shifts = np.zeros((4, 4, 3))
    for (row, column), shift in points.items():
        shifts[row, column] = shift
    return net_of(shifts)


def pieces(model):
    start, end = model.frame.members.T
    count = len(model.frame.nodes)
    graph = coo_array((np.ones(len(start)), (start, end)), shape=(count, count))
    return connected_components(graph, directed=False, return_labels=False)


def areas(model):
    """The cells' area vectors (F, 3)."""
    cells = np.where(model.cells == NO_NODE, model.cells[:, [2]], model.cells)
    a, b, c, d = np.moveaxis(model.frame.nodes[cells], 1, 0)
    return np.cross(c - a, d - b) / 2


def surface_area(points, count=400):
    """Area of a surface by fine triangles."""
    even = np.linspace(0, 1, count)
    p, _ = evaluate(points, even, even)
    first = np.cross(p[1:, :-1] - p[:-1, :-1], p[1:, 1:] - p[:-1, :-1])
    second = np.cross(p[1:, 1:] - p[:-1, :-1], p[:-1, 1:] - p[:-1, :-1])
    return (np.linalg.norm(first, axis=2) + np.linalg.norm(second, axis=2)).sum() / 2


def places(model, scale):
    """Members as sorted pairs of rounded places, after scaling."""
    nodes = np.round(model.frame.nodes * scale, 9) + 0.0
    return {tuple(sorted(map(tuple, pair))) for pair in nodes[model.frame.members].tolist()}


@pytest.mark.parametrize(("along", "across"), [(20, 14), (30, 20), (1, 1), (7, 4)])
def test_a_waffle_has_as_many_parts_as_its_formula_says(along, across):
    grid = grid_of("waffle", along, across)
    assert len(grid.uv) == (along + 1) * (across + 1)
    assert len(grid.members) == along * (across + 1) + across * (along + 1)
    assert len(grid.cells) == along * across


@pytest.mark.parametrize(("along", "across"), [(15, 10), (1, 1), (7, 4)])
def test_a_diagonal_grid_has_as_many_parts_as_its_formula_says(along, across):
    grid = grid_of("diagonal", along, across)
    assert len(grid.uv) == (along + 1) * (across + 1) + along * across
    assert len(grid.members) == 4 * along * across + 2 * (along + across)
    quads = along * (across - 1) + across * (along - 1)
    assert len(grid.cells) == quads + 2 * (along + across)
    assert (grid.cells[:, 3] == NO_NODE).sum() == 2 * (along + across)


@pytest.mark.parametrize("pattern", ["waffle", "diagonal", "triangulated"])
@pytest.mark.parametrize("openings", [(), (ROUND,)])
def test_grids_are_sound(pattern, openings):
    """Euler's formula for a sheet with so many holes, cells to the left, edges that are members."""
    grid = grid_of(pattern, 12, 9, openings)
    euler = len(grid.uv) - len(grid.members) + len(grid.cells)
    assert euler == 1 - len(openings)
    edges, _ = cell_edges(grid.cells)
    members = {tuple(sorted(pair)) for pair in grid.members.tolist()}
    assert members == {tuple(sorted(pair)) for pair in edges.tolist()}
    assert len(members) == len(grid.members)
    assert len({tuple(pair) for pair in edges.tolist()}) == len(edges)
    flat = np.column_stack([grid.uv, np.zeros(len(grid.uv))])
    cells = np.where(grid.cells == NO_NODE, grid.cells[:, [2]], grid.cells)
    a, b, c, d = np.moveaxis(flat[cells], 1, 0)
    signed = np.cross(c - a, d - b)[:, 2] / 2
    assert signed.min() > 0
    if not openings:
        assert signed.sum() == pytest.approx(1.0, abs=1e-13)


def test_the_thesis_roof_spans_30_by_20_m_on_four_hinged_columns():
    model = roof_model(Roof())
    frame = model.frame
    sheet = frame.nodes[np.unique(model.cells)]
    assert np.ptp(sheet, axis=0)[:2] == pytest.approx([30.0, 20.0])
    assert (model.groups == 1).sum() == 4
    held = frame.held.any(axis=1)
    assert held.sum() == 4
    assert (frame.held[held] == HINGED).all()
    assert not frame.nodes[held, 2].any()
    assert len(frame.members) == 598  # 20 × 14 cells, 4 columns
    assert len(roof_model(Roof(spacing=1.0)).frame.members) == 1254
    assert pieces(model) == 1
    assert model.group_names == GROUPS


@pytest.mark.parametrize("pattern", ["waffle", "diagonal"])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_roof_is_its_own_mirror_image(pattern, axis):
    columns = Columns(pairs=3, branching=1.0)
    model = roof_model(Roof(pattern=pattern, columns=columns, opening_1=ROUND))
    found = places(model, np.ones(3))
    assert found == places(model, 1 - 2 * np.eye(3)[axis])
    assert len(found) == len(model.frame.members)


def test_rise_and_undulation_are_as_high_as_they_say():
    even = np.linspace(0, 1, 201)
    dome, _ = evaluate(control_points(Roof(height=5, rise=2, undulation=0)), even, even)
    assert dome[100, 100, 2] == pytest.approx(7.0)
    assert dome[..., 2].max() == pytest.approx(7.0)
    assert dome[[0, -1]][..., 2] == pytest.approx(5.0)
    wave, _ = evaluate(control_points(Roof(height=5, rise=0, undulation=0.5)), even, even)
    chebyshev = np.cos(2 * np.arccos(2 * even - 1))
    assert wave[..., 2] == pytest.approx(5 + 0.5 * np.outer(chebyshev, chebyshev), abs=1e-12)


@pytest.mark.parametrize("pattern", ["waffle", "diagonal"])
def test_the_nodes_lie_on_the_surface_and_cells_cover_it(pattern):
    net = net_of(RNG.uniform(-1.5, 1.5, (4, 4, 3)))
    roof = Roof(pattern=pattern, spacing=0.5)
    model = roof_model(roof, net)
    points = control_points(roof)
    points += np.array([[[s.x, s.y, s.z] for s in row] for row in rows_of(net)])
    grid = grid_of(*topology_key(roof)[1:4])
    assert surface_area(points) == pytest.approx(
        np.linalg.norm(areas(model), axis=1).sum(), rel=2e-4
    )
    on = [evaluate(points, [u], [v])[0][0, 0] for u, v in grid.uv[::97]]
    assert model.frame.nodes[: len(grid.uv) : 97] == pytest.approx(np.array(on), abs=1e-12)


def rows_of(net):
    return [[getattr(net, f"p{i}{j}") for j in range(4)] for i in range(4)]


def test_normals_are_unit_and_point_where_cells_are_counter_clockwise():
    model = roof_model(Roof(), net_of(RNG.uniform(-1, 1, (4, 4, 3))))
    normals = model.frame.normals
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-12)
    assert normals[model.groups == 0, 2].min() > 0.5
    assert areas(model)[:, 2].min() > 0
    axes = model.frame.axes()
    ribs = model.groups == 0
    assert np.einsum("mi,mi->m", axes[ribs, 2], normals[ribs]).min() > 0.99


def test_columns_stand_upright_where_the_insets_put_them():
    model = roof_model(Roof(columns=Columns(pairs=3, inset_along=0.1, inset_across=0.0)))
    foot, head = np.moveaxis(model.frame.nodes[model.frame.members[model.groups == 1]], 1, 0)
    assert np.array_equal(foot[:, :2], head[:, :2])
    assert sorted(set(np.round(foot[:, 0], 9))) == pytest.approx([-12.0, 0.0, 12.0])
    assert sorted(set(np.round(foot[:, 1], 9))) == pytest.approx([-10.0, 10.0])


def test_columns_in_the_corners_leave_the_overhang_free():
    roof = Roof(overhang=3.0, columns=Columns(inset_along=0.0, inset_across=0.0), spacing=1.0)
    model = roof_model(roof)
    assert np.ptp(model.frame.nodes, axis=0)[:2] == pytest.approx([36.0, 26.0])
    feet = model.frame.nodes[model.frame.held.any(axis=1)]
    assert np.abs(feet[:, :2]) == pytest.approx(np.array([[15.0, 10.0]] * 4))


def test_a_branching_column_holds_the_nodes_around():
    plain = roof_model(Roof())
    model = roof_model(Roof(columns=Columns(branching=1.5, base="fixed")))
    assert (model.groups == 2).sum() == 16
    assert pieces(model) == 1
    columns = model.frame.members[model.groups == 1]
    assert model.frame.lengths()[model.groups == 1] == pytest.approx(
        plain.frame.lengths()[plain.groups == 1] - 1.5
    )
    for foot, head in columns:
        assert (model.frame.held[foot] == FIXED).all()
        ends = model.frame.members[model.groups == 2]
        around = model.frame.nodes[ends[ends[:, 0] == head, 1]]
        middle = model.frame.nodes[head, :2]
        assert around[:, :2].mean(axis=0) == pytest.approx(middle, abs=1e-9)


def test_an_opening_takes_cells_and_the_ribs_inside_but_not_its_rim():
    whole, model = roof_model(Roof()), roof_model(Roof(opening_1=ROUND))
    assert len(model.cells) < len(whole.cells)
    edges = {tuple(sorted(pair)) for pair in cell_edges(model.cells)[0].tolist()}
    ribs = model.frame.members[model.groups == 0]
    assert {tuple(sorted(pair)) for pair in ribs.tolist()} == edges
    assert pieces(model) == 1
    removed = 1 - np.linalg.norm(areas(model), axis=1).sum() / surface_area(control_points(Roof()))
    assert removed == pytest.approx(np.pi / 4 * 0.3 * 0.4, abs=0.02)


def test_a_rectangular_opening_takes_the_share_it_covers():
    opening = Opening(shape="rectangle", u=0.5, v=0.5, size_u=0.4, size_v=0.5)
    grid = grid_of("waffle", 10, 8, (opening,))
    assert len(grid.cells) == 80 - 4 * 4


def test_the_topology_stays_while_the_surface_moves():
    roof = Roof(columns=Columns(branching=1.0))
    one, two = roof_model(roof), roof_model(replace(roof, rise=2.0, length=33.0, cells_along=20))
    assert topology_key(roof) == topology_key(
        replace(roof, rise=2.0, length=33.0, cells_along=20, height=7.0)
    )
    assert np.array_equal(one.frame.members, two.frame.members)
    assert np.array_equal(one.frame.held, two.frame.held)
    other = replace(roof, cells_along=21)
    assert topology_key(other) != topology_key(roof)


def test_the_same_roof_is_the_same_to_the_last_bit():
    net = moved({(1, 1): (0.0, 0.0, 1.0)})
    one, two = roof_model(Roof(), net), roof_model(Roof(), net)
    assert np.array_equal(one.frame.nodes, two.frame.nodes)
    assert np.array_equal(one.frame.normals, two.frame.normals)


def test_openings_that_leave_nothing_or_cut_the_roof_are_refused():
    with pytest.raises(SceneError, match="pieces"):
        roof_model(Roof(opening_1=Opening(shape="rectangle", size_u=0.1, size_v=1.0)))
    with pytest.raises(SceneError, match="nothing"):
        roof_model(Roof(opening_1=Opening(shape="rectangle", size_u=1.0, size_v=1.0)))


def test_columns_that_meet_or_have_no_height_are_refused():
    with pytest.raises(SceneError, match="2 columns stand under node"):
        roof_model(Roof(cells_along=1, cells_across=1, columns=Columns(pairs=3)))
    with pytest.raises(SceneError, match=r"Column 0 under node \d+ ends -.* raise the roof"):
        roof_model(Roof(height=1.0), moved({(1, 1): (0, 0, -30)}))
    with pytest.raises(SceneError, match="branch"):
        roof_model(Roof(height=3.0, columns=Columns(branching=6.0)))


FOLDED = {
    "control points that change places": {(1, 1): (25, 0, 0), (2, 1): (-25, 0, 0)}
    | {(1, j): (25, 0, 0) for j in range(4)}
    | {(2, j): (-25, 0, 0) for j in range(4)},
    "an edge drawn over the middle": {(0, j): (25, 0, 0) for j in range(4)},
    "a corner drawn inward": {(0, 0): (25, 18, 0)},
}


@pytest.mark.parametrize("points", FOLDED.values(), ids=FOLDED.keys())
def test_a_folded_surface_is_refused_with_its_place_and_remedy(points):
    with pytest.raises(SceneError, match=r"near u = \d\.\d\d, v = \d\.\d\d .*control points back"):
        roof_model(Roof(), moved(points))


def test_a_surface_without_area_is_refused():
    roof = Roof(length=30, rise=0, undulation=0)
    flattened = {(i, j): (0, 10 - 20 * j / 3, 0) for i in range(4) for j in range(4)}
    with pytest.raises(SceneError, match=r"no area near u = 0\.00"):
        roof_model(roof, moved(flattened))


def test_a_surface_that_passes_through_itself_is_refused():
    """A sheet that runs a loop: its inner rows change sides above the outer ones."""
    points = {(1, j): (50, 0, 40) for j in range(4)} | {(2, j): (-50, 0, 40) for j in range(4)}
    roof = Roof(height=60.0, rise=0.0, undulation=0.0, spacing=1.0)
    with pytest.raises(SceneError, match="crosses itself"):
        roof_model(roof, moved(points))


def test_a_surface_that_is_turned_over_is_refused():
    points = {(i, j): (20 * i - 30, 0, 0) for i in range(4) for j in range(4)}
    mirror = {place: (-x, 0, 0) for place, (x, _, _) in points.items()}
    with pytest.raises(SceneError, match="turned over"):
        roof_model(Roof(), moved(mirror))


def test_a_surface_is_taken_just_where_its_triangles_do_not_cross():
    """Random nets: what passes has no crossing, by the slow comparison of all pairs."""
    grid = grid_of("waffle", 12, 9)
    triangles, _ = triangles_of(grid.cells)
    passed = []
    for _ in range(40):
        points = control_points(Roof()) + RNG.uniform(-14, 14, (4, 4, 3))
        nodes = positions_at(points, grid.uv)
        try:
            check_sheet(nodes, grid.cells, grid.uv)
        except SceneError:
            passed.append(False)
        else:
            passed.append(True)
            assert crossing_triangles(nodes, triangles) is None
    assert 5 < sum(passed) < 35


def test_triangles_cross_where_one_pierces_the_other():
    flat = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0.0]])
    pairs = np.arange(6, dtype=np.int32).reshape(2, 3)
    upright = np.array([[1, 1, -1], [1, 1, 1], [9, 9, 0.0]])
    for shift, crosses in (((0, 0, 0), True), ((0, 0, 1.1), False), ((9, 0, 0), False)):
        nodes = np.vstack([flat, upright + shift])
        assert (crossing_triangles(nodes, pairs) is not None) == crosses
    assert crossing_triangles(np.vstack([flat, flat + np.array([0, 0, 0.1])]), pairs) is None
    joined = np.array([[0, 1, 2], [0, 1, 3]], dtype=np.int32)
    assert crossing_triangles(np.vstack([flat, [[0, 0, 3.0]]]), joined) is None


def test_a_steep_overhanging_surface_is_taken():
    """Its edge curls under, but nothing folds: the projection alone would refuse it."""
    points = {(0, j): (8, 0, -3.9) for j in range(4)} | {(1, j): (-14, 0, 0) for j in range(4)}
    model = roof_model(Roof(height=12.0, rise=0.0, undulation=0.0), moved(points))
    assert areas(model)[:, 2].min() < 0


def test_an_unmoved_net_changes_nothing():
    assert np.array_equal(
        roof_model(Roof(), Net()).frame.nodes, roof_model(Roof(), None).frame.nodes
    )
