"""Yes or no for each sensor and direction, eight to a byte, and weighted sums over them.

Columns are packed along the last axis, the first into the lowest bit of the first byte.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector

Bits = NDArray[np.uint8]
FULL = 65535
"""What stands for a transmittance of 1."""
_BLOCK = 1 << 19  # values at a time: what stays in a processor's cache


def packed(seen: NDArray[np.bool_]) -> Bits:
    """``seen`` (N, D) as (N, ceil(D / 8)) bytes."""
    return np.packbits(seen, axis=-1, bitorder="little")


def unpacked(bits: Bits, columns: int) -> NDArray[np.bool_]:
    """What ``packed`` was made of, ``columns`` wide."""
    return np.unpackbits(bits, axis=-1, count=columns, bitorder="little").view(np.bool_)


def count(bits: Bits) -> int:
    """How many are set."""
    return int(np.bitwise_count(bits).sum(dtype=np.int64))


def sums(
    bits: Bits,
    weights: Vector,
    through: NDArray[np.uint16] | None = None,
    facing: tuple[Vector, Vector] | None = None,
) -> Vector:
    """Σ over the columns d of seen[n, d] · weights[d, k], (N, K) float64 to single precision.

    ``bits`` (N, ceil(D / 8)), ``weights`` (D, K). ``through`` (N, D), of FULL, weighs each further;
    so does the cosine between ``facing``'s normals (N, 3) and directions (D, 3), where positive.
    Bytes that no weight falls on are passed over.
    """
    columns = len(weights)
    used = _used_bytes(weights)
    everywhere = len(used) == bits.shape[1]
    if not everywhere:
        bits = bits[:, used]
        picked = np.minimum((8 * used[:, None] + np.arange(8)).ravel(), columns - 1)
        beyond = (8 * used[:, None] + np.arange(8)).ravel() >= columns
        weights = np.where(beyond[:, None], 0.0, weights[picked])
        through = None if through is None else through[:, picked]
        facing = None if facing is None else (facing[0], facing[1][picked])
        columns = len(picked)
    out = np.empty((len(bits), weights.shape[1]), np.float32)
    towards = None
    if facing is not None:
        normals, directions = facing
        if len(normals) and (normals == normals[0]).all():
            weights = weights * np.maximum(directions @ normals[0], 0.0)[:, None]
        else:
            normals, towards = normals.astype(np.float32), directions.astype(np.float32).T.copy()
    factors = np.ascontiguousarray(weights, dtype=np.float32)
    block = np.empty((max(1, _BLOCK // max(columns, 1)), columns), np.float32)
    for rows in _rows(len(bits), len(block)):
        here = block[: rows.stop - rows.start]
        here[...] = np.unpackbits(bits[rows], axis=1, count=columns, bitorder="little")
        if through is not None:
            here *= through[rows]
        if towards is not None:
            here *= normals[rows] @ towards
        np.matmul(here, factors, out=out[rows])
    total = out.astype(np.float64)
    return total if through is None else total / FULL


def _used_bytes(weights: Vector) -> NDArray[np.int64]:
    """The bytes in which some column has a weight that is not 0."""
    some = (weights != 0).any(axis=1)
    return np.unique(np.flatnonzero(some) // 8)


def _rows(count: int, step: int) -> Iterator[slice]:
    for start in range(0, count, step):
        yield slice(start, min(start + step, count))
