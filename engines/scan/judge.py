"""What a registration came to: the pose, how sure it is, and what the shape leaves open."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .closest import Target, closest
from .settle import LOOSE, Fit, motion, turn_of

_PROBE = 0.02  # of the lever: how far a direction is tried to see whether it is loose
_REACH = 0.2  # of the lever: how far the tried points are looked for
_STEEP = 0.2  # a direction that shows this much is not
_BLOCKS = 4  # to a side; errors are taken to be alike within a block, and not between


@dataclass(frozen=True, slots=True)
class Registration:
    """Where the scan lies.

    ``matrix`` (4, 4) takes the scan's points in m to the design's; ``scale`` is its own, 1 unless
    fitted. ``rms`` in m is over the points that belong, ``inliers`` their share, ``overlap`` that
    of the points near the design. ``covariance`` (6, 6) is that of a small turn about X, Y and Z
    through ``pivot`` (3,) in rad, then of a shift in m; ``scale_deviation`` the standard deviation
    of the scale. ``loose`` (K, 6) are motions of about 1 m, turns in rad and shifts in m, that the
    shape does not determine: they stay as they were at the start and are not in the covariance.
    ``notes`` say what may be otherwise.
    """

    matrix: Vector
    scale: float
    rms: float
    inliers: float
    overlap: float
    iterations: int
    settled: bool
    covariance: Vector
    scale_deviation: float
    pivot: Vector
    loose: Vector
    notes: tuple[str, ...] = ()

    @property
    def turn_deviation(self) -> Vector:
        """Standard deviation (3,) of the turn about X, Y and Z in rad; π where it is loose."""
        return np.where(self._free[:3], np.pi, np.sqrt(np.diag(self.covariance)[:3]))

    @property
    def shift_deviation(self) -> Vector:
        """Standard deviation (3,) of the shift in m; infinite where it is loose."""
        return np.where(self._free[3:], np.inf, np.sqrt(np.diag(self.covariance)[3:]))

    @property
    def _free(self) -> NDArray[np.bool_]:
        """Which of the six a loose motion has a good part of."""
        largest = np.abs(self.loose).max(axis=1, keepdims=True, initial=1e-300)
        return (np.abs(self.loose) > 0.3 * largest).any(axis=0)


def judge(
    fit: Fit, target: Target, near: float, fit_scale: bool, others: list[Vector]
) -> Registration:
    """The pose with its covariance, from how the errors of whole blocks of points add up.

    ``others`` are poses (4, 4) that fit as well; points within ``near`` in m overlap the design.
    """
    terms = fit.terms(fit_scale)
    bread = (terms * fit.slope[:, None]).T @ terms
    values, vectors = np.linalg.eigh(bread / max(fit.slope.sum(), 1e-300))
    firm = np.array([_shows(fit, target, *one) for one in zip(values, vectors.T, strict=True)])
    inverse = (vectors[:, firm] / values[firm]) @ vectors[:, firm].T / max(fit.slope.sum(), 1e-300)
    block = _blocks(fit.points)
    scores = terms * (fit.weights * fit.feet.distance)[:, None]
    sums = np.stack([np.bincount(block, column) for column in scores.T], axis=1)
    count = len(sums)
    meat = sums.T @ sums * (count / max(count - terms.shape[1], 1))
    covariance = inverse @ meat @ inverse
    unit = np.repeat([1 / fit.lever, 1.0], 3)
    loose = vectors[:6, ~firm].T * unit
    away = np.abs(fit.feet.distance)
    inside = fit.weights > 0
    scale = float(np.cbrt(np.linalg.det(fit.matrix[:3, :3])))
    return Registration(
        matrix=fit.matrix,
        scale=scale,
        rms=float(np.sqrt((fit.feet.distance[inside] ** 2).mean())),
        inliers=float(inside.mean()),
        overlap=float((away < near).mean()),
        iterations=fit.iterations,
        settled=fit.settled,
        covariance=covariance[:6, :6] * np.outer(unit, unit),
        scale_deviation=float(np.sqrt(covariance[6, 6])) / fit.lever if fit_scale else 0.0,
        pivot=fit.pivot,
        loose=loose,
        notes=tuple(_notes(fit, loose, others)),
    )


def _shows(fit: Fit, target: Target, value: float, vector: Vector) -> bool:
    """Whether a motion of the points is seen in their distances, tried where it is doubtful.

    ``value`` is the mean square of what shows of it at first sight; the facets of a round piece
    seem to hold it, and do not.
    """
    if value > _STEEP**2:
        return True
    inside = fit.weights > 0
    length = _PROBE * fit.lever
    rise = -2 * (fit.feet.distance[inside] ** 2).mean()
    for side in (length, -length):
        matrix = motion(side * vector, fit.pivot, fit.lever)
        moved = fit.points[inside] @ matrix[:3, :3].T + matrix[:3, 3]
        rise += (closest(moved, target, _REACH * fit.lever).distance ** 2).mean()
    return bool(value > 0 and rise / 2 > (LOOSE * length) ** 2)


def _blocks(points: Vector) -> NDArray[np.intp]:
    """The number (N,) of the block of space that each point is in."""
    low, high = np.percentile(points, [2, 98], axis=0)
    cell = np.clip((points - low) / (high - low + 1e-300) * _BLOCKS, 0, _BLOCKS - 1).astype(int)
    number = (cell * [1, _BLOCKS, _BLOCKS**2]).sum(axis=1)
    return np.unique(number, return_inverse=True)[1]


def _notes(fit: Fit, loose: Vector, others: list[Vector]) -> list[str]:
    """What the shape leaves open, in sentences."""
    notes = []
    turns = any(np.abs(one[2]) * fit.lever > 0.5 for one in loose)
    if turns:
        notes.append(
            "The turn about the axis is not determined, as the piece is round: it is left as it "
            "was found."
        )
    if any(np.abs(one[5]) > 0.5 for one in loose):
        notes.append(
            "The height along the axis is not determined, as no end of the piece was scanned: it "
            "is left as it was found."
        )
    if len(loose) > len(notes):
        notes.append("The shape that was scanned leaves the pose loose; scan more of the piece.")
    said = _otherwise([other @ np.linalg.inv(fit.matrix) for other in others], turns)
    if said:
        notes.append(
            f"The scan fits as well {', or '.join(said)}: the pose that turns it least was taken."
        )
    if not fit.settled:
        notes.append("The registration had not come to rest when it was stopped.")
    return notes


def _otherwise(changes: list[Vector], round_piece: bool) -> list[str]:
    """What ``changes`` (4, 4) do, as in “turned by 90°”; what is no news is left out."""
    upright = [one for one in changes if one[2, 2] > 0.9]
    turns = {round(np.degrees(np.arctan2(one[1, 0], one[0, 0]))) % 360 for one in upright}
    turns -= {*range(4), *range(357, 360)}
    said = _turned(sorted(turns)) if turns and not round_piece else []
    for one in upright:
        if turn_of(one) < np.radians(3.5):
            said.append(f"{abs(one[2, 3]) * 1e3:.1f} mm {'higher' if one[2, 3] > 0 else 'lower'}")
    if any(one[2, 2] < -0.9 for one in changes):
        said.append("upside down")
    over = {round(np.degrees(turn_of(one))) for one in changes if abs(one[2, 2]) <= 0.9}
    return said + [f"turned over by {angle}°" for angle in sorted(over)]


def _turned(angles: list[int]) -> list[str]:
    step = 360 / (len(angles) + 1)
    even = all(abs(angle - step * (k + 1)) < 2 for k, angle in enumerate(angles))
    if even and len(angles) > 1:
        return [f"turned by any multiple of {step:.4g}°"]
    return [f"turned by {angle}°" for angle in angles]
