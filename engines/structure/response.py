"""What a frame answers to its loads: displacements, reactions and forces along its members."""

from dataclasses import dataclass

import numpy as np

from ..core.scene import Vector
from .frame import Rigidities


@dataclass(frozen=True, slots=True)
class Response:
    """C load cases, or K combinations of them, on a frame of N nodes and M members.

    ``displacements`` (C, N, 6) in m and rad, ``reactions`` (C, N, 6) in N and N·m of supports and
    springs, zero elsewhere: world axes. ``end_forces`` (C, M, 12) in N and N·m: what the nodes do
    to the member's ends, in its local axes. ``end_displacements`` (C, M, 12): those of the member's
    ends, local, released freedoms included. ``line`` (C, M, 2, 3) in N/m: the load along the
    member, its own weight included, in local axes. ``lengths`` (M,) in m and ``axes`` (M, 3, 3) as
    of the frame. ``imbalance`` (C,): the greatest residual force over the greatest load, a check of
    the solution. ``rigidities``: what the members resisted with, for the deflections between ends.
    """

    displacements: Vector
    reactions: Vector
    end_forces: Vector
    end_displacements: Vector
    line: Vector
    lengths: Vector
    axes: Vector
    imbalance: Vector
    rigidities: Rigidities | None = None

    def combined(self, factors: Vector) -> "Response":
        """The responses to K combinations; ``factors`` (K, C) says how much of each case.

        ``imbalance`` is of the worst case in each.
        """
        factors = np.asarray(factors, dtype=np.float64)

        def mixed(values: Vector) -> Vector:
            flat = factors @ values.reshape(len(values), -1)
            return flat.reshape(len(factors), *values.shape[1:])

        worst = np.where(factors != 0.0, self.imbalance, 0.0).max(axis=1, initial=0.0)
        return Response(
            mixed(self.displacements),
            mixed(self.reactions),
            mixed(self.end_forces),
            mixed(self.end_displacements),
            mixed(self.line),
            self.lengths,
            self.axes,
            worst,
            self.rigidities,
        )

    def forces(self, stations: Vector) -> Vector:
        """Section forces (C, M, S, 6) at ``stations`` (S,) in 0..1 of the length, as in `Demand`.

        From the equilibrium of the part before the station: exact for the line loads. The stress
        along x is N/A + My z/Iy − Mz y/Iz: positive My pulls where z is positive.
        """
        part = np.asarray(stations, dtype=np.float64)
        length = self.lengths[:, None]
        start, first = self.end_forces[..., :6], self.line[:, :, 0]
        slope = self.line[:, :, 1] - first
        powers = np.zeros((4, *start.shape))  # of the share of the length that is passed
        powers[0] = -start
        powers[1, ..., :3] = -length * first
        powers[2, ..., :3] = -0.5 * length * slope
        for moment, along, sign in ((4, 2, -1.0), (5, 1, 1.0)):
            lever = sign * self.lengths
            powers[1, ..., moment] = lever * start[..., along]
            powers[2, ..., moment] = lever * self.lengths * first[..., along] / 2.0
            powers[3, ..., moment] = lever * self.lengths * slope[..., along] / 6.0
        forces = np.vander(part, 4, increasing=True) @ powers.reshape(4, -1)
        return np.moveaxis(forces.reshape(len(part), *start.shape), 0, 2)

    def deflections(self, stations: Vector) -> Vector:
        """Displacements (C, M, S, 3) in m, world axes, at ``stations`` (S,) in 0..1 of the length.

        Exact for the line loads: the shape functions of Timoshenko's beam, and what the load adds
        between clamped ends, shear included.
        """
        if self.rigidities is None:
            raise ValueError("Deflections between the ends need the rigidities of the members.")
        t = np.asarray(stations, dtype=np.float64)
        mean = 0.5 * (self.line[:, :, 0] + self.line[:, :, 1])[:, :, None]
        skew = 0.5 * (self.line[:, :, 1] - self.line[:, :, 0])[:, :, None]
        ends, lengths = self.end_displacements[:, :, None], self.lengths[:, None]
        local = np.empty((*ends.shape[:2], len(t), 3))
        stretch = lengths**2 / self.rigidities.axial[:, None] * t * (1.0 - t)
        local[..., 0] = ends[..., 0] * (1.0 - t) + ends[..., 6] * t
        local[..., 0] += stretch * (mean[..., 0] / 2.0 + skew[..., 0] * (2.0 * t - 1.0) / 6.0)
        planes = (
            (1, 5, 1.0, self.rigidities.bending_z, self.rigidities.shear_y),
            (2, 4, -1.0, self.rigidities.bending_y, self.rigidities.shear_z),
        )
        for w, turn, sign, bending, shear in planes:
            phi = (12.0 * bending / (shear * self.lengths**2))[:, None]
            soft = lengths**4 / bending[:, None]
            lever = sign * lengths
            one, start, other, end = _shape(t, phi)
            even, odd = _bubbles(t, phi)
            local[..., w] = one * ends[..., w] + other * ends[..., w + 6]
            local[..., w] += lever * (start * ends[..., turn] + end * ends[..., turn + 6])
            local[..., w] += soft * (even * mean[..., w] + odd * skew[..., w])
        return local @ self.axes


def _shape(t: Vector, phi: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """Timoshenko's shape functions (M, S), those of rotations over the length."""
    whole = 1.0 + phi
    one = (1.0 - 3.0 * t**2 + 2.0 * t**3 + phi * (1.0 - t)) / whole
    start = (t - 2.0 * t**2 + t**3 + 0.5 * phi * (t - t**2)) / whole
    end = (t**3 - t**2 - 0.5 * phi * (t - t**2)) / whole
    return one, start, 1.0 - one, end


def _bubbles(t: Vector, phi: Vector) -> tuple[Vector, Vector]:
    """Deflection (M, S) between clamped ends over qL⁴/EI: load 1, and load 2t − 1."""
    even = t * (1.0 - t) * (t * (1.0 - t) + phi) / 24.0
    cubic = (1.0 / 30.0 + phi / 36.0) / (1.0 + phi)
    square = 1.0 / 24.0 - 1.5 * cubic
    odd = (2.0 * t**5 - 5.0 * t**4) / 120.0 + cubic * t**3 + square * t**2
    odd -= phi / 12.0 * ((2.0 * t**3 - 3.0 * t**2) / 6.0 + 6.0 * cubic * t)
    return even, odd
