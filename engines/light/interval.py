"""How sure a sum of photon weights is.

A texel's flux is a compound Poisson sum: photons arrive independently, each with its weight. From
Σw and Σw² follow an effective count n = (Σw)²/Σw² and an effective weight Σw²/Σw; the interval is
the Poisson one for n in units of that weight.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaincinv, ndtri

CONFIDENCE = 0.95
Z = float(ndtri(0.5 + CONFIDENCE / 2))
FEW = 25.0
"""Below so many effective hits the exact Poisson bounds are taken [Garwood 1936]."""
FLOOR = 0.05
"""The error is counted over texels above this share of the map's mean."""

Map = NDArray[np.float64]


_COUNTS = np.linspace(0.0, FEW, 2501)
_TAIL = (1 - CONFIDENCE) / 2
_GARWOOD = (
    np.append(0.0, gammaincinv(_COUNTS[1:], _TAIL)),
    gammaincinv(_COUNTS + 1, 1 - _TAIL),
)
"""Garwood's bounds for effective counts, which need not be whole; between two, linear."""


def interval(total: Map, square: Map, typical: float) -> tuple[Map, Map]:
    """Lower and upper 95 % confidence bounds of sums ``total`` = Σw with ``square`` = Σw².

    Above FEW hits the score interval n + z²/2 ± z √(n + z²/4); below, Garwood's exact bounds,
    which leave a texel without a hit an upper bound of 3.7 photons of the ``typical`` weight.
    """
    hit = square > 0
    weight = np.divide(square, total, out=np.full_like(total, typical), where=hit)
    count = np.divide(total * total, square, out=np.zeros_like(total), where=hit)
    middle, reach = count + Z * Z / 2, Z * np.sqrt(count + Z * Z / 4)
    lower, upper = middle - reach, middle + reach
    few = count < FEW
    lower[few] = np.interp(count[few], _COUNTS, _GARWOOD[0])
    upper[few] = np.interp(count[few], _COUNTS, _GARWOOD[1])
    return lower * weight, upper * weight


def error(total: Map, square: Map, area: Map | float = 1.0) -> float:
    """The error of sums on texels of ``area``: 95 % half-width ÷ mean, root mean square over texels
    whose light per area is above FLOOR × the mean.

    Infinite while nothing has landed.
    """
    mean = total.sum() / np.broadcast_to(area, total.shape).sum()
    counted = total > FLOOR * mean * area
    if not counted.any():
        return float("inf")
    return float(Z * np.sqrt(np.mean(square[counted] / total[counted] ** 2)))
