"""Visibility that is kept, and traced anew only where the scene has changed."""

import hashlib
from collections import OrderedDict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.progress import SILENT, Progress, part
from ..core.scene import Vector
from . import bits, panes, rays
from .blind import blind
from .occlusion import Occluders
from .sensors import Sensors
from .visibility import Visibility, checked, require_room


@dataclass
class _Kept:
    """What is known for some sensors and directions, and which bodies it is true of.

    ``past``: the rays that the ``still`` bodies let pass; ``through``: what the ``panes`` let
    through of these; ``result``: with the moving bodies as well, for ``all`` of the bodies.
    """

    still: bytes = b""
    past: bits.Bits | None = None
    panes: bytes = b""
    through: NDArray[np.uint16] | None = None
    all: bytes = b""
    result: Visibility | None = None

    @property
    def size(self) -> int:
        """In bytes."""
        seen = self.result.seen if self.result else None
        arrays = (self.past, self.through, seen)
        return sum(a.nbytes for a in {id(a): a for a in arrays if a is not None}.values())


class Remembered:
    """`visible`, with what it found kept up to ``most`` bytes; what was not asked for longest goes.

    The same question is answered at once. When bodies moved, only the rays that the still ones let
    pass are traced, against the moving ones alone; the panes are crossed anew only when they, or
    what the still bodies hide, changed.
    """

    def __init__(self, most: int = 1 << 30) -> None:
        self._most = most
        self._kept: OrderedDict[bytes, _Kept] = OrderedDict()

    def visible(
        self,
        occluders: Occluders,
        sensors: Sensors,
        directions: Vector,
        *,
        progress: Progress = SILENT,
    ) -> Visibility:
        """As `visibility.visible`, whose errors it raises."""
        directions = checked(directions)
        require_room(occluders, len(sensors), len(directions))
        key = _key(sensors, directions)
        fan = rays.rays_of(occluders, sensors, directions)
        everything = occluders.digest + np.float64(fan.offset).tobytes()
        kept = self._kept.pop(key, None) or _Kept()
        if kept.result is None or kept.all != everything:
            past = self._renew(kept, occluders, fan, progress)
            seen = rays.unblocked(occluders.moving, fan, past, part(progress, 0.8, 1.0))
            found = blind(occluders, fan, seen)
            notes = (*sensors.notes, *fan.told(), *found.told(), *panes.told(occluders.panes))
            kept.result = Visibility(seen, kept.through, sensors.normals, directions, notes)
            kept.all = everything
        self._kept[key] = kept
        self._forget()
        return kept.result

    def _renew(
        self, kept: _Kept, occluders: Occluders, fan: rays.Rays, progress: Progress
    ) -> bits.Bits:
        """Bring up to date what does not depend on the moving bodies."""
        still = occluders.digests["still"] + np.float64(fan.offset).tobytes()
        if kept.past is None or kept.still != still:
            first = part(progress, 0.0, 0.6)
            kept.past = rays.unblocked(occluders.still, fan, progress=first)
            kept.still, kept.panes = still, b""
        glass = occluders.digests["panes"]
        if kept.panes != glass:
            second = part(progress, 0.6, 0.8)
            kept.through = panes.transmittances(occluders.panes, fan, kept.past, second)
            kept.panes = glass
        return kept.past

    def _forget(self) -> None:
        while len(self._kept) > 1 and sum(k.size for k in self._kept.values()) > self._most:
            self._kept.popitem(last=False)


def _key(sensors: Sensors, directions: Vector) -> bytes:
    told = hashlib.blake2b(digest_size=16)
    for array in (sensors.points, sensors.normals, directions):
        told.update(len(array).to_bytes(8, "little"))
        told.update(np.ascontiguousarray(array))
    told.update(np.float64(sensors.offset).tobytes())
    return told.digest()
