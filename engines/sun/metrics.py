"""What a year of illuminance comes to, sensor by sensor and over an area.

Light and direct light are (N, T) in lx, ``hours`` (T,) how much each interval counts in h: 0 for
those outside the schedule, and hours of night within it count as dark. Shares are 0..1.
"""

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector

Light = NDArray[np.float32]

TARGET = 300.0
"""lx that LM-83 asks for, in half of the hours."""
HALF = 0.5
SUNNY, SUNNY_HOURS = 1000.0, 250.0
"""lx of direct sun, and hours a year with more, beyond which LM-83 calls a place too sunny."""
USEFUL = (100.0, 300.0, 3000.0)
"""lx: below the first it is too dark, up to the second lamps help, above the third it is too
bright [Mardaljevic et al. 2012]."""
_ROUNDED = 1e-9


def autonomy(light: Light, hours: Vector, target: float = TARGET) -> Vector:
    """Daylight autonomy (N,): the share of the hours with ``target`` lx or more [Reinhart 2001]."""
    return _counted(light >= target, hours) / hours.sum()


def continuous_autonomy(light: Light, hours: Vector, target: float = TARGET) -> Vector:
    """The same (N,), where part of the target counts for its part [Rogers 2006]."""
    return (np.minimum(light, target) @ hours.astype(np.float32)) / target / hours.sum()


def useful(
    light: Light, hours: Vector, limits: tuple[float, float, float] = USEFUL
) -> tuple[Vector, Vector, Vector, Vector]:
    """Useful daylight illuminance: four shares (N,) of the hours, 1 together.

    Below the first limit, from it to below the second, from the second to the third, and above.
    """
    low, middle, high = limits
    total = hours.sum()
    dark = _counted(light < low, hours) / total
    dim = _counted(light < middle, hours) / total - dark
    bright = _counted(light > high, hours) / total
    return dark, dim, np.maximum(1 - dark - dim - bright, 0.0), bright


def hours_above(direct: Light, hours: Vector, limit: float = SUNNY) -> Vector:
    """Hours (N,) with more than ``limit`` lx of direct sun."""
    return _counted(direct > limit, hours)


def mean_light(light: Light, hours: Vector) -> Vector:
    """Mean illuminance (N,) over the hours in lx."""
    return (light @ hours.astype(np.float32)) / hours.sum()


def spatial_autonomy(autonomies: Vector, areas: Vector, share: float = HALF) -> float:
    """sDA: the share of the area whose autonomy (N,) is ``share`` or more [LM-83-12, 2.1.1]."""
    return area_share(autonomies >= share - _ROUNDED, areas)


def sunlight_exposure(sunny: Vector, areas: Vector, most: float = SUNNY_HOURS) -> float:
    """ASE: the share of the area with more than ``most`` hours (N,) of sun [LM-83-12, 3.1.1]."""
    return area_share(sunny > most + _ROUNDED, areas)


def area_share(chosen: NDArray[np.bool_], areas: Vector) -> float:
    """The share of the area whose sensors (N,) are chosen; sensors without area count alike."""
    weights = areas if areas.sum() > 0 else np.ones(len(areas))
    return float(weights[chosen].sum() / max(weights.sum(), 1e-300))


def _counted(which: NDArray[np.bool_], hours: Vector) -> Vector:
    """The hours (N,) of those intervals that are chosen (N, T).

    Intervals as long as one another, mostly all of a year, are counted, which single precision
    does exactly, before they are given their length.
    """
    lengths, kinds = np.unique(hours, return_inverse=True)
    found = np.zeros(len(which))
    for kind in np.flatnonzero(lengths):
        number = which @ (kinds == kind).astype(np.float32)
        found += number.astype(np.float64) * lengths[kind]
    return found
