"""Walls in Blender: what their settings and the curves that they follow say."""

from collections.abc import Sequence
from typing import NamedTuple

import bpy
import numpy as np

from ...engines.core.errors import SceneError
from ...engines.core.scene import Vector
from ...engines.glass.loft import Wall
from ..properties import read, scale_of
from .curves import closed_loops

WALL = "glass.wall"
"""What a form says of a wall that Heliform makes."""


class Drawn(NamedTuple):
    """Closed curves (M, 3) in m about the ``foot`` (3,) in m of the wall on them, in the world."""

    loops: list[Vector]
    foot: Vector


def wall_of(obj: bpy.types.Object, scene: bpy.types.Scene) -> tuple[Wall, Drawn]:
    """What a wall object says of its wall, and the curves that it follows.

    Raises SceneError where a curve is gone or is none.
    """
    scale = scale_of(scene)
    curves = [entry.object for entry in obj.heliform.curves]
    if not all(curves):
        raise SceneError(
            f"A curve that “{obj.name}” follows was deleted; choose its curves again, or undo."
        )
    return read(obj.heliform.wall, Wall, scale), drawn_by(curves, scale)


def drawn_by(curves: Sequence[bpy.types.Object], scale: float) -> Drawn:
    """The closed loops of some curves; the foot is below the middle of the lowest one.

    Raises SceneError for what is no closed curve.
    """
    depsgraph = bpy.context.evaluated_depsgraph_get()
    loops = [scale * loop for curve in curves for loop in closed_loops(curve, depsgraph)]
    if not loops:
        return Drawn([], np.zeros(3))
    lowest = min(loops, key=lambda loop: loop[:, 2].mean())
    foot = (lowest.min(axis=0) + lowest.max(axis=0)) / 2
    return Drawn([loop - foot for loop in loops], foot)
