"""Steel members against EN 1993-1-1 and EN 1993-1-5, all at once."""

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .checking import Checked, Demand
from .grade import Grade
from .sections import SHAPES, Sections
from .steel_class import Classes, member_class, section_class
from .steel_demand import Forces, forces_of, worst_of_checks
from .steel_interaction import combined
from .steel_member import member_checks
from .steel_resistance import Resistance, SteelRules, resistance_of

NAMES = (
    "Axial force, EN 1993-1-1 6.2.3 and 6.2.4",
    "Shear along y with torsion, EN 1993-1-1 6.2.6 and 6.2.7",
    "Shear along z with torsion, EN 1993-1-1 6.2.6 and 6.2.7",
    "Torsion, EN 1993-1-1 6.2.7",
    "Bending, shear and axial force, EN 1993-1-1 6.2.5 and 6.2.8 to 6.2.10",
    "Flexural buckling, EN 1993-1-1 6.3.1",
    "Lateral-torsional buckling, EN 1993-1-1 6.3.2",
    "Buckling with bending, EN 1993-1-1 (6.61)",
    "Buckling with bending, EN 1993-1-1 (6.62)",
    "Tubes of class 4, outside EN 1993-1-1 (see EN 1993-1-6)",
)
_DEFAULT = SteelRules()


def check_steel(
    demand: Demand, sections: Sections, grade: Grade, rules: SteelRules = _DEFAULT
) -> Checked:
    """How much steel members use of each limit of EN 1993-1-1:2005 and EN 1993-1-5:2006.

    ``sections``: one for each of the M members of ``demand``, whose stations are evenly spaced from
    end to end. Each cross-section is of the class that its forces make it (`section_class`), and
    resists as that class does: plastic, elastic, or, in class 4, what EN 1993-1-5 4.4 leaves.
    A tube of class 4 with anything in compression is outside both codes: its last check is
    infinite. Buckling goes by the class of the most stressed cross-section; ``section_class`` is
    the worst of those over the combinations.

    Utilisations grow in proportion to the forces where they can: the interaction of 6.2.9.1 is
    told as the factor by which the forces exceed it, 1 exactly where the code's formula is 1.

    What is on the safe side: η = 1 and no part of the flanges in shear buckling; Saint-Venant
    torsion only; a solid section's shear elastic; the class of combinations dominated by axial
    force that of pure compression; slopes of Annex B never negative. What is left out: shear lag,
    web crippling and patch loading, f_y by thickness (it is as the grade says), loads above the
    shear centre. Lateral buckling is that of bending about y: square and circular hollow sections
    have none (6.3.2.1(2)), slender rectangular ones do, as `lateral_imperfections` says.

    At given forces and one width and thickness, a higher section is mostly less used, not always:
    where the class falls, so do its resistances, in high narrow boxes by a third and more at once.

    Raises ParameterError where the grade is no steel with a yield strength, SceneError for forces
    that do not fit.
    """
    if grade.kind != "steel" or grade.yield_strength <= 0:
        raise ParameterError(
            f"“{grade.name}” is no steel with a yield strength, and EN 1993-1-1 needs one; take "
            "a steel grade."
        )
    forces = forces_of(demand, sections)
    resistance = resistance_of(sections, grade, rules.partial_section)
    stressing = forces.axial, forces.moment_y, forces.moment_z
    classes = section_class(*stressing, sections, grade)
    whole = member_class(classes, *stressing, sections)
    twist = forces.torsion / resistance.torsion
    along_y, along_z = _shear(forces, resistance, sections, twist)
    loss_y, loss_z = _loss(along_y, twist, sections), _loss(along_z, twist, sections)
    bent = combined(forces, resistance, sections, classes, loss_y, loss_z)
    used = (
        np.maximum(forces.axial / resistance.axial, forces.axial / -resistance.compression),
        along_y,
        along_z,
        twist,
        bent,
        *member_checks(demand, forces, sections, grade, resistance, whole, rules),
        _scope(classes, sections),
    )
    return worst_of_checks(NAMES, used, bent, whole.max(axis=0))


def _shear(
    forces: Forces, resistance: Resistance, sections: Sections, twist: Vector
) -> tuple[Vector, Vector]:
    """What shear along y and along z uses of V_pl,T,Rd (K, S, M), 6.2.7(9)."""
    along_y = forces.shear_y / resistance.shear_y
    along_z = forces.shear_z / resistance.shear_z
    rolled = sections.shape == SHAPES.index("i")
    if rolled.any():
        left = np.sqrt(np.maximum(1.0 - twist / 1.25, 1e-6))
        return (
            np.where(rolled, along_y / left, along_y + twist),
            np.where(rolled, along_z / left, along_z + twist),
        )
    along_y += twist
    along_z += twist
    return along_y, along_z


def _loss(along: Vector, twist: Vector, sections: Sections) -> Vector | None:
    """ρ of 6.2.8(3) and (4) (K, S, M): the share of f_y that shear takes; None where none does."""
    rolled = sections.shape == SHAPES.index("i")
    taken = np.where(rolled, 0.0, np.minimum(twist, 0.999))
    # V > V_pl,T,Rd/2, written with what torsion takes on its left.
    if not (2.0 * along > 1.0 + taken).any():
        return None
    ratio = (along - taken) / (1.0 - taken)
    return np.where(ratio > 0.5, np.minimum((2.0 * ratio - 1.0) ** 2, 1.0), 0.0)


def _scope(classes: Classes, sections: Sections) -> Vector:
    """Infinite where a tube is of class 4 under what compresses it (K, S, M)."""
    tubes: NDArray[np.bool_] = sections.shape == SHAPES.index("chs")
    outside = np.zeros(classes.shape)
    if tubes.any():
        outside[(classes == 4) & tubes] = np.inf
    return outside
