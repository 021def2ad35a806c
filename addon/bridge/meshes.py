"""Meshes between Blender and the engines, through arrays."""

import math
import zlib
from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.errors import SceneError
from ...engines.core.meshes import Textured
from ...engines.core.scene import Mesh, Vector

_NORMALS, _SHARP = "custom_normal", "sharp_face"
_CREASE = math.radians(60)


def to_blender(mesh: Mesh, target: str | bpy.types.Mesh) -> bpy.types.Mesh:
    """Put ``mesh`` into a mesh datablock, or into a new one of that name.

    Exact to float32, the corner normals too, in Blender units. Materials stay. Where the faces are
    as they were, only places and normals are written.
    """
    block = bpy.data.meshes.new(target) if isinstance(target, str) else target
    if not _has_faces(block, mesh.faces):
        block.clear_geometry()
        count, sides = mesh.faces.shape
        block.vertices.add(len(mesh.vertices))
        block.loops.add(count * sides)
        block.loops.foreach_set("vertex_index", mesh.faces.ravel())
        block.polygons.add(count)
        starts = np.arange(0, count * sides, sides, dtype=np.int32)
        block.polygons.foreach_set("loop_start", starts)
    places = np.ascontiguousarray(mesh.vertices, dtype=np.float32)
    block.attributes["position"].data.foreach_set("vector", places.ravel())
    if mesh.normals is None:
        _forget_normals(block)
        _shade_flat(block)
    else:
        block.shade_smooth()
        # Free normals, written as they are: 1 ms, where normals_split_custom_set takes 2.4 s.
        stored = block.attributes.get(_NORMALS)
        if stored is None:
            stored = block.attributes.new(_NORMALS, "FLOAT_VECTOR", "CORNER")
        stored.data.foreach_set("vector", mesh.normals.ravel())
    block.update(calc_edges=not block.edges)
    return block


def _shade_flat(block: bpy.types.Mesh) -> None:
    """As Blender's own, which goes from face to face in Python."""
    sharp = block.attributes.get(_SHARP) or block.attributes.new(_SHARP, "BOOLEAN", "FACE")
    sharp.data.foreach_set("value", np.ones(len(block.polygons), dtype=bool))


def lines_to_blender(
    points: NDArray[np.float64], edges: NDArray[np.int32], block: bpy.types.Mesh
) -> None:
    """Put ``points`` (N, 3) joined by ``edges`` (E, 2), without faces, into a mesh datablock."""
    block.clear_geometry()
    block.vertices.add(len(points))
    block.edges.add(len(edges))
    block.vertices.foreach_set("co", points.astype(np.float32).ravel())
    block.edges.foreach_set("vertices", edges.astype(np.int32).ravel())
    block.update()


def edges_from_blender(block: bpy.types.Mesh) -> tuple[Vector, NDArray[np.int32]]:
    """The vertices (V, 3) of a mesh datablock and its edges (E, 2)."""
    edges = np.empty((len(block.edges), 2), dtype=np.int32)
    block.edges.foreach_get("vertices", edges.ravel())
    return places_of(block), edges


def from_blender(evaluated: bpy.types.Object) -> Mesh:
    """The mesh of an evaluated object in its own axes and Blender units, modifiers included.

    Quadrilaterals stay whole where they split along their first diagonal; other polygons come as
    Blender's triangles. Raises SceneError, naming the object, where there are no faces.
    """
    with mesh_of(evaluated) as block:
        if _is_modified(evaluated) and _has_free_normals(block):
            # Modifiers leave free normals as they were; smooth shading with creases follows them.
            _forget_normals(block)
            block.set_sharp_from_angle(angle=_CREASE)
        return from_block(block)


def from_block(block: bpy.types.Mesh) -> Mesh:
    """A mesh datablock that has faces, in Blender units; faces as of `from_blender`."""
    picked = _picked(block)
    normals = None
    if block.normals_domain != "FACE":
        normals = np.empty((len(block.loops), 3), dtype=np.float32)
        block.corner_normals.foreach_get("vector", normals.ravel())
        normals = normals[picked]
    return Mesh(places_of(block), corners_of(block)[picked], normals)


def network_from_blender(evaluated: bpy.types.Object) -> Mesh:
    """The edges of an evaluated object, and those faces that have three or four of them.

    In its own axes and Blender units. Everything is a quadrilateral: a triangle names its last
    corner twice, an edge both. Raises SceneError, naming the object, where there are no edges.
    """
    block = evaluated.to_mesh()
    try:
        if block is None or not block.edges:
            raise SceneError(f"“{evaluated.name}” has no edges; draw some, or choose another mesh.")
        places, edges = edges_from_blender(block)
        starts = np.empty(len(block.polygons), dtype=np.int32)
        block.polygons.foreach_get("loop_start", starts)
        sides = np.diff(np.append(starts, len(block.loops)))
        corners = corners_of(block) if len(block.loops) else np.zeros(0, dtype=np.int32)
        faces = [edges[:, [0, 1, 1, 0]]]
        for count in (3, 4):
            order = np.minimum(np.arange(4), count - 1)
            faces.append(corners[starts[sides == count][:, None] + order])
        return Mesh(places, np.concatenate(faces).astype(np.int32))
    finally:
        evaluated.to_mesh_clear()


def textured_from_blender(evaluated: bpy.types.Object) -> Textured:
    """The flat faces of an evaluated object and its active UV map, otherwise as `from_blender`."""
    with mesh_of(evaluated) as block:
        picked = _picked(block)
        mesh = Mesh(places_of(block), corners_of(block)[picked])
        layer = block.uv_layers.active
        if layer is None:
            return Textured(mesh)
        texture = np.empty((len(block.loops), 2), dtype=np.float32)
        layer.uv.foreach_get("vector", texture.ravel())
        return Textured(mesh, texture.astype(np.float64)[picked])


@contextmanager
def mesh_of(evaluated: bpy.types.Object) -> Iterator[bpy.types.Mesh]:
    """The mesh of an evaluated object for a while. Raises SceneError where it has no faces."""
    block = evaluated.to_mesh()
    try:
        if block is None or not block.polygons:
            raise no_faces(evaluated.name)
        yield block
    finally:
        evaluated.to_mesh_clear()


def no_faces(name: str) -> SceneError:
    """What is said of an object without faces."""
    return SceneError(f"“{name}” has no faces; give it a mesh, or set its role to None.")


def has_faces(evaluated: bpy.types.Object) -> bool:
    """Whether an evaluated object has faces of its own."""
    block = evaluated.to_mesh()
    try:
        return block is not None and len(block.polygons) > 0
    finally:
        evaluated.to_mesh_clear()


def places_of(block: bpy.types.Mesh) -> Vector:
    """Where the vertices are (V, 3), in Blender units."""
    places = np.empty((len(block.vertices), 3), dtype=np.float32)
    block.attributes["position"].data.foreach_get("vector", places.ravel())
    return places.astype(np.float64)


def digest_of(block: bpy.types.Mesh) -> str:
    """Eight hex digits that name where the vertices are."""
    places = np.empty(3 * len(block.vertices), dtype=np.float32)
    if len(places):
        block.attributes["position"].data.foreach_get("vector", places)
    return f"{zlib.crc32(places.tobytes()):08x}"


def corners_of(block: bpy.types.Mesh) -> NDArray[np.int32]:
    """The vertices (C,) of the faces' corners."""
    corners = np.empty(len(block.loops), dtype=np.int32)
    block.attributes[".corner_vert"].data.foreach_get("value", corners)
    return corners


def _picked(block: bpy.types.Mesh) -> NDArray[np.int32]:
    """The corners (F, 3) or (F, 4) of the faces."""
    count = len(block.loop_triangles)
    triangles = np.empty((count, 3), dtype=np.int32)
    block.loop_triangles.foreach_get("loops", triangles.ravel())
    if count == 2 * len(block.polygons) and 2 * len(block.loops) == 4 * count:
        quads = np.arange(len(block.loops), dtype=np.int32).reshape(-1, 4)
        if np.array_equal(triangles, quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)):
            return quads
    return triangles


def _has_faces(block: bpy.types.Mesh, faces: NDArray[np.int32]) -> bool:
    if len(block.loops) != faces.size or len(block.polygons) != len(faces):
        return False
    return np.array_equal(corners_of(block), faces.ravel())


def _is_modified(evaluated: bpy.types.Object) -> bool:
    return any(modifier.show_viewport for modifier in evaluated.modifiers)


def _has_free_normals(block: bpy.types.Mesh) -> bool:
    stored = block.attributes.get(_NORMALS)
    return stored is not None and stored.data_type == "FLOAT_VECTOR"


def _forget_normals(block: bpy.types.Mesh) -> None:
    stored = block.attributes.get(_NORMALS)
    if stored is not None:
        block.attributes.remove(stored)
