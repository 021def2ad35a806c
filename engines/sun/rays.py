"""Rays from every sensor in every direction, in batches of bounded memory."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.progress import SILENT, Progress
from ..core.scene import Vector
from . import bits
from .occlusion import Occluders
from .sensors import Sensors
from .soup import CLOSE, Soup

BATCH = 1 << 24
"""Rays at a time: 16 MB of answers, and about half a second on two cores."""
GRAZING = 1e-6
"""A direction whose cosine with the normal is not above this is behind the sensor."""


@dataclass(frozen=True, slots=True)
class Rays:
    """N sensors' rays in D directions, about a scene's centre and in single precision.

    ``origins`` (N, 3) m, ``normals`` (N, 3), ``directions`` (D, 3).
    """

    origins: NDArray[np.float32]
    normals: NDArray[np.float32]
    directions: NDArray[np.float32]

    def batches(self, progress: Progress = SILENT) -> Iterator[slice]:
        """Runs of sensors with no more than BATCH rays, or single ones."""
        count, step = len(self.origins), max(1, BATCH // max(len(self.directions), 1))
        for start in range(0, count, step):
            progress(start / count, f"Tracing sensor {start:,} of {count:,}")
            yield slice(start, min(start + step, count))


def rays_of(occluders: Occluders, sensors: Sensors, directions: Vector) -> Rays:
    """The rays as they are traced; in a scene of many km they start farther off than 1 mm."""
    origins = sensors.points - occluders.centre
    reach = max(occluders.reach, float(np.abs(origins).max(initial=0.0)))
    offset = max(sensors.offset, 2 * CLOSE * reach)
    return Rays(
        (origins + offset * sensors.normals).astype(np.float32),
        sensors.normals.astype(np.float32),
        np.asarray(directions).astype(np.float32),
    )


def facing(rays: Rays, progress: Progress = SILENT) -> bits.Bits:
    """Which directions are in front of each sensor, as bits (N, ceil(D / 8))."""
    out = _empty(rays)
    for rows in rays.batches(progress):
        out[rows] = bits.packed(rays.normals[rows] @ rays.directions.T > GRAZING)
    return out


def unblocked(soup: Soup, rays: Rays, among: bits.Bits, progress: Progress = SILENT) -> bits.Bits:
    """Which of the rays ``among`` (N, ceil(D / 8)) meet none of the soup's triangles."""
    if soup.scene is None:
        return among
    out = _empty(rays)
    for rows in rays.batches(progress):
        fired = Fired(rays, rows, among[rows])
        free = fired.active & ~soup.scene.ray_test(fired.ray, fired.active)
        out[rows] = bits.packed(np.asarray(free).reshape(-1, len(rays.directions)))
    return out


class Fired:
    """Some sensors' rays on the device, a lane each; ``active`` are those ``among`` (n, bytes)."""

    def __init__(self, rays: Rays, rows: slice, among: bits.Bits) -> None:
        mi = runtime.mitsuba()
        import drjit as dr

        columns = len(rays.directions)
        index = dr.arange(mi.UInt32, (rows.stop - rows.start) * columns)
        # Opaque, so that one kernel serves every number of directions.
        row = index // dr.opaque(mi.UInt32, columns)
        column = index - row * columns
        origins = mi.Point3f(np.ascontiguousarray(rays.origins[rows].T))
        directions = mi.Vector3f(np.ascontiguousarray(rays.directions.T))
        self.ray: Any = mi.Ray3f(
            dr.gather(mi.Point3f, origins, row), dr.gather(mi.Vector3f, directions, column)
        )
        words = mi.UInt32(_words(among))
        byte = row * dr.opaque(mi.UInt32, among.shape[1]) + (column >> 3)
        word = dr.gather(mi.UInt32, words, byte >> 2)
        self.active: Any = (word >> (((byte & 3) << 3) + (column & 7))) & 1 != 0


def _words(among: bits.Bits) -> NDArray[np.uint32]:
    """The bytes as little-endian words."""
    flat = np.ascontiguousarray(among).ravel()
    spare = -len(flat) % 4
    return (np.concatenate([flat, np.zeros(spare, np.uint8)]) if spare else flat).view("<u4")


def _empty(rays: Rays) -> bits.Bits:
    return np.empty((len(rays.origins), -(-len(rays.directions) // 8)), np.uint8)
