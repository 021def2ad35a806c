"""A sun study that follows the model while it is dragged about."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..core.errors import SceneError
from ..core.parameters import digest
from ..core.scene import Receiver, Scene, Surface
from .gathering import Free, Gathered, gather, gathered, unobstructed
from .maps import SunMaps, figures_of, quantities_of
from .occlusion import Occluders, bodies_of
from .radiation import (
    Radiation,
    course_of,
    light_of,
    maps_of,
    meta_of,
    notes_of,
    unreflected,
)
from .receivers import sensors_in, sensors_on
from .remembered import Remembered
from .sensors import Sensors, joined
from .visibility import require_room
from .weights import Sources

_COARSE = 2  # subdivision of the sky at most


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
        self._lit: tuple[Any, Sources] | None = None
        self._sensors: dict[int, tuple[Receiver | Surface, Sensors]] = {}
        self._free: tuple[Sensors, Sources, Free] | None = None
        self._joined: tuple[tuple[Sensors, ...], Sensors] | None = None

    def radiation(self, scene: Scene, record: Radiation, *, hourly: bool = False) -> SunMaps:
        """As `study_radiation`, whose errors it raises, but without what bodies reflect.

        The sky has at most 577 patches. There are hourly means only where they are asked for.
        """
        started = time.perf_counter()
        record = replace(record, subdivision=min(record.subdivision, _COARSE))
        sources = self._light(record)
        parts = self._parts(scene)
        occluders = self._placed(scene)
        sensors = self._together(parts)
        found = self._gathered(occluders, sensors, sources)
        free = self._open(sensors, sources) if record.open else None
        maps = maps_of(scene, parts, found, free)
        means = course_of(sources, found.arriving, free) if hourly else {}
        notes = notes_of(scene, occluders, parts, found)
        remedy = "a study adds it" if record.bounces else "raise Bounces, and a study adds it"
        notes += unreflected(scene, remedy)
        meta = meta_of(record, sources, notes)
        meta |= {"figures": figures_of(maps), "quantities": quantities_of(maps), "seed": 0}
        meta["seconds"] = time.perf_counter() - started
        return SunMaps(maps, sources.times if hourly else sources.times[:0], means, meta)

    def _gathered(self, occluders: Occluders, sensors: Sensors, sources: Sources) -> Gathered:
        """From what is remembered of the sensors, unless they are too many for that."""
        try:
            require_room(occluders, len(sensors), len(sources.directions))
        except SceneError:
            return gather(occluders, sensors, sources)
        seen = self._remembered.visible(occluders, sensors, sources.directions)
        return gathered(seen, sensors, sources)

    def _open(self, sensors: Sensors, sources: Sources) -> Free:
        if self._free is None or self._free[0] is not sensors or self._free[1] is not sources:
            self._free = sensors, sources, unobstructed(sensors, sources)
        return self._free[2]

    def _light(self, record: Radiation) -> Sources:
        file = Path(record.weather_file)
        stamp = file.stat().st_mtime_ns if record.weather_file and file.exists() else 0
        key = digest(record), stamp
        if self._lit is None or self._lit[0] != key:
            self._lit = key, light_of(record)
        return self._lit[1]

    def _parts(self, scene: Scene) -> tuple[Sensors, ...]:
        if not scene.receivers:
            return sensors_in(scene)
        kept = [self._sensors.get(id(r), (None, None)) for r in scene.receivers]
        fresh = [
            (receiver, sensors if sensors and before is receiver else sensors_on(receiver))
            for receiver, (before, sensors) in zip(scene.receivers, kept, strict=True)
        ]
        self._sensors = {id(receiver): (receiver, sensors) for receiver, sensors in fresh}
        return tuple(sensors for _, sensors in fresh)

    def _together(self, parts: tuple[Sensors, ...]) -> Sensors:
        if self._joined is None or list(map(id, self._joined[0])) != list(map(id, parts)):
            self._joined = parts, joined(*parts)
        return self._joined[1]

    def _placed(self, scene: Scene) -> Occluders:
        bodies = bodies_of(scene)
        if self._occluders is None:
            self._occluders = Occluders(bodies, self._moving)
        else:
            self._occluders.update(bodies)
        return self._occluders
