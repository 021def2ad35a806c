"""Where sun and sky are measured: points with a normal and the area that each stands for."""

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..core.atlas import charted, spots, without_area
from ..core.errors import ParameterError, SceneError
from ..core.scene import Mesh, Receiver, Surface, Vector

OFFSET = 1e-3
"""m that rays start off a surface, so that it does not shade itself."""


@dataclass(frozen=True, slots=True)
class Sensors:
    """N points that gather on the side of their normals.

    ``points`` (N, 3) float64 in m, ``normals`` (N, 3) float64 unit vectors, ``areas`` (N,) in m²,
    0 where a sensor is a mere point. Rays start ``offset`` m off the points along the normals.
    ``home`` (N,) int64: the flat index of each sensor in an array of ``shape``: faces (F,),
    vertices (V,), a grid or a map (rows, columns), or (2, rows, columns) for front and back.
    ``notes``: what was left out. ``doubtful``: whether some may look to the wrong side, which the
    notes say then.
    """

    points: Vector
    normals: Vector
    areas: Vector
    offset: float
    home: NDArray[np.int64]
    shape: tuple[int, ...]
    notes: tuple[str, ...] = ()
    doubtful: bool = False

    def __len__(self) -> int:
        return len(self.points)

    @property
    def origins(self) -> Vector:
        """Where the rays start (N, 3) in m."""
        return self.points + self.offset * self.normals

    def spread(self, values: NDArray[np.generic], fill: float = np.nan) -> NDArray[np.generic]:
        """``values`` (N, …) at their homes in an array (*shape, …); ``fill`` where no sensor is."""
        out = np.full((int(np.prod(self.shape)), *values.shape[1:]), fill, values.dtype)
        out[self.home] = values
        return out.reshape(*self.shape, *values.shape[1:])

    def some(self, which: slice | NDArray[np.integer[Any] | np.bool_]) -> "Sensors":
        """The sensors that ``which`` selects, as points of their own."""
        home = self.home[which]
        return Sensors(
            self.points[which],
            self.normals[which],
            self.areas[which],
            self.offset,
            np.arange(len(home)),
            (len(home),),
        )

    def turned(self) -> "Sensors":
        """The same points, gathering on the other side."""
        return replace(self, normals=-self.normals)


def at_points(points: Vector, normals: Vector, *, offset: float = OFFSET) -> Sensors:
    """Sensors at ``points`` (N, 3) in m that look along ``normals`` (N, 3) of any length.

    Raises SceneError for a point or a normal that is not finite or has no direction.
    """
    points, normals = (np.array(a, dtype=np.float64).reshape(-1, 3) for a in (points, normals))
    if len(points) != len(normals):
        raise SceneError(
            f"There are {len(points)} points and {len(normals)} normals; give as many."
        )
    length = np.linalg.norm(normals, axis=1)
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1) | ~np.isfinite(length) | ~(length > 0))
    if len(bad):
        raise SceneError(
            f"Sensor {bad[0]} ({len(bad)} in all) has no finite place or no direction; remove it."
        )
    count = len(points)
    normals = normals / length[:, None]
    return Sensors(points, normals, np.zeros(count), offset, np.arange(count), (count,))


def on_plane(
    pose: Vector, width: float, length: float, spacing: float, *, offset: float = OFFSET
) -> Sensors:
    """A grid over a rectangle about the origin of ``pose`` (4, 4), gathering on its +Z side.

    ``width`` along X and ``length`` along Y in m are cut into cells of about ``spacing`` m, with a
    sensor in the middle of each; their shape is (rows along Y, columns along X). Raises
    ParameterError for a size or a spacing that is not above 0.
    """
    sizes = np.array([width, length, spacing])
    if not (np.isfinite(sizes).all() and (sizes > 0).all()):
        raise ParameterError(
            f"A grid of {width:g} m by {length:g} m every {spacing:g} m has no cells; give sizes "
            "and a spacing above 0."
        )
    columns, rows = (max(1, round(size / spacing)) for size in (width, length))
    u, v = pose[:3, 0] * width, pose[:3, 1] * length
    corner = pose[:3, 3] - (u + v) / 2
    return of_receiver(Receiver("Grid", corner, u, v, columns, rows), offset=offset)


def on_mesh(
    name: str, mesh: Mesh, *, per: Literal["face", "vertex"] = "face", offset: float = OFFSET
) -> Sensors:
    """A sensor at the centroid of each face of a mesh, or at each vertex.

    Of a warped quadrilateral the larger triangle has the sensor, nearest to the centroid of both. A
    vertex stands for a third of its triangles' area and looks along their mean normal, by area;
    where they bend, they hide some of what is in front of it. Faces without area and vertices
    without such a face are left out and said in the notes. Raises SceneError, naming the mesh, for
    vertices that are not finite and where nothing is left.
    """
    if not np.isfinite(mesh.vertices).all():
        raise SceneError(f"“{name}” has vertices that are not finite numbers; rebuild its mesh.")
    triangles = mesh.triangles()
    corners = triangles.vertices[triangles.faces]
    vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    areas = np.linalg.norm(vectors, axis=1)
    if per == "face":
        points, vectors, areas = _middles(corners, vectors, areas, mesh.faces.shape[1] - 2)
    else:
        points, owners = mesh.vertices, triangles.faces.T.ravel()
        count = len(points)
        vectors = np.stack(
            [np.bincount(owners, np.tile(v, 3), count) for v in vectors.T / 3], axis=1
        )
        areas = np.bincount(owners, np.tile(areas / 3, 3), count)
    length = np.linalg.norm(vectors, axis=1)
    scale = float(np.ptp(mesh.vertices, axis=0).max()) ** 2 if len(mesh.vertices) else 0.0
    keep = np.flatnonzero(length > 1e-14 * scale)
    if not len(keep):
        raise SceneError(f"“{name}” has no face with an area to measure on; give it faces.")
    lost = len(areas) - len(keep)
    have = "vertex has" if lost == 1 else "vertices have"
    vertices = (f"“{name}”: {lost:,} {have} no area and no sensor.",) if lost else ()
    notes = _flat_faces(name, lost) if per == "face" else vertices
    normals = vectors[keep] / length[keep, None]
    return Sensors(points[keep], normals, areas[keep], offset, keep, (len(areas),), notes)


def _middles(
    corners: Vector, vectors: Vector, areas: Vector, split: int
) -> tuple[Vector, Vector, Vector]:
    """Points and area vectors (F, 3) and areas (F,) of faces of ``split`` triangles in a row each.

    A point lies on the face's largest triangle, whose area vector is the face's.
    """
    corners = corners.reshape(-1, split, 3, 3)
    vectors, areas = vectors.reshape(-1, split, 3), areas.reshape(-1, split)
    total = areas.sum(axis=1)
    largest = np.arange(len(areas)), areas.argmax(axis=1)
    corner, vector = corners[largest], vectors[largest]
    middle = np.einsum("fk,fkji->fi", areas, corners) / 3
    middle /= np.where(total > 0, total, 1)[:, None]
    # Shares of its three corners, by the areas that the middle's foot makes with the others.
    spokes = corner - middle[:, None]
    parts = np.cross(np.roll(spokes, -1, axis=1), np.roll(spokes, -2, axis=1))
    weights = np.maximum(np.einsum("fki,fi->fk", parts, vector), 0)
    whole = weights.sum(axis=1, keepdims=True)
    weights = np.divide(weights, whole, out=weights, where=whole > 0)
    return np.einsum("fk,fki->fi", weights, corner), vector, total


def of_receiver(receiver: Receiver | Surface, *, offset: float = OFFSET) -> Sensors:
    """A sensor at the middle of each of a receiver's texels, front first where both sides gather.

    A mesh has them where its map shows something. They lie on it: where a texel is of several
    faces, on that with most of it, and look as that does, so that no surface that bends hides its
    own sensors. How many faces have no area, and no sensor, is in the notes. Raises SceneError
    where its map is none.
    """
    if isinstance(receiver, Receiver):
        s = (np.arange(receiver.columns) + 0.5) / receiver.columns
        t = (np.arange(receiver.rows) + 0.5) / receiver.rows
        places = receiver.origin + s[None, :, None] * receiver.u + t[:, None, None] * receiver.v
        count = places[..., 0].size
        points, home = places.reshape(-1, 3), np.arange(count)
        normals = np.tile(receiver.normal, (count, 1))
        areas = np.full(count, receiver.texel_area)
        notes: tuple[str, ...] = ()
    else:
        texels = charted(receiver)
        home = np.flatnonzero(texels.inside)
        points, normals = spots(receiver, texels)
        areas = texels.area.ravel()[home]
        notes = _flat_faces(receiver.name, without_area(receiver.mesh))
    shape = (receiver.rows, receiver.columns)
    front = Sensors(points, normals, areas, offset, home, shape, notes)
    if receiver.sides == "front":
        return front
    both = joined(front, front.turned())
    beside = np.concatenate([home, home + receiver.rows * receiver.columns])
    return replace(both, home=beside, shape=(2, *shape), notes=notes)


def _flat_faces(name: str, lost: int) -> tuple[str, ...]:
    have = "face has" if lost == 1 else "faces have"
    return (f"“{name}”: {lost:,} {have} no area and no sensor.",) if lost else ()


def joined(*parts: Sensors) -> Sensors:
    """Several sets of sensors as one, in order; rays start as far off as the farthest of them."""
    count = sum(map(len, parts))
    return Sensors(
        np.concatenate([p.points for p in parts]),
        np.concatenate([p.normals for p in parts]),
        np.concatenate([p.areas for p in parts]),
        max(p.offset for p in parts),
        np.arange(count),
        (count,),
        tuple(note for p in parts for note in p.notes),
    )
