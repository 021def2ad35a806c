"""Section forces as the checks of members use them, and the worst of what they answer."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.scene import Vector
from .checking import Checked, Demand
from .sections import Sections


@dataclass(frozen=True, slots=True)
class Forces:
    """Section forces of K combinations at S stations of M members, each (K, S, M).

    ``axial`` in N, positive in tension; ``moment_y`` and ``moment_z`` in N·m with their signs;
    ``shear_y``, ``shear_z`` in N and ``torsion`` in N·m without.
    """

    axial: Vector
    shear_y: Vector
    shear_z: Vector
    torsion: Vector
    moment_y: Vector
    moment_z: Vector


def forces_of(demand: Demand, sections: Sections) -> Forces:
    """The demand's forces, laid out so that what belongs to neighbouring members lies side by side.

    Raises SceneError where the demand is not of as many members as there are sections, or a force
    is no number.
    """
    members = demand.forces.shape[1]
    if members != len(sections):
        raise SceneError(
            f"There are forces of {members} members but {len(sections)} sections; give one section "
            "for each member."
        )
    forces = np.ascontiguousarray(demand.forces.transpose(3, 0, 2, 1))
    if not np.isfinite(forces.sum()):
        wrong = int(np.argmin(np.isfinite(forces).all(axis=(0, 1, 2))))
        raise SceneError(
            f"The section forces of member {wrong} are not finite; analyse the frame again, and "
            "look there for a mechanism or a load that is no number."
        )
    np.abs(forces[1:4], out=forces[1:4])
    return Forces(*forces)


def worst_of_checks(
    names: tuple[str, ...],
    used: Sequence[Vector],
    governing: Vector,
    section_class: NDArray[np.int8],
) -> Checked:
    """The worst of each check, and where it is.

    ``used``: for each name (K, S, M), or (K, M) where the check is of a whole member; of those the
    station is the one where ``governing`` (K, S, M) is greatest.
    """
    shape = len(used), governing.shape[2]
    utilisation = np.empty(shape)
    combination, station = np.empty(shape, np.int32), np.empty(shape, np.int32)
    stations, members = governing.shape[1], np.arange(governing.shape[2])
    for row, values in enumerate(used):
        flat = values.reshape(int(np.prod(values.shape[:-1])), len(members))
        where = flat.argmax(axis=0)
        utilisation[row] = flat[where, members]
        if values.ndim == 3:
            combination[row], station[row] = np.divmod(where, stations)
        else:
            combination[row] = where
            station[row] = governing[where, :, members].argmax(axis=1)
    return Checked(names, utilisation, combination, station, section_class)
