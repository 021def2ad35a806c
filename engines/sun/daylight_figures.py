"""The figures of a daylight study: LM-83, EN 17037 and how sure they are."""

from typing import Any, Protocol

import numpy as np

from . import blinds, en17037, metrics
from .illuminance import Course
from .interior import Interior
from .maps import SunMap, figures_of
from .summing import Year

_WORKING = (8.0, 18.0)


class Asked(Protocol):
    """What of a `daylight.Daylight` the figures depend on."""

    @property
    def period(self) -> Any: ...
    @property
    def target(self) -> float: ...
    @property
    def exposure_month(self) -> int: ...
    @property
    def exposure_day(self) -> int: ...
    @property
    def lowest_sun(self) -> float: ...


def daylight_figures(
    maps: tuple[SunMap, ...],
    interior: Interior,
    course: Course,
    year: Year,
    asked: Asked,
    annual: bool,
) -> tuple[dict[str, dict[str, Any]], list[str]]:
    """Name → value and unit, and the sentences that belong to them.

    LM-83's and EN 17037's are only there where the period is of a whole year, ``annual``. They are
    of all receivers together.
    """
    figures = figures_of(maps)
    notes = []
    areas, values = interior.sensors.areas, year.values

    def put(name: str, value: float, unit: str) -> None:
        figures[name] = {"value": value, "unit": unit}

    for name, error in year.errors.items():
        put(f"error_{name}", 100 * error, "%")
    notes.append(_said(year))
    if annual:
        bare = "" if interior.veiled else "_without_blinds"
        share = metrics.spatial_autonomy(values["daylight_autonomy"] / 100, areas)
        put(f"sda_{asked.target:g}_50{bare}", 100 * share, "%")
        sunny = metrics.sunlight_exposure(values["direct_hours"], areas)
        put("ase_1000_250", 100 * sunny, "%")
        hours = (asked.period.first_hour, asked.period.last_hour)
        if hours != _WORKING or asked.target != metrics.TARGET:
            notes.append("LM-83 asks for 300 lx from 8 to 18 h; this is for other values.")
        if interior.veiled:
            put("blinds_closed", float(course.hours[year.closed].sum()), "h")
            notes.append(
                f"All blinds close where the sun gives more than {metrics.SUNNY:g} lx to more than "
                f"{100 * blinds.MOST_AREA:g} % of all receivers, and move together."
            )
        _provision(put, year, areas)
        date = (int(str(course.times[0])[:4]), asked.exposure_month, asked.exposure_day)
        sun = en17037.sunlight_hours(
            interior.occluders, interior.sensors, course.dome.site, date, asked.lowest_sun
        )
        most = float(sun.max(initial=0.0))
        put("en17037_sunlight_hours", most, "h")
        put("en17037_sunlight_level", en17037.sunlight_level(most), "")
        if not (2, 1) <= date[1:] <= (3, 21):
            notes.append("EN 17037 counts sunlight on a day from 1 February to 21 March.")
    return figures, notes


def _provision(put: Any, year: Year, areas: np.ndarray) -> None:
    found = en17037.provision(year.reached, areas)
    put("en17037_level", found.level, "")
    for limit, share in zip(en17037.TARGET, found.target, strict=True):
        put(f"en17037_target_{limit:g}", 100 * share, "%")
    for limit, share in zip(en17037.LEAST, found.least, strict=True):
        put(f"en17037_least_{limit:g}", 100 * share, "%")


def _said(year: Year) -> str:
    error = year.errors
    text = (
        f"From up to {year.paths:,} paths a sensor the mean illuminance is good to "
        f"{100 * error['illuminance']:.2g} %, the daylight factor to "
        f"{100 * error['daylight_factor']:.2g} %"
    )
    hour = f", a single hour to {100 * error['hour']:.2g} %" if "hour" in error else ""
    return f"{text}{hour} (95 %, root mean square over the sensors)."
