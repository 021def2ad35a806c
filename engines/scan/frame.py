"""Where the piece is: the cylinder or plane that its faces lie on, found among relief and strays.

The cylinder is written by its curvature, so that a plane is the one of curvature 0 and nothing
grows without bounds on the way there [Lukács, Martin & Marshall 1998].
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from ..core.errors import SceneError
from ..core.scene import Vector
from .boxes import boxed

_PLACES = 4000  # boxes that a fit looks at
_RELIEF = 0.3e-3  # m, the deviation beyond which a place counts less and less
_THINNEST = 1.5e-3  # m; two faces nearer than this are the relief of one
_FLAT = 0.1e-3  # m; a piece that bulges less than this is flat

_SCALE = np.array([0.1, 0.1, 0.1, 1e-3, 5.0, 1e-3])  # how far a first fit may move a frame


@dataclass(frozen=True, slots=True)
class Frame:
    """The base surface of a piece, and axes on it.

    ``axes`` (3, 3) rows: out of the glass at the middle of the piece, along the arc, and up the
    axis; ``origin`` (3,) in m on the outer base surface there. ``curvature`` in 1/m, 0 for a plane,
    is that of the outer base surface; the inner one lies ``thickness`` m further in, 0 where only
    one face was seen. ``cost`` is the robust mean deviation in m.
    """

    origin: Vector
    axes: Vector
    curvature: float
    thickness: float
    cost: float

    @property
    def radius(self) -> float:
        """Of the outer base surface in m; infinite for a plane."""
        return 1 / self.curvature if self.curvature else np.inf

    def unrolled(self, points: Vector) -> tuple[Vector, Vector, Vector]:
        """Arc on the outer base surface, height along the axis, and distance out of it, m (N,)."""
        x, y, z = ((points - self.origin) @ self.axes.T).T
        return *_unrolled(x, y, self.curvature), z

    def rolled(self, arc: Vector, out: Vector, z: Vector) -> Vector:
        """The points (N, 3) at these places: `unrolled` the other way."""
        if self.curvature:
            angle = arc * self.curvature
            radius = 1 / self.curvature + out
            half = 2 * np.sin(angle / 2) ** 2
            x = out - half * radius
            y = radius * np.sin(angle)
        else:
            x, y = out, arc
        return self.origin + np.stack([x, y, z], axis=-1) @ self.axes


def _unrolled(x: Vector, y: Vector, curvature: float) -> tuple[Vector, Vector]:
    """Arc and distance of places ``x`` out of and ``y`` along a circle through the origin."""
    if not curvature:
        return y, x
    reach = np.hypot(1 + curvature * x, curvature * y)
    out = (2 * x + curvature * (x * x + y * y)) / (reach + 1)
    return np.arctan2(curvature * y, 1 + curvature * x) / curvature, out


def fit_frame(points: Vector, seed: int = 0) -> Frame:
    """The frame of the piece that ``points`` (N, 3) in m were scanned from.

    A cylinder with one or two faces is fitted to boxes of equal size by robust least squares from
    several starts: the principal axes, curved either way, and circles through the points. Of these
    the best counts; one that bulges less than 0.1 mm is a plane. The third axis points toward the
    file's own +Z, or +Y or +X where it is square to that.

    Raises SceneError where the points lie on a line.
    """
    places = _boxes(points, seed)
    starts = _starts(places)
    few = places[:: max(1, len(places) // 1200)]
    rough = [_fitted(start, few, 60) for start in starts]
    best = min(rough, key=lambda frame: frame.cost)
    frame = _fitted(best, places, 60)
    return _upright(_centred(frame, places))


def refit(frame: Frame, points: Vector, heights: Vector, inner: NDArray[np.bool_]) -> Frame:
    """The frame nearest ``points`` (N, 3) that stand ``heights`` (N,) m out of it.

    ``inner`` (N,) says which are on the inner face, whose heights count inward.
    """

    def deviation(one: Frame) -> Vector:
        _, out, _ = one.unrolled(points)
        return np.where(inner, -one.thickness - out, out) - heights

    free = [1, 2, 3] + ([0, 4] if frame.curvature else []) + ([5] if frame.thickness else [])
    return _nearest(frame, deviation, free, 0.03 * _SCALE, "soft_l1", 15)[0]


def _nearest(
    start: Frame,
    deviation: Callable[[Frame], Vector],
    free: list[int],
    scale: Vector,
    loss: str,
    steps: int,
) -> tuple[Frame, float]:
    """``start`` moved to where its robust ``deviation`` in m is least, and that in m.

    ``free`` are the movements that may change, of those of `_moved`, ``scale`` (6,) their sizes.
    """

    def moved(values: Vector) -> Frame:
        every = np.zeros(6)
        every[free] = values
        return _moved(start, every)

    found: Any = least_squares(
        lambda values: deviation(moved(values)) / _RELIEF,
        np.zeros(len(free)),
        x_scale=scale[free],
        loss=loss,
        max_nfev=steps,
    )
    return moved(found.x), float(np.sqrt(2 * found.cost / len(found.fun))) * _RELIEF


def _moved(frame: Frame, values: Vector) -> Frame:
    """The frame turned about out, arc and axis in rad, moved out, bent in 1/m and thickened."""
    turn = Rotation.from_rotvec(values[:3] @ frame.axes)
    axes = frame.axes @ turn.as_matrix().T
    origin = frame.origin + values[3] * frame.axes[0]
    return replace(
        frame,
        origin=origin,
        axes=axes,
        curvature=frame.curvature + values[4],
        thickness=frame.thickness + values[5],
    )


def _boxes(points: Vector, seed: int) -> Vector:
    """Means of the points in some thousand boxes of equal size, those with hardly any left out."""
    some = points
    if len(points) > 400_000:
        picked = np.random.default_rng(seed).integers(len(points), size=400_000)
        some = points[picked]
    low, high = np.percentile(some, [0.5, 99.5], axis=0)
    size = high - low
    sides = np.sort(size)
    if not sides[1] > 1e-3:
        raise SceneError("The scan's points lie on a line; scan a face of the piece.")
    room = 0.1 * size
    some = some[((some > low - room) & (some < high + room)).all(axis=1)]
    edge = float(np.sqrt(4 * sides[1] * sides[2] / _PLACES))
    boxes = boxed(some, some.min(axis=0), edge)
    return boxes.means(some)[boxes.count >= max(2, 0.15 * np.median(boxes.count))]


def _starts(places: Vector) -> list[Frame]:
    """Frames to begin from: each principal axis as the axis, bent either way, flat, or a circle."""
    middle = np.median(places, axis=0)
    _, _, principal = np.linalg.svd(places - places.mean(axis=0), full_matrices=False)
    starts = []
    for up, out in ((principal[1], principal[2]), (principal[0], principal[2])):
        for sign in (1.0, -1.0):
            axes = np.stack([sign * out, np.cross(up, sign * out), up])
            x, y, _ = ((places - middle) @ axes.T).T
            bend = -2 * np.polyfit(y, x, 2)[0]
            if bend > 0:
                starts.append(Frame(middle, axes, float(bend), 0.0, np.inf))
    for up in principal:
        aside = principal[0] if abs(up @ principal[0]) < 0.5 else principal[1]
        u, v = aside, np.cross(up, aside)
        plane = np.column_stack([(places - middle) @ u, (places - middle) @ v])
        system = np.column_stack([2 * plane, np.ones(len(plane))])
        centre = np.linalg.lstsq(system, (plane**2).sum(axis=1), rcond=None)[0][:2]
        radius = float(np.median(np.hypot(*(plane - centre).T)))
        toward = -centre if np.hypot(*centre) > 0.3 * radius else np.array([1.0, 0.0])
        toward = toward / np.linalg.norm(toward)
        out = toward @ np.stack([u, v])
        origin = middle + (centre + radius * toward) @ np.stack([u, v])
        axes = np.stack([out, np.cross(up, out), up])
        bend = 1 / max(radius, 1e-3)
        starts.append(Frame(origin, axes.astype(np.float64), bend, 0.0, np.inf))
    return [_with_faces(start, places) for start in starts]


def _with_faces(start: Frame, places: Vector) -> Frame:
    """The start moved onto its outer face, the inner one as far in as the points say."""
    _, out, _ = start.unrolled(places)
    low, high = np.percentile(out, [2, 98])
    if high - low < _THINNEST:
        middle = float(np.median(out))
        return replace(start, origin=start.origin + middle * start.axes[0])
    for _ in range(20):
        border = (low + high) / 2
        low, high = float(np.mean(out[out <= border])), float(np.mean(out[out > border]))
    thickness = high - low if high - low > _THINNEST else 0.0
    shift = high if thickness else float(np.median(out))
    bend = start.curvature / max(1 + start.curvature * shift, 0.1)
    return replace(
        start,
        origin=start.origin + shift * start.axes[0],
        curvature=bend,
        thickness=thickness,
    )


def _fitted(start: Frame, places: Vector, steps: int) -> Frame:
    """The start moved to where the robust deviation of ``places`` (N, 3) is least."""

    def deviation(one: Frame) -> Vector:
        _, out, _ = one.unrolled(places)
        if start.thickness:
            inner = out + one.thickness
            out = np.where(np.abs(inner) < np.abs(out), inner, out)
        return out

    free = [0, 1, 2, 3, 4] + ([5] if start.thickness else [])
    frame, cost = _nearest(start, deviation, free, _SCALE, "cauchy", steps)
    thickness = frame.thickness if frame.thickness >= _THINNEST else 0.0
    return replace(frame, cost=cost, thickness=thickness)


def _centred(frame: Frame, places: Vector) -> Frame:
    """The same surface, convex outward, its origin in the middle of the piece."""
    curvature, axes, origin = frame.curvature, frame.axes, frame.origin
    thickness = frame.thickness
    if curvature < 0:
        axes = np.stack([-axes[0], -axes[1], axes[2]])
        origin = origin + thickness * axes[0]
        curvature = -curvature / (1 - curvature * thickness)
    frame = replace(frame, origin=origin, axes=axes, curvature=curvature)
    arc, out, z = frame.unrolled(places)
    near = (np.abs(out) < 2e-3) | (np.abs(out + thickness) < 2e-3)
    arc, z = arc[near], z[near]
    if np.ptp(np.percentile(arc, [1, 99])) ** 2 * curvature / 8 < _FLAT:
        frame, curvature = replace(frame, curvature=0.0), 0.0
    middle = float(np.mean(np.percentile(arc, [2, 98])))
    level = float(np.mean(np.percentile(z, [2, 98])))
    if curvature and np.ptp(np.percentile(arc, [1, 99])) * curvature > 1.8 * np.pi:
        middle = 0.0
    place = frame.rolled(np.array([middle]), np.zeros(1), np.array([level]))[0]
    angle = middle * curvature
    out_ = np.cos(angle) * frame.axes[0] + np.sin(angle) * frame.axes[1]
    axes = np.stack([out_, np.cross(frame.axes[2], out_), frame.axes[2]])
    return replace(frame, origin=place, axes=axes)


def _upright(frame: Frame) -> Frame:
    """The same surface with its axis pointing to the file's +Z, or else +Y, or else +X."""
    up = frame.axes[2]
    leading = next(up[i] for i in (2, 1, 0) if abs(up[i]) > 0.1)
    return frame if leading > 0 else turned_over(frame)


def turned_over(frame: Frame) -> Frame:
    """The same surface with the axis and the arc pointing the other way."""
    out, along, up = frame.axes
    return replace(frame, axes=np.stack([out, -along, -up]))
