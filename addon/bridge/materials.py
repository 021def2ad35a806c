"""Blender's materials as the engines' own, where a node tree says plainly what is meant.

Facts: Blender's roughness squared is the width α of GGX, and Volume Absorption takes
density × (1 − colour) in each Blender unit [Cycles: kernel/svm/closure.h].
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy
import mathutils

from ...engines.core.errors import SceneError
from ...engines.core.parameters import bounds_text, canonical, fields_of
from ...engines.core.scene import Material

REMEDY = "set the material in Heliform › Object"

_REC709 = (0.2126, 0.7152, 0.0722)
_GLOSSY = 0.3
"""Roughness from which on a gloss over a matte colour is left out."""
_EXTRAS = (
    "Anisotropic",
    "Anisotropy",
    "Coat Weight",
    "Diffuse Roughness",
    "Sheen Weight",
    "Subsurface Weight",
    "Thin Film Thickness",
)
"""Inputs that the engines' materials have nothing for."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A Blender material as it was understood.

    ``source`` names its shader; each of ``notes`` says what was left out or taken otherwise.
    """

    material: Material
    source: str
    notes: tuple[str, ...] = ()


class Unclear(Exception):
    """The rest of a sentence about something that is not understood, and what can be done."""

    def __init__(self, said: str, remedy: str = "") -> None:
        super().__init__(said)
        self.remedy = remedy


def read_material(obj: bpy.types.Object, scale: float = 1.0) -> Reading:
    """The material that light meets on an object, from the first slot's node tree.

    ``scale`` is the metres in a Blender unit. Raises SceneError, naming the object and the remedy,
    where the tree mixes shaders, has textures on its inputs, or is no body's.
    """
    slots = obj.material_slots
    block = slots[0].material if slots else None
    if block is None:
        raise SceneError(f"“{obj.name}” has no Blender material; give it one, or {REMEDY}.")
    try:
        reading = _understood(block.node_tree, scale)
    except Unclear as said:
        whole = f"The Blender material “{block.name}” of “{obj.name}” {said}; {REMEDY}."
        raise SceneError(whole) from None
    others = sum(slot.material not in (None, block) for slot in slots)
    notes = (*reading.notes, "Only the first material is used.") if others else reading.notes
    return Reading(reading.material, f"{block.name} ({reading.source})", notes)


def is_understood(obj: bpy.types.Object) -> bool:
    """Whether an object has a Blender material that `read_material` can read."""
    try:
        read_material(obj)
    except SceneError:
        return False
    return True


# Node trees


def output_of(tree: bpy.types.NodeTree | None) -> bpy.types.Node:
    """The active output, as Cycles takes it. Raises Unclear where there is none."""
    output = tree.get_output_node("CYCLES") if tree else None
    if output is None:
        raise Unclear("has no output node")
    return output


def source_of(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """The output that feeds a socket, through reroutes; None where none does."""
    link = next((k for k in socket.links if k.is_valid and not k.is_muted), None)
    if link is None:
        return None
    if link.from_node.type == "REROUTE":
        return source_of(link.from_node.inputs[0])
    if link.from_node.mute:
        raise Unclear(f"has a muted node ({link.from_node.bl_label})")
    return link.from_socket


def values_of(node: bpy.types.Node) -> dict[str, Any]:
    """The inputs that a node has in use, by name. Raises Unclear for one that varies."""
    return {socket.name: _value(socket) for socket in node.inputs if socket.enabled}


def _value(socket: bpy.types.NodeSocket) -> Any:
    source = source_of(socket)
    if source is None:
        return getattr(socket, "default_value", None)
    if source.node.type not in ("VALUE", "RGB"):
        raise Unclear(f"takes its {socket.name} from another node ({source.node.bl_label})")
    return source.default_value


def luminance(colour: Any) -> float:
    """Rec.709 luminance of a scene-linear colour; 1 for white."""
    linear = mathutils.Color(colour[:3]).from_scene_linear_to_rec709_linear()
    return sum(weight * part for weight, part in zip(_REC709, linear, strict=True))


def _understood(tree: bpy.types.NodeTree | None, scale: float) -> Reading:
    output = output_of(tree)
    source = source_of(output.inputs["Surface"])
    if source is None:
        raise Unclear("has no surface shader")
    shader = source.node
    if shader.type in _NO_BODY:
        raise Unclear(_NO_BODY[shader.type])
    if shader.type not in _SHADERS:
        raise Unclear(f"has a shader that is not read ({shader.bl_label})")
    values = values_of(shader)
    given, notes = _SHADERS[shader.type](shader, values)
    left = [name.removesuffix(" Weight").lower() for name in _EXTRAS if values.get(name)]
    volume = source_of(output.inputs["Volume"])
    if volume and given["kind"] == "dielectric":
        given["absorption"] = _absorption(volume.node) / scale
    elif volume:
        left.append("volume")
    if source_of(output.inputs["Displacement"]):
        left.append("displacement")
    if left:
        notes.append(f"Left out: {', '.join(left)}.")
    return Reading(_checked(given), shader.bl_label, tuple(notes))


def _absorption(node: bpy.types.Node) -> float:
    """Per Blender unit."""
    if node.type != "VOLUME_ABSORPTION":
        raise Unclear(f"has a volume that is not read ({node.bl_label})")
    values = values_of(node)
    return values["Density"] * (1 - min(luminance(values["Color"]), 1.0))


def _checked(given: dict[str, Any]) -> Material:
    for field in fields_of(Material):
        if field.kind == "float" and field.name in given:
            value = given[field.name] = canonical(given[field.name])
            if value < (field.low or 0.0) or value > (field.high or math.inf):
                name = "index of refraction" if field.name == "ior" else field.name
                unit = f" {field.unit}" if field.unit else ""
                allowed = bounds_text(field)
                raise Unclear(f"has a {name} of {value:g}{unit}, but allowed is {allowed}")
    return Material(**given)


# Shaders: each gives the fields of a Material that it sets, and notes

_Said = tuple[dict[str, Any], list[str]]


def _glass(node: bpy.types.Node, values: dict[str, Any]) -> _Said:
    given = {"kind": "dielectric", "ior": values["IOR"], "roughness": values["Roughness"] ** 2}
    notes = _tinted(values["Color"]) + _ground(node, values)
    if node.type == "BSDF_REFRACTION":
        notes.append("It reflects too, by Fresnel.")
    return given, notes


def _mirror(node: bpy.types.Node, values: dict[str, Any]) -> _Said:
    return _mirroring(node, values, luminance(values["Color"]))


def _metal(node: bpy.types.Node, values: dict[str, Any]) -> _Said:
    if node.fresnel_type == "F82":
        return _mirroring(node, values, luminance(values["Base Color"]))
    waves = zip(values["IOR"], values["Extinction"], strict=True)
    return _mirroring(node, values, luminance([_normal_reflectance(n, k) for n, k in waves]))


def _mirroring(node: bpy.types.Node, values: dict[str, Any], reflectance: float) -> _Said:
    given = {
        "kind": "mirror",
        "reflectance": min(reflectance, 1.0),
        "roughness": values["Roughness"] ** 2,
    }
    return given, _ground(node, values)


def _matte(_: bpy.types.Node, values: dict[str, Any]) -> _Said:
    rough = ["Its roughness is left out."] if values["Roughness"] else []
    return _diffuse(values["Color"]), rough


def _principled(node: bpy.types.Node, values: dict[str, Any]) -> _Said:
    if values["Alpha"] < 1:
        raise Unclear(f"is partly transparent (Alpha {values['Alpha']:.2g})")
    if values["Emission Strength"] and luminance(values["Emission Color"]):
        raise Unclear(f"shines (Emission Strength {values['Emission Strength']:.2g})")
    metallic, transmission = values["Metallic"], values["Transmission Weight"]
    if metallic >= 0.5:
        given, notes = _mirroring(node, values, luminance(values["Base Color"]))
        return given, notes + _rounded("Metallic", metallic)
    if transmission >= 0.5:
        if values["Thin Wall"]:
            raise Unclear("is a Thin Wall, which has no inside")
        given, notes = _glass(node, values | {"Color": values["Base Color"]})
        notes += _rounded("Metallic", metallic) + _rounded("Transmission", transmission)
        return given, notes
    given, notes = _coloured(values)
    return given, notes + _rounded("Metallic", metallic) + _rounded("Transmission", transmission)


def _coloured(values: dict[str, Any]) -> _Said:
    """A colour, under a gloss where that is sharp enough to be seen as one."""
    gloss = _normal_reflectance(values["IOR"]) * 2 * values["Specular IOR Level"]
    gloss = min(gloss * luminance(values["Specular Tint"]), 1.0)
    given, rough = _diffuse(values["Base Color"]), values["Roughness"]
    if gloss <= 0:
        return given, []
    if rough >= _GLOSSY:
        return given, [f"Its dull gloss (Roughness {rough:.2g}) is left out."]
    smoothed = [f"Its gloss (Roughness {rough:.2g}) is taken as smooth."] if rough else []
    return given | {"kind": "plastic", "specularity": gloss}, smoothed


def _diffuse(colour: Any) -> dict[str, Any]:
    return {"kind": "diffuse", "reflectance": min(luminance(colour), 1.0)}


def _normal_reflectance(n: float, k: float = 0.0) -> float:
    return ((n - 1) ** 2 + k * k) / ((n + 1) ** 2 + k * k)


def _tinted(colour: Any) -> list[str]:
    white = all(part > 0.999 for part in colour[:3])
    return [] if white else ["Its surface's colour is left out; only Volume Absorption tints it."]


def _ground(node: bpy.types.Node, values: dict[str, Any]) -> list[str]:
    other = node.distribution not in ("GGX", "MULTI_GGX") and values["Roughness"]
    return ["Its roughness is taken as GGX."] if other else []


def _rounded(name: str, share: float) -> list[str]:
    return [] if share in (0, 1) else [f"{name} of {share:.2g} is taken as {int(share >= 0.5)}."]


_SHADERS: dict[str, Callable[[bpy.types.Node, dict[str, Any]], _Said]] = {
    "BSDF_GLASS": _glass,
    "BSDF_REFRACTION": _glass,
    "BSDF_PRINCIPLED": _principled,
    "BSDF_DIFFUSE": _matte,
    "BSDF_GLOSSY": _mirror,
    "BSDF_METALLIC": _metal,
}
_NO_BODY = {
    "BSDF_TRANSPARENT": "lets light straight through (Transparent BSDF), and that is no body",
    "EMISSION": "only shines (Emission), and that is no body but a lamp",
    "MIX_SHADER": "mixes shaders (Mix Shader)",
    "ADD_SHADER": "mixes shaders (Add Shader)",
}
