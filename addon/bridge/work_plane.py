"""The work plane of a room, as a receiver over its floor."""

from collections.abc import Sequence

import bpy
import numpy as np

from ...engines.core.copies import joined
from ...engines.core.errors import HeliformError, SceneError
from ...engines.core.scene import Mesh
from ...engines.sun.work_plane import SensorGrid, WorkPlane, over_faces, over_rooms
from ..objects import added
from ..properties import scale_of
from .meshes import corners_of, places_of, to_blender
from .read import read_mesh

LAYER = "Work Plane"
"""The UV map whose texels are the sensors."""


def add_work_plane(
    context: bpy.types.Context, objects: Sequence[bpy.types.Object], record: WorkPlane
) -> bpy.types.Object:
    """A receiver over the floors of the rooms that ``objects`` are together.

    In Edit Mode it is over their chosen faces; Object Mode is entered then, so that it can be
    undone. Raises SceneError and ParameterError as the engine; adds nothing then.
    """
    name, scale = objects[0].name, scale_of(context.scene)
    if context.mode == "EDIT_MESH":
        edited = [obj for obj in objects if obj.mode == "EDIT"]
        name = edited[0].name
        bpy.ops.object.mode_set(mode="OBJECT")
        try:
            found = over_faces(name, _chosen(edited, scale), record)
        except HeliformError:
            bpy.ops.object.mode_set(mode="EDIT")
            raise
    else:
        depsgraph = context.evaluated_depsgraph_get()
        rooms = joined([read_mesh(obj, depsgraph, scale) for obj in objects])
        found = over_rooms(name, rooms, record)
    return _receiver(context, f"{name} work plane", found)


def _receiver(context: bpy.types.Context, name: str, found: SensorGrid) -> bpy.types.Object:
    mesh, scale = found.textured.mesh, scale_of(context.scene)
    middle = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    block = to_blender(Mesh((mesh.vertices - middle) / scale, mesh.faces), name)
    layer = block.uv_layers.new(name=LAYER, do_init=False)
    assert found.textured.texture is not None
    layer.uv.foreach_set("vector", found.textured.texture.astype(np.float32).ravel())
    obj = added(context, name, block, "RECEIVER", "")
    obj.location = middle / scale
    obj.heliform.plane.resolution = found.texels
    return obj


def _chosen(objects: Sequence[bpy.types.Object], scale: float) -> Mesh:
    """The selected faces of meshes, as they are without modifiers, in metres."""
    found = []
    for obj in objects:
        block = obj.data
        block.calc_loop_triangles()
        loops = np.empty((len(block.loop_triangles), 3), dtype=np.int32)
        polygon = np.empty(len(loops), dtype=np.int32)
        selected = np.empty(len(block.polygons), dtype=bool)
        block.loop_triangles.foreach_get("loops", loops.ravel())
        block.loop_triangles.foreach_get("polygon_index", polygon)
        block.polygons.foreach_get("select", selected)
        if selected.any():
            faces = corners_of(block)[loops[selected[polygon]]]
            matrix = scale * np.array(obj.matrix_world, dtype=np.float64)
            found.append(Mesh(places_of(block), faces).moved(matrix))
    if not found:
        raise SceneError(f"No face of “{objects[0].name}” is selected; select those of the floor.")
    return joined(found)
