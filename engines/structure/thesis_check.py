"""Members checked as Karamba3D checks them, for the thesis's results: steel and timber alike."""

import numpy as np

from ..core.errors import ParameterError
from ..core.scene import Vector
from .checking import Checked, Demand
from .grade import Grade
from .sections import SHAPES, Sections
from .steel_demand import Forces, forces_of, worst_of_checks
from .steel_resistance import shear_areas
from .steel_stability import (
    IMPERFECTION,
    critical_force,
    critical_moment,
    ends_and_middle,
    equivalent_moment,
    imperfections,
    reduction_factor,
)

NAMES = (
    "Axial force and bending, elastic, as Karamba3D after EN 1993-1-1 6.2.1(7)",
    "Shear and torsion, elastic, as Karamba3D after EN 1993-1-1 6.2.6 and 6.2.7",
    "Buckling about y with bending, as Karamba3D after EN 1993-1-1 (6.61)",
    "Buckling about z with bending, as Karamba3D after EN 1993-1-1 (6.62)",
)
TIMBER_STRENGTH = 13e6
"""f_y in Pa of wood in Karamba3D's material table, in tension and in compression."""


def check_thesis(
    demand: Demand, sections: Sections, grade: Grade, *, most_moment_factor: float = 0.9
) -> Checked:
    """How much of the limits Karamba3D's cross-section optimisation would find used.

    ``sections``: one for each of the M members of ``demand``. Steel has its yield strength
    (23.5 kN/cm² in the thesis), timber ± 1.3 kN/cm², and both the same formulas, all with
    γ_M0 = γ_M1 = 1. ``section_class`` is 0: no section is reduced for local buckling.

    Known, from its manual (A.2.6 “Approach used for cross section optimization”) and what its
    author published: the utilisation is that of EN 1993-1-1, elastic, with flexural and
    lateral-torsional buckling, Annex B (method 2) with C_my, C_mz and C_mLT of Table B.3 for
    uniform loads “limited to 0.9”, read here as capped (``most_moment_factor``; the author quotes
    0.95 from version 1.3, which 1.0 gives).

    Assumed: classes 3 and 4 of Tables B.1 and B.2 for k, hollow sections of buckling curve a
    (hot-finished) that do not buckle laterally, solid rectangles of curve c and, laterally,
    of curve d from M_cr under uniform moment; linear sums of stresses for members in tension and
    for cross-sections; shear along y and z on the areas of 6.2.6(3), summed with torsion.
    Karamba3D checks no timber code.

    At given forces, the utilisation falls as a section of one width and thickness grows higher:
    nothing jumps, and even lateral buckling leaves a higher rectangle the stronger.

    Raises ParameterError where a steel has no yield strength, SceneError for forces that do not
    fit.
    """
    forces = forces_of(demand, sections)
    strength = _strength_of(grade)
    axial = sections.area * strength
    bending_y, bending_z = sections.elastic_y * strength, sections.elastic_z * strength
    share_y = np.abs(forces.moment_y) / bending_y
    share_z = np.abs(forces.moment_z) / bending_z
    bent = share_y + share_z
    elastic = np.abs(forces.axial)
    elastic /= axial
    elastic += bent
    shear = _shear(forces, sections, strength)

    compression = np.maximum(-forces.axial.min(axis=1), 0.0) / axial
    most_y, most_z = share_y.max(axis=1), share_z.max(axis=1)
    factor_y, factor_z = (
        np.minimum(equivalent_moment(*ends_and_middle(moments)), most_moment_factor)
        for moments in (forces.moment_y, forces.moment_z)
    )
    alpha_y, alpha_z = imperfections(sections, grade, "hot-finished")
    slenderness_y = np.sqrt(
        axial / critical_force(grade.youngs * sections.inertia_y, demand.buckling_y)
    )
    slenderness_z = np.sqrt(
        axial / critical_force(grade.youngs * sections.inertia_z, demand.buckling_z)
    )
    ratio_y = compression / reduction_factor(slenderness_y, alpha_y)
    ratio_z = compression / reduction_factor(slenderness_z, alpha_z)
    k_yy = factor_y * (1.0 + 0.6 * np.minimum(slenderness_y, 1.0) * ratio_y)
    k_zz = factor_z * (1.0 + 0.6 * np.minimum(slenderness_z, 1.0) * ratio_z)
    lateral = sections.shape != SHAPES.index("rhs")
    lateral &= sections.shape != SHAPES.index("chs")
    k_zy = 0.8 * k_yy
    if lateral.any():
        moment = critical_moment(sections, grade, demand.lateral)
        slenderness = np.sqrt(bending_y / moment)
        # Above the plateau of 6.3.2.3 by the general case 6.3.2.2, whose curve has χ's formula.
        curve = reduction_factor(slenderness, IMPERFECTION["d"])
        most_y = most_y / np.where(lateral, curve, 1.0)
        decay = 0.05 * np.minimum(slenderness_z, 1.0) / np.maximum(factor_y - 0.25, 0.1)
        k_zy = np.where(lateral, 1.0 - decay * ratio_z, k_zy)
    about_y = ratio_y + k_yy * most_y + k_zz * most_z
    about_z = ratio_z + k_zy * most_y + k_zz * most_z
    return worst_of_checks(
        NAMES, (elastic, shear, about_y, about_z), bent, np.zeros(len(sections), np.int8)
    )


def _strength_of(grade: Grade) -> float:
    if grade.yield_strength > 0:
        return grade.yield_strength
    if grade.kind == "timber":
        return TIMBER_STRENGTH
    raise ParameterError(f"The steel “{grade.name}” has no yield strength; give it one in Pa.")


def _shear(forces: Forces, sections: Sections, strength: float) -> Vector:
    """The share of the shear stress f_y/√3 that shear along y and z and torsion use (K, S, M)."""
    stress = strength / np.sqrt(3.0)
    area_y, area_z = shear_areas(sections)
    used = forces.shear_y / (area_y * stress)
    used += forces.shear_z / (area_z * stress)
    used += forces.torsion / (sections.torsion_modulus * stress)
    return used
