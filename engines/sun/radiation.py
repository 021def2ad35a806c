"""Sun hours and irradiation on the receivers of a scene, over any part of a year."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import VERSION
from ..core.atlas import texels
from ..core.errors import SceneError
from ..core.parameters import nested, param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Receiver, Scene, Surface, Vector
from .gathering import Gathered, gather, unobstructed
from .maps import SunMap, SunMaps, figures_of, quantities_of
from .occlusion import Occluders, bodies_of
from .periods import Period, period_text
from .sensors import Sensors, joined, of_receiver
from .site import Site
from .weights import Sources, sources_of, weather_of

_DOWN = -0.5  # the mean of a receiver's normals, below which it is said to look down


@dataclass(frozen=True, slots=True, kw_only=True)
class Radiation:
    """Where and when, and how finely sun and sky are divided."""

    site: Site = nested(Site, "Where the model stands and which way it is turned")  # noqa: RUF009
    weather_file: str = param("", help="EPW, TMY3, NSRDB or PVGIS; empty: a cloudless year")
    period: Period = nested(Period, "Part of the year that counts")  # noqa: RUF009
    subdivision: int = param(2, "", 1, 4, "The sky has 144 times this squared patches and one")
    accuracy: float = param(
        1.0, "deg", 0.0, 30.0, "Suns this near to one another are traced as one; 0: every sun"
    )
    suns_per_hour: int = param(
        1, "", 1, 12, "Parts that each of the weather's intervals is cut into; more for single days"
    )
    ground_reflectance: float = param(
        0.2, "", 0.0, 1.0, "Share of light that the open ground returns"
    )
    open: bool = param(True, help="Also what there would be without any building")


def study_radiation(
    scene: Scene, record: Radiation, *, seed: int = 0, progress: Progress = SILENT
) -> SunMaps:
    """The maps of sun hours and of direct, diffuse and total irradiation of every receiver.

    Each texel gathers what its middle sees of the suns of every interval, of the sky after Perez
    in patches, and of the ground around; bodies and receivers block, panes let part of it through.
    Nothing here is random: ``seed`` only goes into the result.

    Raises SceneError for a scene without a receiver, or with a body or a receiver that has no
    faces; ParameterError, FileError as `weather_of` and `sources_of`; RuntimeMissing; Cancelled.
    """
    started = time.perf_counter()
    progress(0.0, "Reading the weather")
    sources, source, site = light_of(record)
    parts = sensors_in(scene)
    occluders = Occluders(bodies_of(scene))
    found = gather(occluders, joined(*parts), sources, part(progress, 0.05, 0.9))
    progress(0.9, "Summing the hours")
    maps, arriving = maps_of(scene, parts, sources, found, record)
    hourly = course_of(sources, arriving)
    meta = meta_of(record, site, source, sources, [*found.notes, *looking_down(scene, parts)])
    meta |= {"figures": figures_of(maps), "quantities": quantities_of(maps), "seed": seed}
    meta["seconds"] = time.perf_counter() - started
    return SunMaps(maps, sources.times, hourly, meta)


def light_of(record: Radiation) -> tuple[Sources, str, Site]:
    """The period's light, what the weather is from, and where that is."""
    weather, site = weather_of(record.site, record.weather_file, record.suns_per_hour)
    sources = sources_of(
        weather,
        site,
        record.period,
        subdivision=record.subdivision,
        accuracy=record.accuracy,
        ground_reflectance=record.ground_reflectance,
    )
    return sources, weather.source, site


def sensors_in(scene: Scene) -> tuple[Sensors, ...]:
    """The sensors of each of a scene's receivers. Raises SceneError where there are none."""
    if not scene.receivers:
        raise SceneError("Nothing is measured: add a receiver, a plane or a mesh, to the scene.")
    return tuple(sensors_on(receiver) for receiver in scene.receivers)


def maps_of(
    scene: Scene,
    parts: Sequence[Sensors],
    sources: Sources,
    found: Gathered,
    record: Radiation,
) -> tuple[tuple[SunMap, ...], dict[str, Vector]]:
    """The maps of each receiver; and of each kind, "built" and "open", `Gathered.means` (D,).

    ``parts``: the sensors of each receiver, those of all of them in ``found`` in this order.
    """
    values = {
        "sun_hours": found.hours,
        "direct": found.direct,
        "diffuse": found.diffuse,
        "total": found.direct + found.diffuse,
    }
    means = {"built": found.means}
    if record.open:
        free, means["open"] = unobstructed(joined(*parts), sources)
        values["open"] = free
        lit = free > 0
        kept = np.divide(values["total"], free, out=np.full_like(free, np.nan), where=lit)
        values["shading"] = 1 - kept
    ends = np.cumsum([len(part) for part in parts])
    maps = []
    for receiver, sensors, end in zip(scene.receivers, parts, ends.tolist(), strict=True):
        rows = slice(end - len(sensors), end)
        own = {n: sensors.spread(v[rows].astype(np.float32)) for n, v in values.items()}
        maps.append(SunMap(receiver.name, own, _areas(receiver, sensors)))
    return tuple(maps), means


def course_of(sources: Sources, means: dict[str, Vector]) -> dict[str, Vector]:
    """The hourly means (T,) over the sensors in W/m², of what `maps_of` found to arrive."""
    direct, diffuse = sources.course(np.stack(list(means.values()), axis=1))
    hourly = {"direct": direct[:, 0], "diffuse": diffuse[:, 0]}
    if "open" in means:
        hourly["open"] = direct[:, 1] + diffuse[:, 1]
    return hourly


def meta_of(
    record: Radiation, site: Site, source: str, sources: Sources, notes: Sequence[str]
) -> dict[str, Any]:
    """What is known of a result but for its figures, its seed and how long it took."""
    return {
        "kind": "radiation",
        "parameters": to_table(record),
        "site": to_table(site),
        "source": source,
        "period": period_text(record.period),
        "suns": len(sources.suns.directions),
        "patches": len(sources.patches.directions),
        "directions": len(sources.directions),
        "accuracy": float(np.degrees(sources.suns.accuracy)),
        "notes": list(dict.fromkeys([*sources.notes, *notes])),
        "version": VERSION,
    }


def looking_down(scene: Scene, parts: Sequence[Sensors]) -> list[str]:
    """A sentence on each receiver whose only side looks down, as with reversed normals."""
    return [
        f"“{receiver.name}” looks down, away from sun and sky; if it should not, turn its normals."
        for receiver, sensors in zip(scene.receivers, parts, strict=True)
        if receiver.sides == "front" and sensors.normals[:, 2].mean() < _DOWN
    ]


def sensors_on(receiver: Receiver | Surface) -> Sensors:
    covered = None if isinstance(receiver, Receiver) else texels(receiver)
    sensors = of_receiver(receiver, covered)
    if not len(sensors):
        raise SceneError(f"Receiver “{receiver.name}” has no area to measure on; give it faces.")
    return sensors


def _areas(receiver: Receiver | Surface, sensors: Sensors) -> NDArray[np.float32]:
    """What each texel stands for (rows, columns), 0 where there is no sensor."""
    areas = sensors.spread(sensors.areas.astype(np.float32), 0.0)
    return areas if receiver.sides == "front" else areas[0]
