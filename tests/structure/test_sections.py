"""Section properties against published tables, closed forms and another program."""

from dataclasses import fields

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.structure.sections import (
    SHAPES,
    Sections,
    circular_hollow,
    i_section,
    joined_sections,
    rectangle,
    rectangular_hollow,
)

SAMPLES = {
    "rounded box": lambda k: rectangular_hollow(0.15 * k, 0.1 * k, 0.008 * k),
    "sharp box": lambda k: rectangular_hollow(0.4 * k, 0.1 * k, 0.01 * k, 0.0),
    "tube": lambda k: circular_hollow(0.1683 * k, 0.008 * k),
    "i": lambda k: i_section(0.3 * k, 0.15 * k, 0.0071 * k, 0.0107 * k, 0.015 * k),
    "board": lambda k: rectangle(0.2 * k, 0.02 * k),
}

# name: what builds it and what its table says, in cm² to cm⁴ as printed
PUBLISHED = {
    "SHS 150×150×6.3, EN 10210-2": (
        rectangular_hollow(0.15, 0.15, 0.0063),
        {
            "area": 35.8,
            "inertia_y": 1223,
            "elastic_y": 163,
            "plastic_y": 192,
            "torsion": 1909,
            "torsion_modulus": 240,
        },
    ),
    "RHS 200×100×10, EN 10210-2": (
        rectangular_hollow(0.2, 0.1, 0.01),
        {
            "area": 54.9,
            "inertia_y": 2664,
            "inertia_z": 869,
            "elastic_y": 266,
            "elastic_z": 174,
            "plastic_y": 341,
            "plastic_z": 206,
            "torsion": 2156,
            "torsion_modulus": 295,
        },
    ),
    "CHS 168.3×8, EN 10210-2": (
        circular_hollow(0.1683, 0.008),
        {
            "area": 40.3,
            "inertia_y": 1297,
            "elastic_y": 154,
            "plastic_y": 206,
            "torsion": 2595,
            "torsion_modulus": 308,
        },
    ),
    "IPE 300, EN 10365": (
        i_section(0.3, 0.15, 0.0071, 0.0107, 0.015),
        {
            "area": 53.81,
            "inertia_y": 8356,
            "inertia_z": 603.8,
            "elastic_y": 557.1,
            "elastic_z": 80.50,
            "plastic_y": 628.4,
            "plastic_z": 125.2,
            "torsion": 20.12,
            "perimeter": 116.0,
        },
    ),
    "HEA 200, EN 10365": (
        i_section(0.19, 0.2, 0.0065, 0.01, 0.018),
        {
            "area": 53.83,
            "inertia_y": 3692,
            "inertia_z": 1336,
            "elastic_y": 388.6,
            "elastic_z": 133.6,
            "plastic_y": 429.5,
            "plastic_z": 203.8,
            "torsion": 20.98,
            "perimeter": 113.6,
        },
    ),
}
POWERS = {
    **dict.fromkeys(("area", "shear_y", "shear_z"), 2),
    **dict.fromkeys(("elastic_y", "elastic_z", "plastic_y", "plastic_z", "torsion_modulus"), 3),
    **dict.fromkeys(("inertia_y", "inertia_z", "torsion"), 4),
    **dict.fromkeys(("height", "width", "web", "flange", "radius", "perimeter"), 1),
}


@pytest.mark.parametrize("which", PUBLISHED)
def test_properties_are_those_of_the_published_tables(which):
    section, table = PUBLISHED[which]
    for name, printed in table.items():
        found = getattr(section, name)[0] * 100 ** POWERS[name]
        digits = len(f"{printed:g}".replace(".", ""))
        assert float(f"{found:.{digits}g}") == pytest.approx(printed, rel=1e-9), (name, found)


@pytest.mark.parametrize("which", SAMPLES)
def test_properties_grow_with_the_power_of_their_dimension(which):
    one, three = SAMPLES[which](1.0), SAMPLES[which](3.0)
    for name, power in POWERS.items():
        assert getattr(three, name) == pytest.approx(3.0**power * getattr(one, name)), name


@pytest.mark.parametrize("which", ["rounded box", "sharp box", "board"])
def test_lying_on_its_side_y_and_z_change_places(which):
    section = SAMPLES[which](1.0)
    h, b, t, r = section.height, section.width, section.web, section.radius
    lying = rectangle(b, h) if which == "board" else rectangular_hollow(b, h, t, r)
    for name in ("inertia", "shear", "elastic", "plastic"):
        assert getattr(lying, f"{name}_y") == pytest.approx(getattr(section, f"{name}_z")), name
        assert getattr(lying, f"{name}_z") == pytest.approx(getattr(section, f"{name}_y")), name
    for name in ("area", "torsion", "torsion_modulus", "perimeter"):
        assert getattr(lying, name) == pytest.approx(getattr(section, name)), name


def test_torsion_of_rectangles_is_that_of_timoshenko_and_goodier():
    """Theory of Elasticity, table in art. 109: J = k₁ a b³ and τ_max = T ÷ (k₂ a b²)."""
    ratio = np.array([1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 10.0])
    k1 = [0.1406, 0.166, 0.196, 0.229, 0.249, 0.263, 0.281, 0.291, 0.312]
    k2 = [0.208, 0.219, 0.231, 0.246, 0.258, 0.267, 0.282, 0.291, 0.312]
    section = rectangle(0.1 * ratio, 0.1)
    assert section.torsion / (ratio * 1e-4) == pytest.approx(np.array(k1), abs=6e-4)
    assert section.torsion_modulus / (ratio * 1e-3) == pytest.approx(np.array(k2), abs=6e-4)


def test_torsion_of_a_long_thin_rectangle_is_a_third_of_its_length_by_thickness_cubed():
    section = rectangle(2.0, 0.002)
    assert section.torsion[0] == pytest.approx(2.0 * 0.002**3 / 3 * (1 - 0.63025e-3), rel=1e-8)
    assert section.torsion_modulus[0] == pytest.approx(section.torsion[0] / 0.002, rel=1e-12)


def test_a_thin_box_has_the_thin_walled_properties():
    """Bredt's J and modulus; a square's shear area is 5/12 of its area (Cowper, m = n = 1)."""
    side, t = 1.0, 1e-5
    section = rectangular_hollow(side, side, t, 0.0)
    middle = side - t
    assert section.torsion[0] == pytest.approx(t * middle**3, rel=1e-8)
    assert section.torsion_modulus[0] == pytest.approx(2 * middle**2 * t, rel=1e-4)
    assert section.shear_z[0] / section.area[0] == pytest.approx(5 / 12, rel=1e-8)


def test_shear_areas_of_a_thin_box_are_cowpers():
    """Cowper 1966, thin-walled box, ν = 0, with m = b t₁ ÷ h t and n = b ÷ h."""
    h, b, t = 2.0, 0.8, 1e-5
    m = n = b / h
    below = 12 + 72 * m + 150 * m**2 + 90 * m**3 + 10 * n**2 * (3 * m + 3 * m**2)
    kappa = 10 * (1 + 3 * m) ** 2 / below
    section = rectangular_hollow(h, b, t, 0.0)
    assert section.shear_z[0] / section.area[0] == pytest.approx(kappa, rel=1e-4)


def test_thicker_tubes_have_the_shear_area_between_thin_and_solid():
    """Cowper 1966 with ν = 0: a half of a thin tube, 6/7 of a round bar."""
    section = circular_hollow(1.0, [1e-6, 0.1, 0.3, 0.5 - 1e-9])
    share = section.shear_z / section.area
    assert share[[0, -1]] == pytest.approx([1 / 2, 6 / 7], rel=1e-5)
    assert (np.diff(share) > 0).all()


def test_many_sections_at_once_are_each_what_they_are_alone():
    heights, thicknesses = np.array([0.1, 0.2, 0.4]), np.array([0.005, 0.006, 0.01])
    many = rectangular_hollow(heights, 0.1, thicknesses)
    assert len(many) == 3
    for i in range(3):
        alone = rectangular_hollow(heights[i], 0.1, thicknesses[i])
        for f in fields(Sections):
            assert getattr(many.take(np.array([i])), f.name) == getattr(alone, f.name)
    assert [str(n) for n in many.name] == ["SHS 100×100×5", "RHS 200×100×6", "RHS 400×100×10"]


def test_joined_sections_keep_their_order_shapes_and_names():
    parts = [SAMPLES[which](1.0) for which in SAMPLES]
    joined = joined_sections(parts)
    assert [SHAPES[i] for i in joined.shape] == ["rhs", "rhs", "chs", "i", "rectangle"]
    assert list(joined.name) == [part.name[0] for part in parts]
    assert joined.area == pytest.approx([part.area[0] for part in parts])


def test_cold_formed_corners_get_the_inner_radius_of_their_standard():
    """EN 10219-2: outside 2 t, inside 1 t. SHS 100×100×5 has 18.4 cm² and 271 cm⁴."""
    cold = rectangular_hollow(0.1, 0.1, 0.005, 0.01)
    assert cold.area[0] * 1e4 == pytest.approx(18.4, abs=0.05)
    assert cold.inertia_y[0] * 1e8 == pytest.approx(271, abs=0.5)


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (lambda: rectangular_hollow([0.1, 0.02], 0.1, 0.01), "RHS 20×100×10"),
        (lambda: rectangular_hollow(0.1, 0.1, 0.01, 0.06), "too round"),
        (lambda: rectangular_hollow(0.1, 0.1, 0.0), "needs a height"),
        (lambda: rectangular_hollow(np.inf, 0.1, 0.01), "needs a height"),
        (lambda: circular_hollow(0.1, 0.05), "walls that fill it"),
        (lambda: circular_hollow(-0.1, 0.05), "needs a diameter"),
        (lambda: i_section(0.1, 0.05, 0.06, 0.01, 0.0), "fill it"),
        (lambda: i_section(0.1, 0.05, 0.01, 0.01, 0.03), "too round"),
        (lambda: rectangle(np.nan, 0.1), "needs a height"),
    ],
)
def test_a_section_that_cannot_be_is_refused_by_name(build, said):
    with pytest.raises(ParameterError, match=said):
        build()


def _outlines():
    """The same sections for sectionproperties, and how far torsion and shear may be apart."""
    from sectionproperties.pre import Geometry
    from sectionproperties.pre import library as shapes
    from shapely import box

    def rounded(h, b, r):
        return box(-b / 2 + r, -h / 2 + r, b / 2 - r, h / 2 - r).buffer(r, quad_segs=12)

    ring = rounded(0.15, 0.1, 0.012).difference(rounded(0.134, 0.084, 0.008))
    return {
        "rounded box": (Geometry(ring), 0.022, 0.07),
        "sharp box": (shapes.rectangular_hollow_section(0.4, 0.1, 0.01, 0.0, 1), 0.025, 0.06),
        "tube": (shapes.circular_hollow_section(0.1683, 0.008, 96), 0.003, 0.003),
        "i": (shapes.i_section(0.3, 0.15, 0.0107, 0.0071, 0.015, 10), 0.02, 0.1),
        "board": (shapes.rectangular_section(0.2, 0.02), 0.001, 0.001),
    }


@pytest.mark.peer
@pytest.mark.parametrize("which", SAMPLES)
def test_sectionproperties_finds_the_same(which):
    """By finite elements, ν = 0. What is apart is its polygons' corners, and our middle lines."""
    pytest.importorskip("sectionproperties")
    from sectionproperties.analysis import Section

    section = SAMPLES[which](1.0)
    geometry, torsion, shear = _outlines()[which]
    peer = Section(
        geometry.create_mesh(mesh_sizes=[section.area[0] / (400 if which == "board" else 120)])
    )
    peer.calculate_geometric_properties()
    peer.calculate_plastic_properties()
    peer.calculate_warping_properties()
    exact = {
        "area": peer.get_area(),
        "inertia_y": peer.get_ic()[0],
        "inertia_z": peer.get_ic()[1],
        "elastic_y": peer.get_z()[0],
        "elastic_z": peer.get_z()[2],
        "plastic_y": peer.get_s()[0],
        "plastic_z": peer.get_s()[1],
    }
    for name, value in exact.items():
        assert getattr(section, name)[0] == pytest.approx(value, rel=2e-3), name
    assert section.torsion[0] == pytest.approx(peer.get_j(), rel=torsion)
    assert section.shear_y[0] == pytest.approx(peer.get_as()[0], rel=shear)
    assert section.shear_z[0] == pytest.approx(peer.get_as()[1], rel=shear)
