"""The layers: their period, phase and slope on the unrolled face.

Slow trend, relief and wave are fitted together, so that none of them passes for another.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..core.scene import Vector
from .scatter import student
from .unroll import Cells

_DEGREE = 3  # of the slow trend, in arc and z together
_HARMONICS = 10
_DIVIDED = ((6, 6), (1, 10))  # along the arc and up: parts, to see how far the figures scatter


@dataclass(frozen=True, slots=True)
class Trend:
    """A slow surface: a polynomial of total degree 3 in arc and z."""

    middle: tuple[float, float]
    reach: tuple[float, float]
    values: Vector

    @classmethod
    def over(cls, cells: Cells) -> "Trend":
        """A trend of 0 that covers ``cells``."""
        ends = [(float(v.min()), float(v.max())) for v in (cells.arc, cells.z)]
        middle = tuple((high + low) / 2 for low, high in ends)
        reach = tuple((high - low) / 2 for low, high in ends)
        return cls((middle[0], middle[1]), (reach[0], reach[1]), np.zeros(len(_powers())))

    def basis(self, arc: Vector, z: Vector) -> Vector:
        """The polynomial's terms (N, T) at these places."""
        u = (arc - self.middle[0]) / self.reach[0]
        w = (z - self.middle[1]) / self.reach[1]
        terms = np.empty((*np.shape(u), len(_powers())))
        for index, (i, j) in enumerate(_powers()):
            terms[..., index] = u**i * w**j
        return terms

    def at(self, arc: Vector, z: Vector) -> Vector:
        """Its height in m, in the shape of ``arc`` and ``z``."""
        u = (arc - self.middle[0]) / self.reach[0]
        w = (z - self.middle[1]) / self.reach[1]
        rows = np.zeros((_DEGREE + 1, _DEGREE + 1))
        for (i, j), value in zip(_powers(), self.values, strict=True):
            rows[i, j] = value
        return np.asarray(np.polynomial.polynomial.polyval2d(u, w, rows), dtype=np.float64)


def _powers() -> list[tuple[int, int]]:
    return [(i, j) for i in range(_DEGREE + 1) for j in range(_DEGREE + 1 - i)]


@dataclass(frozen=True, slots=True)
class Layers:
    """The wave that the layers make on a face: phase = wave · (arc, z), 1 a layer.

    ``wave`` (2,) in layers/m; ``harmonics`` (2, K) in m are the cosines and sines of the relief;
    ``trend`` the slow surface beside it. ``confidence`` is 1 − the chance that a surface without
    layers shows as strong a wave, ``strength`` how far in dB the wave stands above the surface's
    other waves of its length. ``period_error`` in m and ``tilt_error`` in rad are standard errors,
    from how far parts of the piece differ.
    """

    wave: Vector
    harmonics: Vector
    trend: Trend
    confidence: float
    strength: float
    period_error: float = 0.0
    tilt_error: float = 0.0

    @property
    def period(self) -> float:
        """Layer height in m, square to the layers."""
        return 1 / float(np.hypot(*self.wave))

    @property
    def tilt(self) -> float:
        """How steeply the layers fall along the arc, in rad; 0 where they are level."""
        return float(np.arctan2(self.wave[0], self.wave[1]))

    def phases(self, arc: Vector, z: Vector) -> Vector:
        """Layers counted from the middle of the piece, at these places."""
        return self.wave[0] * arc + self.wave[1] * z

    def relief(self, arc: Vector, z: Vector) -> Vector:
        """What the harmonics say of the height there, in m, of mean 0 over a layer."""
        turns = 2 * np.pi * self.phases(arc, z)
        total = np.zeros_like(turns)
        for n, (cosine, sine) in enumerate(self.harmonics.T, 1):
            total += cosine * np.cos(n * turns) + sine * np.sin(n * turns)
        return total


def fitted(
    start: Layers, cells: Cells, harmonics: int = 0, *, errors: bool = False, held: bool = False
) -> Layers:
    """The wave, relief and trend that fit ``cells`` best, by robust Gauss–Newton from ``start``.

    ``harmonics`` of the relief are fitted, as many as the cells can hold where 0. With ``errors``
    the standard errors come from how far parts of the piece differ; with ``held`` the wave stays as
    it is.
    """
    count = harmonics or int(np.clip(start.period / (3 * cells.edge), 1, _HARMONICS))
    trend = Trend.over(cells)
    basis = trend.basis(cells.arc, cells.z)
    terms = basis.shape[1]
    wave = start.wave.copy()
    relief = np.zeros((2, count))
    known = min(count, start.harmonics.shape[1])
    relief[:, :known] = start.harmonics[:, :known]
    system = np.empty((len(cells.arc), terms + 2 * count + 2))
    system[:, :terms] = basis
    trust = np.ones(len(cells.arc))
    scale = 1 / max(np.ptp(cells.arc), np.ptp(cells.z))
    values = np.zeros(0)
    for step in range(12):
        turns = 2 * np.pi * (wave[0] * cells.arc + wave[1] * cells.z)
        slope = np.zeros(len(turns))
        for n in range(1, count + 1):
            cosine, sine = np.cos(n * turns), np.sin(n * turns)
            system[:, terms + n - 1], system[:, terms + count + n - 1] = cosine, sine
            slope += n * (relief[1, n - 1] * cosine - relief[0, n - 1] * sine)
        slope *= 2 * np.pi * scale
        system[:, -2], system[:, -1] = slope * cells.arc, slope * cells.z
        moving = bool(relief.any()) and not held
        used = system if moving else system[:, :-2]
        values = solved(used, cells.height, trust)
        change = values[-2:] * scale if moving else np.zeros(2)
        # The wave moves by what its slope explains; the relief is fitted anew around it.
        wave = wave + np.clip(change, -0.1 * scale, 0.1 * scale)
        relief = values[terms : terms + 2 * count].reshape(2, count)
        trust = huber(cells.height - used @ values)
        if step > 3 and np.abs(change).max() < 1e-7 * scale:
            break
    trend = replace(trend, values=values[:terms])
    found = replace(start, wave=wave, harmonics=relief, trend=trend)
    if not errors:
        return found
    return _with_errors(found, system, cells, trust, scale)


def _with_errors(
    found: Layers, system: Vector, cells: Cells, trust: Vector, scale: float
) -> Layers:
    """Standard errors from what each part of the piece pulls at the wave [Liang & Zeger 1986].

    Of parts as wide as high and of bands of layers the larger, since roughness is alike over
    millimetres, and what a layer has of its own over the whole of it.
    """
    size = np.sqrt(np.einsum("ij,ij->j", system, system)) + 1e-300
    scaled = system / size
    weighted = scaled * trust[:, None]
    matrix = weighted.T @ scaled
    values = np.linalg.lstsq(matrix, weighted.T @ cells.height, rcond=1e-12)[0]
    weighted *= (cells.height - scaled @ values)[:, None]
    period, tilt = found.wave / np.hypot(*found.wave) ** 3, found.wave[::-1] * [1, -1]
    figures = np.stack([-period, tilt / np.hypot(*found.wave) ** 2])
    errors = []
    for columns, rows in _DIVIDED:
        part = cells.column * columns // cells.shape[1] * rows + cells.row * rows // cells.shape[0]
        pulls = np.stack([weighted[part == index].sum(axis=0) for index in np.unique(part)])
        moves = np.linalg.lstsq(matrix, pulls.T, rcond=1e-12)[0][-2:] / size[-2:, None] * scale
        parts = moves.shape[1]
        share = np.sqrt(parts / max(parts - 1, 1)) * student(parts)
        errors.append(share * np.linalg.norm(figures @ moves, axis=1))
    of_period, of_tilt = np.max(errors, axis=0)
    return replace(found, period_error=float(of_period), tilt_error=float(of_tilt))


def solved(system: Vector, right: Vector, trust: Vector) -> Vector:
    """Weighted least squares by normal equations, columns brought to one size."""
    size = np.sqrt(np.einsum("ij,ij->j", system, system)) + 1e-300
    scaled = system / size
    weighted = scaled * trust[:, None]
    matrix = weighted.T @ scaled
    matrix[np.diag_indices_from(matrix)] += 1e-10 * len(right) / len(matrix) ** 2 * 1e-6
    return np.linalg.lstsq(matrix, weighted.T @ right, rcond=1e-12)[0] / size


def huber(deviation: Vector) -> Vector:
    """Huber's weights (N,) for deviations (N,)."""
    spread = 1.4826 * float(np.median(np.abs(deviation - np.median(deviation)))) + 1e-12
    return 1 / np.maximum(1.0, np.abs(deviation) / (1.5 * spread))
