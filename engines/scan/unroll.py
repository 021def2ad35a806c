"""The piece laid flat: which points belong to which face, and how far they stand out of it."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.spatial import KDTree

from ..core.scene import Vector
from .boxes import boxed
from .frame import Frame

_BOX = 0.7e-3  # m, over which a normal is taken
_NEIGHBOURS = 14
_STEEP = 0.45  # a normal that leans further out of the radial direction is a cut's
_STACK = 3  # boxes above one another that make a cut, where a face has one
_CELL = 0.5e-3
_RIM = 1.0e-3  # m, how far from a cut a face counts as its edge
_REACH = 3.0  # times the middle half of the heights, beyond which a point is astray
_AWAY = 3e-3  # m out of the faces, where nothing of the piece is
_FEWEST = 500
_ENOUGH = 1_000_000  # points to tell cuts by


@dataclass(frozen=True, slots=True)
class Face:
    """One face of the piece, unrolled: arc and z on the outer base surface, and height out of it.

    All (N,) float64 in m; ``height`` is positive out of the glass on either face. ``points`` (N, 3)
    are the same in the scan's own axes.
    """

    inner: bool
    points: Vector
    arc: Vector
    z: Vector
    height: Vector

    @property
    def name(self) -> str:
        return "inner" if self.inner else "outer"


@dataclass(frozen=True, slots=True)
class Cells:
    """Means over square cells of ``edge`` m: (C,) arrays in m, ``count`` the points in each.

    ``row`` along z and ``column`` along the arc (C,) say where a cell lies in a grid of ``shape``;
    ``corner`` is the arc and z in m where the grid begins.
    """

    arc: Vector
    z: Vector
    height: Vector
    count: Vector
    row: NDArray[np.intp]
    column: NDArray[np.intp]
    shape: tuple[int, int]
    edge: float
    corner: tuple[float, float]

    def thinned(self, most: int) -> "Cells":
        """At most so many of the cells, picked evenly at random."""
        if len(self.arc) <= most:
            return self
        kept = np.sort(np.random.default_rng(0).choice(len(self.arc), most, replace=False))
        names = ("arc", "z", "height", "count", "row", "column")
        return replace(self, **{name: getattr(self, name)[kept] for name in names})

    def gridded(self, values: Vector) -> Vector:
        """``values`` (C,) as a grid (rows, columns), NaN where there is no cell."""
        grid = np.full(self.shape, np.nan)
        grid[self.row, self.column] = values
        return grid


def split_faces(points: Vector, frame: Frame, inward: bool) -> list[Face]:
    """The faces of the piece that ``points`` (N, 3) in m were scanned from, the outer one first.

    What is seen edge-on (by normals over 2 mm), within 1 mm of it, or far out of the face is left
    out. ``inward`` says that a single face is the inner one of its wall.
    """
    arc, out, z = frame.unrolled(points)
    some = np.flatnonzero((out > -frame.thickness - _AWAY) & (out < _AWAY))
    some = some[~_on_cut(arc[some], out[some], z[some])]
    inner = out[some] < -frame.thickness / 2
    sides = [(False, some[~inner]), (True, some[inner])]
    if not frame.thickness:
        sides = [(inward, some)]
    faces = [laid_flat(points[which], frame, side) for side, which in sides if len(which) > _FEWEST]
    faces = [_sound(face) for face in faces]
    most = max((len(face.arc) for face in faces), default=0)
    return [face for face in faces if len(face.arc) > 0.1 * most]


def laid_flat(points: Vector, frame: Frame, inner: bool) -> Face:
    """The face that ``points`` (N, 3) in m are on, seen from ``frame``."""
    arc, out, z = frame.unrolled(points)
    return Face(inner, points, arc, z, -frame.thickness - out if inner else out)


def _sound(face: Face) -> Face:
    """The face without points astray."""
    some = face.height[:: len(face.height) // 100_000 + 1]
    low, middle, high = np.percentile(some, [20, 50, 80])
    good = np.abs(face.height - middle) < _REACH * max(high - low, 1e-4)
    return Face(face.inner, face.points[good], face.arc[good], face.z[good], face.height[good])


def _on_cut(arc: Vector, out: Vector, z: Vector) -> NDArray[np.bool_]:
    """Which points lie on the piece's sawn edges or beside them."""
    flat = np.column_stack([arc, out, z])
    low = flat.min(axis=0)
    some = flat[:: -(-len(flat) // _ENOUGH)]
    boxes = boxed(some, low, _BOX)
    mean = boxes.means(some)[boxes.count >= max(1, 0.1 * np.median(boxes.count))]
    if len(mean) <= _NEIGHBOURS:
        return np.zeros(len(arc), dtype=bool)
    _, beside = KDTree(mean).query(mean, _NEIGHBOURS, workers=-1)
    around = mean[beside] - mean[beside].mean(axis=1, keepdims=True)
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", around, around))
    cut = mean[np.abs(axes[:, 1, 0]) < _STEEP]

    place = ((cut - low) / _CELL).astype(np.intp)
    span = np.ceil((flat.max(axis=0) - low) / _CELL).astype(np.intp) + 1
    stacked = np.zeros((span[0], span[2]))
    np.add.at(stacked, (place[:, 0], place[:, 2]), 1)
    reach = round(_RIM / _CELL)
    disc = np.hypot(*np.mgrid[-reach : reach + 1, -reach : reach + 1]) <= reach + 0.5
    rim = np.asarray(binary_dilation(stacked >= _STACK, disc), dtype=bool)
    return rim[((arc - low[0]) / _CELL).astype(np.intp), ((z - low[2]) / _CELL).astype(np.intp)]


def cells_of(face: Face, edge: float, values: Vector | None = None) -> Cells:
    """The face's heights, or other ``values`` (N,) at its points, as means over cells of ``edge``.

    Cells with less than a tenth of the usual number of points are left out.
    """
    corner = float(face.arc.min()), float(face.z.min())
    column = ((face.arc - corner[0]) / edge).astype(np.intp)
    row = ((face.z - corner[1]) / edge).astype(np.intp)
    shape = int(row.max()) + 1, int(column.max()) + 1
    key = row * shape[1] + column
    total = shape[0] * shape[1]
    count = np.bincount(key, minlength=total).astype(float)
    held = np.flatnonzero(count >= max(1.0, 0.1 * np.median(count[count > 0])))

    def mean(values: Vector) -> Vector:
        return np.bincount(key, weights=values, minlength=total)[held] / count[held]

    return Cells(
        arc=mean(face.arc),
        z=mean(face.z),
        height=mean(face.height if values is None else values),
        count=count[held],
        row=held // shape[1],
        column=held % shape[1],
        shape=shape,
        edge=edge,
        corner=corner,
    )
