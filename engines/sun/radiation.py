"""Sun hours and irradiation on the receivers of a scene, over any part of a year."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import VERSION
from ..core.parameters import nested, param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Scene, Vector
from .gathering import Free, Gathered, gather, unobstructed
from .hidden import hidden
from .maps import SunMap, SunMaps, figures_of, quantities_of
from .occlusion import Occluders, bodies_of, is_pane
from .outdoors import Outdoors
from .periods import Period, period_text
from .receivers import looking_down, map_of, sensors_in
from .reflected import Reflected, reflect
from .sensors import Sensors, joined
from .surroundings import is_shiny, returned_by
from .weights import Sources, sources_of, weather_of
from .words import facts_of, share_text


@dataclass(frozen=True, slots=True, kw_only=True)
class Radiation(Outdoors):
    """Where and when, and how finely sun and sky are divided."""

    period: Period = nested(Period, "Part of the year that counts")  # noqa: RUF009
    subdivision: int = param(4, "", 1, 4, "The sky has 144 times this squared patches and one")
    suns_per_hour: int = param(
        1, "", 1, 12, "Parts that each of the weather's intervals is cut into; more for single days"
    )
    bounces: int = param(0, "", 0, 16, "Reflections after which light is given up; 0: none")
    error: float = param(
        0.05, "", 0.001, 1.0, "95 % half-width ÷ mean of what is reflected, over the sensors"
    )


def study_radiation(
    scene: Scene, record: Radiation, *, seed: int = 0, progress: Progress = SILENT
) -> SunMaps:
    """The maps of sun hours and of direct, diffuse and total irradiation of every receiver.

    Each texel gathers what its middle sees of the suns of every interval, of the sky after Perez
    in patches, and of the ground around; bodies and receivers block, panes let part of it through.
    Only what they reflect, where there are ``bounces``, depends on the ``seed``.

    Raises SceneError for a scene without a receiver, or with a body or a receiver that has no
    faces; ParameterError, FileError as `weather_of` and `sources_of`; RuntimeMissing; Cancelled.
    """
    started = time.perf_counter()
    progress(0.0, "Reading the weather")
    sources = light_of(record)
    parts = sensors_in(scene)
    occluders = Occluders(bodies_of(scene))
    sensors = joined(*parts)
    traced = part(progress, 0.05, 0.4 if record.bounces else 0.9)
    found = gather(occluders, sensors, sources, traced)
    thrown = None
    if record.bounces:
        thrown = reflect(
            *(scene, sensors, sources, record.bounces, record.error),
            seed=seed,
            progress=part(progress, 0.4, 0.9),
        )
    progress(0.9, "Summing the hours")
    free = unobstructed(sensors, sources) if record.open else None
    maps = maps_of(scene, parts, found, free, thrown)
    hourly = course_of(sources, found.arriving, free)
    notes = notes_of(scene, occluders, parts, found)
    if thrown:
        hourly["reflected"] = thrown.course
        notes += [*thrown.notes, said_of(scene, thrown, record)]
    else:
        notes += unreflected(scene, "raise Bounces to add it")
    meta = meta_of(record, sources, notes)
    meta |= {"figures": figures_of(maps), "quantities": quantities_of(maps), "seed": seed}
    meta["seconds"] = time.perf_counter() - started
    return SunMaps(maps, sources.times, hourly, meta)


def light_of(record: Radiation) -> Sources:
    """The light of the record's period, where it says."""
    weather, site = weather_of(record.site, record.weather_file, record.suns_per_hour)
    return sources_of(
        weather,
        site,
        record.period,
        subdivision=record.subdivision,
        accuracy=record.accuracy,
        ground_reflectance=record.ground_reflectance,
    )


def maps_of(
    scene: Scene,
    parts: Sequence[Sensors],
    found: Gathered,
    free: Free | None = None,
    thrown: Reflected | None = None,
) -> tuple[SunMap, ...]:
    """The maps of each receiver; “open” and “shading” where ``free`` is known.

    ``parts``: the sensors of each receiver; those of all of them in this order are the N of
    ``found``, of ``free``, what they have `unobstructed`, and of ``thrown``.
    """
    values = {"sun_hours": found.hours, "direct": found.direct, "diffuse": found.diffuse}
    total = found.direct + found.diffuse
    if thrown:
        values["reflected"] = thrown.irradiation
        total = total + thrown.irradiation
    values["total"] = total
    if free:
        values["open"] = free.irradiation
        lit = free.irradiation > 0
        kept = np.divide(total, free.irradiation, out=np.full_like(total, np.nan), where=lit)
        values["shading"] = 100 * (1 - kept)
    ends = np.cumsum([len(part) for part in parts])
    maps = []
    for receiver, sensors, end in zip(scene.receivers, parts, ends.tolist(), strict=True):
        rows = slice(end - len(sensors), end)
        own = {name: some[rows] for name, some in values.items()}
        maps.append(map_of(receiver, sensors, own))
    return tuple(maps)


def course_of(sources: Sources, arriving: Vector, free: Free | None) -> dict[str, Vector]:
    """Direct, diffuse and open irradiance (T,) in W/m², by what is ``arriving`` (D, 3)."""
    kinds = [arriving, free.arriving] if free else [arriving]
    direct, diffuse = sources.course(np.stack(kinds))
    hourly = {"direct": direct[0], "diffuse": diffuse[0]}
    if free:
        hourly["open"] = direct[1] + diffuse[1]
    return hourly


def notes_of(
    scene: Scene, occluders: Occluders, parts: Sequence[Sensors], found: Gathered
) -> list[str]:
    """What to beware of in what the sensors of each receiver, ``parts``, have `Gathered`."""
    return [
        *found.notes,
        *looking_down(scene, parts),
        *hidden(occluders, scene.receivers, parts, found.dark),
    ]


def unreflected(scene: Scene, remedy: str) -> list[str]:
    """A sentence on what bodies reflect, and one on each ground glass, where that is left out."""
    told = [
        f"“{body.name}” is ground glass and black here, as what it scatters is left out; {remedy}."
        for body in scene.bodies
        if body.material.kind == "dielectric" and not is_pane(body.material)
    ]
    if any(returned_by(body.material)[0] > 0 for body in scene.bodies):
        mirrors = [f"“{body.name}”" for body in scene.bodies if body.material.kind == "mirror"]
        those = f", also what a mirror does ({', '.join(mirrors)})" if mirrors else ""
        told.append(f"What bodies reflect is left out{those}; {remedy}.")
    return told


def said_of(scene: Scene, thrown: Reflected, record: Radiation) -> str:
    """How well what is reflected is known."""
    told = (
        f"Light is given up after {record.bounces} reflections; what is reflected is known to "
        f"{share_text(thrown.error)} (95 %)."
    )
    if any(is_shiny(body.material) for body in scene.bodies):
        width = f"{12 / record.subdivision:g}° wide"
        told += f" In mirrors the sun is spread over the sky's patches, {width}."
    return told


def meta_of(record: Radiation, sources: Sources, notes: Sequence[str]) -> dict[str, Any]:
    """What is known of a result but for its figures, its seed and how long it took."""
    meta = {
        "kind": "radiation",
        "parameters": to_table(record),
        "site": to_table(sources.site),
        "source": sources.source,
        "period": period_text(record.period, sources.times, sources.site),
        "suns": len(sources.suns.directions),
        "patches": len(sources.patches.directions),
        "directions": len(sources.directions),
        "accuracy": float(np.degrees(sources.suns.accuracy)),
        "notes": list(dict.fromkeys([*sources.notes, *notes])),
        "version": VERSION,
    }
    return meta | {"facts": facts_of(meta)}
