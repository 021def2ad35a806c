"""Where members' stiffnesses go in the frame's matrix: worked out once, used for every assembly."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csc_matrix, csr_array, diags_array
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

from ..core.scene import Vector
from .frame import Frame

# LAPACK's band does so many more operations a second than SuperLU's columns; and what SuperLU costs
# a small frame. Measured on grids, towers and stars of 200 to 10,000 members.
_BAND_SPEED, _SPARSE_START = 4.0, 6e7


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """The frozen pattern of a frame's matrix over its n free freedoms, in elimination order.

    Freedoms are 6 × node + 0..5: ``places`` (M, 12) are those of the members, ``free`` (n,) that of
    every unknown. ``entry``, ``row`` and ``column`` (E,): the entries of the flattened (M, 12, 12)
    of the members that count, and the unknowns they are between.

    ``band``: how many diagonals there are beside the main one, or 0 where a sparse factor is the
    faster. ``filled`` (F,): those entries that the factor needs, and ``slot`` (F,) where they are
    added up: in a lower band, column after column; or in the columns of the whole matrix,
    compressed with ``indices`` and ``indptr``, which a band has none of.

    It depends on members, held freedoms and nothing else: it stays when nodes or sections change.
    """

    freedoms: int
    places: NDArray[np.intp]
    free: NDArray[np.intp]
    entry: NDArray[np.intp]
    row: NDArray[np.intp]
    column: NDArray[np.intp]
    band: int
    filled: NDArray[np.intp]
    slot: NDArray[np.intp]
    indices: NDArray[np.int32]
    indptr: NDArray[np.int32]

    def fits(self, frame: Frame) -> bool:
        """Whether it is the pattern of a frame with these members and held freedoms."""
        free = np.zeros(self.freedoms, dtype=bool)
        free[self.free] = True
        return np.array_equal(self.places, freedoms_of(frame)) and np.array_equal(
            free, ~frame.held.ravel()
        )

    def matrix(self, members: Vector, springs: Vector | None = None) -> csc_matrix:
        """The members' (M, 12, 12) in world axes and springs (N, 6), added up (n, n)."""
        shape = (len(self.free), len(self.free))
        if self.band:
            values = members.ravel()[self.entry]
            matrix = csc_matrix((values, (self.row, self.column)), shape=shape)
        else:
            data = np.bincount(self.slot, members.ravel()[self.filled], len(self.indices))
            matrix = csc_matrix((data, self.indices, self.indptr), shape=shape)
        if springs is not None:
            matrix = csc_matrix(matrix + diags_array(springs.ravel()[self.free]))
        return matrix

    def banded(self, members: Vector, springs: Vector | None = None) -> Vector:
        """The same as a lower band (band + 1, n) of LAPACK's, entry (i − j, j); Fortran order."""
        count, rows = len(self.free), self.band + 1
        data = np.bincount(self.slot, members.ravel()[self.filled], count * rows)
        band = data.reshape(count, rows)
        if springs is not None:
            band[:, 0] += springs.ravel()[self.free]
        return band.T

    def diagonal_of(self, members: Vector, springs: Vector | None = None) -> Vector:
        """The diagonal (n,) of that matrix."""
        own = np.arange(12)
        diagonal = np.bincount(self.places.ravel(), members[:, own, own].ravel(), self.freedoms)
        if springs is not None:
            diagonal += springs.ravel()
        return diagonal[self.free]

    def spread(self, values: Vector) -> Vector:
        """Values (n, C) of the unknowns as those of all freedoms (C, N, 6), zero where held."""
        whole = np.zeros((values.shape[1], self.freedoms))
        whole[:, self.free] = values.T
        return whole.reshape(values.shape[1], self.freedoms // 6, 6)

    def gathered(self, values: Vector) -> Vector:
        """Values (C, N, 6) of all freedoms as those of the unknowns (n, C)."""
        return values.reshape(len(values), self.freedoms)[:, self.free].T


def pattern_of(frame: Frame) -> Pattern:
    """The pattern of a frame, its unknowns ordered for little fill.

    Reverse Cuthill–McKee's for a band, or multiple minimum degree of A + Aᵀ for a sparse factor:
    whichever takes less time by its count of operations. Nodes are ordered, not freedoms: the six
    of a node stay together.
    """
    graph = _graph(frame)
    places, free = _numbered(frame, reverse_cuthill_mckee(graph, symmetric_mode=True))
    band = _bandwidth(places)
    order, work = _minimum_degree(graph)
    if len(free) * band**2 > _BAND_SPEED * work + _SPARSE_START:
        places, free = _numbered(frame, order)
        band = 0
    rows = np.broadcast_to(places[:, :, None], (*places.shape, 12)).ravel()
    columns = np.broadcast_to(places[:, None, :], (*places.shape, 12)).ravel()
    entry = np.flatnonzero((rows >= 0) & (columns >= 0))
    rows, columns = rows[entry], columns[entry]
    filled, indices, indptr = entry, np.zeros(0, np.int32), np.zeros(0, np.int32)
    if band:
        lower = rows >= columns
        filled = entry[lower]
        slot = columns[lower] * band + rows[lower]  # column × (band + 1) + row − column
    else:
        slot, indices, indptr = _compressed(rows, columns, len(free))
    return Pattern(
        6 * len(frame.nodes),
        freedoms_of(frame),
        free,
        entry,
        rows,
        columns,
        band,
        filled,
        slot,
        indices,
        indptr,
    )


def _compressed(
    rows: NDArray[np.intp], columns: NDArray[np.intp], count: int
) -> tuple[NDArray[np.intp], NDArray[np.int32], NDArray[np.int32]]:
    """Where each of (E,) entries is in compressed columns, with their row indices and starts."""
    keys, slot = np.unique(columns * count + rows, return_inverse=True)
    indptr = np.searchsorted(keys, np.arange(count + 1) * count)
    return slot, (keys % count).astype(np.int32), indptr.astype(np.int32)


def freedoms_of(frame: Frame) -> NDArray[np.intp]:
    """The freedoms (M, 12) of the members' nodes."""
    first = 6 * frame.members.astype(np.intp)[:, :, None]
    return (first + np.arange(6)).reshape(-1, 12)


def _graph(frame: Frame) -> csr_array:
    """Which nodes are joined by a member, symmetric (N, N)."""
    count = len(frame.nodes)
    start, end = frame.members.T
    ones = np.ones(len(frame.members))
    joined = csr_array((ones, (start, end)), shape=(count, count))
    return csr_array(joined + joined.T)


def _numbered(frame: Frame, order: NDArray[np.integer]) -> tuple[NDArray, NDArray]:
    """Each member's twelve unknowns (M, 12), −1 where held, and each unknown's freedom (n,)."""
    freedoms = (6 * order.astype(np.intp)[:, None] + np.arange(6)).ravel()
    free = freedoms[~frame.held.ravel()[freedoms]]
    number = np.full(6 * len(frame.nodes), -1, dtype=np.intp)
    number[free] = np.arange(len(free))
    return number.reshape(-1, 6)[frame.members].reshape(-1, 12), free


def _bandwidth(places: NDArray[np.intp]) -> int:
    """The greatest distance between two unknowns of one member, at least 1."""
    most = places.max(axis=1, initial=-1)
    least = np.where(places >= 0, places, most[:, None]).min(axis=1, initial=1 << 60)
    return max(1, int((most - least).max(initial=0)))


def _minimum_degree(graph: csr_array) -> tuple[NDArray[np.integer], float]:
    """SuperLU's ordering of the nodes for little fill, and the operations of a factor by it."""
    degree = graph.sum(axis=1)
    dominant = csc_array(diags_array(2.0 * degree + 1.0) - graph)
    factor = splu(dominant, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    below = np.diff(factor.L.indptr).astype(np.float64)
    return np.argsort(factor.perm_c), 2.0 * 6.0**3 * float((below**2).sum())
