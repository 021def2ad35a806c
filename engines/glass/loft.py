"""The wall as it is asked for: a record, and the loft that it or drawn curves describe."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.errors import ParameterError
from ..core.parameters import from_table, nested, param, to_table
from ..core.scene import Vector
from .bead import Bead
from .fourier import Plan, plan_outline
from .outline import COUNT, Outline, joined, outline
from .overlap import Overlap, clear_outline, is_clear
from .surface import Loft, Place

__all__ = ["Loft", "Place", "Wall", "wall_loft"]

WHERE = "glass.wall"
_ROUNDS = 6
_SAME = 1e-9  # share of the size to which width and depth are met


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """A printable wall: a base curve lofted upward, with a thickness and the bead's relief."""

    plan: Plan = nested(Plan, "Base curve at the bottom")  # noqa: RUF009
    to_top: bool = param(False, help="Loft from the base curve to a second one at the top")
    top: Plan = nested(Plan, "Base curve at the top")  # noqa: RUF009
    width: float = param(0.0, "m", 0.0, 2.0, "Size along X over the outer face; 0 as the plan is")
    depth: float = param(0.0, "m", 0.0, 2.0, "Size along Y over the outer face; 0 as the plan is")
    height: float = param(0.2, "m", 5e-3, 2.0, "Height; the topmost layer is ground off there")
    thickness: float = param(8.0e-3, "m", 1e-3, 0.05, "Wall thickness, from crest to crest")
    twist: float = param(0.0, "deg", -3600.0, 3600.0, "How far the top is turned about Z")
    scale: float = param(1.0, "", 0.1, 4.0, "Size of the top's plan over the bottom's")
    overlap: Literal["clip", "hull"] = param(
        "clip", help="Where the wall would run into itself: clip it, or take the convex hull"
    )
    faces: int = param(260_000, "", 1000, 4_000_000, "How many faces the mesh should have")
    bead: Bead = nested(Bead, "Relief of one printed layer")  # noqa: RUF009


def wall_loft(wall: Wall, curves: Sequence[Vector] = (), count: int = COUNT) -> Loft:
    """The surface midway in the wall, each outline at ``count`` points.

    ``curves``, closed polylines (M, 2) or (M, 3) in m, replace the record's plans: one serves all
    heights; two and more are a stack, at their own heights where these differ, which then is the
    wall's height too, and its foot is put on z = 0. ``width`` and ``depth`` above 0 stretch the
    plans, about the origin, until the widest level measures as much over its outer faces, along
    its own X and Y where the wall is twisted.

    Raises ParameterError when a value is out of bounds, a curve is open, crosses itself or leaves
    no room for the wall, or two curves of a stack lie at one height.
    """
    wall = from_table(Wall, to_table(wall), WHERE)
    radius = wall.thickness / 2 / min(1.0, wall.scale)
    if len(curves):
        heights = _heights(curves)
        drawn = [outline(curve, count, WHERE) for curve in _risen(curves, heights)]
        makers = [_drawn(found, 2 * radius, wall.overlap) for found in drawn]
    else:
        heights = np.array([0.0, wall.height])
        makers = [_planned(wall.plan, 2 * radius, wall.overlap, count)]
        makers += [_planned(wall.top, 2 * radius, wall.overlap, count)] * wall.to_top
    outlines = _stretched(makers, wall)
    if len(curves):
        outlines = _matched(outlines)
    levels = np.sort(heights - heights.min()) if len(outlines) > 1 else np.zeros(1)
    height = float(levels[-1]) or wall.height
    if len(outlines) == 2:
        levels = np.array([0.0, height])
    return Loft(tuple(outlines), levels / height, height, np.radians(wall.twist), wall.scale)


_Maker = Callable[[tuple[float, float]], Outline]


def _planned(plan: Plan, thickness: float, overlap: Overlap, count: int) -> _Maker:
    return lambda stretch: plan_outline(plan, thickness, overlap, stretch, count, WHERE)


def _drawn(found: Outline, thickness: float, overlap: Overlap) -> _Maker:
    def stretched(stretch: tuple[float, float]) -> Outline:
        count = len(found.points)
        points = found.points * stretch
        if not is_clear(points, thickness / 2):
            return clear_outline(points, thickness / 2, overlap, count, WHERE)
        return found if stretch == (1.0, 1.0) else outline(points, count, WHERE)

    return stretched


def _stretched(makers: Sequence[_Maker], wall: Wall) -> list[Outline]:
    """The outlines, stretched as the wall's width and depth ask.

    An outer face stands half a thickness outside the outline wherever that looks along an axis,
    so its extent is the outline's and one thickness. Clipping overlaps can change the extent, so
    that a few rounds may be needed.
    """
    stretch = np.ones(2)
    asked = np.array([wall.width, wall.depth])
    grown = max(1.0, wall.scale)
    inner = (asked - wall.thickness) / grown
    if np.any((asked > 0) & (inner <= 0)):
        raise ParameterError(
            f"[{WHERE}] A width of {wall.width * 1e3:.4g} mm or depth of {wall.depth * 1e3:.4g} mm "
            f"holds no wall of {wall.thickness * 1e3:.4g} mm; make it larger."
        )
    outlines = [make((1.0, 1.0)) for make in makers]
    for _ in range(_ROUNDS * bool(asked.any())):
        size = np.max([_extent(o) for o in outlines], axis=0)
        change = np.where(asked > 0, inner / size, 1.0)
        if np.abs(change - 1).max() < _SAME:
            break
        stretch = stretch * change
        outlines = [make((float(stretch[0]), float(stretch[1]))) for make in makers]
    return outlines


def _extent(found: Outline) -> Vector:
    """Width and depth (2,) in m of the outline's spline."""
    turn = np.arange(8 * len(found.points)) / (8 * len(found.points))
    plane = found.at(turn)[0]
    return np.array([np.ptp(plane.real), np.ptp(plane.imag)])


def _heights(curves: Sequence[Vector]) -> Vector:
    """Mean height in m of each curve, 0 for those in two dimensions."""
    return np.array([np.mean(c[:, 2]) if np.shape(c)[-1] == 3 else 0.0 for c in curves])


def _risen(curves: Sequence[Vector], heights: Vector) -> list[Vector]:
    """The curves from the lowest to the highest; a stack of three must differ in height."""
    order = np.argsort(heights, kind="stable")
    steps = np.diff(heights[order])
    if len(curves) > 2 and steps.min() <= 1e-3 * np.ptp(heights):
        z = heights[order][np.argmin(steps)] * 1e3
        raise ParameterError(
            f"[{WHERE}] Two curves of the stack lie at z {z:.4g} mm; give each its own height."
        )
    return [curves[i] for i in order]


def _matched(outlines: Sequence[Outline]) -> list[Outline]:
    """Each outline begun anew where it comes closest to the one below, in the square mean."""
    matched = [outlines[0]]
    for found in outlines[1:]:
        below, plane = (joined(o.points) for o in (matched[-1], found))
        alike = np.fft.ifft(np.fft.fft(below).conj() * np.fft.fft(plane)).real
        start = int(np.argmax(alike))
        matched.append(Outline(np.roll(found.points, -start, axis=0), found.notes))
    return matched
