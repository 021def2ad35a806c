"""Load cases on a frame, as arrays."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.scene import Vector

GRAVITY = 9.80665  # m/s², standard
Action = Literal["permanent", "imposed", "snow", "wind"]


@dataclass(frozen=True, slots=True)
class Loads:
    """C load cases on a frame of N nodes and M members, in the world's axes.

    ``names`` and ``actions`` (C,): what EN 1990 calls the kind of action. ``gravity`` (C, 3) in
    m/s²: the acceleration that weighs the members' own mass. ``nodal`` (C, N, 6) in N and N·m.
    ``line`` (C, M, 2, 3) in N per m of member, at its start and its end and linear between.
    """

    names: tuple[str, ...]
    actions: tuple[Action, ...]
    gravity: Vector
    nodal: Vector
    line: Vector


def joined(*parts: Loads) -> Loads:
    """The load cases of all parts, one after the other."""
    return Loads(
        tuple(name for part in parts for name in part.names),
        tuple(action for part in parts for action in part.actions),
        np.concatenate([part.gravity for part in parts]),
        np.concatenate([part.nodal for part in parts]),
        np.concatenate([part.line for part in parts]),
    )
