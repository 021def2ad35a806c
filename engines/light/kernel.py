"""A smooth picture from few photons: every texel gathers as far as it must, and no farther.

Gaussians of growing width are laid over the tally; a texel takes the narrowest in which the
effective count of photons reaches what was asked. Sharp caustics are bright and stay sharp; dim
regions lose their noise. What it blurs is not in the interval, which is that of the raw texels.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dctn, idctn

Map = NDArray[np.float64]

GATHER = 100
"""Photons that a texel gathers: a standard error of 10 %."""
WIDEST = 32.0
"""Standard deviation of the widest Gaussian in texels."""
STEP = 2**0.5


def smoothed(total: Map, square: Map, gather: float = GATHER) -> Map:
    """Sums ``total`` = Σw (rows, columns) with ``square`` = Σw², smoothed where photons are few.

    For a kernel g the estimate is Σ g Σw with variance Σ g² Σw², so its effective count is
    (Σ g Σw)² / Σ g² Σw²; between two widths the estimates are blended by the logarithm of theirs.
    Borders reflect. A dark texel beside a bright line gathers some of the line's light: the map's
    sum is kept only roughly.
    """
    waves = _Waves(total.shape)
    mean, square_mean = waves.of(total), waves.of(square)
    estimate = total.copy()
    count = _count(total, square)
    result, done = total.copy(), count >= gather
    width = 0.5
    while width <= WIDEST and not done.all():
        wider = waves.blurred(mean, width)
        # The square of a Gaussian is a narrower one: width ÷ √2, over 4π width².
        spread = waves.blurred(square_mean, width / 2**0.5) / (4 * np.pi * width**2)
        gathered = np.maximum(_count(wider, spread), count)
        reached = ~done & (gathered >= gather)
        before = np.log(np.maximum(count[reached], 1.0))
        share = (np.log(gather) - before) / (np.log(gathered[reached]) - before)
        result[reached] = (1.0 - share) * estimate[reached] + share * wider[reached]
        done |= reached
        estimate, count, width = wider, gathered, width * STEP
    result[~done] = estimate[~done]
    return result


def _count(total: Map, square: Map) -> Map:
    """The effective number of photons behind a sum."""
    found = square > 0
    return np.divide(total * total, square, out=np.zeros_like(total), where=found)


class _Waves:
    """Gaussian blurs of one shape of map, by cosine transform: its borders reflect."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        rows, columns = (np.pi * np.arange(n) / n for n in shape)
        self.square = rows[:, None] ** 2 + columns[None, :] ** 2

    def of(self, values: Map) -> Map:
        return np.asarray(dctn(values, norm="ortho", workers=2))

    def blurred(self, waves: Map, width: float) -> Map:
        damped = waves * np.exp(-self.square * width**2 / 2)
        return np.maximum(np.asarray(idctn(damped, norm="ortho", workers=2)), 0.0)
