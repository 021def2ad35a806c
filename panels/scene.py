"""The parent panel: what is in the scene, and what the active object is to light."""

import re
import textwrap

import bpy
from bpy.types import Context, Object, Panel, UILayout

from ..addon.objects import GLASS, PLANE, lamp_hides
from ..addon.properties import draw
from ..engines.core.scene import Lamp, Material, Plane
from . import PARENT, Sidebar

_ROLES = (
    ("BODY", "MESH_CYLINDER", "No body"),
    ("LAMP", "LIGHT_SPOT", "No lamp"),
    ("RECEIVER", "MESH_PLANE", "No receiver"),
)
_TABLE = re.compile(r"^\[[\w.]+\] ")
_MATERIAL_HIDES = {
    "dielectric": {"reflectance", "specularity"},
    "mirror": {"ior", "specularity"},
    "diffuse": {"ior", "specularity"},
    "plastic": {"ior"},
    "absorber": {"ior", "reflectance", "specularity"},
}


class HELIFORM_PT_heliform(Sidebar, Panel):
    """What light meets, leaves and lands on"""

    bl_idname = PARENT
    bl_label = "Heliform"

    def draw(self, context: Context) -> None:
        """The buttons that add, and the lists."""
        layout = self.layout
        row = layout.row(align=True)
        row.operator("heliform.add_glass_object", text="Glass", icon="MESH_CYLINDER")
        row.operator("heliform.add_lamp", text="Lamp", icon="LIGHT_SPOT")
        row.operator("heliform.add_receiver", text="Receiver", icon="MESH_PLANE")
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
        return context.object is not None and context.object.type == "MESH"

    def draw(self, context: Context) -> None:
        """Its role, and the settings that the role has."""
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        layout.use_property_decorate = False
        own = obj.heliform
        if own.role != "LAMP":
            row = layout.row(align=True)
            row.use_property_split = False
            for role, text in (("BODY", "Body"), ("RECEIVER", "Receiver"), ("NONE", "None")):
                button = row.operator("heliform.mark_as", text=text, depress=own.role == role)
                button.role, button.kind = role, own.material.kind
        if own.form != GLASS:  # its own room says so
            draw_problem(layout, obj)
        if own.role == "BODY":
            draw(layout, own.material, Material, _MATERIAL_HIDES[own.material.kind])
        elif own.role == "LAMP":
            draw(layout, own.lamp, Lamp, lamp_hides(own.lamp))
        elif own.role == "RECEIVER":
            draw(layout, own.plane, Plane, set() if own.form == PLANE else {"width", "length"})


def draw_problem(layout: UILayout, obj: Object) -> None:
    """What keeps the object from being what its settings say, if anything."""
    draw_sentence(layout, obj.heliform.problem)


def draw_sentence(layout: UILayout, sentence: str, width: int = 34) -> None:
    """A sentence in a red box, in lines of ``width`` letters, without the name of its table."""
    if not sentence:
        return
    box = layout.box().column(align=True)
    box.alert = True
    for index, line in enumerate(textwrap.wrap(_TABLE.sub("", sentence), width)):
        box.label(text=line, icon="ERROR" if index == 0 else "BLANK1")


def _listed(context: Context, role: str) -> list[Object]:
    return sorted(
        (o for o in context.view_layer.objects if o.heliform.role == role), key=lambda o: o.name
    )


def _list(column: UILayout, context: Context, found: list[Object], icon: str, none: str) -> None:
    if not found:
        row = column.row()
        row.enabled = False
        row.label(text=none, icon=icon)
    for obj in found:
        row = column.row(align=True)
        entry = row.row(align=True)
        entry.alignment = "LEFT"
        entry.active = obj.visible_get() and obj.heliform.on
        entry.alert = bool(obj.heliform.problem)
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
    (HELIFORM_PT_heliform, HELIFORM_PT_object)
)
