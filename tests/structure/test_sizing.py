"""Sizing: the first sufficient section, found fast, and a loop that ends where it should."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import Cancelled, ParameterError
from heliform.engines.structure.assembly import pattern_of
from heliform.engines.structure.candidates import menu_of, pool_of
from heliform.engines.structure.catalogue import FAMILIES, load_family
from heliform.engines.structure.choosing import no_bounds, places_from, wanted_places
from heliform.engines.structure.combinations import CombinationRules
from heliform.engines.structure.deflection import DeflectionLimits
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.member_checks import check_members, worst_of
from heliform.engines.structure.search import NONE, first_sufficient
from heliform.engines.structure.service import service_of, size_stiff
from heliform.engines.structure.sizing import demand_of, rigidities_for, size_members

from .sized_roofs import TIMBER, beam_task, mass_of, roof_task


@pytest.mark.parametrize("name", FAMILIES)
def test_chains_hold_every_section_once_and_grow(name):
    pool = pool_of([load_family(name)])
    menu = menu_of(pool, np.arange(len(pool.family)))
    places = np.concatenate(menu.chains)
    assert np.array_equal(np.sort(places), np.arange(len(menu.order)))
    for chain in menu.chains:
        sections = pool.sections.take(menu.order[chain])
        assert (np.diff(chain) > 0).all()
        for grows in ("area", "inertia_y", "inertia_z", "elastic_y", "plastic_z", "torsion"):
            values = getattr(sections, grows)
            assert (np.diff(values) >= -1e-9 * values[1:]).all()


def test_a_range_of_heights_and_widths_is_a_chain_for_each_width():
    pool = pool_of([load_family("thesis-steel")])
    menu = menu_of(pool, np.arange(len(pool.family)))
    assert [len(chain) for chain in menu.chains] == [40, 40, 40, 40]


@pytest.mark.parametrize("name", ["thesis-steel", "rhs", "timber"])
@pytest.mark.parametrize("begin", ["middle", "first", "last", "random"])
def test_the_search_finds_what_a_scan_finds(name, begin):
    pool = pool_of([load_family(name)])
    menu = menu_of(pool, np.arange(len(pool.family)))
    random = np.random.default_rng(5)
    strength = np.stack([pool.sections.elastic_y, pool.sections.elastic_z], axis=1)[menu.order]
    needed = np.exp(random.uniform(np.log(strength.min(0) / 2), np.log(strength.max(0)), (300, 2)))
    holds = (strength[None] >= needed[:, None]).all(axis=2)
    scanned = np.where(holds.any(axis=1), holds.argmax(axis=1), NONE)
    count = len(menu.order)
    starts = {"middle": count // 2, "first": 0, "last": count - 1, "random": 0}
    current = np.full(300, starts[begin])
    if begin == "random":
        current = random.integers(0, count, 300)
    asked = []

    def suffices(slots, places):
        asked.append(len(slots))
        return holds[slots, places]

    found = first_sufficient(menu, np.arange(300), current, suffices)
    assert np.array_equal(found, scanned)
    assert sum(asked) < 0.4 * holds.size


def test_a_search_from_the_answer_asks_little():
    pool = pool_of([load_family("thesis-steel")])
    menu = menu_of(pool, np.arange(len(pool.family)))
    strength = pool.sections.elastic_y[menu.order]
    needed = np.linspace(strength.min(), strength.max(), 100)
    answer = (strength[None] >= needed[:, None]).argmax(axis=1)
    asked = []

    def suffices(slots, places):
        asked.append(len(slots))
        return strength[places] >= needed[slots]

    assert np.array_equal(first_sufficient(menu, np.arange(100), answer, suffices), answer)
    assert sum(asked) <= 100 * 5  # itself, the one before, and the end of three other chains


def test_a_thorough_search_finds_what_only_a_smaller_section_does():
    pool = pool_of([load_family("ipe")])
    menu = menu_of(pool, np.arange(len(pool.family)))

    def suffices(slots, places):
        return places == 3

    def found(thorough):
        slots, current = np.arange(2), np.array([9, 9])
        return first_sufficient(menu, slots, current, suffices, thorough=thorough).tolist()

    assert found(False) == [NONE, NONE]
    assert found(True) == [3, 3]


def test_a_simple_beam_gets_the_section_that_its_moment_asks_for():
    load, length = 30e3, 6.0
    task = beam_task(load, length)
    chosen = size_members(task)
    strength = 235e6
    steel = task.menus[0].order
    needed = load * length**2 / 8 / strength
    sections = task.pool.sections.take(steel)
    # Halves of the boxes' area carry shear along their height, as their shear area says.
    shear = load * length / 2 / (sections.shear_z * strength / np.sqrt(3))
    enough = (sections.elastic_y >= needed) & (shear <= 1)
    assert chosen.sections.tolist() == [steel[enough.argmax()]]
    assert chosen.changes[-1] == 0
    used = worst_of(chosen.demand, task.pool, chosen.sections, task.rules)
    assert used == pytest.approx(needed / task.pool.sections.elastic_y[chosen.sections], rel=1e-9)


def test_a_beam_by_eurocode_uses_what_its_formulas_say():
    rules = {"steel": "ipe", "steel_grade": "S235", "stations": 9}
    combinations = CombinationRules(rule="eurocode")
    task = beam_task(3000.0, 10.0, mode="eurocode", combinations=combinations, **rules)
    ipe = np.array([task.pool.families[0].index("IPE 300")])
    demand, _ = demand_of(task, ipe, pattern_of(task.frame))
    checked = check_members(demand, task.pool, ipe, task.rules)
    names = [name.partition(",")[0] for name in checked.names]
    used = dict(zip(names, checked.utilisation[:, 0].tolist(), strict=True))
    # Tables: I_z 603.8 cm⁴, I_t 20.12 cm⁴, I_w 125 900 cm⁶, W_pl,y 628.4 cm³, A_v 25.68 cm².
    moment, shear = 1.5 * 3000 * 10**2 / 8, 1.5 * 3000 * 10 / 2
    euler = np.pi**2 * 210e9 * 603.8e-8 / 10**2
    critical = 1.127 * np.sqrt(euler * (81e9 * 20.12e-8 + euler * 125.9e-9 / 603.8e-8))
    plastic = 628.4e-6 * 235e6
    slenderness = np.sqrt(plastic / critical)
    half = 0.5 * (1 + 0.34 * (slenderness - 0.4) + 0.75 * slenderness**2)
    factor = min(1 / (half + np.sqrt(half**2 - 0.75 * slenderness**2)), 1 / slenderness**2)
    assert used["Bending"] == pytest.approx(moment / plastic, rel=2e-3)
    assert used["Shear along z with torsion"] == pytest.approx(
        shear / (25.68e-4 * 235e6 / np.sqrt(3)), rel=2e-3
    )
    # C_1 by Kirby and Nethercot is 1.136.
    assert used["Lateral-torsional buckling"] == pytest.approx(
        moment / (factor * plastic), rel=1e-2
    )


def test_what_sizing_ends_with_suffices_and_nothing_before_it_does():
    task = roof_task()
    chosen = size_members(task)
    assert chosen.converged
    used = worst_of(chosen.demand, task.pool, chosen.sections, task.rules)
    assert used.max() <= 1
    menu, places = task.menus[0], places_from(task, chosen.sections)
    first = []
    for member, place in enumerate(places):
        tried = chosen.demand.of(np.full(place, member))
        before = worst_of(tried, task.pool, menu.order[:place], task.rules)
        first.append((before > 1).all())
    assert len(places) - sum(first) <= chosen.held < 0.2 * len(places)


@pytest.mark.parametrize("material", [None, TIMBER])
def test_holding_ends_what_goes_to_and_fro_at_little_mass(material):
    plain = roof_task(material, turns=1000, rounds=60)
    held = roof_task(material)
    without, result = size_members(plain), size_members(held)
    assert result.converged
    assert mass_of(held, result.sections) < 1.12 * mass_of(plain, without.sections)


def test_sizing_goes_the_same_way_twice():
    first, second = (size_members(roof_task()) for _ in range(2))
    assert np.array_equal(first.sections, second.sections)
    assert first.changes == second.changes


def test_a_symmetric_roof_is_sized_symmetrically():
    task = roof_task()
    sections = size_members(task).sections
    middle = task.frame.nodes[task.frame.members].mean(axis=1)
    for axis in (0, 1):
        mirrored = middle * np.where(np.arange(3) == axis, -1.0, 1.0)
        apart = np.linalg.norm(middle[:, None] - mirrored[None], axis=2)
        assert apart.min(axis=1).max() < 1e-9
        assert np.array_equal(sections, sections[apart.argmin(axis=1)])


def test_a_start_from_the_end_ends_at_once():
    task = roof_task(per="group")
    chosen = size_members(task)
    again = size_members(task, start=chosen.sections)
    assert again.changes == (0,)
    assert np.array_equal(again.sections, chosen.sections)


def test_one_section_for_all_is_the_first_that_suffices_for_each():
    task = roof_task(per="all")
    chosen = size_members(task)
    assert len(np.unique(chosen.sections)) == 1
    place = places_from(task, chosen.sections)[0]
    menu = task.menus[task.menu[0]]
    pattern = pattern_of(task.frame)
    for before in range(max(0, place - 3), place):
        lighter = np.full(len(task.slot), menu.order[before])
        assert worst_of(chosen.demand, task.pool, lighter, task.rules).max() > 1
    demand, _ = demand_of(task, chosen.sections, pattern)
    assert worst_of(demand, task.pool, chosen.sections, task.rules).max() <= 1


def test_members_take_less_than_groups_and_groups_less_than_one_for_all():
    masses = []
    for per in ("member", "group", "all"):
        task = roof_task(per=per)
        masses.append(mass_of(task, size_members(task).sections))
    assert masses[0] < masses[1] <= masses[2]


def test_members_of_a_group_share_a_section():
    task = roof_task(per="group")
    sections = size_members(task).sections
    assert all(len(np.unique(sections[task.slot == slot])) == 1 for slot in np.unique(task.slot))


def test_what_no_section_can_bear_keeps_the_largest():
    task = beam_task(1e8, 10.0)
    chosen = size_members(task)
    assert chosen.converged
    assert chosen.sections.tolist() == [task.menus[0].order[-1]]
    assert worst_of(chosen.demand, task.pool, chosen.sections, task.rules)[0] > 1


def test_least_mass_of_both_families_is_no_heavier_than_steel():
    steel, both = roof_task(), roof_task(choose="least mass")
    light = size_members(both)
    assert mass_of(both, light.sections) < mass_of(steel, size_members(steel).sections)
    assert set(both.pool.family[light.sections]) == {0, 1}


def test_a_share_of_the_resistance_makes_a_beam_stronger():
    full, half = beam_task(30e3, 6.0), beam_task(30e3, 6.0, utilisation=0.5)
    used = [
        worst_of(c.demand, t.pool, c.sections, t.rules)[0]
        for t in (full, half)
        for c in [size_members(t)]
    ]
    assert used[0] > 0.5 >= used[1]


@pytest.mark.parametrize("mode", ["thesis", "eurocode"])
def test_all_checks_agree_with_the_quick_ones(mode):
    task = roof_task(mode=mode, timber_grade="C24")
    demand, _ = demand_of(task, size_members(task).sections, pattern_of(task.frame))
    random = np.random.default_rng(2)
    sections = random.integers(0, len(task.pool.family), len(task.slot))
    checked = check_members(demand, task.pool, sections, task.rules)
    assert np.array_equal(checked.worst(), worst_of(demand, task.pool, sections, task.rules))
    steel = task.pool.family[sections] == 0
    if mode == "eurocode":
        timber_only = [n for n, name in enumerate(checked.names) if "EN 1995" in name]
        assert timber_only
        assert (checked.utilisation[timber_only][:, steel] == 0).all()
        assert (checked.section_class[~steel] == 0).all()


def test_second_order_sizing_bears_second_order_forces():
    task = roof_task(second_order=True)
    chosen = size_members(task)
    assert worst_of(chosen.demand, task.pool, chosen.sections, task.rules).max() <= 1
    first = replace(task, rules=replace(task.rules, second_order=False))
    linear, _ = demand_of(first, chosen.sections, pattern_of(task.frame))
    assert not np.allclose(linear.forces, chosen.demand.forces, rtol=1e-3)


def test_a_stiff_roof_keeps_its_limit_and_weighs_more():
    limits = DeflectionLimits(span=18.0)
    task = roof_task(deflection=limits, service=True)
    pattern = pattern_of(task.frame)

    def used(sections):
        rigidities = rigidities_for(task, sections)
        first = solve_frame(task.frame, rigidities, task.loads, pattern)
        return service_of(task, sections, first, pattern).utilisation.max()

    strong, stiff = size_members(task), size_stiff(task, pattern=pattern)
    assert used(strong.sections) > 1 >= used(stiff.sections)
    assert used(stiff.sections) > 0.75
    assert mass_of(task, strong.sections) < mass_of(task, stiff.sections)
    assert worst_of(stiff.demand, task.pool, stiff.sections, task.rules).max() <= 1


def test_a_stiff_beam_has_the_inertia_that_its_limit_asks_for():
    load, length = 5e3, 9.0
    task = beam_task(load, length)
    pattern = pattern_of(task.frame)
    rules = replace(task.rules, service=True, deflection=DeflectionLimits(member=1000.0))
    limited = replace(task, rules=rules)
    chosen = size_stiff(limited, pattern=pattern)
    youngs = 210e9
    sections = task.pool.sections.take(chosen.sections)
    shear = load * length**2 / 8 / (80.76e9 * sections.shear_z[0])
    sag = 5 / 384 * load * length**4 / (youngs * sections.inertia_y[0]) + shear
    assert sag <= length / 1000
    assert 1.5 * sag > length / 1000


def test_bounds_keep_a_slot_from_what_is_too_soft():
    task = beam_task(30e3, 6.0)
    chosen = size_members(task)
    soft = rigidities_for(task, chosen.sections).bending_y
    bounds = replace(no_bounds(task), stiffness=2.0 * soft)
    places = wanted_places(task, chosen.demand, places_from(task, chosen.sections), bounds)
    stiff = task.pool.sections.inertia_y[task.menus[0].order[places]]
    assert stiff >= 2.0 * task.pool.sections.inertia_y[chosen.sections]


def test_sizing_can_be_stopped():
    def stop(fraction, text):
        if fraction > 0:
            raise Cancelled

    with pytest.raises(Cancelled):
        size_members(roof_task(), progress=stop)


def test_a_family_of_the_other_material_is_refused():
    with pytest.raises(ParameterError, match="steel family “timber” is of timber"):
        roof_task(steel="timber")
