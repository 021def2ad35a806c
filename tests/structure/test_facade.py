"""Diagrid façades: their formula, counts, plan, core and folds."""

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, SceneError
from heliform.engines.structure.diagrid import diagrid_of
from heliform.engines.structure.facade import GROUPS, Facade, facade_model, topology_key
from heliform.engines.structure.frame import HINGED
from heliform.engines.structure.grid import cell_edges
from heliform.engines.structure.model import NO_NODE
from heliform.engines.structure.plan import polygon, read_plan, superellipse
from heliform.engines.structure.surface import net_of
from scipy.integrate import quad
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.special import ellipe

ROUND = Facade(exponent=2.0)


def areas(model):
    cells = np.where(model.cells == NO_NODE, model.cells[:, [2]], model.cells)
    a, b, c, d = np.moveaxis(model.frame.nodes[cells], 1, 0)
    return np.cross(c - a, d - b) / 2


def lifted(axis, rows=slice(None), columns=slice(None), by=1.0):
    shifts = np.zeros((4, 4, 3))
    shifts[rows, columns, axis] = by
    return net_of(shifts)


def test_the_thesis_facade_is_96_m_tall_with_floors_every_4_m():
    model = facade_model(Facade())
    heights = np.unique(np.round(model.frame.nodes[:, 2], 9))
    assert heights == pytest.approx(np.arange(25) * 4.0)
    assert model.group_names == GROUPS
    rings = model.frame.members[model.groups == 1]
    z = model.frame.nodes[rings, 2]
    assert z[:, 0] == pytest.approx(z[:, 1])
    assert np.unique(np.round(z, 9)) == pytest.approx(np.arange(1, 25) * 4.0)


@pytest.mark.parametrize(("around", "storeys", "row"), [(24, 24, 2), (5, 7, 1), (6, 10, 3)])
def test_a_diagrid_has_as_many_parts_as_its_formula_says(around, storeys, row):
    """m joints a row, 2m nodes at floors between, 2m diagonals a storey; a tube's Euler χ is 0."""
    grid = diagrid_of(around, storeys, row)
    at = [around if k % row == 0 else 2 * around for k in range(storeys + 1)]
    assert len(grid.uv) == sum(at)
    assert np.bincount(grid.groups).tolist() == [2 * around * storeys, sum(at[1:])]
    assert len(grid.cells) == 2 * around * storeys
    edges = np.unique(np.sort(cell_edges(grid.cells)[0], axis=1), axis=0)
    assert len(grid.uv) - len(edges) + len(grid.cells) == 0
    members = np.unique(np.sort(grid.members, axis=1), axis=0)
    assert len(members) == len(grid.members) == len(edges) - around  # no ring on the ground


def test_joints_stand_where_the_diagrids_formula_says():
    m, rows = 12, 12
    model = facade_model(Facade(exponent=2.0, modules=m, storeys_per_row=2, twist=40.0))
    i, j = np.meshgrid(np.arange(rows + 1), np.arange(m), indexing="ij")
    angle = 2 * np.pi * (j + (i % 2) / 2) / m + np.radians(40) * i / rows
    truth = np.stack([15 * np.cos(angle), 15 * np.sin(angle), 8.0 * i], axis=-1).reshape(-1, 3)
    away = np.linalg.norm(model.frame.nodes[:, None] - truth, axis=2).min(axis=0)
    assert away.max() < 1e-5


def test_diagonals_are_helices_that_cross_at_every_row():
    grid = diagrid_of(10, 12, 3)
    diagonals = grid.members[grid.groups == 0]
    ahead = np.diff(grid.uv[diagonals], axis=1)[:, 0]
    ahead[:, 0] -= np.round(ahead[:, 0])
    assert np.abs(ahead[:, 0]) == pytest.approx(1 / 10 / 2 / 3)
    assert ahead[:, 1] == pytest.approx(1 / 12)
    meeting = np.bincount(diagonals.ravel())
    inner = (grid.levels > 0) & (grid.levels < 12)
    assert np.array_equal(meeting[inner], np.where(grid.levels % 3 == 0, 4, 2)[inner])


def test_nodes_lie_on_the_superellipse():
    for exponent in (1.0, 2.0, 4.0, 12.0):
        x, y, _ = facade_model(Facade(width=40, depth=25, exponent=exponent)).frame.nodes.T
        assert np.abs(2 * x / 40) ** exponent + np.abs(2 * y / 25) ** exponent == pytest.approx(
            1.0, abs=1e-11
        )


def test_a_superellipse_is_walked_evenly_by_its_length():
    """Ellipse: a quarter is a·E(e²); rhombus: straight sides."""
    plan = superellipse(40.0, 24.0, 2.0)
    points, _ = plan.at(np.linspace(0, 1, 40_001))
    gone = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert gone.sum() == pytest.approx(4 * 20 * ellipe(1 - (12 / 20) ** 2), rel=1e-7)
    assert gone[:10_000].sum() == pytest.approx(gone.sum() / 4, rel=1e-9)
    share = quad(lambda t: np.hypot(20 * np.sin(t), 12 * np.cos(t)), 0, np.pi / 5)[0] / gone.sum()
    assert plan.at(np.array([share]))[0][0] == pytest.approx(
        [20 * np.cos(np.pi / 5), 12 * np.sin(np.pi / 5)], abs=1e-5
    )
    rhombus, _ = superellipse(30.0, 30.0, 1.0).at(np.array([0.0, 0.125, 0.25]))
    assert rhombus == pytest.approx(np.array([[15, 0], [7.5, 7.5], [0, 15]]), abs=1e-6)


def test_normals_are_unit_and_those_of_the_cylinder():
    model = facade_model(ROUND)
    angle = 2 * np.pi * model.surface[:, 0]
    truth = np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    assert model.frame.normals == pytest.approx(truth, abs=1e-4)
    assert np.linalg.norm(model.frame.normals, axis=1) == pytest.approx(1.0, abs=1e-12)


def test_cells_face_outward_and_close_around_the_tower():
    model = facade_model(Facade(width=36, twist=30.0), lifted(0, columns=[1, 2], by=3.0))
    vectors = areas(model)
    nodes = np.where(model.cells == NO_NODE, model.cells[:, [2]], model.cells)
    middles = model.frame.nodes[nodes].mean(axis=1)
    assert np.einsum("fi,fi->f", vectors, middles * (1, 1, 0)).min() > 0
    assert vectors[:, :2].sum(axis=0) == pytest.approx(0.0, abs=1e-9)
    normals = model.frame.normals
    out = model.frame.nodes[model.frame.members].mean(axis=1) * (1, 1, 0)
    assert np.einsum("mi,mi->m", normals, out).min() > 0


def test_cells_have_the_area_of_the_cylinder():
    model = facade_model(Facade(exponent=2.0, modules=96, storeys_per_row=1))
    total = np.linalg.norm(areas(model), axis=1).sum()
    assert total == pytest.approx(np.pi * 30 * 96, rel=1e-3)
    assert total < np.pi * 30 * 96


def test_a_net_moved_outward_everywhere_widens_a_round_tower():
    model = facade_model(ROUND, lifted(0, by=2.5))
    assert np.hypot(*model.frame.nodes[:, :2].T) == pytest.approx(17.5, abs=1e-9)


def test_a_net_closes_around_the_tower():
    """A shift of one row of points bulges out at its u and is smooth where u begins anew."""
    model = facade_model(Facade(exponent=2.0, modules=64), lifted(0, rows=0, by=4.0))
    radius = np.hypot(*model.frame.nodes[:, :2].T)
    angle = np.arctan2(model.frame.nodes[:, 1], model.frame.nodes[:, 0])
    order = np.argsort(angle)
    steps = np.abs(np.diff(radius[order], append=radius[order][0]))
    assert np.ptp(radius) > 2
    assert steps.max() < 0.2


def test_the_ground_is_hinged_and_the_core_holds_floors_sideways():
    frame = facade_model(Facade()).frame
    ground = frame.nodes[:, 2] == 0
    assert (frame.held[ground] == HINGED).all()
    assert ground.sum() == 24
    assert (frame.held[~ground] == [True, True, False, False, False, False]).all()
    assert "rigid" in facade_model(Facade()).notes[0]
    free = facade_model(Facade(core="none"))
    assert not free.frame.held[~ground].any()
    assert not free.notes


def test_a_tower_is_in_one_piece_and_its_own_mirror_image():
    model = facade_model(Facade(modules=8, storeys_per_row=2))
    start, end = model.frame.members.T
    count = len(model.frame.nodes)
    graph = coo_array((np.ones(len(start)), (start, end)), shape=(count, count))
    assert connected_components(graph, directed=False, return_labels=False) == 1

    def places(scale):
        nodes = np.round(model.frame.nodes * scale, 6) + 0.0
        return {tuple(sorted(map(tuple, pair))) for pair in nodes[model.frame.members].tolist()}

    assert places((1, 1, 1)) == places((-1, 1, 1)) == places((1, -1, 1))


def test_the_topology_stays_while_the_tower_changes():
    one, two = facade_model(Facade()), facade_model(Facade(width=50, twist=20), lifted(0))
    assert np.array_equal(one.frame.members, two.frame.members)
    assert topology_key(Facade()) == topology_key(Facade(width=50, twist=20))
    assert topology_key(Facade()) != topology_key(Facade(core="none"))


def test_storeys_that_do_not_fill_the_height_are_adjusted_and_said():
    model = facade_model(Facade(height=50.0, storey=4.0))
    assert model.frame.nodes[:, 2].max() == pytest.approx(50.0)
    assert any("4.167 m" in note for note in model.notes)


def test_a_plan_file_is_walked_by_its_length(tmp_path):
    """A rectangle of 30 × 20 m drawn clockwise: 20 modules of 5 m, outward normals."""
    path = tmp_path / "grundriß.csv"
    path.write_text("x,y\n-15,-10\n-15,10\n15,10\n15,-10\n-15,-10\n", encoding="utf-8")
    model = facade_model(Facade(plan_file=str(path), modules=20))
    ground = model.frame.nodes[model.frame.nodes[:, 2] == 0]
    assert ground[:3, :2] == pytest.approx(np.array([[-15, -10], [-10, -10], [-5, -10]]))
    vectors = areas(model)
    assert np.linalg.norm(vectors, axis=1).sum() <= 100 * 96
    assert vectors[:, :2].sum(axis=0) == pytest.approx(0.0, abs=1e-9)
    out = model.frame.nodes[model.frame.members].mean(axis=1) * (1, 1, 0)
    assert np.einsum("mi,mi->m", model.frame.normals, out).min() > 0


def test_a_concave_plan_is_taken(tmp_path):
    path = tmp_path / "l.csv"
    path.write_text("0,0\n30,0\n30,12\n12,12\n12,30\n0,30\n", encoding="utf-8")
    model = facade_model(Facade(plan_file=str(path), modules=60))
    assert np.linalg.norm(areas(model), axis=1).sum() == pytest.approx(120 * 96, rel=0.02)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0,0\n1,a\n1,1\n", "Row 2 of “plan.csv”"),
        ("x,y\n0,0\n1,0,5\n1,1\n", "Row 3 of “plan.csv”"),
        ("0,0\n1,nan\n1,1\n", "Row 2"),
        ("0,0\n1,0\n", "2 corners"),
        ("0,0\n1,1\n1,0\n0,1\n", "crosses"),
        ("0,0\n1,0\n1,0\n0,1\n", "point 1 twice"),
        ("0,0\n1,0\n2,0\n", "crosses or touches"),
    ],
)
def test_a_plan_that_is_none_is_refused(tmp_path, text, said):
    path = tmp_path / "plan.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileError, match=said):
        read_plan(path)
    with pytest.raises(FileError, match=r"no plan “lost\.csv”"):
        read_plan(tmp_path / "lost.csv")


def test_a_polygons_outward_direction_turns_evenly_from_corner_to_corner():
    plan = polygon(np.array([[0, 0], [10, 0], [10, 10], [0, 10.0]]))
    points, outward = plan.at(np.array([0.0, 0.125, 0.25]))
    assert points == pytest.approx(np.array([[0, 0], [5, 0], [10, 0.0]]))
    half = np.sqrt(0.5)
    assert outward == pytest.approx(np.array([[-half, -half], [0, -1], [half, -half]]))


FOLDED = {
    "drawn through the middle": lifted(0, rows=[0, 2], by=-28.0),
    "a storey above the next": lifted(2, columns=1, by=45.0),
    "along past its neighbours": lifted(1, rows=1, by=50.0),
}


@pytest.mark.parametrize("net", FOLDED.values(), ids=FOLDED.keys())
def test_a_folded_tower_is_refused(net):
    with pytest.raises(SceneError, match=r"near u = \d\.\d\d, v = .*control points back"):
        facade_model(Facade(height=24.0), net)
