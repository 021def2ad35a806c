"""The Sun room: where and when, the studies, what came out, and the sun itself."""

import calendar
import textwrap
from typing import Any

import bpy
from bpy.types import Context, Panel, UILayout

from ..addon import jobs, live_sun, sun_place
from ..addon.bridge import sun, sun_sensor
from ..addon.properties import draw
from ..engines.core import runtime
from ..engines.core.colour import Display
from ..engines.core.errors import HeliformError
from ..engines.sun import SUN_DAYLIGHT, SUN_RADIATION, Daylight, Radiation
from ..engines.sun.site import Site
from ..engines.sun.words import figure_text, figure_words, matters
from . import Room
from .scene import draw_notes, draw_progress, draw_row, draw_sentence, prepare

_JOBS = ("Study Sun", "Study Daylight", "Pick Sensor")
_OF_MAPS = {"mean", "min", "max", "sum"}
"""How figures of maps begin; the panel has the means of the receiver that is shown."""
_SHORT = {"open": "Without buildings", "open_illuminance": "Without buildings"}
"""Titles that are longer than the sidebar is wide."""
_SHARED = {"site", "weather_file", "period", "open"}
"""What the panel shows above, in panels of its own, or by other words."""
_TOLD = {"target", "blinds", "blinds_transmittance"}
"""What of a study of daylight is beside its button."""
_LABELS = 0.6  # of the width of a row of figures
_LINE = 24  # letters of a long value


class HELIFORM_PT_sun(Room, Panel):
    """What sun and sky give to the receivers"""

    bl_idname = "HELIFORM_PT_sun"
    bl_label = "Sun"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """The weather, the period, the studies."""
        layout, own = self.layout, context.scene.heliform
        problem = sun_place.weather_problem(context.scene)
        prepare(layout)
        layout.prop(own.radiation, "weather_file", text="Weather", placeholder="Cloudless year")
        draw_sentence(layout, problem)
        _draw_period(layout, own.radiation.period)
        if jobs.state.running:
            draw_progress(layout)
        else:
            row = layout.row()
            row.scale_y = 1.6
            row.operator("heliform.study_sun", icon="LIGHT_SUN")
        row = layout.row(align=True)
        row.use_property_split = False
        facts = sun.facts_of(context.scene)
        light = facts is not None and facts["kind"] == "daylight"
        live = "Live Irradiation" if light else "Live Sun"
        row.prop(own, "live_sun", text=live, toggle=True, icon="REC")
        row.prop(own, "live_texels", text="Texels")
        if own.live_sun and live_sun.state.rate:
            layout.label(text=f"{live_sun.state.rate:.1f} a second", icon="TIME")
        if not runtime.choose().backend:
            draw_sentence(layout, f"Tracing is off: {runtime.choose().reason}.")
        said = {"", problem}
        if own.live_sun and live_sun.state.problem not in said:
            draw_sentence(layout, live_sun.state.problem)
        if jobs.state.label in _JOBS and jobs.state.message not in said:
            draw_sentence(layout, jobs.state.message)


class _Part(Room):
    bl_parent_id = "HELIFORM_PT_sun"


class HELIFORM_PT_sun_result(_Part, Panel):
    """What came of the study"""

    bl_label = "Result"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a study."""
        return sun.facts_of(context.scene) is not None

    def draw(self, context: Context) -> None:
        """Which map, the numbers, the files, one sensor's hours, the colours."""
        layout, own = self.layout, context.scene.heliform
        prepare(layout)
        facts = sun.facts_of(context.scene)
        assert facts is not None
        layout.prop(own, "sun_map")
        fixed = {"low", "high"} if own.sun_display.automatic else set()
        draw(layout, own.sun_display, Display, {"log"} | fixed)
        draw_sentence(layout, facts.get("problem", ""))
        layout.prop(own, "legend")
        layout.prop(own, "see_inside")
        if facts.get("stale"):
            draw_sentence(layout, "This is of earlier settings; do the study again.")
        if facts.get("live") and not own.live_sun:
            draw_sentence(layout, "This is live and coarse; press Study Sun for all texels.")
        grave = [note for note in facts["notes"] if matters(note)]
        draw_notes(layout, grave, icon="ERROR")
        _draw_figures(layout, context, facts)
        row = layout.row(align=True)
        row.operator("heliform.export_sun_hours", icon="EXPORT")
        row.operator("heliform.sun_to_vertices", text="", icon="VERTEXSEL")
        row.operator("heliform.open_sun_report", text="", icon="URL")
        row.operator("heliform.clear_sun", text="", icon="X")
        row = layout.row(align=True)
        row.operator("heliform.sun_sensor", icon="EYEDROPPER")
        if sun_sensor.picture_of(context.scene):
            row.operator("heliform.show_sun_sensor", text="", icon="WINDOW")
        draw_notes(layout, [note for note in facts["notes"] if note not in grave])


class HELIFORM_PT_sun_daylight(_Part, Panel):
    """Daylight over the year, with what bodies reflect"""

    bl_label = "Daylight"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Its hours, what it is held against, and the button."""
        layout, daylight = self.layout, context.scene.heliform.daylight
        prepare(layout)
        layout.operator("heliform.add_work_plane", icon="MESH_GRID")
        _draw_period(layout, daylight.period)
        layout.prop(daylight, "target")
        layout.prop(daylight, "blinds")
        if daylight.blinds:
            layout.prop(daylight, "blinds_transmittance")
        row = layout.row()
        row.scale_y = 1.4
        row.operator("heliform.study_daylight", icon="OUTLINER_OB_LIGHT")


class HELIFORM_PT_sun_daylight_more(Room, Panel):
    """Rarely needed settings of the study of daylight"""

    bl_label = "Daylight Settings"
    bl_parent_id = "HELIFORM_PT_sun_daylight"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """How far light is followed and how well, the day of exposure; and the study as a file."""
        layout, daylight = self.layout, context.scene.heliform.daylight
        prepare(layout)
        draw(layout, daylight, Daylight, _SHARED | _TOLD)
        layout.prop(daylight, "open", text="Open Field Too")
        button = layout.operator("heliform.export_study", text="Export Study", icon="EXPORT")
        button.analysis = SUN_DAYLIGHT.name


class HELIFORM_PT_sun_site(_Part, Panel):
    """Where the model stands"""

    bl_label = "Site"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """The place; that of a weather file is its own, but for the model's north."""
        layout, radiation = self.layout, context.scene.heliform.radiation
        prepare(layout)
        column = layout.column()
        if radiation.weather_file and not sun_place.weather_problem(context.scene):
            site = sun_place.site_of(context.scene)
            column.active = False
            column.label(text="As the weather file says", icon="INFO")
            draw_row(column, "Latitude", f"{site.latitude:.2f}°")
            draw_row(column, "Longitude", f"{site.longitude:.2f}°")
            draw_row(column, "Elevation", f"{site.elevation:g} m")
            draw_row(column, "UTC offset", f"{site.utc_offset:g} h")
        else:
            draw(column, radiation.site, Site, {"north", "utc_offset", "turbidity"})
            column.prop(radiation.site, "utc_offset", text="UTC Offset")
            column.prop(radiation.site, "turbidity")
        layout.prop(radiation.site, "north")


class HELIFORM_PT_sun_now(_Part, Panel):
    """The sun at a date and hour, and its path over the year"""

    bl_label = "Sun Path"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """The moment, the path, the lamp."""
        layout, own = self.layout, context.scene.heliform
        prepare(layout)
        layout.prop(own, "sun_path", text="Show Path")
        column = layout.column(align=True)
        column.prop(own, "sun_day")
        column.prop(own, "sun_month", text=calendar.month_name[own.sun_month])
        column.prop(own, "sun_hour", slider=True)
        try:
            now = sun_place.sun_now(context.scene)
        except HeliformError as error:
            draw_sentence(layout, str(error))
            return
        said = f"{now.altitude:.1f}° high, azimuth {now.azimuth:.1f}°"
        layout.label(text=said if now.altitude > 0 else "Below the horizon", icon="LIGHT_SUN")
        layout.operator("heliform.add_sun_lamp", icon="ADD")


class HELIFORM_PT_sun_more(_Part, Panel):
    """Rarely needed settings of the study"""

    bl_label = "Settings"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Everything but place, weather and time; and the study as a file that runs anywhere."""
        layout, radiation = self.layout, context.scene.heliform.radiation
        prepare(layout)
        draw(layout, radiation, Radiation, _SHARED)
        layout.prop(radiation, "open", text="Open Field Too")
        button = layout.operator("heliform.export_study", text="Export Study", icon="EXPORT")
        button.analysis = SUN_RADIATION.name


def _draw_period(layout: UILayout, period: Any) -> None:
    """The span, what it needs to be said, and the hours of the day."""
    layout.prop(period, "span", text="Period")
    column = layout.column(align=True)
    if period.span.endswith("season"):
        column.prop(period, "seasons", text="Parted by")
    if period.span.endswith("season") and period.seasons == "dates":
        _draw_dates(column, period.cooling, "Cooled from")
    elif period.span == "dates":
        _draw_dates(column, period, "From day")
    elif period.span == "months":
        column.prop(period, "first_month", text=f"From {_month(period.first_month)}")
        column.prop(period, "last_month", text=f"to {_month(period.last_month)}")
    column = layout.column(align=True)
    column.prop(period, "first_hour", text="From hour")
    column.prop(period, "last_hour", text="to hour")


def _draw_dates(column: UILayout, ends: Any, begin: str) -> None:
    """The first and the last day, with the names of their months."""
    column.prop(ends, "first_day", text=begin)
    column.prop(ends, "first_month", text=_month(ends.first_month))
    column.prop(ends, "last_day", text="to day")
    column.prop(ends, "last_month", text=_month(ends.last_month))


def _month(number: int) -> str:
    return calendar.month_name[number]


def _draw_figures(layout: UILayout, context: Context, facts: dict[str, Any]) -> None:
    """The means of each map and the figures of the active receiver, or of the first."""
    receivers = sun.staged_on(context.scene)
    shown = context.object if context.object in receivers else receivers[0]
    box = layout.box().column(align=True)
    _draw_figure(box, "Mean over", shown.name)
    for name, (title, unit) in facts["quantities"].items():
        mean = {"value": sun.mean_on(shown, name), "unit": unit}
        _draw_figure(box, _SHORT.get(name, title), figure_text(name, mean))
    names = [sun.name_in_study(receiver) for receiver in receivers]
    own = own_figures(facts["figures"], sun.name_in_study(shown), names)
    groups: dict[str, list[tuple[str, str]]] = {}
    for name, figure in own.items():
        if name.partition("_")[0] not in _OF_MAPS:
            group, title = figure_words(name)
            groups.setdefault(group, []).append((title, figure_text(name, figure)))
    for group, rows in groups.items():
        box = layout.box().column(align=True)
        if group:
            box.label(text=group)
        for title, text in rows:
            _draw_figure(box, title, text)
    box = layout.box().column(align=True)
    for name, text in {"Period": facts["period"], **facts.get("facts", {})}.items():
        _draw_fact(box, name, text)


def own_figures(figures: dict[str, Any], receiver: str, receivers: list[str]) -> dict[str, Any]:
    """A receiver's own figures, without its name; where it is the only one, they have none."""
    longer = tuple(f"{r}." for r in receivers if r.startswith(f"{receiver}."))
    own = {
        name.removeprefix(f"{receiver}."): figure
        for name, figure in figures.items()
        if name.startswith(f"{receiver}.") and not name.startswith(longer)
    }
    return own or (figures if len(receivers) == 1 else {})


def _draw_figure(layout: UILayout, title: str | None, text: str) -> None:
    row = layout.split(factor=_LABELS)
    row.label(text=title)
    row.label(text=text)


def _draw_fact(layout: UILayout, name: str, text: str) -> None:
    """A name and its text beside it, in as many lines as it needs."""
    for index, line in enumerate(textwrap.wrap(text, _LINE) or [""]):
        row = layout.split(factor=0.3)
        row.label(text=name if index == 0 else "")
        row.label(text=line)


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_PT_sun,
        HELIFORM_PT_sun_result,
        HELIFORM_PT_sun_daylight,
        HELIFORM_PT_sun_daylight_more,
        HELIFORM_PT_sun_site,
        HELIFORM_PT_sun_now,
        HELIFORM_PT_sun_more,
    )
)
