"""Shapes in which a frame buckles or swings: eigenvectors of its matrices."""

from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import LinearOperator, eigsh

from ..core.scene import Vector
from .linear import Factor

_DENSE = 240
"""Matrices with no more rows than this are solved whole."""


class Modes(NamedTuple):
    """n modes of a frame of N nodes and M members; in each the greatest displacement is 1.

    ``values`` (n,): load factors, or frequencies in Hz; ``nodes`` (n, N, 6): displacements and
    rotations; ``along`` (n, M, pieces + 1, 3): displacements at even stations of the members. World
    axes.
    """

    values: Vector
    nodes: Vector
    along: Vector


def greatest_eigenpairs(
    matrix: csc_matrix, metric: csc_matrix, factor: Factor, count: int
) -> tuple[Vector, Vector]:
    """The greatest ``count`` values θ (n,), falling, and vectors (rows, n) of B φ = θ A φ.

    ``matrix`` B is symmetric, ``metric`` A positive definite and ``factor`` its factor. Lanczos'
    method in A's inner product [Lehoucq, Sorensen and Yang 1998, ARPACK, mode 2].
    """
    rows = len(metric.indptr) - 1
    count = min(count, rows)
    if not count:
        return np.zeros(0), np.zeros((rows, 0))
    if rows <= _DENSE or count > rows // 3:
        span = [rows - count, rows - 1]
        values, vectors = eigh(matrix.toarray(), metric.toarray(), subset_by_index=span)
    else:
        start = np.random.default_rng(0).normal(size=rows)  # the same modes every time
        values, vectors = eigsh(
            matrix, count, metric, which="LA", Minv=_Inverse(factor, rows), v0=start
        )
    order = np.argsort(values)[::-1]
    return values[order], vectors[:, order]


class _Inverse(LinearOperator):
    """The inverse of a factorised matrix, as Lanczos' method applies it."""

    def __init__(self, factor: Factor, rows: int) -> None:
        super().__init__(np.dtype(np.float64), (rows, rows))
        self._factor = factor

    def _matvec(self, x: Vector) -> Vector:
        return self._factor.solve(x.reshape(-1, 1)).ravel()


def scaled(nodes: Vector, along: Vector) -> tuple[Vector, Vector]:
    """Shapes (n, N, 6) and (n, M, S, 3) whose greatest displacement is 1."""
    size = np.linalg.norm(along, axis=-1).reshape(len(along), -1)
    most = size.max(axis=1)
    most = np.where(most > 0, most, np.abs(nodes).max(axis=(1, 2), initial=1e-300))
    return nodes / most[:, None, None], along / most[:, None, None, None]
