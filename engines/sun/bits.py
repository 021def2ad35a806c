"""Yes or no for each sensor and direction, eight to a byte, and weighted sums over them.

Columns are packed along the last axis, the first into the lowest bit of the first byte.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..core.scene import Vector

Bits = NDArray[np.uint8]
FULL = 65535
"""What stands for a transmittance of 1."""
_BLOCK = 1 << 19  # values at a time: what stays in a processor's cache
_FEW = 16  # columns of weights


def packed(seen: NDArray[np.bool_]) -> Bits:
    """``seen`` (N, D) as (N, ceil(D / 8)) bytes."""
    return np.packbits(seen, axis=-1, bitorder="little")


def unpacked(bits: Bits, columns: int) -> NDArray[np.bool_]:
    """What ``packed`` was made of, ``columns`` wide."""
    return np.unpackbits(bits, axis=-1, count=columns, bitorder="little").view(np.bool_)


def sums(
    bits: Bits,
    weights: Vector | sparse.csr_array,
    through: NDArray[np.uint16] | None = None,
    facing: tuple[Vector, Vector] | None = None,
) -> Vector:
    """Σ over the columns d of seen[n, d] · weights[d, k], (N, K) float64 to single precision.

    ``bits`` (N, ceil(D / 8)), ``weights`` (D, K), also sparse. ``through`` (N, D), of FULL, weighs
    each further; so does the cosine between ``facing``'s normals (N, 3) and directions (D, 3),
    which is above 0 wherever a bit is set. Bytes that no weight falls on are passed over.
    """
    if isinstance(weights, sparse.csr_array):
        return _multiplied(bits, weights, through, facing)
    used = _used_bytes(weights)
    if len(used) < bits.shape[1]:
        columns = (8 * used[:, None] + np.arange(8)).ravel()
        columns = columns[columns < len(weights)]
        bits, weights = bits[:, used], weights[columns]
        through = None if through is None else through[:, columns]
        facing = None if facing is None else (facing[0], facing[1][columns])
    if facing is None or not len(bits):
        return _multiplied(bits, weights, through)
    normals, directions = facing
    if (normals == normals[0]).all():
        return _multiplied(bits, weights * (directions @ normals[0])[:, None], through)
    if 3 * weights.shape[1] <= _FEW:
        # The sum of weight · cosine is the normal times the sum of weight · direction.
        vectors = (weights[:, :, None] * directions[:, None]).reshape(len(weights), -1)
        total = _multiplied(bits, vectors, through).reshape(len(bits), -1, 3)
        return np.einsum("nki,ni->nk", total, normals)
    return _multiplied(bits, weights, through, facing)


def _multiplied(
    bits: Bits,
    weights: Vector | sparse.csr_array,
    through: NDArray[np.uint16] | None,
    facing: tuple[Vector, Vector] | None = None,
) -> Vector:
    (columns, sums), count = weights.shape or (0, 0), len(bits)
    factors = weights.astype(np.float32)
    few = sums <= _FEW and not isinstance(factors, sparse.csr_array)
    normals, towards = (np.asarray(a, np.float32) for a in facing or (np.zeros(0), np.zeros(0)))
    out = np.zeros((count, sums), np.float32)
    size = _BLOCK if few else 8 * _BLOCK  # BLAS's threads want more
    block = np.empty((max(1, size // max(columns, 1)), columns), np.float32)
    for start in range(0, count, len(block)):
        rows = slice(start, min(start + len(block), count))
        here = block[: rows.stop - start]
        here[...] = np.unpackbits(bits[rows], axis=1, count=columns, bitorder="little")
        if through is not None:
            here *= through[rows]
        if facing is not None:
            here *= normals[rows] @ towards.T
        if not few:
            out[rows] = here @ factors
            continue
        # Column by column: BLAS would set several threads on this little, and they wait longer.
        for k, column in enumerate(factors.T.copy()):
            np.vecdot(here, column, out=out[rows, k])
    return out.astype(np.float64) / (1 if through is None else FULL)


def _used_bytes(weights: Vector) -> NDArray[np.int64]:
    """The bytes in which some column has a weight that is not 0."""
    some = (weights != 0).any(axis=1)
    return np.unique(np.flatnonzero(some) // 8)
