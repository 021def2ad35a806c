"""A structure as it is drawn: its frame, the surface it lies on and what its members are for."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .frame import Frame

NO_NODE = -1


@dataclass(frozen=True, slots=True)
class Model:
    """A frame with the cells between its members, and what its members are for.

    ``cells`` (F, 4) int32: node indices around each cell, the last NO_NODE in a triangle,
    counter-clockwise seen from where ``normals`` of the members point; loads on the surface act on
    them. ``surface`` (M, 2) float64: u and v in 0..1 of each member's middle on its surface, NaN
    for those beside it (columns). ``groups`` (M,) int32 into ``group_names``: ribs, columns, rings,
    diagonals. ``notes``: what was assumed or repaired.
    """

    frame: Frame
    cells: NDArray[np.int32]
    surface: Vector
    groups: NDArray[np.int32]
    group_names: tuple[str, ...]
    notes: tuple[str, ...] = field(default=())
