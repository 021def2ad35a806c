"""A space frame: nodes, the straight members between them, and what holds it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector

FREEDOMS = ("ux", "uy", "uz", "rx", "ry", "rz")
HINGED = np.array([True, True, True, False, False, False])
FIXED = np.ones(6, dtype=bool)


@dataclass(frozen=True, slots=True)
class Frame:
    """Straight members between nodes, joined rigidly unless released.

    ``nodes`` (N, 3) float64 in m; ``members`` (M, 2) int32, start and end node; ``normals`` (M, 3)
    float64, for each member the direction in which its section's height is measured: the local z
    is the part of it that is perpendicular to the member. Local x runs from start to end and y is
    z × x. ``held`` (N, 6) bool: the displacements and rotations that supports hold, in the
    world's axes and in the order of FREEDOMS.

    ``releases`` (M, 12) bool, or None: local end freedoms (start, then end, each in the order of
    FREEDOMS) that a member does not share with its node. ``offsets`` (M, 2, 3) in m, or None: from
    the nodes to the member's ends, by rigid arms, in the world's axes. ``springs`` (N, 6) in N/m
    and N·m/rad, or None: elastic supports.
    """

    nodes: Vector
    members: NDArray[np.int32]
    normals: Vector
    held: NDArray[np.bool_]
    releases: NDArray[np.bool_] | None = None
    offsets: Vector | None = None
    springs: Vector | None = None

    def ends(self) -> Vector:
        """Where the members' axes start and end (M, 2, 3) in m, offsets included."""
        ends = self.nodes[self.members]
        return ends if self.offsets is None else ends + self.offsets

    def lengths(self) -> Vector:
        """The members' lengths (M,) in m."""
        ends = self.ends()
        return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)

    def axes(self) -> Vector:
        """The members' local axes (M, 3, 3), x, y and z as rows.

        A normal along its member is replaced by the world's axis that is farthest from the member.
        """
        ends = self.ends()
        x = ends[:, 1] - ends[:, 0]
        x: Vector = x / np.linalg.norm(x, axis=1, keepdims=True)
        z: Vector = self.normals - np.einsum("mi,mi->m", self.normals, x)[:, None] * x
        size = np.linalg.norm(z, axis=1)
        along = size < 1e-6 * np.maximum(np.linalg.norm(self.normals, axis=1), 1e-300)
        if along.any():
            other = np.eye(3)[np.argmin(np.abs(x[along]), axis=1)]
            z[along] = other - np.einsum("mi,mi->m", other, x[along])[:, None] * x[along]
            size = np.linalg.norm(z, axis=1)
        z = z / size[:, None]
        return np.stack([x, np.cross(z, x), z], axis=1)


@dataclass(frozen=True, slots=True)
class Rigidities:
    """What the members' sections and materials resist with, each (M,) float64.

    ``axial`` EA in N; ``bending_y`` and ``bending_z`` EI about local y (strong, the height counts)
    and z in N·m²; ``torsion`` GJ in N·m²; ``shear_y`` and ``shear_z`` GA_s along local y and z in
    N, infinite for Euler–Bernoulli beams; ``mass`` ρA in kg/m; ``rotary`` ρI_p in kg·m.
    """

    axial: Vector
    bending_y: Vector
    bending_z: Vector
    torsion: Vector
    shear_y: Vector
    shear_z: Vector
    mass: Vector
    rotary: Vector
