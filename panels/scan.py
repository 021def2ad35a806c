"""The Scan room: reading a sample, and what was found."""

from typing import Any

import bpy
from bpy.types import Context, Panel, UILayout

from ..addon import jobs
from ..addon.bridge import as_printed, scan
from ..addon.properties import draw
from ..engines.scan import Comparison, ScanReading
from . import Room
from .scene import draw_notes, draw_progress, draw_sentence

Rows = tuple[tuple[str, str, float, str], ...]
"""Figures by their keys, with what they are called, a factor, and the unit that it gives."""

_FIGURES: Rows = (
    ("layer_height", "Layer height", 1e3, "mm"),
    ("depth", "Depth", 1e3, "mm"),
    ("tilt", "Tilt", 1.0, "°"),
    ("roughness", "Roughness", 1e6, "µm"),
    ("noise", "Scan noise", 1e6, "µm"),
    ("wall_thickness", "Wall", 1e3, "mm"),
    ("confidence", "Confidence", 100.0, "%"),
    ("coverage", "Seen", 100.0, "%"),
)
_DEVIATIONS: Rows = (
    ("deviation_mean", "Mean", 1e3, "mm"),
    ("deviation_rms", "RMS", 1e3, "mm"),
    ("deviation_95", "95 % within", 1e3, "mm"),
    ("deviation_max", "Largest", 1e3, "mm"),
    ("within_tolerance", "Within tolerance", 100.0, "%"),
    ("coverage", "Seen", 100.0, "%"),
    ("layer_height", "Layer height", 1e3, "mm"),
    ("layer_height_design", "Designed", 1e3, "mm"),
    ("wall_width", "Wall", 1e3, "mm"),
    ("wall_width_design", "Designed", 1e3, "mm"),
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
            _draw_buttons(layout, bool(reading.file))
        if jobs.state.label == "Read Scan":
            draw_sentence(layout, jobs.state.message)
        facts = scan.facts_of(settings.relief)
        if facts:
            _draw_facts(layout, facts)


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


class HELIFORM_PT_as_printed(Room, Panel):
    """The scan of a finished piece against its design"""

    bl_parent_id = "HELIFORM_PT_scan"
    bl_label = "As Printed"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """The scan, what counts as right, the button, and what was found."""
        layout, comparison = self.layout, context.scene.heliform.comparison
        layout.use_property_split = True
        layout.use_property_decorate = False
        placed = set() if comparison.start == "as placed" else {"placed"}
        draw(layout, comparison, Comparison, {"body"} | placed)
        if jobs.state.running:
            draw_progress(layout)
        else:
            layout.operator("heliform.compare_print", icon="MOD_DATA_TRANSFER")
        if jobs.state.label == "Compare Print":
            draw_sentence(layout, jobs.state.message)
        facts = as_printed.facts_of(context.object)
        if facts:
            _draw_figures(layout, facts["figures"], _DEVIATIONS)
            row = layout.row(align=True)
            row.operator("heliform.open_comparison", icon="URL")
            row.operator("heliform.clear_layer", text="", icon="X")
            draw_notes(layout, facts["notes"])


def _draw_buttons(layout: UILayout, chosen: bool) -> None:
    """What comes next: a scan to read, or to choose; the sample that comes along, too."""
    row = layout.row()
    row.scale_y = 1.4
    if chosen:
        row.operator("heliform.read_scan", icon="MESH_GRID")
        return
    row.operator("heliform.choose_scan", text="Choose Scan…", icon="FILE_FOLDER")
    layout.operator("heliform.read_scan", text="Read Built-in Sample")


def _draw_facts(layout: UILayout, facts: dict[str, Any]) -> None:
    """The numbers, what was noticed, and the way to walls."""
    layout.prop(bpy.context.scene.heliform, "relief", text="Relief")
    _draw_figures(layout, facts["figures"], _FIGURES)
    row = layout.row(align=True)
    row.operator("heliform.use_scan", icon="MOD_OCEAN")
    row.operator("heliform.open_scan_report", text="", icon="URL")
    draw_notes(layout, facts["notes"])


def _draw_figures(layout: UILayout, figures: dict[str, Any], rows: Rows) -> None:
    box = layout.box().column(align=True)
    for key, label, factor, unit in rows:
        if key in figures:
            figure = figures[key]
            spread = figure.get("uncertainty")
            tail = f" ± {factor * spread:.2g}" if spread else ""
            split = box.split(factor=0.42)
            split.label(text=label)
            split.label(text=f"{factor * figure['value']:.4g}{tail} {unit}")


register, unregister = bpy.utils.register_classes_factory(
    (HELIFORM_PT_scan, HELIFORM_PT_scan_more, HELIFORM_PT_as_printed)
)
