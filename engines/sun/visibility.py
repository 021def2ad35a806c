"""Which sensor sees how much of which direction of sun or sky.

Rays go from each sensor in each direction in front of it and are blocked by the first body that
they meet; panes let them through in part. What is seen does not depend on the time or the weather:
any period, any sky is a weighted sum over the directions, in a few ms.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..core.errors import SceneError
from ..core.progress import SILENT, Progress, part
from ..core.scene import Vector
from . import bits, panes, rays
from .blind import Blind, blind
from .occlusion import Occluders
from .sensors import Sensors

MOST_BYTES = 1 << 31
"""What a visibility may take up; beyond it, `weighted` keeps none."""
_STREAMED = 1 << 26  # rays between two sums of `weighted`


@dataclass(frozen=True, slots=True)
class Visibility:
    """What N sensors see of D directions.

    ``seen`` (N, ceil(D / 8)) uint8: a bit a direction, in order, the first lowest (`bits`);
    ``through`` (N, D) uint16 or None: what panes let through of those seen, of 65535. ``normals``
    (N, 3), ``directions`` (D, 3) float64. ``notes``: what a reader must know, a sentence each.
    """

    seen: bits.Bits
    through: NDArray[np.uint16] | None
    normals: Vector
    directions: Vector
    notes: tuple[str, ...] = ()

    def dot(self, weights: Vector | csr_array, *, cosine: bool = True) -> Vector:
        """Σ over the directions of visibility × weight, × the cosine at the sensor if ``cosine``.

        ``weights`` (D,) gives (N,), (D, K), also sparse, gives (N, K), float64 to single precision.
        With radiance × solid angle for weights this is irradiance; with hours and no cosine, sun
        hours. Raises SceneError where there are not D weights.
        """
        weights = _checked_weights(weights, len(self.directions))
        facing = (self.normals, self.directions) if cosine else None
        if weights.ndim == 1:
            return bits.sums(self.seen, weights[:, None], self.through, facing)[:, 0]
        return bits.sums(self.seen, weights, self.through, facing)

    def values(self) -> NDArray[np.float32]:
        """What of each direction is seen, 0..1 (N, D)."""
        values = bits.unpacked(self.seen, len(self.directions)).astype(np.float32)
        if self.through is not None:
            values *= self.through
            values /= bits.FULL
        return values


def visible(
    occluders: Occluders, sensors: Sensors, directions: Vector, *, progress: Progress = SILENT
) -> Visibility:
    """What the sensors see of ``directions`` (D, 3), unit vectors towards sun or sky.

    They are in the model's axes and of any order: true or merged suns, patches. Raises SceneError
    where the result would take more than 2 GiB, which `weighted` does without, RuntimeMissing
    where nothing can be traced, Cancelled.
    """
    directions = checked(directions)
    require_room(occluders, len(sensors), len(directions))
    result, found = _traced(occluders, sensors, directions, progress)
    notes = (*sensors.notes, *result.notes, *found.told(), *panes.told(occluders.panes))
    return replace(result, notes=notes)


def weighted(
    occluders: Occluders,
    sensors: Sensors,
    directions: Vector,
    weights: Vector | csr_array,
    *,
    cosine: bool = True,
    progress: Progress = SILENT,
) -> tuple[Vector, tuple[str, ...]]:
    """`Visibility.dot` and the notes, without keeping what is seen, for any number of sensors.

    Raises what `visible` does but for the size.
    """
    directions = checked(directions)
    weights = _checked_weights(weights, len(directions))
    out, found = np.empty((len(sensors), *(weights.shape or ())[1:])), Blind()
    told = rays.rays_of(occluders, sensors, directions).told()
    step = max(1, _STREAMED // max(len(directions), 1))
    for start in range(0, len(sensors), step):
        rows = slice(start, min(start + step, len(sensors)))
        within = part(progress, start / len(sensors), rows.stop / len(sensors))
        some, blind_ones = _traced(occluders, sensors.some(rows), directions, within)
        out[rows] = some.dot(weights, cosine=cosine)
        found += blind_ones
    return out, (*sensors.notes, *told, *found.told(), *panes.told(occluders.panes))


def _traced(
    occluders: Occluders, sensors: Sensors, directions: Vector, progress: Progress
) -> tuple[Visibility, Blind]:
    fan = rays.rays_of(occluders, sensors, directions)
    seen = rays.unblocked(occluders.still, fan, progress=part(progress, 0.0, 0.5))
    seen = rays.unblocked(occluders.moving, fan, seen, part(progress, 0.5, 0.8))
    through = panes.transmittances(occluders.panes, fan, seen, part(progress, 0.8, 1.0))
    result = Visibility(seen, through, sensors.normals, directions, fan.told())
    return result, blind(occluders, fan, seen)


def require_room(occluders: Occluders, sensors: int, directions: int) -> None:
    """Raise SceneError where what is seen takes more than MOST_BYTES."""
    each = directions / 8 + (2 * directions if occluders.panes.bodies else 0)
    if sensors * each > MOST_BYTES:
        raise SceneError(
            f"What {sensors:,} sensors see of {directions:,} directions takes more than "
            f"{MOST_BYTES >> 30} GiB; use fewer sensors, merge suns, or sum without keeping it."
        )


def checked(directions: Vector) -> Vector:
    """``directions`` as (D, 3) float64; raises SceneError for one that is not a unit vector."""
    directions = np.asarray(directions, dtype=np.float64).reshape(-1, 3)
    length = np.sqrt(np.einsum("ij,ij->i", directions, directions))
    bad = np.flatnonzero(~(np.abs(length - 1) < 1e-4))
    if len(bad):
        raise SceneError(f"Direction {bad[0]} is {length[bad[0]]:.4g} long; give unit vectors.")
    return directions


def _checked_weights(weights: Vector | csr_array, count: int) -> Vector | csr_array:
    if not isinstance(weights, csr_array):
        weights = np.asarray(weights, dtype=np.float64)
    given = (weights.shape or (0,))[0]
    if given != count:
        raise SceneError(f"There are {given} weights for {count} directions; give as many.")
    return weights
