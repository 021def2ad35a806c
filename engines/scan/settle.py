"""Iterated closest points: a scan settles onto its design from a start near by.

The distances are those to the surface itself, edges and all, weighted by Tukey's function of a
robust deviation that shrinks as the scan settles [Chen & Medioni 1992; Bergström & Edlund 2014];
steps that go on in one direction grow, as Besl & McKay's [1992] do.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from ..core.scene import Vector
from .closest import Feet, Target, closest

LOOSE = 0.01
"""A motion of which less than this shows in the distances is one that the shape leaves loose."""

_TUKEY = 4.685  # deviations beyond which a point has no weight
_FASTER, _FASTEST = 1.5, 20.0  # times its length that a step becomes, each time and at most
_SAME_WAY = 0.8  # cosine between steps that go on
_MISSED = 0.05  # of the design's size beyond which a point surely missed


@dataclass(frozen=True, slots=True)
class Sample:
    """Points (N, 3) in m of a scan and their outward unit normals (N, 3), or None."""

    points: Vector
    normals: Vector | None = None

    def first(self, count: int) -> "Sample":
        """The first ``count`` of them."""
        return Sample(self.points[:count], None if self.normals is None else self.normals[:count])


@dataclass(frozen=True, slots=True)
class Fit:
    """A pose on the way.

    ``matrix`` (4, 4); ``points`` (N, 3) under it, their ``feet`` on the design and their
    ``weights`` (N,) in 0..1, 0 for what does not belong; ``sigma`` the robust standard deviation
    of the distances in m; ``settled`` whether it had come to rest.
    """

    matrix: Vector
    points: Vector
    feet: Feet
    weights: Vector
    sigma: float
    iterations: int
    settled: bool

    @property
    def pivot(self) -> Vector:
        """What small motions are about: the points' middle (3,)."""
        return self.points.mean(axis=0)

    @property
    def lever(self) -> float:
        """How far in m the points lie from their middle: a turn of 1 moves them about so far."""
        return lever_of(self.points)

    @property
    def slope(self) -> Vector:
        """How the weighted squares change as the weights do (N,), Tukey's ψ′."""
        relative = (self.feet.distance / (_TUKEY * self.sigma)) ** 2
        return np.where(self.weights > 0, (1 - relative) * (1 - 5 * relative), 0.0)

    def terms(self, scale: bool) -> Vector:
        """How the distances change with a turn times the lever, a shift and a scale (N, 6 or 7)."""
        return _terms(self.points - self.pivot, self.feet.toward, self.lever, scale)

    def cost(self, cut: float) -> Vector:
        """Squared distances (N,) in m²; of points that do not belong that of the ``cut`` in m."""
        square = np.minimum(self.feet.distance**2, cut**2)
        return np.where(self.weights > 0, square, cut**2)


def settle(
    sample: Sample,
    target: Target,
    matrix: Vector,
    rounds: int,
    *,
    rest: float = 1e-5,
    fit_scale: bool = False,
) -> Fit:
    """The pose from the start ``matrix`` (4, 4), after a step below ``rest`` in m or ``rounds``."""
    missed = _MISSED * float(np.linalg.norm(np.ptp(target.anchors, axis=0)))
    lever = lever_of(sample.points)
    still, count, gain = False, 0, 1.0
    last = np.zeros(6 + fit_scale)
    while True:
        moved = sample.points @ matrix[:3, :3].T + matrix[:3, 3]
        feet = closest(moved, target, missed)
        weights, sigma = _weights(feet, sample.normals, matrix, target, missed)
        if still or count == rounds or not weights.any():
            return Fit(matrix, moved, feet, weights, sigma, count, still)
        pivot = moved.mean(axis=0)
        terms = _terms(moved - pivot, feet.toward, lever, fit_scale)
        step = _step(terms, feet.distance, weights)
        gain = min(_FASTER * gain, _FASTEST) if _onward(step, last) else 1.0
        matrix = motion(gain * step, pivot, lever) @ matrix
        last = step
        count += 1
        still = bool(np.linalg.norm(step) < rest)


def _onward(step: Vector, last: Vector) -> bool:
    """Whether a step goes the way of the last one, as when a scan slides slowly along a wall."""
    return bool(step @ last > _SAME_WAY * np.linalg.norm(step) * np.linalg.norm(last) > 0)


def lever_of(points: Vector) -> float:
    """How far in m the points (N, 3) typically lie from their middle."""
    return float(np.median(np.linalg.norm(points - np.median(points, axis=0), axis=1)))


def turn_of(matrix: Vector) -> float:
    """By how much in rad a matrix (4, 4) turns."""
    return float(Rotation.from_matrix(matrix[:3, :3]).magnitude())


def motion(step: Vector, pivot: Vector, lever: float) -> Vector:
    """The matrix (4, 4) of a ``step`` (6 or 7,) in m: turn and scale about ``pivot``, and shift."""
    turn = Rotation.from_rotvec(step[:3] / lever).as_matrix()
    if len(step) == 7:
        turn = turn * (1 + step[6] / lever)
    moved = np.eye(4)
    moved[:3, :3] = turn
    moved[:3, 3] = pivot + step[3:6] - turn @ pivot
    return moved


def _weights(
    feet: Feet, normals: Vector | None, matrix: Vector, target: Target, missed: float
) -> tuple[Vector, float]:
    """Tukey's weights (N,), and the robust standard deviation in m that they come from."""
    away = np.abs(feet.distance)
    belongs = away < missed
    if normals is not None:
        turned = normals @ matrix[:3, :3].T
        belongs &= np.einsum("ij,ij->i", turned, target.normals[feet.face]) > 0
    if not belongs.any():
        return np.zeros(len(away)), missed
    sigma = max(1.4826 * float(np.median(away[belongs])), 1e-7)
    weights = np.maximum(1 - (away / (_TUKEY * sigma)) ** 2, 0.0) ** 2
    return np.where(belongs, weights, 0.0), sigma


def _terms(arms: Vector, toward: Vector, lever: float, scale: bool) -> Vector:
    columns = [np.cross(arms, toward) / lever, toward]
    if scale:
        columns.append(np.einsum("ij,ij->i", arms, toward)[:, None] / lever)
    return np.concatenate(columns, axis=1)


def _step(terms: Vector, distance: Vector, weights: Vector) -> Vector:
    """The motion that lessens the distances most, none in directions that hardly change them."""
    normal = (terms * weights[:, None]).T @ terms / weights.sum()
    values, vectors = np.linalg.eigh(normal)
    slope = vectors.T @ (terms.T @ (weights * distance) / weights.sum())
    firm = values > LOOSE**2
    return -vectors @ np.where(firm, slope / np.where(firm, values, 1.0), 0.0)
