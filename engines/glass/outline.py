"""The outline: a closed plan curve that is walked by its length."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from ..core.errors import ParameterError
from ..core.scene import Vector

Plane = NDArray[np.complex128]  # x + iy

COUNT = 1024
_FEWEST = 8
_DENSE = 4096
_CORNER = np.radians(50.0)  # a drawn curve that turns more than this at a point is a polygon
_FINE = 8
_GAP = 3.0  # ends further apart than this many of the longest steps are open
_FLAT = 1e-3  # rise over size


@dataclass(frozen=True, slots=True)
class Outline:
    """A closed curve in plan, counter-clockwise, at N points evenly spaced along it.

    ``points`` (N, 2) float64 in m, the first not repeated: a print starts there. Between them
    runs a periodic cubic spline over the *turn*, the fraction of the length gone. ``notes`` say
    what was changed of the curve that was asked for.
    """

    points: Vector
    notes: tuple[str, ...] = ()
    _pieces: Plane = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        plane = joined(self.points)
        knots = np.arange(len(plane) + 1, dtype=np.float64)
        spline = CubicSpline(knots, np.append(plane, plane[0]), bc_type="periodic")
        object.__setattr__(self, "_pieces", np.ascontiguousarray(spline.c[::-1].T))

    def at(self, turn: ArrayLike) -> tuple[Plane, Plane, Plane]:
        """Position x + iy in m and its first two derivatives by the turn, of ``turn``'s shape."""
        count = len(self.points)
        place = np.asarray(turn, dtype=np.float64) * count
        whole = np.floor(place)
        t = place - whole
        c0, c1, c2, c3 = np.moveaxis(self._pieces[whole.astype(np.intp) % count], -1, 0)
        position = ((c3 * t + c2) * t + c1) * t + c0
        speed = ((3 * c3 * t + 2 * c2) * t + c1) * count
        change = (6 * c3 * t + 2 * c2) * count**2
        return position, speed, change

    @property
    def length(self) -> float:
        """Length of the spline in m."""
        return float(np.abs(self.at(np.arange(_DENSE) / _DENSE)[1]).mean())


def outline(points: ArrayLike, count: int = COUNT, where: str = "glass.wall") -> Outline:
    """The outline through a closed polyline, at ``count`` points evenly spaced along it.

    ``points`` (M, 2), or (M, 3) at one height, in m; the first may be repeated at the end. Where
    the polyline turns by less than 50° at each point it is taken for a smooth curve, a cubic
    spline by chord length, else for the polygon it is. The outline runs counter-clockwise from
    the first point.

    Raises ParameterError, naming ``where``, when the curve is open, crosses itself, encloses
    nothing, is not level, has fewer than eight different points or one that is no number.
    """
    plane = _checked(points, where)
    step = np.roll(plane, -1) - plane
    if np.abs(np.angle(step / np.roll(step, 1))).max() > _CORNER:
        return eased(plane, count)
    closed = np.append(plane, plane[0])
    chord = np.concatenate([[0.0], np.cumsum(np.abs(step))])
    spline = CubicSpline(chord, closed, bc_type="periodic")
    parts = max(1, -(-_DENSE // len(plane)))
    nodes = np.interp(np.arange(len(plane) * parts + 1) / parts, np.arange(len(chord)), chord)
    slope = spline.derivative()
    arc = summed(lambda t: np.abs(slope(t)), nodes)
    return Outline(pairs(spline(evened(nodes, arc, np.abs(slope(nodes)), count))))


def eased(plane: Plane, count: int, notes: tuple[str, ...] = ()) -> Outline:
    """The outline of a polygon x + iy, its corners eased over one step between the points.

    A triangular window as wide as two steps keeps the spline from swinging where the bend jumps.
    """
    fine = _walked(plane, count * _FINE)
    window = np.bartlett(2 * _FINE + 1)
    around = np.concatenate([fine[-_FINE:], fine, fine[:_FINE]])
    return Outline(
        pairs(_walked(np.convolve(around, window / window.sum(), "valid"), count)), notes
    )


def _walked(plane: Plane, count: int) -> Plane:
    """``count`` points evenly spaced along a closed polygon."""
    closed = np.append(plane, plane[0])
    arc = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(closed)))])
    return np.interp(np.arange(count) * (arc[-1] / count), arc, closed)


def summed(speed: Callable[[Vector], Vector], nodes: Vector) -> Vector:
    """Length (M,) of a curve up to each of its ``nodes``, between which its speed is smooth."""
    middle, half = (nodes[1:] + nodes[:-1]) / 2, np.diff(nodes) / 2
    offset, weight = np.polynomial.legendre.leggauss(4)
    panels = speed(middle[:, None] + half[:, None] * offset) @ weight * half
    return np.concatenate([[0.0], np.cumsum(panels)])


def evened(nodes: Vector, arc: Vector, speed: Vector, count: int) -> Vector:
    """A closed curve's parameter (``count``,) at even shares of its length, from the first node.

    At ``nodes`` (M,), which go once around, ``arc`` is the length gone and ``speed`` its slope;
    exact to the fourth order of the nodes' spacing.
    """
    inverse = CubicHermiteSpline(arc, nodes, 1 / speed)
    return inverse(np.arange(count) * (arc[-1] / count))


def pairs(plane: Plane) -> Vector:
    """Complex numbers x + iy of any shape as (…, 2) float64."""
    return np.stack([plane.real, plane.imag], axis=-1)


def joined(points: Vector) -> Plane:
    """Points (…, 2) as complex numbers x + iy."""
    return points[..., 0] + 1j * points[..., 1]


def _checked(points: ArrayLike, where: str) -> Plane:
    """The polyline without repeated points, counter-clockwise, or ParameterError."""
    given = np.asarray(points, dtype=np.float64)
    if given.ndim != 2 or given.shape[1] not in (2, 3):
        raise ParameterError(f"[{where}] A base curve should be points in plan, not {given.shape}.")
    if not np.isfinite(given).all():
        raise ParameterError(f"[{where}] The base curve has points that are no numbers; redraw it.")
    plane = joined(given)
    size = float(np.abs(plane - plane.mean()).max()) if len(plane) else 0.0
    tiny = 1e-7 * size
    plane = plane[np.abs(plane - np.roll(plane, -1)) > tiny]
    if len(plane) < _FEWEST:
        raise ParameterError(
            f"[{where}] The base curve has {len(plane)} different points; draw at least {_FEWEST}."
        )
    if given.shape[1] == 3 and np.ptp(given[:, 2]) > _FLAT * size:
        raise ParameterError(
            f"[{where}] The base curve rises by {np.ptp(given[:, 2]) * 1e3:.4g} mm; draw it level, "
            "and take one curve for each height."
        )
    step = np.abs(np.diff(plane))
    gap = abs(plane[0] - plane[-1])
    if gap > _GAP * step.max():
        raise ParameterError(
            f"[{where}] The base curve is open: its ends are {gap * 1e3:.4g} mm apart; close it."
        )
    ring = shapely.linearrings(pairs(plane))
    if not shapely.is_simple(ring):
        x, y = crossing(plane) * 1e3
        raise ParameterError(
            f"[{where}] The base curve crosses itself near x {x:.4g} mm, y {y:.4g} mm; "
            "pull its sides apart there."
        )
    area = area_of(plane)
    if abs(area) < 1e-6 * size**2:
        raise ParameterError(f"[{where}] The base curve encloses no area; draw it wider.")
    return plane if area > 0 else np.roll(plane[::-1], 1)


def area_of(plane: Plane) -> float:
    """What a closed polygon encloses in m², positive counter-clockwise."""
    return float((plane.conj() * np.roll(plane, -1)).imag.sum() / 2)


def crossing(plane: Plane) -> Vector:
    """A place (2,) in m where the closed polygon crosses itself."""
    pieces = shapely.node(shapely.linearrings(pairs(plane)))
    ends = np.array([line.coords[0] for line in shapely.get_parts(pieces)])
    away = np.hypot(*(ends - pairs(plane[:1])).T)
    return ends[np.argmax(away)]
