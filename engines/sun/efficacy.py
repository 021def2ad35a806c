"""How many lumens a watt of daylight is worth, after Perez."""

from pathlib import Path

import numpy as np

from ..core.scene import Vector
from .perez import PerezSky, clearness_class

DEW_POINT = 11.0
"""°C, where the weather says none (gendaymtx's): 2 cm of water in the air."""

_GLOBAL, _DIFFUSE, _DIRECT = (
    np.loadtxt(Path(__file__).parent / "data" / "efficacy_1990.csv", delimiter=",")
    .reshape(-1, 3, 4)
    .swapaxes(0, 1)
)


def precipitable_water(dew_point: Vector | float) -> Vector:
    """The water in the air in cm (T,), of the dew point in °C; NaN counts as `DEW_POINT`.

    [Perez et al. 1990, eq. 3]
    """
    known = np.where(np.isnan(dew_point), DEW_POINT, dew_point)
    return np.exp(0.07 * known - 0.075)


def global_efficacy(sky: PerezSky, water: Vector | float) -> Vector:
    """lm/W (T,) of global horizontal light; ``water`` in cm [Perez et al. 1990, eq. 6]."""
    return _of_sky(_GLOBAL, sky, water)


def diffuse_efficacy(sky: PerezSky, water: Vector | float) -> Vector:
    """lm/W (T,) of diffuse horizontal light; ``water`` in cm [Perez et al. 1990, eq. 7]."""
    return _of_sky(_DIFFUSE, sky, water)


def direct_efficacy(sky: PerezSky, water: Vector | float) -> Vector:
    """lm/W (T,) of direct normal light; ``water`` in cm [Perez et al. 1990, eq. 8].

    Never below 0, where the fit ends for a sun near the horizon.
    """
    a, b, c, d = _DIRECT[clearness_class(sky.clearness)].T
    found = a + b * water + c * np.exp(5.73 * sky.zenith - 5) + d * sky.brightness
    return np.maximum(found, 0.0)


def _of_sky(table: Vector, sky: PerezSky, water: Vector | float) -> Vector:
    a, b, c, d = table[clearness_class(sky.clearness)].T
    return a + b * water + c * np.cos(sky.zenith) + d * np.log(sky.brightness)
