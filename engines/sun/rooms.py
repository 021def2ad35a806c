"""The places of a daylight study: each receiver with the bodies that are around all of them.

What a receiver's sun does to its blinds, how exact its light is and what its figures are does not
depend on what other receivers there are.
"""

from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ..core.progress import Progress, part
from ..core.scene import Body, Scene, Vector
from . import summing
from .annual import year_of
from .illuminance import Course
from .interior import Interior
from .occlusion import body_of
from .sensors import Sensors, joined
from .summing import Year


class Asked(summing.Asked, Protocol):
    """What of a `daylight.Daylight` rooms depend on."""

    @property
    def blinds(self) -> bool: ...


def rooms_of(scene: Scene, parts: tuple[Sensors, ...], asked: Asked) -> tuple[Interior, ...]:
    """A scene's bodies with the sensors of each of its receivers, ``parts``."""
    whole = Interior(surfaces_of(scene), joined(*parts), asked.blinds)
    return tuple(whole.at(sensors) for sensors in parts)


def surfaces_of(scene: Scene) -> tuple[Body, ...]:
    """A scene's bodies, and those of its receivers that return light as matte ones."""
    return (*scene.bodies, *(body_of(r) for r in scene.receivers if r.reflectance > 0))


def years_of(
    rooms: tuple[Interior, ...],
    course: Course,
    counted: NDArray[np.bool_],
    asked: Asked,
    seed: int,
    progress: Progress,
) -> tuple[Year, ...]:
    """The year of each room. Raises what `year_of` does."""
    ends = np.cumsum([len(room.sensors) for room in rooms])
    bounds = [0.0, *(ends / ends[-1]).tolist()]
    return tuple(
        year_of(room, course, counted, asked, seed + n, part(progress, bounds[n], bounds[n + 1]))
        for n, room in enumerate(rooms)
    )


def mean_course(rooms: tuple[Interior, ...], years: tuple[Year, ...]) -> Vector:
    """Mean illuminance (T,) in lx over all sensors by area, or alike where none has any."""
    areas = np.array([room.sensors.areas.sum() for room in rooms])
    shares = areas if areas.any() else np.array([len(room.sensors) for room in rooms])
    return np.average([year.course for year in years], axis=0, weights=shares)


def nearest(rooms: tuple[Interior, ...], sensors: Sensors) -> Interior:
    """The room whose own sensors are nearest to these."""
    return min(rooms, key=lambda room: KDTree(room.sensors.points).query(sensors.points)[0].sum())


def told_of(scene: Scene, rooms: tuple[Interior, ...], years: tuple[Year, ...]) -> Iterator[str]:
    """What is said of the bodies, and of each receiver's sensors by its name."""
    yield from rooms[0].around.told()
    for receiver, room, year in zip(scene.receivers, rooms, years, strict=True):
        yield from room.sensors.notes
        name = f"“{receiver.name}”: " if len(years) > 1 else ""
        yield from (f"{name}{note}" for note in year.notes)
