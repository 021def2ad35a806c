"""Registration: the scan of a finished piece laid onto its design, with what is uncertain in it."""

import numpy as np
from scipy.spatial.transform import Rotation

from ..core.errors import SceneError
from ..core.progress import SILENT, Progress, part
from ..core.scene import Vector
from .closest import Target
from .coarse import starts
from .judge import Registration, judge
from .settle import Fit, Sample, settle, turn_of

_STARTS, _FINALISTS = 16, 5
_FEW, _SOME, _MANY = 400, 2500, 15_000  # points to settle with: at first, finalists, at the end
_HOPELESS = 4.0  # times the best's misfit: no finalist
_CUT = 3e-3  # m; the farthest that a point counts as between starts
_SLIPS = (-3, -2, -1, 1, 2, 3)  # layers
_ORDERS = range(12, 1, -1)  # how often a piece may look alike in a turn


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
        start, *others = _alike(fits, sample.first(_SOME), target)
    progress(0.8, "Settling with many points")
    fit = settle(sample, target, start, 20, rest=1e-6, fit_scale=fit_scale)
    if np.count_nonzero(fit.weights) < 50:
        raise SceneError(
            "The scan touches the design nowhere; check that it is a scan of this piece, or move "
            "it closer."
        )
    progress(0.95, "Estimating the uncertainty")
    return judge(fit, target, near, fit_scale, others)


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


def _alike(fits: list[Fit], sample: Sample, target: Target) -> list[Vector]:
    """The poses that nothing tells apart from the best, the one that turns least first."""
    best = min(fits, key=_misfit)
    cut = 6 * best.sigma
    cost = best.cost(cut)

    def fits_as_well(fit: Fit) -> bool:
        worse = fit.cost(cut) - cost
        chance = 3 * worse.std() / np.sqrt(len(worse))
        return bool(worse.mean() <= max(chance, 0.1 * best.sigma**2))

    def turned(fit: Fit, share: float) -> Fit:
        return settle(sample, target, _about_axis(target, share) @ fit.matrix, 2)

    alike = [best]
    alike += [fit for fit in fits if not _same(fit, best) and fits_as_well(fit)]
    order = next((n for n in _ORDERS if fits_as_well(turned(best, 1 / n))), 1)
    for fit in list(alike):
        for step in range(1, order):
            other = turned(fit, step / order)
            if not any(_same(other, one) for one in alike):
                alike.append(other)
    return sorted((fit.matrix for fit in alike), key=lambda pose: round(np.degrees(turn_of(pose))))


def _about_axis(target: Target, share: float) -> Vector:
    """The motion (4, 4) by a share of a turn about the upright axis through the design's middle."""
    motion = np.eye(4)
    motion[:3, :3] = Rotation.from_rotvec([0.0, 0.0, 2 * np.pi * share]).as_matrix()
    corners = target.mesh.vertices[target.mesh.faces].mean(axis=1)
    middle = (corners * target.areas[:, None]).sum(axis=0) / target.areas.sum()
    motion[:3, 3] = middle - motion[:3, :3] @ middle
    return motion
