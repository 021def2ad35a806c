"""Which triangles of a mesh cross one another."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ..core.scene import Vector

_BATCH = 1 << 16
_PARALLEL = 1e-9  # volume over lengths, of an edge that runs along a face


def crossing_triangles(nodes: Vector, triangles: NDArray[np.int32]) -> tuple[int, int] | None:
    """The first pair of ``triangles`` (T, 3) that cross without sharing a node, or None.

    Pairs whose centres are nearer than their circles are compared by their boxes, then edge
    against face [Möller and Trumbore, Fast, minimum storage ray–triangle intersection, 1997].
    Triangles that overlap in one plane are not found.
    """
    corners = nodes[triangles]
    centres = corners.mean(axis=1)
    reach = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    pairs = KDTree(centres).query_pairs(2 * reach.max(), output_type="ndarray")
    low, high = corners.min(axis=1), corners.max(axis=1)
    for start in range(0, len(pairs), _BATCH):
        a, b = pairs[start : start + _BATCH].T
        near = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
        a, b = a[near], b[near]
        apart = (triangles[a][:, :, None] != triangles[b][:, None, :]).all(axis=(1, 2))
        a, b = a[apart], b[apart]
        hit = _pierced(corners[a], corners[b]) | _pierced(corners[b], corners[a])
        if hit.any():
            first = int(np.argmax(hit))
            return int(a[first]), int(b[first])
    return None


def _pierced(one: Vector, other: Vector) -> NDArray[np.bool_]:
    """Whether an edge of triangle ``one`` (P, 3, 3) passes through the face of ``other``."""
    along = np.roll(one, -1, axis=1) - one
    corner = other[:, :1]
    first, second = other[:, 1:2] - corner, other[:, 2:] - corner
    offset = one - corner
    cross, turned = np.cross(along, second), np.cross(offset, first)
    volume = (first * cross).sum(axis=2)
    long, wide, deep = (np.linalg.norm(edge, axis=2) for edge in (along, first, second))
    through = np.abs(volume) > _PARALLEL * long * wide * deep
    inverse = 1 / np.where(through, volume, 1.0)
    u = inverse * (offset * cross).sum(axis=2)
    v = inverse * (along * turned).sum(axis=2)
    t = inverse * (second * turned).sum(axis=2)
    inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0) & (t <= 1)
    return (inside & through).any(axis=1)
