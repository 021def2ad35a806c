"""The search for layers: the strongest wave in a face's heights, and how sure it is."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from ..core.errors import SceneError
from ..core.scene import Vector
from .layers import Layers, Trend, fitted, huber, solved
from .unroll import Cells

_FEWEST_LAYERS = 2.5
_STEEPEST = np.radians(20.0)  # between the layers and the axis's own level
_ENOUGH = 20_000  # cells for a first fit
_FAINTEST = 8.0  # times its like that a wave must have to be picked by its power
_SUB = 0.1  # share of a peak's power above which half its frequency is the layers'


def find_layers(
    cells: Cells,
    shortest: float,
    longest: float,
    least: float,
    anywhere: bool = False,
) -> Layers:
    """The layers in the heights of ``cells``, with a period between two lengths in m.

    Only waves within 20° of the axis count, unless ``anywhere``. Raises SceneError, saying the
    confidence, where there is no wave of which one is as sure as ``least``.
    """
    trend = Trend.over(cells)
    basis = trend.basis(cells.arc, cells.z)
    values = solved(basis, cells.height, np.ones(len(cells.arc)))
    flat = cells.height - basis @ values
    flat -= basis @ (extra := solved(basis, flat, huber(flat)))
    trend = replace(trend, values=values + extra)
    wave, confidence, strength = _strongest(cells, flat, shortest, longest, anywhere)
    if confidence < least:
        raise _none(cells, wave, confidence, shortest, longest, least)
    first = Layers(wave, np.zeros((2, 0)), trend, confidence, strength)
    cells = cells.thinned(_ENOUGH)
    for count in (1, 2, 4):
        first = fitted(first, cells, count)
    if not shortest <= first.period <= longest:
        raise _none(cells, wave, 0.0, shortest, longest, least)
    return first


def _none(
    cells: Cells, wave: Vector, confidence: float, shortest: float, longest: float, least: float
) -> SceneError:
    size = (np.ptp(cells.arc) * 1e3, np.ptp(cells.z) * 1e3)
    return SceneError(
        f"There is no layer period between {shortest * 1e3:.3g} and {longest * 1e3:.3g} mm in "
        f"the scan's {size[0]:.3g} × {size[1]:.3g} mm: the likeliest, "
        f"{1e3 / np.hypot(*wave):.3g} mm, has a confidence of {100 * confidence:.0f} %, and "
        f"{100 * least:g} % is asked; check the unit, widen the range or scan more layers."
    )


def _strongest(
    cells: Cells, flat: Vector, shortest: float, longest: float, anywhere: bool
) -> tuple[Vector, float, float]:
    """The strongest wave in layers/m, how sure it is, and its strength in dB.

    A periodogram under a Blackman window, whose side lobes pass for no layers. A wave's power is
    compared with the median of the waves of its length; that of noise is distributed exponentially.
    """
    rows, columns = cells.shape
    window = np.blackman(rows + 2)[1:-1, None] * np.blackman(columns + 2)[1:-1]
    grid = np.nan_to_num(cells.gridded(flat)) * window
    shape = tuple(1 << int(np.ceil(np.log2(2 * n))) for n in grid.shape)
    power = np.abs(np.fft.rfft2(grid.T, (shape[1], shape[0]))) ** 2  # arc, z
    k_arc = np.fft.fftfreq(shape[1], cells.edge)[:, None]
    k_z = np.fft.rfftfreq(shape[0], cells.edge)[None, :]
    length = np.hypot(k_arc, k_z)
    span = np.abs(k_arc) * np.ptp(cells.arc) + k_z * np.ptp(cells.z)
    wanted = (length >= 1 / longest) & (length <= min(1 / shortest, 0.5 / cells.edge))
    wanted &= span >= _FEWEST_LAYERS
    if not anywhere:
        wanted &= np.abs(k_arc) <= np.tan(_STEEPEST) * k_z
    if not wanted.any():
        raise SceneError(
            f"The scan is {np.ptp(cells.z) * 1e3:.3g} mm high, too little for {_FEWEST_LAYERS:g} "
            f"layers of at least {shortest * 1e3:.3g} mm; scan a higher piece or check the unit."
        )
    noise = _background(power, length)
    ratio = np.where(wanted, power / np.maximum(noise, 1e-300), 0.0)
    crest = power >= maximum_filter(power, 5, mode="wrap")
    crest &= wanted
    if not crest.any():
        crest = wanted
    strong = crest & (ratio > _FAINTEST)
    ranked = np.where(strong, power, 0.0) if strong.any() else np.where(crest, ratio, 0.0)
    best = np.unravel_index(np.argmax(ranked), power.shape)
    best = _fundamental(power, ratio, best, wanted)
    wave = np.array([k_arc[best[0], 0], k_z[0, best[1]]])
    wave = wave if wave[1] > 0 else -wave
    oversampled = power.size / (rows * columns / 2)
    tries = max(1.0, np.count_nonzero(wanted) / oversampled)
    chance = -np.expm1(tries * np.log1p(-np.exp(-min(ratio[best], 700.0))))
    return wave, float(1 - chance), float(10 * np.log10(max(ratio[best], 1e-3)))


def _background(power: Vector, length: Vector) -> Vector:
    """The mean power of noise at each wave, from the median of the waves of like length."""
    first = np.min(length[length > 0])
    ring = np.floor(np.log(np.maximum(length, first) / first) / np.log(1.25)).astype(np.intp)
    order = np.argsort(ring, axis=None)
    ends = np.searchsorted(ring.ravel()[order], np.arange(ring.max() + 2))
    ranked = power.ravel()[order]
    level = np.zeros(ring.max() + 1)
    for index in range(len(level)):
        members = ranked[ends[index] : ends[index + 1]]
        level[index] = np.median(members) / np.log(2) if len(members) else np.nan
    sizes = np.diff(ends)
    known = np.flatnonzero(sizes >= 60)
    if len(known):
        level = np.exp(
            np.interp(np.arange(len(level)), known, np.log(np.maximum(level[known], 1e-300)))
        )
    return level[ring]


def _fundamental(
    power: Vector, ratio: Vector, best: tuple, wanted: NDArray[np.bool_]
) -> tuple[int, int]:
    """The wave itself, or that of twice or three times its length where that is there too."""
    rows = power.shape[0]
    signed = best[0] if best[0] <= rows // 2 else best[0] - rows
    for part in (3, 2):
        row, column = round(signed / part), round(best[1] / part)
        around = [
            ((row + i) % rows, column + j)
            for i in (-2, -1, 0, 1, 2)
            for j in (-2, -1, 0, 1, 2)
            if column + j >= 0
        ]
        top = max(around, key=lambda at: power[at])
        if wanted[top] and ratio[top] > 20 and power[top] > _SUB * power[best]:
            return top
    return int(best[0]), int(best[1])
