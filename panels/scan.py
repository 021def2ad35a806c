"""The Scan room: reading a sample, and what was found."""

import textwrap
from typing import Any

import bpy
from bpy.types import Context, Panel, UILayout

from ..addon import jobs
from ..addon.bridge import scan
from ..addon.properties import draw
from ..engines.scan import ScanReading
from . import Room
from .scene import draw_progress, draw_sentence

_FIGURES = (
    ("layer_height", "Layer height", 1e3, "mm"),
    ("depth", "Depth", 1e3, "mm"),
    ("tilt", "Tilt", 1.0, "°"),
    ("roughness", "Roughness", 1e6, "µm"),
    ("noise", "Scan noise", 1e6, "µm"),
    ("wall_thickness", "Wall", 1e3, "mm"),
    ("confidence", "Confidence", 100.0, "%"),
    ("coverage", "Seen", 100.0, "%"),
)


class HELIFORM_PT_scan(Room, Panel):
    """From a scanned sample to the relief of its layers"""

    bl_idname = "HELIFORM_PT_scan"
    bl_label = "Scan"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """The file, the button that reads it, and what was found."""
        layout, settings = self.layout, context.scene.heliform
        layout.use_property_split = True
        layout.use_property_decorate = False
        reading = settings.scan_reading
        column = layout.column()
        column.prop(reading, "file", text="Scan", placeholder="Built-in sample")
        column.prop(reading, "unit")
        if jobs.state.running:
            draw_progress(layout)
        else:
            row = layout.row(align=True)
            row.scale_y = 1.4
            row.operator("heliform.read_scan", icon="MESH_GRID")
            row.operator("heliform.choose_scan", text="", icon="FILE_FOLDER")
        if jobs.state.label == "Read Scan":
            draw_sentence(layout, jobs.state.message)
        facts = scan.facts_of(settings.relief)
        if facts:
            _draw_facts(layout, settings.relief.name, facts)


class HELIFORM_PT_scan_more(Room, Panel):
    """Rarely needed settings of the reading"""

    bl_parent_id = "HELIFORM_PT_scan"
    bl_label = "Settings"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Everything but the file and its unit."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        draw(layout, context.scene.heliform.scan_reading, ScanReading, {"file", "unit"})


def _draw_facts(layout: UILayout, name: str, facts: dict[str, Any]) -> None:
    """The numbers, what was noticed, and the way to walls."""
    layout.prop(bpy.context.scene.heliform, "relief", text="Relief")
    box = layout.box().column(align=True)
    figures = facts["figures"]
    for key, label, factor, unit in _FIGURES:
        if key in figures:
            figure = figures[key]
            spread = figure.get("uncertainty")
            tail = f" ± {factor * spread:.2g}" if spread else ""
            split = box.split(factor=0.42)
            split.label(text=label)
            split.label(text=f"{factor * figure['value']:.4g}{tail} {unit}")
    row = layout.row(align=True)
    row.operator("heliform.use_scan", icon="MOD_OCEAN")
    row.operator("heliform.open_scan_report", text="", icon="URL")
    column = layout.column(align=True)
    column.scale_y = 0.8
    for note in facts["notes"]:
        for index, line in enumerate(textwrap.wrap(note, 40)):
            column.label(text=line, icon="INFO" if index == 0 else "BLANK1")


register, unregister = bpy.utils.register_classes_factory((HELIFORM_PT_scan, HELIFORM_PT_scan_more))
