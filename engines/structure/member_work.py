"""The work λᵀ(a f − K u) of members, and how it changes with their rigidities and their ends.

Of the six ways in which ends strain a member none has to do with another: stretch, twist, and in
each plane a bow, where the ends turn against each other, and a wave, where they turn alike.
"""

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from ..core.scene import Vector
from .beam_shapes import PLANES
from .frame import Frame, Rigidities
from .loads import Loads

_STEP = 1e-30
"""Of the complex step [Squire and Trapp 1998]: exact to rounding, as nothing is subtracted."""
_BENDING = (("bending_z", "shear_y"), ("bending_y", "shear_z"))
"""The rigidities in each of PLANES."""


@dataclass(frozen=True)
class MemberWork:
    """Members of a frame that move by u, and by λ, under loads of which ``share`` a counts.

    ``ends`` (2, C, M, 4, 3): displacement and rotation of the start, then of the end, in u and in
    λ, world axes; ``apart``, of the same shape: what released ends move by themselves, local axes.
    Both stay as they are when a member's ends are moved.
    """

    frame: Frame
    rigidities: Rigidities
    loads: Loads
    ends: Vector
    apart: Vector
    share: float

    def of_lines(self) -> float:
        """λᵀf of the loads along members, in J."""
        place = _place(self.frame, 0.0)
        _, by = self._strains(place)
        return float(_of_line(self.rigidities, place.lengths, self._line(place), by).sum())

    def by_rigidities(self) -> Rigidities:
        """Its derivatives by the rigidities of each member (M,)."""
        place = _place(self.frame, 0.0)
        length, line = place.lengths, self._line(place)
        u, by = self._strains(place)
        found = {f.name: np.zeros_like(length) for f in fields(Rigidities)}
        found["axial"] = -_sum(u.stretch, by.stretch) / length
        found["torsion"] = -_sum(u.twist, by.twist) / length
        for plane, (bending, shear) in enumerate(_BENDING):
            stiff, soft = getattr(self.rigidities, bending), getattr(self.rigidities, shear)
            ratio = 12 * stiff / (soft * length**2)
            slant = line[:, :, 0, plane + 1] - line[:, :, 1, plane + 1]
            load = self.share * length**2 / 60 * _sum(slant, by.wave[plane])
            waved = 12 / length * _sum(u.wave[plane], by.wave[plane])
            bowed = 4 / length * _sum(u.bow[plane], by.bow[plane])
            # load/(1 + φ) − waved·EI/(1 + φ), where φ is EI over GA and a constant
            found[bending] = -bowed - (waved + load * ratio / stiff) / (1 + ratio) ** 2
            found[shear] = (load - waved * stiff) * (ratio / soft) / (1 + ratio) ** 2
        own = np.repeat(self.loads.gravity[:, None, None], 2, axis=2) @ place.axes.transpose(0, 2, 1)
        found["mass"] = self.share * _of_line(self.rigidities, length, own, by)
        return Rigidities(**found)

    def by_ends(self) -> Vector:
        """Its derivatives by the vectors from start to end (M, 3), in J/m."""
        found = [self._work(_place(self.frame, 1j * _STEP * axis)).imag for axis in np.eye(3)]
        return np.stack(found, axis=1) / _STEP

    def _work(self, place: "_Place") -> Vector:
        """λᵀ(a f − K u) of each member (M,), summed over the cases."""
        r, length = self.rigidities, place.lengths
        u, by = self._strains(place)
        work = self.share * _of_line(r, length, self._line(place), by)
        work = work - r.axial / length * _sum(u.stretch, by.stretch)
        work = work - r.torsion / length * _sum(u.twist, by.twist)
        for plane, (bending, shear) in enumerate(_BENDING):
            stiff, soft = getattr(r, bending), getattr(r, shear)
            ratio = 12 * stiff / (soft * length**2)
            waved = 12 / (1 + ratio) * _sum(u.wave[plane], by.wave[plane])
            bowed = 4 * _sum(u.bow[plane], by.bow[plane])
            work = work - stiff / length * (bowed + waved)
        return work

    def _strains(self, place: "_Place") -> tuple["_Strains", "_Strains"]:
        """How u and λ strain the members."""
        local = self.ends @ place.axes.transpose(0, 2, 1) + self.apart
        return _strains(local[0], place.lengths), _strains(local[1], place.lengths)

    def _line(self, place: "_Place") -> Vector:
        """Loads along the members with their own weight (C, M, 2, 3), local axes."""
        weight = self.loads.gravity[:, None, None] * self.rigidities.mass[:, None, None]
        return (self.loads.line + weight) @ place.axes.transpose(0, 2, 1)


class _Place(NamedTuple):
    """Lengths (M,) and local axes (M, 3, 3) of members, complex where their ends are."""

    lengths: Vector
    axes: Vector


class _Strains(NamedTuple):
    """Displacements of members' ends (C, M), and what of them strains the members."""

    ends: Vector
    stretch: Vector
    twist: Vector
    bow: tuple[Vector, ...]
    wave: tuple[Vector, ...]


def _place(frame: Frame, change: Vector | float) -> _Place:
    """Where members lie when the vector from start to end of each changes by ``change`` (3,)."""
    ends = frame.ends()
    span = ends[:, 1] - ends[:, 0] + change
    length = np.sqrt(_dot(span, span))
    x = span / length[:, None]
    normals = _normals(frame)
    z = normals - _dot(normals, x)[:, None] * x
    z = z / np.sqrt(_dot(z, z))[:, None]
    return _Place(length, np.stack([x, np.cross(z, x), z], axis=1))


def _normals(frame: Frame) -> Vector:
    """The members' normals, those along a member replaced as `Frame.axes` does it."""
    axes = frame.axes()
    across = np.abs(_dot(frame.normals, axes[:, 2]))
    along = across < 1e-6 * np.linalg.norm(frame.normals, axis=1)
    other = np.eye(3)[np.argmin(np.abs(axes[:, 0]), axis=1)]
    return np.where(along[:, None], other, frame.normals)


def _strains(local: Vector, length: Vector) -> _Strains:
    """What of the end displacements ``local`` (C, M, 4, 3) strains members."""
    flat = local.reshape(*local.shape[:2], 12)
    bow, wave = [], []
    for start, start_turn, end, end_turn, sign in PLANES:
        chord = (flat[..., end] - flat[..., start]) / length
        bow.append(sign * (flat[..., start_turn] - flat[..., end_turn]) / 2)
        wave.append(sign * (flat[..., start_turn] + flat[..., end_turn]) / 2 - chord)
    stretch, twist = flat[..., 6] - flat[..., 0], flat[..., 9] - flat[..., 3]
    return _Strains(local[..., ::2, :], stretch, twist, tuple(bow), tuple(wave))


def _of_line(rigidities: Rigidities, length: Vector, line: Vector, by: _Strains) -> Vector:
    """∫ of the load times λ along each member (M,), in J; ``line`` (C, M, 2, 3), local axes."""
    start, end = line[:, :, 0], line[:, :, 1]
    chord = (2 * start + end) * by.ends[:, :, 0] + (start + 2 * end) * by.ends[:, :, 1]
    work = chord.sum(axis=(0, 2)) * length / 6
    for plane, (bending, shear) in enumerate(_BENDING):
        stiff, soft = getattr(rigidities, bending), getattr(rigidities, shear)
        ratio = 12 * stiff / (soft * length**2)
        first, last = start[..., plane + 1], end[..., plane + 1]
        bowed = _sum(first + last, by.bow[plane]) / 12
        waved = _sum(first - last, by.wave[plane]) / (60 * (1 + ratio))
        work = work + length**2 * (bowed + waved)
    return work


def _dot(one: Vector, other: Vector) -> Vector:
    """The products of vectors (M, 3), without conjugation."""
    return np.einsum("mi,mi->m", one, other)


def _sum(one: Vector, other: Vector) -> Vector:
    """The product of (C, M) and (C, M), summed over the cases."""
    return np.einsum("cm,cm->m", one, other)
