"""Grids of members over a unit square: their nodes, members and cells, by counts alone."""

import functools
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..core.errors import SceneError
from ..core.parameters import param
from ..core.scene import Vector
from .model import NO_NODE

Pattern = Literal["waffle", "diagonal", "triangulated"]
Indices = NDArray[np.int32]


@dataclass(frozen=True, slots=True, kw_only=True)
class Opening:
    """A hole in a surface; the cells whose middle lies in it go, and the ribs inside."""

    shape: Literal["ellipse", "rectangle"] = param("ellipse", help="Outline of the opening")
    u: float = param(0.5, "", 0.0, 1.0, "Its middle along u, as a share of the surface")
    v: float = param(0.5, "", 0.0, 1.0, "Its middle along v")
    size_u: float = param(0.0, "", 0.0, 1.0, "Its size along u; 0 is no opening")
    size_v: float = param(0.0, "", 0.0, 1.0, "Its size along v; 0 is no opening")


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Straight members between nodes on a unit square.

    ``uv`` (N, 2) float64; ``members`` (M, 2) int32; ``cells`` (F, 4) int32, counter-clockwise in
    (u, v), the last NO_NODE in a triangle; ``middles`` (M, 2) u and v of the members' middles.
    Arrays are read-only, for they are shared between all that is made of them.
    """

    uv: Vector
    members: Indices
    cells: Indices
    middles: Vector


def count_for(length: float, spacing: float) -> int:
    """The fewest cells over ``length`` that are at most ``spacing`` wide, both in m."""
    return max(1, int(np.ceil(length / spacing - 1e-9)))


@functools.lru_cache(maxsize=16)
def grid_of(pattern: Pattern, along: int, across: int, openings: tuple[Opening, ...] = ()) -> Grid:
    """The grid of ``pattern`` with ``along`` × ``across`` cells, without what is in openings.

    “waffle”: quadrilaterals. “triangulated”: each with one diagonal, all the same way. “diagonal”:
    ribs both ways across each corner-to-corner, so that a cell is a diamond, and edge ribs.

    Raises SceneError when openings leave nothing, or more than one piece.
    """
    make = {"waffle": _waffle, "diagonal": _diagonal, "triangulated": _triangulated}[pattern]
    uv, members, cells = make(along, across)
    for opening in openings:
        if opening.size_u > 0 and opening.size_v > 0:
            uv, members, cells = _opened(uv, members, cells, opening)
    if _pieces(len(uv), members) != 1:
        raise SceneError(
            "The openings cut the surface into pieces that do not touch; make them smaller."
        )
    grid = Grid(uv, members, cells, uv[members].mean(axis=1))
    for array in (grid.uv, grid.members, grid.cells, grid.middles):
        array.setflags(write=False)
    return grid


def neighbours(grid: Grid, node: int) -> Indices:
    """The nodes that a member joins to ``node``, in the order of the members."""
    touching = grid.members[(grid.members == node).any(axis=1)]
    return touching.sum(axis=1, dtype=np.int32) - np.int32(node)


def cell_edges(cells: Indices) -> tuple[Indices, Indices]:
    """The edges around all cells (E, 2), start and end as the cell runs, and their cells (E,)."""
    following = np.roll(cells, -1, axis=1)
    following[:, 2] = np.where(cells[:, 3] == NO_NODE, cells[:, 0], cells[:, 3])
    edges = np.stack([cells, following], axis=-1)
    real = cells != NO_NODE
    owner = np.broadcast_to(np.arange(len(cells), dtype=np.int32)[:, None], cells.shape)
    return edges[real], owner[real]


def _lattice(along: int, across: int) -> tuple[Vector, Indices]:
    """Nodes (N, 2) of along × across rectangles, and their indices (along + 1, across + 1)."""
    u, v = np.meshgrid(np.arange(along + 1) / along, np.arange(across + 1) / across, indexing="ij")
    index = np.arange(u.size, dtype=np.int32).reshape(u.shape)
    return np.column_stack([u.ravel(), v.ravel()]), index


def _joined(*parts: tuple[NDArray[np.integer], ...]) -> Indices:
    """Rows of node indices from tuples of equally shaped index arrays."""
    rows = [np.stack([nodes.ravel() for nodes in part], axis=-1) for part in parts]
    return np.concatenate(rows).astype(np.int32)


def _waffle(along: int, across: int) -> tuple[Vector, Indices, Indices]:
    uv, at = _lattice(along, across)
    members = _joined((at[:-1], at[1:]), (at[:, :-1], at[:, 1:]))
    cells = _joined((at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    return uv, members, cells


def _triangulated(along: int, across: int) -> tuple[Vector, Indices, Indices]:
    uv, at = _lattice(along, across)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    members = _joined((at[:-1], at[1:]), (at[:, :-1], at[:, 1:]), (a, c))
    none = np.full_like(a, NO_NODE)
    return uv, members, _joined((a, b, c, none), (a, c, d, none))


def _diagonal(along: int, across: int) -> tuple[Vector, Indices, Indices]:
    corners, at = _lattice(along, across)
    i, j = np.meshgrid(np.arange(along), np.arange(across), indexing="ij")
    middles = np.column_stack([(i.ravel() + 0.5) / along, (j.ravel() + 0.5) / across])
    mid = len(corners) + np.arange(along * across, dtype=np.int32).reshape(along, across)
    members = _joined(
        (at[:-1, :-1], mid),
        (mid, at[1:, 1:]),
        (at[:-1, 1:], mid),
        (mid, at[1:, :-1]),
        (at[:-1, [0, -1]], at[1:, [0, -1]]),
        (at[[0, -1], :-1], at[[0, -1], 1:]),
    )
    none_u, none_v = np.full(along, NO_NODE), np.full(across, NO_NODE)
    cells = _joined(
        (at[:-1, 1:-1], mid[:, :-1], at[1:, 1:-1], mid[:, 1:]),
        (at[1:-1, :-1], mid[1:], at[1:-1, 1:], mid[:-1]),
        (at[:-1, 0], at[1:, 0], mid[:, 0], none_u),
        (at[1:, -1], at[:-1, -1], mid[:, -1], none_u),
        (at[0, 1:], at[0, :-1], mid[0], none_v),
        (at[-1, :-1], at[-1, 1:], mid[-1], none_v),
    )
    return np.concatenate([corners, middles]), members, cells


def _opened(
    uv: Vector, members: Indices, cells: Indices, opening: Opening
) -> tuple[Vector, Indices, Indices]:
    """What stays of a grid: cells with their middle outside, members beside one, their nodes."""
    real = (cells != NO_NODE)[..., None]
    middles = np.where(real, uv[cells], 0.0).sum(axis=1) / real.sum(axis=1)
    away = 2 * np.abs(middles - (opening.u, opening.v)) / (opening.size_u, opening.size_v)
    reach = np.hypot(*away.T) if opening.shape == "ellipse" else away.max(axis=1)
    cells = cells[reach >= 1]
    if not len(cells):
        raise SceneError("The openings leave nothing of the surface; make them smaller.")

    names = np.sort(members, axis=1) @ (len(uv), 1)
    edges, _ = cell_edges(cells)
    members = members[np.isin(names, np.sort(edges, axis=1) @ (len(uv), 1))]
    kept = np.unique(members)
    index = np.full(len(uv) + 1, NO_NODE, dtype=np.int32)  # the last for NO_NODE itself
    index[kept] = np.arange(len(kept))
    return uv[kept], index[members], index[cells]


def _pieces(count: int, members: Indices) -> int:
    """How many pieces the nodes fall into."""
    start, end = members.T
    graph = coo_array((np.ones(len(members)), (start, end)), shape=(count, count))
    return connected_components(graph, directed=False, return_labels=False)
