"""Grid shells between two walls."""

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure.frame import FIXED, HINGED
from heliform.engines.structure.grid import Opening
from heliform.engines.structure.model import NO_NODE
from heliform.engines.structure.shell import Shell, shell_model, topology_key
from heliform.engines.structure.surface import net_of
from scipy.integrate import quad

PATTERNS = ("waffle", "diagonal", "triangulated")


def area_of(model):
    cells = np.where(model.cells == NO_NODE, model.cells[:, [2]], model.cells)
    a, b, c, d = np.moveaxis(model.frame.nodes[cells], 1, 0)
    return np.linalg.norm(np.cross(c - a, d - b), axis=1).sum() / 2


@pytest.mark.parametrize("pattern", PATTERNS)
def test_a_barrel_is_a_parabola_from_wall_to_wall(pattern):
    shell = Shell(pattern=pattern)
    x, y, z = shell_model(shell).frame.nodes.T
    assert z == pytest.approx(6 + 3 * (1 - (2 * y / 15) ** 2), abs=1e-12)
    assert np.ptp(x) == pytest.approx(24.0)
    assert np.ptp(y) == pytest.approx(15.0)


@pytest.mark.parametrize("pattern", PATTERNS)
def test_cells_have_the_area_of_the_barrel(pattern):
    arch, _ = quad(lambda y: np.hypot(1, 8 * 3 * y / 15**2), -7.5, 7.5)
    model = shell_model(Shell(pattern=pattern, spacing=0.5))
    assert area_of(model) == pytest.approx(24 * arch, rel=5e-4)
    assert area_of(model) < 24 * arch


def test_the_walls_hold_both_long_edges_and_the_arches_are_free():
    model = shell_model(Shell())
    x, y, z = model.frame.nodes.T
    held = model.frame.held.any(axis=1)
    assert np.array_equal(held, np.abs(np.abs(y) - 7.5) < 1e-9)
    assert held.sum() == 2 * 17  # 16 cells along
    assert (model.frame.held[held] == HINGED).all()
    assert (z[held] == 6.0).all()
    assert not held[(np.abs(x) > 11.9) & (np.abs(y) < 7.4)].any()
    fixed = shell_model(Shell(supports="fixed"))
    assert (fixed.frame.held[held] == FIXED).all()


def test_ends_may_rise_less_than_the_middle():
    x, y, z = shell_model(Shell(rise=4.0, rise_ends=1.0, spacing=0.75)).frame.nodes.T
    crown = 1 + 3 * (1 - (2 * x / 24) ** 2)
    assert z == pytest.approx(6 + crown * (1 - (2 * y / 15) ** 2), abs=1e-12)


def test_a_triangulated_shell_tells_its_diagonals_from_its_ribs():
    model = shell_model(Shell(pattern="triangulated", cells_along=8, cells_across=6))
    assert model.group_names == ("ribs", "diagonals")
    assert np.bincount(model.groups).tolist() == [8 * 7 + 6 * 9, 48]
    assert (model.cells[:, 3] == NO_NODE).all()
    assert len(model.cells) == 96
    assert not shell_model(Shell(pattern="diagonal")).groups.any()


@pytest.mark.parametrize("pattern", PATTERNS)
def test_normals_of_a_shell_point_up_and_out(pattern):
    model = shell_model(Shell(pattern=pattern))
    middles = model.frame.nodes[model.frame.members].mean(axis=1)
    y = model.surface[:, 1] * 15 - 7.5
    slope = np.column_stack([np.zeros_like(y), 8 * 3 * y / 15**2, np.ones_like(y)])
    truth = slope / np.linalg.norm(slope, axis=1, keepdims=True)
    assert model.frame.normals == pytest.approx(truth, abs=1e-12)
    assert middles[:, 1] == pytest.approx(y, abs=1e-9)


def test_control_points_move_the_shell_and_keep_its_topology():
    shifts = np.zeros((4, 4, 3))
    shifts[1:3, 1:3, 2] = 16 / 9
    plain, raised = shell_model(Shell()), shell_model(Shell(), net_of(shifts))
    lift = raised.frame.nodes - plain.frame.nodes
    middle = np.argmin(np.linalg.norm(plain.frame.nodes[:, :2], axis=1))
    assert lift[middle] == pytest.approx([0, 0, 1])
    assert np.array_equal(plain.frame.members, raised.frame.members)
    assert topology_key(Shell()) == topology_key(Shell(rise=5.0, height=0.0))
    assert topology_key(Shell()) != topology_key(Shell(spacing=1.0))


@pytest.mark.parametrize("pattern", ["waffle", "diagonal"])
def test_spacing_is_the_greatest_distance_between_parallel_ribs(pattern):
    """A parallelogram's area is a side times the distance of that side from the next."""
    flat = Shell(pattern=pattern, rise=0, rise_ends=0, length=21, span=20, spacing=1.3)
    model = shell_model(flat)
    quad_cells = model.cells[model.cells[:, 3] != NO_NODE]
    a, b, c, d = np.moveaxis(model.frame.nodes[quad_cells], 1, 0)
    area = np.linalg.norm(np.cross(c - a, d - b), axis=1) / 2
    for side in (b - a, c - b):
        apart = area / np.linalg.norm(side, axis=1)
        assert 1.15 < apart.min() <= apart.max() <= 1.3


def test_an_opening_in_a_shell_takes_no_support():
    model = shell_model(Shell(opening_2=Opening(size_u=0.4, size_v=0.4)))
    assert model.frame.held.any(axis=1).sum() == 34


def test_a_shell_that_folds_is_refused():
    shifts = np.zeros((4, 4, 3))
    shifts[:, 1, 1], shifts[:, 2, 1] = 30, -30
    with pytest.raises(SceneError, match="control points back"):
        shell_model(Shell(), net_of(shifts))
