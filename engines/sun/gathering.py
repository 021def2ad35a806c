"""What sensors gather of the light of a period, in bounded memory."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..core.progress import SILENT, Progress, part
from ..core.scene import Vector
from . import bits, panes
from .blind import blind
from .hidden import skyless
from .occlusion import Occluders
from .rays import GRAZING, rays_of
from .sensors import Sensors
from .visibility import Visibility, visible
from .weights import Sources

_RAYS = 1 << 26  # whose answers are kept at a time
_BLOCK = 1 << 19  # values at a time: what stays in a processor's cache


@dataclass(frozen=True, slots=True)
class Gathered:
    """What N sensors have of a period.

    ``direct`` and ``diffuse`` (N,) in kWh/m²; ``hours`` (N,): how long they see the sun, be it
    through glass. ``arriving`` (D, 3): visibility × normal for each direction, as a mean over the
    sensors by area. ``dark`` (N,): which see neither sun nor sky. ``notes``: what a reader must
    know.
    """

    direct: Vector
    diffuse: Vector
    hours: Vector
    arriving: Vector
    dark: NDArray[np.bool_]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Free:
    """What N sensors have without any body: ``irradiation`` (N,) in kWh/m², direct and diffuse
    together, and ``arriving`` (D, 3) as in `Gathered`."""

    irradiation: Vector
    arriving: Vector


def gather(
    occluders: Occluders, sensors: Sensors, sources: Sources, progress: Progress = SILENT
) -> Gathered:
    """The sums over all directions, sensors by sensors, of which any number will do.

    Raises RuntimeMissing where nothing can be traced, Cancelled.
    """
    count, columns = len(sensors), len(sources.directions)
    areas = weights_of(sensors)
    out, arriving = np.empty((3, count)), np.zeros((columns, 3))
    any_seen, dark = np.zeros((count, 1), np.uint8), np.zeros(count, bool)
    step = max(1, _RAYS // max(columns, 1))
    for start in range(0, count, step):
        rows = slice(start, min(start + step, count))
        within = part(progress, start / count, rows.stop / count)
        seen = visible(occluders, sensors.some(rows), sources.directions, progress=within)
        out[:, rows], some = summed(seen, areas[rows], sources)
        arriving += some
        any_seen[rows, 0] = seen.seen.any(axis=1)
        dark[rows] = skyless(seen.seen, sources.directions)
    fan = rays_of(occluders, sensors, sources.directions)
    found = blind(occluders, fan, any_seen)
    notes = (*sensors.notes, *fan.told(), *found.told(), *panes.told(occluders.panes))
    direct, diffuse, hours = out
    return Gathered(direct, diffuse, hours, arriving, dark, notes)


def gathered(seen: Visibility, sensors: Sensors, sources: Sources) -> Gathered:
    """`gather` where it is known what the sensors see."""
    (direct, diffuse, hours), arriving = summed(seen, weights_of(sensors), sources)
    dark = skyless(seen.seen, sources.directions)
    return Gathered(direct, diffuse, hours, arriving, dark, seen.notes)


def summed(seen: Visibility, areas: Vector, sources: Sources) -> tuple[Vector, Vector]:
    """Direct, diffuse and hours (3, N); Σ (D, 3) over the sensors of area × what arrives."""
    energy = seen.dot(np.stack([sources.direct, sources.diffuse], axis=1))
    hours = replace(seen, through=None).dot(sources.hours, cosine=False)
    return np.stack([*energy.T, hours]), column_sums(seen, areas)


def unobstructed(sensors: Sensors, sources: Sources) -> Free:
    """What the sensors have in an open field: all that is in front of them, by its cosine."""
    light = (sources.direct + sources.diffuse).astype(np.float32)
    areas = weights_of(sensors)
    normals, which = _distinct(sensors.normals)
    vectors = np.bincount(which, areas, minlength=len(normals))[:, None] * normals
    total, arriving = np.empty(len(normals)), np.zeros((3, len(light)))
    step = max(1, 8 * _BLOCK // max(len(light), 1))
    towards = np.ascontiguousarray(sources.directions.T, np.float32)
    for start in range(0, len(normals), step):
        rows = slice(start, start + step)
        cosines = normals[rows].astype(np.float32) @ towards
        front = cosines > GRAZING
        total[rows] = np.where(front, cosines, 0) @ light
        arriving += vectors[rows].T.astype(np.float32) @ front.astype(np.float32)
    return Free(total[which], arriving.T)


def column_sums(seen: Visibility, areas: Vector) -> Vector:
    """Σ (D, 3) over the sensors of area × what they see of each direction × their normal."""
    columns = len(seen.directions)
    vectors = (areas[:, None] * seen.normals).T.astype(np.float32)
    total = np.zeros((3, columns))
    step = max(1, _BLOCK // max(columns, 1))
    for start in range(0, len(areas), step):
        rows = slice(start, start + step)
        values = bits.unpacked(seen.seen[rows], columns).astype(np.float32)
        if seen.through is not None:
            values *= seen.through[rows]
            values /= bits.FULL
        total += vectors[:, rows] @ values
    return total.T


def weights_of(sensors: Sensors) -> Vector:
    """What each sensor counts (N,) in a mean over all: by its area; 1 together."""
    areas = sensors.areas if sensors.areas.sum() > 0 else np.ones(len(sensors))
    return areas / max(areas.sum(), 1e-300)


def _distinct(normals: Vector) -> tuple[Vector, NDArray[np.int64]]:
    """The normals that there are, and which of them each sensor has."""
    if len(normals) and (normals == normals[0]).all():
        return normals[:1], np.zeros(len(normals), np.int64)
    rounded = np.round(normals, 7)
    _, first, which = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return normals[first], which.reshape(-1)
