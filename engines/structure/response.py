"""What a frame answers to its loads: displacements, reactions and forces along its members."""

from dataclasses import dataclass

from ..core.scene import Vector


@dataclass(frozen=True, slots=True)
class Response:
    """C load cases, or K combinations of them, on a frame of N nodes and M members.

    ``displacements`` (C, N, 6) in m and rad, ``reactions`` (C, N, 6) in N and N·m, zero where
    nothing is held: world axes. ``end_forces`` (C, M, 12) in N and N·m: what the nodes do to the
    member's ends, in its local axes. ``end_displacements`` (C, M, 12): those of the member's ends,
    local, released freedoms included. ``line`` (C, M, 2, 3) in N/m: the load along the member, its
    own weight included, in local axes. ``lengths`` (M,) in m and ``axes`` (M, 3, 3) as of the frame.
    ``imbalance`` (C,): the greatest residual force over the greatest load, a check of the solution.
    """

    displacements: Vector
    reactions: Vector
    end_forces: Vector
    end_displacements: Vector
    line: Vector
    lengths: Vector
    axes: Vector
    imbalance: Vector

    def combined(self, factors: Vector) -> "Response":
        """The responses to K combinations; ``factors`` (K, C) says how much of each case."""
        raise NotImplementedError

    def forces(self, stations: Vector) -> Vector:
        """Section forces (C, M, S, 6) as `Demand.forces` at ``stations`` (S,) in 0..1 of the length."""
        raise NotImplementedError
