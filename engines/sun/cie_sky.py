"""The CIE's standard general skies."""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..core.errors import ParameterError
from ..core.scene import Vector
from .luminance import relative_luminance
from .sky import Skies

OVERCAST = 16
"""The number of the traditional overcast sky, beside the fifteen general ones."""

NAMES = (
    "Overcast, steep gradation, even azimuth",
    "Overcast, steep gradation, slightly brighter towards the sun",
    "Overcast, moderate gradation, even azimuth",
    "Overcast, moderate gradation, slightly brighter towards the sun",
    "Uniform",
    "Partly cloudy, no gradation, slightly brighter towards the sun",
    "Partly cloudy, no gradation, brighter circumsolar region",
    "Partly cloudy, no gradation, distinct solar corona",
    "Partly cloudy, sun obscured",
    "Partly cloudy, brighter circumsolar region",
    "White-blue, distinct solar corona",
    "Clear, low turbidity",
    "Clear, polluted",
    "Cloudless, turbid, broad solar corona",
    "White-blue, turbid, broad solar corona",
    "Traditional overcast",
)
"""What the skies 1 to 16 are called."""

_TABLE = np.loadtxt(Path(__file__).parent / "data" / "cie_15469.csv", delimiter=",")


def cie_sky(kind: int, azimuth: ArrayLike = 180.0, altitude: ArrayLike = 45.0) -> Skies:
    """The T skies of one kind, for suns at ``azimuth`` and ``altitude`` (T,) in degrees.

    ``kind``: 1 to 15 of ISO 15469:2004, or 16, the traditional overcast sky of Moon and Spencer,
    (1 + 2 sin altitude) / 3 of the zenith's luminance, which the standard keeps beside them.
    Azimuth clockwise from north; kinds 1, 3, 5 and 16 are alike wherever the sun is.

    Raises ParameterError for another kind and for a sun that is not at 0° to 90°.
    """
    if kind not in range(1, OVERCAST + 1):
        raise ParameterError(f"The CIE's skies have the numbers 1 to {OVERCAST}, not {kind!r}.")
    azimuth, altitude = np.broadcast_arrays(np.atleast_1d(azimuth), np.atleast_1d(altitude))
    if not ((altitude >= 0) & (altitude <= 90)).all() or not np.isfinite(azimuth).all():
        raise ParameterError("A CIE sky needs the sun at an altitude of 0° to 90°.")
    turn, height = np.radians(azimuth.astype(float)), np.radians(altitude.astype(float))
    sun = np.stack(
        [np.sin(turn) * np.cos(height), np.cos(turn) * np.cos(height), np.sin(height)], axis=1
    )
    if kind == OVERCAST:
        gradation, indicatrix = (0.0, 0.0, 2.0), (1.0, 0.0, 0.0, 0.0)
    else:
        a, b, c, d, e = _TABLE[kind - 1]
        gradation, indicatrix = (a, b, 0.0), (1 - c * np.exp(d * np.pi / 2), c, d, e)
    every = np.ones((len(sun), 1))
    return Skies(sun, every * gradation, every * indicatrix)


def zenith_ratio(skies: Skies, directions: Vector) -> Vector:
    """The luminance (D, T) in ``directions`` (D, 3) over the zenith's, as the standard has it."""
    zenith = relative_luminance(skies, np.array([(0.0, 0.0, 1.0)]))
    return relative_luminance(skies, directions) / zenith
