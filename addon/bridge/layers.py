"""Layers: values on the vertices of an object, in false colour, with a legend and marked places.

The values lie in a float attribute and their colours in a colour attribute of the base mesh, which
modifiers carry along; what the legend says lies with the mesh. Solid shading shows the colours with
Color › Attribute.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field

import bpy
import numpy as np

from ...engines.core.colour import ColourScale
from ...engines.core.scene import Vector

VALUES, COLOURS = "Heliform values", "Heliform colours"
_LAYER, _VIEWS = "heliform_layer", "heliform_views"
_LOOK = ["VERTEX", "STUDIO"]
"""The colours and the light of Solid shading that show a layer."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A place in the object's own coordinates that is pointed out, and what is said of it."""

    place: tuple[float, float, float]
    label: str


@dataclass(frozen=True, slots=True)
class Layer:
    """What a layer's legend says, and the places that are pointed out."""

    quantity: str
    scale: ColourScale
    footing: list[str] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)


def paint(obj: bpy.types.Object, values: Vector, layer: Layer) -> None:
    """Give the object a layer of ``values`` (V,), one a vertex of its own mesh; NaN is grey.

    A mesh that others share becomes the object's own.
    """
    if obj.data.users > 1:
        obj.data = obj.data.copy()
    block = obj.data
    stored = _attribute(block, VALUES, "FLOAT")
    stored.data.foreach_set("value", values.astype(np.float32))
    colours = np.ones((len(values), 4), dtype=np.float32)
    colours[:, :3] = layer.scale.colours(values) / 255
    _attribute(block, COLOURS, "BYTE_COLOR").data.foreach_set("color_srgb", colours.ravel())
    block.color_attributes.active_color = block.color_attributes[COLOURS]
    block[_LAYER] = json.dumps(asdict(layer))
    block.update()


def layer_of(obj: bpy.types.Object | None) -> Layer | None:
    """The object's layer, or None where it has none."""
    if obj is None or obj.type != "MESH" or _LAYER not in obj.data:
        return None
    kept = json.loads(obj.data[_LAYER])
    scale = ColourScale(**kept.pop("scale"))
    marks = [Mark(tuple(mark["place"]), mark["label"]) for mark in kept.pop("marks")]
    return Layer(scale=scale, marks=marks, **kept)


def clear(objects: Sequence[bpy.types.Object]) -> None:
    """Take the layers off the objects."""
    for obj in objects:
        if obj.type != "MESH" or _LAYER not in obj.data:
            continue
        del obj.data[_LAYER]
        for name in (VALUES, COLOURS):
            if (stored := obj.data.attributes.get(name)) is not None:
                obj.data.attributes.remove(stored)


def show_in_views(context: bpy.types.Context) -> None:
    """Have the 3D views in Solid shading show layers; what they showed is kept with their screen.

    `restore_views` brings that back.
    """
    for screen in {window.screen for window in context.window_manager.windows}:
        kept = json.loads(screen.get(_VIEWS, "{}"))
        for index, shading in _shadings(screen):
            if shading.type == "SOLID" and _look(shading) != _LOOK:
                kept[index] = _look(shading)
                shading.color_type, shading.light = _LOOK
        screen[_VIEWS] = json.dumps(kept)


def restore_views(context: bpy.types.Context) -> None:
    """Where the scene has no layer left, have views that show layers show what they did before."""
    if any(layer_of(obj) for obj in context.scene.objects):
        return
    for screen in bpy.data.screens:
        kept = json.loads(screen.pop(_VIEWS, "{}"))
        for index, shading in _shadings(screen):
            if index in kept and _look(shading) == _LOOK:
                shading.color_type, shading.light = kept[index]


def _shadings(screen: bpy.types.Screen) -> list[tuple[str, bpy.types.View3DShading]]:
    """The shading of each 3D view of a screen, by the place of its area."""
    return [
        (str(index), area.spaces.active.shading)
        for index, area in enumerate(screen.areas)
        if area.type == "VIEW_3D"
    ]


def _look(shading: bpy.types.View3DShading) -> list[str]:
    return [shading.color_type, shading.light]


def _attribute(block: bpy.types.Mesh, name: str, kind: str) -> bpy.types.Attribute:
    found = block.attributes.get(name)
    if found is not None and (found.data_type != kind or found.domain != "POINT"):
        block.attributes.remove(found)
        found = None
    return found or block.attributes.new(name, kind, "POINT")
