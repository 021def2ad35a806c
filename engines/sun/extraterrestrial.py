"""What sunlight reaches the air."""

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector

SOLAR_CONSTANT = 1367.0
"""In W/m² [WMO 1981], by which Reindl's and Erbs's correlations were fitted."""


def extraterrestrial(
    times: NDArray[np.datetime64], solar_constant: float = SOLAR_CONSTANT
) -> Vector:
    """Irradiance (T,) in W/m² normal to the sun outside the air at ``times`` [Spencer 1971]."""
    days = times.astype("datetime64[D]") - times.astype("datetime64[Y]").astype("datetime64[D]")
    angle = 2.0 * np.pi * days.astype(np.float64) / 365.0
    eccentricity = (
        1.00011
        + 0.034221 * np.cos(angle)
        + 0.00128 * np.sin(angle)
        + 0.000719 * np.cos(2.0 * angle)
        + 0.000077 * np.sin(2.0 * angle)
    )
    return solar_constant * eccentricity
