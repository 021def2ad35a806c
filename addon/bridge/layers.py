"""Layers: values on an object in false colour, with a legend and marked places.

Values on vertices lie in a float attribute and their colours in a colour attribute of the base
mesh, which modifiers carry along; Solid shading shows them with Color › Attribute. Values in texels
lie in images, which it shows with Color › Texture. What the legend says lies with the mesh.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.colour import ColourScale
from ...engines.core.scene import Vector
from . import results, shading

VALUES, COLOURS = "Heliform values", "Heliform colours"
_LAYER, _VIEWS = "heliform_layer", "heliform_views"
_LINES = ("show_outline_selected", "show_relationship_lines")
_EDGES = {"show_object_outline": False, "show_cavity": True}
ON_VERTICES, IN_TEXELS = ["VERTEX", "STUDIO"], ["TEXTURE", "FLAT"]
"""The colours and the light of Solid shading that show a layer."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A place in the object's own coordinates that is pointed out, and what is said of it."""

    place: tuple[float, float, float]
    label: str


@dataclass(frozen=True, slots=True)
class Layer:
    """What a layer's legend says, and the places that are pointed out.

    Without a ``scale`` the ``swatches`` are the legend: names with the sRGB colours, 0..255, that
    stand for them; with one they are what lies outside it, such as what fails.
    """

    quantity: str
    scale: ColourScale | None
    footing: list[str] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)
    swatches: list[tuple[str, tuple[int, int, int]]] = field(default_factory=list)


def paint(obj: bpy.types.Object, values: Vector, layer: Layer) -> None:
    """Give the object a layer of ``values`` (V,), one a vertex of its own mesh; NaN is grey.

    A mesh that others share becomes the object's own.
    """
    assert layer.scale
    if obj.data.users > 1:
        obj.data = obj.data.copy()
    block = obj.data
    stored = _attribute(block, VALUES, "FLOAT")
    stored.data.foreach_set("value", values.astype(np.float32))
    colours = np.ones((len(values), 4), dtype=np.float32)
    colours[:, :3] = layer.scale.colours(values) / 255
    _attribute(block, COLOURS, "BYTE_COLOR").data.foreach_set("color_srgb", colours.ravel())
    block.color_attributes.active_color = block.color_attributes[COLOURS]
    note(obj, layer)
    block.update()


def paint_texels(
    obj: bpy.types.Object,
    quantity: str,
    kinds: Sequence[str],
    colours: NDArray[np.floating],
    layer: Layer,
) -> None:
    """Give the object a layer of ``colours`` (rows, columns, 3) in 0..1, where its UV map has it.

    ``kinds`` are the object's images of values, which the material shows beside the picture.
    """
    results.fill(results.image_for(obj, results.PICTURE, "", colours.shape[:2]), colours)
    shading.show_pictures(obj, quantity, kinds)
    note(obj, layer)


def note(obj: bpy.types.Object, layer: Layer) -> None:
    """Keep what the legend says."""
    obj.data[_LAYER] = json.dumps(asdict(layer))


def forget(obj: bpy.types.Object) -> None:
    """Say no more what the legend says: something else is shown on the object now."""
    if obj.type == "MESH":
        obj.data.pop(_LAYER, None)


def layer_of(obj: bpy.types.Object | None) -> Layer | None:
    """The object's layer, or None where it has none."""
    if obj is None or obj.type != "MESH" or _LAYER not in obj.data:
        return None
    kept = json.loads(obj.data[_LAYER])
    scale = kept.pop("scale")
    marks = [Mark(tuple(mark["place"]), mark["label"]) for mark in kept.pop("marks")]
    swatches = [(label, tuple(colour)) for label, colour in kept.pop("swatches", [])]
    return Layer(
        scale=ColourScale(**scale) if scale else None, marks=marks, swatches=swatches, **kept
    )


def clear(objects: Sequence[bpy.types.Object]) -> None:
    """Take the layers off the objects."""
    for obj in objects:
        if obj.type != "MESH" or _LAYER not in obj.data:
            continue
        del obj.data[_LAYER]
        shading.hide_pictures(obj)
        results.drop_others(obj, set())
        for name in (VALUES, COLOURS):
            if (stored := obj.data.attributes.get(name)) is not None:
                obj.data.attributes.remove(stored)


def show_in_views(context: bpy.types.Context, look: list[str] = ON_VERTICES) -> None:
    """Have the 3D views in Solid shading show layers; what they showed is kept with their screen.

    ``look`` says which layers. `restore_views` brings back what was shown before.
    """
    for screen in {window.screen for window in context.window_manager.windows}:
        kept = json.loads(screen.get(_VIEWS, "{}"))
        for index, view in _views(screen):
            if view.shading.type == "SOLID" and _look(view) != look:
                if _look(view) not in (ON_VERTICES, IN_TEXELS):
                    kept[index] = [*_look(view), *(getattr(view.overlay, n) for n in _LINES)]
                    kept[index] += [getattr(view.shading, name) for name in _EDGES]
                view.shading.color_type, view.shading.light = look
                if look == IN_TEXELS:  # what is slender would drown in lines and shade
                    for name in _LINES:
                        setattr(view.overlay, name, False)
                    for name, value in _EDGES.items():
                        setattr(view.shading, name, value)
        screen[_VIEWS] = json.dumps(kept)


def restore_views(context: bpy.types.Context) -> None:
    """Where the scene has no layer left, have views that show layers show what they did before."""
    if any(layer_of(obj) for obj in context.scene.objects):
        return
    for screen in bpy.data.screens:
        kept = json.loads(screen.pop(_VIEWS, "{}"))
        for index, view in _views(screen):
            if index in kept and _look(view) in (ON_VERTICES, IN_TEXELS):
                view.shading.color_type, view.shading.light = kept[index][:2]
                lines, edges = kept[index][2:4], kept[index][4:]
                for name, value in zip(_LINES, lines, strict=True):
                    setattr(view.overlay, name, value)
                for name, value in zip(_EDGES, edges, strict=True):
                    setattr(view.shading, name, value)


def _views(screen: bpy.types.Screen) -> list[tuple[str, bpy.types.SpaceView3D]]:
    """The 3D views of a screen, by the place of their area."""
    return [
        (str(index), area.spaces.active)
        for index, area in enumerate(screen.areas)
        if area.type == "VIEW_3D"
    ]


def _look(view: bpy.types.SpaceView3D) -> list[str]:
    return [view.shading.color_type, view.shading.light]


def _attribute(block: bpy.types.Mesh, name: str, kind: str) -> bpy.types.Attribute:
    found = block.attributes.get(name)
    if found is not None and (found.data_type != kind or found.domain != "POINT"):
        block.attributes.remove(found)
        found = None
    return found or block.attributes.new(name, kind, "POINT")
