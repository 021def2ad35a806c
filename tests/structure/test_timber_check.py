"""EN 1995-1-1 against its own tables, textbook examples, another program and invariants."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.structure.checking import Demand
from heliform.engines.structure.grade import grades
from heliform.engines.structure.sections import circular_hollow, rectangle
from heliform.engines.structure.timber_check import NAMES, check_timber
from heliform.engines.structure.timber_rules import (
    DURATIONS,
    TimberRules,
    modification,
    size_factor,
)
from heliform.engines.structure.timber_stability import (
    column_factor,
    critical_stress,
    effective,
    lateral_factor,
    relative_slenderness,
    softwood_stress,
    stability_of,
)

C24 = grades()["C24"]
GL24H = grades()["GL24h"]
TENSION, COMPRESSION, COLUMN, LATERAL, SHEAR, TORSION, BOTH = range(len(NAMES))
MEDIUM = np.array(["medium"])


def demand_of(forces, length=1.0, duration=MEDIUM, lateral=None):
    """One member for each row of ``forces`` (M, 6), one combination, one station."""
    forces = np.atleast_2d(np.asarray(forces, float))
    lengths = np.broadcast_to(np.asarray(length, float), len(forces)).copy()
    between = lengths if lateral is None else np.full(len(forces), float(lateral))
    return Demand(forces[None, :, None], lengths, lengths, lengths, between, duration)


def used(forces, height, width, grade=C24, rules=None, **more):
    """The utilisations (Q,) of one member."""
    sections = rectangle(height, width)
    checked = check_timber(demand_of(forces, **more), sections, grade, rules or TimberRules())
    return checked.utilisation[:, 0]


def random_demand(seed, members=40, combinations=3, stations=4):
    rng = np.random.default_rng(seed)
    scale = np.array([60e3, 4e3, 8e3, 300.0, 6e3, 2e3])
    forces = rng.normal(size=(combinations, members, stations, 6)) * scale
    lengths = rng.uniform(0.5, 6.0, (4, members))
    sections = rectangle(rng.uniform(0.06, 0.5, members), rng.uniform(0.03, 0.2, members))
    return Demand(forces, *lengths, rng.choice(DURATIONS, combinations)), sections


# Tables and closed forms


@pytest.mark.parametrize(
    ("service_class", "factors"),
    [
        ("1 heated indoors", [0.60, 0.70, 0.80, 0.90, 1.10]),
        ("2 under cover", [0.60, 0.70, 0.80, 0.90, 1.10]),
        ("3 exposed", [0.50, 0.55, 0.65, 0.70, 0.90]),
    ],
)
def test_modification_factors_are_those_of_table_3_1(service_class, factors):
    found = modification(np.array(DURATIONS), TimberRules(service_class=service_class))
    np.testing.assert_array_equal(found, factors)


@pytest.mark.parametrize(("slenderness", "factor"), [(50, 0.796), (100, 0.305), (180, 0.101)])
def test_column_factors_of_c24_are_the_published_ones(slenderness, factor):
    section = rectangle(0.1, 0.1)
    length = np.array([slenderness * 0.1 / np.sqrt(12.0)])
    relative = relative_slenderness(length, section.inertia_y, section.area, C24)
    assert column_factor(relative, glued=False)[0] == pytest.approx(factor, abs=5e-4)


def test_stocky_columns_do_not_buckle_and_glued_ones_buckle_later():
    slenderness = np.linspace(0.0, 3.0, 301)
    solid, glued = column_factor(slenderness, False), column_factor(slenderness, True)
    assert (solid[slenderness <= 0.3] == 1.0).all()
    assert (glued >= solid).all()
    assert (np.diff(solid) <= 1e-12).all()
    # A very slender column carries Euler's load.
    assert column_factor(np.array([50.0]), True)[0] * 50.0**2 == pytest.approx(1.0, rel=3e-3)


def test_lateral_factor_follows_equation_6_34_at_its_limits():
    found = lateral_factor(np.array([0.0, 0.75, 0.75 + 1e-12, 1.0, 1.4, 1.4 + 1e-12, 2.0]))
    np.testing.assert_allclose(found, [1, 1, 0.9975, 0.81, 0.51, 1 / 1.96, 0.25], rtol=1e-9)


def test_lateral_buckling_agrees_with_the_example_of_benoit_legrand_and_tastet():
    # “Calcul de structures en bois”, example 2.3.2: C24, 50 × 200 mm over 5 m, uniform load on top.
    rules = TimberRules(lateral=0.9, load_at="compression edge")
    length = np.array([5.0])
    found = stability_of(rectangle(0.2, 0.05), C24, length, length, length, rules)
    assert found.lateral[0] == pytest.approx(0.602, abs=5e-4)


def test_both_equations_of_the_critical_stress_agree_for_a_thin_board():
    board, length = rectangle(2.0, 0.02), np.array([3.0])
    general = critical_stress(board, C24, length)
    # π/4 in the general one, 0.78 in the other, and the ends of the board's torsion between them
    assert softwood_stress(board, C24, length) == pytest.approx(general, rel=0.01)


def test_size_factors_follow_equations_3_1_and_3_2():
    np.testing.assert_allclose(
        size_factor(np.array([0.04, 0.1, 0.15, 0.3]), C24), [1.3, 1.5**0.2, 1, 1]
    )
    np.testing.assert_allclose(
        size_factor(np.array([0.1, 0.4, 0.6, 0.9]), GL24H), [1.1, 1.5**0.1, 1, 1]
    )
    dense = replace(C24, density=900.0)
    assert size_factor(np.array([0.04]), dense)[0] == 1.0


def test_effective_lengths_follow_table_6_1_and_its_note():
    section, between = rectangle([0.3, 0.1, 0.3], [0.1, 0.3, 0.1]), np.array([4.0, 4.0, 0.0])
    for place, shift in (("axis", 0.0), ("compression edge", 0.6), ("tension edge", -0.15)):
        found = effective(between, section, TimberRules(lateral=0.9, load_at=place))
        np.testing.assert_allclose(found, [3.6 + shift, 3.6 + shift, 0.0])


# Examples


def test_column_of_porteous_and_kermani_example_5_7_3():
    # C24, 100 × 200 mm, 3.75 m, service class 2, medium term, 25 and 10 mm eccentric.
    section, length = rectangle(0.2, 0.1), np.array([3.75])
    slenderness = 3.75 / np.sqrt(section.inertia_z / section.area)
    assert slenderness[0] == pytest.approx(129.9, abs=0.05)
    rules = TimberRules(service_class="2 under cover")
    stability = stability_of(section, C24, length, length, length, rules)
    assert stability.column_z[0] == pytest.approx(0.188, abs=5e-4)
    assert stability.lateral[0] == 1.0

    force = 1.35 * 10e3 + 1.5 * 17.5e3
    found = used([-force, 0, 0, 0, 0.025 * force, 0.010 * force], 0.2, 0.1, C24, rules, length=3.75)
    axial = force / 0.02 / (0.188 * 0.8 * 21e6 / 1.3)
    about_y = 0.025 * force / (0.1 * 0.2**2 / 6) / (0.8 * 24e6 / 1.3)
    about_z = 0.010 * force / (0.2 * 0.1**2 / 6) / (1.5**0.2 * 0.8 * 24e6 / 1.3)
    assert found[COLUMN] == pytest.approx(axial + 0.7 * about_y + about_z, rel=2e-3)
    assert found[COLUMN] == found.max() < 1.0


def test_tie_shear_and_torsion_by_hand():
    found = used([30e3, 2e3, 5e3, 100.0, 0, 0], 0.2, 0.1, duration=np.array(["short"]))
    strength = 0.9 / 1.3
    assert found[TENSION] == pytest.approx(30e3 / 0.02 / (strength * C24.tension))
    assert found[SHEAR] == pytest.approx(1.5 * 5e3 / (0.67 * 0.02) / (strength * 4e6))
    # τ = T/(0.246 h b²) and k_shape = 1.1 where h is twice b
    torsion = 100.0 / (0.2459 * 0.2 * 0.1**2) / (1.1 * strength * 4e6)
    assert found[TORSION] == pytest.approx(torsion, rel=1e-3)
    across = found[SHEAR] * 2 / 5
    assert found[BOTH] == pytest.approx(found[TORSION] + found[SHEAR] ** 2 + across**2)


def test_glued_timber_has_its_own_partial_factor_and_torsion_its_cap():
    found = used([0, 0, 5e3, 100.0, 0, 0], 1.0, 0.1, GL24H)
    strength = 0.8 * 3.5e6 / 1.25
    assert found[SHEAR] == pytest.approx(1.5 * 5e3 / (0.67 * 0.1) / strength)
    # τ = T/(0.312 h b²) and k_shape = 1.3 at most
    assert found[TORSION] == pytest.approx(100.0 / (0.3123 * 0.1**2) / (1.3 * strength), rel=1e-3)


def test_a_slender_beam_column_bent_both_ways_follows_equation_6_35():
    about_y, about_z, axial, length = 3e3, 0.3e3, 10e3, 4.0
    found = used([-axial, 0, 0, 0, about_y, about_z], 0.3, 0.06, length=length)
    strength = 0.8 / 1.3
    critical = 0.78 * 0.06**2 * 7.4e9 / (0.3 * length)
    slender = np.sqrt(24e6 / critical)
    assert 0.75 < slender < 1.4
    lateral = 1.56 - 0.75 * slender
    deep = about_y / (0.06 * 0.3**2 / 6) / (lateral * strength * 24e6)
    flat = about_z / (0.3 * 0.06**2 / 6) / (2.5**0.2 * strength * 24e6)
    relative = length / 0.06 * np.sqrt(12) / np.pi * np.sqrt(21 / 7400)
    k = 0.5 * (1 + 0.2 * (relative - 0.3) + relative**2)
    column = axial / 0.018 * (k + np.sqrt(k**2 - relative**2)) / (strength * 21e6)
    assert found[LATERAL] == pytest.approx(deep**2 + flat + column, rel=1e-9)


def test_a_high_thin_board_is_governed_by_lateral_buckling():
    # The thesis's largest board, 200 × 2 cm over 3 m, bent in the direction of its height.
    found = used([0, 0, 0, 0, 20e3, 0], 2.0, 0.02, length=3.0)
    assert found.argmax() == LATERAL
    assert found[LATERAL] > 10 * found[TENSION]
    restrained = used([0, 0, 0, 0, 20e3, 0], 2.0, 0.02, length=3.0, lateral=0.0)
    assert restrained[LATERAL] == pytest.approx(restrained[TENSION])


@pytest.mark.peer
def test_random_members_agree_with_eurocodepy():
    bending = pytest.importorskip("eurocodepy.ec5.uls.bending")
    shear = pytest.importorskip("eurocodepy.ec5.uls.shear")
    from eurocodepy.ec5 import LoadDuration, ServiceClass, Timber
    from eurocodepy.utils import RectangularCrossSection

    demand, sections = random_demand(seed=7, members=25, combinations=1, stations=1)
    sections = rectangle(
        np.maximum(sections.height, sections.width), np.minimum(sections.height, sections.width)
    )
    demand.forces[..., 0] = -np.abs(demand.forces[..., 0])
    demand = replace(demand, duration=MEDIUM)
    timber = Timber("C24")
    grade = replace(C24, youngs_low=timber.E0k * 1e6, shear_low=timber.Gk * 1e6)
    rules = TimberRules(critical="general")
    found = check_timber(demand, sections, grade, rules).utilisation
    without_mz = replace(demand, forces=demand.forces * [1, 1, 1, 1, 1, 0])
    lateral = check_timber(without_mz, sections, grade, rules).utilisation[LATERAL]
    for m in range(25):
        n, vy, vz, torque, my, mz = demand.forces[0, m, 0] / 1e3
        section = RectangularCrossSection(sections.width[m], sections.height[m])
        lengths = (demand.buckling_y[m], demand.buckling_z[m], demand.lateral[m])
        climate = (ServiceClass.SC1, LoadDuration.MediumDuration)
        bent = bending.check_bending_with_normal(
            n, my, mz, section, timber, *(1e3 * one for one in lengths), *climate
        )["checks"]
        assert found[COMPRESSION, m] == pytest.approx(max(bent["check1"], bent["check2"]), rel=1e-6)
        assert found[COLUMN, m] == pytest.approx(bent["check3"], rel=1e-6)
        # They give 6.35 alone, to which 6.33 adds at most its root; their torsion is a fit.
        beam = bent["check4"]
        assert beam * (1 - 1e-3) <= lateral[m] <= max(beam, beam**0.5) * (1 + 1e-3)
        sheared = shear.check_shear_with_torsion(vy, vz, torque, section, timber, *climate)
        assert found[SHEAR, m] == pytest.approx(sheared["util_shear"], rel=1e-6)


# Invariants


def test_a_member_turned_by_a_quarter_is_used_alike():
    demand, sections = random_demand(seed=1)
    turned = replace(
        demand,
        forces=demand.forces[..., [0, 2, 1, 3, 5, 4]],
        buckling_y=demand.buckling_z,
        buckling_z=demand.buckling_y,
    )
    lying = rectangle(sections.width, sections.height)
    for grade, critical in ((C24, "softwood"), (C24, "general"), (GL24H, "general")):
        rules = TimberRules(critical=critical)
        np.testing.assert_allclose(
            check_timber(turned, lying, grade, rules).utilisation,
            check_timber(demand, sections, grade, rules).utilisation,
            rtol=1e-12,
        )


def test_signs_of_moments_shear_and_torsion_do_not_matter():
    demand, sections = random_demand(seed=2)
    mirrored = replace(demand, forces=demand.forces * [1, -1, 1, -1, -1, 1])
    np.testing.assert_array_equal(
        check_timber(mirrored, sections, C24).utilisation,
        check_timber(demand, sections, C24).utilisation,
    )


def test_the_worst_is_found_where_it_is():
    demand, sections = random_demand(seed=3)
    found = check_timber(demand, sections, C24)
    for m in (0, 7, 39):
        for q in range(len(NAMES)):
            k, s = found.combination[q, m], found.station[q, m]
            alone = replace(
                demand.of(np.array([m])),
                forces=demand.forces[k : k + 1, m : m + 1, s : s + 1],
                duration=demand.duration[k : k + 1],
            )
            one = check_timber(alone, sections.take(np.array([m])), C24)
            assert one.utilisation[q, 0] == pytest.approx(found.utilisation[q, m], rel=1e-12)
    each = [
        check_timber(replace(demand, forces=demand.forces[:, :, [s]]), sections, C24).utilisation
        for s in range(4)
    ]
    np.testing.assert_allclose(np.max(each, axis=0), found.utilisation, rtol=1e-12)


def test_longer_loads_and_damper_air_use_more():
    demand, sections = random_demand(seed=4)
    worst = [
        check_timber(
            replace(demand, duration=np.full(3, duration)),
            sections,
            C24,
            TimberRules(service_class=place),
        ).worst()
        for duration in DURATIONS
        for place in ("3 exposed", "2 under cover")
    ]
    assert (worst[0] > worst[1]).all()
    for longer, shorter in zip(worst[:-2], worst[2:], strict=True):
        assert (longer > shorter).all()


def test_combinations_without_a_class_are_checked_as_permanent():
    demand, sections = random_demand(seed=5)
    silent = check_timber(replace(demand, duration=None), sections, C24)
    said = check_timber(replace(demand, duration=np.full(3, "permanent")), sections, C24)
    np.testing.assert_array_equal(silent.utilisation, said.utilisation)


def test_a_column_uses_more_the_longer_it_is_and_none_of_it_in_tension():
    forces = np.array([[-20e3, 0, 0, 0, 500.0, 0]] * 5)
    lengths = np.array([0.5, 1.0, 2.0, 4.0, 8.0])
    sections = rectangle(np.full(5, 0.2), np.full(5, 0.1))
    column = check_timber(demand_of(forces, lengths), sections, C24).utilisation[COLUMN]
    assert column[0] == 0.0  # λ_rel 0.29, too stocky to buckle
    assert (np.diff(column) > 0.0).all()
    pulled = check_timber(demand_of(-forces, lengths), sections, C24).utilisation
    assert (pulled[[COMPRESSION, COLUMN]] == 0.0).all()


# Refusals


def test_the_thesis_timber_is_refused_with_a_remedy():
    with pytest.raises(ParameterError, match=r"thesis-timber.* no bending strength.*take C24"):
        used([1, 0, 0, 0, 0, 0], 0.2, 0.1, grades()["thesis-timber"])


def test_steel_tubes_and_unknown_durations_are_refused():
    with pytest.raises(ParameterError, match="“S235” is steel"):
        used([1, 0, 0, 0, 0, 0], 0.2, 0.1, grades()["S235"])
    with pytest.raises(ParameterError, match="is no rectangle"):
        check_timber(demand_of([1, 0, 0, 0, 0, 0]), circular_hollow(0.1, 0.01), C24)
    with pytest.raises(ParameterError, match="“forever” is no load-duration class"):
        used([1, 0, 0, 0, 0, 0], 0.2, 0.1, duration=np.array(["forever"]))
