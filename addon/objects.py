"""Heliform's objects in Blender: made, and rebuilt when their properties change."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import bpy
import numpy as np

from ..engines.core.errors import HeliformError, ParameterError
from ..engines.core.scene import Lamp, Luminaire, Material, Mesh, Plane
from ..engines.glass import GlassObject, glass_object
from ..engines.glass.loft import Wall
from ..engines.glass.printed import wall_skin
from ..engines.glass.profile import STYLES, Style
from ..engines.glass.relief import Relief, check_relief
from ..engines.light.luminaires import source
from ..engines.light.shape import lamp_outline, plane_mesh
from . import printing
from .bridge.materials import is_understood
from .bridge.meshes import digest_of, lines_to_blender, to_blender
from .bridge.print_layers import (
    is_print_layers,
    read_modifier,
    skin_to_blender,
    write_modifier,
)
from .bridge.read import lamp_record
from .bridge.walls import WALL, drawn_by, wall_of
from .properties import read, scale_of, write

GLASS = "glass.object"
PLANE = "plane"
"""What a form says of a mesh that Heliform makes."""

_MADE = "heliform_made"
"""What a mesh carries of the places that its settings gave it: hands may have moved them since."""

_FOOT = "heliform_foot"
"""Where the foot of a wall on curves was when it was built, in Blender units."""

_LAMP_HEIGHT = 0.22
_GAP = 1e-3
_GLASS_COLOUR = (0.72, 0.88, 0.95, 0.45)


def add_glass(context: bpy.types.Context, record: GlassObject, name: str) -> bpy.types.Object:
    """A printed vessel that stands at the 3D cursor. Raises ParameterError; adds nothing then."""
    scale = scale_of(context.scene)
    block = to_blender(_resized(glass_object(record), 1 / scale), name)
    block.materials.append(_glass_material())
    obj = added(context, name, block, "BODY", GLASS)
    write(obj.heliform.glass_object, record, scale)
    return obj


def add_wall(
    context: bpy.types.Context,
    record: Wall,
    name: str,
    curves: Sequence[bpy.types.Object] = (),
) -> bpy.types.Object:
    """A smooth printable wall that stands at the 3D cursor, or on the ``curves`` that it follows.

    Raises HeliformError where there can be none; adds nothing then.
    """
    scale = scale_of(context.scene)
    loops, foot = drawn_by(curves, scale)
    mesh, skin = wall_skin(record, loops)
    block = to_blender(_resized(mesh, 1 / scale), name)
    skin_to_blender(skin, block, scale)
    block.materials.append(_glass_material())
    obj = added(context, name, block, "BODY", WALL)
    if curves:
        obj.location = obj[_FOOT] = foot / scale
    for curve in curves:
        obj.heliform.curves.add().object = curve
    write(obj.heliform.wall, record, scale)
    return obj


def add_lamp(context: bpy.types.Context, record: Lamp, name: str) -> bpy.types.Object:
    """A lamp 22 cm above the 3D cursor, shining down."""
    obj = added(context, name, bpy.data.meshes.new(name), "LAMP", "")
    obj.location.z += _LAMP_HEIGHT / scale_of(context.scene)
    obj.hide_render = True
    obj.show_in_front = True
    write(obj.heliform.lamp, record, scale_of(context.scene))
    rebuild(obj, context.scene)
    return obj


def add_receiver(context: bpy.types.Context, record: Plane, name: str) -> bpy.types.Object:
    """A receiver 1 mm below the 3D cursor, so that glass standing there does not touch it."""
    obj = added(context, name, bpy.data.meshes.new(name), "RECEIVER", PLANE)
    obj.location.z -= _GAP / scale_of(context.scene)
    write(obj.heliform.plane, record, scale_of(context.scene))
    rebuild(obj, context.scene)
    return obj


def add_demo(context: bpy.types.Context, glass: GlassObject) -> None:
    """A glass object 1 mm above a receiver, and a lamp 22 cm over the receiver, which is active."""
    receiver = add_receiver(context, Plane(), "Receiver")
    lamp = add_lamp(context, Lamp(), "Lamp")
    lamp.location.z = receiver.location.z + _LAMP_HEIGHT / scale_of(context.scene)
    add_glass(context, glass, "Tube")
    select_only(context, receiver)  # short settings: the Light panel stays in view


def rebuild(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    """Make an object's mesh anew from its properties.

    Where they cannot be, the mesh stays as it was and ``obj.heliform.problem`` says why. The user's
    own meshes stay as they are.
    """
    own = obj.heliform
    made = {
        ("BODY", GLASS): _glass,
        ("BODY", WALL): _wall,
        ("RECEIVER", PLANE): _plane,
        ("LAMP", ""): _lamp,
    }
    build = made.get((own.role, own.form))
    if build is None:
        return
    try:
        if obj.mode != "OBJECT":
            raise ParameterError(f"“{obj.name}” is being edited; leave Edit Mode to change it.")
        if _MADE in obj.data and obj.data[_MADE] != digest_of(obj.data):
            raise ParameterError(
                f"“{obj.name}” was changed by hand, so its settings no longer shape it; undo that, "
                "or add a new one beside it."
            )
        if obj.data.users > 1:
            obj.data = obj.data.copy()
        try:
            build(obj, scene)
        finally:
            obj.data[_MADE] = digest_of(obj.data)
        problem = ""
    except HeliformError as error:
        problem = str(error)
    if own.problem != problem:
        own.problem = problem
    if own.form == WALL and not problem:
        printing.refresh(obj, scene)


def set_wall(obj: bpy.types.Object, record: Wall, scene: bpy.types.Scene) -> None:
    """Give a wall other properties, all at once, and rebuild it."""
    write(obj.heliform.wall, record, scale_of(scene))
    rebuild(obj, scene)


def set_glass(obj: bpy.types.Object, record: GlassObject, scene: bpy.types.Scene) -> None:
    """Give a glass object other properties, all at once, and rebuild it."""
    write(obj.heliform.glass_object, record, scale_of(scene))
    rebuild(obj, scene)


def may_be_body(obj: bpy.types.Object) -> bool:
    """Whether an object can be marked as a body: a mesh but a lamp's, a collection's instance."""
    if obj.type == "EMPTY":
        return obj.instance_collection is not None
    return obj.type == "MESH" and obj.heliform.role != "LAMP"


def mark(obj: bpy.types.Object, role: str, kind: str = "") -> str:
    """Say what an object is to light: a body, a lamp where it is a light, a receiver, nothing.

    A new body is of the ``kind`` of material given; else, unless somebody has chosen otherwise,
    what its Blender material says where that is understood, and matte where there is none that is.
    Returns a sentence where a material was passed over.
    """
    own = obj.heliform
    fresh = role == "BODY" != own.role and not own.form
    own.role = role
    own.problem = ""
    if role == "BODY" and kind:
        own.material_from, own.material.kind = "OWN", kind
    elif fresh and not own.is_property_set("material_from"):
        if is_understood(obj):
            own.material_from = "BLENDER"
        elif not own.material.is_property_set("kind"):
            own.material.kind = "diffuse"
            if any(slot.material for slot in obj.material_slots):
                return (
                    f"“{obj.name}” is taken as matte, since its Blender material cannot be read; "
                    "choose another kind in Heliform › Object."
                )
    return ""


def set_material(obj: bpy.types.Object, material: Material) -> None:
    """Have a body treat light as that material does, by its own settings; its priority stays."""
    own = obj.heliform
    own.material_from = "OWN"
    write(own.material, replace(material, priority=own.material.priority))


def lamp_hides(group: Any) -> set[str]:
    """The fields of a Lamp that say nothing for the source that a group or operator holds."""
    if group.source == "point":
        return {"file", "opening", "width", "length"}
    hidden = set() if group.source == "ies" else {"file"}
    if group.source == "ies" and group.opening == "file":
        return hidden | {"width", "length"}
    return hidden if group.opening == "rectangular" else hidden | {"length"}


def select_only(context: bpy.types.Context, obj: bpy.types.Object) -> None:
    """Select an object alone and make it active."""
    for other in context.selected_objects:
        other.select_set(False)
    obj.select_set(True)
    context.view_layer.objects.active = obj


def replace_mesh(obj: bpy.types.Object, mesh: Mesh) -> None:
    """Make ``mesh`` the object's own, in Blender units; modifiers and shape keys go."""
    obj.modifiers.clear()
    obj.shape_key_clear()
    if obj.data.users > 1:
        obj.data = obj.data.copy()
    obj.heliform.form = ""
    obj.data.pop(_MADE, None)
    to_blender(mesh, obj.data)


def _glass(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    scale = scale_of(scene)
    mesh = glass_object(read(obj.heliform.glass_object, GlassObject, scale))
    to_blender(_resized(mesh, 1 / scale), obj.data)


def _wall(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    scale = scale_of(scene)
    record, drawn = wall_of(obj, scene)
    reliefs = [
        _fitted(modifier, record, scale) for modifier in filter(is_print_layers, obj.modifiers)
    ]
    mesh, skin = wall_skin(record, drawn.loops)
    to_blender(_resized(mesh, 1 / scale), obj.data)
    skin_to_blender(skin, obj.data, scale)
    for modifier, relief, style in reliefs:
        write_modifier(modifier, relief, style, scale)
    if _FOOT in obj:  # the wall goes where the curves went, wherever it was put since
        foot = drawn.foot / scale
        obj.location = np.array(obj.location) + foot - np.array(obj[_FOOT])
        obj[_FOOT] = foot


def _fitted(
    modifier: bpy.types.Modifier, record: Wall, scale: float
) -> tuple[bpy.types.Modifier, Relief, Style]:
    """A modifier with the relief for the wall's layers. Raises ParameterError where none fits."""
    relief, style = read_modifier(modifier, scale)
    relief = replace(relief, height=record.bead.height)
    check_relief(relief, record.thickness)
    if relief.style in STYLES:
        style = STYLES[relief.style](relief.height, relief.amplitude)
    return modifier, relief, style


def _plane(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    scale = scale_of(scene)
    mesh, texture = plane_mesh(read(obj.heliform.plane, Plane, scale))
    to_blender(_resized(mesh, 1 / scale), obj.data)
    layer = obj.data.uv_layers.active or obj.data.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", texture.ravel())


def _lamp(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    scale = scale_of(scene)
    luminaire = Luminaire(obj.name, lamp_record(obj, scale))
    points, edges = lamp_outline(luminaire)
    lines_to_blender(points / scale, edges, obj.data)
    source(luminaire)  # says what else keeps it from shining


def _resized(mesh: Mesh, factor: float) -> Mesh:
    return mesh if factor == 1 else Mesh(mesh.vertices * factor, mesh.faces, mesh.normals)


def added(
    context: bpy.types.Context, name: str, block: bpy.types.Mesh, role: str, form: str
) -> bpy.types.Object:
    """A new object at the 3D cursor, selected and active."""
    obj = bpy.data.objects.new(name, block)
    if form:
        block[_MADE] = digest_of(block)
    obj.location = context.scene.cursor.location
    obj.heliform.role = role
    obj.heliform.form = form
    context.collection.objects.link(obj)
    select_only(context, obj)
    return obj


def _glass_material() -> bpy.types.Material:
    """A clear material for the viewport; light is traced with the object's own settings."""
    name = "Heliform Glass"
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    material = bpy.data.materials.new(name)
    material.diffuse_color = _GLASS_COLOUR
    material.metallic, material.roughness = 0.0, 0.1
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Transmission Weight"].default_value = 1.0
    shader.inputs["Roughness"].default_value = 0.0
    shader.inputs["IOR"].default_value = 1.5
    return material
