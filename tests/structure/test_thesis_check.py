"""The check that the thesis's structures were sized by, against hand calculation and itself."""

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.structure.checking import Demand
from heliform.engines.structure.grade import Grade
from heliform.engines.structure.sections import (
    SHAPES,
    joined_sections,
    rectangle,
    rectangular_hollow,
)
from heliform.engines.structure.steel_check import check_steel
from heliform.engines.structure.thesis_check import TIMBER_STRENGTH, check_thesis

from .steel_members import demand, steel, used

MILD = steel(235)
TIMBER = Grade("wood", "timber", 10.5e9, 3.6e9, 530.0, 7.4e6, 0.0, "thesis, Table 4")
BOX = rectangular_hollow(0.4, 0.1, 0.01, 0.0)
BOARD = rectangle(0.4, 0.06)


def random_demand(seed, members, combinations=3):
    rng = np.random.default_rng(seed)
    size = np.array([2e5, 1e4, 3e4, 2e3, 4e4, 5e3])
    forces = rng.normal(size=(combinations, members, 5, 6)) * size
    lengths = rng.uniform(0.5, 5.0, members)
    return Demand(forces, lengths, lengths, lengths, lengths)


def chi(slenderness, alpha):
    half = 0.5 * (1 + alpha * (slenderness - 0.2) + slenderness**2)
    return 1 / (half + np.sqrt(half**2 - slenderness**2))


def test_stresses_of_a_box_add_up_to_its_yield_strength():
    checked = check_thesis(demand(N=2e5, My=6e4, Mz=-5e3), BOX, MILD)
    truth = (2e5 / BOX.area + 6e4 / BOX.elastic_y + 5e3 / BOX.elastic_z)[0] / 235e6
    assert used(checked, "elastic, as Karamba3D after EN 1993-1-1 6.2.1") == pytest.approx(truth)
    assert checked.section_class[0] == 0


def test_timber_has_the_strength_of_karamba_s_wood_both_ways():
    area = 0.4 * 0.06
    for force in (0.5 * area * 13e6, -0.5 * area * 13e6):
        assert used(check_thesis(demand(0.0, N=force), BOARD, TIMBER), "6.2.1") == 0.5
    assert TIMBER_STRENGTH == 13e6


def test_a_box_column_with_moments_by_hand():
    """Tables B.1 and B.3, class 3: ψ = 0, so C_my = 0.6; C_mz = 0.95, capped at 0.9."""
    my = 3e4 * np.linspace(1, 0, 5)
    mz = 4e3 * np.array([0.0, 0.75, 1.0, 0.75, 0.0])
    checked = check_thesis(demand(3.0, N=-3e5, My=my, Mz=mz), BOX, MILD)
    axial = BOX.area[0] * 235e6
    slenderness_y, slenderness_z = (
        np.sqrt(axial / (np.pi**2 * 210e9 * inertia[0] / 9))
        for inertia in (BOX.inertia_y, BOX.inertia_z)
    )
    y, z = 3e5 / (chi(slenderness_y, 0.21) * axial), 3e5 / (chi(slenderness_z, 0.21) * axial)
    k_yy = 0.6 * (1 + 0.6 * slenderness_y * y)
    k_zz = 0.9 * (1 + 0.6 * slenderness_z * z)
    assert max(slenderness_y, slenderness_z) < 1
    bent_y = 3e4 / (BOX.elastic_y[0] * 235e6)
    bent_z = 4e3 / (BOX.elastic_z[0] * 235e6)
    assert used(checked, "(6.61)") == pytest.approx(y + k_yy * bent_y + k_zz * bent_z)
    assert used(checked, "(6.62)") == pytest.approx(z + 0.8 * k_yy * bent_y + k_zz * bent_z)


def test_a_board_buckles_laterally():
    """M_cr = π/L √(E I_z G J); above 6.2, k_zy = 1 − … ≤ 1 times M/(χ_LT M_el)."""
    checked = check_thesis(demand(4.0, My=5e3), BOARD, TIMBER)
    critical = np.pi / 4 * np.sqrt(10.5e9 * BOARD.inertia_z[0] * 3.6e9 * BOARD.torsion[0])
    elastic = 0.06 * 0.4**2 / 6 * 13e6
    truth = 5e3 / (chi(np.sqrt(elastic / critical), 0.76) * elastic)
    assert used(checked, "(6.62)") == pytest.approx(truth)
    assert used(checked, "(6.61)") == pytest.approx(0.9 * truth)
    stocky = check_thesis(demand(0.1, My=5e3), BOARD, TIMBER)
    assert used(stocky, "(6.62)") < used(checked, "(6.62)")


def test_the_cap_of_moment_factors_can_be_lifted():
    given = demand(4.0, N=-3e5, My=np.full(5, 3e4))
    capped = check_thesis(given, BOX, MILD)
    whole = check_thesis(given, BOX, MILD, most_moment_factor=1.0)
    assert used(whole, "(6.61)") > used(capped, "(6.61)")
    assert used(whole, "6.2.1") == used(capped, "6.2.1")


def test_shear_and_torsion_are_elastic():
    checked = check_thesis(demand(Vy=1e4, Vz=-3e4, T=2e3), BOX, MILD)
    stress = 235e6 / np.sqrt(3)
    area = BOX.area[0]
    truth = 1e4 / (area * 0.1 / 0.5) + 3e4 / (area * 0.4 / 0.5) + 2e3 / BOX.torsion_modulus[0]
    assert used(checked, "6.2.6") == pytest.approx(truth / stress)


@pytest.mark.parametrize("grade", [MILD, TIMBER])
def test_utilisation_falls_as_a_section_grows_higher(grade):
    heights = np.linspace(0.1, 2.0, 96)
    given = random_demand(31, 60)
    for width in (0.05, 0.1, 0.2):
        before = np.full(60, np.inf)
        for height in heights:
            if grade is MILD:
                section = rectangular_hollow(height, width, 0.01, 0.0)
            else:
                section = rectangle(height, width / 2)
            worst = check_thesis(given, section.take(np.zeros(60, int)), grade).worst()
            assert (worst <= before * (1 + 1e-12)).all()
            before = worst


def test_more_load_uses_more_in_proportion_or_beyond():
    given, sections = random_demand(32, 80), BOX.take(np.zeros(80, int))
    one = check_thesis(given, sections, MILD).utilisation
    twice = Demand(2 * given.forces, *(given.lengths,) * 4)
    two = check_thesis(twice, sections, MILD).utilisation
    assert two[:2] == pytest.approx(2 * one[:2])
    assert (two[2:] >= 2 * one[2:] * (1 - 1e-12)).all()


def test_signs_of_moments_and_the_member_s_direction_do_not_matter():
    given = random_demand(33, 80)
    sections = joined_sections([BOX, BOARD]).take(np.arange(80) % 2)
    one = check_thesis(given, sections, MILD).utilisation
    for forces in (given.forces * [1, -1, 1, -1, -1, -1], given.forces[:, :, ::-1]):
        turned = Demand(forces, *(given.lengths,) * 4)
        assert check_thesis(turned, sections, MILD).utilisation == pytest.approx(one)


def test_each_member_is_checked_for_itself_and_by_its_worst_combination():
    given = random_demand(34, 40, 4)
    sections = joined_sections([BOX, BOARD]).take(np.arange(40) % 2)
    whole = check_thesis(given, sections, MILD)
    for member in (0, 7, 33):
        one = np.array([member])
        alone = check_thesis(given.of(one), sections.take(one), MILD)
        assert alone.utilisation[:, 0] == pytest.approx(whole.utilisation[:, member])
        for row, combination in enumerate(alone.combination[:, 0]):
            some = Demand(given.forces[[combination]][:, one], *(given.lengths[one],) * 4)
            only = check_thesis(some, sections.take(one), MILD)
            assert only.utilisation[row, 0] == pytest.approx(whole.utilisation[row, member])


def test_eurocode_asks_more_of_slender_boxes_than_the_thesis():
    """What the thesis leaves out: webs that buckle. Stocky boxes get their plastic moment back."""
    slender, stocky = rectangular_hollow(1.5, 0.1, 0.01, 0.0), rectangular_hollow(0.2, 0.1, 0.01)
    assert slender.shape[0] == SHAPES.index("rhs")
    given = demand(3.0, N=-5e5, My=1e5)
    assert check_steel(given, slender, MILD).worst() > check_thesis(given, slender, MILD).worst()
    given = demand(0.5, My=5e4)
    assert check_steel(given, stocky, MILD).worst() < check_thesis(given, stocky, MILD).worst()


def test_a_steel_without_a_yield_strength_is_refused():
    with pytest.raises(ParameterError, match="has no yield strength"):
        check_thesis(demand(N=1.0), BOX, steel(0))
