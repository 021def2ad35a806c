"""The frame's geometry by closed forms, and the search's confidence by counting."""

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.scan.frame import Frame, fit_frame
from heliform.engines.scan.search import find_layers
from heliform.engines.scan.unroll import Face, cells_of
from scipy.spatial.transform import Rotation


def _frame(radius: float, seed: int) -> Frame:
    rng = np.random.default_rng(seed)
    axes = Rotation.random(random_state=np.random.RandomState(seed)).as_matrix()
    return Frame(rng.normal(size=3), axes, 1 / radius if radius else 0.0, 0.008, 0.0)


@pytest.mark.parametrize("radius", [0.0, 0.05, 0.1, 10.0, 1e6])
def test_rolling_up_undoes_unrolling(radius):
    frame, rng = _frame(radius, 4), np.random.default_rng(0)
    arc, z = rng.uniform(-0.04, 0.04, (2, 1000))
    out = rng.uniform(-0.01, 0.002, 1000)
    again = frame.unrolled(frame.rolled(arc, out, z))
    for found, true in zip(again, (arc, out, z), strict=True):
        np.testing.assert_allclose(found, true, atol=1e-12)


def test_a_nearly_flat_cylinder_is_the_plane():
    flat, bent = _frame(0.0, 1), _frame(1e9, 1)
    points = np.random.default_rng(2).uniform(-0.05, 0.05, (100, 3)) + flat.origin
    for one, two in zip(flat.unrolled(points), bent.unrolled(points), strict=True):
        np.testing.assert_allclose(one, two, atol=1e-10)


def test_a_quarter_turn_is_a_quarter_of_the_girth():
    frame = Frame(np.array([0.1, 0.0, 0.0]), np.eye(3), 10.0, 0.0, 0.0)
    arc, out, z = frame.unrolled(np.array([[0.0, 0.12, 0.03]]))
    assert arc[0] == pytest.approx(np.pi / 2 * 0.1)
    assert out[0] == pytest.approx(0.02)
    assert z[0] == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("radius", "turned"), [(0.104, 40), (0.104, 15), (0.03, 90), (0.03, 180), (0.05, 350)]
)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_wall_is_found_from_any_side(radius, turned, seed):
    rng = np.random.default_rng(seed)
    angle = np.radians(rng.uniform(-turned / 2, turned / 2, 40_000))
    z = rng.uniform(-0.025, 0.025, 40_000)
    across = np.where(rng.random(40_000) < 0.5, radius, radius - 0.007)
    across = across + rng.normal(0, 0.05e-3, 40_000)
    points = np.column_stack([across * np.cos(angle), across * np.sin(angle), z])
    points[:200] = rng.uniform(-0.1, 0.1, (200, 3))
    turn = Rotation.random(random_state=np.random.RandomState(seed)).as_matrix()
    found = fit_frame(points @ turn.T + [1.0, 2.0, 3.0])
    lean = np.degrees(np.arcsin(np.linalg.norm(np.cross(found.axes[2], turn[:, 2]))))
    assert lean < 0.3
    assert found.radius == pytest.approx(radius, rel=0.03)
    assert found.thickness == pytest.approx(0.007, abs=0.05e-3)
    assert np.linalg.det(found.axes) == pytest.approx(1)


def _noisy(seed: int, wave: float) -> Face:
    """White noise and a wave of 5 mm, so many times as high as the noise."""
    rng = np.random.default_rng(seed)
    arc, z = rng.uniform(-0.03, 0.03, 20_000), rng.uniform(-0.02, 0.02, 20_000)
    height = 1e-4 * (rng.normal(size=20_000) + wave * np.sin(2 * np.pi * z / 5e-3))
    return Face(False, np.zeros((20_000, 3)), arc, z, height)


def test_confidence_is_what_it_says_where_there_is_nothing():
    """Of 60 pieces without layers, 1 − c should be as surely above c; three sigmas of room."""
    sure = 0
    for seed in range(60):
        try:
            find_layers(cells_of(_noisy(seed, 0.0), 0.6e-3), 1.5e-3, 15e-3, 0.8)
            sure += 1
        except SceneError:
            pass
    assert sure <= 0.2 * 60 + 3 * np.sqrt(60 * 0.2 * 0.8)


@pytest.mark.parametrize("seed", range(5))
def test_layers_far_below_the_noise_are_found(seed):
    found = find_layers(cells_of(_noisy(seed, 0.2), 0.6e-3), 1.5e-3, 15e-3, 0.99)
    assert found.period == pytest.approx(5e-3, rel=0.02)
    assert found.confidence > 0.99
