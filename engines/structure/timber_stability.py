"""Buckling of timber members by EN 1995-1-1 6.3: columns, and beams that turn sideways."""

from dataclasses import dataclass

import numpy as np

from ..core.scene import Vector
from .grade import Grade
from .sections import Sections
from .timber_rules import TimberRules

SLENDER = 0.3  # relative slenderness up to which a column does not buckle, 6.3.2(2)


@dataclass(frozen=True, slots=True)
class Stability:
    """What buckling leaves of M members' strengths, each (M,).

    ``slenderness_y`` and ``slenderness_z``: λ_rel; ``column_y`` and ``column_z``: k_c,y and k_c,z;
    ``lateral``: k_crit, of bending about the axis in which the section is deeper.
    """

    slenderness_y: Vector
    slenderness_z: Vector
    column_y: Vector
    column_z: Vector
    lateral: Vector


def stability_of(
    sections: Sections,
    grade: Grade,
    buckling_y: Vector,
    buckling_z: Vector,
    lateral: Vector,
    rules: TimberRules,
) -> Stability:
    """Slenderness and factors of M rectangular members, one section each.

    ``buckling_y``, ``buckling_z``: buckling lengths (M,) in m about y and z; ``lateral`` (M,) in m
    between lateral restraints. A length of 0 stands for a member that cannot buckle that way.
    """
    slender_y = relative_slenderness(buckling_y, sections.inertia_y, sections.area, grade)
    slender_z = relative_slenderness(buckling_z, sections.inertia_z, sections.area, grade)
    length = effective(lateral, sections, rules)
    stress = (softwood_stress if rules.critical == "softwood" else critical_stress)(
        sections, grade, length
    )
    return Stability(
        slender_y,
        slender_z,
        column_factor(slender_y, grade.glued),
        column_factor(slender_z, grade.glued),
        lateral_factor(np.sqrt(grade.bending / stress)),
    )


def relative_slenderness(length: Vector, inertia: Vector, area: Vector, grade: Grade) -> Vector:
    """λ_rel = λ/π · √(f_c,0,k / E_0,05), equations 6.21 and 6.22; ``length`` is the buckling length
    in m."""
    slenderness = length * np.sqrt(area / inertia)
    return slenderness / np.pi * np.sqrt(grade.compression / grade.youngs_low)


def column_factor(slenderness: Vector, glued: bool) -> Vector:
    """The factor k_c of a column with relative slenderness ``slenderness``, equations 6.25–6.29."""
    straightness = 0.1 if glued else 0.2
    k = 0.5 * (1.0 + straightness * (slenderness - SLENDER) + slenderness**2)
    # Below the limit the root may be of something negative, and the factor is 1 there.
    root = np.sqrt(np.maximum(k**2 - slenderness**2, 0.0))
    return np.where(slenderness <= SLENDER, 1.0, 1.0 / (k + root))


def effective(lateral: Vector, sections: Sections, rules: TimberRules) -> Vector:
    """The effective length (M,) in m for lateral buckling, Table 6.1 with its note."""
    depth = np.maximum(sections.height, sections.width)
    shift = {"axis": 0.0, "compression edge": 2.0, "tension edge": -0.5}[rules.load_at]
    return np.where(lateral > 0.0, np.maximum(rules.lateral * lateral + shift * depth, 0.0), 0.0)


def critical_stress(sections: Sections, grade: Grade, length: Vector) -> Vector:
    """σ_m,crit (M,) in Pa of bending in the deep direction over the effective ``length`` (M,) in m.

    Equation 6.31, for any timber. Infinite where the length is 0.
    """
    deep = np.maximum(sections.elastic_y, sections.elastic_z)
    weak = np.minimum(sections.inertia_y, sections.inertia_z)
    stiff = np.sqrt(grade.youngs_low * weak * grade.shear_low * sections.torsion)
    with np.errstate(divide="ignore"):
        return np.pi * stiff / (length * deep)


def softwood_stress(sections: Sections, grade: Grade, length: Vector) -> Vector:
    """The same for rectangles of softwood, equation 6.32, which takes G_05 as E_0,05 ÷ 16 and the
    torsion of a thin board."""
    depth = np.maximum(sections.height, sections.width)
    breadth = np.minimum(sections.height, sections.width)
    with np.errstate(divide="ignore"):
        return 0.78 * breadth**2 * grade.youngs_low / (depth * length)


def lateral_factor(slenderness: Vector) -> Vector:
    """The factor k_crit of a beam with λ_rel,m = √(f_m,k / σ_m,crit), equations 6.30 and 6.34."""
    with np.errstate(divide="ignore"):
        slim = 1.0 / slenderness**2
    between = np.where(slenderness <= 0.75, 1.0, 1.56 - 0.75 * slenderness)
    return np.where(slenderness > 1.4, slim, between)
