"""A smooth picture from few photons: every texel gathers as far as it must, and no farther.

Kernels of growing width are laid over the tally; a texel takes the narrowest in which the effective
count of photons reaches what is asked. Sharp caustics are bright and stay sharp; dim regions lose
their noise. How many photons are asked is chosen from the photons themselves: it is the count that
leaves the least error when each photon is predicted from all others (leave-one-out
cross-validation, [Bowman 1984]).

The kernel is 2 G(h) − G(√2 h) of Gaussians G, whose moments vanish up to the third: it blurs an
edge but neither lowers a smooth peak nor fills a smooth trough [Jones & Signorini 1997].
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct, dctn, idctn
from scipy.special import ive

from .interval import FLOOR, Z

Map = NDArray[np.float64]
Layers = NDArray[np.float32]

LADDER = 25.0 * 2.0 ** np.arange(13)
"""Counts of photons to choose from."""
PILOT = 400.0
"""The count of the first picture, which only weighs the errors of all others. Of fewer, its own
photons would sway the choice."""
NARROWEST, STEP = 0.5, 2**0.5
"""Standard deviation of the narrowest Gaussian in texels, and the ratio of one to the next."""
WIDEST = 1 / 5
"""Standard deviation of the widest Gaussian as a share of the map."""
NEIGHBOURS = 2.0
"""Standard deviation in texels of the neighbourhood that a bias is taken over."""
SPREAD = 11 / 6
"""∫ kernel² over that of its narrower Gaussian, 4 − 8/3 + 1/2. The square of the kernel itself has
a ring of noughts, where a bright line would go unnoticed."""
CUT = 5.0
"""Standard deviations that a Gaussian reaches."""
SAMPLED = 4.0
"""Standard deviation in texels from which a Gaussian is sampled."""


@dataclass(frozen=True, slots=True)
class Smooth:
    """A smoothed tally; all maps (rows, columns) float64 in the tally's unit.

    ``half_width`` is the 95 % half-width of its noise. ``bias`` is how far a texel and its
    neighbours move (root mean square) when a quarter of the photons are gathered: what is blurred
    shows up in it, with some noise. ``gathered`` is the count of photons that was chosen.
    """

    value: Map
    half_width: Map
    bias: Map
    gathered: float


def smoothed(total: Map, square: Map, gather: float | None = None) -> Smooth:
    """Sums ``total`` = Σw (rows, columns) with ``square`` = Σw², smoothed where photons are few.

    For a kernel g the estimate is Σ g Σw with variance Σ g² Σw², so its effective count is
    (Σ g Σw)² / Σ g² Σw²; between two widths the estimates are blended by the logarithm of theirs.
    ``gather`` fixes the count instead of choosing it. Borders reflect; the sum is kept roughly.
    """
    if not square.any():
        return Smooth(total.copy(), np.zeros_like(total), np.zeros_like(total), 0.0)
    stack = _Stack(total, square)
    gather = _chosen(stack, total, square) if gather is None else gather
    value, count, _ = stack.gathered(gather)
    before, _, _ = stack.gathered(gather / 4)
    half_width = Z * np.maximum(value, before) / np.sqrt(np.maximum(count, 1.0))
    wave = _Waves(total.shape)
    moved = wave.back(wave.of(np.square(value - before)), wave.gaussian(NEIGHBOURS))
    return Smooth(value, half_width, np.sqrt(np.maximum(moved, 0.0)), gather)


def _chosen(stack: "_Stack", total: Map, square: Map) -> float:
    """The count on LADDER with the least mean relative square error.

    Up to a constant the square error of an estimate m of λ is m² − 2 λ m, and λ m without bias
    is Σw m less what each photon adds to its own prediction, its kernel's centre × w².
    """
    pilot, _, _ = stack.gathered(PILOT)
    counted = pilot > FLOOR * pilot.mean()
    weight = np.divide(1.0, pilot**2, out=np.zeros_like(pilot), where=counted)
    best, least = float(LADDER[0]), np.inf
    for gather in LADDER:
        value, _, centre = stack.gathered(float(gather))
        risk = float(np.sum(weight * (value * (value - 2 * total) + 2 * centre * square)))
        if risk < least:
            best, least = float(gather), risk
        elif gather > 4 * best:
            break
    return best


class _Stack:
    """A tally under kernels of all widths: ``estimate`` and effective ``count`` (K, T) float32,
    the count growing with the width, and ``centre`` (K,), the weight of a kernel's own texel."""

    def __init__(self, total: Map, square: Map) -> None:
        self.shape = total.shape
        widest = max(WIDEST * max(total.shape), NARROWEST)
        steps = int(np.log(widest / NARROWEST) / np.log(STEP)) + 1
        widths = NARROWEST * STEP ** np.arange(steps)
        wave = _Waves(total.shape)
        light, spread = wave.of(total), wave.of(square)
        self.estimate = np.empty((steps + 1, total.size), np.float32)
        self.count = np.zeros((steps + 1, total.size), np.float32)
        self.centre = np.ones(steps + 1)
        self._lay(0, total, square, total)
        narrow = wave.back(light, wave.gaussian(NARROWEST))
        for i, width in enumerate(widths, 1):
            wide = wave.back(light, wave.gaussian(width * STEP))
            variance = SPREAD * wave.back(spread, wave.squared(width))
            self._lay(i, np.maximum(2 * narrow - wide, 0.0), variance, narrow)
            self.centre[i] = 2 * _centre(width) - _centre(width * STEP)
            narrow = wide
        np.maximum.accumulate(self.count, axis=0, out=self.count)

    def _lay(self, layer: int, estimate: Map, variance: Map, mean: Map) -> None:
        """Fill one layer. Where a transform only left rounding errors nothing is counted."""
        found = variance > 1e-12 * variance.max()
        squared = np.square(np.maximum(mean, 0.0))
        np.divide(squared, variance, out=squared, where=found)
        self.estimate[layer] = estimate.ravel()
        self.count[layer] = np.where(found, squared, 0.0).ravel()

    def gathered(self, gather: float) -> tuple[Map, Map, Map]:
        """Estimate, effective count and own weight (rows, columns) with ``gather`` photons."""
        last = len(self.count) - 1
        wide = (self.count < gather).sum(axis=0)
        above = np.clip(wide, 1, last)
        texel = np.arange(self.count.shape[1])
        before = np.log(np.maximum(self.count[above - 1, texel], 1.0))
        after = np.log(np.maximum(self.count[above, texel], 1.0))
        share = (np.log(gather) - before) / np.maximum(after - before, 1e-9)
        share = np.where(wide == 0, 0.0, np.where(wide > last, 1.0, np.clip(share, 0.0, 1.0)))
        count = np.where(wide == 0, self.count[0], np.minimum(self.count[-1], gather))
        value = self._blend(self.estimate[above - 1, texel], self.estimate[above, texel], share)
        centre = self._blend(self.centre[above - 1], self.centre[above], share)
        return value.reshape(self.shape), count.reshape(self.shape), centre.reshape(self.shape)

    @staticmethod
    def _blend(low: NDArray[np.floating], high: NDArray[np.floating], share: Map) -> Map:
        return low * (1.0 - share) + high * share


class _Waves:
    """Blurs of one shape of map, by cosine transform: its borders reflect."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape

    def of(self, values: Map) -> Map:
        return np.asarray(dctn(values, norm="ortho", workers=2))

    def back(self, waves: Map, response: Map) -> Map:
        return np.asarray(idctn(waves * response, norm="ortho", workers=2))

    def gaussian(self, width: float) -> Map:
        """The response of a Gaussian of the grid."""
        rows, columns = (_response(_line(width), n) for n in self.shape)
        return rows[:, None] * columns

    def squared(self, width: float) -> Map:
        """The response of a Gaussian's square."""
        rows, columns = (_response(_line(width) ** 2, n) for n in self.shape)
        return rows[:, None] * columns


def _line(width: float) -> NDArray[np.float64]:
    """Half of a Gaussian on the grid, from its centre out.

    Of narrow ones e^−t I_n(t), t = width², which is nowhere negative, as a sampled one that is cut
    off at the grid's finest wave would be [Lindeberg 1990].
    """
    reach = np.arange(int(np.ceil(CUT * width)) + 3)
    if width < SAMPLED:
        return ive(reach, width**2)
    line = np.exp(-np.square(reach / width) / 2)
    return line / (2 * line.sum() - line[0])


def _response(line: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """What a symmetric kernel does to the ``count`` waves of a cosine transform."""
    padded = np.zeros(max(count + 1, len(line)))
    padded[: len(line)] = line
    if len(line) <= count + 1:
        return np.asarray(dct(padded, type=1))[:count]
    wave = np.pi * np.arange(count) / count
    return line[0] + 2 * np.cos(wave[:, None] * np.arange(1, len(line))) @ line[1:]


def _centre(width: float) -> float:
    """A Gaussian's weight at its own texel, far from the border."""
    return float(_line(width)[0] ** 2)
