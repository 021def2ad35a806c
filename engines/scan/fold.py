"""The fold: every point of a face laid into one layer, and the bead that their medians draw."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ..core.scene import Vector
from .layers import Layers
from .scatter import blunted, depth_error
from .unroll import Face

SAMPLES = 1024
_TO_A_BIN = 40  # points that a median is taken of, where there are enough
_FEWEST_BINS = 64
_STRIPS = 12  # along the arc, every other one for either half
_BAND = 1.3  # ratio of the wave numbers that a band of the bead's spectrum spans
_CLEAR = 2.0  # times the noise's power that a band must have to be known
_RECENT = np.log(4.0)  # of wave numbers, over which the bead's power fell before
_FALLS = (2.0, 12.0)  # powers of the wave number, that a bead's spectrum can fall with
_VALLEY = 0.25  # share of the depth that counts as the valley
_LEVELS = 200  # of the density picture


@dataclass(frozen=True, slots=True)
class Fold:
    """One layer's profile, from the raw points of a face.

    ``phase`` (B,) are the middles of the bins in 0..1, ``median`` (B,) in m the median height of
    the points in each, ``error`` (B,) the median's standard error, ``spread`` in m the robust
    scatter of the points about it. ``profile`` (1024,) in m is the bead at the phases i/1024: the
    medians without what is not the same in one half of the piece and the other. It is 0 where it is
    lowest, about phase 0, the middle of the valley, which lies ``base`` m over the face's slow
    trend. ``depth_error`` in m is the depth's standard error (see `scatter.depth_error`), and
    ``blunt`` how much deeper in m a valley may be, since it is sharper than the scan can tell (see
    `scatter.blunted`). ``density`` (200, B) counts points by height from ``lowest`` to ``highest``
    in m. ``points`` is how many were folded.
    """

    phase: Vector
    median: Vector
    error: Vector
    spread: float
    profile: Vector
    base: float
    depth_error: float
    blunt: float
    density: Vector
    lowest: float
    highest: float
    points: int

    @property
    def depth(self) -> float:
        """From valley to crest in m."""
        return float(np.ptp(self.profile))

    def spline(self) -> CubicSpline:
        """The profile as a function of phase in 0..1, periodic, in m."""
        places = np.arange(SAMPLES + 1) / SAMPLES
        values = np.append(self.profile, self.profile[0])
        return CubicSpline(places, values, bc_type="periodic")


def fold(face: Face, layers: Layers, start: float | None = None) -> tuple[Fold, float]:
    """The fold of ``face`` by ``layers``, and the phase that its valley has there.

    The slow trend is taken off first. Medians are of the raw points, so that noise and strays
    average out and nothing of the relief does. ``start`` is the phase to call 0, where another
    face has said it; left out, the deepest valley is.
    """
    height = face.height - layers.trend.at(face.arc, face.z)
    turns = layers.phases(face.arc, face.z)
    place = turns - np.floor(turns)
    bins = 1 << int(np.log2(np.clip(len(height) / _TO_A_BIN, _FEWEST_BINS, SAMPLES)))
    which = np.minimum((place * bins).astype(np.int16), bins - 1)
    median, error, spread = _medians(which, height, bins)
    strip = np.floor((face.arc - face.arc.min()) / np.ptp(face.arc) * 0.999 * _STRIPS)
    even = strip % 2 == 0
    halves = [_medians(which[part], height[part], bins)[0] for part in (even, ~even)]
    waves, kept = _smoothed(median, (halves[0], halves[1]))
    offset = _valley(_drawn(waves, 0.0)) if start is None else start % 1.0
    profile = _drawn(waves, offset)
    lowest = float(profile.min())
    step = round(offset * bins)
    low, high = lowest - 4 * spread, float(profile.max()) + 4 * spread
    level = np.clip((height - low) / (high - low) * _LEVELS, 0, _LEVELS - 1).astype(np.intp)
    density = np.bincount(level * bins + which, minlength=_LEVELS * bins).reshape(_LEVELS, bins)
    from_valley = turns - offset
    places = np.arange(SAMPLES + 1) / SAMPLES
    course = np.interp(from_valley - np.floor(from_valley), places, np.append(profile, profile[0]))
    crest = float(np.argmax(profile)) / SAMPLES
    found = Fold(
        phase=((np.arange(bins) + 0.5) / bins + (step / bins - offset)) % 1.0,
        median=np.roll(median, -step) - lowest,
        error=np.roll(error, -step),
        spread=spread,
        profile=profile - lowest,
        base=lowest,
        depth_error=depth_error(face.arc, from_valley, height - course, crest, 1 / kept),
        blunt=blunted(profile, layers.period, kept, spread),
        density=np.roll(density, -step, axis=1).astype(np.float64),
        lowest=low - lowest,
        highest=high - lowest,
        points=len(height),
    )
    return found, offset


def _valley(profile: Vector) -> float:
    """The phase of the deepest valley: the middle of its lowest part, which noise moves little."""
    lowest = int(np.argmin(profile))
    around = np.roll(profile, SAMPLES // 2 - lowest)
    deep = np.maximum(profile.min() + _VALLEY * np.ptp(profile) - around, 0.0)
    high = np.flatnonzero(deep == 0)
    if len(high):
        left, right = high[high < SAMPLES // 2], high[high > SAMPLES // 2]
        deep[: left.max(initial=0)] = 0.0
        deep[right.min(initial=SAMPLES) :] = 0.0
    middle = np.sum(np.arange(SAMPLES) * deep) / max(deep.sum(), 1e-300)
    return float((middle - SAMPLES // 2 + lowest) / SAMPLES % 1.0)


def _medians(which: NDArray[np.int16], height: Vector, bins: int) -> tuple[Vector, Vector, float]:
    """Median and its standard error in each bin, and the scatter about the medians."""
    order = np.argsort(which, kind="stable")
    ends = np.searchsorted(which[order], np.arange(bins + 1))
    ranked = height[order]
    median, spread = np.full(bins, np.nan), np.full(bins, np.nan)
    for index in range(bins):
        part = ranked[ends[index] : ends[index + 1]]
        if len(part):
            median[index] = np.median(part)
            spread[index] = 1.4826 * np.median(np.abs(part - median[index]))
    empty = np.isnan(median)
    if empty.any():
        at = np.arange(bins)
        median = np.interp(at, at[~empty], median[~empty], period=bins)
        spread = np.interp(at, at[~empty], spread[~empty], period=bins)
    count = np.maximum(np.diff(ends), 1)
    usual = float(np.median(spread)) + 1e-12
    return median, 1.2533 * np.maximum(spread, 0.3 * usual) / np.sqrt(count), usual


def _smoothed(
    median: Vector, halves: tuple[Vector, Vector]
) -> tuple[NDArray[np.complex128], float]:
    """The Fourier coefficients (1 + B/2,) of the likeliest bead behind the medians: Wiener's.

    And how many waves are kept of it, either way.
    ``halves`` are the medians (B,) of two halves of the piece: what they share is bead, what they
    differ by is not. Where the bead's power sinks into the noise it is taken to go on falling as
    it fell before.
    """
    one, two = (np.fft.rfft(half) for half in halves)
    wave = np.arange(1, len(one))
    shared = (one * two.conj()).real[1:]
    noise = float(np.mean(np.abs(one - two)[1:] ** 2)) / 4
    band = np.floor(np.log(wave) / np.log(_BAND)).astype(np.intp)
    size = np.bincount(band)
    held = np.flatnonzero(size)
    middle = np.bincount(band, weights=np.log(wave))[held] / size[held]
    power = np.bincount(band, weights=shared)[held] / size[held]
    clear = np.append(power > _CLEAR * noise, False)
    last = int(np.argmin(clear))
    level = np.log(np.maximum(power[: max(last, 1)], noise))
    middle = middle[: len(level)]
    recent = middle >= middle[-1] - _RECENT
    fall = -np.polyfit(middle[recent], level[recent], 1)[0] if recent.sum() > 1 else _FALLS[0]
    beyond = np.clip(fall, *_FALLS) * np.maximum(np.log(wave) - middle[-1], 0.0)
    likely = np.exp(np.interp(np.log(wave), middle, level) - beyond)
    share = likely / (likely + noise)
    return np.fft.rfft(median) * np.append(1.0, share), 1 + 2 * float(share @ share)


def _drawn(waves: NDArray[np.complex128], offset: float) -> Vector:
    """The curve of these coefficients at the phases ``offset`` + i/1024."""
    bins = 2 * (len(waves) - 1)
    shift = np.exp(2j * np.pi * np.arange(len(waves)) * (offset - 0.5 / bins))
    return np.fft.irfft(waves * shift, SAMPLES) * (SAMPLES / bins)
