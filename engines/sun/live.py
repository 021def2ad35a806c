"""A sun study that follows the model while it is dragged about."""

import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.parameters import digest
from ..core.scene import Receiver, Scene, Surface, Vector
from .gathering import gathered
from .maps import SunMaps, figures_of, quantities_of
from .occlusion import Occluders, bodies_of
from .radiation import (
    Radiation,
    course_of,
    light_of,
    looking_down,
    maps_of,
    meta_of,
    sensors_in,
    sensors_on,
)
from .remembered import Remembered
from .sensors import Sensors, joined
from .site import Site
from .visibility import visible
from .weights import Sources


class LiveSun:
    """Studies one after the other, of which each keeps what it can of the one before.

    The weather, the sky and the suns stay while the record does, the sensors of a receiver while
    it is the same object, what bodies hide while they do not change. ``moving``: the names of
    bodies that will move, so that the first move is as quick as the later ones.
    """

    def __init__(self, moving: tuple[str, ...] = ()) -> None:
        self._moving = moving
        self._occluders: Occluders | None = None
        self._remembered = Remembered()
        self._lit: tuple[Any, tuple[Sources, str, Site]] | None = None
        self._sensors: dict[int, tuple[Receiver | Surface, Sensors]] = {}
        self._joined: tuple[tuple[Sensors, ...], Sensors] | None = None

    def radiation(self, scene: Scene, record: Radiation, *, hourly: bool = False) -> SunMaps:
        """As `study_radiation`, whose errors it raises; without hourly means unless asked for."""
        started = time.perf_counter()
        sources, source, site = self._light(record)
        parts = self._parts(scene)
        occluders = self._placed(scene)
        sensors = self._together(parts)
        seen = self._remembered.visible(occluders, sensors, sources.directions)
        found = gathered(seen, sensors, sources)
        maps, arriving = maps_of(scene, parts, sources, found, record)
        means = course_of(sources, arriving) if hourly else {}
        meta = meta_of(record, site, source, sources, [*found.notes, *looking_down(scene, parts)])
        meta |= {"figures": figures_of(maps), "quantities": quantities_of(maps), "seed": 0}
        meta["seconds"] = time.perf_counter() - started
        return SunMaps(maps, sources.times if hourly else sources.times[:0], means, meta)

    def at_sensor(
        self, scene: Scene, record: Radiation, receiver: str, texel: tuple[int, ...]
    ) -> tuple[NDArray[np.datetime64], dict[str, Vector]]:
        """Times (T,), UTC, and direct, diffuse and open irradiance (T,) in W/m² at one sensor.

        ``texel``: (row, column), or (side, row, column) where both sides gather. Raises SceneError
        where no sensor is.
        """
        sources, _, _ = self._light(record)
        names = [r.name for r in scene.receivers]
        if receiver not in names:
            raise SceneError(f"There is no receiver “{receiver}”; pick a sensor of {names}.")
        sensors = self._parts(scene)[names.index(receiver)]
        home = int(np.ravel_multi_index(texel, sensors.shape))
        found = np.flatnonzero(sensors.home == home)
        if not len(found):
            raise SceneError(f"“{receiver}” has no sensor at {texel}; pick another place.")
        one = sensors.some(found)
        seen = visible(self._placed(scene), one, sources.directions).values()[0]
        cosines = np.maximum(sources.directions @ one.normals[0], 0.0)
        return sources.times, course_of(sources, {"built": seen * cosines, "open": cosines})

    def _light(self, record: Radiation) -> tuple[Sources, str, Site]:
        file = Path(record.weather_file)
        stamp = file.stat().st_mtime_ns if record.weather_file and file.exists() else 0
        key = digest(record), stamp
        if self._lit is None or self._lit[0] != key:
            self._lit = key, light_of(record)
        return self._lit[1]

    def _parts(self, scene: Scene) -> tuple[Sensors, ...]:
        if not scene.receivers:
            return sensors_in(scene)
        kept = {}
        for receiver in scene.receivers:
            before = self._sensors.get(id(receiver))
            known = before is not None and before[0] is receiver
            kept[id(receiver)] = before if known else (receiver, sensors_on(receiver))
        self._sensors = kept
        return tuple(sensors for _, sensors in kept.values())

    def _together(self, parts: tuple[Sensors, ...]) -> Sensors:
        if self._joined is None or any(
            a is not b for a, b in zip(self._joined[0], parts, strict=False)
        ) or len(self._joined[0]) != len(parts):
            self._joined = parts, joined(*parts)
        return self._joined[1]

    def _placed(self, scene: Scene) -> Occluders:
        bodies = bodies_of(scene)
        if self._occluders is None:
            self._occluders = Occluders(bodies, self._moving)
        else:
            self._occluders.update(bodies)
        return self._occluders
