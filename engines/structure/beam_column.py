"""Members under a steady axial force: how they bend, exactly, by second-order theory.

In each plane EI ψ″ + GA_s (w′ − ψ) = 0 and R′ = −q, where R = GA_s (w′ − ψ) + N w′ is the force
across the undeformed axis [Engesser 1891; Timoshenko and Gere 1961, ch. 1 and 2]. With
η = GA_s ÷ (GA_s + N) and k² = −η N ÷ EI all of it is made of Stumpff's functions of k²x²: one
formula for tension, compression and neither. x runs from the middle, where the even and the odd
part of the motion have nothing to do with each other.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .beam_shapes import PLANES, polar_radius_squared
from .frame import Rigidities

_TAUT = -25.0
"""Below this k²x² at its ends a member is taut: most of it is straight, and bends near its ends."""
_NEAR = 1.0
_TERMS = 12


@dataclass(frozen=True)
class BeamColumns:
    """M members under axial forces (…, M) in N, tension positive; ``lengths`` (M,) in m."""

    rigidities: Rigidities
    lengths: Vector
    axial_force: Vector

    def planes(self) -> Iterator[tuple[tuple[int, ...], Vector, "Flexure"]]:
        """For each plane its freedoms, their signs and how the members bend in it."""
        r = self.rigidities
        both = ((r.bending_z, r.shear_y), (r.bending_y, r.shear_z))
        for (*freedoms, sign), (bending, shear) in zip(PLANES, both, strict=True):
            signs = np.array([1.0, sign, 1.0, sign])
            yield tuple(freedoms), signs, Flexure(bending, shear, self.lengths, self.axial_force)

    def twisting(self) -> Vector:
        """(GJ + N i_p²) ÷ L of each member (…, M), with Wagner's term; warping is free."""
        wagner = self.axial_force * polar_radius_squared(self.rigidities)
        return (self.rigidities.torsion + wagner) / self.lengths

    def buckled(self) -> NDArray[np.bool_]:
        """Members (…, M) that bend or twist away even where both ends are clamped."""
        away = self.twisting() <= 0
        for _, _, flexure in self.planes():
            away = away | flexure.buckled()
        return away

    def stiffness(self) -> Vector:
        """Of the end freedoms in local axes (…, M, 12, 12), in N, m and rad."""
        matrix = np.zeros((*self.axial_force.shape, 12, 12))
        for freedom, stiff in ((0, self.rigidities.axial / self.lengths), (3, self.twisting())):
            far = freedom + 6
            matrix[..., [freedom, far], [freedom, far]] += stiff[..., None]
            matrix[..., [freedom, far], [far, freedom]] -= stiff[..., None]
        for freedoms, signs, flexure in self.planes():
            part = flexure.stiffness() * np.outer(signs, signs)
            matrix[..., np.array(freedoms)[:, None], freedoms] += part
        return matrix

    def equivalent_loads(self, line: Vector) -> Vector:
        """End forces (…, M, 12) that do to clamped ends what ``line`` (…, M, 2, 3) in N/m does."""
        ends = np.zeros((*line.shape[:-2], 12))
        start, end = line[..., 0, 0], line[..., 1, 0]
        ends[..., 0] = self.lengths * (2 * start + end) / 6
        ends[..., 6] = self.lengths * (start + 2 * end) / 6
        still = np.zeros(start.shape)
        for freedoms, signs, flexure in self.planes():
            along = freedoms[0]
            load = line[..., 0, along], line[..., 1, along]
            motion = flexure.motion(Ends(still, still, still, still), *load)
            ends[..., freedoms] = -motion.end_forces() * signs
        return ends

    def motions(self, ends: Vector, line: Vector) -> Iterator[tuple[int, float, "Motion"]]:
        """For each plane the freedom 1 or 2, the rotation's sign and how the members move.

        ``ends`` (…, M, 12) local end displacements in m and rad, ``line`` (…, M, 2, 3) in N/m.
        """
        for freedoms, signs, flexure in self.planes():
            along = freedoms[0]
            at = Ends(*np.moveaxis(ends[..., freedoms] * signs, -1, 0))
            load = line[..., 0, along], line[..., 1, along]
            yield along, float(signs[1]), flexure.motion(at, *load)


class Ends(NamedTuple):
    """Deflection in m and rotation in rad (…, M) at both ends of members, in one plane."""

    start: Vector
    start_turn: Vector
    end: Vector
    end_turn: Vector


@dataclass(frozen=True)
class Flexure:
    """M members bending in one plane: EI, GA_s and the length (M,), the axial force (…, M)."""

    bending: Vector
    shear: Vector
    lengths: Vector
    axial_force: Vector

    @cached_property
    def slip(self) -> Vector:
        """1 ÷ (GA_s + N) in 1/N."""
        return 1 / (self.shear + self.axial_force)

    @cached_property
    def eta(self) -> Vector:
        """η = GA_s ÷ (GA_s + N)."""
        return 1 - self.axial_force * self.slip

    @cached_property
    def wave(self) -> Vector:
        """k² in 1/m², positive in compression."""
        return -self.axial_force * self.eta / self.bending

    @cached_property
    def at_end(self) -> "Functions":
        """`functions` at the members' ends; those at the start are the same but for odd signs."""
        return self.functions(self.lengths / 2)

    def buckled(self) -> NDArray[np.bool_]:
        """Whether a member buckles between clamped ends: k L ≥ 2π, or nothing resists shear."""
        return (self.wave * self.lengths**2 >= 4 * np.pi**2) | (self.shear + self.axial_force <= 0)

    def stiffness(self) -> Vector:
        """Of deflection and rotation at the start, then at the end (…, M, 4, 4)."""
        none = np.zeros(self.axial_force.shape)
        units = np.broadcast_to(np.eye(4), (*none.shape, 4, 4))
        columns = [
            self.motion(Ends(*np.moveaxis(units[..., k], -1, 0)), none, none).end_forces()
            for k in range(4)
        ]
        return np.stack(columns, axis=-1)

    def motion(self, ends: Ends, start: Vector, end: Vector) -> "Motion":
        """The motion with these ``ends`` under a load in N/m, linear from start to end (…, M)."""
        half, at = self.lengths / 2, self.at_end
        eta, share, slip = self.eta, self.eta / self.bending, self.slip
        mean, slant = (start + end) / 2, (end - start) / self.lengths

        bow = (ends.end_turn - ends.start_turn) / 2 - share * at.cubic * mean
        curvature = bow / at.sine
        rise = (ends.end + ends.start) / 2 + slip * half**2 / 2 * mean
        lift = rise - eta * (at.versine * curvature + share * at.quartic * mean)

        turn = (ends.end_turn + ends.start_turn) / 2 - share * at.quartic * slant
        rise = (ends.end - ends.start) / 2 + slip * half**3 / 6 * slant
        rise = rise - eta * share * at.quintic * slant
        give = slip * half - eta * share * at.cubic
        scale = at.cosine * give + eta * share * at.sine * at.square
        return Motion(
            self,
            mean,
            slant,
            lift,
            curvature,
            turn=(turn * give + share * at.square * rise) / scale,
            force=(at.cosine * rise - eta * at.sine * turn) / scale,
        )

    def functions(self, x: Vector) -> "Functions":
        """The functions of x that motions are made of, ``x`` (…, M) in m from the middle."""
        k2 = self.wave
        taut = k2 * (self.lengths / 2) ** 2 < _TAUT
        c = stumpff(k2 * x**2)
        by = 1 / np.where(taut, k2, 1.0)
        return Functions(
            cosine=c[0],
            sine=x * c[1],
            versine=x**2 * c[2],
            linear=np.where(taut, 0.0, x * c[1]),
            square=np.where(taut, by, x**2 * c[2]),
            cubic=np.where(taut, by * x, x**3 * c[3]),
            quartic=np.where(taut, by * (x**2 / 2 - by), x**4 * c[4]),
            quintic=np.where(taut, by * (x**3 / 6 - by * x), x**5 * c[5]),
        )


class Functions(NamedTuple):
    """Of motion without load cos kx, sin kx ÷ k and (1 − cos kx) ÷ k², and what loads add to it.

    The latter, `linear` to `quintic`, begin as powers of x, are each the derivative of the next and
    solve y″ + k²y = 1, x, x²/2, x³/6 from `square` on.
    """

    cosine: Vector
    sine: Vector
    versine: Vector
    linear: Vector
    square: Vector
    cubic: Vector
    quartic: Vector
    quintic: Vector


@dataclass(frozen=True)
class Motion:
    """How members move in one plane, from load, w, ψ′, ψ and R at the middle, each (…, M)."""

    flexure: Flexure
    mean: Vector
    slant: Vector
    lift: Vector
    curvature: Vector
    turn: Vector
    force: Vector

    def deflection(self, x: Vector) -> Vector:
        """w in m at ``x`` (…, M) in m from the middle."""
        flexure, at = self.flexure, self.flexure.functions(x)
        eta, slip = flexure.eta, flexure.slip
        bent = at.quartic * self.mean + at.quintic * self.slant - at.cubic * self.force
        sheared = self.force * x - self.mean * x**2 / 2 - self.slant * x**3 / 6
        free = at.versine * self.curvature + at.sine * self.turn
        return self.lift + eta * (free + eta / flexure.bending * bent) + slip * sheared

    def moment(self, x: Vector) -> Vector:
        """EI ψ′ in N·m at ``x`` (…, M) in m from the middle."""
        even, odd = self._moments(self.flexure.functions(x))
        return even + odd

    def across(self, x: Vector) -> Vector:
        """R in N at ``x`` (…, M) in m from the middle."""
        return self.force - self.mean * x - self.slant * x**2 / 2

    def end_forces(self) -> Vector:
        """What holds the ends (…, M, 4): force and moment at the start, then at the end."""
        half = self.flexure.lengths / 2
        even, odd = self._moments(self.flexure.at_end)
        start, end = self.across(-half), self.across(half)
        return np.stack([-start, odd - even, end, even + odd], axis=-1)

    def _moments(self, at: "Functions") -> tuple[Vector, Vector]:
        """The even and the odd part of the moment in N·m where the functions are those ``at``."""
        flexure = self.flexure
        even = flexure.bending * at.cosine * self.curvature + flexure.eta * at.square * self.mean
        odd = flexure.eta * (at.cubic * self.slant - at.linear * self.force)
        return even, odd - flexure.bending * flexure.wave * at.sine * self.turn


def stumpff(z: Vector) -> Vector:
    """Stumpff's functions c₀ to c₅ of ``z`` (…): cₙ(z) = Σ (−z)ʲ ÷ (2j + n)!, stacked (6, …)."""
    z = np.asarray(z, dtype=float)
    near = np.abs(z) < _NEAR
    small, large = np.where(near, z, 0.0), np.where(near, _NEAR, z)
    series = []
    for order in (4, 5):
        total = np.ones_like(z)
        for j in range(_TERMS, 0, -1):
            total = 1 - small / ((2 * j + order - 1) * (2 * j + order)) * total
        series.append(total / (24 if order == 4 else 120))
    root = np.sqrt(np.abs(large))
    falling = large < 0
    cosh = np.cosh(np.where(falling, root, 0.0))
    c0 = np.where(falling, cosh, np.cos(root))
    c1 = np.where(falling, np.sinh(np.where(falling, root, 0.0)), np.sin(root)) / root
    c2, c3 = (1 - c0) / large, (1 - c1) / large
    far = [c0, c1, c2, c3, (1 / 2 - c2) / large, (1 / 6 - c3) / large]
    c4, c5 = series
    c2, c3 = 1 / 2 - small * c4, 1 / 6 - small * c5
    close = [1 - small * c2, 1 - small * c3, c2, c3, c4, c5]
    return np.where(near, np.stack(close), np.stack(far))
