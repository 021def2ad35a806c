"""Members of rectangular timber against EN 1995-1-1, all at once."""

from dataclasses import dataclass

import numpy as np

from ..core.errors import ParameterError
from ..core.scene import Vector
from .checking import FORCES, Checked, Demand
from .grade import Grade
from .sections import SHAPES, Sections
from .timber_rules import (
    TimberRules,
    check_grade,
    modification,
    partial_factor,
    size_factor,
)
from .timber_stability import SLENDER, Stability, stability_of

NAMES = (
    "Tension and bending, EN 1995-1-1 6.2.3",
    "Compression and bending, EN 1995-1-1 6.2.4",
    "Column buckling, EN 1995-1-1 6.3.2",
    "Lateral torsional buckling, EN 1995-1-1 6.3.3",
    "Shear, EN 1995-1-1 6.1.7",
    "Torsion, EN 1995-1-1 6.1.8",
    "Shear with torsion, EN 1995-1-1 6.1.7 and 6.1.8",
)
_DEFAULT = TimberRules()
_BLOCK = 4000  # values of each array that are worked on at once


def check_timber(
    demand: Demand, sections: Sections, grade: Grade, rules: TimberRules = _DEFAULT
) -> Checked:
    """How much rectangular timber members use of each limit of EN 1995-1-1:2004 with A1 and A2.

    ``sections``: one for each of the M members of ``demand``. Design strengths are
    k_mod k_h f_k / γ_M, k_mod by the service class and the load-duration class of each combination.
    Buckling lengths of 0 leave buckling to the analysis.

    Two checks go beyond EN 1995-1-1 where it is silent, as DIN EN 1995-1-1/NA does: equation 6.35
    gets σ_m,z/f_m,z as a further term for a beam that bends sideways besides, and shear along y,
    along z and torsion together are held to τ_tor/(k_shape f_v) + (τ_y/f_v)² + (τ_z/f_v)² ≤ 1.

    Raises ParameterError where the grade has no strengths for EN 1995-1-1, a section is no
    rectangle, or a load-duration class is unknown.
    """
    check_grade(grade)
    _check_shapes(sections)
    combinations, members, stations, _ = demand.forces.shape
    worst = np.zeros((len(NAMES), members))
    where = np.zeros((len(NAMES), members), dtype=np.intp)
    # A block's arrays stay in the processor's cache, which makes this about twice as fast.
    size = max(1, _BLOCK // max(1, combinations * stations))
    for start in range(0, members, size):
        block = np.arange(start, min(start + size, members))
        used = _used_by(demand.of(block), sections.take(block), grade, rules)
        for check, values in enumerate(used):
            where[check, block] = values.argmax(axis=1)
            worst[check, block] = values.max(axis=1)
    return Checked(
        NAMES,
        worst,
        (where // stations).astype(np.int32),
        (where % stations).astype(np.int32),
        np.zeros(members, dtype=np.int8),
    )


def _used_by(demand: Demand, sections: Sections, grade: Grade, rules: TimberRules) -> list[Vector]:
    """What each check uses (M, K·S), combination by combination and station by station."""
    forces = _scaled_forces(demand, grade, rules)
    resistance = _resistance_of(sections, grade, rules)
    stability = stability_of(
        sections, grade, demand.buckling_y, demand.buckling_z, demand.lateral, rules
    )
    return [
        *_axial_and_bending(forces, sections, resistance, stability, rules.redistribution),
        *_shear_and_torsion(forces, resistance),
    ]


@dataclass(frozen=True, slots=True)
class _Resistance:
    """What M sections bear at their characteristic strengths, each (M, 1) in N or N·m."""

    tension: Vector
    compression: Vector
    bending_y: Vector
    bending_z: Vector
    shear: Vector
    torsion: Vector


def _check_shapes(sections: Sections) -> None:
    other = np.flatnonzero(sections.shape != SHAPES.index("rectangle"))
    if other.size:
        raise ParameterError(
            f"The section “{sections.name[other[0]]}” is no rectangle, and only rectangles of "
            "timber are checked by EN 1995-1-1; take a timber family."
        )


def _scaled_forces(demand: Demand, grade: Grade, rules: TimberRules) -> Vector:
    """The forces over k_mod/γ_M (6, M, K·S), to be compared with characteristic resistances."""
    combinations, members, stations, _ = demand.forces.shape
    durations = demand.duration
    if durations is None:
        durations = np.full(combinations, rules.duration)
    scale = partial_factor(grade, rules) / modification(durations, rules)
    forces = np.empty((len(FORCES), members, combinations, stations))
    np.multiply(demand.forces.transpose(3, 1, 0, 2), scale[:, None], out=forces)
    return forces.reshape(len(FORCES), members, combinations * stations)


def _resistance_of(sections: Sections, grade: Grade, rules: TimberRules) -> _Resistance:
    height, width = sections.height, sections.width
    larger, smaller = np.maximum(height, width), np.minimum(height, width)
    size_y, size_z = size_factor(height, grade), size_factor(width, grade)
    if grade.glued:
        # Laminations lie across the larger side; 3.3 is for bending across them only.
        size_y = np.where(height < width, 1.0, size_y)
        size_z = np.where(height < width, size_z, 1.0)
    shape = np.minimum(1.0 + 0.05 * larger / smaller, 1.3)  # equation 6.15
    strengths = (
        sections.area * size_factor(larger, grade) * grade.tension,
        sections.area * grade.compression,
        sections.elastic_y * size_y * grade.bending,
        sections.elastic_z * size_z * grade.bending,
        sections.area * rules.crack / 1.5 * grade.shear_strength,
        sections.torsion_modulus * shape * grade.shear_strength,
    )
    return _Resistance(*(one[:, None] for one in strengths))


def _axial_and_bending(
    forces: Vector, sections: Sections, resistance: _Resistance, stability: Stability, share: float
) -> list[Vector]:
    """Tension, compression, columns and lateral buckling, each (M, K·S); ``share`` is k_m."""
    axial = forces[FORCES.index("N")]
    tension = np.maximum(axial, 0.0) / resistance.tension
    compression = np.maximum(-axial, 0.0) / resistance.compression
    about_y = np.abs(forces[FORCES.index("My")]) / resistance.bending_y
    about_z = np.abs(forces[FORCES.index("Mz")]) / resistance.bending_z
    mostly_y = about_y + share * about_z
    mostly_z = share * about_y + about_z
    bending = np.maximum(mostly_y, mostly_z)
    pressed = compression > 0.0

    along_y = compression / stability.column_y[:, None]
    along_z = compression / stability.column_z[:, None]
    slender = np.maximum(stability.slenderness_y, stability.slenderness_z) > SLENDER
    column = np.maximum(along_y + mostly_y, along_z + mostly_z)

    # A beam buckles sideways when it bends in the direction in which it is deeper.
    upright = (sections.height >= sections.width)[:, None]
    deep = np.where(upright, about_y, about_z) / stability.lateral[:, None]
    flat = np.where(upright, about_z, about_y)
    lateral = np.maximum(deep, deep**2 + flat + np.where(upright, along_z, along_y))
    return [
        np.where(pressed, 0.0, tension + bending),
        np.where(pressed, compression**2 + bending, 0.0),
        np.where(pressed & slender[:, None], column, 0.0),
        lateral,
    ]


def _shear_and_torsion(forces: Vector, resistance: _Resistance) -> list[Vector]:
    """Shear, torsion and both together, each (M, K·S)."""
    along_y = np.abs(forces[FORCES.index("Vy")]) / resistance.shear
    along_z = np.abs(forces[FORCES.index("Vz")]) / resistance.shear
    torsion = np.abs(forces[FORCES.index("T")]) / resistance.torsion
    return [
        np.maximum(along_y, along_z),
        torsion,
        torsion + along_y**2 + along_z**2,
    ]
