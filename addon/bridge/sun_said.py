"""What is said of a study of sun and sky beside its maps: its settings, its legend, its notes."""

import textwrap
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy

from ...engines.core.colour import Display
from ...engines.core.errors import HeliformError
from ...engines.core.parameters import from_table, to_table
from ...engines.sun import Daylight, Radiation
from ...engines.sun.periods import Period, period_text
from ..properties import parameters, read
from ..sun_place import site_of

_WIDE = 32  # letters in a line of a legend
_MOST = 3  # names in a note


def asked(scene: bpy.types.Scene, record: type) -> Any:
    """The scene's record; place and weather are one for all studies of sun and sky.

    The weather file is named by its whole path.
    """
    file = parameters(scene, Radiation).weather_file
    whole = file and bpy.path.abspath(file)
    return replace(parameters(scene, record), site=site_of(scene), weather_file=whole)


def display_of(scene: bpy.types.Scene) -> Display:
    """How a study's files are drawn: in the scene's palette, on a linear scale."""
    return Display(palette=read(scene.heliform.sun_display, Display).palette, log=False)


def is_stale(scene: bpy.types.Scene, facts: dict[str, Any]) -> bool:
    """Whether settings that the study depends on are others now; what moved is not looked at."""
    record = Daylight if facts["kind"] == "daylight" else Radiation
    try:
        now = _counting(to_table(asked(scene, record)), facts)
        return now != _counting(facts["asked"], facts)
    except (HeliformError, KeyError):  # of another version
        return True


def _counting(table: dict[str, Any], facts: dict[str, Any]) -> dict[str, Any]:
    """What of a record's table a result depends on."""
    file = table["weather_file"] and str(Path(table["weather_file"]).absolute())
    counts = table | {"weather_file": file}
    counts["period"] = period_text(from_table(Period, table["period"], "period"))
    if file:
        counts["site"] = table["site"]["north"]
    if not table.get("blinds"):
        counts.pop("blinds_transmittance", None)
    if facts["live"]:  # takes a coarser sky
        del counts["subdivision"]
    return counts


def footing(facts: dict[str, Any], live: bool) -> list[str]:
    """The last lines of the legend: when, where, and whether that is what is set now."""
    said = [facts["period"], place(facts)]
    if facts["stale"]:
        said.append("of earlier settings")
    if facts["live"] and not live:
        said.append("live, coarse: press Study Sun")
    elif facts["footing"]:
        said.append(facts["footing"])
    return [line for text in said for line in textwrap.wrap(text, _WIDE)]


def place(facts: dict[str, Any]) -> str:
    """Where a study is of, its weather and which way the model is turned, in few words."""
    weather = facts["facts"]["Weather"] if facts["asked"]["weather_file"] else "cloudless"
    north = facts["asked"]["site"]["north"]
    turned = f", +Y at {north:g}°" if north else ""
    return f"{facts['facts']['Place']}, {weather}{turned}"


def hidden_notes(layer: bpy.types.ViewLayer) -> tuple[str, ...]:
    """A sentence on the bodies and receivers that are on but hidden, so that nothing meets them."""
    hidden = [
        obj.name
        for obj in layer.objects
        if obj.heliform.role in ("BODY", "RECEIVER")
        and obj.heliform.on
        and not obj.visible_get(view_layer=layer)
    ]
    names = [f"“{name}”" for name in sorted(hidden)]
    if not names:
        return ()
    more = [f"{len(names) - _MOST} more"] * (len(names) > _MOST)
    *first, last = [*names[:_MOST], *more]
    said = f"{', '.join(first)} and {last}" if first else last
    return (f"{said} {'is' if len(names) == 1 else 'are'} hidden and left out.",)
