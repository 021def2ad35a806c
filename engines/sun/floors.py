"""Floors of rooms: where one can stand, found in meshes of any orientation."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..core.scene import Mesh, Vector

LEVEL = 0.01
"""Metres between what counts as one level, and between what counts as touching."""
_SAME = 1e-4
"""Metres within which vertices are at one place."""
_OVERLAP = 1e-6
_STEEP = np.cos(np.radians(2.0))
_COVERED = 0.5
"""The share of a face's area under which what lies closely above is no more than furniture."""


@dataclass(frozen=True, slots=True)
class Floor:
    """A connected floor: its ``outline`` in plan, holes included, and its ``level`` in m."""

    outline: shapely.Polygon
    level: float


@dataclass(frozen=True, slots=True)
class _Piece:
    outline: shapely.Polygon
    level: float
    part: int


def floors_of(mesh: Mesh, clear: float) -> list[Floor]:
    """The floors of the rooms that a mesh is, whichever way its faces look.

    A floor is horizontal, with ``clear`` m of height free over most of it, so that the underside of
    a slab is none; of what lies one over the other, or touches it in the same connected part of the
    mesh, the lowest is the floor: a ceiling, a table and a sill are none.
    """
    pieces = sorted(_pieces(mesh, _horizontal(mesh)), key=lambda p: (p.level, -p.outline.area))
    found: list[_Piece] = []
    for piece in pieces:
        close = [
            other.outline
            for other in pieces
            if LEVEL < other.level - piece.level <= clear
            and shapely.intersects(other.outline, piece.outline)
        ]
        covered = shapely.union_all(close).intersection(piece.outline).area
        if covered <= _COVERED * piece.outline.area and not any(_under(f, piece) for f in found):
            found.append(piece)
    return [Floor(piece.outline, piece.level) for piece in found]


def floors_from(mesh: Mesh) -> list[Floor]:
    """All faces of a mesh as floors, each connected part one; vertical faces are left out."""
    return [Floor(p.outline, p.level) for p in _pieces(mesh, _upright(mesh) > 1 - _STEEP, True)]


def grid_of(mesh: Mesh) -> float:
    """The metres to which plans are rounded: what Blender's single precision can tell apart."""
    return max(1e-5, 3e-7 * float(np.abs(mesh.vertices).max(initial=0.0)))


def _under(floor: _Piece, piece: _Piece) -> bool:
    """Whether what lies on a piece belongs to the room over a lower floor."""
    filled = shapely.Polygon(floor.outline.exterior)
    if floor.part == piece.part and filled.distance(piece.outline) < LEVEL:
        return True
    return filled.intersection(piece.outline).area > LEVEL * piece.outline.area


def _horizontal(mesh: Mesh) -> NDArray[np.bool_]:
    return _upright(mesh) >= _STEEP


def _upright(mesh: Mesh) -> Vector:
    """How much each triangle (T,) looks up or down, 0..1."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    return np.divide(np.abs(normal[:, 2]), length, out=np.zeros_like(length), where=length > 0)


def _pieces(mesh: Mesh, chosen: NDArray[np.bool_], alone: bool = False) -> Iterator[_Piece]:
    """The connected outlines of the ``chosen`` triangles, at each level of each part of the mesh.

    Parts are those of the chosen triangles ``alone``, and each is then one level.
    """
    faces = mesh.faces[chosen]
    if not len(faces):
        return
    parts = _parts(mesh.vertices, faces if alone else mesh.faces)
    part = parts[faces[:, 0]]
    height = mesh.vertices[faces][..., 2].mean(axis=1)
    level = part if alone else _levels(height)
    rings = np.round(mesh.vertices[faces][..., :2] / grid_of(mesh)) * grid_of(mesh)
    triangles = np.asarray(shapely.polygons(rings))
    whole = shapely.area(triangles) > 0
    for key in np.unique(np.stack([part, level], axis=1), axis=0):
        some = whole & (part == key[0]) & (level == key[1])
        if some.any():
            mean = float(np.average(height[some], weights=shapely.area(triangles[some])))
            for outline in polygons_of(_joined(triangles[some], grid_of(mesh))):
                yield _Piece(outline, mean, int(key[0]))


def _joined(triangles: NDArray[Any], grid: float) -> Any:
    """The plan of triangles: by their shared edges, or where some overlap, the slow way."""
    try:
        found = shapely.coverage_union_all(triangles)
    except shapely.errors.GEOSException:
        return shapely.union_all(triangles, grid_size=grid)
    whole = shapely.area(triangles).sum()
    if not found.is_valid or abs(found.area - whole) > _OVERLAP * whole:
        return shapely.union_all(triangles, grid_size=grid)
    return shapely.union_all(shapely.get_parts(found), grid_size=grid)


def _parts(vertices: Vector, faces: NDArray[np.int32]) -> NDArray[np.intp]:
    """Which connected part each vertex (V,) is of; vertices at one place are one."""
    places = np.round(vertices / _SAME).astype(np.int64)
    _, same = np.unique(places, axis=0, return_inverse=True)
    same = same.reshape(-1)
    return connected(same[faces], int(same.max()) + 1)[same]


def connected(faces: NDArray[np.integer[Any]], count: int) -> NDArray[np.intp]:
    """Which connected part each of ``count`` vertices is of, by the triangles that share some."""
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    graph = coo_array((np.ones(len(ends), bool), ends.T), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def _levels(height: Vector) -> NDArray[np.intp]:
    """Numbers (N,) of the levels that heights (N,) are at: gaps of LEVEL part them."""
    order = np.argsort(height)
    steps = np.concatenate([[0], np.cumsum(np.diff(height[order]) > LEVEL)])
    found = np.empty(len(height), np.intp)
    found[order] = steps
    return found


def polygons_of(shape: Any) -> list[shapely.Polygon]:
    """The polygons, those with an area, that a shape consists of."""
    parts = shapely.get_parts(shape)
    return [part for part in parts if part.geom_type == "Polygon" and part.area > 0]
