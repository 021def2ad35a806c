"""Points sorted into boxes of equal size, and what the boxes hold."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector

_FAR = 1e5  # boxes from the first corner; what lies beyond is in the last


@dataclass(frozen=True, slots=True)
class Boxes:
    """Which of B boxes of ``edge`` m each of N points is in.

    ``which`` (N,) is a point's box, ``count`` (B,) how many points a box has. ``key`` (B,) rises;
    ``span`` (3,) are the boxes along each axis, of which the key counts.
    """

    which: NDArray[np.intp]
    count: NDArray[np.intp]
    key: NDArray[np.int64]
    span: NDArray[np.int64]

    def means(self, points: Vector) -> Vector:
        """The mean (B, 3) of the points (N, 3) in each box."""
        sums = [np.bincount(self.which, weights=points[:, i]) for i in range(3)]
        return np.stack(sums, axis=1) / self.count[:, None]


def boxed(points: Vector, corner: Vector, edge: float) -> Boxes:
    """``points`` (N, 3) in boxes of ``edge`` m that begin at ``corner`` (3,), or before it."""
    box = np.clip((points - corner) / edge, -_FAR, _FAR).astype(np.int64)
    box -= box.min(axis=0) - 1
    span = box.max(axis=0) + 2
    key = (box[:, 0] * span[1] + box[:, 1]) * span[2] + box[:, 2]
    key, which, count = np.unique(key, return_inverse=True, return_counts=True)
    return Boxes(which, count, key, span)
