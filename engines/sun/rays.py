"""Rays from every sensor in every direction, in batches of bounded memory."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
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
_FAR_OFF = 5e-3  # m: an offset that is told
_BESIDE = 1.0  # m about the sensors, within which a triangle may be what they lie on
GRAZING = 1e-6
"""A direction whose cosine with the normal is not above this is behind the sensor."""


@dataclass(frozen=True, slots=True)
class Rays:
    """N sensors' rays in D directions, about a scene's centre and in single precision.

    ``origins`` (N, 3) m, ``offset`` m from the sensors along their ``normals`` (N, 3);
    ``directions`` (D, 3).
    """

    origins: NDArray[np.float32]
    normals: NDArray[np.float32]
    directions: NDArray[np.float32]
    offset: float

    def some(self, which: NDArray[np.int64]) -> "Rays":
        """The rays of some of the sensors."""
        return replace(self, origins=self.origins[which], normals=self.normals[which])

    def told(self) -> tuple[str, ...]:
        """A sentence where they start so far off that something may be passed over."""
        if self.offset < _FAR_OFF:
            return ()
        return (
            f"Bodies reach so far that rays start {1000 * self.offset:.2g} mm off the sensors; "
            "what is nearer than that is passed over, so leave out what is far away.",
        )

    def batches(self, progress: Progress = SILENT) -> Iterator[slice]:
        """Runs of sensors with no more than BATCH rays, or single ones."""
        count, step = len(self.origins), max(1, BATCH // max(len(self.directions), 1))
        for start in range(0, count, step):
            progress(start / count, f"Tracing sensor {start:,} of {count:,}")
            yield slice(start, min(start + step, count))


def rays_of(occluders: Occluders, sensors: Sensors, directions: Vector) -> Rays:
    """The rays as they are traced; far from the centre, or on triangles that reach far from it,
    they start farther off than 1 mm."""
    origins = sensors.points - occluders.centre
    offset = clearance(origins, (occluders.still, occluders.moving), sensors.offset)
    return Rays(
        (origins + offset * sensors.normals).astype(np.float32),
        sensors.normals.astype(np.float32),
        np.asarray(directions).astype(np.float32),
        offset,
    )


def clearance(points: Vector, soups: Iterable[Soup], least: float) -> float:
    """How far in m, ``least`` or more, rays from ``points`` (N, 3) about a centre must start off.

    What they lie on is met, in single precision, as nearly as its coordinates are known.
    """
    if not len(points):
        return least
    low, high = points.min(axis=0) - _BESIDE, points.max(axis=0) + _BESIDE
    least = max(least, 2 * CLOSE * float(np.abs(points).max()))
    return max(soup.step_near(low, high, least) for soup in soups)


def facing(rays: Rays, progress: Progress = SILENT) -> bits.Bits:
    """Which directions are in front of each sensor, as bits (N, ceil(D / 8))."""
    out = _empty(rays)
    for rows in rays.batches(progress):
        out[rows] = bits.packed(rays.normals[rows] @ rays.directions.T > GRAZING)
    return out


def unblocked(
    soup: Soup, rays: Rays, among: bits.Bits | None = None, progress: Progress = SILENT
) -> bits.Bits:
    """Which of the rays ``among`` (N, ceil(D / 8)) meet none of the soup's triangles.

    None stands for all that are in front of their sensors.
    """
    if soup.scene is None:
        return facing(rays, progress) if among is None else among
    out = _empty(rays)
    for rows in rays.batches(progress):
        fired = Fired(rays, rows, among)
        free = fired.active & ~soup.scene.ray_test(fired.ray, fired.active)
        out[rows] = bits.packed(np.asarray(free).reshape(-1, len(rays.directions)))
    return out


class Fired:
    """Some sensors' rays on the device, a lane each; ``active`` are those ``among`` (N, bytes), or
    all in front of the sensors."""

    def __init__(self, rays: Rays, rows: slice, among: bits.Bits | None) -> None:
        mi = runtime.mitsuba()
        import drjit as dr

        def loaded(vectors: NDArray[np.float32]) -> Any:
            return mi.Vector3f(np.ascontiguousarray(vectors.T))

        columns = len(rays.directions)
        index = dr.arange(mi.UInt32, (rows.stop - rows.start) * columns)
        # Opaque, so that one kernel serves every number of directions.
        row = index // dr.opaque(mi.UInt32, columns)
        column = index - row * columns
        origin = dr.gather(mi.Vector3f, loaded(rays.origins[rows]), row)
        direction = dr.gather(mi.Vector3f, loaded(rays.directions), column)
        self.ray: Any = mi.Ray3f(mi.Point3f(origin), direction)
        self.active: Any
        if among is None:
            normal = dr.gather(mi.Vector3f, loaded(rays.normals[rows]), row)
            self.active = dr.dot(normal, direction) > GRAZING
        else:
            words = mi.UInt32(_words(among[rows]))
            byte = row * dr.opaque(mi.UInt32, among.shape[1]) + (column >> 3)
            word = dr.gather(mi.UInt32, words, byte >> 2)
            self.active = (word >> (((byte & 3) << 3) + (column & 7))) & 1 != 0


def _words(among: bits.Bits) -> NDArray[np.uint32]:
    """The bytes as little-endian words."""
    flat = np.ascontiguousarray(among).ravel()
    spare = -len(flat) % 4
    return (np.concatenate([flat, np.zeros(spare, np.uint8)]) if spare else flat).view("<u4")


def _empty(rays: Rays) -> bits.Bits:
    return np.empty((len(rays.origins), -(-len(rays.directions) // 8)), np.uint8)
