"""Whether a wall has room for its own width: both its sides against the line midway in it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from ..core.scene import Vector
from .surface import Loft

_CHORDS = 0.02  # share of half a width that straight pieces of a section may take from it
_FAR = 2.0  # widths along a turn, beyond which it is another part: a bend back takes π/2
_FINE = 6  # places to a width, at which turns are held against one another
_NEIGHBOURS = 24  # more than a bead of that spacing has within its width


@dataclass(frozen=True, slots=True)
class Clearance:
    """How much room a wall has at K levels, each at M places around.

    ``turn`` (M,) and ``level`` (K,) in m say where; ``points`` (K, M, 2) is the middle. ``room``
    (K, M) in m is the bend's radius, or what lies between the wall's sides and the nearest part of
    its middle where that is less than half the width. ``between`` (K, M) is half the distance from
    the section one layer below, but for the part that carries this one; infinite where it is
    enough. Both must be at least ``half`` (K, M), half the width.
    """

    turn: Vector
    level: Vector
    points: Vector
    room: Vector
    between: Vector
    half: Vector


def clearance(loft: Loft, levels: Vector, width: Vector) -> Clearance:
    """The room at ``levels`` (K,) in m of a wall of ``width`` (K, M) in m.

    A side that lies half a width from its own place must not come closer to any other.
    """
    count = width.shape[1]
    turn = np.arange(count) / count
    place = loft.at(turn, levels[:, None])
    middle, normal = place.points[..., :2], place.normal
    half = width / 2
    bend = 1 / np.maximum(np.abs(place.curvature), np.finfo(float).tiny)
    sides = middle + np.stack([normal, -normal]) * half[..., None]
    room = np.minimum(bend, _short(_distance(middle, sides).min(axis=0), half))
    between = np.full_like(half, np.inf)
    if len(levels) > 1:
        length = float(loft.length(levels).min())
        step = max(1, int(np.ceil(count * width.min() / (_FINE * length))))
        wide = width.max()
        away = _far(middle[:, ::step], float(wide), _FAR * wide / length) / 2
        between[1:] = _short(np.repeat(away, step, axis=1)[:, :count], half[1:])
    return Clearance(turn, levels, middle, room, between, half)


def _far(rings: Vector, wide: float, apart: float) -> Vector:
    """How far each corner of the rings (K, M, 2) but the lowest is from other parts of the ring
    below, (K − 1, M) in m, infinite beyond ``wide``.

    Another part is one that lies more than ``apart`` of a turn from the nearest.
    """
    levels, count = rings.shape[:2]
    below, above = _stacked(rings[:-1], rings[1:])
    distance, found = KDTree(below).query(above, k=_NEIGHBOURS, distance_upper_bound=wide)
    corner = found % count
    along = np.abs((corner - corner[:, :1] + count // 2) % count - count // 2)
    other = np.isfinite(distance) & (along > apart * count)
    return np.where(other, distance, np.inf).min(axis=1).reshape(levels - 1, count)


def _short(room: Vector, half: Vector) -> Vector:
    """``room`` where it is less than half the width, and infinite where it is not."""
    return np.where(room < half * (1 - _CHORDS), room, np.inf)


def _distance(rings: Vector, points: Vector) -> Vector:
    """The distance (…, K, M) of ``points`` (…, K, M, 2) from closed polygons (K, M', 2), each from
    its own.

    The nearest piece is one of the two at the nearest corner.
    """
    count = rings.shape[1]
    corners, wanted = _stacked(rings, points)
    nearest = KDTree(corners).query(wanted)[1].reshape(points.shape[:-1])
    ring, corner = np.divmod(nearest, count)
    here = rings[ring, corner] - points
    found = np.full(here.shape[:-1], np.inf)
    for way in (1, -1):
        step = rings[ring, (corner + way) % count] - rings[ring, corner]
        squared = np.maximum((step * step).sum(axis=-1), np.finfo(float).tiny)
        share = np.clip(-(here * step).sum(axis=-1) / squared, 0.0, 1.0)
        found = np.minimum(found, np.hypot(*np.moveaxis(here + share[..., None] * step, -1, 0)))
    return found


def _stacked(*sections: Vector) -> Iterator[Vector]:
    """The points of sections (…, K, M, 2) as (N, 3), those of one level far from all others."""
    apart = 4 * max(float(np.abs(points).max()) for points in sections)
    for points in sections:
        floor = np.broadcast_to((apart * np.arange(points.shape[-3]))[:, None], points.shape[:-1])
        yield np.concatenate([points, floor[..., None]], axis=-1).reshape(-1, 3)
