"""Printing the active wall: the machine, the gate's lines, the path and the files."""

import textwrap
from typing import Any

import bpy
from bpy.types import Context, Panel, UILayout

from ..addon import printing
from ..addon.bridge.paths import facts_of, path_of
from ..addon.objects import WALL
from ..addon.properties import draw
from ..engines.glass import PRINT_WALL
from ..engines.glass.checks import GEOMETRY
from ..engines.glass.machine import FILE
from ..engines.glass.toolpath import Spiral
from . import Room
from .scene import grouped


class HELIFORM_PT_print(Room, Panel):
    """Whether and how a printer lays the active wall"""

    bl_parent_id = "HELIFORM_PT_glass"
    bl_idname = "HELIFORM_PT_print"
    bl_label = "Print"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a wall."""
        return context.object is not None and context.object.heliform.form == WALL

    def draw(self, context: Context) -> None:
        """The machine, the gate, the path, and the files."""
        layout, obj, settings = self.layout, context.object, context.scene.heliform
        layout.use_property_split = True
        layout.use_property_decorate = False
        row = layout.row(align=True)
        row.prop(settings, "machine")
        row.operator("heliform.edit_machine", text="", icon="GREASEPENCIL")
        if settings.machine == FILE:
            layout.prop(settings, "machine_file")
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(obj.heliform, "gate", toggle=True, icon="CHECKMARK")
        row.prop(obj.heliform, "path", toggle=True, icon="CURVE_PATH")
        row = layout.row(align=True)
        row.operator("heliform.export_gcode", text="G-code", icon="EXPORT")
        row.operator("heliform.export_solid", text="Solid", icon="MESH_CUBE")
        path = path_of(obj)
        if path:
            _draw_facts(layout, facts_of(path))
        verdict = printing.verdict_of(obj)
        if verdict:
            _draw_verdict(layout, verdict, obj.heliform.gate_check)


class HELIFORM_PT_spiral(Room, Panel):
    """Rarely needed settings of the path"""

    bl_parent_id = "HELIFORM_PT_print"
    bl_label = "Path Settings"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Everything but the layer height, which the wall says."""
        layout, group = self.layout, context.scene.heliform.spiral
        layout.use_property_split = True
        layout.use_property_decorate = False
        hidden = {"layer_height"} | ({"speed"} if group.pace != "speed" else set())
        draw(layout, group, Spiral, hidden)
        layout.operator("heliform.export_coupon", icon="MOD_THICKNESS")
        study = layout.operator("heliform.export_study", text="Export as Study", icon="EXPORT")
        study.analysis = PRINT_WALL.name


def _draw_verdict(layout: UILayout, verdict: dict[str, Any], shown: str) -> None:
    """A line a check: passed or not, the figure and its limit, and where that is from."""
    box = layout.box().column(align=True)
    head = box.row()
    head.alert = not verdict["passed"]
    failed = sum(not check["passed"] for check in verdict["checks"])
    head.label(
        text="Printable" if verdict["passed"] else f"Not printable: {failed} of its limits",
        icon="CHECKMARK" if verdict["passed"] else "ERROR",
    )
    for check in sorted(verdict["checks"], key=lambda check: -check["share"]):
        _draw_check(box, check, check["name"] == shown)
    if not all(check["confirmed"] for check in verdict["checks"]):
        _wrapped(box, "? The limit is assumed. Press a line for its source and its own colours.")


def _draw_check(box: UILayout, check: dict[str, Any], shown: bool) -> None:
    split = box.split(factor=0.52, align=True)
    name = split.row()
    name.alert = not check["passed"]
    name.alignment = "LEFT"
    icon = "CHECKMARK" if check["passed"] else "CANCEL"
    button = name.operator("heliform.show_check", text=check["label"], icon=icon, emboss=shown)
    button.name = check["name"]
    if check["source"] == GEOMETRY and check["passed"]:
        split.label(text="Yes")
    else:
        sign = "≥" if check["least"] else "≤"
        if not check["passed"]:
            sign = "<" if check["least"] else ">"
        doubt = "" if check["confirmed"] else " ?"
        limit = f"{check['limit']:.3g} {check['unit']}"
        split.label(text=f"{check['worst']:.3g} {sign} {limit}{doubt}")
    if shown or not check["passed"]:
        _wrapped(box, check["sentence"])
        _wrapped(box, check["source"])


def _wrapped(box: UILayout, text: str) -> None:
    column = box.column(align=True)
    column.scale_y = 0.8
    for line in textwrap.wrap(text, 30):
        column.label(text=line, icon="BLANK1")


def _draw_facts(layout: UILayout, facts: dict[str, float]) -> None:
    column = layout.box().column(align=True)
    minutes = facts["time"] / 60
    rows = (
        ("Turns", f"{facts['turns']:.0f}"),
        ("Length", f"{facts['length']:.1f} m"),
        ("Time", f"{minutes:.0f} min" if minutes < 120 else f"{minutes / 60:.1f} h"),
        ("Glass", f"{grouped(facts['mass'])} kg"),
    )
    for name, value in rows:
        split = column.split(factor=0.35)
        split.label(text=name)
        split.label(text=value)


register, unregister = bpy.utils.register_classes_factory((HELIFORM_PT_print, HELIFORM_PT_spiral))
