"""The directions that the sun's light comes from in a year: each true sun, or a few for many."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from ..core.errors import ParameterError
from ..core.scene import Vector
from .position import sun_position
from .site import Site
from .sky import Suns
from .times import Times, check_order
from .weather import Weather

_MOST = 20_000  # directions that are covered one by one; more are put into small cells first
_CELLS = 6  # cells to the asked accuracy
_ROUNDS = 10  # of settling; more no longer lowers the error of shaded irradiation
_BITS = 16  # of a direction's place along either axis of the map by which suns are put in order
_DIM = 1e-6  # of the brightest: what a sun without light counts, so that it has a place too


def true_suns(weather: Weather | Times, site: Site) -> Suns:
    """One sun for each interval whose middle has the sun's centre above the horizon.

    ``weather``: T intervals, whose temperature and pressure bend the sun's light, or plain times
    (T,), datetime64 in UTC. ``weights`` (S, T) is sparse and holds a 1 for each sun: multiplied by
    (T,) of the intervals it gives (S,) of the suns. What shines in the first and last minutes of a
    day whose hour has its middle in the night is left out: 0.1 % of a clear hourly year at most.
    In polar night there are no suns. They follow each other by place, not by time.

    Raises ParameterError for a site out of bounds and for times as `check_order` says.
    """
    if isinstance(weather, Weather):
        air: dict[str, Any] = {"pressure": weather.pressure, "temperature": weather.temperature}
        directions = sun_position(check_order(weather.times), site, **air).direction
    else:
        directions = sun_position(check_order(weather), site).direction
    up = np.flatnonzero(directions[:, 2] > 0)
    up = up[_order(directions[up])]
    return Suns(directions[up], _shares(np.arange(len(up)), up, len(directions)), 0.0)


def merged_suns(directions: Vector, weights: Vector, accuracy_deg: float) -> Suns:
    """Few suns that stand for many, none farther than ``accuracy_deg`` from those it stands for.

    ``directions`` (T, 3): unit vectors to the sun, those at the horizon and below left out;
    ``weights`` (T,), not negative: how much light comes from each, in any unit. As few discs of
    that radius as a greedy search finds cover the suns; then each disc moves to the weighted mean
    of the suns nearest to it, as far as all of them stay within the accuracy. Every interval's
    light is kept: its column in ``weights`` (S, T), which is sparse, sums to 1. Where nothing is to
    be merged, as at accuracy 0, they are the true suns.

    Raises ParameterError for an accuracy below 0 or above 30°, for weights that are negative, not
    finite or not as many as the directions.
    """
    directions, weights = np.asarray(directions, float), np.asarray(weights, float)
    _check(directions, weights, accuracy_deg)
    up = np.flatnonzero(directions[:, 2] > 0)
    up = up[_order(directions[up])]
    points, light = directions[up], weights[up]
    if accuracy_deg == 0 or not len(up):
        return Suns(points, _shares(np.arange(len(up)), up, len(directions)), 0.0)
    reach = 2 * np.sin(np.radians(accuracy_deg) / 2)  # as a chord
    cell = _cells(points, reach)
    places = _means(points, np.ones(len(points)), cell)
    slack = np.linalg.norm(points - places[cell], axis=1).max()
    discs = places[_cover(places, reach - slack)]
    suns, owner = _settled(places, np.bincount(cell, light), discs, reach - slack)
    order = _order(suns)
    suns, nearest = suns[order], np.argsort(order)[owner[cell]]
    farthest = np.linalg.norm(points - suns[nearest], axis=1).max()
    shares = _shares(nearest, up, len(directions))
    return Suns(suns, shares, float(2 * np.arcsin(farthest / 2)))


def _order(directions: Vector) -> NDArray[np.int64]:
    """An order in which suns that follow each other are near: Z-order over an equal-area map.

    Rays are traced sixteen at a time, and faster where they go alike.
    """
    places = directions[:, :2] / np.sqrt(1 + np.abs(directions[:, 2:]))
    x, y = ((places + 1) / 2 * ((1 << _BITS) - 1)).astype(np.int64).T
    keys = np.zeros(len(directions), np.int64)
    for bit in range(_BITS):
        keys |= (x >> bit & 1) << 2 * bit | (y >> bit & 1) << 2 * bit + 1
    return np.argsort(keys, kind="stable")


def _check(directions: Vector, weights: Vector, accuracy_deg: float) -> None:
    if not 0 <= accuracy_deg <= 30:
        raise ParameterError(
            f"Suns merge to an accuracy of 0 to 30°, not {accuracy_deg:g}°; 1 to 2° are usual."
        )
    if directions.ndim != 2 or weights.shape != directions.shape[:1]:
        raise ParameterError(
            f"Suns need a direction and a weight each, not {directions.shape} and {weights.shape}."
        )
    bad = np.flatnonzero(~np.isfinite(weights) | (weights < 0))
    if bad.size:
        raise ParameterError(
            f"The weight of sun {bad[0]} is {weights[bad[0]]:g}; give 0 where no light is known."
        )


def _shares(suns: NDArray[np.integer], intervals: NDArray[np.integer], count: int) -> Any:
    """Which sun (k,) shines in which of ``count`` intervals (k,), as a sparse (S, T) of ones."""
    height = int(suns.max(initial=-1)) + 1
    return csr_array((np.ones(len(suns)), (suns, intervals)), shape=(height, count))


def _cells(points: Vector, reach: float) -> NDArray[np.int64]:
    """The cell (T,) that each point is in: its own, or with many points a small cube's."""
    if len(points) <= _MOST:
        return np.arange(len(points))
    cubes = np.floor(points / reach * _CELLS).astype(np.int64)
    span = 4 * int(_CELLS / reach) + 9
    keys = (cubes[:, 0] * span + cubes[:, 1]) * span + cubes[:, 2]
    return np.unique(keys, return_inverse=True)[1]


def _cover(points: Vector, reach: float) -> list[int]:
    """Points whose discs of radius ``reach`` cover all of them, the fullest disc first."""
    tree = KDTree(points)
    pairs = tree.query_pairs(reach, output_type="ndarray")
    ones = np.ones(len(pairs), np.int32)
    half = csr_array((ones, (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    near = (half + half.T).tocsr()
    gain = np.diff(near.indptr) + 1
    open_ = np.ones(len(points), bool)
    chosen = []
    while open_.any():
        best = int(gain.argmax())
        chosen.append(best)
        disc = np.append(near.indices[near.indptr[best] : near.indptr[best + 1]], best)
        fresh = disc[open_[disc]]
        open_[fresh] = False
        gain[fresh] -= 1
        gain -= np.bincount(near[fresh].indices, minlength=len(points))
    return chosen


def _settled(
    points: Vector, light: Vector, centres: Vector, reach: float
) -> tuple[Vector, NDArray[np.int64]]:
    """Centres moved to where most light is, and the one that each point belongs to.

    Each goes to the mean of its points and each point to the nearest centre, in turns [Lloyd 1982];
    but where a move would leave a point beyond the reach, the centre stays.
    """
    bright = light / light.max() + _DIM if light.any() else np.ones(len(points))
    nearest = KDTree(centres).query(points)[1]
    for _ in range(_ROUNDS):
        used, nearest = np.unique(nearest, return_inverse=True)
        still, moved = centres[used], _means(points, bright, nearest)
        distance, owner = KDTree(moved).query(points)
        while (distance > reach).any():
            held = np.unique(nearest[distance > reach])
            moved[held] = still[held]
            distance, owner = KDTree(moved).query(points)
        centres, nearest = moved, owner
    used, nearest = np.unique(nearest, return_inverse=True)
    return centres[used], nearest


def _means(points: Vector, light: Vector, group: NDArray[np.integer]) -> Vector:
    """Unit vectors (G, 3) to the weighted mean of each group of points."""
    sums = np.column_stack([np.bincount(group, light * axis) for axis in points.T])
    return sums / np.linalg.norm(sums, axis=1, keepdims=True)
