"""How high the sun stands in intervals of time, for what is a mean over them."""

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .position import sun_position
from .site import Site

_SAMPLES = 4
"""Instants in each interval: a sunrise hour's mean sine is then good to 0.002."""


def instants(times: NDArray[np.datetime64], hours: Vector) -> NDArray[np.datetime64]:
    """Moments (S, T) spread evenly over the T intervals of ``hours`` around ``times``, UTC."""
    steps = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5
    shifts = np.round(steps[:, None] * hours * 3600.0).astype("timedelta64[s]")
    return times.astype("datetime64[s]") + shifts


def declination(ordinal: NDArray[np.int64]) -> Vector:
    """Of the sun in deg on days counted from 1 January as 1, within 1° [Cooper 1969]."""
    return 23.45 * np.sin(2.0 * np.pi * (284.0 + ordinal) / 365.0)


def sines(times: NDArray[np.datetime64], hours: Vector, site: Site) -> tuple[Vector, Vector]:
    """Sine of the sun's true altitude in T intervals: its mean above the horizon, its highest.

    ``times`` (T,) are the intervals' middles, UTC. Below the horizon the sun counts as 0 in the
    mean (T,); the highest (T,) is negative where the sun does not rise in the interval.
    """
    moments = instants(times, hours)
    altitude = sun_position(moments.ravel(), site, refraction=False).altitude
    sine = np.sin(np.radians(altitude)).reshape(moments.shape)
    return np.maximum(sine, 0.0).mean(axis=0), sine.max(axis=0)
