"""Sun hours and irradiation on the receivers of a scene, over any part of a year."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

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
    weather, site = weather_of(record.site, record.weather_file, record.suns_per_hour)
    sources = sources_for(weather, site, record)
    fields = fields_of_view(scene)
    occluders = Occluders(bodies_of(scene))
    found = gather(occluders, joined(*fields), sources, part(progress, 0.05, 0.95))
    progress(0.95, "Summing the hours")
    result = maps_of(scene, fields, sources, found, record, weather.source, site)
    result.meta.update(seed=seed, seconds=time.perf_counter() - started)
    return result
