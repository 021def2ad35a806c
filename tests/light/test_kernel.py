"""The smooth map: what it keeps, what it removes, and what it must not touch."""

import numpy as np
import pytest
from heliform.engines.light import PhotonTracing
from heliform.engines.light.kernel import smoothed
from light import scenes


def hits(mean, seed=1):
    """A tally of photons of weight 2 with Poisson counts around ``mean`` (rows, columns)."""
    count = np.random.default_rng(seed).poisson(mean).astype(float)
    return 2.0 * count, 4.0 * count


def test_an_even_field_loses_its_noise_and_keeps_its_sum():
    mean = np.full((96, 128), 3.0)
    total, square = hits(mean)
    result = smoothed(total, square, gather=100).value
    assert result.sum() == pytest.approx(total.sum(), rel=0.01)
    assert (result / 6.0).std() == pytest.approx(0.1, abs=0.03)
    assert (total / 6.0).std() > 0.5


def test_well_lit_texels_stay_as_they_are():
    total, square = hits(np.full((32, 32), 1000.0))
    np.testing.assert_array_equal(smoothed(total, square, gather=100).value, total)


def test_a_sharp_line_stays_sharp_where_it_is_bright():
    mean = np.full((64, 64), 0.5)
    mean[:, 32] = 400.0
    total, square = hits(mean)
    result = smoothed(total, square, gather=100).value
    np.testing.assert_array_equal(result[:, 32], total[:, 32])


def test_an_empty_tally_stays_empty():
    empty = np.zeros((16, 16))
    np.testing.assert_array_equal(smoothed(empty, empty).value, empty)


def test_fewer_photons_than_asked_spread_over_the_widest_kernel():
    total, square = np.zeros((64, 64)), np.zeros((64, 64))
    total[10, 10], square[10, 10] = 2.0, 4.0
    result = smoothed(total, square).value
    assert np.isfinite(result).all()
    assert (result >= 0).all()
    assert result.sum() == pytest.approx(2.0, rel=0.1)


def test_it_is_nearer_to_the_truth_than_the_raw_map_of_the_same_photons():
    ball = scenes.glass(scenes.sphere(0.02, 5))
    scene = scenes.scene(
        ball,
        lamp=scenes.beam(1000.0, 0.038, scenes.at(z=0.05)),
        receiver=scenes.floor(0.04, 64, scenes.at(z=-0.03)),
    )
    truth = scenes.traced(
        scene, PhotonTracing(until="landed", landed=8_000_000), seed=1
    ).illuminance
    few = scenes.traced(scene, PhotonTracing(until="landed", landed=60_000), seed=2)

    def distance(found):
        counted = truth > 0.05 * truth.mean()
        return np.sqrt(np.mean((found[counted] / truth[counted] - 1) ** 2))

    assert distance(few.smooth) < 0.5 * distance(few.illuminance)
