"""Global horizontal irradiance split into what the sun sends straight and what the sky scatters.

A split knows no clouds: it is what a station's hours did on average. All arrays broadcast, in
W/m²; ``altitude`` in deg is the sun's true one, without refraction; ``extraterrestrial`` is normal
to the sun. Where the sun stands below ``lowest`` or what is left for it cannot be, all is diffuse.
Direct and diffuse always make up the global irradiance again.
"""

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector

LOWEST = 3.0
"""In deg: below it a sun's horizontal share is too small to divide by."""

_FLATTEST = 0.065
"""The least sine of the altitude in a clearness index, as in DISC [Maxwell 1987]."""

_REDUCED = (
    (1.020, -0.254, 0.0123),
    (1.400, -1.749, 0.177),
    (0.0, 0.486, -0.182),
)
_FULL = (
    (1.000, -0.232, 0.0239, -0.000682, 0.0195),
    (1.329, -1.716, 0.267, -0.00357, 0.106),
    (0.0, 0.426, -0.256, 0.00349, 0.0734),
)
"""Per sky (overcast, mixed, clear): what 1, the clearness index, the sine of the altitude, and in
the full correlation the temperature in °C and the relative humidity, count for."""


def split_reindl(
    global_horizontal: Vector, altitude: Vector, extraterrestrial: Vector, lowest: float = LOWEST
) -> tuple[Vector, Vector]:
    """Direct normal and diffuse horizontal irradiance by clearness and altitude.

    The reduced correlation of Reindl, Beckman and Duffie, Solar Energy 45(1), 1990, table 2; with
    ``lowest`` 5° it is that of Daysim's gen_reindl. Raises ParameterError for negative irradiance.
    """
    sine, clearness = _clearness(global_horizontal, altitude, extraterrestrial)
    fraction = _reindl(clearness, _REDUCED, (1.0, clearness, sine))
    return _shared(global_horizontal, fraction, sine, extraterrestrial, lowest)


def split_reindl_full(
    global_horizontal: Vector,
    altitude: Vector,
    extraterrestrial: Vector,
    temperature: Vector,
    humidity: Vector,
    lowest: float = LOWEST,
) -> tuple[Vector, Vector]:
    """Direct normal and diffuse horizontal irradiance by clearness, altitude, warmth and moisture.

    The full correlation of Reindl, Beckman and Duffie 1990, table 2: ``temperature`` of the air in
    °C and its relative ``humidity`` from 0 to 1. Raises ParameterError for negative irradiance.
    """
    sine, clearness = _clearness(global_horizontal, altitude, extraterrestrial)
    fraction = _reindl(clearness, _FULL, (1.0, clearness, sine, temperature, humidity))
    return _shared(global_horizontal, fraction, sine, extraterrestrial, lowest)


def split_erbs(
    global_horizontal: Vector, altitude: Vector, extraterrestrial: Vector, lowest: float = LOWEST
) -> tuple[Vector, Vector]:
    """Direct normal and diffuse horizontal irradiance by clearness alone.

    Erbs, Klein and Duffie, Solar Energy 28(4), 1982, eq. 1; it is what gendaylit -E does. Raises
    ParameterError for negative irradiance.
    """
    sine, k = _clearness(global_horizontal, altitude, extraterrestrial)
    mixed = 0.9511 - 0.1604 * k + 4.388 * k**2 - 16.638 * k**3 + 12.336 * k**4
    fraction = np.select([k <= 0.22, k <= 0.80], [1.0 - 0.09 * k, mixed], 0.165)
    return _shared(global_horizontal, fraction, sine, extraterrestrial, lowest)


def _clearness(
    global_horizontal: Vector, altitude: Vector, extraterrestrial: Vector
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if np.any(np.asarray(global_horizontal) < 0.0):
        raise ParameterError("Global irradiance below zero cannot be split; set it to zero first.")
    sine = np.sin(np.radians(altitude))
    clearness = global_horizontal / (extraterrestrial * np.maximum(sine, _FLATTEST))
    return sine, np.minimum(clearness, 1.0)


def _reindl(clearness: Vector, table: tuple[tuple[float, ...], ...], terms: tuple) -> Vector:
    overcast, mixed, clear = (
        sum(weight * term for weight, term in zip(row, terms, strict=True)) for row in table
    )
    return np.select(
        [clearness <= 0.3, clearness < 0.78],
        [np.clip(overcast, 0.1, 1.0), np.clip(mixed, 0.1, 0.97)],
        np.clip(clear, 0.1, 1.0),
    )


def _shared(
    global_horizontal: Vector,
    fraction: Vector,
    sine: Vector,
    extraterrestrial: Vector,
    lowest: float,
) -> tuple[Vector, Vector]:
    high = sine >= np.sin(np.radians(lowest))
    direct = (1.0 - fraction) * global_horizontal / np.where(high, sine, 1.0)
    direct = np.where(high, np.minimum(direct, extraterrestrial), 0.0)
    return direct, global_horizontal - direct * np.where(high, sine, 0.0)
