"""The Sun room: where and when, the studies, what came out, and the sun itself."""

import re
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
from . import Room
from .scene import draw_notes, draw_progress, draw_row, draw_sentence, prepare

_JOBS = ("Study Sun", "Study Daylight", "Pick Sensor")
_OF_SPAN = {
    "months": ("first_month", "last_month"),
    "dates": ("first_day", "first_month", "last_day", "last_month"),
}
_OF_MAPS = {"mean", "min", "max", "sum"}
"""How figures of maps begin; the panel has the means of the receiver that is shown."""
_WORDS = {"sda": "sDA", "ase": "ASE", "en17037": "EN 17037"}
_SHARED = {"site", "weather_file", "period"}
"""What the panel shows above, or in panels of its own."""
_HOURS = ("first_hour", "last_hour")


class HELIFORM_PT_sun(Room, Panel):
    """What sun and sky give to the receivers"""

    bl_idname = "HELIFORM_PT_sun"
    bl_label = "Sun"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """The weather, the period, the studies."""
        layout, own = self.layout, context.scene.heliform
        prepare(layout)
        layout.prop(own.radiation, "weather_file", text="Weather", placeholder="Cloudless year")
        draw_sentence(layout, sun_place.weather_problem(context.scene))
        _draw_period(layout, own.radiation.period)
        if jobs.state.running:
            draw_progress(layout)
        else:
            row = layout.row()
            row.scale_y = 1.6
            row.operator("heliform.study_sun", icon="LIGHT_SUN")
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(own, "live_sun", toggle=True, icon="REC")
        row.prop(own, "live_texels", text="Texels")
        if own.live_sun and live_sun.state.rate:
            layout.label(text=f"{live_sun.state.rate:.1f} a second", icon="TIME")
        if not runtime.choose().backend:
            draw_sentence(layout, f"Tracing is off: {runtime.choose().reason}.")
        said = {"", sun_place.weather_problem(context.scene)}
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
        draw_notes(layout, facts["notes"])


class HELIFORM_PT_sun_daylight(_Part, Panel):
    """Daylight over the year, with what bodies reflect"""

    bl_label = "Daylight"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Its hours, how far light is followed, what it is held against, and the button."""
        layout, daylight = self.layout, context.scene.heliform.daylight
        prepare(layout)
        _draw_period(layout, daylight.period)
        hidden = set() if daylight.blinds else {"blinds_transmittance"}
        draw(layout, daylight, Daylight, _SHARED | hidden)
        if jobs.state.running:
            draw_progress(layout)
        else:
            row = layout.row()
            row.scale_y = 1.4
            row.operator("heliform.study_daylight", icon="OUTLINER_OB_LIGHT")


class HELIFORM_PT_sun_site(_Part, Panel):
    """Where the model stands"""

    bl_label = "Site"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """The place; that of a weather file is its own, but for the model's north."""
        layout, radiation = self.layout, context.scene.heliform.radiation
        prepare(layout)
        if radiation.weather_file:
            layout.label(text="As the weather file says", icon="INFO")
        column = layout.column()
        column.enabled = not radiation.weather_file
        draw(column, radiation.site, Site, {"north"})
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
        column.prop(own, "sun_month")
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
        """Everything but place, weather and time; and the studies as files that run anywhere."""
        prepare(self.layout)
        draw(self.layout, context.scene.heliform.radiation, Radiation, _SHARED)
        row = self.layout.row(align=True)
        for analysis, text in ((SUN_RADIATION, "Export Study"), (SUN_DAYLIGHT, "Daylight")):
            button = row.operator("heliform.export_study", text=text, icon="EXPORT")
            button.analysis = analysis.name


def _draw_period(layout: UILayout, period: Any) -> None:
    """The span, what it needs to be said, and the hours of the day."""
    layout.prop(period, "span", text="Period")
    column = layout.column(align=True)
    if period.span.endswith("season"):
        column.prop(period, "seasons", text="Parted by")
    if period.span.endswith("season") and period.seasons == "dates":
        for name, text in (
            ("first_day", "Cooling from day"),
            ("first_month", "month"),
            ("last_day", "to day"),
            ("last_month", "month"),
        ):
            column.prop(period.cooling, name, text=text)
    for name in _OF_SPAN.get(period.span, ()):
        column.prop(period, name)
    column = layout.column(align=True)
    for name, text in zip(_HOURS, ("Hours from", "to"), strict=True):
        column.prop(period, name, text=text)


def _draw_figures(layout: UILayout, context: Context, facts: dict[str, Any]) -> None:
    """The means of each map and the figures of the active receiver, or of the first."""
    receivers = sun.staged_on(context.scene)
    shown = context.object if context.object in receivers else receivers[0]
    box = layout.box().column(align=True)
    draw_row(box, "Receiver", shown.name)
    for name, (title, unit) in facts["quantities"].items():
        draw_row(box, title, f"{_number(sun.mean_on(shown, name))} {unit}")
    names = [sun.name_in_study(receiver) for receiver in receivers]
    own = own_figures(facts["figures"], sun.name_in_study(shown), names)
    for name, figure in own.items():
        if name.partition("_")[0] not in _OF_MAPS:
            draw_row(box, _label(name), f"{_number(figure['value'])} {figure['unit']}")
    draw_row(box, "Period", facts["period"])
    draw_row(box, "Weather", facts["source"])


def own_figures(figures: dict[str, Any], receiver: str, receivers: list[str]) -> dict[str, Any]:
    """A receiver's own figures, without its name; where it is the only one, they have none."""
    longer = tuple(f"{r}." for r in receivers if r.startswith(f"{receiver}."))
    own = {
        name.removeprefix(f"{receiver}."): figure
        for name, figure in figures.items()
        if name.startswith(f"{receiver}.") and not name.startswith(longer)
    }
    return own or (figures if len(receivers) == 1 else {})


def _label(name: str) -> str:
    """“sda_300_50_without_blinds” as “sDA 300/50 without blinds”."""
    words = [_WORDS.get(word, word) for word in name.split("_")]
    text = " ".join(words)
    text = re.sub(r"(?<=[AE] )(\d+) (\d+)", r"\1/\2", text)
    return text[:1].upper() + text[1:] if not text.startswith("s") else text


def _number(value: float) -> str:
    """Three digits or more, and no exponent."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_PT_sun,
        HELIFORM_PT_sun_result,
        HELIFORM_PT_sun_daylight,
        HELIFORM_PT_sun_site,
        HELIFORM_PT_sun_now,
        HELIFORM_PT_sun_more,
    )
)
