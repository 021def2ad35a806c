"""Where members' stiffnesses go in the frame's matrix: worked out once, used for every assembly."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, csr_matrix, diags_array
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

from ..core.scene import Vector
from .frame import Frame

_BAND_WORK = 5e9  # n·band²: above it a sparse factor is faster than a banded one


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """The frozen pattern of a frame's matrix over its n free freedoms, in elimination order.

    Freedoms are 6 × node + 0..5: ``places`` (M, 12) are those of the members, ``free`` (n,) that of
    every unknown. ``entry`` and ``slot`` (E,): the
    place in the flattened (M, 12, 12) of the members, and the place in ``data`` of the compressed
    columns ``indices`` and ``indptr`` it is added to; ``diagonal`` (n,) is that of the diagonal.
    ``band``: how many diagonals beside the main one; ``band_entry`` and ``band_slot``: the same
    for the lower band, column after column, empty where the sparse factor is the faster.

    It depends on members, held freedoms and nothing else: it stays when nodes or sections change.
    """

    freedoms: int
    places: NDArray[np.intp]
    free: NDArray[np.intp]
    entry: NDArray[np.intp]
    slot: NDArray[np.intp]
    indices: NDArray[np.int32]
    indptr: NDArray[np.int32]
    diagonal: NDArray[np.intp]
    band: int
    band_entry: NDArray[np.intp]
    band_slot: NDArray[np.intp]

    def matrix(self, members: Vector, springs: Vector | None = None) -> csc_matrix:
        """The members' (M, 12, 12) in world axes and springs (N, 6), added up (n, n)."""
        count = len(self.free)
        data = np.bincount(self.slot, members.ravel()[self.entry], len(self.indices))
        if springs is not None:
            data[self.diagonal] += springs.ravel()[self.free]
        return csc_matrix((data, self.indices, self.indptr), shape=(count, count))

    def banded(self, members: Vector, springs: Vector | None = None) -> Vector:
        """The same as a lower band (band + 1, n) of LAPACK's, entry (i − j, j); Fortran order."""
        count, rows = len(self.free), self.band + 1
        data = np.bincount(self.band_slot, members.ravel()[self.band_entry], count * rows)
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

    Narrow frames get reverse Cuthill–McKee and a band, others a minimum degree ordering of A + Aᵀ
    and a sparse factor. Nodes are ordered, not freedoms: the six of a node stay together.
    """
    graph = _graph(frame)
    order = reverse_cuthill_mckee(graph, symmetric_mode=True)
    places, free = _numbered(frame, order)
    band = _bandwidth(places)
    if len(free) * band**2 > _BAND_WORK:
        places, free = _numbered(frame, _minimum_degree(graph))
        band = 0
    rows = np.broadcast_to(places[:, :, None], (*places.shape, 12)).reshape(-1)
    columns = np.broadcast_to(places[:, None, :], (*places.shape, 12)).reshape(-1)
    entry = np.flatnonzero((rows >= 0) & (columns >= 0))
    rows, columns = rows[entry], columns[entry]
    count = len(free)
    diagonal = np.arange(count)
    keys = np.concatenate([columns * count + rows, diagonal * (count + 1)])
    filled, slot = np.unique(keys, return_inverse=True)
    slot, on_diagonal = slot[: len(entry)], slot[len(entry) :]
    indptr = np.searchsorted(filled, diagonal * count)
    lower = np.flatnonzero(rows >= columns) if band or not count else np.zeros(0, dtype=np.intp)
    return Pattern(
        6 * len(frame.nodes),
        freedoms_of(frame),
        free,
        entry,
        slot,
        (filled % max(count, 1)).astype(np.int32),
        np.append(indptr, len(filled)).astype(np.int32),
        on_diagonal,
        band,
        entry[lower],
        columns[lower] * (band + 1) + rows[lower] - columns[lower],
    )


def freedoms_of(frame: Frame) -> NDArray[np.intp]:
    """The freedoms (M, 12) of the members' nodes."""
    first = 6 * frame.members.astype(np.intp)[:, :, None]
    return (first + np.arange(6)).reshape(-1, 12)


def _graph(frame: Frame) -> csr_matrix:
    """Which nodes are joined by a member, symmetric (N, N)."""
    count = len(frame.nodes)
    start, end = frame.members.T
    ones = np.ones(len(frame.members))
    joined = csr_matrix((ones, (start, end)), shape=(count, count))
    return csr_matrix(joined + joined.T)


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


def _minimum_degree(graph: csr_matrix) -> NDArray[np.integer]:
    """Multiple minimum degree ordering of the nodes, SuperLU's own."""
    degree = np.asarray(graph.sum(axis=1)).ravel()
    dominant = csc_matrix(diags_array(2.0 * degree + 1.0) - graph)
    factor = splu(dominant, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    return np.argsort(factor.perm_c)
