"""What Blender's objects and scenes carry for Heliform."""

from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, PointerProperty, StringProperty

from ..engines.core.colour import Display
from ..engines.core.scene import Lamp, Material, Plane
from ..engines.glass import GlassObject
from ..engines.light import PhotonTracing
from .bridge.lights import BlenderLight
from .objects import rebuild
from .properties import group_for, groups

ROLES = (
    ("NONE", "None", "Heliform does not see it", 0),
    ("BODY", "Body", "Light meets it: glass, mirror or a matte surface", 1),
    ("LAMP", "Lamp", "Light leaves it", 2),
    ("RECEIVER", "Receiver", "Light is gathered on it", 3),
)

SOURCES = (
    ("OWN", "Heliform", "The settings below", 0),
    ("BLENDER", "Blender", "The Blender material of the first slot, as it is when traced", 1),
)


def _rebuild(group: Any, context: bpy.types.Context) -> None:
    rebuild(group.id_data, context.scene)


# Made here: from Python 3.14 on, annotations are evaluated only when the class is registered.
_SHAPE, _LAMP, _PLANE = (group_for(record, _rebuild) for record in (GlassObject, Lamp, Plane))
_MATERIAL, _TRACING, _DISPLAY = map(group_for, (Material, PhotonTracing, Display))
_LIGHT = group_for(BlenderLight)


class HELIFORM_PG_object(bpy.types.PropertyGroup):
    """What an object is to Heliform."""

    role: EnumProperty(name="Role", description="What the object is to light", items=ROLES)
    on: BoolProperty(name="On", description="Whether Heliform sees the object", default=True)
    form: StringProperty(
        name="Form", description="What made the mesh; empty for your own", options={"HIDDEN"}
    )
    problem: StringProperty(name="Problem", options={"HIDDEN"})
    glass_object: PointerProperty(type=_SHAPE)
    material_from: EnumProperty(
        name="Material From", description="What says how a body treats light", items=SOURCES
    )
    material: PointerProperty(type=_MATERIAL)
    blender_light: PointerProperty(type=_LIGHT)
    lamp: PointerProperty(type=_LAMP)
    plane: PointerProperty(type=_PLANE)


class HELIFORM_PG_scene(bpy.types.PropertyGroup):
    """Heliform's settings of a scene."""

    photon_tracing: PointerProperty(type=_TRACING)
    display: PointerProperty(type=_DISPLAY)
    seed: IntProperty(
        name="Seed", description="The same seed gives the same photons", default=0, min=0
    )
    legend: BoolProperty(
        name="Legend", description="Draw the colour legend in the view", default=True
    )
    shown: PointerProperty(
        type=bpy.types.Image, name="Shown", description="The result whose legend is drawn"
    )


OWNERS = ((bpy.types.Object, HELIFORM_PG_object), (bpy.types.Scene, HELIFORM_PG_scene))


def register() -> None:
    """Add ``heliform`` to objects and scenes."""
    for group in (*groups, *(group for _, group in OWNERS)):
        bpy.utils.register_class(group)
    for owner, group in OWNERS:
        owner.heliform = PointerProperty(type=group, name="Heliform")


def unregister() -> None:
    """Take ``heliform`` from objects and scenes again."""
    for owner, _ in reversed(OWNERS):
        del owner.heliform
    for group in reversed((*groups, *(group for _, group in OWNERS))):
        bpy.utils.unregister_class(group)
