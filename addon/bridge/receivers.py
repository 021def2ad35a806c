"""Receivers that are meshes: the UV map of one that has none, and values on its vertices.

The map is kept in the mesh as the UV map “Heliform”, so that the picture has its place there; it is
made anew where the mesh or the resolution has changed since.
"""

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.atlas import at_vertices, texels
from ...engines.core.errors import SceneError
from ...engines.core.scene import Mesh, Plane, Surface
from ...engines.core.unwrap import unwrap
from ..properties import read, scale_of
from . import results
from .meshes import corners_of, mesh_of, places_of
from .read import SQUARE, objects_of, read_receiver

LAYER = "Heliform"
_KEY = "heliform_unwrapped"
_SAME = 1e-3  # of a texel's area: how far it may be from that of the surface that was traced


def unwrap_receivers(context: bpy.types.Context) -> list[str]:
    """Unwrap the scene's receivers where they need it; a sentence for each that was.

    Raises SceneError, naming the receiver and the remedy, where one cannot be.
    """
    context.view_layer.update()  # or what was just added is not seen
    return unwrap_those(context, objects_of(context.view_layer, "RECEIVER"))


def unwrap_those(context: bpy.types.Context, objects: Iterable[bpy.types.Object]) -> list[str]:
    """As `unwrap_receivers`, for these objects."""
    depsgraph = context.evaluated_depsgraph_get()
    scale = scale_of(context.scene)
    done = [o.name for o in objects if _unwrap_where_needed(o, depsgraph, scale)]
    return [f"“{name}” had no UV map: it was unwrapped into “{LAYER}”." for name in done]


def _unwrap_where_needed(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, scale: float
) -> bool:
    resolution = read(obj.heliform.plane, Plane).resolution
    own = obj.type == "MESH" and obj.data.uv_layers.active
    if own and (own.name != LAYER or obj.data.get(_KEY) == _key(obj.data, resolution)):
        return False
    evaluated = obj.evaluated_get(depsgraph)
    with mesh_of(evaluated) as block:
        if block.uv_layers.active and not own and obj.modifiers:  # which have made it
            return False
        _require_own(obj, block)
        loops = np.empty((len(block.loop_triangles), 3), dtype=np.int32)
        block.loop_triangles.foreach_get("loops", loops.ravel())
        polygon = np.empty(len(loops), dtype=np.int32)
        block.loop_triangles.foreach_get("polygon_index", polygon)
        size = np.linalg.norm(np.array(evaluated.matrix_world)[:3, :3], axis=0) * scale
        mesh = Mesh(places_of(block) * size, corners_of(block)[loops])
        texture = _texture(obj.name, mesh, loops, polygon, resolution)
    if obj.data.users > 1:
        obj.data = obj.data.copy()
    block = obj.data
    layer = block.uv_layers.get(LAYER) or block.uv_layers.new(name=LAYER, do_init=False)
    layer.uv.foreach_set("vector", texture.astype(np.float32).ravel())
    block.uv_layers.active = layer
    layer.active_render = True
    block[_KEY] = _key(block, resolution)
    block.update()
    return True


def _require_own(obj: bpy.types.Object, block: bpy.types.Mesh) -> None:
    """Raise SceneError unless the object's own mesh can hold a map for the evaluated one."""
    said = f"Receiver “{obj.name}” has no UV map"
    if obj.mode != "OBJECT":
        raise SceneError(f"{said}; leave Edit Mode, then Heliform unwraps it.")
    if obj.type != "MESH" or not np.array_equal(corners_of(obj.data), corners_of(block)):
        raise SceneError(
            f"{said}, and its modifiers make faces that Heliform cannot give one; apply them, or "
            "unwrap it with UV › Smart UV Project."
        )
    if not (obj.is_editable and obj.data.is_editable):
        raise SceneError(f"{said} and belongs to another file; unwrap it there, or make it local.")


def _texture(
    name: str,
    mesh: Mesh,
    loops: NDArray[np.int32],
    polygon: NDArray[np.int32],
    resolution: int,
) -> NDArray[np.float64]:
    """Texture coordinates (C, 2) of the corners ``loops`` (F, 3) of a mesh of triangles."""
    if polygon.max() == 0 and loops.max() == 3:
        return SQUARE[0]
    try:
        found = unwrap(mesh, resolution, polygon=polygon)
    except SceneError as error:
        raise SceneError(f"Receiver “{name}”: {error}") from None
    texture = np.zeros((loops.max() + 1, 2))
    flat = (found == found[:, :1]).all(axis=(1, 2))  # at a point: of no area, others say where
    for some in (flat, ~flat):
        texture[loops[some]] = found[some]
    if not np.array_equal(texture[loops[~flat]], found[~flat]):
        raise SceneError(
            f"Receiver “{name}” has faces that are bent too much to be unwrapped; triangulate them "
            "with Face › Triangulate Faces."
        )
    return texture


def _key(block: bpy.types.Mesh, resolution: int) -> str:
    """What a map of Heliform's was made for."""
    digest = hashlib.sha256(str(resolution).encode())
    for values in (places_of(block), corners_of(block)):
        digest.update(values.tobytes())
    return digest.hexdigest()


def values_to_vertices(context: bpy.types.Context, picture: bpy.types.Image) -> str:
    """Write the map that is shown as a float attribute of its receiver's vertices; its name.

    Raises SceneError where the receiver is gone, and as `onto_vertices`.
    """
    owner = results.owner_of(picture)
    if owner is None or owner.name not in context.scene.objects:
        raise SceneError(f"The receiver of “{picture.name}” is gone; trace photons onto another.")
    result, name = results.staged(picture), picture.heliform_map
    side = f" {result.meta['side']}" if "side" in result.meta else ""
    onto_vertices(context, owner, result.area, {name + side: getattr(result, name)})
    return name + side


def onto_vertices(
    context: bpy.types.Context,
    owner: bpy.types.Object,
    area: NDArray[np.floating],
    maps: Mapping[str, NDArray[np.floating]],
) -> None:
    """Write maps (rows, columns) as float attributes of the receiver's vertices, by their names.

    ``area`` (rows, columns) m² tells whether it is the surface still that the maps are of. Raises
    SceneError where it is not, is no mesh, or has vertices of its modifiers' making.
    """
    depsgraph = context.evaluated_depsgraph_get()
    surface = read_receiver(owner, depsgraph, scale_of(context.scene))
    changed = SceneError(f"“{owner.name}” has changed since; measure on it again.")
    if not isinstance(surface, Surface):
        raise changed
    surface = replace(surface, columns=area.shape[1], rows=area.shape[0])
    found = texels(surface)
    if not np.allclose(found.area, area, rtol=_SAME, atol=_SAME * area.max()):
        raise changed
    for name, values in maps.items():
        there = at_vertices(surface, values.astype(np.float64), found)
        if len(there) != len(owner.data.vertices):
            raise SceneError(
                f"The modifiers of “{owner.name}” make other vertices than its own; apply them "
                "first."
            )
        _attribute(owner.data, name).data.foreach_set("value", there.astype(np.float32))
    owner.data.update()


def _attribute(block: bpy.types.Mesh, name: str) -> bpy.types.Attribute:
    """The mesh's float attribute of that name on its vertices, in place of any other of it."""
    present = block.attributes.get(name)
    if present and (present.data_type, present.domain) != ("FLOAT", "POINT"):
        block.attributes.remove(present)
        present = None
    return present or block.attributes.new(name, "FLOAT", "POINT")
