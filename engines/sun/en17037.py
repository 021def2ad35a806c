"""EN 17037, daylight in buildings: levels of daylight provision and of exposure to sunlight."""

from dataclasses import dataclass, replace

import numpy as np

from ..core.progress import SILENT, Progress, part
from ..core.scene import Vector
from .metrics import HALF, area_share
from .occlusion import Occluders
from .position import sun_position
from .sensors import Sensors
from .site import Site, to_model
from .times import moment
from .visibility import visible

LEVELS = ("none", "minimum", "medium", "high")
"""What figures call levels, by their number."""
TARGET, LEAST = (300.0, 500.0, 750.0), (100.0, 300.0, 500.0)
"""lx in half of the daylight hours, over half of the area and over 95 % of it [table A.1]."""
TARGET_AREA, LEAST_AREA = 0.5, 0.95
SUNLIGHT = (1.5, 3.0, 4.0)
"""Hours of sun on one day from 1 February to 21 March [table A.6]."""
LIMITS = tuple(sorted({*TARGET, *LEAST}))
"""All the illuminances that matter: 100, 300, 500 and 750 lx."""
_STEPS = 12  # moments of an hour
_BLOCK = 1 << 16  # sensors at a time


@dataclass(frozen=True, slots=True)
class Provision:
    """What EN 17037 finds of a place's daylight.

    ``level`` is 0 to 3 of LEVELS; ``target`` and ``least`` (3,): the shares of the area on which
    each level's two illuminances are reached in half of the daylight hours.
    """

    level: int
    target: tuple[float, ...]
    least: tuple[float, ...]


def provision(reached: Vector, areas: Vector) -> Provision:
    """Daylight provision by illuminance [EN 17037, 5.1 and annex A, for vertical openings].

    ``reached`` (N, 4): the share of the daylight hours with each of LIMITS or more.
    """
    shares = {
        limit: area_share(column >= HALF - 1e-9, areas)
        for limit, column in zip(LIMITS, reached.T, strict=True)
    }
    target = tuple(shares[limit] for limit in TARGET)
    least = tuple(shares[limit] for limit in LEAST)
    met = [
        a >= TARGET_AREA - 1e-9 and b >= LEAST_AREA - 1e-9
        for a, b in zip(target, least, strict=True)
    ]
    return Provision(sum(met), target, least)


def sunlight_hours(
    occluders: Occluders,
    sensors: Sensors,
    site: Site,
    date: tuple[int, int, int],
    lowest: float,
    *,
    progress: Progress = SILENT,
) -> Vector:
    """Hours of possible sun (N,) on a date (year, month, day), however cloudy.

    For EN 17037 the sensors are `openings.reference_points`.

    Counted every five minutes while the sun is ``lowest`` degrees up or more, in front of the
    sensors, be it through panes. Raises ParameterError for no such day, RuntimeMissing, Cancelled.
    """
    midnight = moment(*date, 0.0, site)
    steps = (np.arange(24 * _STEPS) + 0.5) * (3600 / _STEPS)
    times = midnight + steps.astype("timedelta64[s]")
    at = sun_position(times, site)
    up = at.apparent_altitude >= max(lowest, 0.0)
    directions = to_model(at.direction[up], site)
    if not len(directions):
        return np.zeros(len(sensors))
    found = np.zeros(len(sensors))
    for start in range(0, len(sensors), _BLOCK):
        rows = slice(start, start + _BLOCK)
        within = part(progress, start / len(sensors), min(1.0, rows.stop / len(sensors)))
        seen = visible(occluders, sensors.some(rows), directions, progress=within)
        # Sun through glass is sun.
        plain = replace(seen, through=None)
        found[rows] = plain.dot(np.full(len(directions), 1 / _STEPS), cosine=False)
    return found


def sunlight_level(hours: float) -> int:
    """0 to 3 of LEVELS for hours of sun on the day."""
    return int(np.searchsorted(SUNLIGHT, hours + 1e-9, side="right"))
