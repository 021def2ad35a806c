"""How much air sunlight passes, and how much of it there is."""

import numpy as np

from ..core.scene import Vector

SEA_LEVEL = 101325.0
"""Pressure of the standard atmosphere in Pa."""


def relative_air_mass(apparent_altitude: Vector) -> Vector:
    """Air passed in zeniths of it, by apparent altitude in deg [Kasten and Young 1989].

    Below the horizon it is that at the horizon.
    """
    altitude = np.maximum(apparent_altitude, 0.0)
    return 1.0 / (np.sin(np.radians(altitude)) + 0.50572 * (altitude + 6.07995) ** -1.6364)


def standard_pressure(elevation: float) -> float:
    """Pressure in Pa at ``elevation`` in m in the standard atmosphere [ISO 2533]."""
    return SEA_LEVEL * (1.0 - 2.25577e-5 * elevation) ** 5.25588
