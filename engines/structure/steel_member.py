"""Buckling of whole steel members, EN 1993-1-1 6.3."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .checking import Demand
from .grade import Grade
from .sections import SHAPES, Sections
from .steel_class import Classes
from .steel_demand import Forces
from .steel_resistance import Resistance, SteelRules
from .steel_stability import (
    critical_force,
    critical_moment,
    critical_torsion,
    ends_and_middle,
    equivalent_moment,
    imperfections,
    lateral_imperfections,
    lateral_reduction_factor,
    moment_gradient,
    reduction_factor,
)

Mask = NDArray[np.bool_]
_SWAY = 0.9
_PLATEAU = 0.4  # λ_LT up to which nothing buckles laterally, 6.3.2.2(4)


@dataclass(frozen=True, slots=True)
class _Columns:
    """Flexural buckling of M members: N_b,Rd in N and λ about y and z, each (M,)."""

    resistance_y: Vector
    resistance_z: Vector
    slenderness_y: Vector
    slenderness_z: Vector


def member_checks(
    demand: Demand,
    forces: Forces,
    sections: Sections,
    grade: Grade,
    resistance: Resistance,
    classes: Classes,
    rules: SteelRules,
) -> tuple[Vector, Vector, Vector, Vector]:
    """What compression, bending about y and both together use of each member, each (K, M).

    By 6.3.1, 6.3.2 and, with Annex B, equations 6.61 and 6.62. ``classes`` (K, M) of the members.
    """
    partial = rules.partial_section / rules.partial_member  # γM0 is in the resistances
    slender = classes == 4
    effective = _columns(demand, sections, grade, resistance.compression, rules)
    compression = np.maximum(-forces.axial.min(axis=1), 0.0)
    least = np.minimum(effective.resistance_y, effective.resistance_z)
    flexural = compression / least

    columns = effective
    if (resistance.even == 4).any() and not slender.all():
        # In class 3 and better the whole area counts, though not in pure compression.
        columns = _chosen(
            slender, effective, _columns(demand, sections, grade, resistance.axial, rules)
        )
    moment_y = _by_class(
        classes, resistance.plastic_y, resistance.elastic_y, resistance.effective_y
    )
    moment_z = _by_class(
        classes, resistance.plastic_z, resistance.elastic_z, resistance.effective_z
    )
    diagram_y, diagram_z = ends_and_middle(forces.moment_y), ends_and_middle(forces.moment_z)
    most_y = np.abs(forces.moment_y).max(axis=1)
    used_z = np.abs(forces.moment_z).max(axis=1) / (moment_z * partial)

    lateral = _lateral(demand, sections, grade, moment_y * rules.partial_section, diagram_y)
    used_y = most_y / (moment_y * partial)
    turned = used_y if lateral is None else used_y / lateral
    beam = np.zeros_like(used_y) if lateral is None else np.where(lateral < 1.0, turned, 0.0)

    if rules.sway:
        factor_y = factor_z = np.full_like(used_y, _SWAY)
    else:
        factor_y, factor_z = equivalent_moment(*diagram_y), equivalent_moment(*diagram_z)
    ratio_y = compression / columns.resistance_y
    ratio_z = compression / columns.resistance_z
    plastic = classes <= 2
    slope_y, slope_z = _slopes(columns, sections, plastic)
    k_yy = factor_y * (1.0 + slope_y * ratio_y)
    k_zz = factor_z * (1.0 + slope_z * ratio_z)
    k_yz = np.where(plastic, 0.6, 1.0) * k_zz
    k_zy = np.where(plastic, 0.6, 0.8) * k_yy
    open_ = (sections.shape == SHAPES.index("i")) | (sections.shape == SHAPES.index("rectangle"))
    if lateral is not None or open_.any():
        twisting = open_ if lateral is None else open_ | (lateral < 1.0)
        k_zy = np.where(
            twisting, _twisting(columns.slenderness_z, ratio_z, factor_y, plastic), k_zy
        )
    return (
        flexural,
        beam,
        ratio_y + k_yy * turned + k_yz * used_z,
        ratio_z + k_zy * turned + k_zz * used_z,
    )


def _columns(
    demand: Demand, sections: Sections, grade: Grade, axial: Vector, rules: SteelRules
) -> _Columns:
    """6.3.1 for the cross-sections' resistances ``axial`` (M,), which have γM0 in them."""
    characteristic = axial * rules.partial_section
    alpha_y, alpha_z = imperfections(sections, grade, rules.hollow)
    critical_y = critical_force(grade.youngs * sections.inertia_y, demand.buckling_y)
    critical_z = critical_force(grade.youngs * sections.inertia_z, demand.buckling_z)
    rolled = sections.shape == SHAPES.index("i")
    if rolled.any():
        torsional = critical_torsion(sections, grade, demand.lateral)
        critical_z = np.where(rolled, np.minimum(critical_z, torsional), critical_z)
    slenderness_y = np.sqrt(characteristic / critical_y)
    slenderness_z = np.sqrt(characteristic / critical_z)
    design = characteristic / rules.partial_member
    return _Columns(
        reduction_factor(slenderness_y, alpha_y) * design,
        reduction_factor(slenderness_z, alpha_z) * design,
        slenderness_y,
        slenderness_z,
    )


def _chosen(slender: Mask, effective: _Columns, gross: _Columns) -> _Columns:
    """The columns (K, M) of the effective section where it is of class 4, else of the gross one."""
    return _Columns(
        np.where(slender, effective.resistance_y, gross.resistance_y),
        np.where(slender, effective.resistance_z, gross.resistance_z),
        np.where(slender, effective.slenderness_y, gross.slenderness_y),
        np.where(slender, effective.slenderness_z, gross.slenderness_z),
    )


def _by_class(classes: Classes, plastic: Vector, elastic: Vector, effective: Vector) -> Vector:
    return np.where(classes <= 2, plastic, np.where(classes == 3, elastic, effective))


def _lateral(
    demand: Demand,
    sections: Sections,
    grade: Grade,
    moment: Vector,
    diagram: tuple[Vector, Vector, Vector],
) -> Vector | None:
    """χ_LT (K, M) for characteristic moments ``moment`` (K, M), None where nothing buckles so.

    C_1 is that of the whole member's moments, and 1 where it is held in between.
    """
    tube = sections.shape == SHAPES.index("chs")
    critical = critical_moment(sections, grade, demand.lateral)
    stocky = tube | (sections.inertia_z >= sections.inertia_y)
    critical[stocky] = np.inf
    if (moment <= _PLATEAU**2 * critical).all():
        return None
    gradient = np.where(demand.lateral < 0.999 * demand.lengths, 1.0, moment_gradient(*diagram))
    slenderness = np.sqrt(moment / (gradient * critical))
    return lateral_reduction_factor(slenderness, lateral_imperfections(sections))


def _slopes(columns: _Columns, sections: Sections, plastic: Mask) -> tuple[Vector, Vector]:
    """How k_yy/C_my and k_zz/C_mz grow with the axial force (K, M), Table B.1."""
    y, z = columns.slenderness_y, columns.slenderness_z
    elastic_y, elastic_z = 0.6 * np.minimum(y, 1.0), 0.6 * np.minimum(z, 1.0)
    plastic_y = np.clip(y - 0.2, 0.0, 0.8)
    hollow = (sections.shape == SHAPES.index("rhs")) | (sections.shape == SHAPES.index("chs"))
    plastic_z = np.where(hollow, np.clip(z - 0.2, 0.0, 0.8), np.clip(2 * z - 0.6, 0.0, 1.4))
    return np.where(plastic, plastic_y, elastic_y), np.where(plastic, plastic_z, elastic_z)


def _twisting(slenderness_z: Vector, ratio_z: Vector, factor: Vector, plastic: Mask) -> Vector:
    """k_zy of members that twist (K, M), Table B.2, C_mLT being ``factor``."""
    decay = np.where(plastic, 0.1, 0.05) / (factor - 0.25) * ratio_z
    slow = 1.0 - decay * np.minimum(slenderness_z, 1.0)
    stocky = plastic & (slenderness_z < 0.4)
    return np.where(stocky, np.minimum(0.6 + slenderness_z, slow), slow)
