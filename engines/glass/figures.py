"""The figures of a machine profile: their units, and what each has to be."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..core.errors import ParameterError
from ..core.parameters import check_keys

UNITS: dict[str, dict[str, float]] = {
    "length": {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254},
    "speed": {"mm/s": 1e-3, "mm/min": 1e-3 / 60, "m/min": 1 / 60, "m/s": 1.0},
    "acceleration": {"mm/s²": 1e-3, "mm/s2": 1e-3, "m/s²": 1.0, "m/s2": 1.0},
    "angular rate": {"deg/s": math.pi / 180, "rad/s": 1.0, "rpm": math.pi / 30},
    "angular acceleration": {
        "deg/s²": math.pi / 180,
        "deg/s2": math.pi / 180,
        "rad/s²": 1.0,
        "rad/s2": 1.0,
    },
    "time": {"s": 1.0, "min": 60.0, "h": 3600.0},
    "flow": {"mm³/s": 1e-9, "mm3/s": 1e-9, "cm³/min": 1e-6 / 60, "cm3/min": 1e-6 / 60, "m³/s": 1.0},
    "density": {"kg/m³": 1.0, "kg/m3": 1.0, "g/cm³": 1000.0, "g/cm3": 1000.0},
    "mass": {"kg": 1.0, "g": 1e-3},
    "angle": {"deg": math.pi / 180, "rad": 1.0},
    "share": {"": 1.0, "%": 0.01},
}
"""The units that a figure of each kind may have, with what takes them to SI."""

FIGURES = {
    "layer_height_min": "length",
    "layer_height_max": "length",
    "width_min": "length",
    "width_max": "length",
    "speed_min": "speed",
    "speed_max": "speed",
    "acceleration_max": "acceleration",
    "rotary_rate_max": "angular rate",
    "rotary_acceleration_max": "angular acceleration",
    "turn_time_min": "time",
    "turn_time_max": "time",
    "time_max": "time",
    "flow": "flow",
    "flow_min": "flow",
    "flow_max": "flow",
    "density": "density",
    "charge": "mass",
    "reach_x": "length",
    "reach_y": "length",
    "reach_z": "length",
    "bed_x": "length",
    "bed_y": "length",
    "origin_x": "length",
    "origin_y": "length",
    "overhang_max": "angle",
    "overlap_min": "share",
    "filament_diameter": "length",
}
"""Every figure of a profile and its kind. Heights, widths and flow are those of a bead; a turn's
time is what passes until the nozzle is above the same place again; ``time_max`` and ``charge``
bound one print; ``origin`` is where the piece's axis stands in the machine's own coordinates;
``overlap_min`` is the share of a bead that must lie on the bead below."""

NO_LIMITS = {"flow", "density", "origin_x", "origin_y", "filament_diameter"}
"""The figures that bound nothing."""

_ROTARY = {"rotary_rate_max", "rotary_acceleration_max"}
_MAY_BE_NEGATIVE = {"origin_x", "origin_y"}
_MAY_BE_ZERO = {"speed_min", "turn_time_min", "flow_min", "overlap_min", *_MAY_BE_NEGATIVE}
_RANGES = ("layer_height", "width", "speed", "turn_time", "flow")


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure as its profile states it, with where it is from.

    ``confirmed`` is False for what was assumed or recalled: it is shown as unconfirmed.
    """

    name: str
    value: float
    unit: str
    source: str
    confirmed: bool

    @property
    def si(self) -> float:
        """The value in SI units, radians for angles."""
        return self.value * UNITS[FIGURES[self.name]][self.unit]

    @property
    def said(self) -> str:
        """The source as a person reads it, “unconfirmed” with it where it is."""
        return self.source if self.confirmed else f"{self.source}; unconfirmed"


def figures_of(
    given: Mapping[str, Any], axes: str, extrusion: str, where: str
) -> dict[str, Figure]:
    """The figures in a profile's table, those that its machine has no use for left out or not.

    Raises ParameterError, naming ``where``, for one that is unknown, missing or impossible.
    """
    check_keys(given, FIGURES, f"{where} figures")
    needed = set(FIGURES)
    if axes == "three":
        needed -= _ROTARY
    if extrusion != "relative":
        needed.discard("filament_diameter")
    for name in FIGURES:
        if name in needed and name not in given:
            raise ParameterError(
                f"[{where} figures] has no {name}; add [figures.{name}] with value, unit, source "
                "and confirmed."
            )
    figures = {name: _figure(name, given[name], where) for name in FIGURES if name in given}
    _check_ranges(figures, where)
    return figures


def table_in(table: Mapping[str, Any], key: str, where: str) -> Mapping[str, Any]:
    """The table under ``key``. Raises ParameterError where there is none."""
    value = table.get(key)
    if not isinstance(value, Mapping):
        raise ParameterError(f"[{where}] {key} should be a table: [{key}].")
    return value


def text_in(table: Mapping[str, Any], key: str, where: str, required: bool = False) -> str:
    """The line of text under ``key``, "" where there is none and that may be. Raises likewise."""
    value = table.get(key, "")
    if not isinstance(value, str) or not value.isprintable():
        raise ParameterError(f"[{where}] {key} = {value!r} should be a line of text.")
    if required and not value.strip():
        raise ParameterError(f"[{where}] has no {key}; say it in a line of text.")
    return value


def _figure(name: str, table: Any, where: str) -> Figure:
    where = f"{where} figures.{name}"
    if not isinstance(table, Mapping):
        raise ParameterError(f"[{where}] should be a table of value, unit, source and confirmed.")
    check_keys(table, ("value", "unit", "source", "confirmed"), where)
    value, unit = table.get("value"), text_in(table, "unit", where)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ParameterError(f"[{where}] value = {value!r} should be a number.")
    kind = FIGURES[name]
    if unit not in UNITS[kind]:
        known = ", ".join(f"“{u}”" for u in UNITS[kind])
        raise ParameterError(
            f"[{where}] unit = {unit!r} is no unit of {kind}; take one of {known}."
        )
    if value < 0 and name not in _MAY_BE_NEGATIVE:
        raise ParameterError(f"[{where}] value = {value!r} is negative; give it as it is measured.")
    if value == 0 and name not in _MAY_BE_ZERO:
        raise ParameterError(f"[{where}] value = {value!r} should be above zero.")
    confirmed = table.get("confirmed", False)
    if not isinstance(confirmed, bool):
        raise ParameterError(f"[{where}] confirmed = {confirmed!r} should be true or false.")
    source = text_in(table, "source", where, required=True)
    return Figure(name, float(value), unit, source, confirmed)


def _check_ranges(figures: Mapping[str, Figure], where: str) -> None:
    for name in _RANGES:
        low, high = figures[f"{name}_min"], figures[f"{name}_max"]
        if low.si > high.si:
            raise ParameterError(
                f"[{where} figures] {low.name} of {low.value:g} {low.unit} is above {high.name} of "
                f"{high.value:g} {high.unit}; exchange them."
            )
    if not figures["flow_min"].si <= figures["flow"].si <= figures["flow_max"].si:
        raise ParameterError(
            f"[{where} figures] flow is not between flow_min and flow_max; correct one of them."
        )
    if figures["overhang_max"].si >= math.pi / 2:
        raise ParameterError(f"[{where} figures] overhang_max should be below 90 degrees.")
    if figures["overlap_min"].si > 1:
        raise ParameterError(f"[{where} figures] overlap_min is a share and at most 1, or 100 %.")
