"""A year's weather as arrays, whatever file it is from."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .site import Site


@dataclass(frozen=True, slots=True)
class Weather:
    """T intervals of a typical year, in order.

    ``times`` (T,) datetime64[s], UTC: the middle of each interval, in ``year`` by the site's
    standard time; ``hours`` (T,) float64: how long each is, in h. ``global_horizontal``,
    ``direct_normal``, ``diffuse_horizontal`` (T,) in W/m², means over the intervals;
    ``temperature`` (T,) in °C, ``dew_point`` (T,) in °C, ``pressure`` (T,) in Pa, NaN where
    unknown. ``site`` is the file's; ``source`` names it. ``notes``: what was missing, guessed or
    repaired.
    """

    site: Site
    year: int
    times: NDArray[np.datetime64]
    hours: Vector
    global_horizontal: Vector
    direct_normal: Vector
    diffuse_horizontal: Vector
    temperature: Vector
    dew_point: Vector
    pressure: Vector
    source: str
    notes: tuple[str, ...] = field(default=())

    @property
    def local_times(self) -> NDArray[np.datetime64]:
        """``times`` by the site's standard time, (T,) datetime64[s]."""
        return self.times + seconds(3600.0 * self.site.utc_offset)


def seconds(count: float) -> np.timedelta64:
    """A length of time in whole seconds."""
    return np.timedelta64(round(count), "s")
