"""Registration: the scan of a finished piece laid onto its design, with what is uncertain in it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ..core.errors import SceneError
from ..core.progress import SILENT, Progress, part
from ..core.scene import Vector
from .closest import Target, closest
from .coarse import starts
from .settle import LOOSE, Fit, Sample, motion, settle

_STARTS, _FINALISTS = 24, 6
_FEW, _SOME, _MANY = 400, 3000, 20_000  # points to settle with: at first, finalists, at the end
_HOPELESS = 4.0  # times the best's misfit: no finalist
_CUT = 3e-3  # m; the farthest that a point counts as between starts
_PROBE = 0.02  # of the lever: how far a direction is tried to see whether it is loose
_REACH = 0.2  # of the lever: how far the tried points are looked for
_STEEP = 0.2  # a direction that shows this much is not
_BLOCKS = 4  # to a side; errors are taken to be alike within a block, and not between
_SLIPS = (-3, -2, -1, 1, 2, 3)  # layers


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


def register(
    sample: Sample,
    target: Target,
    *,
    start: Vector | None = None,
    fit_scale: bool = False,
    pitch: float = 0.0,
    near: float = 5e-3,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Registration:
    """The pose of a scan on the design.

    Normals of the scan keep its outside from settling on the inside of a thin wall. ``start``
    (4, 4) is a pose near by; without one, all are searched. ``fit_scale`` lets the scan grow or
    shrink. ``pitch`` in m is the design's layer height, by which a piece can slip unnoticed, 0 for
    none. Points within ``near`` in m of the design count as overlapping it.

    Where several poses fit alike, the one that turns the scan least is taken, and said.

    Raises SceneError where no point comes to lie on the design, Cancelled when ``progress`` is
    asked to stop.
    """
    rng = np.random.default_rng(seed)
    many = rng.permutation(len(sample.points))[:_MANY]
    sample = Sample(sample.points[many], None if sample.normals is None else sample.normals[many])
    others: list[Vector] = []
    if start is None:
        fits = _searched(sample, target, rng, part(progress, 0.0, 0.7))
        fits += _slipped(fits[0], pitch, sample.first(_SOME), target, part(progress, 0.7, 0.8))
        start, *others = _alike(fits)
    progress(0.8, "Settling with many points")
    fit = settle(sample, target, start, 30, rest=1e-6, fit_scale=fit_scale)
    if np.count_nonzero(fit.weights) < 50:
        raise SceneError(
            "The scan touches the design nowhere; check that it is a scan of this piece, or move "
            "it closer."
        )
    progress(0.95, "Estimating the uncertainty")
    return _judged(fit, target, near, fit_scale, others)


def _searched(
    sample: Sample, target: Target, rng: np.random.Generator, progress: Progress
) -> list[Fit]:
    """Poses from all over, the best first, settled with a few points and then with more."""
    progress(0.0, "Looking for the scan's axis")
    poses = starts(sample.points, target, rng, _STARTS)
    fits = []
    for index, pose in enumerate(poses):
        progress(0.2 + 0.4 * index / len(poses), f"Start {index + 1} of {len(poses)}")
        fits.append(settle(sample.first(_FEW), target, pose, 15))
    best: list[Fit] = []
    for fit in sorted(fits, key=_misfit):
        hopeless = best and _misfit(fit) > _HOPELESS * _misfit(best[0])
        if len(best) < _FINALISTS and not hopeless and not any(_same(fit, one) for one in best):
            best.append(fit)
    finals = []
    for index, fit in enumerate(best):
        progress(0.6 + 0.4 * index / len(best), f"Finalist {index + 1} of {len(best)}")
        finals.append(settle(sample.first(_SOME), target, fit.matrix, 20))
    return sorted(finals, key=_misfit)


def _slipped(
    fit: Fit, pitch: float, sample: Sample, target: Target, progress: Progress
) -> list[Fit]:
    """The pose settled anew some layers higher and lower."""
    fits = []
    for layers in _SLIPS if pitch else ():
        progress(0.5 + layers / 7, "Counting layers")
        lifted = fit.matrix.copy()
        lifted[2, 3] += layers * pitch
        slid = settle(sample, target, lifted, 5)
        if not _same(slid, fit):
            fits.append(slid)
    return fits


def _misfit(fit: Fit) -> float:
    return float(fit.cost(_CUT).mean())


def _same(one: Fit, other: Fit) -> bool:
    """Whether two poses bring nearly all points to within 3 mm of one another."""
    return bool(np.quantile(np.linalg.norm(one.points - other.points, axis=1), 0.9) < 3e-3)


def _alike(fits: list[Fit]) -> list[Vector]:
    """The poses that nothing tells apart from the best, the one that turns least first."""
    best = min(fits, key=_misfit)
    cut = 6 * best.sigma
    cost = best.cost(cut)
    alike = []
    for fit in [best, *(fit for fit in fits if not _same(fit, best))]:
        worse = fit.cost(cut) - cost
        chance = 3 * worse.std() / np.sqrt(len(worse))
        if worse.mean() <= max(chance, 0.1 * best.sigma**2):
            alike.append((round(np.degrees(_angle(fit.matrix))), worse.mean(), fit.matrix))
    return [matrix for *_, matrix in sorted(alike, key=lambda one: one[:2])]


def _angle(matrix: Vector) -> float:
    """By how much in rad a matrix (4, 4) turns."""
    return float(Rotation.from_matrix(matrix[:3, :3]).magnitude())


def _judged(
    fit: Fit, target: Target, near: float, fit_scale: bool, others: list[Vector]
) -> Registration:
    """The pose with its covariance, from how the errors of whole blocks of points add up."""
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
    if len(loose) > sum(len(note) > 0 for note in notes):
        notes.append("The shape that was scanned leaves the pose loose; scan more of the piece.")
    said = dict.fromkeys(filter(None, (_otherwise(fit.matrix, one, turns) for one in others)))
    if said:
        notes.append(
            f"The scan fits as well {', or '.join(said)}: the pose that turns it least was taken."
        )
    if not fit.settled:
        notes.append("The registration had not come to rest when it was stopped.")
    return notes


def _otherwise(matrix: Vector, other: Vector, round_piece: bool) -> str:
    """How another pose differs, as in “turned by 90°”; nothing where it is no news."""
    change = other @ np.linalg.inv(matrix)
    if change[2, 2] < -0.9:
        return "upside down"
    if change[2, 2] < 0.9:
        return f"turned over by {np.degrees(_angle(change)):.0f}°"
    turn = np.degrees(np.arctan2(change[1, 0], change[0, 0]))
    if abs(turn) > 3.0:
        return "" if round_piece else f"turned by {turn % 360:.0f}°"
    return f"{abs(change[2, 3]) * 1e3:.1f} mm {'higher' if change[2, 3] > 0 else 'lower'}"
