"""The interval holds what it says: on simulated photons, and on traced ones over many seeds."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from heliform.engines.light import PhotonTracing, interval
from light import scenes
from scipy.stats import chi2

COVERAGE = Path(__file__).resolve().parents[2] / "bench" / "coverage.py"


def photons(expected, weights, cases, seed=5):
    """Σw and Σw² (expected, cases) of Poisson many photons, each with one of ``weights``."""
    random = np.random.default_rng(seed)
    share = np.asarray(expected)[:, None, None] / len(weights)
    counts = random.poisson(share, (len(expected), cases, len(weights)))
    return counts @ np.asarray(weights), counts @ np.square(weights)


# On simulated sums


@pytest.mark.parametrize("expected", [30.0, 60.0, 200.0, 5000.0])
def test_many_equal_photons_are_held_in_95_of_100_cases(expected):
    """Within 1 % of 0.95: the steps of a Poisson count allow no better, and 40,000 cases tell."""
    total, square = photons([expected], [0.3], 40_000)
    low, high = interval.interval(total, square, 0.3)
    assert np.mean((low <= 0.3 * expected) & (0.3 * expected <= high)) == pytest.approx(
        0.95, abs=0.01
    )


@pytest.mark.parametrize("expected", [0.5, 1.0, 3.0, 8.0, 15.0, 24.0])
def test_few_equal_photons_are_held_at_least_as_often(expected):
    total, square = photons([expected, 100.0], [0.3], 40_000)
    low, high = (bound[0] for bound in interval.interval(total, square, 0.3))
    held = (low <= 0.3 * expected) & (0.3 * expected <= high)
    assert np.mean(held) > 0.95 - 3 * np.sqrt(0.05 * 0.95 / 40_000)


@pytest.mark.parametrize("weights", [[0.5, 1.0, 1.5], [0.1, 1.0, 2.0], [1.0, 1.0, 1.0, 3.0]])
def test_photons_of_unequal_weight_are_held_too(weights):
    """A compound Poisson sum is skewed more than the interval knows: 1.5 % is given for that."""
    expected = np.array([60.0, 400.0])
    total, square = photons(expected, weights, 40_000)
    truth = (expected * np.mean(weights))[:, None]
    low, high = interval.interval(total, square, np.mean(weights))
    held = np.mean((low <= truth) & (truth <= high), axis=1)
    assert held == pytest.approx(0.95, abs=0.015)


def test_a_texel_without_a_hit_may_still_get_3_7_photons():
    """Garwood's bounds, of the map's mean weight where a texel has none of its own."""
    low, high = interval.interval(np.array([0.0, 8.0]), np.array([0.0, 16.0]), 2.0)
    assert low[0] == 0
    assert high[0] == pytest.approx(2.0 * chi2.ppf(0.975, 2) / 2)
    assert low[1] == pytest.approx(2.0 * chi2.ppf(0.025, 8) / 2)
    assert high[1] == pytest.approx(2.0 * chi2.ppf(0.975, 10) / 2)


def test_the_bounds_scale_with_the_light():
    total, square = photons([2.0, 20.0, 200.0], [0.5, 1.0], 50)
    low, high = interval.interval(total, square, 0.75)
    scaled = interval.interval(7 * total, 49 * square, 7 * 0.75)
    np.testing.assert_allclose(scaled, (7 * low, 7 * high))


def test_the_bounds_enclose_the_sum_and_join_where_few_become_many():
    """To a photon: Garwood's lower bound of 25 is 16.2, the score interval's 16.9."""
    count = np.linspace(0.01, 200, 20_000)
    low, high = interval.interval(count, count.copy(), 1.0)
    assert (low < count).all()
    assert (high > count).all()
    assert np.diff(low).max() < 1.0
    assert np.diff(high).min() > -1.0


def test_the_error_is_the_half_width_over_the_mean_where_there_is_light():
    """Texels of 100 and 400 hits count, one below 5 % of the mean does not."""
    count = np.array([100.0, 400.0, 5.0])
    expected = interval.Z * np.sqrt((1 / 100 + 1 / 400) / 2)
    assert interval.error(3 * count, 9 * count) == pytest.approx(expected)
    assert interval.error(np.zeros(4), np.zeros(4)) == np.inf


# On traced photons


@pytest.fixture(scope="module")
def ball():
    mesh = scenes.sphere(0.03, 4)
    shift = np.eye(4)
    shift[2, 3] = 0.05
    lamp = scenes.beam(1000.0, 0.08, scenes.at(z=0.2))
    return scenes.scene(scenes.glass(mesh.moved(shift)), lamp=lamp, receiver=scenes.floor(0.2, 48))


def test_the_same_seed_gives_the_same_map(ball):
    """To 1e-4 of the brightest texel; another seed gives another."""
    settings = PhotonTracing(until="landed", landed=200_000)
    first, again, other = (scenes.traced(ball, settings, seed=seed) for seed in (4, 4, 5))
    assert first.meta["photons"] == again.meta["photons"]
    for name in ("illuminance", "caustic", "lower", "upper"):
        found, repeated = getattr(first, name), getattr(again, name)
        assert np.abs(found - repeated).max() < 1e-4 * found.max()
    assert np.abs(first.caustic - other.caustic).max() > 1e-2 * first.caustic.max()


def test_the_photons_of_two_seeds_are_independent(ball):
    """The difference of two runs has twice the variance of one: Σw² says so to 10 %.

    Some 700 texels of 25 hits or more let the ratio vary by 5 %.
    """
    settings = PhotonTracing(until="landed", landed=400_000)
    first, other = (scenes.traced(ball, settings, seed=seed) for seed in (6, 7))
    photon = first.caustic.sum() / first.meta["photons"]["landed"]
    mean = (first.caustic + other.caustic) / 2
    many = mean > 25 * photon
    ratio = np.square(first.caustic - other.caustic)[many] / (2 * photon * mean[many])
    assert ratio.mean() == pytest.approx(1.0, abs=3 * np.sqrt(2 / many.sum()))


def check(figures, slack):
    """93 to 97 % where there are many hits, at least 95 % below the upper bound elsewhere."""
    assert 0.93 - slack < figures["many"]["within"] < 0.97 + slack
    assert figures["few"]["below_upper"] > 0.95 - slack


def test_traced_light_is_held_after_an_automatic_stop():
    """6000 cases of many hits: 95 % come out between 94.2 and 95.8 % (three deviations)."""
    figures = runpy.run_path(str(COVERAGE))["measure"](30, 24, 0.3, references=30)
    assert figures["many"]["cases"] > 5000
    check(figures, slack=0.0)


@pytest.mark.slow
def test_traced_light_is_held_over_200_seeds():
    figures = runpy.run_path(str(COVERAGE))["measure"](200, 64, 0.3)
    check(figures, slack=0.0)
    for row in figures["classes"]:
        assert row["below_upper"] > 0.95
