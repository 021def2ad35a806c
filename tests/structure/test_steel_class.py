"""Section classes: Table 5.2 at its limits, and under axial force with moments."""

import numpy as np
import pytest
from heliform.engines.structure.sections import (
    circular_hollow,
    i_section,
    joined_sections,
    rectangle,
    rectangular_hollow,
)
from heliform.engines.structure.steel_class import (
    compression_class,
    flat_walls,
    internal_limits,
    member_class,
    section_class,
)

from .steel_members import ipe, steel

MILD, STRONG = steel(235), steel(355)
JUST = 1e-6


def class_of(section, grade, axial=0.0, moment_y=0.0, moment_z=0.0):
    forces = (np.full(1, value) for value in (axial, moment_y, moment_z))
    return int(section_class(*forces, section, grade)[0])


@pytest.mark.parametrize(
    ("alpha", "psi", "limits"),
    [
        (1.0, 1.0, (33, 38, 42)),
        (0.5, -1.0, (72, 83, 124)),
        (0.75, 0.0, (396 / 8.75, 456 / 8.75, 42 / 0.67)),
        (0.25, -2.0, (144, 166, 62 * 3 * np.sqrt(2))),
    ],
)
def test_limits_of_internal_walls_are_those_of_table_5_2(alpha, psi, limits):
    assert np.array(internal_limits(alpha, psi)) == pytest.approx(limits)


@pytest.mark.parametrize("grade", [MILD, STRONG])
@pytest.mark.parametrize(("limit", "below"), [(33, 1), (38, 2), (42, 3)])
def test_a_box_in_compression_changes_class_at_33_38_and_42_epsilon(grade, limit, below):
    factor = np.sqrt(235e6 / grade.yield_strength)
    for side, expected in ((1 - JUST, below), (1 + JUST, below + 1)):
        box = rectangular_hollow(0.01 * (limit * factor * side + 3), 0.1, 0.01)
        assert class_of(box, grade, axial=-1.0) == expected


@pytest.mark.parametrize("grade", [MILD, STRONG])
@pytest.mark.parametrize(("limit", "below"), [(72, 1), (83, 2), (124, 3)])
def test_a_box_in_bending_changes_class_at_72_83_and_124_epsilon(grade, limit, below):
    factor = np.sqrt(235e6 / grade.yield_strength)
    for side, expected in ((1 - JUST, below), (1 + JUST, below + 1)):
        box = rectangular_hollow(0.01 * (limit * factor * side + 3), 0.1, 0.01)
        assert class_of(box, grade, moment_y=1e3) == expected
        flat = rectangular_hollow(0.1, 0.01 * (limit * factor * side + 3), 0.01)
        assert class_of(flat, grade, moment_z=1e3) == expected


@pytest.mark.parametrize(("limit", "below"), [(50, 1), (70, 2), (90, 3)])
def test_a_tube_changes_class_at_50_70_and_90_epsilon_squared(limit, below):
    for side, expected in ((1 - JUST, below), (1 + JUST, below + 1)):
        tube = circular_hollow(0.005 * limit * side * 235 / 355, 0.005)
        assert class_of(tube, STRONG, moment_y=1e3) == expected


@pytest.mark.parametrize(("limit", "below"), [(9, 1), (10, 2), (14, 3)])
def test_flanges_of_an_i_section_change_class_at_9_10_and_14_epsilon(limit, below):
    for side, expected in ((1 - JUST, below), (1 + JUST, below + 1)):
        width = 2 * (0.01 * limit * side + 0.02) + 0.012
        section = i_section(0.3, width, 0.012, 0.01, 0.02)
        assert class_of(section, MILD, moment_y=1e3) == expected


def test_a_wall_is_flat_between_its_corners():
    box, sharp = rectangular_hollow(0.3, 0.2, 0.01), rectangular_hollow(0.3, 0.2, 0.01, 0.0)
    assert np.ravel(flat_walls(box)) == pytest.approx([0.27, 0.17])  # h − 3t and b − 3t
    assert np.ravel(flat_walls(sharp)) == pytest.approx([0.28, 0.18])
    web, flange = flat_walls(ipe(600))
    assert (web[0], flange[0]) == pytest.approx((0.514, 0.080))  # as in tables of profiles


def test_an_ipe_600_of_s355_is_class_1_in_bending_and_4_in_compression():
    assert class_of(ipe(600), STRONG, moment_y=1e5) == 1
    assert class_of(ipe(600), STRONG, axial=-1e5) == 4
    assert compression_class(ipe(300), MILD)[0] == 2  # c/t = 35.0
    assert compression_class(ipe(600), STRONG)[0] == 4


@pytest.mark.parametrize(("first", "below"), [(396, 1), (456, 2)])
def test_an_axial_force_lifts_the_plastic_neutral_axis_of_an_i_section(first, below):
    """N = (2α − 1) c t f_y, as behind the limits of N/N_pl in SCI P363."""
    factor = np.sqrt(235 / 355)
    alpha = (first * factor / (0.514 / 0.012) + 1) / 13
    force = (2 * alpha - 1) * 0.514 * 0.012 * 355e6
    moment = 1e6
    assert class_of(ipe(600), STRONG, -force * (1 - JUST), moment) == below
    assert class_of(ipe(600), STRONG, -force * (1 + JUST), moment) == below + 1


def test_an_axial_force_makes_class_4_where_psi_is_2n_minus_1():
    box = rectangular_hollow(0.73, 0.1, 0.01)  # c/t = 70
    psi = (42 / 70 - 0.67) / 0.33
    force = (psi + 1) / 2 * box.area[0] * 235e6
    moment = 0.999 * box.elastic_y[0] * 235e6
    assert class_of(box, MILD, -force * (1 - JUST), moment) == 3
    assert class_of(box, MILD, -force * (1 + JUST), moment) == 4


def test_the_other_moment_presses_the_walls_of_a_box():
    box = rectangular_hollow(0.6, 0.2, 0.01)  # c/t = 57, and 17
    moment = 1e5
    assert class_of(box, MILD, moment_y=moment) == 1
    assert class_of(box, MILD, moment_y=moment, moment_z=1e-3 * moment) == 1
    assert class_of(box, MILD, moment_y=moment, moment_z=moment) > 1
    assert class_of(box, MILD, moment_z=moment) == 4
    assert class_of(box, MILD, moment_y=1e-3 * moment, moment_z=moment) == 4


def test_what_is_not_compressed_is_of_class_1():
    slender = joined_sections(
        [rectangular_hollow(2.0, 0.2, 0.01), circular_hollow(0.5, 0.003), ipe(600)]
    )
    pull = 0.5 * slender.area * 235e6
    small = 0.1 * slender.elastic_z * 235e6
    assert (section_class(pull, small, small, slender, MILD) == 1).all()
    assert (section_class(-pull, small, small, slender, MILD) > 1).all()


@pytest.mark.filterwarnings("error")
def test_a_wall_that_is_all_corner_is_of_class_1():
    narrow = rectangular_hollow(0.6, 0.05, 0.01, 0.025)
    assert flat_walls(narrow)[1][0] == pytest.approx(0.0)
    assert class_of(narrow, MILD, moment_y=1e4) == 1
    assert class_of(narrow, MILD, axial=-1e4) == 4


def test_solid_sections_are_of_class_1():
    assert class_of(rectangle(0.5, 0.01), STRONG, -1e5, 1e5, 1e5) == 1


def test_no_class_improves_as_compression_grows():
    rng = np.random.default_rng(3)
    sections = rectangular_hollow(*rng.uniform(0.05, 1.5, (2, 200)), 0.01, 0.0)
    y = rng.uniform(0, 1, 200) * sections.elastic_y * 235e6
    z = rng.uniform(0, 1, 200) * sections.elastic_z * 235e6
    shares = np.linspace(-0.9, 1.0, 60)[:, None]
    classes = section_class(
        -shares * sections.area * 235e6, y + 0 * shares, z + 0 * shares, sections, MILD
    )
    assert (np.diff(classes.astype(int), axis=0)[shares[:-1, 0] >= 0] >= 0).all()
    assert set(np.unique(classes)) == {1, 2, 3, 4}


def test_a_class_does_not_depend_on_the_signs_of_moments():
    rng = np.random.default_rng(4)
    sections = rectangular_hollow(*rng.uniform(0.05, 1.5, (2, 100)), 0.01)
    forces = rng.normal(size=(3, 100)) * np.array([[1e6], [3e5], [3e5]])
    classes = section_class(*forces, sections, MILD)
    mirrored = section_class(forces[0], -forces[1], -forces[2], sections, MILD)
    assert (classes == mirrored).all()


def test_a_member_is_of_the_class_of_its_most_stressed_section():
    box = rectangular_hollow(0.6, 0.2, 0.01)
    axial = np.full((1, 3, 1), -1e4)
    moment = np.array([0.0, 2e5, 0.0]).reshape(1, 3, 1)
    classes = section_class(axial, moment, 0 * moment, box, MILD)
    assert classes.ravel().tolist() == [4, 1, 4]  # in pure compression at its ends
    assert member_class(classes, axial, moment, 0 * moment, box).tolist() == [[1]]
