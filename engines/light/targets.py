"""The receivers in stage space: where each one's texels begin, and how light meets a plane.

Texels of all receivers are numbered through, side by side: those of a receiver's front, then, where
both sides gather, those of its back.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.errors import SceneError
from ..core.scene import Receiver, Scene, Surface

MM = 1000.0
"""Stage space is in millimetres, all else in metres."""
MOST = 1 << 28
"""Texels of a scene."""
NOWHERE = 0xFFFFFFFF
"""The texel of a side that does not gather."""
MESH = 0xFFFFFFFF
"""Stands for the number of a plane where a mesh is met."""


@dataclass(frozen=True, slots=True)
class Side:
    """One side of a receiver: its texels are ``first`` to ``first`` + rows × columns."""

    receiver: Receiver | Surface
    back: bool
    first: int

    @property
    def texels(self) -> slice:
        """Where its texels lie among all."""
        return slice(self.first, self.first + self.receiver.rows * self.receiver.columns)

    @property
    def name(self) -> str:
        """The receiver's name, with the side where both gather."""
        if self.receiver.sides == "front":
            return self.receiver.name
        return f"{self.receiver.name} ({'back' if self.back else 'front'})"


def sides_of(scene: Scene) -> tuple[Side, ...]:
    """All sides that gather, in the receivers' order.

    Raises SceneError for more than MOST texels.
    """
    sides, first = [], 0
    for receiver in scene.receivers:
        for back in (False, True)[: 1 + (receiver.sides == "both")]:
            sides.append(Side(receiver, back, first))
            first += receiver.rows * receiver.columns
    if first > MOST:
        raise SceneError(
            f"The receivers have {first:,} texels together, more than {MOST:,}; lower their "
            "resolution."
        )
    return tuple(sides)


def first_texels(sides: tuple[Side, ...], receiver: Receiver | Surface) -> tuple[int, int]:
    """The first texels of a receiver's front and back, NOWHERE for a side that does not gather."""
    front, back = NOWHERE, NOWHERE
    for side in sides:
        if side.receiver is receiver:
            front, back = (front, side.first) if side.back else (side.first, back)
    return front, back


@dataclass
class Met:
    """Where photons meet a receiver: ``distance`` in mm (inf where missed), the ``texel`` or
    NOWHERE, the receiver's ``reflectance``, its ``normal`` on the side that is met, and the number
    of the ``plane``, or MESH."""

    distance: Any
    texel: Any
    reflectance: Any
    normal: Any
    plane: Any


class Plane:
    """A rectangular receiver on the device, in stage space, the ``number``-th of the planes."""

    def __init__(
        self,
        number: int,
        receiver: Receiver,
        origin: NDArray[np.float64],
        first: tuple[int, int],
    ) -> None:
        mi = runtime.mitsuba()
        import drjit as dr

        def fixed(vector: NDArray[np.float64]) -> Any:
            return mi.Vector3f(*(dr.opaque(mi.Float, float(c)) for c in vector))

        u, v = receiver.u * MM, receiver.v * MM
        self.number, self.receiver = number, receiver
        self.origin = mi.Point3f(fixed(origin))
        self.normal = fixed(receiver.normal)
        # Rows of the inverse: dot with a place on the plane gives its texture coordinate.
        self.to_u, self.to_v = fixed(u / (u @ u)), fixed(v / (v @ v))
        self.rows, self.columns = receiver.rows, receiver.columns
        self.front, self.back = (dr.opaque(mi.UInt32, n) for n in first)
        self.reflectance = dr.opaque(mi.Float, receiver.reflectance)

    def meet(self, origin: Any, direction: Any, slack: Any) -> Met:
        """Where rays meet the plane; it may lie up to ``slack`` mm behind their origin, or must
        lie as far before it where that is negative."""
        mi = runtime.mitsuba()
        import drjit as dr

        facing = dr.dot(direction, self.normal)
        height = dr.dot(origin - self.origin, self.normal)
        distance = dr.maximum(-height / facing, 0)
        offset = origin + distance * direction - self.origin
        u, v = dr.dot(offset, self.to_u), dr.dot(offset, self.to_v)
        ahead = dr.select(facing < 0, height > -slack, height < slack)
        met = ahead & (u >= 0) & (u < 1) & (v >= 0) & (v < 1)
        first = dr.select(facing < 0, self.front, self.back)
        return Met(
            dr.select(met, distance, dr.inf),
            texel_at(first, u, v, mi.UInt32(self.columns), mi.UInt32(self.rows)),
            self.reflectance,
            dr.select(facing < 0, self.normal, -self.normal),
            mi.UInt32(self.number),
        )

    def blocks(self, origin: Any, direction: Any, distance: Any) -> Any:
        """Whether the plane cuts the way of ``distance`` mm from ``origin``."""
        import drjit as dr

        away = -dr.dot(origin - self.origin, self.normal) / dr.dot(direction, self.normal)
        offset = origin + away * direction - self.origin
        u, v = dr.dot(offset, self.to_u), dr.dot(offset, self.to_v)
        return (away > 0) & (away < distance) & (u >= 0) & (u < 1) & (v >= 0) & (v < 1)


def texel_at(first: Any, u: Any, v: Any, columns: Any, rows: Any) -> Any:
    """The texel at texture coordinates of a side that begins at ``first``; NOWHERE stays."""
    mi = runtime.mitsuba()
    import drjit as dr

    column = dr.minimum(mi.UInt32(dr.maximum(u, 0) * mi.Float(columns)), columns - 1)
    row = dr.minimum(mi.UInt32(dr.maximum(v, 0) * mi.Float(rows)), rows - 1)
    nowhere = mi.UInt32(NOWHERE)
    return dr.select(first == nowhere, nowhere, first + row * columns + column)
