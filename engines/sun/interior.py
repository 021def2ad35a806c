"""Bodies with sensors among them, and blinds that the sun closes."""

from collections.abc import Iterator
from copy import copy

import numpy as np
from numpy.typing import NDArray

from ..core.progress import Progress
from ..core.scene import Body
from . import blinds
from .gathering import weights_of
from .illuminance import Course
from .occlusion import Occluders
from .sensors import Sensors
from .surroundings import Surroundings

_TABLE = 1 << 21  # values of illuminance at a time: what stays in a processor's cache


class Interior:
    """Bodies, the N sensors among them, and whether the bodies' panes have blinds."""

    def __init__(self, bodies: tuple[Body, ...], sensors: Sensors, veiled: bool) -> None:
        self.sensors = sensors
        self.around = Surroundings(bodies)
        self.occluders = Occluders(bodies)
        self.veiled = veiled and self.around.glazed
        self.shut = Occluders(blinds.shut(bodies)) if self.veiled else self.occluders
        self.shares = weights_of(sensors)

    def at(self, sensors: Sensors) -> "Interior":
        """The same bodies and blinds with other sensors."""
        other = copy(self)
        other.sensors, other.shares = sensors, weights_of(sensors)
        return other

    @property
    def front(self) -> slice:
        """The sensors on the front, where ``sensors`` are of one receiver that has both sides."""
        count = len(self.sensors)
        return slice(0, count // 2 if len(self.sensors.shape) == 3 else count)


def closed_in(interior: Interior, course: Course, progress: Progress) -> NDArray[np.bool_]:
    """In which intervals (T,) the blinds are closed for the sun on the front of the sensors."""
    if not interior.veiled:
        return np.zeros(len(course.hours), bool)
    sunny = np.zeros(len(course.hours))
    front = interior.sensors.some(interior.front)
    count, shares = len(front), weights_of(front)
    for rows in tables(slice(0, count), len(course.hours)):
        progress(rows.start / count, "Looking where the sun comes in")
        some = front.some(rows)
        # What is left without panes comes through them; blinds do nothing against other sun.
        through = course.sunlight(interior.occluders, some)
        through -= course.sunlight(interior.shut, some)
        sunny += blinds.sunny_area(through, shares[rows])
    return blinds.closed(sunny)


def tables(rows: slice, columns: int) -> Iterator[slice]:
    """Runs of sensors whose hourly values stay in the cache."""
    step = max(1, _TABLE // max(columns, 1))
    for start in range(rows.start, rows.stop, step):
        yield slice(start, min(start + step, rows.stop))
