"""How bright a sky is, in a direction and all together."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from ..core.scene import Vector
from .sky import Skies

LOWEST = 0.01
"""The sine of altitude below which a sky brightens towards the horizon no more (Radiance's
perezlum.cal)."""

_BLOCK = 1 << 19
_NODES = 20


def relative_luminance(skies: Skies, directions: Vector) -> Vector:
    """The relative luminance (D, T) of T skies in ``directions`` (D, 3), unit vectors, Z up.

    Without a unit; 0 below the horizon.
    """
    found = np.empty((len(skies), len(directions)))
    for part, block in relative_blocks(skies, directions):
        found[part] = block
    return found.T


def luminance(
    skies: Skies, directions: Vector, horizontal: ArrayLike, integral: Vector | None = None
) -> Vector:
    """The luminance or radiance (D, T) of T skies in ``directions`` (D, 3), unit vectors, Z up.

    ``horizontal`` (T,) or one for all: what each sky gives to a horizontal plane, in lx for cd/m²
    or in W/m² for W/(m² sr); ``integral`` (T,): what it would give at its relative luminance, by
    `horizontal_integral` if not said.
    """
    integral = horizontal_integral(skies) if integral is None else integral
    return relative_luminance(skies, directions) * (np.asarray(horizontal, float) / integral)


def horizontal_integral(skies: Skies) -> Vector:
    """∫ L cos ζ dω over the hemisphere (T,), of each sky's relative luminance L.

    By Gauss's rule in polar coordinates about the sun, which put its peak at an end of the range;
    in two parts, of circles about the sun that clear the horizon and that cross it.
    """
    node, weight = np.polynomial.legendre.leggauss(_NODES)
    node, weight = (node + 1) / 2, weight / 2
    total = np.empty(len(skies))
    for part in _slices(len(skies), 2 * _NODES**2):
        chosen = skies[part]
        height = chosen.sun[:, 2, None, None]
        level = np.sqrt(np.maximum(1 - height**2, 0.0))
        clear = np.arcsin(np.clip(height, -1.0, 1.0))
        total[part] = 0.0
        for low, high in ((0.0 * clear, clear), (clear, np.pi - clear)):
            gamma = low + (high - low) * node[:, None]
            across = -height * np.cos(gamma) / np.maximum(level * np.sin(gamma), 1e-12)
            half = np.arccos(np.clip(across, -1.0, 1.0))
            cosine = height * np.cos(gamma) + level * np.sin(gamma) * np.cos(half * node)
            bright = _gradation(chosen, np.maximum(cosine, 0.0)) * _indicatrix(chosen, gamma)
            ring = (np.maximum(bright, 0.0) * np.maximum(cosine, 0.0)) @ weight
            width = (high - low)[:, :, 0] * 2 * half[:, :, 0]
            total[part] += (ring * np.sin(gamma)[:, :, 0] * width) @ weight
    return total


def relative_blocks(skies: Skies, directions: Vector) -> Iterator[tuple[slice, Vector]]:
    """`relative_luminance` in pieces of bounded size: which skies, and (t, D) of theirs."""
    heights, row = np.unique(directions[:, 2], return_inverse=True)
    below = directions[:, 2] < 0
    for part in _slices(len(skies), len(directions)):
        chosen = skies[part]
        gamma = np.arccos(np.clip(chosen.sun @ directions.T, -1.0, 1.0))
        block = _indicatrix(chosen, gamma)
        block *= _gradation(chosen, heights)[:, row]
        np.maximum(block, 0.0, out=block)
        block[:, below] = 0.0
        yield part, block


def _gradation(skies: Skies, cosine: Vector) -> Vector:
    """The factor of height (T, …) at the cosines (…) or (T, …) from the zenith."""
    a, b, g = (_column(k, skies, cosine) for k in skies.gradation.T)
    return 1 + a * np.exp(b / np.maximum(cosine, LOWEST)) + g * cosine


def _indicatrix(skies: Skies, gamma: Vector) -> Vector:
    """The factor of distance from the sun, gamma (T, …) in rad."""
    f, c, d, e = (_column(k, skies, gamma) for k in skies.indicatrix.T)
    found = np.cos(gamma)
    found *= found
    found *= e
    peak = d * gamma
    np.exp(peak, out=peak)
    peak *= c
    found += peak
    found += f
    return found


def _column(values: Vector, skies: Skies, like: Vector) -> Vector:
    """``values`` (T,) with axes added to go with an array (T, …) or (n,)."""
    return values.reshape(-1, *(1,) * max(like.ndim - 1, 1))


def _slices(count: int, size: int) -> Iterator[slice]:
    """Slices of ``count`` things of ``size`` numbers each, so that a piece stays small."""
    step = max(1, _BLOCK // size)
    return (slice(first, min(first + step, count)) for first in range(0, count, step))
