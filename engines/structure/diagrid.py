"""The joints and members of a diagrid around a tower, by counts alone."""

import functools
from dataclasses import dataclass

import numpy as np

from ..core.scene import Vector
from .grid import Indices
from .model import NO_NODE


@dataclass(frozen=True, slots=True, eq=False)
class Diagrid:
    """Diagonals and rings on a cylinder of circumference 1 and height 1.

    ``uv`` (N, 2) float64, u around and v up; ``levels`` (N,) the floor that each node is at;
    ``members`` (M, 2) int32; ``groups`` (M,): 0 for diagonals, 1 for rings; ``cells`` (F, 4) int32,
    counter-clockwise seen from outside, the last NO_NODE in a triangle; ``middles`` (M, 2) u and v
    of the members' middles, 0 ≤ u < 1. Arrays are read-only.
    """

    uv: Vector
    levels: Indices
    members: Indices
    groups: Indices
    cells: Indices
    middles: Vector


@functools.lru_cache(maxsize=16)
def diagrid_of(modules: int, storeys: int, storeys_per_row: int) -> Diagrid:
    """The diagrid with so many ``modules`` around and ``storeys``.

    Joints of row i, every ``storeys_per_row`` floors, stand at u = (j + (i mod 2) ÷ 2) ÷ modules.
    From each two diagonals go up, half a module to either side. At the floors between rows they
    have nodes too, and at every floor but the ground a ring joins all nodes. A row that the top
    does not leave room for is cut there. Diagonals come first, floor by floor, then the rings.
    """
    slots = [_slots(level, modules, storeys_per_row) for level in range(storeys + 1)]
    sizes = [len(places) for places, _, _ in slots]
    first = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32)
    uv = np.concatenate(
        [np.column_stack([u, np.full(len(u), k / storeys)]) for k, (u, _, _) in enumerate(slots)]
    )

    diagonals, cells = [], []
    for level in range(storeys):
        left, right = first[level] + slots[level][1]
        left_above, right_above = first[level + 1] + slots[level + 1][2]
        diagonals += [np.column_stack([left, left_above]), np.column_stack([right, right_above])]
        near, near_above = np.roll(left, -1), np.roll(left_above, -1)
        cells += [
            _cells(left, right, right_above, left_above),
            _cells(right, near, near_above, right_above),
        ]
    rings = [
        first[k] + np.column_stack([np.arange(n), (np.arange(n) + 1) % n])
        for k, n in enumerate(sizes)
        if k
    ]
    members = np.concatenate(diagonals + rings).astype(np.int32)
    groups = np.repeat([0, 1], [len(np.concatenate(diagonals)), len(np.concatenate(rings))])
    start, end = uv[members[:, 0]], uv[members[:, 1]]
    ahead = end - start
    ahead[:, 0] -= np.round(ahead[:, 0])
    middles = start + ahead / 2
    middles[:, 0] %= 1.0
    grid = Diagrid(
        uv,
        np.repeat(np.arange(storeys + 1, dtype=np.int32), sizes),
        members,
        groups.astype(np.int32),
        np.concatenate(cells).astype(np.int32),
        middles,
    )
    for array in (grid.uv, grid.levels, grid.members, grid.groups, grid.cells, grid.middles):
        array.setflags(write=False)
    return grid


def _slots(level: int, modules: int, per_row: int) -> tuple[Vector, Indices, Indices]:
    """The nodes of a floor: their u (n,), and which ones the diagonals pass.

    Twice (2, modules), first the diagonal that leans left and then the one that leans right from
    each joint of the row: as the floor is met from above, and from below.
    """
    row, part = divmod(level, per_row)
    joints = (np.arange(modules) + 0.5 * (row % 2)) / modules
    index = np.arange(modules, dtype=np.int32)
    if part:
        lean = part / per_row / 2 / modules
        u = np.column_stack([joints - lean, joints + lean]).ravel() % 1.0
        passed = np.stack([2 * index, 2 * index + 1])
        return u, passed, passed
    # A diagonal that leans right ends where the next one that leans left does. From an even row's
    # joint j it ends at joint j of the row above, from an odd row's at j + 1.
    right = (index + (row - 1) % 2) % modules
    return joints, np.stack([index, index]), np.stack([(right - 1) % modules, right])


def _cells(left: Indices, right: Indices, right_above: Indices, left_above: Indices) -> Indices:
    """Cells (F, 4) between two floors; triangles where the two nodes of one floor are the same."""
    if left[0] == right[0]:
        none = np.full_like(left, NO_NODE)
        return np.column_stack([left, right_above, left_above, none])
    if left_above[0] == right_above[0]:
        none = np.full_like(left, NO_NODE)
        return np.column_stack([left, right, left_above, none])
    return np.column_stack([left, right, right_above, left_above])
