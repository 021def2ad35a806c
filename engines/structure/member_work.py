"""The work λᵀ(a f − K u) of members, and how it changes with their rigidities and their ends.

Of the six ways in which ends strain a member none has to do with another: stretch, twist, and in
each plane a bow, where the ends turn against each other, and a wave, where they turn alike.
"""

from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .beam_shapes import PLANES
from .frame import Frame, Rigidities
from .loads import Loads
from .stiffness import coefficients, elastic_forces, equivalent_loads

_STEP = 1e-30
"""Of the complex step [Squire and Trapp 1998]: exact to rounding, as nothing is subtracted."""
_BENDING = (("bending_z", "shear_y"), ("bending_y", "shear_z"))
"""The rigidities in each of PLANES."""


@dataclass(frozen=True)
class MemberWork:
    """M members that move by u, and by λ, under C load cases of which a ``share`` a counts.

    ``u`` and ``by`` λ (C, M, 12): displacements of the ends, local axes; ``apart_u`` and
    ``apart_by``: what of it released ends move by themselves, which stays along the member's axes
    when those turn. ``lengths`` (M,) in m and ``axes`` (M, 3, 3) as of the frame.
    """

    frame: Frame
    rigidities: Rigidities
    loads: Loads
    lengths: Vector
    axes: Vector
    u: Vector
    by: Vector
    apart_u: Vector
    apart_by: Vector
    share: float

    def of_lines(self) -> float:
        """λᵀf of the loads along members, in J."""
        return float(np.sum(self._line() * self._carried(self.lengths)))

    def by_rigidities(self) -> Rigidities:
        """Its derivatives by the rigidities of each member (M,)."""
        length, line = self.lengths, self._line()
        u, by = _strains(self.u, length), _strains(self.by, length)
        found = {f.name: np.zeros_like(length) for f in fields(Rigidities)}
        found["axial"] = -_sum(u.stretch, by.stretch) / length
        found["torsion"] = -_sum(u.twist, by.twist) / length
        for plane, (bending, shear) in enumerate(_BENDING):
            stiff, soft = getattr(self.rigidities, bending), getattr(self.rigidities, shear)
            ratio = 12 * stiff / soft / length**2
            slant = line[:, :, 0, plane + 1] - line[:, :, 1, plane + 1]
            load = self.share * length**2 / 60 * _sum(slant, by.wave[plane])
            waved = 12 / length * _sum(u.wave[plane], by.wave[plane])
            bowed = 4 / length * _sum(u.bow[plane], by.bow[plane])
            # Of (load − waved EI) ÷ (1 + φ) − bowed EI, where φ goes with EI and against GA_s
            found[bending] = -bowed - (waved + load * ratio / stiff) / (1 + ratio) ** 2
            found[shear] = (load - waved * stiff) * (ratio / soft) / (1 + ratio) ** 2
        pull = self._turned(self.loads.gravity[:, None])
        found["mass"] = self.share * _sum(pull, self._carried(length).sum(axis=2))
        return Rigidities(**found)

    def by_spans(self) -> Vector:
        """Its derivatives by the vectors from start to end of the members (M, 3), in J/m."""
        length, line = self.lengths, self._line()
        c = coefficients(self.rigidities, length)
        pairs = (
            (self.u - self.apart_u, -elastic_forces(c, self.by)),
            (
                self.by - self.apart_by,
                self.share * equivalent_loads(c, line) - elastic_forces(c, self.u),
            ),
            (line, self.share * self._carried(length)),
        )
        # Axes that turn by ω take ω × v from the local components of every vector v
        turning = -np.sum([_moment(vectors, slopes) for vectors, slopes in pairs], axis=0)
        x, y, z = self.axes.transpose(1, 0, 2)
        normals = _normals(self.frame, self.axes)
        roll = np.einsum("mi,mi->m", x, normals) / np.einsum("mi,mi->m", z, normals)
        longer = np.imag(self._work(length + 1j * _STEP)) / _STEP
        aside = (turning[:, 2] + roll * turning[:, 0]) / length
        return longer[:, None] * x + aside[:, None] * y - (turning[:, 1] / length)[:, None] * z

    def _work(self, length: NDArray[Any]) -> NDArray[Any]:
        """λᵀ(a f − K u) of members (M,) so long, their ends moving as they do in local axes."""
        r = self.rigidities
        u, by = _strains(self.u, length), _strains(self.by, length)
        work = self.share * _sum(self._line(), self._carried(length))
        work = work - r.axial / length * _sum(u.stretch, by.stretch)
        work = work - r.torsion / length * _sum(u.twist, by.twist)
        for plane, (bending, shear) in enumerate(_BENDING):
            stiff, soft = getattr(r, bending), getattr(r, shear)
            waved = 12 / (1 + 12 * stiff / soft / length**2)
            waved = waved * _sum(u.wave[plane], by.wave[plane])
            work = work - stiff / length * (4 * _sum(u.bow[plane], by.bow[plane]) + waved)
        return work

    def _carried(self, length: NDArray[Any]) -> NDArray[Any]:
        """λᵀf (C, M, 2, 3) of unit loads in N/m along local axes, that fade from start or end."""
        by = _strains(self.by, length)
        start, end = self.by[..., :3], self.by[..., 6:9]
        carried = np.stack([2 * start + end, start + 2 * end], axis=2) * (length / 6)[:, None, None]
        for plane, (bending, shear) in enumerate(_BENDING):
            stiff, soft = getattr(self.rigidities, bending), getattr(self.rigidities, shear)
            bowed = length**2 / 12 * by.bow[plane]
            waved = length**2 / (60 * (1 + 12 * stiff / soft / length**2)) * by.wave[plane]
            carried[:, :, 0, plane + 1] += bowed + waved
            carried[:, :, 1, plane + 1] += bowed - waved
        return carried

    def _line(self) -> Vector:
        """Loads along the members with their own weight (C, M, 2, 3) in N/m, local axes."""
        weight = self.loads.gravity[:, None, None] * self.rigidities.mass[:, None, None]
        return (self.loads.line + weight) @ self.axes.transpose(0, 2, 1)

    def _turned(self, vectors: Vector) -> Vector:
        """Vectors (C, 1, 3) in the members' local axes (C, M, 3)."""
        return np.einsum("mji,ci->cmj", self.axes, vectors[:, 0])


def _moment(vectors: Vector, slopes: Vector) -> Vector:
    """Σ v × ∂W/∂v (M, 3) of all vectors in two (C, M, …) alike."""
    shape = (*vectors.shape[:2], -1, 3)
    return np.cross(vectors.reshape(shape), slopes.reshape(shape)).sum(axis=(0, 2))


class _Strains(NamedTuple):
    """What of its ends' displacements strains each member (C, M), in m and rad."""

    stretch: Vector
    twist: Vector
    bow: tuple[NDArray[Any], ...]
    wave: tuple[NDArray[Any], ...]


def _strains(ends: Vector, length: NDArray[Any]) -> _Strains:
    """What of end displacements (C, M, 12) in local axes strains members of so many m (M,)."""
    bow, wave = [], []
    for start, start_turn, end, end_turn, sign in PLANES:
        chord = (ends[..., end] - ends[..., start]) / length
        bow.append(sign * (ends[..., start_turn] - ends[..., end_turn]) / 2)
        wave.append(sign * (ends[..., start_turn] + ends[..., end_turn]) / 2 - chord)
    stretch, twist = ends[..., 6] - ends[..., 0], ends[..., 9] - ends[..., 3]
    return _Strains(stretch, twist, tuple(bow), tuple(wave))


def _normals(frame: Frame, axes: Vector) -> Vector:
    """The members' normals, those along a member replaced as `Frame.axes` does it."""
    across = np.abs(np.einsum("mi,mi->m", frame.normals, axes[:, 2]))
    along = across < 1e-6 * np.linalg.norm(frame.normals, axis=1)
    other = np.eye(3)[np.argmin(np.abs(axes[:, 0]), axis=1)]
    return np.where(along[:, None], other, frame.normals)


def _sum(one: NDArray[Any], other: NDArray[Any]) -> NDArray[Any]:
    """The product of two (C, M, …), summed to (M,)."""
    product = one * other
    return product.sum(axis=(0, *range(2, product.ndim)))
