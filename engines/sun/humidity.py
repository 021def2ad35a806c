"""Moisture of the air: dew point and relative humidity, each from the other."""

import numpy as np

from ..core.scene import Vector

_A, _B = 17.625, 243.04  # Magnus's form over water [Alduchov and Eskridge 1996, eq. 21]


def relative_humidity(temperature: Vector, dew_point: Vector) -> Vector:
    """Relative humidity, 0 to 1, of air at ``temperature`` and ``dew_point`` in °C; NaN for NaN."""
    exponent = _A * dew_point / (_B + dew_point) - _A * temperature / (_B + temperature)
    return np.minimum(np.exp(exponent), 1.0)


def dew_point(temperature: Vector, humidity: Vector) -> Vector:
    """Dew point in °C of air at ``temperature`` in °C and relative ``humidity``, above 0 to 1."""
    exponent = np.log(np.maximum(humidity, 1e-4)) + _A * temperature / (_B + temperature)
    return _B * exponent / (_A - exponent)
