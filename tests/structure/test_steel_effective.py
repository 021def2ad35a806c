"""Effective sections of class 4, against EN 1993-1-5 by hand and by fibres."""

import numpy as np
import pytest
from heliform.engines.structure.sections import i_section, rectangular_hollow
from heliform.engines.structure.steel_effective import (
    buckling_coefficient,
    effective_sections,
    internal_reduction,
    outstand_reduction,
    shear_buckling,
)

from .steel_members import ipe, steel

MILD = steel(235)


def test_buckling_coefficients_are_those_of_table_4_1():
    psi = np.array([1.0, 0.5, 0.0, -0.5, -1.0, -2.0, -3.0])
    truth = [4.0, 8.2 / 1.55, 8.2 / 1.05, 13.4, 23.9, 53.82, 95.68]
    assert buckling_coefficient(psi) == pytest.approx(truth, rel=1e-3)


@pytest.mark.parametrize(
    ("plate", "psi", "truth"),
    [
        (0.673, 1.0, 1.0),
        (1.0, 1.0, 0.78),
        (2.0, 1.0, 0.445),
        (1.0, 0.0, 0.835),
        (1.0, -1.0, 0.89),
        (1.5, -1.0, (1.5 - 0.11) / 2.25),
    ],
)
def test_reduction_of_internal_walls_is_equation_4_2(plate, psi, truth):
    slenderness = plate * 28.4 * np.sqrt(buckling_coefficient(psi))
    assert internal_reduction(slenderness, psi) == pytest.approx(truth, abs=5e-4)


def test_reduction_of_outstands_is_equation_4_3():
    plate = np.array([0.5, 0.748, 1.0, 2.0])
    reduction = outstand_reduction(plate * 28.4 * np.sqrt(0.43))
    assert reduction == pytest.approx([1.0, 1.0, 0.812, 0.453], abs=2e-3)


def test_effective_area_of_a_square_box_by_hand():
    """400 × 400 × 6 in S355: c/t = 63.7, λ_p = 1.377, ρ = 0.610."""
    box = rectangular_hollow(0.4, 0.4, 0.006)
    plate = (382 / 6) / (28.4 * np.sqrt(235 / 355) * 2)
    assert plate == pytest.approx(1.377, abs=1e-3)
    reduction = (plate - 0.22) / plate**2
    truth = box.area[0] - 4 * (1 - reduction) * 0.382 * 0.006
    assert effective_sections(box, steel(355)).area[0] == pytest.approx(truth, rel=1e-9)


def test_nothing_is_reduced_up_to_class_3():
    sections = rectangular_hollow(0.42 + 0.03, [0.1, 0.3], 0.01)
    effective = effective_sections(sections, MILD)
    assert (effective.area == sections.area).all()
    assert (effective.modulus_y == sections.elastic_y).all()
    assert (effective.modulus_z == sections.elastic_z).all()


def fibres(depth, flange, lost, web, webs, slices=120_000):
    """W_eff in m³ of a sharp-cornered section of S235, cut into slices.

    ``flange`` and ``web``: breadth and thickness; ``lost`` of the compressed flange's breadth.
    """
    (breadth, thick), thin = flange, web
    z = (np.arange(slices) + 0.5) / slices * depth - depth / 2
    wall = np.where(np.abs(z) > depth / 2 - thick, breadth, webs * thin)
    wall = np.where(z > depth / 2 - thick, breadth - lost, wall)
    centre = (wall * z).sum() / wall.sum()
    edge = depth / 2 - thick
    top, bottom = edge - centre, -edge - centre
    psi = bottom / top
    limit = 42 / (0.67 + 0.33 * psi) if psi > -1 else 62 * (1 - psi) * np.sqrt(-psi)
    if 2 * edge / thin > limit:
        plate = 2 * edge / thin / (28.4 * np.sqrt(7.81 - 6.29 * psi + 9.78 * psi**2))
        reduction = (plate - 0.055 * (3 + psi)) / plate**2
        hole = (z < edge - 0.4 * reduction * top) & (z > centre + 0.6 * reduction * top)
        wall = np.where(hole, 0.0, wall)
    centre = (wall * z).sum() / wall.sum()
    inertia = (wall * (z - centre) ** 2).sum() * depth / slices
    return inertia / (depth / 2 - centre)


def box_fibres(height, width, thickness):
    flat = width - 2 * thickness
    plate = flat / thickness / 56.8
    lost = (1 - (plate - 0.22) / plate**2) * flat if flat > 42 * thickness else 0.0
    return fibres(height, (width, thickness), lost, thickness, 2)


@pytest.mark.parametrize(
    ("height", "width"), [(2.0, 0.2), (1.5, 0.05), (1.0, 0.8), (0.6, 0.6), (0.3, 1.2)]
)
def test_effective_moduli_of_boxes_are_what_fibres_sum_up_to(height, width):
    """The thesis's largest box, and others whose webs, flanges or both are of class 4."""
    box = rectangular_hollow(height, width, 0.01, 0.0)
    effective = effective_sections(box, MILD)
    assert effective.modulus_y[0] == pytest.approx(box_fibres(height, width, 0.01), rel=1e-5)
    assert effective.modulus_z[0] == pytest.approx(box_fibres(width, height, 0.01), rel=1e-5)


def test_a_quarter_turn_swaps_the_moduli():
    boxes = rectangular_hollow([1.0, 0.5], [0.5, 1.0], 0.006)
    effective = effective_sections(boxes, MILD)
    assert effective.modulus_y[::-1] == pytest.approx(effective.modulus_z)
    assert effective.area[0] == pytest.approx(effective.area[1])


def test_the_web_of_an_ipe_600_in_s355_loses_a_little_in_compression():
    section = ipe(600)
    plate = (514 / 12) / (28.4 * np.sqrt(235 / 355) * 2)
    lost = (1 - (plate - 0.22) / plate**2) * 0.514 * 0.012
    effective = effective_sections(section, steel(355))
    assert effective.area[0] == pytest.approx(section.area[0] - lost)
    assert effective.modulus_y[0] == section.elastic_y[0]


def test_a_plate_girder_loses_flange_tips_and_web():
    girder = i_section(1.5, 0.5, 0.008, 0.012, 0.0)
    effective = effective_sections(girder, MILD)
    tip = (1 - float(outstand_reduction(0.246 / 0.012))) * 0.246
    assert tip > 0
    assert effective.area[0] < girder.area[0] - 4 * tip * 0.012
    truth = fibres(1.5, (0.5, 0.012), 2 * tip, 0.008, 1)
    assert effective.modulus_y[0] == pytest.approx(truth, rel=1e-5)
    # One side's tips gone: a rectangle of twice the flange, with one end cut off.
    width, height = 0.5 - tip, 2 * 0.012
    inertia = height * width**3 / 12 + (1.5 - height) * 0.008**3 / 12
    web = (1.5 - height) * 0.008
    shift = height * width * tip / 2 / (height * width + web)
    inertia += height * width * (tip / 2 - shift) ** 2 + web * shift**2
    assert effective.modulus_z[0] == pytest.approx(inertia / (0.25 + shift), rel=1e-6)


def test_shear_buckling_begins_at_72_epsilon():
    assert shear_buckling([30.0, 71.7, 72.0, 86.4 * 1.66]) == pytest.approx(
        [1.0, 1.0, 0.996, 0.5], abs=1e-3
    )
