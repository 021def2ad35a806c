"""What every member check is given, and what it answers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector

FORCES = ("N", "Vy", "Vz", "T", "My", "Mz")


@dataclass(frozen=True, slots=True)
class Demand:
    """Section forces of K combinations at S stations along each of M members.

    ``forces`` (K, M, S, 6) in N and N·m in the order of FORCES, local axes, acting on the face
    whose outward normal is local x: N is positive in tension. ``lengths`` (M,) in m;
    ``buckling_y``, ``buckling_z`` (M,): the lengths in m over which a member buckles about y and
    about z; ``lateral`` (M,): between lateral restraints, for lateral-torsional buckling.
    ``duration`` (K,) text or None: the load-duration class of each combination, for timber.
    """

    forces: Vector
    lengths: Vector
    buckling_y: Vector
    buckling_z: Vector
    lateral: Vector
    duration: NDArray[np.str_] | None = None

    def of(self, members: NDArray[np.integer] | NDArray[np.bool_]) -> "Demand":
        """The demand on some of the members."""
        return Demand(
            self.forces[:, members],
            self.lengths[members],
            self.buckling_y[members],
            self.buckling_z[members],
            self.lateral[members],
            self.duration,
        )


@dataclass(frozen=True, slots=True)
class Checked:
    """How much of each limit is used: Q checks of M members.

    ``names`` (Q,): each check with its clause, "Bending and axial force, EN 1993-1-1 6.2.9.1".
    ``utilisation`` (Q, M): the worst over combinations and stations, at most 1 where it holds;
    ``combination`` and ``station`` (Q, M) int32: where that is. ``section_class`` (M,) int8: 1 to 4
    of EN 1993-1-1, 0 where there is none.
    """

    names: tuple[str, ...]
    utilisation: Vector
    combination: NDArray[np.int32]
    station: NDArray[np.int32]
    section_class: NDArray[np.int8]

    def worst(self) -> Vector:
        """The greatest utilisation of each member (M,)."""
        return self.utilisation.max(axis=0)
