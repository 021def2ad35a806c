"""Terrestrial time less universal time: how far the turning earth runs behind the clocks."""

import numpy as np
from numpy.polynomial.polynomial import polyval

from ..core.scene import Vector

# First year, year that the polynomial counts from, years in its unit, coefficients.
_POLYNOMIALS = (
    (-np.inf, 1820, 100, (-20, 0, 32)),
    (
        *(-500, 0, 100),
        (10583.6, -1014.41, 33.78311, -5.952053, -0.1798452, 0.022174192, 0.0090316521),
    ),
    (
        *(500, 1000, 100),
        (1574.2, -556.01, 71.23472, 0.319781, -0.8503463, -0.005050998, 0.0083572073),
    ),
    (1600, 1600, 1, (120, -0.9808, -0.01532, 1 / 7129)),
    (1700, 1700, 1, (8.83, 0.1603, -0.0059285, 0.00013336, -1 / 1174000)),
    (
        *(1800, 1800, 1),
        (13.72, -0.332447, 0.0068612, 0.0041116, -0.00037436, 1.21272e-5, -1.699e-7, 8.75e-10),
    ),
    (1860, 1860, 1, (7.62, 0.5737, -0.251754, 0.01680668, -0.0004473624, 1 / 233174)),
    (1900, 1900, 1, (-2.79, 1.494119, -0.0598939, 0.0061966, -0.000197)),
    (1920, 1920, 1, (21.20, 0.84493, -0.076100, 0.0020936)),
    (1941, 1950, 1, (29.07, 0.407, -1 / 233, 1 / 2547)),
    (1961, 1975, 1, (45.45, 1.067, -1 / 260, -1 / 718)),
    (1986, 2000, 1, (63.86, 0.3345, -0.060374, 0.0017275, 0.000651814, 2.373599e-5)),
    (2005, 2000, 1, (62.92, 0.32217, 0.005589)),
    (2050, 2000, 1, (-0.74, 1.7148, 0.0032)),
    (2150, 1820, 100, (-20, 0, 32)),
)


def delta_t_of(years: Vector) -> Vector:
    """ΔT (T,) in s at decimal ``years`` (T,) [Espenak & Meeus, NASA/TP-2006-214141, 2.7].

    Observed to 2005, foretold after: by 2025 the polynomial is 5 s ahead of what came, which
    moves the sun by 6e-5°.
    """
    piece = np.searchsorted([first for first, *_ in _POLYNOMIALS], years, side="right") - 1
    result = np.empty_like(years, dtype=np.float64)
    for index in np.unique(piece):
        _, origin, unit, coefficients = _POLYNOMIALS[index]
        here = piece == index
        result[here] = polyval((years[here] - origin) / unit, coefficients)
    return result
