"""Few sizes for fabrication."""

import itertools

import numpy as np
import pytest
from heliform.engines.structure.assembly import pattern_of
from heliform.engines.structure.grouping import few_sizes, size_with_few
from heliform.engines.structure.member_checks import worst_of
from heliform.engines.structure.sizing import size_members

from .sized_roofs import TIMBER, mass_of, roof_task


def least_of(cost: np.ndarray, kept) -> float:
    return cost[:, list(kept)].min(axis=1).sum()


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_few_sizes_of_an_ordered_family_cost_what_the_best_do(seed, count):
    random = np.random.default_rng(seed)
    weight = np.sort(random.uniform(1, 10, 9))
    needed = random.uniform(1, 10, 40).clip(max=weight[-1])
    cost = np.where(weight[None] >= needed[:, None], weight[None], 1e6)
    best = min(least_of(cost, kept) for kept in itertools.combinations(range(9), count))
    found = few_sizes(cost, count)
    assert len(found) <= count
    assert least_of(cost, found) <= 1.02 * best


def test_as_many_sizes_as_there_are_cost_nothing_more():
    cost = np.random.default_rng(0).uniform(1, 2, (30, 6))
    assert least_of(cost, few_sizes(cost, 6)) == pytest.approx(cost.min(axis=1).sum())


def test_more_sizes_weigh_less_and_all_suffice():
    task = roof_task()
    pattern = pattern_of(task.frame)
    free = mass_of(task, size_members(task, pattern=pattern).sections)
    masses = []
    for count in (2, 8):
        chosen = size_with_few(task, count, pattern=pattern)
        assert len(np.unique(chosen.sections)) <= count
        assert worst_of(chosen.demand, task.pool, chosen.sections, task.rules).max() <= 1
        masses.append(mass_of(task, chosen.sections))
    assert masses[0] > masses[1] > 0.97 * free
    single = roof_task(per="all")
    assert masses[0] < mass_of(single, size_members(single).sections)


def test_each_material_keeps_its_few_sizes():
    task = roof_task(TIMBER)
    chosen = size_with_few(task, 3, pattern=pattern_of(task.frame))
    families = task.pool.family[chosen.sections]
    for family in (0, 1):
        assert 1 <= len(np.unique(chosen.sections[families == family])) <= 3
