"""Reduction factors, critical loads and moment factors against tables and published examples."""

import numpy as np
import pytest
from heliform.engines.structure.sections import (
    i_section,
    joined_sections,
    rectangle,
    rectangular_hollow,
)
from heliform.engines.structure.steel_stability import (
    IMPERFECTION,
    critical_force,
    critical_moment,
    equivalent_moment,
    imperfections,
    lateral_imperfections,
    lateral_reduction_factor,
    moment_gradient,
    reduction_factor,
)

from .steel_members import ipe, steel

SLENDERNESS = [0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.2, 1.5, 2.0, 2.6, 3.0]
TABLE = {  # ENV 1993-1-1 Table 5.5.2
    "a": [1, 0.9775, 0.9528, 0.9243, 0.8477, 0.6656, 0.5300, 0.3724, 0.2229, 0.1362, 0.1036],
    "b": [1, 0.9641, 0.9261, 0.8842, 0.7837, 0.5970, 0.4781, 0.3422, 0.2095, 0.1299, 0.0994],
    "c": [1, 0.9491, 0.8973, 0.8430, 0.7247, 0.5399, 0.4338, 0.3145, 0.1962, 0.1234, 0.0951],
    "d": [1, 0.9235, 0.8504, 0.7793, 0.6431, 0.4671, 0.3762, 0.2766, 0.1766, 0.1134, 0.0882],
}


@pytest.mark.parametrize("curve", "abcd")
def test_reduction_factors_are_those_of_the_table(curve):
    found = reduction_factor(SLENDERNESS, IMPERFECTION[curve])
    assert found == pytest.approx(TABLE[curve], abs=6e-5)


def test_curve_a0_is_above_curve_a_and_below_euler():
    slenderness = np.linspace(0.25, 3, 50)
    a0 = reduction_factor(slenderness, IMPERFECTION["a0"])
    assert (a0 > reduction_factor(slenderness, IMPERFECTION["a"])).all()
    assert (a0 < np.minimum(1.0, slenderness**-2.0)).all()
    assert reduction_factor(1.0, IMPERFECTION["a0"]) == pytest.approx(0.7253, abs=6e-5)


def test_the_unrestrained_beam_of_steel_buildings_in_europe():
    """Part 4, example A.1: IPE 330 of S235 over 5.70 m, M_cr = 113.9 kNm, χ_LT = 0.480.

    Its load stands on the top flange, with C_1 = 1.127 and C_2 z_g = 74.91 mm.
    """
    moment = critical_moment(ipe(330), steel(235), np.array([5.7]))[0]
    force = critical_force(210e9 * 788.1e-8, 5.7)
    assert force == pytest.approx(502.75e3, rel=1e-4)
    raised = force * 74.91e-3
    assert 1.127 * (np.hypot(moment, raised) - raised) == pytest.approx(113.9e3, rel=2e-3)
    alpha = lateral_imperfections(ipe(330))[0]
    assert lateral_reduction_factor(1.288, alpha) == pytest.approx(0.480, abs=5e-4)


def test_the_column_of_staad_s_verification_manual_buckles_laterally():
    """HD 320 × 127 of S275: λ_LT = 0.619, χ_LT = 0.908."""
    section = i_section(0.320, 0.300, 0.0115, 0.0205, 0.027)
    assert lateral_imperfections(section)[0] == 0.34
    assert lateral_reduction_factor(0.619, 0.34) == pytest.approx(0.908, abs=5e-4)


def test_nothing_buckles_laterally_up_to_0_4():
    assert (lateral_reduction_factor([0.0, 0.3, 0.4], 0.76) == 1.0).all()
    assert lateral_reduction_factor(0.401, 0.76) == pytest.approx(1.0, abs=1e-3)


def test_columns_of_no_length_do_not_buckle():
    assert np.isinf(critical_force(1e6, 0.0))
    assert np.isinf(critical_moment(ipe(300), steel(235), np.zeros(1))).all()


def test_curves_are_those_of_table_6_2():
    sections = joined_sections(
        [
            rectangular_hollow(0.2, 0.1, 0.01),
            i_section(0.30, 0.15, 0.0071, 0.0107, 0.015),  # IPE 300
            i_section(0.20, 0.20, 0.009, 0.015, 0.018),  # HEB 200
            i_section(0.60, 0.30, 0.03, 0.06, 0.027),
            rectangle(0.1, 0.05),
        ]
    )
    y, z = imperfections(sections, steel(355), "hot-finished")
    assert y.tolist() == [IMPERFECTION[curve] for curve in "aabbc"]
    assert z.tolist() == [IMPERFECTION[curve] for curve in "abccc"]
    y, z = imperfections(sections, steel(460), "hot-finished")
    names = ["a0", "a0", "a", "a", "c"]
    assert y.tolist() == z.tolist() == [IMPERFECTION[name] for name in names]
    for made, curve in (("cold-formed", "c"), ("welded", "b")):
        assert imperfections(sections, steel(355), made)[0][0] == IMPERFECTION[curve]


@pytest.mark.parametrize(
    ("start", "middle", "end", "truth"),
    [
        (1.0, 1.0, 1.0, 1.0),
        (1.0, 0.5, 0.0, 0.6),
        (1.0, 0.75, 0.5, 0.8),
        (1.0, 0.0, -1.0, 0.4),
        (-1.0, -0.25, 0.5, 0.4),
        (0.0, 1.0, 0.0, 0.95),  # simply supported, uniform load
        (-2.0, 1.0, -2.0, 0.5),  # built in at both ends: α_s = −1/2, ψ = 1
        (-2.0, 1.0, 0.0, 0.5),  # built in at one: α_s = −1/2, ψ = 0
        (-1.0, 2.0, -1.0, 0.925),  # α_h = −1/2, ψ = 1
        (-1.0, 2.0, 1.0, 0.975),  # α_h = −1/2, ψ = −1
        (-2.0, 1.0, 1.0, 0.55),  # α_s = −1/2, ψ = −1/2
        (0.0, 0.0, 0.0, 1.0),
    ],
)
def test_moment_factors_are_those_of_table_b_3(start, middle, end, truth):
    values = [np.array([value]) for value in (start, middle, end)]
    assert equivalent_moment(*values)[0] == pytest.approx(truth)
    assert equivalent_moment(*values[::-1])[0] == pytest.approx(truth)
    assert equivalent_moment(*(-value for value in values))[0] == pytest.approx(truth)


def test_moment_factors_do_not_jump():
    middle = np.linspace(-3, 3, 60001)
    for end in (1.0, 0.3, 0.0, -0.4):
        factor = equivalent_moment(np.ones_like(middle), middle, np.full_like(middle, end))
        assert np.abs(np.diff(factor)).max() < 3e-4


@pytest.mark.parametrize(
    ("start", "middle", "end", "truth", "within"),
    [
        (1.0, 1.0, 1.0, 1.0, 1e-9),
        (0.0, 1.0, 0.0, 1.127, 0.01),
        (1.0, 0.5, 0.0, 1.77, 0.11),
        (1.0, 0.0, -1.0, 2.55, 0.3),
    ],
)
def test_gradients_of_moments_are_near_the_tables(start, middle, end, truth, within):
    """C_1 of SN003 by Access Steel; the formula is below it but for uniform load."""
    found = moment_gradient(*(np.array([value]) for value in (start, middle, end)))[0]
    assert found == pytest.approx(truth, abs=within)
