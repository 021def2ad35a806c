"""The surface over control points: against geomdl, closed forms and invariants."""

import numpy as np
import pytest
from geomdl import BSpline
from heliform.engines.core.parameters import from_table, to_table
from heliform.engines.structure.surface import (
    Net,
    Shift,
    basis,
    evaluate,
    evaluate_at,
    flat_points,
    net_of,
    positions_at,
    shifts_of,
)

RNG = np.random.default_rng(11)
POINTS = flat_points(30, 20, 5) + RNG.uniform(-2, 2, (4, 4, 3))
PLACES = RNG.uniform(size=(40, 2))


def oracle(points, knots_u, knots_v):
    surface = BSpline.Surface()
    surface.degree_u = surface.degree_v = 3
    surface.ctrlpts2d = points.tolist()
    surface.knotvector_u, surface.knotvector_v = knots_u, knots_v
    return surface


def test_a_clamped_surface_and_its_derivatives_are_those_of_geomdl():
    clamped = [0.0] * 4 + [1.0] * 4
    surface = oracle(POINTS, clamped, clamped)
    for order in ((0, 0), (1, 0), (0, 1)):
        found = positions_at(POINTS, PLACES, orders=order)
        truth = [surface.derivatives(u, v, order=1)[order[0]][order[1]] for u, v in PLACES]
        assert found == pytest.approx(np.array(truth), abs=1e-11)


def test_a_closed_surface_is_the_unclamped_one_of_geomdl_with_its_points_repeated():
    """geomdl maps the knots of 7 unclamped points onto 0..1; the closed part is from 3 to 7."""
    around = np.concatenate([POINTS, POINTS[:3]])
    knots = (np.arange(11.0) / 10).tolist()
    surface = oracle(around, knots, [0.0] * 4 + [1.0] * 4)
    truth = [surface.evaluate_single((0.3 + 0.4 * u, v)) for u, v in PLACES]
    assert positions_at(POINTS, PLACES, closed=True) == pytest.approx(np.array(truth), abs=1e-11)


@pytest.mark.parametrize("closed", [False, True])
def test_a_basis_adds_up_to_one_and_its_derivative_to_nothing(closed):
    t = np.linspace(0, 1, 57)
    assert basis(t, closed=closed).sum(axis=1) == pytest.approx(1.0, abs=1e-14)
    assert basis(t, closed=closed, derivative=1).sum(axis=1) == pytest.approx(0.0, abs=1e-13)
    assert basis(t, closed=closed).min() >= 0


def test_a_closed_surface_goes_on_smoothly_where_it_meets_itself():
    v = np.linspace(0, 1, 5)
    for order in (0, 1, 2):
        ends = [
            positions_at(
                POINTS, np.column_stack([np.full(5, u), v]), closed=True, orders=(order, 0)
            )
            for u in (0.0, 1.0 - 1e-12)
        ]
        assert ends[0] == pytest.approx(ends[1], abs=1e-8)


def test_a_clamped_surface_passes_its_corners():
    found, _ = evaluate(POINTS, [0.0, 1.0], [0.0, 1.0])
    assert np.array_equal(found, POINTS[::3, ::3])


def test_derivatives_are_the_limit_of_differences():
    step = 1e-5
    inside = 0.1 + 0.8 * PLACES
    for order in ((1, 0), (0, 1)):
        ahead = positions_at(POINTS, inside + step * np.array(order))
        back = positions_at(POINTS, inside - step * np.array(order))
        assert positions_at(POINTS, inside, orders=order) == pytest.approx(
            (ahead - back) / (2 * step), rel=1e-6, abs=1e-6
        )


def test_normals_are_unit_and_perpendicular_to_the_surface():
    _, normals = evaluate_at(POINTS, PLACES)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-14)
    for order in ((1, 0), (0, 1)):
        along = positions_at(POINTS, PLACES, orders=order)
        assert np.einsum("mi,mi->m", normals, along) == pytest.approx(0.0, abs=1e-12)


def test_a_level_net_is_level_and_evenly_spaced():
    u, v = np.linspace(0, 1, 7), np.linspace(0, 1, 5)
    found, normals = evaluate(flat_points(30, 20, 5), u, v)
    assert found[..., 0] == pytest.approx(np.broadcast_to((u * 30 - 15)[:, None], (7, 5)))
    assert found[..., 1] == pytest.approx(np.broadcast_to(v * 20 - 10, (7, 5)))
    assert normals == pytest.approx(np.broadcast_to([0.0, 0.0, 1.0], normals.shape), abs=1e-14)


def test_many_surfaces_at_once_are_each_one_of_them():
    many = POINTS + RNG.uniform(-1, 1, (2, 5, 4, 4, 3))
    u, v = np.linspace(0, 1, 6), np.linspace(0, 1, 4)
    positions, normals = evaluate(many, u, v)
    assert positions.shape == normals.shape == (2, 5, 6, 4, 3)
    one = evaluate(many[1, 3], u, v)
    assert positions[1, 3] == pytest.approx(one[0], abs=1e-13)
    assert normals[1, 3] == pytest.approx(one[1], abs=1e-13)
    places = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    assert evaluate_at(many, places)[0].reshape(positions.shape) == pytest.approx(
        positions, abs=1e-12
    )


def test_a_surface_turns_with_its_points():
    turn = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    positions, normals = evaluate_at(POINTS, PLACES)
    assert evaluate_at(POINTS @ turn, PLACES)[0] == pytest.approx(positions @ turn, abs=1e-12)
    assert evaluate_at(POINTS @ turn, PLACES)[1] == pytest.approx(normals @ turn, abs=1e-12)


def test_a_point_without_surface_has_no_normal():
    _, normals = evaluate_at(np.zeros((4, 4, 3)), PLACES)
    assert not normals.any()


def test_a_net_holds_its_shifts_by_row_and_column():
    shifts = np.arange(48.0).reshape(4, 4, 3) / 10
    net = net_of(shifts)
    assert net.p21 == Shift(x=2.7, y=2.8, z=2.9)
    assert np.array_equal(shifts_of(net), shifts)
    assert from_table(Net, to_table(net), "structure.net") == net
    assert not shifts_of(Net()).any()
