"""The loft: the surface midway in a wall, one function for mesh, toolpath and simulation."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from ..core.scene import Vector
from .outline import Outline, Plane

_AROUND = 1024  # places around that a blended section's length is summed over
_TABLE = 257  # heights between which lengths are interpolated where more are asked for


@dataclass(frozen=True, slots=True)
class Place:
    """The loft's surface at some places, all float64 and of one leading shape.

    ``points`` (…, 3) in m; ``along`` (…, 3) is ∂P/∂turn, level; ``rise`` (…, 3) is ∂P/∂z, its z
    component 1; ``curvature`` (…,) in 1/m of the horizontal section, positive where it is convex.
    """

    points: Vector
    along: Vector
    rise: Vector
    curvature: Vector

    @property
    def normal(self) -> Vector:
        """The section's outward unit normal in plan (…, 2)."""
        x, y = self.along[..., 0], self.along[..., 1]
        return np.stack([y, -x], axis=-1) / np.hypot(x, y)[..., None]


@dataclass(frozen=True, slots=True)
class Loft:
    """A surface through outlines at K levels, turned and scaled as it rises from z = 0.

    ``outlines`` are matched turn by turn; ``levels`` (K,) are their shares of the ``height`` in m,
    rising from 0 to 1, and a single one serves all heights. Between them runs a straight line for
    two and a natural cubic spline for more. ``twist`` in rad and ``scale`` are what the top is
    turned by about the Z axis and grown to, both evenly with height.
    """

    outlines: tuple[Outline, ...]
    levels: Vector
    height: float
    twist: float = 0.0
    scale: float = 1.0
    _blend: CubicSpline | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        blend = None
        if len(self.outlines) > 1:
            blend = CubicSpline(self.levels, np.eye(len(self.levels)), bc_type="natural")
        object.__setattr__(self, "_blend", blend)

    @property
    def prismatic(self) -> bool:
        """Whether the section is the same at every height."""
        return len(self.outlines) == 1 and self.twist == 0.0 and self.scale == 1.0

    @property
    def notes(self) -> tuple[str, ...]:
        """What was changed of the curves that were asked for, a sentence each."""
        return tuple(dict.fromkeys(note for o in self.outlines for note in o.notes))

    def at(self, turn: ArrayLike, z: ArrayLike) -> Place:
        """The surface at ``turn`` and height ``z`` in m, which broadcast.

        A whole turn is 1, of any number. It is the share of the arc length gone, exactly so where
        the section is one outline; between two outlines, points of equal share are joined.
        Analytic in both; heights beyond the loft go on as it ends.
        """
        position, speed, change, rise = self._sections(np.asarray(turn), np.asarray(z))
        bend = (speed.conj() * change).imag / np.abs(speed) ** 3
        shape = np.broadcast_shapes(np.shape(turn), np.shape(z))
        return Place(
            _lifted(position, z, shape),
            _lifted(speed, 0.0, shape),
            _lifted(rise, 1.0, shape),
            np.broadcast_to(bend, shape),
        )

    def length(self, z: ArrayLike) -> Vector:
        """Length in m of the horizontal section at heights ``z`` in m, of ``z``'s shape.

        Of more than some hundred heights, blended lengths are interpolated to 1e-6 or better.
        """
        heights = np.asarray(z, dtype=np.float64)
        if len(self.outlines) == 1:
            return self.outlines[0].length * (1 + (self.scale - 1) * heights / self.height)
        if heights.size > _TABLE:
            table = np.linspace(heights.min(), heights.max(), _TABLE)
            return CubicSpline(table, self.length(table))(heights)
        turn = np.arange(_AROUND) / _AROUND
        return np.abs(self._sections(turn, heights[..., None])[1]).mean(-1)

    def _sections(self, turn: Vector, z: Vector) -> tuple[Plane, Plane, Plane, Plane]:
        """Position, its first two derivatives by turn and its first by z, x + iy."""
        share = z / self.height
        if self._blend is None:
            position, speed, change = self.outlines[0].at(turn)
            lean = np.zeros(())
        else:
            sums = np.zeros((4, *np.broadcast_shapes(turn.shape, z.shape)), dtype=np.complex128)
            weights = self._blend(share)
            slopes = self._blend(share, 1) / self.height
            for k, outline in enumerate(self.outlines):
                here = outline.at(turn)
                for part in range(3):
                    sums[part] += weights[..., k] * here[part]
                sums[3] += slopes[..., k] * here[0]
            position, speed, change, lean = sums
        grown = 1 + (self.scale - 1) * share
        pose = grown * np.exp(1j * self.twist * share)
        spin = ((self.scale - 1) / grown + 1j * self.twist) / self.height
        return position * pose, speed * pose, change * pose, (lean + spin * position) * pose


def _lifted(plane: Plane, z: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    lifted = np.empty((*shape, 3))
    lifted[..., 0] = plane.real
    lifted[..., 1] = plane.imag
    lifted[..., 2] = z
    return lifted
