"""Where a scan may lie on its design: starts for the fine registration, from any place and turn.

A printed piece stands around an axis. Directions that the scan's axis may have come from its
normals and its principal axes, the axis's place from a circle, the height from both ends; around
the axis every turn is tried.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from ..core.scene import Vector
from .closest import Target

_SAMPLE = 20_000  # points on the design
_FEW, _LOOKED_AT = 300, 5000  # points of the scan that are moved about, and that its axes are from
_AROUND = 48  # turns tried around an axis
_NEIGHBOURS = 16
_ROUNDS = 6
_CUT = 0.05  # of the design's size: what is farther counts as this far
_SAME = 0.01  # of the design's size: places this close are one


@dataclass(frozen=True, slots=True)
class Frame:
    """An upright axis: ``centre`` (2,) in plan, ``low`` and ``high`` ends, in m."""

    centre: Vector
    low: float
    high: float


def starts(points: Vector, target: Target, rng: np.random.Generator, most: int) -> list[Vector]:
    """Up to ``most`` 4×4 matrices that take the scan's points (N, 3) about to the design.

    The likeliest first, by the mean distance of a few hundred points, in which none counts more
    than a twentieth of the design's size.
    """
    design, _ = target.sample(_SAMPLE, rng)
    tree, here = KDTree(design), _frame(design)
    size = float(np.linalg.norm(np.ptp(design, axis=0)))
    cut = _CUT * size
    seen = points[rng.permutation(len(points))[:_LOOKED_AT]]
    found: list[tuple[float, Vector]] = []
    for axis in _axes(seen):
        turn = _upright(axis)
        stood = seen @ turn.T
        poses = _poses(_shifts(stood, design, here, _SAME * size), turn)
        moved = np.einsum("pij,nj->pni", poses[:, :3, :3], seen[:_FEW]) + poses[:, None, :3, 3]
        away = tree.query(moved.reshape(-1, 3), distance_upper_bound=cut, workers=-1)[0]
        misfit = np.minimum(away, cut).reshape(-1, _AROUND, moved.shape[1]).mean(axis=2)
        around = np.minimum(np.roll(misfit, 1, axis=1), np.roll(misfit, -1, axis=1))
        least = np.flatnonzero((misfit <= around).ravel())
        found += [(float(misfit.ravel()[i]), poses[i]) for i in least]
    found.sort(key=lambda one: one[0])
    return [pose for _, pose in found[:most]]


def _normals(points: Vector) -> tuple[Vector, Vector]:
    """Unit normals (N, 3) of either sign from each point's neighbours, and how flat these lie (N,):
    1 in a plane, 0 in a ball.
    """
    near = points[KDTree(points).query(points, _NEIGHBOURS, workers=-1)[1]]
    near = near - near.mean(axis=1, keepdims=True)
    values, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", near, near))
    return vectors[..., 0], 1 - values[:, 0] / np.maximum(values[:, 1], 1e-300)


def _axes(points: Vector) -> list[Vector]:
    """Unit vectors that may be the axis, pointing up: each with its opposite."""
    normals, flat = _normals(points)
    weight = np.where(flat > 0.5, flat, 0.0)[:, None]
    about = normals - (normals * weight).sum(axis=0) / max(weight.sum(), 1e-300)
    vectors = [
        np.linalg.eigh((normals * weight).T @ normals)[1][:, :1],
        np.linalg.eigh((about * weight).T @ about)[1][:, :1],
        np.linalg.eigh(np.cov(_inner(points).T))[1],
    ]
    axes: list[Vector] = []
    for axis in np.concatenate(vectors, axis=1).T:
        if all(abs(axis @ other) < np.cos(np.radians(2.0)) for other in axes):
            axes.append(axis)
    return [sign * axis for axis in axes for sign in (1.0, -1.0)]


def _inner(points: Vector) -> Vector:
    """The points without the tenth that lies farthest out."""
    away = np.linalg.norm(points - np.median(points, axis=0), axis=1)
    return points[away <= np.quantile(away, 0.9)]


def _upright(axis: Vector) -> Vector:
    """A rotation (3, 3) that takes ``axis`` to +Z."""
    other = np.eye(3)[np.abs(axis).argmin()]
    x = np.cross(other, axis)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(axis, x), axis])


def _frame(points: Vector) -> Frame:
    """The axis of points that stand upright around it, strays apart."""
    plan, weight = points[:, :2], np.ones(len(points))
    middle = np.median(plan, axis=0)
    centre, away = middle, np.zeros(len(points))
    for _ in range(_ROUNDS):
        terms = np.column_stack([2 * (plan - middle), np.ones(len(plan))])
        square = ((plan - middle) ** 2).sum(axis=1)
        weighed = terms.T * weight
        centre = middle + np.linalg.pinv(weighed @ terms)[:2] @ (weighed @ square)
        ring = np.linalg.norm(plan - centre, axis=1)
        away = np.abs(ring - np.median(ring))
        weight = 1 / (1 + (away / max(float(np.median(away)), 1e-9) / 3) ** 2)
    near = away <= 6 * np.median(away) + 1e-9
    low, high = np.percentile(points[near, 2], [1, 99])
    return Frame(centre, float(low), float(high))


def _shifts(stood: Vector, design: Vector, here: Frame, same: float) -> list[tuple[Vector, Vector]]:
    """What goes where before turning: a place (3,) of the upright scan and one of the design."""
    there = _frame(stood)
    ends = [(there.low, here.low), (there.high, here.high)]
    ends.append(((there.low + there.high) / 2, (here.low + here.high) / 2))
    pairs = [(np.append(there.centre, z), np.append(here.centre, to)) for z, to in ends]
    pairs.append((np.median(stood, axis=0), np.median(design, axis=0)))
    kept: list[tuple[Vector, Vector]] = []
    for place, to in pairs:
        if all(np.linalg.norm((place - p) - (to - q)) > same for p, q in kept):
            kept.append((place, to))
    return kept


def _poses(shifts: list[tuple[Vector, Vector]], turn: Vector) -> Vector:
    """Matrices (P, 4, 4), for each shift all turns around the axis."""
    angles = np.arange(_AROUND) * (2 * np.pi / _AROUND)
    turns = Rotation.from_rotvec(angles[:, None] * np.array([0.0, 0.0, 1.0])).as_matrix()
    poses = np.tile(np.eye(4), (len(shifts), _AROUND, 1, 1))
    poses[..., :3, :3] = turns @ turn
    for some, (place, to) in zip(poses, shifts, strict=True):
        some[:, :3, 3] = to - turns @ place
    return poses.reshape(-1, 4, 4)
