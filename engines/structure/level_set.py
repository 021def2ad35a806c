"""A control surface over a structure that says what each member is made of, or how it is turned."""

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ..core.parameters import param
from ..core.scene import Vector
from .model import Model


@dataclass(frozen=True, slots=True, kw_only=True)
class Nine:
    """Nine control values of the level function, c<row u><column v>; above 0 is steel."""

    c00: float = param(1.0, "", -1.0, 1.0, "Control value at u 0, v 0")
    c01: float = param(1.0, "", -1.0, 1.0, "Control value at u 0, v ½")
    c02: float = param(1.0, "", -1.0, 1.0, "Control value at u 0, v 1")
    c10: float = param(1.0, "", -1.0, 1.0, "Control value at u ½, v 0")
    c11: float = param(1.0, "", -1.0, 1.0, "Control value at u ½, v ½")
    c12: float = param(1.0, "", -1.0, 1.0, "Control value at u ½, v 1")
    c20: float = param(1.0, "", -1.0, 1.0, "Control value at u 1, v 0")
    c21: float = param(1.0, "", -1.0, 1.0, "Control value at u 1, v ½")
    c22: float = param(1.0, "", -1.0, 1.0, "Control value at u 1, v 1")


def values_of(nine: Nine) -> Vector:
    """The control values (3, 3), row along u and column along v."""
    return np.array([getattr(nine, f.name) for f in fields(nine)], dtype=np.float64).reshape(3, 3)


def level_at(nine: Nine, uv: Vector) -> Vector:
    """The level φ (M,) at ``uv`` (M, 2): the tensor quadratic Bézier function of the nine values.

    Members beside the surface, whose u and v are NaN (columns), have φ = 1: they are of steel
    whatever the surface says. The level set method for materials, thesis 5.3.2.
    """
    on = np.isfinite(uv).all(axis=-1)
    u, v = np.where(on[:, None], uv, 0.0).T
    level = np.einsum("mi,mj,ij->m", _bernstein(u), _bernstein(v), values_of(nine))
    return np.where(on, level, 1.0)


def is_steel(nine: Nine, uv: Vector) -> NDArray[np.bool_]:
    """Which members at ``uv`` (M, 2) are of steel, φ > 0; the others are of timber."""
    return level_at(nine, uv) > 0.0


def turn_at(nine: Nine, uv: Vector, most: float) -> Vector:
    """Angles (M,) in rad by which members at ``uv`` (M, 2) are turned: φ · ``most``.

    Members beside the surface (u and v NaN) are not turned.
    """
    on = np.isfinite(uv).all(axis=-1)
    return np.where(on, most * level_at(nine, uv), 0.0)


def turned(model: Model, angle: Vector) -> Model:
    """The model with its members' normals turned by ``angle`` (M,) in rad about their axes.

    Right-handed about local x, from start to end of the member (Rodrigues' formula; the normal
    is perpendicular to the axis, so that two terms are left).
    """
    _, y, z = np.moveaxis(model.frame.axes(), 1, 0)
    angle = np.asarray(angle, dtype=np.float64)[:, None]
    normals = np.cos(angle) * z - np.sin(angle) * y  # x × z = −y
    return replace(model, frame=replace(model.frame, normals=normals))


def _bernstein(t: Vector) -> Vector:
    """The three quadratic Bernstein polynomials at ``t`` (M,), (M, 3)."""
    return np.stack([(1 - t) ** 2, 2 * t * (1 - t), t**2], axis=-1)
