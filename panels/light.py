"""The Light room: tracing, what came out, how it is shown."""

import textwrap
from typing import Any

import bpy
from bpy.types import Context, Panel, UILayout

from ..addon import jobs
from ..addon.bridge import results, showing
from ..addon.properties import draw
from ..engines.core import runtime
from ..engines.core.colour import Display
from ..engines.light import PhotonTracing
from . import Room
from .scene import draw_progress, draw_sentence

_HANDLED = {"until", "error", "landed", "seconds", "keep_sums"}
"""Fields that the Light panel itself shows, and one that is always on here."""
_OTHERS = {
    *("Read Scan", "Choose Scan", "Compare Print", "Size Members"),
    *("Study Sun", "Study Daylight", "Pick Sensor"),
}
"""Jobs of other rooms, whose panels say how they went."""
_STOP_OF = {"error": "error", "landed": "landed", "time": "seconds"}
_FLUX = (
    ("emitted", "Lamps"),
    ("landed", "Landed"),
    ("absorbed", "Absorbed"),
    ("escaped", "Escaped"),
    ("cut_off", "Cut off"),
)


class HELIFORM_PT_light(Room, Panel):
    """Photon tracing from the lamps through the glass onto the receivers"""

    bl_idname = "HELIFORM_PT_light"
    bl_label = "Light"

    def draw(self, context: Context) -> None:
        """How long to trace, and the button that does it."""
        layout, settings = self.layout, context.scene.heliform
        layout.use_property_split = True
        layout.use_property_decorate = False
        tracing = settings.photon_tracing
        column = layout.column()
        column.prop(tracing, "until")
        column.prop(tracing, _STOP_OF[tracing.until])
        if jobs.state.running:
            draw_progress(layout)
        else:
            row = layout.row()
            row.scale_y = 1.6
            row.operator("heliform.trace_photons", icon="LIGHT_SUN")
        if not runtime.choose().backend:
            draw_sentence(layout, f"Tracing is off: {runtime.choose().reason}.")
        if jobs.state.label not in _OTHERS:
            draw_sentence(layout, jobs.state.message)


class HELIFORM_PT_light_more(Room, Panel):
    """Rarely needed settings of the tracing"""

    bl_parent_id = "HELIFORM_PT_light"
    bl_label = "Settings"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Everything but when to stop."""
        layout, settings = self.layout, context.scene.heliform
        layout.use_property_split = True
        layout.use_property_decorate = False
        draw(layout, settings.photon_tracing, PhotonTracing, without=_HANDLED)
        layout.prop(settings, "seed")


class _ResultPanel(Room):
    """A panel that is there once a result is."""

    bl_parent_id = "HELIFORM_PT_light"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a result."""
        return results.is_result(context.scene.heliform.shown)


class HELIFORM_PT_light_result(_ResultPanel, Panel):
    """What came of the tracing"""

    bl_label = "Result"

    def draw(self, context: Context) -> None:
        """The numbers, where the light went, and the way to the report."""
        layout, picture = self.layout, context.scene.heliform.shown
        meta, figures = results.meta_of(picture), results.figures_of(picture)
        pictures = results.results_of(context.scene)
        if len(pictures) > 1:
            _list(layout, pictures, picture)
        box = layout.box().column(align=True)
        _row(box, "Receiver", results.name_of(picture))
        _row(box, "Mean", _value(figures["mean_illuminance"]))
        _row(box, "Highest", _value(figures["max_illuminance"]))
        if meta["error"]:
            _row(box, "Error", f"{100 * meta['error']:.1f} %")
        photons = meta["photons"]
        sent, landed = (_count(photons[key]) for key in ("emitted", "landed"))
        _row(box, "Photons", f"{sent}, {landed} landed")
        _row(box, "Time", f"{meta['seconds']:.1f} s")
        box = layout.box().column(align=True)
        for key, name in _FLUX:
            share = meta["flux"][key] / (meta["flux"]["emitted"] or 1)
            _row(box, name, f"{meta['flux'][key]:z.1f} lm", f"{100 * share:z.1f} %")
        for note in meta["notes"]:
            _note(layout, note)
        row = layout.row(align=True)
        row.operator("heliform.refine_photons", icon="ADD")
        row.operator("heliform.open_report", icon="URL")
        if not results.is_plane(picture):
            layout.operator("heliform.values_to_vertices", icon="VERTEXSEL")


class HELIFORM_PT_light_display(_ResultPanel, Panel):
    """How the result is shown; changes colour it anew without tracing"""

    bl_label = "Display"

    def draw(self, context: Context) -> None:
        """Which map, in which colours."""
        layout, settings = self.layout, context.scene.heliform
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(settings.shown, "heliform_map")
        fixed = {"low", "high"} if settings.display.automatic else set()
        draw(layout, settings.display, Display, without=fixed)
        draw_sentence(layout, showing.problem_of(settings.shown))
        layout.prop(settings, "legend")
        if context.scene.view_settings.view_transform not in ("Standard", "Raw"):
            _note(layout, "Renders show the legend's colours with the view transform Standard.")
            layout.prop(context.scene.view_settings, "view_transform", text="Renders")


class HELIFORM_PT_light_section(_ResultPanel, Panel):
    """The light along a line"""

    bl_label = "Section"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with the result of a plane."""
        return super().poll(context) and results.is_plane(context.scene.heliform.shown)

    def draw(self, context: Context) -> None:
        """The line and the plot."""
        layout, picture = self.layout, context.scene.heliform.shown
        row = layout.row(align=True)
        row.operator("heliform.section", icon="FCURVE")
        row.operator("heliform.add_section_line", text="Add Line", icon="IPO_LINEAR")
        if results.SECTION in picture:
            row.operator("heliform.clear_section", text="", icon="X")


class HELIFORM_PT_study(Room, Panel):
    """The scene as a file that runs anywhere, and back"""

    bl_label = "Study"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 100

    def draw(self, context: Context) -> None:
        """Load and export."""
        row = self.layout.row(align=True)
        row.operator("heliform.load_study", text="Load", icon="IMPORT")
        row.operator("heliform.export_study", text="Export", icon="EXPORT")


def _list(layout: UILayout, pictures: list[bpy.types.Image], shown: bpy.types.Image) -> None:
    """A button and the mean a receiver; pressed, it is the one that is told of below."""
    column = layout.column(align=True)
    for picture in pictures:
        split = column.split(factor=0.65, align=True)
        chosen = picture == shown
        name = results.name_of(picture)
        split.operator("heliform.show_result", text=name, depress=chosen).name = picture.name
        figure = results.figures_of(picture)["mean_illuminance"]
        split.label(text=f"{_number(figure['value'])} {figure['unit']}")


def _row(column: UILayout, name: str, *values: str) -> None:
    split = column.split(factor=0.35)
    split.label(text=name)
    cells = split.row()
    for value in values:
        cells.label(text=value)


def _note(layout: UILayout, note: str) -> None:
    column = layout.column(align=True)
    for index, line in enumerate(textwrap.wrap(note, 40)):
        column.label(text=line, icon="INFO" if index == 0 else "BLANK1")


def _value(figure: dict[str, Any]) -> str:
    spread = f" ± {_number(figure['uncertainty'])}" if "uncertainty" in figure else ""
    return f"{_number(figure['value'])}{spread} {figure['unit']}"


def _number(value: float) -> str:
    """Three digits at least: 0.535, 43.6, 43 590 with a thin space."""
    return f"{value:,.0f}".replace(",", "\u2009") if value >= 100 else f"{value:.3g}"


def _count(number: int) -> str:
    return f"{number / 1e6:.1f} M" if number >= 1e6 else _number(number)


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_PT_light,
        HELIFORM_PT_light_more,
        HELIFORM_PT_light_result,
        HELIFORM_PT_light_display,
        HELIFORM_PT_light_section,
        HELIFORM_PT_study,
    )
)
