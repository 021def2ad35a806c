"""Studies of sun and sky in words: what a figure is called, how a number reads, where and when."""

import math
import re
from collections.abc import Mapping
from typing import Any

from ..core.parameters import from_table
from .en17037 import LEVELS
from .site import Site, place_text
from .tables import QUANTITIES

_KINDS = {"mean": "", "min": ", least", "max": ", greatest", "sum": ", sum"}
_ERROR = "Error (95 %)"
_FIRST = (*_KINDS, "sda", "ase", "blinds", "en17037", "error", "given")
"""What names of figures begin with."""
_PATTERNS = (
    (r"sda_([\d.]+)_([\d.]+)_without_blinds", "LM-83", r"sDA \1/\2, no blinds"),
    (r"sda_([\d.]+)_([\d.]+)", "LM-83", r"sDA \1/\2"),
    (r"ase_([\d.]+)_([\d.]+)", "LM-83", r"ASE \1/\2"),
    (r"blinds_closed", "LM-83", "Blinds closed"),
    (r"en17037_level", "EN 17037", "Daylight level"),
    (r"en17037_target_([\d.]+)", "EN 17037", r"Target \1 lx"),
    (r"en17037_least_([\d.]+)", "EN 17037", r"Minimum \1 lx"),
    (r"en17037_sunlight_hours", "EN 17037", "Sunlight"),
    (r"en17037_sunlight_level", "EN 17037", "Sunlight level"),
    (r"error_hour", _ERROR, "Single hour"),
    (r"given_up", "", "After last bounce"),
)
_GRAVE = (
    *("lie inside", "looks down", "looks inward", "wrong side", "face away", "hidden"),
    *("never up", "deleted", "check the", "no area", "No floor", "guessed", "by its name"),
    *("named", "No body is clear glass"),
)
_THIN_SPACE = "\u2009"


def figure_words(name: str) -> tuple[str, str]:
    """What a receiver's figure of that name belongs to, "" for none, and its own title.

    “en17037_target_300” is (“EN 17037”, “Target 300 lx”), “mean_total” (“”, “Irradiation”).
    """
    kind, _, quantity = name.partition("_")
    if kind in _KINDS and quantity in QUANTITIES:
        return "", QUANTITIES[quantity][0] + _KINDS[kind]
    for pattern, group, title in _PATTERNS:
        if re.fullmatch(pattern, name):
            return group, re.sub(pattern, title, name)
    if kind == "error" and quantity in QUANTITIES:
        return _ERROR, QUANTITIES[quantity][0]
    words = name.replace("_", " ")
    return "", words[:1].upper() + words[1:]


def figure_title(name: str) -> str:
    """The same in one text, after the receiver's name where there is one: “Floor: sDA 300/50”."""
    found = re.fullmatch(rf"(?:(.*)\.)?((?:{'|'.join(_FIRST)})_.*)", name, re.DOTALL)
    receiver, own = found.groups() if found else ("", name)
    return ": ".join(filter(None, (receiver, *figure_words(own))))


def figure_text(name: str, figure: Mapping[str, Any]) -> str:
    """A figure's value with its unit: “51.2 %”, “medium”, “–” where it is not known."""
    value = figure["value"]
    if name.endswith("_level") and math.isfinite(value):
        return LEVELS[round(value)]
    return f"{number_text(value)} {figure['unit']}".strip() if math.isfinite(value) else "–"


def number_text(value: float) -> str:
    """Three digits or more and no exponent: 0.535, 1652, 51 400 with a thin space; “–” for NaN."""
    if not math.isfinite(value):
        return "–"
    if abs(value) < 999.5:
        text = f"{value:.3g}"
        return text if "e" not in text else "0"
    whole = round(value) if abs(value) < 10_000 else round(float(f"{value:.3g}"))
    return f"{whole:,}".replace(",", _THIN_SPACE) if abs(whole) >= 10_000 else str(whole)


def share_text(share: float) -> str:
    """An error or another share of two digits: “3.7 %”, “20 %”, “120 %”."""
    return f"{number_text(float(f'{100 * share:.2g}'))} %"


def facts_of(meta: Mapping[str, Any]) -> dict[str, str]:
    """Where and when a study's result is of: place, north, clock, weather and period, as texts.

    ``meta`` is that of `maps.SunMaps`, whose site, source and period these are.
    """
    site = from_table(Site, meta["site"], "site")
    north = site.north % 360
    return {
        "Place": place_text(site),
        "Elevation": f"{site.elevation:g} m",
        "Clock": _clock(site.utc_offset),
        "+Y axis": f"{north:g}°, clockwise from north" if north else "north",
        "Weather": meta["source"],
        "Period": meta["period"],
    }


def _clock(offset: float) -> str:
    minutes = round(60 * abs(offset))
    part = f":{minutes % 60:02d}" if minutes % 60 else ""
    return f"UTC{'+−'[offset < 0]}{minutes // 60}{part} all year"


def matters(note: str) -> bool:
    """Whether a note says that something may be wrong, not only how it was computed."""
    return any(word in note for word in _GRAVE)
