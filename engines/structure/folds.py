"""Refuses a surface that is folded on itself, or whose cells have no area."""

import functools

import numpy as np
import shapely
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.scene import Vector
from .crossing import crossing_triangles
from .grid import Indices, cell_edges
from .model import NO_NODE

_FLAT = 1e-6  # area over longest edge², of a cell without area
_FOLDED = -0.5  # cosine between the normals of neighbours that fold, 120°
_REMEDY = "move its control points back, closer to where they were"


def check_sheet(nodes: Vector, cells: Indices, uv: Vector, flat: Vector | None = None) -> None:
    """Raise SceneError where the surface that ``cells`` (F, 4) make of ``nodes`` (N, 3) is folded.

    That is where a cell has no area or crosses itself, neighbours turn back on one another, or
    cells apart cross. ``uv`` (N, 2) names the place. ``flat`` (N, 2): where the nodes come to lie
    when the surface is flattened; without it, its projection along its mean normal, which then
    has to point upward.

    A surface without bad cells whose flattened cells all run the same way round, and whose
    flattened edges do not cross, cannot fold [Floater, One-to-one piecewise linear mappings over
    triangulations, 2003]; only where this does not hold are all cells compared.
    """
    corners, normals = _corner_normals(nodes, cells)
    mean = normals.sum(axis=1)
    size = np.linalg.norm(mean, axis=1)
    _check_cells(corners, normals, mean, size, cells, uv)

    if flat is None:
        up = mean.sum(axis=0)
        if up[2] <= 0:
            raise SceneError(f"The surface is turned over, its outside down; {_REMEDY}.")
        flat = _projected(nodes, up)
    edges, sides = _edges(cells.tobytes())
    if _runs_one_way(flat, cells) and not _crosses(flat, edges[sides[:, 1] < 0]):
        return

    units = mean / size[:, None]
    inner = sides[sides[:, 1] >= 0]
    bend = np.einsum("ei,ei->e", units[inner[:, 0]], units[inner[:, 1]])
    if len(bend) and bend.min() < _FOLDED:
        cell = inner[np.argmin(bend), 0]
        raise SceneError(f"The surface folds back on itself {_place(cells, uv, cell)}; {_REMEDY}.")
    triangles, owner = triangles_of(cells)
    pair = crossing_triangles(nodes, triangles)
    if pair is not None:
        cell = owner[pair[0]]
        raise SceneError(f"The surface crosses itself {_place(cells, uv, cell)}; {_REMEDY}.")


def triangles_of(cells: Indices) -> tuple[Indices, Indices]:
    """The triangles (T, 3) that cells split into along their first diagonal, and whose they are."""
    quads = np.flatnonzero(cells[:, 3] != NO_NODE)
    triangles = np.concatenate([cells[:, :3], cells[quads][:, [0, 2, 3]]])
    return triangles, np.concatenate([np.arange(len(cells)), quads]).astype(np.int32)


def _corner_normals(nodes: Vector, cells: Indices) -> tuple[Vector, Vector]:
    """The corners of the cells (F, 4, 3), and at each the product of the edges that meet (F, 4, 3).

    The fourth corner of a triangle is its third again, and its product zero.
    """
    around = np.where(cells == NO_NODE, cells[:, [2]], cells)
    corners = nodes[around]
    ahead = np.roll(corners, -1, axis=1) - corners
    back = np.roll(ahead, 1, axis=1)
    three = cells[:, 3] == NO_NODE
    if three.any():  # the third corner's edge leads to the first, not to its double
        ahead[three, 2] = ahead[three, 3]
        back[three, 3] = ahead[three, 3]
    return corners, np.cross(back, ahead)


def _check_cells(
    corners: Vector, normals: Vector, mean: Vector, size: Vector, cells: Indices, uv: Vector
) -> None:
    reach = np.ptp(corners, axis=1).max(axis=1)
    small = size <= _FLAT * reach**2
    if small.any():
        cell = int(np.argmax(small))
        raise SceneError(f"The surface has no area {_place(cells, uv, cell)}; {_REMEDY}.")
    twisted = (np.einsum("fci,fi->fc", normals, mean) < 0).sum(axis=1) > 1
    if twisted.any():
        cell = int(np.argmax(twisted))
        raise SceneError(f"The surface crosses itself {_place(cells, uv, cell)}; {_REMEDY}.")


def _projected(nodes: Vector, normal: Vector) -> Vector:
    """The nodes (N, 2) seen against ``normal``, so that what runs round it stays that way."""
    z = normal / np.linalg.norm(normal)
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return nodes @ np.column_stack([x, np.cross(z, x)])


def _runs_one_way(flat: Vector, cells: Indices) -> bool:
    """Whether all triangles of the cells are counter-clockwise where they are flattened."""
    triangles, _ = triangles_of(cells)
    a, b, c = np.moveaxis(flat[triangles], 1, 0)
    (x, y), (p, q) = (b - a).T, (c - a).T
    return bool((x * q - y * p > 0).all())


def _crosses(flat: Vector, edges: Indices) -> bool:
    """Whether any of the edges (E, 2) crosses another where they are flattened."""
    lines = np.asarray(shapely.linestrings(flat[edges]))
    return bool(shapely.STRtree(lines).query(lines, predicate="crosses").size)


@functools.lru_cache(maxsize=16)
def _edges(cells: bytes) -> tuple[Indices, NDArray[np.int32]]:
    """The edges of the cells (E, 2), and the cells at their sides (E, 2), −1 where there is none.

    Of an edge with more than two cells the first and the last count.
    """
    ends, owner = cell_edges(np.frombuffer(cells, dtype=np.int32).reshape(-1, 4))
    ends = np.sort(ends, axis=1)
    names = ends[:, 0].astype(np.int64) << 32 | ends[:, 1]
    _, first, which = np.unique(names, return_index=True, return_inverse=True)
    sides = np.full((len(first), 2), -1, dtype=np.int32)
    sides[:, 0] = owner[first]
    again = np.ones(len(ends), dtype=bool)
    again[first] = False
    sides[which[again], 1] = owner[again]
    return ends[first], sides


def _place(cells: Indices, uv: Vector, cell: int) -> str:
    """Where a cell is, as a message says it."""
    u, v = uv[cells[cell, 0]]
    return f"near u = {u:.2f}, v = {v:.2f} (cell {cell}, node {cells[cell, 0]})"
