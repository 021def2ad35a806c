"""Staging a result: its images, and the material that shows them on the receivers."""

import json
from collections.abc import Mapping

import bpy
import numpy as np

from ...engines.core.colour import Display
from ...engines.light import Irradiance, IrradianceMap
from ...engines.light.drawing import is_plane
from . import results, showing
from .results import CHANNELS, COLOUR, KINDS, PICTURE

_OWNER, _SIDES = "heliform_owner", "heliform_sides"
_UV = "UV map"


def stage_irradiance(
    scene: bpy.types.Scene,
    receivers: Mapping[str, bpy.types.Object],
    result: Irradiance,
    display: Display,
) -> list[bpy.types.Image]:
    """Put the maps of a result on their receivers and return the pictures, in the maps' order.

    ``receivers`` has the objects by the names that they had when the light was traced; maps of one
    that is not there are left out. Reruns replace in place.
    """
    before = scene.heliform.shown
    name = before.heliform_map if results.is_result(before) else ""
    pictures, sides = [], {}
    for one in result.maps:
        receiver = receivers.get(one.meta["receiver"])
        if receiver is not None:
            pictures.append(_stage_map(receiver, one))
            sides.setdefault(receiver, []).append(one)
    for receiver, maps in sides.items():
        kept = {(kind, _side(one)) for one in maps for kind in _kinds(one)}
        results.drop_others(receiver, kept)
    showing.share_map(pictures, name)
    showing.redisplay(scene, display, pictures)
    for receiver, maps in sides.items():
        _show(receiver, [_side(one) for one in maps])
    return pictures


def _stage_map(receiver: bpy.types.Object, result: IrradianceMap) -> bpy.types.Image:
    shape, side = result.illuminance.shape, _side(result)
    for kind in _kinds(result):
        if kind != PICTURE:
            values = [getattr(result, name) for name in CHANNELS[kind]]
            image = results.image_for(receiver, kind, side, shape)
            results.fill(image, np.stack(values, axis=-1))
    picture = results.image_for(receiver, PICTURE, side, shape)
    picture[results.META] = json.dumps(result.meta)
    picture[results.FIGURES] = json.dumps(result.figures())
    picture[results.MAPS] = json.dumps(showing.offered_by(result))
    picture[results.PLANE] = is_plane(result)
    for stale in (results.SECTION, results.LEGEND):
        picture.pop(stale, None)
    return picture


def _kinds(result: IrradianceMap) -> list[str]:
    """The images that a map has."""
    coloured = any(getattr(result, name).any() for name in CHANNELS[COLOUR])
    return [kind for kind in KINDS if kind != COLOUR or coloured]


def _side(result: IrradianceMap) -> str:
    return result.meta.get("side", "")


# The material


def _show(receiver: bpy.types.Object, sides: list[str]) -> None:
    """Have the receiver show its pictures.

    Its own materials stay with its mesh, and what a person made of ours stays too, as long as the
    receiver gathers on the same sides.
    """
    if not receiver.material_slots:
        receiver.data.materials.append(None)
    slots = receiver.material_slots
    ours = next((s.material for s in slots if s.material and _is_for(s.material, receiver)), None)
    if ours is None:
        ours = bpy.data.materials.new(f"{receiver.name} light")
        ours[_OWNER] = receiver
    if ours.get(_SIDES) != json.dumps(sides):
        ours[_SIDES] = json.dumps(sides)
        _make_nodes(ours.node_tree, sides)
    for slot in slots:
        if slot.material != ours:
            slot.link = "OBJECT"
            slot.material = ours
    nodes = ours.node_tree.nodes
    for side in sides:
        for kind in KINDS:
            if (node := nodes.get(_node(kind, side))) is not None:
                node.image = results.find(receiver, kind, side)
    layer = receiver.data.uv_layers.active
    if layer and _UV in nodes:
        nodes[_UV].uv_map = layer.name
    bring_forward(receiver, sides[0])


def bring_forward(receiver: bpy.types.Object, side: str) -> None:
    """Have Solid shading, which knows but one picture, take that of this side."""
    for slot in receiver.material_slots:
        if slot.material and _is_for(slot.material, receiver):
            nodes = slot.material.node_tree.nodes
            nodes.active = nodes.get(_node(PICTURE, side)) or nodes.active


def _is_for(material: bpy.types.Material, receiver: bpy.types.Object) -> bool:
    return material.get(_OWNER) == receiver


def _node(kind: str, side: str) -> str:
    return f"back {kind}" if side == "back" else kind


def _make_nodes(tree: bpy.types.NodeTree, sides: list[str]) -> None:
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
        for row, kind in enumerate((PICTURE, *CHANNELS)):
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
