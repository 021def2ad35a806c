"""Wind on closed prisms: resultants by their silhouettes, and the walls of EN 1991-1-4."""

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.structure.tributary import tributary_of
from heliform.engines.structure.wind import WINDS, wind_pressures
from structure.waffles import model, prism, waffle


def resultant(tributary, pressures):
    return (pressures * tributary.areas[:, None]).sum(axis=0)


def house(depth, breadth, height, parts=10):
    """Four vertical walls of ``parts`` × 1 faces, depth along x and breadth along y."""
    corners = np.array([[0, 0], [depth, 0], [depth, breadth], [0, breadth]])
    steps = np.arange(parts)[:, None] / parts
    plan = np.concatenate(
        [a + steps * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    )
    count = len(plan)
    nodes = np.concatenate([np.column_stack([plan, np.full(count, z)]) for z in (0.0, height)])
    at = np.arange(count)
    after = np.roll(at, -1)
    cells = np.stack([at, after, after + count, at + count], -1)
    return model(
        nodes, np.stack([at, at + count], -1), cells, normals=np.tile([1, 1, 0.0], (count, 1))
    )


@pytest.mark.parametrize("name", WINDS)
@pytest.mark.parametrize("sides", [4, 7, 12])
def test_drag_is_the_pressure_on_the_silhouette_of_a_convex_prism(name, sides):
    made = prism(sides)
    wind = WINDS[name]
    tributary = tributary_of(made.frame, made.cells)
    silhouette = np.ptp(made.frame.nodes @ np.cross(wind, [0, 0, 1])) * 12.0
    found = resultant(tributary, wind_pressures(tributary, wind, 2500.0, "drag"))
    assert found == pytest.approx(2500.0 * silhouette * wind, rel=1e-12, abs=1e-6)


def test_pressure_on_normals_pushes_a_cylinder_by_a_quarter_of_pi_of_its_silhouette():
    made = prism(720, storeys=1)
    tributary = tributary_of(made.frame, made.cells)
    found = resultant(tributary, wind_pressures(tributary, WINDS["+y"], 1.0, "normal"))
    # ∫ cos² θ dθ over the windward half is π/2, against 2 for the silhouette.
    assert found == pytest.approx([0, np.pi / 2 * 5.0 * 4.0, 0], rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("method", ["drag", "normal"])
def test_faces_in_the_lee_and_beside_the_wind_take_nothing(method):
    made = prism()
    tributary = tributary_of(made.frame, made.cells)
    pressures = wind_pressures(tributary, WINDS["-x"], 100.0, method)
    sheltered = tributary.normals @ WINDS["-x"] >= -1e-12
    assert np.abs(pressures[sheltered]).max() < 1e-9
    assert (np.linalg.norm(pressures[~sheltered], axis=1) > 0).all()


def test_opposite_winds_push_a_symmetric_prism_alike():
    made = prism(8)
    tributary = tributary_of(made.frame, made.cells)
    there, back = (
        resultant(tributary, wind_pressures(tributary, WINDS[name], 700.0, "normal"))
        for name in ("+x", "-x")
    )
    assert there == pytest.approx(-back, abs=1e-8)


@pytest.mark.parametrize(
    ("height", "windward", "leeward"),
    [
        (4.0, 0.7, -0.3),
        (20.0, 0.8, -0.5),
        (100.0, 0.8, -0.7),
        (12.5, 0.75, -0.4),
        (200.0, 0.8, -0.7),
    ],
)
def test_walls_take_the_coefficients_of_table_7_1(height, windward, leeward):
    made = house(20.0, 20.0, height)
    tributary = tributary_of(made.frame, made.cells)
    pressures = wind_pressures(tributary, WINDS["+x"], 1000.0, "walls")
    inward = -np.einsum("fi,fi->f", pressures, tributary.normals) / 1000.0
    assert inward[tributary.normals[:, 0] < -0.9] == pytest.approx(np.full(10, windward))
    assert inward[tributary.normals[:, 0] > 0.9] == pytest.approx(np.full(10, leeward))


def test_side_walls_have_zones_a_to_c_behind_the_windward_edge():
    made = house(30.0, 20.0, 5.0, parts=60)  # e = 2 h = 10: A to 2 m, B to 10 m, C behind
    tributary = tributary_of(made.frame, made.cells)
    pressures = wind_pressures(tributary, WINDS["+x"], 1.0, "walls")
    side = tributary.normals[:, 1] > 0.9
    outward = np.einsum("fi,fi->f", pressures, tributary.normals)[side]
    order = np.argsort(tributary.centres[side, 0])
    assert outward[order] == pytest.approx([1.2] * 4 + [0.8] * 16 + [0.5] * 40)


def test_walls_are_refused_on_a_roof():
    made = waffle()
    tributary = tributary_of(made.frame, made.cells)
    with pytest.raises(ParameterError, match="cell 0 leans by 90°"):
        wind_pressures(tributary, WINDS["+x"], 1.0, "walls")
