"""The base curve: size, spacing, normals and curvature."""

import numpy as np
import pytest
from heliform.engines.glass.base import base_curve
from scipy.spatial import KDTree

SHAPES = [(0.2, 0.2, 0, 0.1), (0.262, 0.283, 3, 0.1), (0.231, 0.245, 4, 0.08), (0.3, 0.2, 1, 0.3)]


@pytest.mark.parametrize("shape", SHAPES)
def test_a_curve_has_its_size_even_spacing_and_right_normals(shape):
    curve = base_curve(*shape, 4000)
    assert np.ptp(curve.points, axis=0) == pytest.approx(shape[:2], abs=1e-6)
    chord = np.roll(curve.points, -1, axis=0) - curve.points
    step = np.hypot(*chord.T)
    assert step == pytest.approx(curve.length / 4000, rel=1e-4)
    assert np.hypot(*curve.normals.T) == pytest.approx(1)
    tangent = (chord + np.roll(chord, 1, axis=0)) / (2 * step[:, None])
    assert np.abs(np.einsum("ij,ij->i", tangent, curve.normals)).max() < 1e-4
    assert (np.einsum("ij,ij->i", curve.points, curve.normals) > 0).all()


@pytest.mark.parametrize("shape", SHAPES)
def test_curvature_turns_once_around(shape):
    curve = base_curve(*shape, 4000)
    assert curve.curvature.mean() * curve.length == pytest.approx(2 * np.pi, rel=1e-5)


def test_a_tube_is_a_circle_and_a_stretched_one_an_ellipse():
    assert base_curve(0.2, 0.2, 0, 0.3, 64).curvature == pytest.approx(10)
    assert base_curve(0.4, 0.2, 0, 0.3, 64).curvature.max() == pytest.approx(0.2 / 0.1**2, rel=1e-6)
    assert base_curve(0.4, 0.2, 0, 0.3, 5).bend == pytest.approx(0.1**2 / 0.2)


@pytest.mark.parametrize("lobes", [1, 2, 3, 4, 6, 12])
@pytest.mark.parametrize("stretch", [0.1, 0.7, 1.0, 1.4, 10.0])
def test_a_wall_thinner_than_the_tightest_bend_meets_itself_nowhere(lobes, stretch):
    for lobe in (0.02, 0.1, 0.3):
        curve = base_curve(1.0, stretch, lobes, lobe, 8000)
        wall = 0.99 * curve.bend
        apart, _ = KDTree(curve.points).query(curve.points - wall * curve.normals)
        assert apart == pytest.approx(wall, abs=curve.length / 8000)
