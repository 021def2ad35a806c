"""The figures of a daylight study: LM-83, EN 17037 and how sure they are."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from . import blinds, en17037, metrics
from .illuminance import Course
from .interior import Interior
from .maps import SunMap, figures_of
from .openings import reference_points
from .probing import told_open
from .summing import Year
from .times import moment
from .words import share_text

_WORKING = (8.0, 18.0)
_TRIFLE = 0.005  # of the light
_WHOLE = 360
"""Days of weather from which on they are a year's."""


class Asked(Protocol):
    """What of a `daylight.Daylight` the figures depend on."""

    @property
    def period(self) -> Any: ...
    @property
    def target(self) -> float: ...
    @property
    def ground_reflectance(self) -> float: ...
    @property
    def exposure_month(self) -> int: ...
    @property
    def exposure_day(self) -> int: ...
    @property
    def lowest_sun(self) -> float: ...


type Put = Callable[[str, float, str], None]


def is_annual(course: Course, asked: Asked) -> bool:
    """Whether LM-83's and EN 17037's figures can be told: of a year, and of weather for it all."""
    return asked.period.span == "year" and _days(course) >= _WHOLE


def exposure_date(course: Course, asked: Asked) -> tuple[int, int, int]:
    """Year, month and day on which EN 17037's sunlight is counted, in the weather's own year.

    Raises ParameterError for a day that there is not.
    """
    year = int(str(course.times[len(course.times) // 2])[:4])
    date = (year, asked.exposure_month, asked.exposure_day)
    moment(*date, 12.0, course.dome.site)
    return date


def daylight_figures(
    maps: tuple[SunMap, ...],
    rooms: tuple[Interior, ...],
    course: Course,
    years: tuple[Year, ...],
    asked: Asked,
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Name → value and unit, and the sentences that belong to them.

    ``rooms`` and ``years`` are of one receiver each, as ``maps``; so are the figures, under
    “receiver.” where there are several. LM-83's and EN 17037's are of its front alone, and only
    there where `is_annual`.
    """
    figures = figures_of(maps)
    notes: list[str] = []
    annual = is_annual(course, asked)
    if annual:
        notes += _unlike(course, asked, any(room.veiled for room in rooms))
    elif asked.period.span == "year":
        notes.append(
            f"The weather is of {_days(course)} days, so the figures of LM-83 and EN 17037, which "
            "are of a year, are left out; take a file of a whole year."
        )
    for one, room, year in zip(maps, rooms, years, strict=True):
        prefix = f"{one.receiver}." if len(maps) > 1 else ""

        def put(name: str, value: float, unit: str, prefix: str = prefix) -> None:
            figures[prefix + name] = {"value": value, "unit": unit}

        for name, error in year.errors.items():
            put(f"error_{name}", 100 * error, "%")
        put("given_up", 100 * year.given_up, "%")
        notes.append(_said(year, f" on “{one.receiver}”" if prefix else ""))
        if annual:
            _autonomy(put, room, course, year, asked)
            _provision(put, room, year)
            notes += _exposure(put, one.receiver, room, course, asked)
    return figures, notes


def told_below(name: str, room: Interior, asked: Asked) -> tuple[str, ...]:
    """A sentence where the open ground's light comes up through a receiver's ``room``."""
    if not asked.ground_reflectance:
        return ()
    return told_open(name, room.occluders, room.sensors.some(room.front))


def _days(course: Course) -> int:
    return len(np.unique(course.times.astype("datetime64[D]")))


def _unlike(course: Course, asked: Asked, veiled: bool) -> list[str]:
    """What is not as the standards have it."""
    notes = []
    hours = (asked.period.first_hour, asked.period.last_hour)
    if hours != _WORKING or asked.target != metrics.TARGET:
        notes.append("LM-83 asks for 300 lx from 8 to 18 h; this is for other values.")
    if veiled:
        notes.append(
            f"Blinds close where sun through panes gives more than {metrics.SUNNY:g} lx to more "
            f"than {100 * blinds.MOST_AREA:g} % of a receiver, all of them at once; LM-83 closes "
            "those of one façade at a time."
        )
    if not (2, 1) <= exposure_date(course, asked)[1:] <= (3, 21):
        notes.append("EN 17037 counts sunlight on a day from 1 February to 21 March.")
    return notes


def _autonomy(put: Put, room: Interior, course: Course, year: Year, asked: Asked) -> None:
    front, bare = room.front, "" if room.veiled else "_without_blinds"
    areas, values = room.sensors.areas[front], year.values
    share = metrics.spatial_autonomy(values["daylight_autonomy"][front] / 100, areas)
    put(f"sda_{asked.target:g}_50{bare}", 100 * share, "%")
    sunny = metrics.sunlight_exposure(values["direct_hours"][front], areas)
    put("ase_1000_250", 100 * sunny, "%")
    if room.veiled:
        put("blinds_closed", float(course.hours[year.closed].sum()), "h")


def _provision(put: Put, room: Interior, year: Year) -> None:
    found = en17037.provision(year.reached[room.front], room.sensors.areas[room.front])
    put("en17037_level", found.level, "")
    for limit, share in zip(en17037.TARGET, found.target, strict=True):
        put(f"en17037_target_{limit:g}", 100 * share, "%")
    for limit, share in zip(en17037.LEAST, found.least, strict=True):
        put(f"en17037_least_{limit:g}", 100 * share, "%")


def _exposure(put: Put, name: str, room: Interior, course: Course, asked: Asked) -> list[str]:
    """EN 17037's sunlight, at the pane that has most of it."""
    points = reference_points(
        room.around.soup.bodies, room.occluders, room.sensors.some(room.front)
    )
    if points is None:
        return [
            f"No pane gives on to “{name}”, so EN 17037's hours of sunlight, which are of a point "
            "behind one, are left out."
        ]
    date = exposure_date(course, asked)
    sun = en17037.sunlight_hours(room.occluders, points, course.dome.site, date, asked.lowest_sun)
    put("en17037_sunlight_hours", float(sun.max()), "h")
    put("en17037_sunlight_level", en17037.sunlight_level(float(sun.max())), "")
    return []


def _said(year: Year, where: str) -> str:
    error, paths = year.errors, f"From up to {year.paths:,} paths a sensor"
    if not error["illuminance"]:
        return f"{paths} none{where} has found light; what little there may be is not told from 0."
    text = (
        f"{paths} the mean illuminance{where} is good to {share_text(error['illuminance'])}, the "
        f"daylight factor to {share_text(error['daylight_factor'])}"
    )
    hour = f", a single hour to {share_text(error['hour'])}" if "hour" in error else ""
    return f"{text}{hour} (95 %, root mean square over the sensors)." + _given_up(year)


def _given_up(year: Year) -> str:
    """What is said where light that is reflected more often than asked is more than a trifle."""
    if year.given_up < _TRIFLE:
        return ""
    return f" Some {share_text(year.given_up)} more would come by more reflections."
