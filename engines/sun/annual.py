"""A year of daylight on sensors, a block of them at a time in bounded memory."""

import numpy as np
from numpy.typing import NDArray

from ..core.progress import SILENT, Progress, part
from .coefficients import blocks
from .illuminance import Course
from .interior import Interior, closed_in
from .metrics import Light
from .sensors import Sensors
from .summing import Asked, Summing, Year


def year_of(
    interior: Interior,
    course: Course,
    counted: NDArray[np.bool_],
    asked: Asked,
    seed: int,
    progress: Progress = SILENT,
) -> Year:
    """Trace and sum up the ``counted`` (T,) intervals of a course.

    Raises RuntimeMissing where nothing can be traced, Cancelled.
    """
    sensors = interior.sensors
    hours = np.where(counted, course.hours, 0.0)
    share = 0.1 if interior.veiled else 0.0
    closed = closed_in(interior, course, part(progress, 0.0, share))
    summing = Summing(interior, course, hours, closed, asked)
    for rows in blocks(len(sensors), course.dome.count + len(course.scattered.directions)):
        step = (1 - share) / len(sensors)
        within = part(progress, share + step * rows.start, share + step * rows.stop)
        summing.add(rows, seed, within)
    if asked.open:
        summing.values["open_illuminance"] = course.open_mean(sensors.normals, hours)
    return summing.year()


def light_at(
    interior: Interior,
    course: Course,
    sensors: Sensors,
    asked: Asked,
    seed: int,
    progress: Progress = SILENT,
) -> Light:
    """Illuminance (N, T) in lx of a few sensors, with blinds as they move for ``interior``'s own.

    Raises RuntimeMissing where nothing can be traced, Cancelled.
    """
    closed = closed_in(interior, course, part(progress, 0.0, 0.1))
    few = interior.at(sensors)
    summing = Summing(few, course, course.hours, closed, asked)
    every = slice(0, len(sensors))
    plain, veiled = summing.coefficients(every, seed, part(progress, 0.1, 0.9))
    return summing.light(every, plain, veiled)[0]
