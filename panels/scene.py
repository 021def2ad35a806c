"""The parent panel: what is in the scene, and what the active object is to light."""

import math
import re
import textwrap
from typing import Any

import bpy
from bpy.types import Context, Object, Panel, UILayout

from ..addon import jobs
from ..addon.bridge.lights import BlenderLight, is_sun, read_light
from ..addon.bridge.materials import read_material
from ..addon.objects import GLASS, PLANE, WALL, lamp_hides, may_be_body
from ..addon.properties import draw, read, scale_of
from ..addon.structures import STRUCTURE
from ..engines.core.errors import SceneError
from ..engines.core.glazing import goes_by_transmittance, highest_transmittance
from ..engines.core.scene import Lamp, Material, Plane
from ..engines.light.shape import placed_lamp
from . import PARENT, Sidebar

_ROLES = (
    ("BODY", "MESH_CYLINDER", "No body"),
    ("LAMP", "LIGHT_SPOT", "No lamp"),
    ("RECEIVER", "MESH_PLANE", "No receiver"),
)
_TABLE = re.compile(r"^\[[\w.]+\] ")
_CLEAR = {"absorption", "transmittance", "glass", "abbe", "priority"}
_MATERIAL_HIDES = {
    "dielectric": {"reflectance", "specularity"},
    "mirror": {"ior", "specularity"} | _CLEAR,
    "diffuse": {"ior", "specularity", "roughness"} | _CLEAR,
    "plastic": {"ior", "roughness"} | _CLEAR,
    "absorber": {"ior", "reflectance", "specularity", "roughness"} | _CLEAR,
}
_KINDS = {
    "dielectric": "Clear glass",
    "mirror": "Mirror",
    "diffuse": "Matte",
    "plastic": "Matte under a gloss",
    "absorber": "Black",
}
_THICK = 0.01
"""Metres of glass that the panel says the transmittance of."""

Rows = list[tuple[str, str]]


class HELIFORM_PT_heliform(Sidebar, Panel):
    """What light meets, leaves and lands on"""

    bl_idname = PARENT
    bl_label = "Heliform"

    def draw(self, context: Context) -> None:
        """The buttons that add, and the lists."""
        layout = self.layout
        row = layout.row(align=True)
        row.operator("heliform.add_wall", text="Wall", icon="MOD_CLOTH")
        row.operator("heliform.add_lamp", text="Lamp", icon="LIGHT_SPOT")
        row.operator("heliform.add_receiver", text="Receiver", icon="MESH_PLANE")
        layout.operator_menu_enum(
            "heliform.add_structure", "preset", text="Structure", icon="MOD_LATTICE"
        )
        found = {role: _listed(context, role) for role, _, _ in _ROLES}
        if not any(found.values()):
            layout.operator("heliform.add_demo", icon="SCENE_DATA")
        column = layout.box().column(align=True)
        for role, icon, none in _ROLES:
            _list(column, context, found[role], icon, none)


class HELIFORM_PT_object(Sidebar, Panel):
    """What the active object is to light"""

    bl_parent_id = PARENT
    bl_label = "Object"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with an object that can have a role."""
        obj = context.object
        return obj is not None and (obj.type in ("MESH", "LIGHT") or may_be_body(obj))

    def draw(self, context: Context) -> None:
        """Its role, and the settings that the role has."""
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        layout.use_property_decorate = False
        own = obj.heliform
        _draw_roles(layout, obj)
        if obj.type == "MESH" and own.role in ("NONE", "BODY"):
            layout.operator("heliform.add_work_plane", icon="MESH_GRID")
        if own.form not in (GLASS, WALL, STRUCTURE):  # their own room says so
            draw_problem(layout, obj)
        if own.role == "BODY":
            draw_sentence(layout, body_used(obj, scale_of(context.scene))[2])
        elif own.role == "LAMP" and obj.type == "LIGHT":
            draw(layout, own.blender_light, BlenderLight)
            draw_used(layout, *light_used(obj, scale_of(context.scene)))
        elif own.role == "LAMP":
            draw(layout, own.lamp, Lamp, lamp_hides(own.lamp))
        elif own.role == "RECEIVER":
            draw(layout, own.plane, Plane, set() if own.form == PLANE else {"width", "length"})


class HELIFORM_PT_material(Sidebar, Panel):
    """How the active body treats light, and what the simulation uses"""

    bl_parent_id = "HELIFORM_PT_object"
    bl_label = "Material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a body."""
        return context.object is not None and context.object.heliform.role == "BODY"

    def draw(self, context: Context) -> None:
        """Where it comes from, its settings, and what is made of them."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        _draw_body(self.layout, context.object, scale_of(context.scene))


def _draw_roles(layout: UILayout, obj: Object) -> None:
    """The buttons that say what the object is; none for a lamp of Heliform's own."""
    role = obj.heliform.role
    if obj.type == "LIGHT":
        operator, choices = "heliform.mark_light", ("LAMP", "NONE")
    elif obj.type == "EMPTY":
        operator, choices = "heliform.mark_as", ("BODY", "NONE")
    elif role != "LAMP":
        operator, choices = "heliform.mark_as", ("BODY", "RECEIVER", "NONE")
    else:
        return
    row = layout.row(align=True)
    row.use_property_split = False
    for choice in choices:
        button = row.operator(operator, text=choice.capitalize(), depress=role == choice)
        button.role = choice


def _draw_body(layout: UILayout, obj: Object, scale: float) -> None:
    """Where its material comes from, its own settings if they say it, and what is used."""
    own = obj.heliform
    layout.operator_menu_enum("heliform.set_material", "preset", text="Preset", icon="PRESET")
    layout.prop(own, "material_from")
    if own.material_from == "OWN":
        draw(layout, own.material, Material, material_hides(own.material))
    rows, notes, problem = body_used(obj, scale)
    if own.material_from == "BLENDER" and not problem:
        layout.prop(own.material, "priority")
    draw_used(layout, rows, notes, "")


def material_hides(group: Any) -> set[str]:
    """The fields of a Material that say nothing for the kind that a group holds."""
    published = {"abbe"} if group.glass != "own" else set()
    given = {"absorption"} if group.transmittance < 1 else set()
    return _MATERIAL_HIDES[group.kind] | published | given


# What the simulation uses

Used = tuple[Rows, tuple[str, ...], str]
"""Rows of a name and a value, notes, and what is not understood, if anything."""


def body_used(obj: Object, scale: float) -> Used:
    """What a body is to light now, from its own settings or its Blender material."""
    if obj.heliform.material_from == "OWN":
        material = read(obj.heliform.material, Material)
        return [("Source", "Heliform settings"), *_material_rows(material)], (), ""
    try:
        reading = read_material(obj, scale)
    except SceneError as error:
        return [], (), str(error)
    return [("Source", reading.source), *_material_rows(reading.material)], reading.notes, ""


def light_used(obj: Object, scale: float) -> Used:
    """What a Blender light is as a lamp now."""
    try:
        reading = read_light(obj, scale)
        lamp = placed_lamp(obj.name, reading.lamp, obj.matrix_world).lamp
    except SceneError as error:
        return [], (), str(error)
    rows = [("Source", f"Blender {obj.data.type.capitalize()} light")]
    if is_sun(obj):
        rows += [("Illuminance", f"{grouped(reading.lamp.flux)} lx across its rays")]
        rows += [("Beam", "Spans what it shines on")]
    else:
        rows += [("Flux", f"{grouped(lamp.flux)} lm"), *_opening_rows(lamp)]
    return rows, reading.notes, ""


def draw_used(layout: UILayout, rows: Rows, notes: tuple[str, ...], problem: str) -> None:
    """A box of what the simulation uses, or the sentence that says why it cannot."""
    draw_sentence(layout, problem)
    if not rows:
        return
    box = layout.box().column(align=True)
    box.label(text="The simulation uses")
    for name, value in rows:
        split = box.split(factor=0.35)
        split.label(text=name)
        split.label(text=value)
    for note in notes:
        for index, line in enumerate(textwrap.wrap(note, 30)):
            box.label(text=line, icon="INFO" if index == 0 else "BLANK1")


def _material_rows(material: Material) -> Rows:
    rows = [("Kind", _KINDS[material.kind])]
    if material.kind == "dielectric":
        rows += [("Index", f"{material.ior:.4g}"), _passing(material)]
        if material.glass != "own":
            rows += [("Colours", f"{material.glass.capitalize()}, as published")]
        elif material.abbe:
            rows += [("Colours", f"Abbe number {material.abbe:.4g}")]
    elif material.kind != "absorber":
        rows += [("Reflectance", f"{100 * material.reflectance:.3g} %")]
    if material.kind == "plastic":
        rows += [("Gloss", f"{100 * material.specularity:.3g} %")]
    if material.kind in ("dielectric", "mirror"):
        rough = material.roughness
        rows += [("Roughness", f"GGX α {rough:.2g}" if rough else "Smooth")]
    return rows


def _passing(material: Material) -> tuple[str, str]:
    """What of the light passes a clear material, as far as its settings say."""
    if goes_by_transmittance(material):
        clear = highest_transmittance(material.ior)
        return "Straight on", f"{100 * min(material.transmittance, clear):.3g} % passes"
    return "Over 10 mm", f"{100 * math.exp(-material.absorption * _THICK):.3g} % passes"


def _opening_rows(lamp: Lamp) -> Rows:
    if lamp.source == "point":
        return [("Opening", "A point"), ("Shines", "Alike in all directions")]
    sides = [lamp.width] if lamp.opening == "round" else [lamp.length, lamp.width]
    size = " × ".join(f"{1e3 * side:.4g}" for side in sides) + " mm"
    shown = f"Round, {size}" if lamp.opening == "round" else size
    return [("Opening", shown), ("Shines", "By Lambert's law")]


def grouped(value: float) -> str:
    """Three digits at least: 0.535, 43.6, 43 590 with a thin space."""
    return f"{value:,.0f}".replace(",", "\u2009") if value >= 100 else f"{value:.3g}"


# Sentences and progress


def draw_problem(layout: UILayout, obj: Object) -> None:
    """What keeps the object from being what its settings say, if anything."""
    draw_sentence(layout, obj.heliform.problem)


def draw_sentence(layout: UILayout, sentence: str, width: int = 30) -> None:
    """A sentence in a red box, in lines of ``width`` letters, without the name of its table."""
    if not sentence:
        return
    box = layout.box().column(align=True)
    box.alert = True
    for index, line in enumerate(textwrap.wrap(_TABLE.sub("", sentence), width)):
        box.label(text=line, icon="ERROR" if index == 0 else "BLANK1")


def prepare(layout: UILayout) -> None:
    """Labels to the left of their values, and no buttons for keyframes."""
    layout.use_property_split = True
    layout.use_property_decorate = False


def draw_row(layout: UILayout, label: str, value: str) -> None:
    """A label and its value, side by side."""
    split = layout.split(factor=0.5)
    split.label(text=label)
    split.label(text=value)


def draw_notes(layout: UILayout, notes: list[str], width: int = 34, icon: str = "INFO") -> None:
    """What a reader should know, in lines of ``width`` letters."""
    column = layout.column(align=True)
    column.scale_y = 0.8
    for note in notes:
        for index, line in enumerate(textwrap.wrap(note, width)):
            column.label(text=line, icon=icon if index == 0 else "BLANK1")


def draw_progress(layout: UILayout) -> None:
    """The bar, what is being done, and Cancel."""
    state = jobs.state
    row = layout.row(align=True)
    row.scale_y = 1.6
    said = f"{100 * state.fraction:.0f} %, {state.elapsed:.0f} s"
    row.progress(factor=state.fraction, text=said, type="BAR")
    row.operator("heliform.cancel_job", text="", icon="CANCEL")
    column = layout.column(align=True)
    for line in textwrap.wrap("Stopping" if state.cancelling else state.text, 40):
        column.label(text=line)


def _problem(obj: Object, scale: float) -> str:
    """What keeps an object from being traced, of what is quick to tell."""
    own = obj.heliform
    if own.role == "BODY" and own.material_from == "BLENDER":
        return body_used(obj, scale)[2] or own.problem
    if own.role == "LAMP" and obj.type == "LIGHT":
        return light_used(obj, scale)[2]
    return own.problem


def _listed(context: Context, role: str) -> list[Object]:
    return sorted(
        (o for o in context.view_layer.objects if o.heliform.role == role), key=lambda o: o.name
    )


def _list(column: UILayout, context: Context, found: list[Object], icon: str, none: str) -> None:
    if not found:
        row = column.row()
        row.enabled = False
        row.label(text=none, icon=icon)
    scale = scale_of(context.scene)
    for obj in found:
        row = column.row(align=True)
        entry = row.row(align=True)
        entry.alignment = "LEFT"
        entry.active = obj.visible_get() and obj.heliform.on
        entry.alert = bool(_problem(obj, scale))
        chosen = obj.select_get()
        entry.operator("heliform.select", text=obj.name, icon=icon, emboss=chosen).name = obj.name
        switch = row.row()
        switch.alignment = "RIGHT"
        switch.prop(
            obj.heliform,
            "on",
            text="",
            icon="CHECKBOX_HLT" if obj.heliform.on else "CHECKBOX_DEHLT",
            emboss=False,
        )


register, unregister = bpy.utils.register_classes_factory(
    (HELIFORM_PT_heliform, HELIFORM_PT_object, HELIFORM_PT_material)
)
