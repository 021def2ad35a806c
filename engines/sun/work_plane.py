"""The work plane of a room: where daylight is measured, over its floor and off its walls."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from ..core.errors import ParameterError, SceneError
from ..core.meshes import Textured
from ..core.parameters import param
from ..core.scene import Mesh, Vector
from .floors import LEVEL, Floor, connected, floors_from, floors_of, grid_of, polygons_of

MOST = 4096
"""Texels along a side of a receiver."""
_MITRE = {"join_style": "mitre", "mitre_limit": 10.0}
_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkPlane:
    """A horizontal grid of sensors over a floor."""

    height: float = param(0.8, "m", 0.0, 100.0, "Height over the floor")
    margin: float = param(0.5, "m", 0.0, 100.0, "Distance from walls and columns")
    spacing: float = param(0.5, "m", 0.001, 100.0, "Distance between sensors")


@dataclass(frozen=True, slots=True)
class SensorGrid:
    """A mesh that looks up and its map, in which ``texels`` × ``texels`` are squares of ``spacing``
    m; the grid lies along the longer side of the plane."""

    textured: Textured
    texels: int


def over_rooms(name: str, mesh: Mesh, record: WorkPlane) -> SensorGrid:
    """The work plane over the floors of the rooms that ``mesh`` is, in its own axes, Z up.

    Columns and inner walls, in the mesh as holes of the floor or as bodies that reach through the
    plane, are kept off like the walls. Raises SceneError, naming it, where there is no floor or the
    margin leaves nothing of it, ParameterError for more than MOST sensors along a side.
    """
    mesh = mesh.triangles()
    floors = floors_of(mesh, record.height)
    if not floors:
        raise SceneError(
            f"“{name}” has no horizontal floor; choose the floor's faces in Edit Mode, or another "
            "object."
        )
    planes = [_over(floor, mesh, record) for floor in floors]
    return _grid(name, floors, planes, record, grid_of(mesh))


def over_faces(name: str, mesh: Mesh, record: WorkPlane) -> SensorGrid:
    """The work plane over all faces of ``mesh``; what stands on them is not looked for.

    Raises as `over_rooms`.
    """
    mesh = mesh.triangles()
    floors = floors_from(mesh)
    if not floors:
        raise SceneError(f"The chosen faces of “{name}” are upright; choose those of the floor.")
    planes = [_inset(floor.outline, record.margin) for floor in floors]
    return _grid(name, floors, planes, record, grid_of(mesh))


def _over(floor: Floor, mesh: Mesh, record: WorkPlane) -> Any:
    """What of a floor's plan is the margin off all that stands through the plane."""
    sections = _sections(mesh, floor.level + record.height)
    solid = shapely.union_all([_solid(lines, floor.outline) for lines in sections])
    free = floor.outline.difference(solid, grid_size=grid_of(mesh))
    plane = _inset(free, record.margin)
    walls = shapely.union_all(sections).intersection(free)
    walls = walls.difference(free.boundary.buffer(LEVEL))
    if record.margin > 0 and not walls.is_empty:
        plane = plane.difference(walls.buffer(record.margin, cap_style="square", **_MITRE))
    return plane


def _inset(plan: Any, margin: float) -> Any:
    return plan.buffer(-margin, **_MITRE) if margin > 0 else plan


def _sections(mesh: Mesh, level: float) -> list[Any]:
    """The lines in plan in which each part of a mesh of triangles meets a horizontal plane."""
    above = mesh.vertices[mesh.faces][..., 2] > level
    met = above.any(axis=1) & ~above.all(axis=1)
    part = connected(mesh.faces, len(mesh.vertices))[mesh.faces[met, 0]]
    corners, above = mesh.vertices[mesh.faces[met]], above[met]
    # The corner that is alone on its side, then the two others.
    lone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), above.argmin(axis=1))
    row = np.arange(len(corners))
    first, ends = corners[row, lone], []
    for step in (1, 2):
        other = corners[row, (lone + step) % 3]
        share = (level - first[:, 2]) / (other[:, 2] - first[:, 2])
        ends.append(first[:, :2] + share[:, None] * (other - first)[:, :2])
    segments = np.round(np.stack(ends, axis=1) / grid_of(mesh)) * grid_of(mesh)
    long = (segments[:, 0] != segments[:, 1]).any(axis=1)
    lines, part = np.asarray(shapely.linestrings(segments[long])), part[long]
    return [shapely.union_all(lines[part == p], grid_size=grid_of(mesh)) for p in np.unique(part)]


def _solid(lines: Any, floor: shapely.Polygon) -> Any:
    """The inside of a body that stands free on a floor: every other ring, from the outside in."""
    cells = polygons_of(shapely.polygonize(list(shapely.get_parts(lines))))
    inner = [c for c in cells if floor.contains(c) and c.distance(floor.boundary) > LEVEL]
    filled = [shapely.Polygon(cell.exterior) for cell in inner]
    points = [cell.representative_point() for cell in inner]
    depths = [sum(ring.contains(point) for ring in filled) for point in points]
    return shapely.union_all([c for c, depth in zip(inner, depths, strict=True) if depth % 2])


def _grid(
    name: str, floors: Sequence[Floor], planes: Sequence[Any], record: WorkPlane, grid: float
) -> SensorGrid:
    """The planes in triangles, with a map along the longer side of all of them."""
    triangles, heights = [], []
    for floor, plane in zip(floors, planes, strict=True):
        for part in polygons_of(shapely.set_precision(plane, grid)):
            pieces = polygons_of(shapely.constrained_delaunay_triangles(part))
            triangles += [shapely.get_coordinates(piece)[:3] for piece in pieces]
            heights += [floor.level + record.height] * len(pieces)
    if not triangles:
        raise SceneError(
            f"A margin of {record.margin:g} m leaves nothing of the floor of “{name}”; make it "
            "smaller."
        )
    flat = np.array(triangles)
    a, b, c = (flat[:, k] for k in range(3))
    turned = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] < 0
    flat[turned] = flat[turned][:, ::-1]
    texture, texels = _map(name, flat, record.spacing)
    places = np.concatenate([flat, np.repeat(heights, 3).reshape(-1, 3, 1)], axis=2)
    vertices, index = np.unique(places.reshape(-1, 3), axis=0, return_inverse=True)
    mesh = Mesh(vertices, index.reshape(-1, 3).astype(np.int32))
    return SensorGrid(Textured(mesh, texture), texels)


def _map(name: str, flat: Vector, spacing: float) -> tuple[Vector, int]:
    """Texture coordinates (T, 3, 2) of triangles in plan, and how many texels go along a side."""
    box = shapely.minimum_rotated_rectangle(shapely.multipoints(flat.reshape(-1, 2)))
    corners = shapely.get_coordinates(box)
    sides = np.diff(corners[:3], axis=0)
    x, y = sides[np.argmax(np.linalg.norm(sides, axis=1))]
    along = np.array([x, y]) / math.hypot(x, y)
    if along @ [1, 1] < 0:
        along = -along
    turned = flat @ np.stack([along, [-along[1], along[0]]], axis=1)
    low, high = turned.min(axis=(0, 1)), turned.max(axis=(0, 1))
    counts = np.maximum(np.ceil((high - low) / spacing - _ROUNDING * 100), 1)
    texels = int(counts.max())
    if texels > MOST:
        raise ParameterError(
            f"A spacing of {spacing:g} m makes {texels} sensors along “{name}”; allowed are "
            f"{MOST}, so take a wider one."
        )
    start = (low + high - counts * spacing) / 2
    return np.clip((turned - start) / (texels * spacing), 0.0, 1.0), texels
