"""Shells that would buckle as a whole are braced where it helps, and stand."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.scene import Scene
from heliform.engines.structure.bracing import bracing_factors
from heliform.engines.structure.presets import PRESETS
from heliform.engines.structure.structure import size_structure

SHELL = PRESETS["shell"]
FREE = replace(SHELL, rules=replace(SHELL.rules, stability=0.0, modes=1))
BRACED = replace(SHELL, rules=replace(SHELL.rules, modes=1))


@pytest.fixture(scope="module")
def free():
    return size_structure(Scene(), FREE)


@pytest.fixture(scope="module")
def braced():
    return size_structure(Scene(), BRACED)


def test_members_that_suffice_one_by_one_let_the_whole_buckle_and_that_is_said(free):
    figures = free.figures()
    assert figures["failing"]["value"] == 0
    assert figures["buckling_factor"]["value"] < 0.5
    assert any("buckle" in note for note in free.meta["notes"])


def test_a_braced_shell_stands_at_the_factor_that_was_asked(braced):
    figures = braced.figures()
    assert figures["failing"]["value"] == 0
    assert figures["buckling_factor"]["value"] > 0.95 * SHELL.rules.stability


def test_bracing_weighs_less_than_making_every_member_as_tall(free, braced):
    tall = replace(FREE.rules.steel_range, height_low=braced.rows["height"].max())
    blunt = size_structure(Scene(), replace(FREE, rules=replace(FREE.rules, steel_range=tall)))
    masses = [one.figures()["mass"]["value"] for one in (free, braced, blunt)]
    assert masses == sorted(masses)


def test_factors_make_the_energy_grow_as_often_as_is_asked():
    rng = np.random.default_rng(3)
    energy, weight = rng.uniform(0, 5, 40), rng.uniform(1, 2, 40)
    for times in (1.1, 2.0, 30.0):
        factor = bracing_factors(energy, weight, times)
        assert factor.min() >= 1
        assert (factor * energy).sum() == pytest.approx(times * energy.sum(), rel=1e-9)
    np.testing.assert_array_equal(bracing_factors(energy, weight, 0.9), 1)
    np.testing.assert_array_equal(bracing_factors(0 * energy, weight, 2.0), 1)
