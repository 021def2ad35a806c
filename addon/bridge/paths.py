"""Toolpaths as Blender's curves, with what the printer does at each point."""

import json

import bpy
import numpy as np

from ...engines.core.scene import Vector
from ...engines.glass.toolpath import Toolpath

CHANNELS = ("turn", "arc", "rotary", "width", "height", "speed", "flow", "time")
"""What each point of a path carries as an attribute, in SI units."""

_OWNER = "heliform_path_of"
_FACTS = "heliform_path"


def path_to_blender(
    owner: bpy.types.Object, path: Toolpath, scale: float, facts: dict[str, float]
) -> bpy.types.Object:
    """The curve object of the wall's path, made or brought up to date; it follows the wall.

    ``facts`` are kept with it for the panel. The paths of walls that were deleted go.
    """
    drop_orphans()
    obj = path_of(owner)
    block = bpy.data.hair_curves.new(f"{owner.name} path")
    block.add_curves([len(path.points)])
    block.position_data.foreach_set("vector", _flat(path.points / scale))
    for name in CHANNELS:
        stored = block.attributes.new(name, "FLOAT", "POINT")
        stored.data.foreach_set("value", _flat(getattr(path, name)))
    if obj is None:
        obj = bpy.data.objects.new(block.name, block)
        obj[_OWNER] = owner
        obj.parent = owner
        obj.hide_render = True
        obj.show_in_front = True  # it lies inside the wall
        for collection in owner.users_collection:
            collection.objects.link(obj)
    else:
        before, obj.data = obj.data, block
        bpy.data.hair_curves.remove(before)
    obj[_FACTS] = json.dumps(facts)
    return obj


def path_of(owner: bpy.types.Object) -> bpy.types.Object | None:
    """The curve object that shows the wall's path, or None."""
    return next((o for o in owner.children if _is_path(o) and o[_OWNER] == owner), None)


def drop_orphans() -> None:
    """Remove the path curves whose wall was deleted: it is gone, or in no collection any more."""
    for obj in [obj for obj in bpy.data.objects if _is_path(obj)]:
        owner = obj[_OWNER]
        if owner is None or not owner.users_collection:
            bpy.data.hair_curves.remove(obj.data)


def _is_path(obj: bpy.types.Object) -> bool:
    """Whether an object is a path curve still: a person may have converted it."""
    return obj.type == "CURVES" and _OWNER in obj


def facts_of(path: bpy.types.Object) -> dict[str, float]:
    """What was kept with a path for the panel."""
    return json.loads(path[_FACTS])


def _flat(values: Vector) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=np.float32).ravel()
