"""The Glass room: the shape of the active printed object, its check and repair."""

from typing import Any

import bpy
from bpy.types import Context, Object, Panel, Scene, UILayout

from ..addon.bridge.print_nodes import sockets_of
from ..addon.objects import GLASS, WALL
from ..addon.properties import draw, scale_of
from ..addon.structures import STRUCTURE
from ..engines.core.parameters import fields_of
from ..engines.glass import GlassObject
from ..engines.glass.fourier import Plan
from ..engines.glass.loft import Wall
from ..operators.relief import relief_of
from . import Room
from .scene import draw_problem


class HELIFORM_PT_glass(Room, Panel):
    """Printed glass: its shape, and whether it is a solid"""

    bl_idname = "HELIFORM_PT_glass"
    bl_label = "Glass"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Not with a structure, which is no glass."""
        return context.object is None or context.object.heliform.form != STRUCTURE

    def draw(self, context: Context) -> None:
        """The active glass object, or how to get one."""
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        layout.use_property_decorate = False
        if obj is None or obj.heliform.role != "BODY":
            layout.label(text="Select a glass object, or add one.", icon="INFO")
            return
        if obj.heliform.form == WALL:
            draw_wall(layout, obj)
        elif obj.heliform.form == GLASS:
            layout.operator_menu_enum("heliform.reshape_glass", "preset", icon="PRESET")
            draw_problem(layout, obj)
            shape = obj.heliform.glass_object
            draw(layout, shape, GlassObject, () if shape.lobes else {"lobe"})
        _facts(layout, obj, context.scene)
        row = layout.row(align=True)
        row.operator("heliform.check_glass", icon="CHECKMARK")
        row.operator("heliform.repair_glass", icon="MODIFIER")


def draw_wall(layout: UILayout, obj: Object) -> None:
    """The wall's shape: its plans unless it follows curves, and what is lofted."""
    own = obj.heliform
    layout.operator_menu_enum("heliform.reshape_wall", "preset", icon="PRESET")
    draw_problem(layout, obj)
    if own.curves:
        row = layout.row(align=True)
        row.prop(own.curves[0], "object", text="Curve")
        row.operator("heliform.rebuild_wall", text="", icon="FILE_REFRESH")
    else:
        _draw_plan(layout, own.wall.plan, "Plan")
        layout.prop(own.wall, "to_top", text="Plan at the Top")
        if own.wall.to_top:
            _draw_plan(layout, own.wall.top, "Plan at the top")
    box = layout.box()
    box.label(text="Outer size, 0 as the plan is")
    box.prop(own.wall, "width")
    box.prop(own.wall, "depth")
    drawn = {f.name for f in fields_of(Wall) if f.kind == "record"} | {"to_top", "width", "depth"}
    draw(layout, own.wall, Wall, drawn)
    layout.prop(own.wall.bead, "height", text="Layer Height")


def _draw_plan(layout: UILayout, plan: Any, title: str) -> None:
    """A plan's waves, without what says nothing while a wave has no height."""
    box = layout.box()
    box.label(text=title)
    idle = {
        f"{name}_{wave}"
        for wave in (1, 2)
        if not getattr(plan, f"amplitude_{wave}")
        for name in ("period", "phase")
    }
    draw(box, plan, Plan, idle)


def _facts(layout: UILayout, obj: Object, scene: Scene) -> None:
    """What the mesh is now."""
    column = layout.column(align=True)
    fact(column, "Size", size_text(tuple(d * scale_of(scene) for d in obj.dimensions)))
    fact(column, "Faces", f"{len(obj.data.polygons):,}".replace(",", "\u2009"))
    if obj.heliform.form == GLASS and not obj.modifiers:
        fact(column, "Watertight", "By construction")


def size_text(metres: tuple[float, ...]) -> str:
    """217 × 217 × 209 mm; in metres from 10 m on."""
    factor, unit = (1, "m") if max(metres) >= 10 else (1e3, "mm")
    return " × ".join(f"{size * factor:.4g}" for size in metres) + f" {unit}"


def fact(column: UILayout, name: str, value: str) -> None:
    """A name at the right of the left column, and a value."""
    split = column.split(factor=0.4)
    left = split.row()
    left.alignment = "RIGHT"
    left.label(text=name)
    split.label(text=value)


class HELIFORM_PT_relief(Room, Panel):
    """The relief of printed layers on the active mesh"""

    bl_parent_id = "HELIFORM_PT_glass"
    bl_label = "Print Layers"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a mesh that could have it."""
        obj = context.object
        return obj is not None and obj.type == "MESH" and obj.heliform.role == "BODY"

    def draw(self, context: Context) -> None:
        """Where the relief is from, and the modifier's settings."""
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        layout.use_property_decorate = False
        row = layout.row(align=True)
        row.operator_menu_enum("heliform.add_relief", "style", icon="MOD_OCEAN")
        row.operator("heliform.load_relief", text="", icon="FILE_FOLDER")
        row.operator("heliform.draw_relief", text="", icon="CURVE_DATA")
        modifier = relief_of(obj)
        if modifier is None:
            return
        row.operator("heliform.save_relief", text="", icon="FILE_TICK")
        row.operator("heliform.copy_relief", text="", icon="PASTEDOWN")
        hidden = {"Geometry"} | ({"Layer Height"} if obj.heliform.form == WALL else set())
        for name, socket in sockets_of(modifier).items():
            if name == "Mask":
                _draw_mask(layout, socket, obj)
            elif name == "Style":
                fact(layout, name, socket.value.name if socket.value else "None")
            elif name not in hidden:
                layout.prop(socket, "value", text=name)


def _draw_mask(layout: UILayout, socket: Any, obj: Object) -> None:
    """How much of the relief there is: everywhere the same, or as a vertex group says."""
    row = layout.row(align=True)
    if socket.type == "ATTRIBUTE":
        row.prop_search(socket, "attribute_name", obj, "vertex_groups", text="Mask")
    else:
        row.prop(socket, "value", text="Mask")
    row.prop(socket, "type", text="", icon="GROUP_VERTEX", icon_only=True)


register, unregister = bpy.utils.register_classes_factory((HELIFORM_PT_glass, HELIFORM_PT_relief))
