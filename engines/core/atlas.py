"""The texels of a surface's map: what of the surface each covers, and how values go on it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.spatial import KDTree

from .clipping import Indices, Pieces, coverage, pieces
from .errors import SceneError
from .scene import Mesh, Surface, Vector

_SLIVER = 0.05  # of a texel: what covers less gives its light to a neighbour
_DUST = 1e-3  # of a texel: what covers less, and has no such neighbour, is not shown
_STEPS = 4  # texels that a sliver's light may go
_SLACK = 1e-3  # of the map, or of the surface: what may be amiss
_ROUNDED = 1e-5  # how far a coordinate may be outside 0..1
_ANEW = "unwrap it anew or clear its UV map so that Heliform unwraps it."
_AROUND = [(0, -1), (0, 1), (-1, 0), (1, 0), (-1, -1), (-1, 1), (1, -1), (1, 1)]


@dataclass(frozen=True, slots=True)
class Texels:
    """What of a surface the texels of its map cover; row 0 is at v = 0.

    ``area`` (rows, columns) float64 in m²; ``place`` (rows, columns, 3) float64 in m, the centroid
    of that area; ``normal`` (rows, columns, 3) float64, its mean unit normal; ``face`` (rows,
    columns) int32, the face with most of it. Where there is no surface: 0, 0, 0 and -1.

    ``home`` (rows, columns) int32 is the flat index of the texel that answers for each. Along the
    border of a chart, slivers under 5 % of a texel would show noise and no more; a neighbour of
    the same chart takes their area, and is to take their light: see ``gathered``. So does it with
    what rounding lands on an empty texel next to a chart. Every other texel is its own.

    ``inside`` (rows, columns) bool: where there is a value worth showing. That is wherever there
    is area, but for slivers under 0.1 % of a texel that found no neighbour; theirs is not shown.
    """

    area: Vector
    place: Vector
    normal: Vector
    face: NDArray[np.int32]
    home: NDArray[np.int32]
    inside: NDArray[np.bool_]
    shared: float

    def gathered(self, amounts: Vector) -> Vector:
        """``amounts`` (rows, columns), such as flux in lm, each brought home; their sum stays."""
        brought = np.bincount(self.home.ravel(), amounts.ravel(), self.home.size)
        return brought.reshape(self.home.shape)


def texels(surface: Surface) -> Texels:
    """What of the surface each texel of its map covers, by exact clipping.

    The areas add up to the mesh's. A face without area in the map puts all of its own into the
    texel at its middle; what is outside 0..1 is moved to the border (see ``require_chart``).
    """
    mesh, columns, rows = surface.mesh, surface.columns, surface.rows
    corners = mesh.vertices[mesh.faces].transpose(1, 2, 0)
    areas, normals = _areas(mesh)
    sums = np.zeros((8, rows * columns))  # area, covered, 3 of place, 3 of normal
    most, face = np.zeros(rows * columns), np.full(rows * columns, -1, dtype=np.int32)
    for some in _solid_pieces(surface, areas):
        area = some.part * areas[some.face]
        places = (corners[:, :, some.face] * some.weights[:, None]).sum(axis=0)
        added = [area, some.covered, *(places * area), *(normals.T[:, some.face] * area)]
        for total, amounts in zip(sums, added, strict=True):
            np.add.at(total, some.texel, amounts)
        order = np.argsort(area, kind="stable")
        order = order[area[order] > most[some.texel[order]]]  # of equals, the last one stays
        most[some.texel[order]] = area[order]
        face[some.texel[order]] = some.face[order]
    shared = _claimed_twice(sums[1])
    home = _homes(sums[1].reshape(rows, columns), face, _charts(surface))
    moved = np.flatnonzero(home != np.arange(len(home)))
    for total in sums:
        np.add.at(total, home[moved], total[moved])
        total[moved] = 0.0
    face[moved] = -1
    area, covered, places, normal = sums[0], sums[1], sums[2:5], sums[5:8]
    length = np.sqrt((normal * normal).sum(axis=0))
    shape = (rows, columns)
    return Texels(
        area.reshape(shape),
        np.divide(places, area, out=places, where=area > 0).T.reshape(*shape, 3).copy(),
        np.divide(normal, length, out=normal, where=length > 0).T.reshape(*shape, 3).copy(),
        face.reshape(shape),
        home.reshape(shape).astype(np.int32),
        ((area > 0) & (covered >= _DUST)).reshape(shape),
        shared,
    )


def spots(surface: Surface, texels: Texels) -> tuple[Vector, Vector]:
    """A place on the surface for each texel that is ``inside``, in m, and the unit normal there.

    Both (N, 3), in the texels' order: the centroid of what the texel's ``face`` covers of it. A
    texel's own centroid is off the surface where that bends within the texel.
    """
    shown = np.flatnonzero(texels.inside)
    face = texels.face.ravel()
    used, number = np.unique(face[shown], return_inverse=True)
    mesh, of = surface.mesh, np.full(face.size, -1)
    of[shown] = number
    weights = np.zeros((3, face.size))
    for some in pieces(surface.texture[used], surface.columns, surface.rows):
        own = of[some.texel] == some.face
        weights[:, some.texel[own]] = some.weights[:, own]
    corners = mesh.vertices[mesh.faces[face[shown]]]
    normals = _areas(Mesh(mesh.vertices, mesh.faces[used]))[1]
    return np.einsum("kn,nki->ni", weights[:, shown], corners), normals[number]


def _areas(mesh: Mesh) -> tuple[Vector, Vector]:
    """Area (F,) and unit normal (F, 3) of each triangle; no normal where there is no area."""
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    length = np.sqrt(np.einsum("fi,fi->f", cross, cross))
    return length / 2, np.divide(cross, length[:, None], out=cross, where=length[:, None] > 0)


def without_area(mesh: Mesh) -> int:
    """How many of the faces have none, and so no texel."""
    return len(mesh.faces) - len(_solid(_areas(mesh)[0]))


def _solid(areas: Vector) -> Indices:
    """The faces that have area; where others are in the map does not matter."""
    return np.flatnonzero(areas > 1e-9 * areas.mean())


def _solid_pieces(surface: Surface, areas: Vector) -> Iterator[Pieces]:
    solid = _solid(areas)
    for some in pieces(surface.texture[solid], surface.columns, surface.rows):
        yield replace(some, face=solid[some.face])


def _charts(surface: Surface) -> Indices:
    """Which chart each face belongs to (F,): those that meet at a vertex in the map are one."""
    corners = surface.mesh.faces.reshape(-1)
    u, v = surface.texture.reshape(-1, 2).T
    order = np.lexsort((v, u, corners))
    same = (np.diff(corners[order]) == 0) & (np.diff(u[order]) == 0) & (np.diff(v[order]) == 0)
    point = np.empty(len(corners), dtype=np.intp)
    point[order] = np.concatenate([[0], np.cumsum(~same)])
    a, b, c = point.reshape(-1, 3).T
    joins = np.concatenate([a, b]), np.concatenate([b, c])
    graph = sparse.coo_array((np.ones(len(joins[0]), dtype=bool), joins), shape=2 * (len(point),))
    return sparse.csgraph.connected_components(graph, directed=False)[1][a]


def _homes(covered: Vector, face: Indices, charts: Indices) -> Indices:
    """The texel (rows · columns,) that answers for each."""
    there = (covered > 0).ravel()
    covered = np.round(covered, 6)  # of equals, the first neighbour is taken
    chart = np.where(there, charts[face], -1)
    settled = np.where(covered.ravel() >= _SLIVER, covered.ravel(), 0.0)
    home = np.arange(covered.size)
    slivers = np.flatnonzero(there & (settled == 0))
    for _ in range(_STEPS):
        beside = _neighbours(slivers, covered.shape)
        claims = np.where(chart[beside] == chart[slivers], settled[beside], 0.0)
        best = claims.argmax(axis=0), np.arange(len(slivers))
        found = claims[best] > 0
        home[slivers[found]] = home[beside[best][found]]
        settled[slivers[found]] = claims[best][found]
        slivers = slivers[~found]
    near = ndimage.maximum_filter(covered, size=3, mode="constant") > 0
    empty = np.flatnonzero(near.ravel() & ~there)
    beside = _neighbours(empty, covered.shape)
    best = covered.ravel()[beside].argmax(axis=0), np.arange(len(empty))
    home[empty] = home[beside[best]]
    return home


def _neighbours(texel: Indices, shape: tuple[int, ...]) -> Indices:
    """The eight texels (8, N) around each; beyond the border stands the texel itself."""
    row, column = np.divmod(texel, shape[1])
    beside = []
    for down, right in _AROUND:
        r, c = row + down, column + right
        there = (r >= 0) & (r < shape[0]) & (c >= 0) & (c < shape[1])
        beside.append(np.where(there, r * shape[1] + c, texel))
    return np.array(beside)


# Whether it is a map


def overlapping(surface: Surface) -> float:
    """Share of the map in use that more than one face claims, 0..1.

    Found where the faces claim more of a texel than there is, on a grid of the map's texels, of 512
    a side at least. Faces without area claim nothing.
    """
    sides = max(surface.columns, 512), max(surface.rows, 512)
    return _claimed_twice(coverage(surface.texture[_solid(_areas(surface.mesh)[0])], *sides))


def _claimed_twice(claimed: Vector) -> float:
    used = np.minimum(claimed, 1.0).sum()
    twice = np.clip(claimed - 1.0, 0.0, 1.0)
    return float(twice[twice > 1e-6].sum() / used) if used > 0 else 0.0


def require_chart(surface: Surface) -> None:
    """Raise SceneError unless light can be gathered in the surface's map.

    That is: there is a surface, and the map has a place within 0..1 for each part of it, its own.
    Faces without area may have any; a thousandth may be amiss.
    """
    _require_places(surface)
    _require_own(surface, overlapping(surface))


def charted(surface: Surface) -> Texels:
    """The texels of a surface's map. Raises SceneError as `require_chart`; whether faces share a
    place in the map is judged by its own texels, which costs nothing."""
    _require_places(surface)
    found = texels(surface)
    _require_own(surface, found.shared)
    return found


def _require_places(surface: Surface) -> None:
    name = surface.name
    areas, _ = _areas(surface.mesh)
    if not np.isfinite(areas).all():
        raise SceneError(
            f"Receiver “{name}” has vertices that are nowhere (not a number); "
            "delete them, or undo what made them."
        )
    if not areas.sum() > 0:
        raise SceneError(f"Receiver “{name}” has no area; give it faces, and a scale above 0.")
    solid = _solid(areas)
    areas, texture = areas[solid], surface.texture[solid]
    if not np.isfinite(texture).all():
        raise SceneError(f"Receiver “{name}” has UVs that are not numbers; {_ANEW}")
    low, high = texture.min(), texture.max()
    if low < -_ROUNDED or high > 1 + _ROUNDED:
        raise SceneError(
            f"Receiver “{name}” has UVs outside its map, from {low:.4g} to {high:.4g} "
            f"where 0 to 1 is; scale them into it, or {_ANEW}"
        )
    a, b, c = texture.transpose(1, 2, 0)
    twice = np.abs((b - a)[0] * (c - a)[1] - (c - a)[0] * (b - a)[1])
    lost = areas[twice < 1e-12].sum() / areas.sum()
    if lost > _SLACK:
        raise SceneError(
            f"Receiver “{name}” has no place in its UV map for {_percent(lost)} of its surface; "
            + _ANEW
        )


def _require_own(surface: Surface, shared: float) -> None:
    if shared > _SLACK:
        raise SceneError(
            f"Receiver “{surface.name}” has overlapping UVs ({_percent(shared)} of its map); "
            + _ANEW
        )


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share < 0.995 else "100 %"


# Values


def padded(
    values: NDArray[np.floating], inside: NDArray[np.bool_], reach: int
) -> NDArray[np.floating]:
    """``values`` (rows, columns[, k]) carried beyond the charts, so that no seam shows.

    Texels that are not ``inside`` (rows, columns) take the value of the nearest one that is, where
    it is within ``reach`` texels along both axes; others are 0.
    """
    out = np.zeros_like(values)
    if not inside.any():
        return out
    nearest = np.empty((2, *inside.shape), dtype=np.int32)
    ndimage.distance_transform_edt(
        ~inside, return_distances=False, return_indices=True, indices=nearest
    )
    row, column = nearest[0], nearest[1]
    rows, columns = np.ogrid[: inside.shape[0], : inside.shape[1]]
    near = (np.abs(row - rows) <= reach) & (np.abs(column - columns) <= reach)
    out[near] = values[row[near], column[near]]
    return out


def at_vertices(surface: Surface, values: Vector, texels: Texels) -> Vector:
    """``values`` (rows, columns) of the texels as values (V,) of the mesh's vertices.

    A vertex takes the mean over its faces, weighted with area and, within a face, with nearness
    (the vertex's share in a linear interpolation). Interpolated over the mesh, values keep their
    integral: Σ value · area over the texels. A vertex without any takes the nearest texel's.
    """
    mesh = surface.mesh
    areas, _ = _areas(mesh)
    shown, home = np.ravel(texels.inside), np.ravel(texels.home)
    value = np.where(shown, values.ravel(), 0.0)[home]
    weight = np.where(shown, 1.0, 0.0)[home]
    total, weights = np.zeros((2, len(mesh.vertices)))
    for some in _solid_pieces(surface, areas):
        near = some.part * areas[some.face] * some.weights * weight[some.texel]
        vertex = mesh.faces[some.face].T
        np.add.at(weights, vertex.ravel(), near.ravel())
        np.add.at(total, vertex.ravel(), (near * value[some.texel]).ravel())
    known = weights > 0
    result = np.divide(total, weights, out=total, where=known)
    if shown.any() and not known.all():
        nearest = KDTree(texels.place[texels.inside]).query(mesh.vertices[~known])[1]
        result[~known] = values[texels.inside][nearest]
    return result
