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


def ball_caustic(size=128):
    """Light of a parallel beam behind a glass ball, 1.6 radii from its middle (rows, columns).

    Rays through the ball by their height h land at r(h); E = h dh ÷ (r dr), summed over the
    branches, on a map 0.6 radii wide.
    """
    ior, plane = 1.5, 1.6
    h = np.linspace(0, 0.98, 400_001)
    bent = 2 * (np.arcsin(h) - np.arcsin(h / ior))
    leave = np.arcsin(h) - bent
    r = np.sin(leave) - (plane - np.cos(leave)) * np.tan(bent)
    # Four by four places a texel, each looked up in narrow rings.
    fine = (np.arange(4 * size) + 0.5) / (4 * size) * 0.6 - 0.3
    rings = np.linspace(0, 0.45, 1500)
    flux = np.histogram(np.abs(r), rings, weights=h * (h[1] - h[0]))[0]
    light = flux / (np.diff(rings**2) / 2)
    at = np.hypot(fine[:, None], fine[None, :])
    found = np.interp(at, (rings[1:] + rings[:-1]) / 2, light)
    return found.reshape(size, 4, size, 4).mean(axis=(1, 3))


def sharp_shadow(size=128):
    """A disc's and a bar's shadows with sharp edges on an even field; a twentieth is left there."""
    y, x = np.mgrid[:size, :size] / size - 0.5
    dark = (np.hypot(x + 0.1, y) < 0.2) | (np.abs(x - 0.3 - 0.2 * y) < 0.04)
    return np.where(dark, 0.05, 1.0)


@pytest.mark.parametrize(
    ("field", "photons"),
    [(field, n) for field in (ball_caustic, sharp_shadow) for n in (0.5, 4, 32, 256)],
)
def test_noise_and_blur_together_hold_the_truth(field, photons):
    """In nine of ten bright texels, at ``photons`` a texel on the average, over several seeds."""
    truth = field()
    truth *= photons / truth.mean()
    bright = truth > 0.2 * truth.mean()
    held = []
    for seed in range(4):
        total, square = hits(truth, seed)
        found = smoothed(total, square)
        off = np.abs(found.value - 2 * truth)
        held.append((off <= found.half_width + found.bias)[bright].mean())
    assert np.mean(held) >= 0.9


@pytest.mark.parametrize("field", [ball_caustic, sharp_shadow])
def test_more_photons_let_more_be_gathered_and_err_less(field):
    truth = field()
    truth /= truth.mean()
    bright = truth > 0.2
    gathered, error = [], []
    for photons in (0.5, 8, 128):
        total, square = hits(photons * truth, 3)
        found = smoothed(total, square)
        gathered.append(found.gathered)
        off = (found.value / (2 * photons) - truth)[bright] / truth[bright]
        error.append(np.sqrt(np.mean(off**2)))
        raw = (total / (2 * photons) - truth)[bright] / truth[bright]
        assert error[-1] <= np.sqrt(np.mean(raw**2))
    if field is ball_caustic:
        assert gathered == sorted(gathered)
        assert gathered[-1] > gathered[0]
    assert error[0] > error[1] > error[2]


def test_without_a_kernel_the_texel_means_stay():
    scene = scenes.scene(
        scenes.glass(scenes.sphere(0.02, 4)),
        lamp=scenes.beam(1000.0, 0.038, scenes.at(z=0.05)),
        receiver=scenes.floor(0.04, 32, scenes.at(z=-0.03)),
    )
    none, adaptive = (
        scenes.traced(scene, PhotonTracing(until="landed", landed=40_000, kernel=k), seed=1)
        for k in ("none", "adaptive")
    )
    np.testing.assert_array_equal(none.smooth, none.illuminance)
    np.testing.assert_array_equal(none.smooth_half_width, none.half_width)
    assert none.smooth_bias.max() == 0.0
    assert "gathered" not in none.meta
    np.testing.assert_array_equal(none.illuminance, adaptive.illuminance)
    assert adaptive.meta["gathered"] > 0
    assert (adaptive.smooth != adaptive.illuminance).any()
