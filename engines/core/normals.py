"""Smooth normals of meshes, as Blender shades them: at vertices, and at corners between creases."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .scene import Mesh, Vector

_TINY = np.finfo(np.float64).tiny

Index = NDArray[np.integer]


def face_normals(mesh: Mesh) -> Vector:
    """Unit normals (F, 3) of the faces, 0 where a face has no area.

    A quadrilateral's is that of the plane through the middles of its sides.
    """
    return np.ascontiguousarray(_flat(_corners(mesh)).T)


def vertex_normals(mesh: Mesh) -> Vector:
    """Unit normals (V, 3) at the vertices.

    The mean of the faces around, weighted by their angle there [Thürmer & Wüthrich 1998]. Where
    there are none, away from the origin, as Blender has it.
    """
    places = _corners(mesh)
    total = _gathered(mesh.faces, len(mesh.vertices), _weighted(places, _flat(places)))
    normals = np.ascontiguousarray(_unit(total).T)
    lost = np.flatnonzero(~normals.any(axis=1))
    normals[lost] = _unit(mesh.vertices[lost].T).T
    return normals


def corner_normals(mesh: Mesh, crease: float) -> NDArray[np.float32]:
    """Unit normals (F, 3 or 4, 3) at the faces' corners, smooth but for creases.

    Each is the mean of the faces that a corner reaches around its vertex without crossing a
    crease, weighted by their angle. A crease is an edge where two faces turn by more than
    ``crease`` radians, where they are wound opposite ways, or where more than two meet.
    """
    places = _corners(mesh)
    flat = _flat(places)
    group, count = _fans(mesh, _joints(mesh, flat, np.cos(crease)))
    smooth = _unit(_gathered(group, count, _weighted(places, flat))).astype(np.float32)
    lost = ~smooth.any(axis=0)
    normals = np.ascontiguousarray(smooth.T)[group]
    if lost.any():
        face, corner = np.nonzero(lost[group])
        normals[face, corner] = flat.T[face]
    return normals


@dataclass(frozen=True, slots=True)
class _Joints:
    """Where two faces share an edge smoothly, their corners (J,) at both ends, numbered through
    all faces; and the vertices (V,) at which some edge is a crease."""

    here: Index
    there: Index
    creased: NDArray[np.bool_]


def _joints(mesh: Mesh, flat: Vector, least: float) -> _Joints:
    """The joints between faces whose normals have a cosine of ``least`` or more."""
    faces, count = mesh.faces.astype(np.int64), len(mesh.vertices)
    sides = faces.shape[1]
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    edge = np.minimum(start, end) * count + np.maximum(start, end)
    order = np.argsort(edge, kind="stable")
    edge = edge[order]
    first = np.flatnonzero(np.append(True, edge[1:] != edge[:-1])[: len(edge)])
    size = np.diff(first, append=len(edge))

    pair = first[size == 2]
    one, other = order[pair], order[pair + 1]
    pairs = one // sides, other // sides
    cosine = sum(np.take(row, pairs[0]) * np.take(row, pairs[1]) for row in flat)
    smooth = (cosine >= least) & (start[one] != start[other])
    sharp = np.concatenate([one[~smooth], order[first[size > 2]]])
    creased = np.zeros(count, dtype=bool)
    creased[start[sharp]] = creased[end[sharp]] = True

    near = smooth & (creased[start[one]] | creased[end[one]])
    one, other = one[near], other[near]
    here = np.concatenate([one, _next(one, sides)])
    there = np.concatenate([_next(other, sides), other])
    near = creased[start[here]]
    return _Joints(here[near], there[near], creased)


def _next(corner: Index, sides: int) -> Index:
    """The next corner of the same face."""
    return np.where(corner % sides == sides - 1, corner - (sides - 1), corner + 1)


def _fans(mesh: Mesh, joints: _Joints) -> tuple[Index, int]:
    """The number (F, 3 or 4) of the fan that each corner is in, and how many numbers there are.

    The corners at a vertex without creases are one fan, numbered as the vertex.
    """
    group = mesh.faces.astype(np.int64)
    split = np.flatnonzero(joints.creased[mesh.faces].ravel())
    place = np.zeros(group.size, dtype=np.int64)
    place[split] = np.arange(len(split))
    ends = place[joints.here], place[joints.there]
    graph = coo_array((np.ones(len(ends[0]), np.int8), ends), shape=(len(split),) * 2)
    fans, label = connected_components(graph, directed=False) if len(split) else (0, split)
    group.ravel()[split] = len(mesh.vertices) + label
    return group, len(mesh.vertices) + int(fans)


def _corners(mesh: Mesh) -> list[Vector]:
    """Where the faces' corners are, a (3, F) for each: whole rows of x, y and z are quicker."""
    rows = np.ascontiguousarray(mesh.vertices.T)
    return [rows[:, corner] for corner in np.ascontiguousarray(mesh.faces.T)]


def _flat(places: list[Vector]) -> Vector:
    """The faces' own unit normals (3, F)."""
    first, second = places[1] - places[0], places[2] - places[0]
    if len(places) == 4:
        first, second = second, places[3] - places[1]
    (a, b, c), (d, e, f) = first, second
    return _unit(np.stack([b * f - c * e, c * d - a * f, a * e - b * d]))


def _weighted(places: list[Vector], flat: Vector) -> list[Vector]:
    """The faces' normals times their angles: a (3, F) for each corner of a face."""
    sides = len(places)
    along = [_unit(places[(c + 1) % sides] - places[c]) for c in range(sides)]
    cosines = [-_dot(along[c], along[c - 1]) for c in range(sides)]
    return [np.arccos(np.clip(c, -1.0, 1.0)) * flat for c in cosines]


def _gathered(group: Index, count: int, values: list[Vector]) -> Vector:
    """The sums (3, count) of corner values over the groups that the corners are in."""
    total = np.zeros((3, count))
    for corner, value in enumerate(values):
        into = np.ascontiguousarray(group[:, corner])
        for row, part in zip(total, value, strict=True):
            row += np.bincount(into, part, count)
    return total


def _unit(vectors: Vector) -> Vector:
    return vectors / np.maximum(np.sqrt(_dot(vectors, vectors)), _TINY)


def _dot(a: Vector, b: Vector) -> Vector:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
