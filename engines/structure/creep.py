"""Creep of timber in structures that may have steel beside it, EN 1995-1-1 2.2.3 and 2.3.2.2."""

from dataclasses import replace

from ..core.scene import Vector
from .combinations import Combinations
from .frame import Rigidities
from .response import Response


def crept_rigidities(rigidities: Rigidities, creep: Vector) -> Rigidities:
    """What the members resist with under loads that last: every modulus over 1 + k_def.

    ``creep`` (M,): k_def of each member, 0 for steel. Equations 2.7 to 2.9.
    """
    share = 1.0 / (1.0 + creep)
    return replace(
        rigidities,
        axial=rigidities.axial * share,
        bending_y=rigidities.bending_y * share,
        bending_z=rigidities.bending_z * share,
        torsion=rigidities.torsion * share,
        shear_y=rigidities.shear_y * share,
        shear_z=rigidities.shear_z * share,
    )


def final_deflections(
    initial: Response, crept: Response, combinations: Combinations, stations: Vector
) -> Vector:
    """Displacements (K, M, S, 3) in m along the members once the timber has crept.

    ``initial`` and ``crept``: the responses to the same C load cases with the members' rigidities
    and with those of `crept_rigidities`. The lasting part of each combination acts on the crept
    structure, the rest on the fresh one. Where all members creep alike, that is u_fin of equations
    2.2 to 2.5; where they do not, the crept structure passes forces on to what creeps less.
    """
    passing = initial.combined(combinations.factors - combinations.lasting)
    lasting = crept.combined(combinations.lasting)
    return passing.deflections(stations) + lasting.deflections(stations)
