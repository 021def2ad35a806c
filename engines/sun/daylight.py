"""Daylight on the receivers of a scene over a year, with what bodies reflect."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import VERSION
from ..core.parameters import nested, param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Scene
from .annual import light_at
from .daylight_figures import daylight_figures, exposure_date, is_annual, told_below
from .dome import Dome
from .hidden import unlit
from .illuminance import Course, course_of
from .interior import Interior
from .maps import SunMap, SunMaps, quantities_of
from .metrics import Light
from .outdoors import Outdoors
from .periods import Period, period_text, season_notes, selected
from .position import sun_position
from .receivers import looking_down, map_of, sensors_in
from .rooms import mean_course, nearest, rooms_of, told_of, years_of
from .sensors import Sensors
from .site import Site
from .sky_matrix import require_size
from .summing import Year
from .surroundings import is_shiny
from .weather import Weather
from .weights import weather_of
from .words import facts_of


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkingHours(Period):
    """Part of a year by the site's standard time; by default from 8 to 18 h, as LM-83 asks."""

    first_hour: float = param(
        8.0, "h", 0.0, 24.0, "Hour from which on it counts, by standard time all year"
    )
    last_hour: float = param(
        18.0, "h", 0.0, 24.0, "Hour up to which, by standard time; before the first, overnight"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Daylight(Outdoors):
    """Where and when, how far light is followed, and what it is held against."""

    period: WorkingHours = nested(WorkingHours, "Part of the year that counts")  # noqa: RUF009
    subdivision: int = param(2, "", 1, 4, "The sky has 144 times this squared patches and one")
    bounces: int = param(4, "", 0, 16, "Reflections after which light is given up")
    target: float = param(300.0, "lx", 1.0, 1e5, "Illuminance to be reached, of the autonomies")
    blinds: bool = param(False, help="Panes have blinds, closed by the hour as LM-83 has it")
    blinds_transmittance: float = param(
        0.05, "", 0.0, 1.0, "Share of light that closed blinds let through, scattered"
    )
    error: float = param(
        0.02,
        "",
        0.001,
        1.0,
        "95 % half-width ÷ mean of the mean light of sky and reflections",
    )
    paths: int = param(131_072, "", 2048, 10_000_000, "Paths to follow from a sensor at most")
    exposure_month: int = param(3, "", 1, 12, "Month of the day on which sunlight is counted")
    exposure_day: int = param(21, "", 1, 31, "The day, 1 February to 21 March by EN 17037")
    lowest_sun: float = param(10.0, "deg", 0.0, 89.0, "Altitude from which that sunlight counts")


def study_daylight(
    scene: Scene, record: Daylight, *, seed: int = 0, progress: Progress = SILENT
) -> SunMaps:
    """The maps of illuminance and of its metrics over a year on every receiver.

    Bodies block, return and let through light as their materials say; receivers that reflect do so
    as matte surfaces, and those that do not are mere planes to measure on. With blinds, all that
    goes by the hour is with them, but for the hours of direct sun, which are without as LM-83 asks.
    Each receiver is a place by itself: its sun closes its blinds, and it has figures of its own.

    Raises SceneError for a scene without a receiver, or with a body or a receiver that has no
    faces; ParameterError and FileError as `weather_of`, `selected` and `course_of` do;
    RuntimeMissing; Cancelled.
    """
    started = time.perf_counter()
    progress(0.0, "Reading the weather")
    course, counted, source = light_of(record)
    if is_annual(course, record):
        exposure_date(course, record)
    parts = sensors_in(scene)
    rooms = rooms_of(scene, parts, record)
    years = years_of(rooms, course, counted, record, seed, part(progress, 0.05, 1.0))
    maps = _maps(scene, parts, years)
    figures, said = daylight_figures(maps, rooms, course, years, record)
    notes = [*course.notes, *season_notes(record.period, course.dome.site)]
    notes += [*told_of(scene, rooms, years), *_notes(scene, record, rooms), *said]
    factors = np.concatenate([year.values["daylight_factor"] for year in years])
    notes += unlit(rooms[0].occluders, scene.receivers, parts, factors)
    meta: dict[str, Any] = {
        "kind": "daylight",
        "parameters": to_table(record),
        "site": to_table(course.dome.site),
        "source": source,
        "period": period_text(record.period, course.times[counted], course.dome.site),
        "suns": len(course.suns.directions),
        "patches": course.dome.count - 1,
        "accuracy": float(np.degrees(course.suns.accuracy)),
        "paths": max(year.paths for year in years),
        "notes": list(dict.fromkeys([*notes, *looking_down(scene, parts)])),
        "version": VERSION,
        "figures": figures,
        "quantities": quantities_of(maps),
        "seed": seed,
        "seconds": time.perf_counter() - started,
    }
    meta["facts"] = facts_of(meta)
    mean = mean_course(rooms, years)[counted]
    return SunMaps(maps, course.times[counted], {"illuminance": mean}, meta)


def illuminance_at(
    scene: Scene,
    record: Daylight,
    sensors: Sensors,
    *,
    seed: int = 0,
    progress: Progress = SILENT,
) -> tuple[NDArray[np.datetime64], Light]:
    """The period's intervals (T,), UTC, and the illuminance (N, T) of a few sensors in lx.

    For a picked place's hours. Blinds close as they do for the receiver that is nearest to them.
    Raises what `study_daylight` does.
    """
    course, counted, _ = light_of(record)
    course = course.some(counted)
    parts = sensors_in(scene)
    room = nearest(rooms_of(scene, parts, record), sensors)
    return course.times, light_at(room, course, sensors, record, seed, progress)


def light_of(record: Daylight) -> tuple[Course, NDArray[np.bool_], str]:
    """The daylight that is needed, which of its T intervals the period counts, and its source.

    Over a whole year the hours of daylight are among them, which EN 17037 is about.
    """
    weather, site = weather_of(record.site, record.weather_file)
    counted = selected(weather, record.period, site)
    mask = counted | _up(weather, site) if record.period.span == "year" else counted
    dome = Dome(record.subdivision, site)
    require_size(dome.count, int(np.count_nonzero(mask)))
    course = course_of(
        weather,
        site,
        dome,
        mask,
        accuracy=record.accuracy,
        ground_reflectance=record.ground_reflectance,
    )
    return course, counted[mask], weather.source


def _up(weather: Weather, site: Site) -> NDArray[np.bool_]:
    """In which intervals (T,) the sun is up in the middle."""
    air: dict[str, Any] = {"pressure": weather.pressure, "temperature": weather.temperature}
    return sun_position(weather.times, site, **air).direction[:, 2] > 0


def _maps(scene: Scene, parts: tuple[Sensors, ...], years: tuple[Year, ...]) -> tuple[SunMap, ...]:
    each = zip(scene.receivers, parts, years, strict=True)
    return tuple(map_of(receiver, sensors, year.values) for receiver, sensors, year in each)


def _notes(scene: Scene, record: Daylight, rooms: tuple[Interior, ...]) -> list[str]:
    """What a reader must know of how light was followed."""
    notes = []
    planes = [
        (r.name, room) for r, room in zip(scene.receivers, rooms, strict=True) if not r.reflectance
    ]
    if planes:
        names = ", ".join(f"“{name}”" for name, _ in planes)
        does = "measures and blocks" if len(planes) == 1 else "measure and block"
        notes.append(f"{names} only {does} no light; give a floor or a roof its reflectance.")
        notes += [note for plane in planes for note in told_below(*plane, record)]
    if record.ground_reflectance:
        notes.append(
            f"The ground is level, returns {100 * record.ground_reflectance:g} % of the light "
            "evenly and is nowhere shaded."
        )
    if record.bounces:
        shiny = any(is_shiny(body.material) for body in scene.bodies)
        width = f"{12 / record.subdivision:g}° wide"
        notes.append(
            f"Light is given up after {record.bounces} reflections; over long periods what "
            "surfaces scatter of the sun comes from suns up to 6° around it"
            + (f", and mirrors show it on the sky's patches, {width}." if shiny else ".")
        )
    if record.blinds and not rooms[0].veiled:
        notes.append("No body is clear glass, so there are no blinds to close.")
    return notes
