"""Roughness: what is left of a face beside base and bead, told apart from the scanner's noise.

The points are dealt into two halves at random. What both halves show at a place is the surface,
what differs between them is noise; so is the cross-spectrum of the halves free of it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ..core.scene import Vector
from ..glass.profile import Texture, texture_of
from .fold import Fold
from .layers import Layers
from .unroll import Cells, Face, cells_of

_TO_A_CELL = 8
_FINEST, _COARSEST = 0.1e-3, 1.0e-3  # m
_ASTRAY = 5.0  # standard deviations
_FAINT = 0.1  # signal over noise below which an octave is left out of the texture
_WIDTHS = (0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 12.0)  # cells, that gaps are filled over
_LONGEST = 32e-3
_MARGIN = 0.5  # of the shorter side: the longest wave of which there are enough to tell


@dataclass(frozen=True, slots=True)
class Octave:
    """Roughness between two wavelengths in m: RMS of the surface and of the noise in m."""

    shortest: float
    longest: float
    signal: float
    noise: float


@dataclass(frozen=True, slots=True)
class Roughness:
    """The roughness of a face.

    All maps (rows, columns) in m, row 0 at the lowest z: ``height`` over the slow trend and ``raw``
    over the bead too are means over the cells of ``cells``, NaN where there are none; ``smooth`` is
    the surface's likeliest course through the latter, everywhere. ``rms`` in m is of all waves,
    without the noise; ``noise`` in m of one point; ``octaves`` from long to short. ``texture`` is a
    tile of the octaves that stand clear of the noise, brought to RMS 1, and ``held`` in m what it
    had before: ``rms`` less what is too long or too faint to tell. None and 0 where there is none.
    """

    cells: Cells
    height: Vector
    raw: Vector
    smooth: Vector
    rms: float
    held: float
    noise: float
    octaves: tuple[Octave, ...]
    texture: Texture | None


def find_roughness(face: Face, layers: Layers, fold: Fold, valley: float, seed: int) -> Roughness:
    """The roughness beside the ``fold`` whose valley has the phase ``valley`` in ``layers``."""
    phase = layers.phases(face.arc, face.z) - valley
    over = face.height - layers.trend.at(face.arc, face.z)
    left = over - fold.base - fold.spline()(phase - np.floor(phase))
    good = np.abs(left) < _ASTRAY * 1.4826 * np.median(np.abs(left))
    face = Face(face.inner, face.points[good], face.arc[good], face.z[good], left[good])

    area = np.ptp(face.arc) * np.ptp(face.z)
    edge = float(np.clip(np.sqrt(_TO_A_CELL * area / len(face.arc)), _FINEST, _COARSEST))
    cells = cells_of(face, edge)
    first = np.random.default_rng((2, seed)).random(len(face.arc)) < 0.5
    halves = _halves(face, cells, first)
    both = np.isfinite(halves[0]) & np.isfinite(halves[1])
    raw = cells.gridded(cells.height)
    height = cells_of(face, edge, over[good])
    filling = _blurred(raw, _best_width(halves, both))
    signal, noise = _spectra(halves, filling)
    octaves = _octaves(signal, noise, raw.shape, edge)
    smooth = _likeliest(np.where(np.isnan(raw), filling, raw), octaves, edge)
    texture, held = _texture(signal, octaves, raw.shape, edge, seed)
    shared = float(np.mean(halves[0][both] * halves[1][both]))
    return Roughness(
        cells=cells,
        height=height.gridded(height.height),
        raw=raw,
        smooth=smooth,
        rms=float(np.sqrt(max(shared, 0.0))),
        held=held,
        noise=_noise_of_a_point(face, cells),
        octaves=octaves,
        texture=texture,
    )


def _halves(face: Face, cells: Cells, first: NDArray[np.bool_]) -> tuple[Vector, Vector]:
    """The grid of cell means of the points that are ``first`` (N,), and of the others."""
    column = ((face.arc - cells.corner[0]) / cells.edge).astype(np.intp)
    row = ((face.z - cells.corner[1]) / cells.edge).astype(np.intp)
    key = row * cells.shape[1] + column
    total = cells.shape[0] * cells.shape[1]
    grids = []
    for half in (first, ~first):
        count = np.bincount(key[half], minlength=total)
        height = np.bincount(key[half], weights=face.height[half], minlength=total)
        with np.errstate(invalid="ignore", divide="ignore"):
            grids.append((height / count).reshape(cells.shape))
    return grids[0], grids[1]


def _noise_of_a_point(face: Face, cells: Cells) -> float:
    """Standard deviation in m of points about their cell's mean, pooled."""
    column = ((face.arc - cells.corner[0]) / cells.edge).astype(np.intp)
    row = ((face.z - cells.corner[1]) / cells.edge).astype(np.intp)
    mean, count = cells.gridded(cells.height)[row, column], cells.gridded(cells.count)[row, column]
    several = count > 1
    away = (face.height - mean)[several]
    free = np.sum(1 - 1 / count[several])
    return float(np.sqrt((away**2).sum() / max(free, 1.0)))


def _blurred(grid: Vector, width: float) -> Vector:
    """A grid with gaps blurred over so many cells, the gaps filled from around them."""
    known = np.isfinite(grid)
    top = gaussian_filter(np.where(known, grid, 0.0), width, mode="constant", truncate=5)
    below = gaussian_filter(known.astype(float), width, mode="constant", truncate=5)
    return top / np.maximum(below, 1e-9)


def _best_width(halves: tuple[Vector, Vector], both: NDArray[np.bool_]) -> float:
    """The blur with which each half foretells the other best."""

    def miss(width: float) -> float:
        one, two = halves
        left = _blurred(one, width)[both] - two[both]
        right = _blurred(two, width)[both] - one[both]
        return float(np.mean(left**2) + np.mean(right**2))

    misses = [miss(width) for width in _WIDTHS]
    return _WIDTHS[int(np.argmin(misses))]


def _spectra(halves: tuple[Vector, Vector], filling: Vector) -> tuple[Vector, Vector]:
    """Power of surface and of noise in m² a wave, (rows, columns) in the order of `numpy.fft`.

    Their sums are the variances. A Hann window keeps the piece's ends from spreading over the
    spectrum; the cells' own blur is taken back.
    """
    rows, columns = filling.shape
    window = np.hanning(rows + 2)[1:-1, None] * np.hanning(columns + 2)[1:-1]
    one, two = (np.fft.fft2(np.where(np.isfinite(half), half, filling) * window) for half in halves)
    scale = 1 / (rows * columns * (window**2).sum())
    k_z, k_arc = np.fft.fftfreq(rows)[:, None], np.fft.fftfreq(columns)
    blur = (np.sinc(k_z) * np.sinc(k_arc)) ** 2
    signal = (one * two.conj()).real * scale / blur
    noise = np.abs(one - two) ** 2 * scale / 4
    return signal, noise


def _lengths(shape: tuple[int, ...], edge: float) -> Vector:
    """The frequency of each wave in 1/m (rows, columns)."""
    rows, columns = shape
    return np.hypot(np.fft.fftfreq(rows, edge)[:, None], np.fft.fftfreq(columns, edge))


def _octaves(
    signal: Vector, noise: Vector, shape: tuple[int, ...], edge: float
) -> tuple[Octave, ...]:
    frequency = _lengths(shape, edge)
    found = []
    longest = _LONGEST
    while longest / 2 >= 2.5 * edge:
        if longest <= _MARGIN * min(shape) * edge:
            band = (frequency >= 1 / longest) & (frequency < 2 / longest)
            power = float(signal[band].sum()), float(noise[band].sum())
            rms = [float(np.sqrt(max(p, 0.0))) for p in power]
            found.append(Octave(longest / 2, longest, *rms))
        longest /= 2
    return tuple(found)


def _likeliest(grid: Vector, octaves: tuple[Octave, ...], edge: float) -> Vector:
    """The surface's likeliest course through a noisy ``grid``, by Wiener's filter.

    Each wave keeps the share of its power that is the surface's, as the octaves say; the grid is
    mirrored at its borders so that they do not bend.
    """
    known = [octave for octave in octaves if octave.noise > 0]
    if not known:
        return np.zeros_like(grid)
    middle = np.log([1 / np.sqrt(o.shortest * o.longest) for o in known])
    ratio = np.log([max(o.signal / o.noise, 1e-4) ** 2 for o in known])
    wide = np.concatenate([grid, grid[:, ::-1]], axis=1)
    mirrored = np.concatenate([wide, wide[::-1]])
    frequency = np.maximum(_lengths(mirrored.shape, edge), 1e-3)
    share = np.exp(np.interp(np.log(frequency), middle, ratio))
    beyond = frequency > np.exp(middle[-1])
    fall = (frequency / np.exp(middle[-1])) ** -4.0
    share = np.where(beyond, share * fall, share)
    kept = np.fft.ifft2(np.fft.fft2(mirrored) * (share / (1 + share))).real
    return kept[: grid.shape[0], : grid.shape[1]]


def _texture(
    signal: Vector, octaves: tuple[Octave, ...], shape: tuple[int, ...], edge: float, seed: int
) -> tuple[Texture | None, float]:
    """A tile of the same spectrum with random phases [van Wijk 1991, Galerne et al. 2011].

    And its RMS in m, to which its heights of RMS 1 belong.

    Octaves that the noise drowns stay empty; the power of each other one is as measured.
    """
    power = np.maximum(gaussian_filter(signal, 1.5, mode="wrap"), 0.0)
    frequency = _lengths(shape, edge)
    kept = np.zeros_like(power)
    for octave in octaves:
        band = (frequency >= 1 / octave.longest) & (frequency < 1 / octave.shortest)
        total = power[band].sum()
        if total > 0 and octave.signal**2 > _FAINT * octave.noise**2:
            kept[band] = power[band] * (octave.signal**2 / total)
    if not kept.any():
        return None, 0.0
    white = np.fft.fft2(np.random.default_rng((3, seed)).normal(size=shape))
    phases = white / np.maximum(np.abs(white), 1e-300)
    heights = np.fft.ifft2(phases * np.sqrt(kept)).real * power.size
    return texture_of(heights, (shape[1] * edge, shape[0] * edge))
