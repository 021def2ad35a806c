"""The deviation of a scan from its design, spread over the design's own surface."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse

from ..core.scene import Vector
from .closest import Feet, Target

_ENOUGH = 16  # points that a vertex takes its deviation from
_RINGS = 12  # of neighbours that it takes them from at most
_ALONE = 5.0  # robust deviations from its neighbours at which a point is a stray
_SPARSE = 0.2  # of the usual number of points about it, below which it is one, too
_COLUMNS = 720  # of the unrolled picture at most
_CELL = 8  # points to a cell of it


@dataclass(frozen=True, slots=True)
class Spread:
    """What the points say of the design's surface.

    ``vertices`` (V,) float64: the deviation in m along the design's normal, NaN where nothing was
    seen; ``area`` (V,) m² the vertices' shares of the surface. ``belongs`` (N,) says which points
    count, ``noise`` in m is how those next to one another scatter.
    """

    vertices: Vector
    area: Vector
    belongs: NDArray[np.bool_]
    noise: float

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Which vertices have a deviation (V,)."""
        return np.isfinite(self.vertices)


def spread(feet: Feet, target: Target, near: float) -> Spread:
    """The deviations of points, by their feet on the design, brought to its vertices.

    Each vertex has the mean of some sixteen points about it, along the surface, so that the two
    sides of a wall keep apart. Points farther than ``near`` in m, those far off their neighbours
    and those that have hardly any are strays.
    """
    mesh = target.mesh
    belongs = (feet.face >= 0) & (np.abs(feet.distance) < near)
    corners, weights = _corners(feet, target, belongs)
    value = feet.distance[belongs]
    joined = _joined(mesh.vertices)
    count = int(joined.max()) + 1
    corners, faces = joined[corners], joined[mesh.faces]
    join = _neighbours(faces, count)
    rings = _rings(join, corners, weights, count)
    noise, keep = 0.0, np.ones(len(value), dtype=bool)
    smooth = np.full(count, np.nan)
    for _ in range(3):
        smooth = _smooth(join, corners[keep], weights[keep], value[keep], count, rings)
        rest = np.abs(value - (smooth[corners] * weights).sum(axis=1))
        known = np.isfinite(rest)
        noise = 1.4826 * float(np.median(rest[known])) if known.any() else 0.0
        keep = known & (rest <= _ALONE * noise + 1e-9)
    belongs = belongs.copy()
    belongs[belongs] = keep
    area = np.zeros(len(mesh.vertices))
    np.add.at(area, mesh.faces, target.areas[:, None] / 3)
    return Spread(smooth[joined], area, belongs, noise)


def _corners(
    feet: Feet, target: Target, some: NDArray[np.bool_]
) -> tuple[NDArray[np.intp], Vector]:
    """The corners (N, 3) about each foot, and their shares in it."""
    frame = target.frames[feet.face[some]]
    apart = feet.place[some] - frame[:, :3]
    along = np.einsum("ij,ij->i", apart, frame[:, 3:6])
    across = np.einsum("ij,ij->i", apart, frame[:, 6:9])
    uu, uv, vv = frame[:, 12:].T
    scale = 1 / (uu * vv - uv * uv)
    s, t = (vv * along - uv * across) * scale, (uu * across - uv * along) * scale
    shares = np.clip(np.column_stack([1 - s - t, s, t]), 0.0, 1.0)
    return target.mesh.faces[feet.face[some]].astype(np.intp), shares


def _joined(vertices: Vector) -> NDArray[np.intp]:
    """The same number (V,) for vertices at the same place."""
    order = np.lexsort(vertices.T)
    new = (np.diff(vertices[order], axis=0) != 0).any(axis=1)
    number = np.empty(len(vertices), dtype=np.intp)
    number[order] = np.concatenate([[0], np.cumsum(new)])
    return number


def _neighbours(faces: NDArray[np.intp], count: int) -> sparse.csr_array:
    """Ones (V, V) between vertices of a triangle, and on the diagonal."""
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    join = sparse.coo_array((np.ones(len(ends)), ends.T), shape=(count, count)).tocsr()
    join = (join + join.T + sparse.eye_array(count)).tocsr()
    join.data[:] = 1.0
    return join


def _rings(join: sparse.csr_array, corners: NDArray[np.intp], weights: Vector, count: int) -> int:
    """Over how many rings of neighbours a vertex that is seen finds enough points."""
    points = np.bincount(corners.ravel(), weights.ravel(), count)
    around = np.median(points[points > 0]) if points.any() else 1.0
    rings = 0
    while rings < _RINGS and around * (1 + 3 * rings * (rings + 1)) < _ENOUGH:
        rings += 1
    return rings


def _smooth(
    join: sparse.csr_array,
    corners: NDArray[np.intp],
    weights: Vector,
    value: Vector,
    count: int,
    rings: int,
) -> Vector:
    """The mean (V,) of the values about each vertex, NaN where there are hardly any."""
    weight = np.bincount(corners.ravel(), weights.ravel(), count)
    total = np.bincount(corners.ravel(), (weights * value[:, None]).ravel(), count)
    for _ in range(rings):
        weight, total = join @ weight, join @ total
    usual = np.median(weight[corners[:, 0]]) if len(corners) else 1.0
    return np.where(weight > _SPARSE * usual, total / np.maximum(weight, 1e-300), np.nan)


@dataclass(frozen=True, slots=True)
class Statistics:
    """A deviation in figures, by area: lengths in m, shares in 0..1, NaN where nothing was seen.

    The ``_deviation`` of mean and RMS are the standard deviations by how the eighths of the piece
    differ. ``largest`` has its sign and ``place`` (3,).
    """

    mean: float
    mean_deviation: float
    rms: float
    rms_deviation: float
    percentile_95: float
    largest: float
    place: Vector
    within: float
    coverage: float


_NOTHING = Statistics(
    mean=np.nan,
    mean_deviation=np.nan,
    rms=np.nan,
    rms_deviation=np.nan,
    percentile_95=np.nan,
    largest=np.nan,
    place=np.full(3, np.nan),
    within=np.nan,
    coverage=0.0,
)


def statistics(found: Spread, vertices: Vector, tolerance: float) -> Statistics:
    """What the deviation at the design's ``vertices`` (V, 3) comes to.

    ``within`` is the share of what was seen that is off by at most the ``tolerance`` in m.
    """
    seen = found.seen & (found.area > 0)
    if not seen.any():
        return _NOTHING
    value, area, place = found.vertices[seen], found.area[seen], vertices[seen]
    size = np.abs(value)
    order = np.argsort(size)
    shares = np.cumsum(area[order]) / area.sum()
    worst = order[-1]
    eighth = ((place > place.mean(axis=0)) * [1, 2, 4]).sum(axis=1)
    weight = np.bincount(eighth, area, 8)
    there = weight > 0.01 * weight.sum()
    means, squares = (
        np.bincount(eighth, area * what, 8)[there] / weight[there] for what in (value, value**2)
    )
    return Statistics(
        mean=float((area * value).sum() / area.sum()),
        mean_deviation=_of_mean(means),
        rms=float(np.sqrt((area * value**2).sum() / area.sum())),
        rms_deviation=_of_mean(np.sqrt(squares)),
        percentile_95=float(size[order][min(np.searchsorted(shares, 0.95), len(size) - 1)]),
        largest=float(value[worst]),
        place=place[worst],
        within=float(area[size <= tolerance].sum() / area.sum()),
        coverage=float(area.sum() / found.area.sum()),
    )


def _of_mean(values: Vector) -> float:
    """The standard deviation of the mean."""
    return float(values.std(ddof=1) / np.sqrt(len(values))) if len(values) > 1 else np.nan


def picture_of(turn: Vector, z: Vector, value: Vector, girth: float) -> Vector:
    """A side unrolled: the mean of N values in each cell (rows, columns), NaN where none are near.

    Row 0 is at the lowest ``z`` in m, column 0 at ``turn`` 0; ``girth`` in m goes with a turn.
    Cells are square and hold some eight points where the scan is even; gaps of a cell are bridged.
    """
    low, high = z.min(), z.max()
    tall = max(float(high - low), 1e-9)
    fitting = np.sqrt(max(len(value), 1) / _CELL * girth / tall)
    columns = int(np.clip(fitting, 24, _COLUMNS))
    rows = int(np.clip(round(columns * tall / girth), 4, 4 * _COLUMNS))
    column = np.minimum((turn * columns).astype(int), columns - 1)
    row = np.minimum(((z - low) / tall * rows).astype(int), rows - 1)
    cell = row * columns + column
    count = np.bincount(cell, minlength=rows * columns).reshape(rows, columns).astype(float)
    total = np.bincount(cell, value, rows * columns).reshape(rows, columns)
    near = {"sigma": 0.7, "mode": ("nearest", "wrap"), "truncate": 2.0}
    count, total = (ndimage.gaussian_filter(what, **near) for what in (count, total))
    return np.where(count > 0.2, total / np.maximum(count, 1e-300), np.nan)
