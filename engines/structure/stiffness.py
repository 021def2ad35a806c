"""Stiffness and loads of one straight member, for all members at once.

Timoshenko's beam with the exact shape functions of its homogeneous equation (Przemieniecki, Theory
of Matrix Structural Analysis, 1968, ch. 5 and 11): nodal results are exact for loads that are
linear along the member. With infinite shear stiffness it is Euler–Bernoulli's.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .frame import Frame, Rigidities


@dataclass(frozen=True, slots=True)
class Coefficients:
    """What a member's stiffness is made of, each (M,).

    ``axial`` EA/L in N/m, ``torsion`` GJ/L in N·m; ``bending_y`` and ``bending_z``
    EI/(L(1 + φ)) in N·m about local y and z, where ``phi_y`` and ``phi_z`` are 12EI/(GA_s L²).
    """

    lengths: Vector
    axial: Vector
    torsion: Vector
    bending_y: Vector
    bending_z: Vector
    phi_y: Vector
    phi_z: Vector


def coefficients(rigidities: Rigidities, lengths: Vector) -> Coefficients:
    """The coefficients of members of so many m, ``lengths`` (M,)."""
    phi_y = 12.0 * rigidities.bending_y / (rigidities.shear_z * lengths**2)
    phi_z = 12.0 * rigidities.bending_z / (rigidities.shear_y * lengths**2)
    return Coefficients(
        lengths,
        rigidities.axial / lengths,
        rigidities.torsion / lengths,
        rigidities.bending_y / (lengths * (1.0 + phi_y)),
        rigidities.bending_z / (lengths * (1.0 + phi_z)),
        phi_y,
        phi_z,
    )


def local_stiffness(rigidities: Rigidities, lengths: Vector) -> Vector:
    """Stiffness (M, 12, 12) of unreleased members in local axes, in N, m and rad."""
    c = coefficients(rigidities, lengths)
    local = np.zeros((len(lengths), 12, 12))
    _pair(local, 0, c.axial, -c.axial)
    _pair(local, 3, c.torsion, -c.torsion)
    for w, turn, sign, k, phi in (
        (1, 5, 1.0, c.bending_z, c.phi_z),
        (2, 4, -1.0, c.bending_y, c.phi_y),
    ):
        force, lever = 12.0 * k / lengths**2, sign * 6.0 * k / lengths
        _pair(local, w, force, -force)
        _pair(local, turn, (4.0 + phi) * k, (2.0 - phi) * k)
        _couple(local, w, turn, lever, lever, -lever, -lever)
    return local


def _pair(local: Vector, freedom: int, same: Vector, across: Vector) -> None:
    """Entries of one freedom with itself at both ends, and across the member."""
    far = freedom + 6
    local[:, freedom, freedom] = local[:, far, far] = same
    local[:, freedom, far] = local[:, far, freedom] = across


def _couple(
    local: Vector, w: int, turn: int, ss: Vector, se: Vector, es: Vector, ee: Vector
) -> None:
    """Entries of a displacement with a rotation: at start or end, with that of start or end."""
    for i, j, value in ((w, turn, ss), (w, turn + 6, se), (w + 6, turn, es), (w + 6, turn + 6, ee)):
        local[:, i, j] = local[:, j, i] = value


def world_stiffness(c: Coefficients, axes: Vector) -> Vector:
    """Stiffness (M, 12, 12) of members without releases or offsets, in world axes.

    Written out in the dyads of the local axes, ``axes`` (M, 3, 3): no matrix products.
    """
    x, y, z = axes[:, 0], axes[:, 1], axes[:, 2]
    xx, yy, zz = (a[:, :, None] * a[:, None, :] for a in (x, y, z))
    yz = y[:, :, None] * z[:, None, :]
    lengths = c.lengths

    def times(value: Vector, dyad: Vector) -> Vector:
        return value[:, None, None] * dyad

    move = (
        times(c.axial, xx)
        + times(12.0 * c.bending_z / lengths**2, yy)
        + times(12.0 * c.bending_y / lengths**2, zz)
    )
    lever = times(6.0 * c.bending_z / lengths, yz) - times(
        6.0 * c.bending_y / lengths, yz.transpose(0, 2, 1)
    )
    twist = times(c.torsion, xx)
    near = (
        twist + times((4.0 + c.phi_y) * c.bending_y, yy) + times((4.0 + c.phi_z) * c.bending_z, zz)
    )
    far = (
        times((2.0 - c.phi_y) * c.bending_y, yy) + times((2.0 - c.phi_z) * c.bending_z, zz) - twist
    )
    back = lever.transpose(0, 2, 1)
    world = np.empty((len(lengths), 12, 12))
    world[:, 0:3, 0:3] = world[:, 6:9, 6:9] = move
    world[:, 0:3, 6:9] = world[:, 6:9, 0:3] = -move
    world[:, 0:3, 3:6] = world[:, 0:3, 9:12] = lever
    world[:, 6:9, 3:6] = world[:, 6:9, 9:12] = -lever
    world[:, 3:6, 0:3] = world[:, 9:12, 0:3] = back
    world[:, 3:6, 6:9] = world[:, 9:12, 6:9] = -back
    world[:, 3:6, 3:6] = world[:, 9:12, 9:12] = near
    world[:, 3:6, 9:12] = world[:, 9:12, 3:6] = far
    return world


def transform(axes: Vector, offsets: Vector | None = None) -> Vector:
    """Local displacements of the members' ends from those of their nodes in world axes (M, 12, 12).

    ``axes`` (M, 3, 3); ``offsets`` (M, 2, 3) in m from node to end, rigid: u_end = u + θ × offset.
    Forces go back, and a stiffness with them, by the transpose.
    """
    matrix = np.zeros((len(axes), 12, 12))
    for first in range(0, 12, 3):
        matrix[:, first : first + 3, first : first + 3] = axes
    if offsets is not None:
        for end in range(2):
            arm = offsets[:, end]
            cross = np.zeros((len(axes), 3, 3))
            cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = arm[:, 2], -arm[:, 1], arm[:, 0]
            cross -= cross.transpose(0, 2, 1).copy()
            matrix[:, 6 * end : 6 * end + 3, 6 * end + 3 : 6 * end + 6] = axes @ cross
    return matrix


def released(local: Vector, releases: NDArray[np.bool_]) -> tuple[Vector, Vector]:
    """How released ends follow: (M, 12, 12) from the joined freedoms, and from loads on them.

    The first gives all local end displacements from those of the nodes: K and everything else is
    condensed by it, RᵀKR. The second is the flexibility of the released freedoms alone.
    A member whose released part has no stiffness must have been refused (`mechanism`).
    """
    both = releases[:, :, None] & releases[:, None, :]
    alone = np.where(both, local, 0.0)
    diagonal = np.arange(12)
    alone[:, diagonal, diagonal] += ~releases
    flexible = np.where(both, np.linalg.inv(alone), 0.0)
    follow = np.where(releases[:, :, None] & ~releases[:, None, :], -flexible @ local, 0.0)
    follow[:, diagonal, diagonal] += ~releases
    return follow, flexible


def equivalent_loads(c: Coefficients, line: Vector) -> Vector:
    """End forces (C, M, 12) in local axes that do what a line load does to clamped ends.

    ``line`` (C, M, 2, 3) in N/m, local, linear between start and end: ∫ Nᵀ q of the exact shape
    functions.
    """
    mean = 0.5 * (line[:, :, 0] + line[:, :, 1])
    skew = 0.5 * (line[:, :, 1] - line[:, :, 0])
    lengths = c.lengths
    ends = np.zeros((*line.shape[:2], 12))
    half = 0.5 * mean * lengths[:, None]
    share = np.stack(
        [
            lengths / 6.0,
            lengths * (0.2 + c.phi_z / 6.0) / (1.0 + c.phi_z),
            lengths * (0.2 + c.phi_y / 6.0) / (1.0 + c.phi_y),
        ],
        axis=1,
    )
    ends[:, :, 0:3] = half - share * skew
    ends[:, :, 6:9] = half + share * skew
    for w, turn, sign, phi in ((1, 5, 1.0, c.phi_z), (2, 4, -1.0, c.phi_y)):
        clamp = sign * mean[:, :, w] * lengths**2 / 12.0
        twist = sign * skew[:, :, w] * lengths**2 / (60.0 * (1.0 + phi))
        ends[:, :, turn] = clamp - twist
        ends[:, :, turn + 6] = -clamp - twist
    return ends


def elastic_forces(c: Coefficients, ends: Vector) -> Vector:
    """Forces (C, M, 12) of the local stiffness at local end displacements ``ends`` (C, M, 12)."""
    forces = np.empty_like(ends)
    _spring(forces, ends, 0, c.axial)
    _spring(forces, ends, 3, c.torsion)
    for w, turn, sign, k, phi in (
        (1, 5, 1.0, c.bending_z, c.phi_z),
        (2, 4, -1.0, c.bending_y, c.phi_y),
    ):
        chord = sign * (ends[:, :, w + 6] - ends[:, :, w]) / c.lengths
        start, end = ends[:, :, turn] - chord, ends[:, :, turn + 6] - chord
        one = k * ((4.0 + phi) * start + (2.0 - phi) * end)
        other = k * ((2.0 - phi) * start + (4.0 + phi) * end)
        shear = sign * (one + other) / c.lengths
        forces[:, :, turn], forces[:, :, turn + 6] = one, other
        forces[:, :, w], forces[:, :, w + 6] = shear, -shear
    return forces


def _spring(forces: Vector, ends: Vector, freedom: int, stiffness: Vector) -> None:
    """Fill in what axial or torsional stiffness does."""
    force = stiffness * (ends[:, :, freedom] - ends[:, :, freedom + 6])
    forces[:, :, freedom], forces[:, :, freedom + 6] = force, -force


@dataclass(frozen=True, slots=True)
class Members:
    """A frame's members ready to be assembled and to be given displacements back.

    ``world`` (M, 12, 12): stiffness between the nodes' freedoms in world axes, releases and offsets
    included. ``special`` (P,): the members that have releases or offsets; for those only,
    ``follow`` (P, 12, 12): local end displacements from the nodes' in world axes, and ``flexible``
    (P, 12, 12): what loads on released freedoms add.
    """

    coefficients: Coefficients
    axes: Vector
    world: Vector
    special: NDArray[np.intp]
    follow: Vector
    flexible: Vector

    def end_displacements(self, at_nodes: Vector, equivalent: Vector) -> Vector:
        """Local (C, M, 12) from world ``at_nodes`` (C, M, 12) and `equivalent_loads` (C, M, 12)."""
        cases, count = at_nodes.shape[:2]
        ends = at_nodes.reshape(cases, count, 4, 3) @ self.axes.transpose(0, 2, 1)
        ends = ends.reshape(cases, count, 12)
        if len(self.special):
            special = self.special
            ends[:, special] = _applied(self.follow, at_nodes[:, special]) + _applied(
                self.flexible, equivalent[:, special]
            )
        return ends

    def to_nodes(self, local: Vector) -> Vector:
        """World forces (C, M, 12) on the nodes' freedoms that do the work of local end forces."""
        cases, count = local.shape[:2]
        forces = (local.reshape(cases, count, 4, 3) @ self.axes).reshape(cases, count, 12)
        if len(self.special):
            back = self.follow.transpose(0, 2, 1)
            forces[:, self.special] = _applied(back, local[:, self.special])
        return forces

    def transforms(self) -> Vector:
        """Local end displacements from the nodes' in world axes, all members (M, 12, 12)."""
        matrix = transform(self.axes)
        matrix[self.special] = self.follow
        return matrix


def members_of(frame: Frame, rigidities: Rigidities) -> Members:
    """The members of a frame with their stiffness."""
    c = coefficients(rigidities, frame.lengths())
    axes = frame.axes()
    world = world_stiffness(c, axes)
    special = special_members(frame)
    follow = transform(axes[special], None if frame.offsets is None else frame.offsets[special])
    flexible = np.zeros_like(follow)
    if len(special):
        local = local_stiffness(rigidities, c.lengths)[special]
        joined = local
        keep = np.broadcast_to(np.eye(12), local.shape)
        if frame.releases is not None:
            keep, flexible = released(local, frame.releases[special])
            joined = _cleaned(keep.transpose(0, 2, 1) @ local @ keep, local)
        world[special] = follow.transpose(0, 2, 1) @ joined @ follow
        follow = keep @ follow
    return Members(c, axes, world, special, follow, flexible)


def _cleaned(condensed: Vector, whole: Vector) -> Vector:
    """A condensed stiffness without what rounding left of entries that cancel."""
    size = np.sqrt(np.diagonal(whole, axis1=1, axis2=2))
    return np.where(np.abs(condensed) > 1e-12 * size[:, :, None] * size[:, None, :], condensed, 0.0)


def special_members(frame: Frame) -> NDArray[np.intp]:
    """The members that have a release or an offset."""
    special = np.zeros(len(frame.members), dtype=bool)
    if frame.releases is not None:
        special |= frame.releases.any(axis=1)
    if frame.offsets is not None:
        special |= frame.offsets.any(axis=(1, 2))
    return np.flatnonzero(special)


def _applied(matrix: Vector, values: Vector) -> Vector:
    """Each of P matrices (P, 12, 12) on its column of (C, P, 12)."""
    return np.einsum("pij,cpj->cpi", matrix, values)
