"""Boxes, of which studies build rooms: slabs, walls, panes."""

from dataclasses import dataclass

import numpy as np

from ..core.parameters import param
from ..core.scene import Mesh

_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)])
_SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A box that stands on the middle of its base."""

    width: float = param(1.0, "m", 1e-4, 1e5, "Along X")
    length: float = param(1.0, "m", 1e-4, 1e5, "Along Y")
    height: float = param(1.0, "m", 1e-4, 1e5, "Along Z, up from the base")


def box_mesh(box: Box) -> Mesh:
    """Its six sides, which look outward, in m about the middle of its base."""
    return Mesh(_CORNERS * [box.width, box.length, box.height], np.array(_SIDES, np.int32))
