"""The skin of a wall: at each vertex, which way is out, which face it is on, how far around."""

from dataclasses import dataclass

import numpy as np

from ..core.normals import vertex_normals
from ..core.scene import Mesh, Vector

STEEP = 4.0
"""Where the normal's horizontal part is below 1 ÷ this, the surface is a rim, and relief fades."""

OUTWARD = -1e-4
"""A surface that looks neither toward the axis nor away from it counts as an outer one."""


@dataclass(frozen=True, slots=True)
class Skin:
    """What a relief needs to know at each vertex of a wall.

    ``normal`` (V, 2) horizontal unit vector out of the piece, the same on both faces of a wall;
    ``side`` (V,) +1 on the outer face, −1 on the inner, in between on rims; a relief moves a
    vertex by side · offset · normal. ``turn`` (V,) how far around, 0 to 1: by arc length on walls,
    by angle about the Z axis elsewhere. ``girth`` mean length of a turn in m. All float64.
    """

    normal: Vector
    side: Vector
    turn: Vector
    girth: float


def skin_of(mesh: Mesh) -> Skin:
    """The skin of any mesh, about the Z axis of its own coordinates.

    The vertex normals are those of the faces around, weighted by the angle [Thürmer & Wüthrich
    1998], as Blender's are. A vertex is on the outer face where its normal looks away from the
    axis. Where the surface lies almost flat, so that “out” has no meaning, ``side`` fades to 0.
    """
    return skin_from(mesh.vertices, vertex_normals(mesh))


def skin_from(vertices: Vector, normals: Vector) -> Skin:
    """As `skin_of`, from ``vertices`` (V, 3) in m and their unit ``normals`` (V, 3)."""
    plan = vertices[:, :2]
    radius = np.hypot(*plan.T)
    flat = normals[:, :2]
    level = np.hypot(*flat.T)
    out = np.einsum("ij,ij->i", flat, plan) / np.maximum(radius, np.finfo(np.float32).tiny)
    facing = np.where(out >= OUTWARD, 1.0, -1.0)
    away = flat / np.maximum(level, np.finfo(np.float32).tiny)[:, None]
    turn = np.arctan2(plan[:, 1], plan[:, 0]) / (2 * np.pi)
    return Skin(
        normal=facing[:, None] * away,
        side=facing * np.minimum(STEEP * level, 1.0),
        turn=turn - np.floor(turn),
        girth=float(2 * np.pi * radius.mean()) if len(radius) else 0.0,
    )
