"""Handles: empties in the view that stand for numbers of an object, to be dragged and animated.

A handle is a child of its object and carries the name of what it moves. Where it may be is the
object's business: `place` puts handles where numbers say, `places_of` reads where hands put them.
"""

from collections.abc import Mapping
from typing import Any

import bpy
import numpy as np

from ...engines.core.scene import Vector

_NAME = "heliform_handle"
_MOVED = 1e-6
"""Blender units that count as moved: locations are kept in float32."""


def name_of(obj: bpy.types.Object) -> str:
    """What a handle moves, such as “net.p12”; an empty text for what is no handle."""
    return obj.get(_NAME, "") if obj.type == "EMPTY" else ""


def handles_of(obj: bpy.types.Object) -> dict[str, bpy.types.Object]:
    """The object's handles by their names."""
    return {name: child for child in obj.children if (name := name_of(child))}


def owner_of(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """The object whose handle this is; what is no handle is its own."""
    return obj.parent if obj is not None and name_of(obj) and obj.parent is not None else obj


def add_handles(obj: bpy.types.Object, labels: Mapping[str, str], shape: str, size: float) -> None:
    """Give the object a handle for each name that has none yet, called by its label.

    ``shape`` is one of Blender's displays of an empty, ``size`` in Blender units.
    """
    there = handles_of(obj)
    for name, label in labels.items():
        if name in there:
            continue
        handle = bpy.data.objects.new(f"{obj.name} {label}", None)
        handle[_NAME] = name
        handle.empty_display_type, handle.empty_display_size = shape, size
        handle.show_in_front = True
        handle.lock_rotation = handle.lock_scale = (True, True, True)
        handle.parent = obj
        for collection in obj.users_collection:
            collection.objects.link(handle)


def remove_handles(obj: bpy.types.Object, start: str) -> None:
    """Remove the handles whose names start so."""
    for name, handle in handles_of(obj).items():
        if name.startswith(start):
            bpy.data.objects.remove(handle)


def place(obj: bpy.types.Object, places: Mapping[str, Any]) -> None:
    """Put handles where they belong, (3,) in the object's own axes and Blender units."""
    there = handles_of(obj)
    for name, where in places.items():
        handle = there.get(name)
        if handle is not None and np.abs(np.array(handle.location) - where).max() > _MOVED:
            handle.location = where


def places_of(obj: bpy.types.Object) -> dict[str, Vector]:
    """Where the handles are, in the object's own axes and Blender units."""
    return {name: np.array(h.location, dtype=float) for name, h in handles_of(obj).items()}
