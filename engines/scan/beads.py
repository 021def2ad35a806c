"""The beads of a printed wall as found: layer by layer, from the relief itself.

Around the wall, in sectors, the relief is laid against one bead's own shape, the median of all;
where it fits best, there is a boundary between two layers.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector

SECTORS = 48
_BIN, _IN_CELL = 2e-4, 3  # m along z, or more for so many points in a cell
_SHORTEST, _LONGEST = 5e-4, 2e-2  # m, what a layer may measure
_FEWEST = 4  # layers
_FINE = 4  # frequencies tried for each that can be told apart
_SURE, _CLEAR = 0.1, 5.0  # share of the relief that a rhythm explains; over the usual frequency's
_PARTS = 64  # of a bead's shape
_ROUNDS = 4
_FILLED = 0.7  # of a window must have been seen
_CREST = 0.25  # of a layer to both sides of its middle, that its crest is measured over


@dataclass(frozen=True, slots=True)
class Strip:
    """A side of a wall, unrolled: means in cells of a sector (S,) by a height (B,).

    ``offset`` (S, B) in m, out of the wall, NaN where nothing was seen; ``height`` (S, B) in m
    and ``count`` (S, B) of the points; ``z`` (B,) in m the cells' middles.
    """

    offset: Vector
    height: Vector
    count: NDArray[np.intp]
    z: Vector

    @property
    def turn(self) -> Vector:
        """The middles (S, 1) of the sectors as a share of a turn."""
        return (np.arange(len(self.offset))[:, None] + 0.5) / len(self.offset)


@dataclass(frozen=True, slots=True)
class Beads:
    """The layers of one side.

    ``floors`` (S, K) in m: the boundaries between layers in each sector, NaN where not seen, from
    below. ``shape`` (P,) in m is one bead, its valley half-way. ``pitch`` in m is the mean layer
    height, ``rise`` the layers climbed in a turn (0 stacked, ±1 a spiral).
    """

    floors: Vector
    shape: Vector
    pitch: float
    rise: int

    @property
    def depth(self) -> float:
        """From valley to crest in m."""
        return float(np.ptp(self.shape))


def strip_of(turn: Vector, z: Vector, offset: Vector, low: float, high: float) -> Strip:
    """The strip between two heights of N points, ``turn`` 0..1, the others in m."""
    bins = int(np.clip(min((high - low) / _BIN, len(z) / SECTORS / _IN_CELL), 64, 8192))
    sector = np.minimum((turn * SECTORS).astype(int), SECTORS - 1)
    level = np.floor((z - low) / (high - low) * bins).astype(int)
    inside = (level >= 0) & (level < bins)
    cell = (sector * bins + level)[inside]
    shape = (SECTORS, bins)
    count = np.bincount(cell, minlength=SECTORS * bins)

    def mean(what: Vector) -> Vector:
        total = np.bincount(cell, what[inside], SECTORS * bins)
        return np.where(count > 0, total / np.maximum(count, 1), np.nan).reshape(shape)

    middles = low + (np.arange(bins) + 0.5) * (high - low) / bins
    return Strip(mean(offset), mean(z), count.reshape(shape), middles)


def beads_of(strip: Strip) -> Beads | None:
    """The layers in a strip, None where its relief has no rhythm."""
    flat = _flattened(strip)
    rhythm = _rhythm(flat, strip)
    if rhythm is None:
        return None
    pitch, rise, phase = rhythm
    floors = _first_floors(flat, strip, pitch, rise, phase)
    if floors.shape[1] < 2:
        return None
    shape = np.zeros(_PARTS)
    for _ in range(_ROUNDS):
        heights, places = _windows(flat, strip, floors, pitch)
        shape = _shape(heights, places)
        floors = floors + pitch * _shift(heights, places, shape)
    heights = np.diff(floors, axis=1)
    if not np.isfinite(heights).any():
        return None
    shape = np.roll(shape, -round(_valley(shape) * _PARTS))
    return Beads(floors, shape, float(np.nanmean(heights)), rise)


def levels_of(strip: Strip, floors: Vector) -> Vector:
    """The mean offset (S, K − 1) in m of a strip between floors (S, K)."""
    part = _between(strip, floors)
    rows = np.arange(len(floors))[:, None] * floors.shape[1]
    known = np.isfinite(strip.offset) & (part >= 0)
    cell = np.where(known, rows + part, 0)
    size = floors.size
    weight = np.bincount(cell.ravel(), known.ravel(), size)
    total = np.bincount(cell.ravel(), np.where(known, strip.offset, 0.0).ravel(), size)
    mean = np.where(weight > 0, total / np.maximum(weight, 1), np.nan)
    return mean.reshape(floors.shape)[:, :-1]


def _flattened(strip: Strip) -> Vector:
    """The offset (S, B) less a cubic along z in each sector; NaN stays."""
    x = np.linspace(-1.0, 1.0, len(strip.z))
    terms = np.polynomial.legendre.legvander(x, 3)
    known = np.isfinite(strip.offset)
    value = np.where(known, strip.offset, 0.0)
    normal = np.einsum("sb,bi,bj->sij", known.astype(float), terms, terms, optimize=True)
    fitted = np.linalg.pinv(normal, hermitian=True) @ (value @ terms)[..., None]
    return strip.offset - fitted[..., 0] @ terms.T


def _rhythm(flat: Vector, strip: Strip) -> tuple[float, int, float] | None:
    """Pitch in m, layers a turn, and phase at z = 0 in layers."""
    height = strip.z[-1] - strip.z[0]
    step = strip.z[1] - strip.z[0]
    lowest, highest = max(_FEWEST / height, 1 / _LONGEST), min(1 / _SHORTEST, 1 / (4 * step))
    known = np.isfinite(flat)
    if highest <= lowest or known.mean() < 0.02:
        return None
    tried = np.arange(lowest, highest, 1 / (_FINE * height))
    waves = np.exp(-2j * np.pi * strip.z[:, None] * tried)
    value = np.where(known, flat, 0.0)
    swing = value @ waves
    rises = np.array([0, 1, -1])
    sums = np.exp(2j * np.pi * rises[:, None] * strip.turn[:, 0]) @ swing
    power = np.abs(sums) / known.sum()
    which, best = np.unravel_index(power.argmax(), power.shape)
    share = 2 * power[which, best] ** 2 / max(float((value**2).sum() / known.sum()), 1e-300)
    if share < _SURE or power[which, best] < _CLEAR * np.median(power[which]):
        return None
    # Of a wave cos 2π(z/p − rise · turn − phase), the sum turns by −phase.
    phase = -np.angle(sums[which, best]) / (2 * np.pi)
    return 1 / float(tried[best]), int(rises[which]), float(phase)


def _first_floors(flat: Vector, strip: Strip, pitch: float, rise: int, phase: float) -> Vector:
    """Where the floors (S, K) are by the wave's valleys, which may run slow or fast along z."""
    low, high = strip.z[0] + 0.4 * pitch, strip.z[-1] - 0.4 * pitch
    first = int(np.ceil(low / pitch - phase - 0.5 - max(rise, 0)))
    last = int(np.floor(high / pitch - phase - 0.5 - min(rise, 0)))
    number = np.arange(first, last + 1) + 0.5 + phase
    known = np.isfinite(flat)
    wave = np.exp(-2j * np.pi * (strip.z / pitch - rise * strip.turn - phase))
    along = (np.where(known, flat, 0.0) * wave).sum(axis=0)
    near = np.exp(-(((strip.z - pitch * number[:, None]) / pitch) ** 2) / 2)
    late = -np.unwrap(np.angle(near @ along)) / (2 * np.pi)
    middle = int(np.argmin(np.abs(pitch * number - strip.z.mean())))
    late -= np.round(late[middle])
    floors = pitch * (number + late + rise * strip.turn)
    return np.where((floors >= low) & (floors <= high), floors, np.nan)


def _windows(flat: Vector, strip: Strip, floors: Vector, pitch: float) -> tuple[Vector, Vector]:
    """The relief half a layer to both sides of each floor (S, K, W), and where, in layers."""
    step = strip.z[1] - strip.z[0]
    half = int(np.ceil(pitch / 2 / step))
    there = np.isfinite(floors)
    middle = np.where(there, (floors - strip.z[0]) / step, 0.0)
    index = np.round(middle).astype(int)[..., None] + np.arange(-half, half + 1)
    outside = (index < 0) | (index >= len(strip.z)) | ~there[..., None]
    index = np.clip(index, 0, len(strip.z) - 1)
    row = np.arange(len(flat))[:, None, None]
    heights = np.where(outside, np.nan, flat[row, index])
    places = (strip.height[row, index] - np.where(there, floors, 0.0)[..., None]) / pitch
    places = np.where(np.isfinite(places), places, 0.0)
    heights = np.where(np.abs(places) <= 0.5, heights, np.nan)
    filled = np.isfinite(heights).mean(axis=2) > _FILLED * min(1.0, pitch / step / (2 * half + 1))
    return np.where(filled[..., None], heights, np.nan), places


def _shape(heights: Vector, places: Vector) -> Vector:
    """One bead from valley to valley (P,) in m, the median of all windows."""
    count = np.maximum(np.isfinite(heights).sum(axis=2, keepdims=True), 1)
    level = heights - np.nansum(heights, axis=2, keepdims=True) / count
    part = np.floor((places + 0.5) * _PARTS).astype(int) % _PARTS
    known = np.isfinite(level)
    order = np.argsort(part[known], kind="stable")
    values, parts = level[known][order], part[known][order]
    ends = np.searchsorted(parts, np.arange(_PARTS + 1))
    shape = np.array([np.median(values[a:b]) if b > a else np.nan for a, b in pairwise(ends)])
    x = np.arange(_PARTS)
    known = np.isfinite(shape)
    return np.interp(x, x[known], shape[known], period=_PARTS) if known.any() else np.zeros(_PARTS)


def _valley(shape: Vector) -> float:
    """Where in −0.5..0.5 layers a bead's shape is deepest, by the weight of what is deep."""
    weight = (shape.max() - shape) ** 4
    angle = 2 * np.pi * ((np.arange(_PARTS) + 0.5) / _PARTS - 0.5)
    return float(np.angle((weight * np.exp(1j * angle)).sum()) / (2 * np.pi))


def _along(shape: Vector, places: Vector) -> Vector:
    """A bead's shape, or its slope, at places in layers from its valley; it repeats."""
    at = (np.arange(_PARTS) + 0.5) / _PARTS - 0.5
    return np.interp(places, at, shape, period=1.0)


def _shift(heights: Vector, places: Vector, shape: Vector) -> Vector:
    """How much higher, in layers, the valley lies than each window's middle (S, K)."""
    known = np.isfinite(heights)
    some = known.any(axis=2)
    value, weight = np.where(known, heights, 0.0)[some], known[some].astype(float)
    slope = (np.roll(shape, -1) - np.roll(shape, 1)) * (_PARTS / 2)
    valley = _valley(shape)
    shift = np.zeros(len(value))
    for _ in range(3):
        x = places[some] - shift[:, None]
        terms = np.stack([np.ones_like(x), x, -_along(slope, x)], axis=-1)
        rest = value - _along(shape, x)
        normal = np.einsum("nw,nwi,nwj->nij", weight, terms, terms, optimize=True)
        right = np.einsum("nw,nwi,nw->ni", weight, terms, rest, optimize=True)
        step = (np.linalg.pinv(normal, hermitian=True) @ right[..., None])[:, 2, 0]
        shift += np.clip(step, -0.1, 0.1)
    result = np.full(some.shape, np.nan)
    result[some] = shift + valley
    return result


def _between(strip: Strip, floors: Vector) -> Vector:
    """The number (S, B) of the layer that each cell is in, −1 outside and next to gaps."""
    part = np.full(strip.offset.shape, -1)
    for row, line in zip(part, floors, strict=True):
        there = np.flatnonzero(np.isfinite(line))
        index = np.searchsorted(line[there], strip.z) - 1
        inside = (index >= 0) & (index < len(there) - 1)
        lower, upper = there[index[inside]], there[index[inside] + 1]
        row[inside] = np.where(upper == lower + 1, lower, -1)
    return part


def crests_of(strip: Strip, floors: Vector, shape: Vector) -> Vector:
    """How far in m the layers between floors (S, K) stand out (S, K − 1), by their middles.

    ``shape`` is that of their beads.
    """
    part = _between(strip, floors)
    row = np.arange(len(floors))[:, None]
    low = floors[row, np.maximum(part, 0)]
    high = floors[row, np.minimum(part + 1, floors.shape[1] - 1)]
    place = (np.nan_to_num(strip.height) - low) / np.where(part < 0, 1.0, high - low)
    top = np.abs(place - 0.5) <= _CREST
    below = shape.max() - _along(shape, np.where(top, place, 0.5))
    raised = np.where(top & (part >= 0), strip.offset + below, np.nan)
    return levels_of(replace(strip, offset=raised), floors)
