"""Overlaps: what becomes of a plan curve whose wall would run into itself."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .outline import Outline, area_of, eased, joined, pairs

Overlap = Literal["clip", "hull"]

_ARC = 24  # segments to a quarter turn of a rounded corner
_CELL = 1e-2
_SIMPLER = 2e-4
_MARGINS = (1.2, 1.5, 2.0, 3.0)  # bends over half the wall; the first that leaves it clear serves


@dataclass(frozen=True, slots=True)
class Resolved:
    """A closed curve whose wall is clear of itself.

    ``points`` (M, 2) in m, counter-clockwise; ``note`` says what was done, empty where nothing
    was; ``erased``: a concavity of the curve is gone.
    """

    points: Vector
    note: str = ""
    erased: bool = False


def is_clear(points: Vector, radius: float) -> bool:
    """Whether the wall reaching ``radius`` in m to both sides of a closed curve misses itself.

    ``points`` (M, 2) in m, counter-clockwise, dense against the curve's bends.
    """
    plane = joined(points)
    slope = np.roll(plane, -1) - np.roll(plane, 1)
    normal = -1j * slope / np.abs(slope)
    sides = np.stack([plane, plane + radius * normal, plane - radius * normal])
    step = sides - np.roll(sides, 1, axis=1)
    forward = (step[1:].conj() * step[:1]).real
    return bool(forward.min() > 0 and shapely.is_simple(shapely.linearrings(pairs(sides))).all())


def clear_outline(
    points: Vector, radius: float, how: Overlap, count: int, where: str = "glass.wall"
) -> Outline:
    """The outline, of ``count`` points, of what `resolved` makes of a curve, its note with it.

    Bends are widened until the outline's own wall misses itself. Raises ParameterError as
    `resolved` does.
    """
    for margin in _MARGINS:
        clean = resolved(points, radius, how, margin, where)
        found = eased(joined(clean.points), count, (clean.note,))
        if is_clear(found.points, radius) and np.abs(_bend(found)).max() * radius < 1:
            return found
    raise _no_room(radius, where)


def resolved(
    points: Vector,
    radius: float,
    how: Overlap,
    margin: float = _MARGINS[0],
    where: str = "glass.wall",
) -> Resolved:
    """The closed curve with its overlaps taken out, for a wall of half-thickness ``radius``.

    ``points`` (M, 2) in m may cross itself; where its wall misses itself they are returned as
    they are. Else "clip" keeps what the curve goes around counter-clockwise and rounds it by
    offsets outward, inward and back of ``margin`` radii, so that gaps and necks narrower than the
    wall close; "hull" takes the convex hull, as the thesis does, which erases concavities.

    Raises ParameterError, naming ``where``, when nothing of the curve is left.
    """
    if is_clear(points, radius):
        return Resolved(points)
    body = _wound(points, radius)
    before = body.area
    if how == "hull":
        body = _largest(body.convex_hull)
    hull = body.convex_hull.area
    body = _largest(body.simplify(_SIMPLER * radius))
    for step in (margin * radius, -2 * margin * radius, margin * radius):
        body = _largest(body.buffer(step, quad_segs=_ARC))
    if body.is_empty:
        raise _no_room(radius, where)
    ring = np.asarray(body.exterior.coords)[:-1]
    ring = ring if area_of(joined(ring)) > 0 else ring[::-1]
    start = int(np.argmin(np.hypot(*(ring - points[0]).T)))
    erased = how == "hull" and hull - before > 1e-4 * hull
    change = 100 * (body.area / before - 1)
    done = "its convex hull is taken" if how == "hull" else "overlaps are clipped, bends rounded"
    lost = " and a concavity erased" if erased else ""
    note = f"The wall would run into itself: {done}{lost} (area {change:+.2g} %)."
    return Resolved(np.roll(ring, -start, axis=0), note, erased)


def _bend(found: Outline) -> Vector:
    count = 4 * len(found.points)
    _, speed, change = found.at(np.arange(count) / count)
    return (speed.conj() * change).imag / np.abs(speed) ** 3


def _no_room(radius: float, where: str) -> ParameterError:
    return ParameterError(
        f"[{where}] The base curve leaves no room for a wall of {radius * 2e3:.4g} mm; take a "
        "thinner wall, smaller waves or a larger radius."
    )


def _wound(points: Vector, radius: float) -> shapely.Polygon:
    """What a closed curve goes around counter-clockwise, without holes, its largest part.

    Cells far smaller than the wall are left out: rounding takes or fills them anyway.
    """
    ring = shapely.linearrings(points)
    if shapely.is_simple(ring):
        return shapely.Polygon(points)
    cells = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.node(ring))))
    cells = cells[shapely.area(cells) > _CELL * radius**2]
    places = shapely.get_coordinates(shapely.point_on_surface(cells))
    return _largest(shapely.union_all(cells[_winding(points, places) > 0]))


def _winding(points: Vector, places: Vector) -> NDArray[np.int_]:
    """How often a closed polygon (M, 2) goes around each of P ``places`` (P, 2), (P,) int."""
    x, y = places.T
    below = points[:, 1] <= y[:, None]
    place, edge = np.nonzero(below ^ np.roll(below, -1, axis=1))
    (x0, y0), (x1, y1) = points[edge].T, points[(edge + 1) % len(points)].T
    up = np.where(y1 > y0, 1, -1)
    right = up * ((x1 - x0) * (y[place] - y0) - (x[place] - x0) * (y1 - y0)) > 0
    return np.bincount(place, up * right, len(places)).round().astype(int)


def _largest(body: shapely.Geometry) -> shapely.Polygon:
    parts = [p for p in shapely.get_parts(body) if isinstance(p, shapely.Polygon)]
    if not parts:
        return shapely.Polygon()
    return shapely.Polygon(max(parts, key=lambda p: p.area).exterior)
