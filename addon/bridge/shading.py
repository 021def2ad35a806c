"""The material that shows an object's false-colour pictures, the values at hand beside."""

import json
from collections.abc import Sequence

import bpy

from . import results
from .results import PICTURE

_OWNER, _MADE_FOR = "heliform_owner", "heliform_made_for"
_UV = "UV map"


def show_pictures(
    obj: bpy.types.Object, quantity: str, kinds: Sequence[str], sides: Sequence[str] = ("",)
) -> None:
    """Have the object show its pictures of a ``quantity``; ``kinds`` are the images of values.

    Its own materials stay with its mesh, and what a person made of ours stays too, as long as the
    images and their sides are the same.
    """
    if not obj.material_slots:
        obj.data.materials.append(None)
    slots = obj.material_slots
    ours = next((s.material for s in slots if s.material and _is_for(s.material, obj)), None)
    if ours is None:
        ours = bpy.data.materials.new(f"{obj.name} {quantity}")
        ours[_OWNER] = obj
    made_for = json.dumps([kinds, sides])
    if ours.get(_MADE_FOR) != made_for:
        ours[_MADE_FOR] = made_for
        _make_nodes(ours.node_tree, kinds, sides)
    for slot in slots:
        if slot.material != ours:
            slot.link = "OBJECT"
            slot.material = ours
    nodes = ours.node_tree.nodes
    for side in sides:
        for kind in (*kinds, PICTURE):
            if (node := nodes.get(_node(kind, side))) is not None:
                node.image = results.find(obj, kind, side)
    layer = obj.data.uv_layers.active
    if layer and _UV in nodes:
        nodes[_UV].uv_map = layer.name
    bring_forward(obj, sides[0])


def hide_pictures(obj: bpy.types.Object) -> None:
    """Give the object's slots back to the materials of its mesh."""
    for slot in obj.material_slots:
        if slot.material and _is_for(slot.material, obj):
            ours = slot.material
            slot.link = "DATA"
            if not ours.users:
                bpy.data.materials.remove(ours)


def bring_forward(obj: bpy.types.Object, side: str) -> None:
    """Have Solid shading, which knows but one picture, take that of this side."""
    for slot in obj.material_slots:
        if slot.material and _is_for(slot.material, obj):
            nodes = slot.material.node_tree.nodes
            nodes.active = nodes.get(_node(PICTURE, side)) or nodes.active


def _is_for(material: bpy.types.Material, obj: bpy.types.Object) -> bool:
    return material.get(_OWNER) == obj


def _node(kind: str, side: str) -> str:
    return f"back {kind}" if side == "back" else kind


def _make_nodes(tree: bpy.types.NodeTree, kinds: Sequence[str], sides: Sequence[str]) -> None:
    """What shines in the colours of the pictures, with the values at hand beside them."""
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.location.x = -220
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    uv = tree.nodes.new("ShaderNodeUVMap")
    uv.name = uv.label = _UV
    uv.location.x = -820 - 320 * (len(sides) - 1)
    for column, side in enumerate(sides):
        for row, kind in enumerate((PICTURE, *kinds)):
            node = tree.nodes.new("ShaderNodeTexImage")
            node.name = node.label = _node(kind, side)
            node.interpolation = "Closest"  # a texel is a mean over its area, not a point to blend
            node.location = (-540 - 320 * column, -300 * row)
            tree.links.new(uv.outputs["UV"], node.inputs["Vector"])
    pictures = [tree.nodes[_node(PICTURE, side)].outputs["Color"] for side in sides]
    if len(pictures) == 1:
        tree.links.new(pictures[0], emission.inputs["Color"])
        return
    facing = tree.nodes.new("ShaderNodeNewGeometry")
    facing.location = (-540, 300)
    mix = tree.nodes.new("ShaderNodeMix")
    mix.data_type = "RGBA"
    mix.location = (-220, 300)
    mixed = {s.name: s for s in mix.inputs if s.enabled}
    tree.links.new(facing.outputs["Backfacing"], mixed["Factor"])
    tree.links.new(pictures[0], mixed["A"])
    tree.links.new(pictures[1], mixed["B"])
    tree.links.new(next(s for s in mix.outputs if s.enabled), emission.inputs["Color"])


def show_in_views(context: bpy.types.Context) -> None:
    """Have the 3D views in Solid shading show pictures in the colours of their legend."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                shading = area.spaces.active.shading
                if shading.type == "SOLID":
                    shading.color_type, shading.light = "TEXTURE", "FLAT"
