"""How far a figure can be trusted: from how far it scatters between parts of the piece.

Roughness and a scanner's errors are alike over millimetres, so that neighbouring points tell the
same thing again; parts of the piece are nearly independent, and what a whole layer has of its own
shows between bands of layers alone. Of both divisions the larger scatter counts.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.stats import t as student_t

from ..core.scene import Vector

TO_95 = 1.96  # standard errors
_STRIPS = 6  # of the piece along the arc
_EDGE = np.sqrt(2 / np.pi)  # what a Gaussian's width fills of an edge of slope 1
_SHARP = 0.6  # of the bend that an edge keeps, from where on a valley counts as one
_BLUR = 0.5 / np.sqrt(np.pi)  # the Gaussian's width that keeps one wave of noise a layer


def student(parts: int) -> float:
    """How much a standard error from so few parts must grow for 1.96 of it to be 95 %."""
    return float(student_t.ppf(0.975, max(parts - 1, 1)) / TO_95)


def jackknifed(values: Vector) -> Vector:
    """Standard errors (K,) of figures that were found without one part at a time, (parts, K).

    [Efron & Tibshirani 1993]; rather large where single parts decide much.
    """
    return np.sqrt(max(len(values) - 1, 0) * values.var(axis=0)) if len(values) else values.sum(0)


def depth_error(arc: Vector, turns: Vector, left: Vector, crest: float, width: float) -> float:
    """Standard error in m of a profile's depth.

    ``left`` (N,) in m is what the profile leaves of the points at ``arc`` m and ``turns``, counted
    from the valley; ``crest`` is the crest's phase, ``width`` the share of a layer that the profile
    takes a mean over. It covers noise and roughness as far as they differ from one part of the
    piece to another, and never less than the scatter of the points in the valley and at the crest.
    """
    valley = np.abs(turns - np.round(turns)) < width / 2
    away = turns - crest
    top = np.abs(away - np.round(away)) < width / 2
    layer = np.where(valley, np.round(turns), np.round(away)).astype(np.intp)
    layer -= int(layer.min())
    strip = ((arc - arc.min()) / max(np.ptp(arc), 1e-12) * 0.999 * _STRIPS).astype(np.intp)
    scatter = 1.4826 * float(np.median(np.abs(left)))
    points = [max(np.count_nonzero(some), 1) for some in (valley, top)]
    least = 1.2533 * scatter * float(np.sqrt(1 / points[0] + 1 / points[1]))
    steps = (_steps(part, valley, top, left) for part in (layer * _STRIPS + strip, layer))
    return max(least, *steps)


def _steps(
    part: NDArray[np.intp], valley: NDArray[np.bool_], top: NDArray[np.bool_], left: Vector
) -> float:
    """Standard error of the mean step from valley to crest, by its scatter between the parts."""
    size = int(part.max()) + 1
    count = [np.bincount(part[some], minlength=size) for some in (valley, top)]
    total = [np.bincount(part[some], left[some], minlength=size) for some in (valley, top)]
    both = (count[0] > 0) & (count[1] > 0)
    if np.count_nonzero(both) < 3:
        return 0.0
    step = total[1][both] / count[1][both] - total[0][both] / count[0][both]
    weight = 1 / (1 / count[0][both] + 1 / count[1][both])
    share = weight / weight.sum()
    away = step - share @ step
    parts = 1 / float(share @ share)
    return float(np.sqrt(share**2 @ away**2 * parts / max(parts - 1, 1.0))) * student(int(parts))


def blunted(profile: Vector, period: float, waves: float, noise: float) -> float:
    """How much deeper in m a valley may be than the ``profile`` (M,) in m over ``period`` m.

    A profile of so many ``waves``, either way, is blurred as if by a Gaussian, and ``noise`` m,
    along the surface's normal, shifts points of a slope sideways: either fills an edge by
    0.8 · slope · width, and a rounded valley by less, the less sharp it is beside that.
    An estimate, within a third either way; it falls short where the noise is above a tenth of the
    depth.
    """
    count = len(profile)
    spline = CubicSpline(np.arange(count + 1), np.append(profile, profile[0]), bc_type="periodic")
    steep = np.percentile(np.abs(spline(np.arange(count), 1)), 95) * count / period
    if not steep > 0:
        return 0.0
    blur = _BLUR * period / waves
    aside = noise * steep / np.sqrt(1 + steep**2)
    both = np.hypot(blur, aside)
    around = int(np.argmin(profile)) + np.linspace(-1, 1, 33) * both / period * count
    bend = float(np.max(spline(around % count, 2))) * (count / period) ** 2
    sharp = np.clip(bend * both / (_SHARP * _EDGE * steep), 0.0, 1.0)
    return float(sharp**3 * _EDGE * steep * (blur + aside))
