"""Force densities: shapes in equilibrium, against closed forms and against the frame."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure.form_finding import FormFinding, formed, found_form, solve_net
from heliform.engines.structure.frame import FIXED, Rigidities
from heliform.engines.structure.joints import node_normals
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.loads import Loads
from structure.waffles import model, waffle


def chain(count=20, length=10.0):
    """A row of members between two supports, without cells."""
    nodes = np.column_stack([np.linspace(0, length, count + 1), np.zeros((count + 1, 2))])
    at = np.arange(count)
    return model(nodes, np.stack([at, at + 1], -1), [], held=(0, count))


def residual(form, members):
    """Σ q (neighbour − node) + force at every node (N, 3) in N."""
    start, end = members[form.branches].T
    pull = form.densities[:, None] * (form.nodes[end] - form.nodes[start])
    total = form.forces.copy()
    np.add.at(total, start, pull)
    np.add.at(total, end, -pull)
    return total


def test_a_net_of_four_cables_lifts_its_middle_by_p_over_the_sum_of_densities():
    corners = np.array([[0, 0, 0], [4, 0, 1], [4, 6, 0], [0, 6, 1], [1, 1, 9.0]])
    members = np.array([[0, 4], [1, 4], [2, 4], [3, 4]])
    fixed = np.array([True] * 4 + [False])
    forces = np.zeros((5, 3))
    forces[4] = [0.0, 0.0, 3.0]
    found = solve_net(corners, members, np.full(4, 2.0), fixed, forces)
    assert found[4] == pytest.approx([2.0, 3.0, 0.5 + 3.0 / 8.0])
    weighed = solve_net(corners, members, np.array([1.0, 2, 3, 4]), fixed, 0 * forces)
    assert weighed[4] == pytest.approx([0.1 * (8 + 12), 0.1 * (18 + 24), 0.1 * (2 + 4)])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_even_load_in_plan_makes_a_parabola(sign):
    made = chain(20)
    members, fixed = made.frame.members, made.frame.held[:, 0]
    load, thrust = 3.0, 15.0  # N per m in plan, and N
    forces = np.zeros((21, 3))
    forces[:, 2] = load * 0.5
    density = np.full(20, sign * thrust / 0.5)
    found = solve_net(made.frame.nodes, members, density, fixed, forces)
    x = found[:, 0]
    assert x == pytest.approx(made.frame.nodes[:, 0])
    # f = w L² / 8 H
    rise = sign * load * 10.0**2 / (8 * thrust)
    assert found[:, 2] == pytest.approx(4 * rise * x * (10 - x) / 100, abs=1e-12)


def test_a_chain_under_its_own_weight_hangs_in_a_catenary():
    form = found_form(
        chain(400), FormFinding(shape="hanging", rise=3.0, held="supports", load="members")
    )
    x, _, z = form.nodes.T
    # z = c cosh(x / c), whose sag of 3 m over 10 m gives c; the tension at the bottom is w c.
    low, high = 1.0, 100.0
    for _ in range(200):
        c = (low + high) / 2
        low, high = (c, high) if c * (np.cosh(5 / c) - 1) > 3.0 else (low, c)
    assert z == pytest.approx(c * np.cosh((x - 5) / c) - c - 3.0, abs=2e-4)
    tension = form.densities * np.linalg.norm(np.diff(form.nodes, axis=0), axis=1)
    assert tension.min() == pytest.approx(c, rel=1e-3)


@pytest.mark.parametrize("load", ["plan", "surface", "members"])
@pytest.mark.parametrize("held", ["edges", "supports"])
@pytest.mark.parametrize("shape", ["standing", "hanging"])
def test_every_free_node_is_in_equilibrium(shape, held, load):
    made = waffle(9, 6, height=lambda x, y: 5 + 0.03 * x + 0.02 * x * y / 10)
    record = FormFinding(shape=shape, rise=2.5, along=2.0, edge=4.0, held=held, load=load)
    form = found_form(made, record)
    left = residual(form, made.frame.members)[~form.fixed]
    assert np.abs(left).max() <= 1e-10 * np.abs(form.forces).sum()
    assert (np.sign(form.densities) == (-1 if shape == "standing" else 1)).all()
    slack = found_form(made, replace(record, rise=1e-3))
    assert np.abs(form.nodes - slack.nodes)[:, 2].max() == pytest.approx(2.5, abs=2e-3)


def test_loads_of_the_surface_outweigh_those_of_the_plan():
    made = waffle(8, 8, 10.0, 10.0)
    plan, surface = (
        found_form(made, FormFinding(shape="standing", rise=4.0, load=load))
        for load in ("plan", "surface")
    )
    assert -plan.forces[:, 2].sum() == pytest.approx(100.0, rel=1e-12)
    assert -surface.forces[:, 2].sum() > 110.0


def test_a_symmetric_net_stays_symmetric():
    made = waffle(8, 6, 16.0, 12.0)
    form = found_form(made, FormFinding(shape="standing", rise=3.0, held="supports", edge=5.0))
    grid = form.nodes.reshape(9, 7, 3)
    assert grid[::-1, :, 2] == pytest.approx(grid[..., 2], abs=1e-12)
    assert grid[:, ::-1, 1] == pytest.approx(12 - grid[..., 1], abs=1e-11)
    # Free edges draw in between their corners.
    assert grid[4, 0, 1] > 0.1


def test_a_funicular_frame_carries_its_load_without_bending():
    made = waffle(6, 6, 12.0, 12.0)
    made = replace(made, frame=replace(made.frame, held=made.frame.held & False))
    edge = (made.frame.nodes[:, :2] % 12.0 == 0).any(axis=1)
    held = np.zeros_like(made.frame.held)
    held[edge] = FIXED
    made = replace(made, frame=replace(made.frame, held=held))
    record = FormFinding(shape="standing", rise=3.0)
    form = found_form(made, record)
    frame = formed(made, record).frame
    count = len(frame.members)
    thin = np.full(count, 1.0)
    rigidities = Rigidities(
        np.full(count, 1e9), thin, thin, thin, thin * np.inf, thin * np.inf, 0 * thin, 0 * thin
    )
    nodal = np.zeros((1, len(frame.nodes), 6))
    nodal[0, :, :3] = form.forces
    loads = Loads(("load",), ("imposed",), np.zeros((1, 3)), nodal, np.zeros((1, count, 2, 3)))
    response = solve_frame(frame, rigidities, loads)
    forces = response.forces(np.array([0.0, 1.0]))[0]
    free = ~form.fixed[frame.members].all(axis=1)
    axial = (form.densities * frame.lengths()[form.branches])[free]
    assert forces[free][:, 0, 0] == pytest.approx(axial, rel=1e-4)
    assert np.abs(forces[free][..., 4:]).max() < 1e-6 * np.abs(axial).max()


def test_members_turn_with_the_surface_and_keep_their_roll():
    made = waffle(8, 8, 10.0, 10.0)
    roll = 0.4
    local = made.frame.axes()
    turned = np.cos(roll) * local[:, 2] + np.sin(roll) * local[:, 1]
    made = replace(made, frame=replace(made.frame, normals=turned))
    found = formed(made, FormFinding(shape="standing", rise=3.0))
    up = node_normals(found.frame, made.cells)[found.frame.members].sum(axis=1)
    surface = replace(found.frame, normals=up).axes()
    z = found.frame.axes()[:, 2]
    assert np.einsum("mi,mi->m", z, surface[:, 2]) == pytest.approx(np.cos(roll))
    assert np.einsum("mi,mi->m", z, surface[:, 1]) == pytest.approx(np.sin(roll))


def test_columns_hold_the_net_and_stay():
    flat = waffle(6, 6, 12.0, 12.0)
    nodes = np.concatenate([flat.frame.nodes, [[6, 6, -4.0]]])
    members = np.concatenate([flat.frame.members, [[49, 24]]])
    normals = np.concatenate([flat.frame.normals, [[1.0, 0, 0]]])
    made = model(nodes, members, flat.cells, normals, held=(49,))
    surface = made.surface.copy()
    surface[-1] = np.nan
    made = replace(made, surface=surface)
    found = formed(made, FormFinding(shape="standing", rise=2.0))
    assert found.frame.nodes[[24, 49]] == pytest.approx(nodes[[24, 49]])
    assert found.frame.nodes[:, 2].max() == pytest.approx(2.0)
    assert found.frame.normals[-1] == pytest.approx([1, 0, 0])


def test_a_drawn_shape_stays_as_it_is():
    made = waffle()
    assert formed(made, FormFinding()) is made


def test_a_net_held_nowhere_is_refused():
    made = waffle()
    loose = replace(made, frame=replace(made.frame, held=made.frame.held & False))
    with pytest.raises(SceneError, match="held nowhere"):
        found_form(loose, FormFinding(shape="standing", held="supports"))


def test_a_net_without_a_free_node_is_refused():
    with pytest.raises(SceneError, match="Every node of the net is held"):
        found_form(waffle(1, 1), FormFinding(shape="standing"))


def test_area_loads_without_cells_are_refused():
    with pytest.raises(SceneError, match="no cells for its load"):
        found_form(chain(), FormFinding(shape="hanging", held="supports"))


def test_an_upright_surface_is_not_bent_by_a_load_in_plan():
    flat = waffle(4, 4)
    upright = replace(flat.frame, nodes=flat.frame.nodes[:, [0, 2, 1]])
    with pytest.raises(SceneError, match="does not bend the net"):
        found_form(replace(flat, frame=upright), FormFinding(shape="standing"))
