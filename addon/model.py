"""What Blender's objects and scenes carry for Heliform."""

from typing import Any, get_args

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..engines.core.colour import Display
from ..engines.core.scene import Lamp, Material, Plane
from ..engines.glass import GlassObject
from ..engines.glass.loft import Wall
from ..engines.glass.toolpath import Spiral
from ..engines.light import PhotonTracing
from ..engines.scan import Comparison, ScanReading
from ..engines.structure.joints import Joint
from ..engines.structure.structure import Structure
from ..engines.sun import QUANTITIES, Daylight, Radiation
from . import live_sun, printing, structures, sun_place
from .bridge import layers, members, scan, sun, sun_inside
from .bridge.lights import BlenderLight
from .bridge.walls import WALL
from .objects import rebuild
from .properties import enum_items, group_for, group_name, groups, scale_of, settle

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


def _show_print(group: Any, context: bpy.types.Context) -> None:
    printing.refresh(group.id_data, context.scene)
    if group.gate:
        layers.show_in_views(context)
    else:
        layers.restore_views(context)


def _reprint(group: Any, context: bpy.types.Context) -> None:
    """Another machine or another spiral: every wall that shows its print shows it anew."""
    scene = group.id_data
    for obj in scene.objects:
        if obj.heliform.form == WALL and (obj.heliform.gate or obj.heliform.path):
            printing.refresh(obj, scene)


def _restructure(group: Any, context: bpy.types.Context) -> None:
    structures.change(group.id_data, context.scene)


def _show_handles(group: Any, context: bpy.types.Context) -> None:
    structures.show_handles(group.id_data, context.scene)


def _repaint(group: Any, context: bpy.types.Context) -> None:
    structures.repaint(group.id_data, context.scene)


def _resun(group: Any, context: bpy.types.Context) -> None:
    """Another place, weather or time: what follows it does."""
    sun_place.take_site(group.id_data)
    sun_place.place_lamp(context)
    live_sun.changed(group.id_data)
    sun.recheck(group.id_data)


def _redaylight(group: Any, context: bpy.types.Context) -> None:
    sun.recheck(group.id_data)


def _see_inside(group: Any, context: bpy.types.Context) -> None:
    sun_inside.follow(group.id_data)


def _move_sun(group: Any, context: bpy.types.Context) -> None:
    sun_place.place_lamp(context)


def _switch_sun(group: Any, context: bpy.types.Context) -> None:
    live_sun.switched(group.id_data)


def _repaint_sun(group: Any, context: bpy.types.Context) -> None:
    sun.repaint(group.id_data)


def _sun_maps(group: Any, context: bpy.types.Context | None) -> list[tuple[str, str, str, int]]:
    offered = sun.offered_maps(group.id_data) or QUANTITIES
    return [item for item in _SUN_MAPS if item[0] in offered]


_SUN_MAPS = [
    (name, QUANTITIES[name][0], QUANTITIES[name][2].rstrip("."), number)
    for name, _, _, number in enum_items(QUANTITIES)
]  # kept: Blender holds on to their texts


def _is_read(scene: Any, obj: bpy.types.Object) -> bool:
    return scan.facts_of(obj) is not None


def _is_light(scene: Any, obj: bpy.types.Object) -> bool:
    return obj.type == "LIGHT" and obj.data.type == "SUN"


def _is_mesh(group: Any, obj: bpy.types.Object) -> bool:
    return obj.type == "MESH" and obj != group.id_data


# Made here: from Python 3.14 on, annotations are evaluated only when the class is registered.
_SHAPE, _WALL, _LAMP, _PLANE = (
    group_for(record, _rebuild) for record in (GlassObject, Wall, Lamp, Plane)
)
_MATERIAL, _TRACING, _DISPLAY, _READING, _COMPARISON = map(
    group_for, (Material, PhotonTracing, Display, ScanReading, Comparison)
)
_LIGHT = group_for(BlenderLight)
_STRUCTURE = group_for(Structure, _restructure)
_RADIATION, _SUN_DISPLAY = group_for(Radiation, _resun), group_for(Display, _repaint_sun)
_DAYLIGHT = group_for(Daylight, _redaylight)
_SPIRAL = group_for(Spiral, _reprint)


class HELIFORM_PG_curve(bpy.types.PropertyGroup):
    """A curve that a wall follows."""

    object: PointerProperty(type=bpy.types.Object)


class HELIFORM_PG_object(bpy.types.PropertyGroup):
    """What an object is to Heliform."""

    role: EnumProperty(name="Role", description="What the object is to light", items=ROLES)
    on: BoolProperty(name="On", description="Whether Heliform sees the object", default=True)
    form: StringProperty(
        name="Form", description="What made the mesh; empty for your own", options={"HIDDEN"}
    )
    problem: StringProperty(name="Problem", options={"HIDDEN"})
    glass_object: PointerProperty(type=_SHAPE)
    wall: PointerProperty(type=_WALL)
    curves: CollectionProperty(type=HELIFORM_PG_curve)
    gate: BoolProperty(
        name="Print Gate",
        description="Colour the wall by what a printer can make of it, the worst place marked",
        update=_show_print,
    )
    gate_check: StringProperty(
        name="Shown Check", description="Empty shows the worst of all", update=_show_print
    )
    structure: PointerProperty(type=_STRUCTURE)
    source: PointerProperty(
        type=bpy.types.Object,
        name="Edges Of",
        description="The mesh whose edges are the members",
        poll=_is_mesh,
        update=_restructure,
    )
    live: BoolProperty(
        name="Live",
        description="Analyse and size the structure whenever it changes",
        default=True,
        update=_restructure,
    )
    joint: EnumProperty(
        name="Joints",
        description="How members are drawn where they meet",
        items=enum_items(get_args(Joint)),
        update=_restructure,
    )
    member_map: EnumProperty(
        name="Show",
        description="What the members are coloured by",
        items=[(key, *words[:2], n) for n, (key, words) in enumerate(members.MAPS.items())],
        update=_repaint,
    )
    member: IntProperty(
        name="Member",
        description="The member whose checks are listed",
        default=-1,
        min=-1,
        update=_repaint,
    )
    controls: BoolProperty(
        name="Control Points",
        description="Handles that move the surface: drag them, or give them keyframes",
        update=_show_handles,
    )
    levels: BoolProperty(
        name="Material Handles",
        description="Nine handles: off the surface on its outer side is steel, on the inner timber",
        update=_show_handles,
    )
    turns: BoolProperty(
        name="Turn Handles",
        description="Nine handles: the farther off the surface, the more members are turned",
        update=_show_handles,
    )
    path: BoolProperty(
        name="Print Path", description="Show the way of the nozzle as a curve", update=_show_print
    )
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
    scan_reading: PointerProperty(type=_READING)
    comparison: PointerProperty(type=_COMPARISON)
    relief: PointerProperty(
        type=bpy.types.Object,
        name="Relief",
        description="The relief that a scan was read as",
        poll=_is_read,
    )
    spiral: PointerProperty(type=_SPIRAL)
    machine: EnumProperty(
        name="Machine",
        description="What prints the walls",
        items=printing.MACHINES,
        update=_reprint,
    )
    machine_file: StringProperty(
        name="Profile",
        description="Machine profile of your own, a TOML file",
        subtype="FILE_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
        update=_reprint,
    )
    display: PointerProperty(type=_DISPLAY)
    radiation: PointerProperty(type=_RADIATION)
    daylight: PointerProperty(type=_DAYLIGHT)
    live_sun: BoolProperty(
        name="Live Sun",
        description="Colour the receivers anew whenever anything moves, on few texels",
        update=_switch_sun,
    )
    live_texels: IntProperty(
        name="Live Texels",
        description="Texels along a receiver's longer side while Live Sun is on; means over a body "
        "with many sides come within about 1 % of the study's from 32 on",
        default=32,
        min=1,
        soft_max=128,
        max=4096,
        update=_switch_sun,
    )
    sun_map: EnumProperty(
        name="Map",
        description="What of sun and sky is shown, on all receivers",
        items=_sun_maps,
        default=next(number for name, _, _, number in _SUN_MAPS if name == "total"),
        update=_repaint_sun,
    )
    sun_display: PointerProperty(type=_SUN_DISPLAY)
    see_inside: BoolProperty(
        name="See Inside",
        description="Draw bodies as their edges, to see maps within closed ones",
        update=_see_inside,
    )
    sun_path: BoolProperty(
        name="Sun Path", description="Draw the sun's path over the year around the scene"
    )
    sun_month: IntProperty(
        name="Month", description="Month of the sun", default=6, min=1, max=12, update=_move_sun
    )
    sun_day: IntProperty(
        name="Day", description="Day of the month", default=21, min=1, max=31, update=_move_sun
    )
    sun_hour: FloatProperty(
        name="Hour",
        description="Hour of the day in standard time",
        default=12.0,
        min=0.0,
        max=24.0,
        step=25,
        precision=2,
        update=_move_sun,
    )
    sun_lamp: PointerProperty(
        type=bpy.types.Object,
        name="Lamp",
        description="The lamp that shines as the sun does at this date and hour",
        poll=_is_light,
    )
    seed: IntProperty(
        name="Seed", description="The same seed gives the same photons", default=0, min=0
    )
    legend: BoolProperty(
        name="Legend", description="Draw the colour legend in the view", default=True
    )
    shown: PointerProperty(
        type=bpy.types.Image, name="Shown", description="The result whose legend is drawn"
    )


SETTINGS = (PhotonTracing, Display, ScanReading, Comparison, Spiral, Radiation, Daylight)
"""The records that a scene holds."""

OWNERS = ((bpy.types.Object, HELIFORM_PG_object), (bpy.types.Scene, HELIFORM_PG_scene))


@bpy.app.handlers.persistent
def settle_scenes(*_: object) -> None:
    """Have panels show the lengths of settings that nobody has touched in the scene's units."""
    for scene in bpy.data.scenes:
        if scale_of(scene) != 1:
            for record in SETTINGS:
                settle(getattr(scene.heliform, group_name(record)), record, scale_of(scene))


def register() -> None:
    """Add ``heliform`` to objects and scenes."""
    for group in _all():
        bpy.utils.register_class(group)
    for owner, group in OWNERS:
        owner.heliform = PointerProperty(type=group, name="Heliform")
    bpy.app.handlers.load_post.append(settle_scenes)


def unregister() -> None:
    """Take ``heliform`` from objects and scenes again."""
    bpy.app.handlers.load_post.remove(settle_scenes)
    for owner, _ in reversed(OWNERS):
        del owner.heliform
    for group in reversed(_all()):
        bpy.utils.unregister_class(group)


def _all() -> list[type[bpy.types.PropertyGroup]]:
    """The groups, each after those that it holds."""
    return [*groups, HELIFORM_PG_curve, *(group for _, group in OWNERS)]
