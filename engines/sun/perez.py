"""Perez's all-weather sky: a luminance distribution from the beam and the diffuse light."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .extraterrestrial import SOLAR_CONSTANT
from .luminance import relative_luminance
from .patches import patches_of
from .sky import Skies

HIGHEST = np.radians(87.0)
"""The altitude that stands for all above it: Radiance keeps the sun's halo off the zenith."""

CLEARNESS = (1.0, 12.01)
BRIGHTNESS = (0.01, 0.6)
"""The bounds within which gendaylit holds Perez's two indices."""

_TABLE = np.loadtxt(Path(__file__).parent / "data" / "perez_1993.csv", delimiter=",")
_BOUNDS = _TABLE[1:, 0]
_TERMS = _TABLE[:, 1:].reshape(-1, 5, 4)


@dataclass(frozen=True, slots=True)
class PerezSky:
    """T skies after Perez, and what they were found from.

    ``clearness`` ε and ``brightness`` Δ (T,), within the bounds; ``zenith`` (T,) in rad: how far
    the sun is from the zenith, 3° to 90°; ``skies``: their relative luminance.
    """

    clearness: Vector
    brightness: Vector
    zenith: Vector
    skies: Skies


def perez_sky(
    azimuth: ArrayLike,
    altitude: ArrayLike,
    direct_normal: ArrayLike,
    diffuse_horizontal: ArrayLike,
    *,
    outside: ArrayLike = SOLAR_CONSTANT,
) -> PerezSky:
    """The T skies that give the irradiances [Perez, Seals & Michalsky 1993, eq. 1 and 6–8].

    ``azimuth`` and ``altitude`` (T,) of the sun in degrees, clockwise from north;
    ``direct_normal``, ``diffuse_horizontal`` and, outside the air and normal to the sun,
    ``outside`` (T,) in W/m²; each may be one number for all. A sun below the horizon lights the
    sky as one on it, one above 87° as one at 87°. Clearness, brightness, air mass [Kasten 1966] and
    the floor of 0.2 for Δ at ε from 1.065 to 2.8 are gendaylit's. Outside what they were fitted to,
    as for a low sun in a bright sky, a and b can make a zenith darker than black or a horizon
    without bound, where gendaylit gives up with a black sky: such a sky has no gradation here. A
    typical year has none.

    Raises ParameterError, naming the interval, for an irradiance that is negative or not a number.
    """
    azimuth, altitude, direct, diffuse = np.broadcast_arrays(
        *(np.atleast_1d(a) for a in (azimuth, altitude, direct_normal, diffuse_horizontal))
    )
    _check(azimuth, "sun's azimuth", signed=True)
    _check(altitude, "sun's altitude", signed=True)
    _check(direct, "direct normal irradiance")
    _check(diffuse, "diffuse horizontal irradiance")
    height = np.clip(np.radians(altitude), 0.0, HIGHEST)
    zenith = np.pi / 2 - height
    cubed = 1.041 * zenith**3
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        beam = np.where(direct > 0, direct / diffuse, 0.0)
    clearness = np.clip((1 + beam + cubed) / (1 + cubed), *CLEARNESS)
    brightness = np.clip(diffuse * air_mass(zenith) / np.asarray(outside, float), *BRIGHTNESS)
    turn = np.radians(azimuth)
    sun = np.stack(
        [np.sin(turn) * np.cos(height), np.cos(turn) * np.cos(height), np.sin(height)], axis=1
    )
    a, b, c, d, e = _coefficients(clearness, brightness, zenith)
    nothing = np.zeros_like(a)
    sound = (b < 0) & (1 + a * np.exp(b) > 0)
    gradation = np.stack([np.where(sound, a, 0.0), np.where(sound, b, 0.0), nothing], axis=1)
    indicatrix = np.stack([nothing + 1, c, d, e], axis=1)
    return PerezSky(clearness, brightness, zenith, Skies(sun, gradation, indicatrix))


def clearness_class(clearness: Vector) -> NDArray[np.int64]:
    """Perez's class of the sky (T,), 0 for overcast to 7 for clear."""
    return np.searchsorted(_BOUNDS, clearness, side="right")


def air_mass(zenith: Vector) -> Vector:
    """The relative air mass (T,) to a sun ``zenith`` (T,) rad from the zenith [Kasten 1966]."""
    return 1 / (np.cos(zenith) + 0.15 * (93.885 - np.degrees(zenith)) ** -1.253)


def gendaylit_integral(skies: Skies) -> Vector:
    """What gendaylit takes for `luminance.horizontal_integral` (T,): the mean of 145 directions.

    They are the centres of Tregenza's patches, turned with the sun. Handed to
    `luminance.luminance` it gives gendaylit's own level, at which a sky gives 0.2 to 3 % less
    diffuse light than was asked for.
    """
    directions = patches_of(1).directions
    level = np.hypot(skies.sun[:, 0], skies.sun[:, 1])
    ahead = np.stack([np.zeros_like(level), level, skies.sun[:, 2]], axis=1)
    turned = Skies(ahead, skies.gradation, skies.indicatrix)
    return 2 * np.pi / 145 * (directions[:, 2] @ relative_luminance(turned, directions))


def _coefficients(clearness: Vector, brightness: Vector, zenith: Vector) -> Vector:
    """Perez's a to e (5, T)."""
    category = clearness_class(clearness)
    meagre = (clearness > _BOUNDS[0]) & (clearness < _BOUNDS[4])
    delta = np.where(meagre, np.maximum(brightness, 0.2), brightness)
    terms = _TERMS[category]
    found = (
        terms[:, :, 0]
        + terms[:, :, 1] * zenith[:, None]
        + delta[:, None] * (terms[:, :, 2] + terms[:, :, 3] * zenith[:, None])
    ).T
    (c1, c2, c3, c4), (d1, d2, d3, d4) = _TERMS[0, 2], _TERMS[0, 3]
    c = np.exp((delta * (c1 + c2 * zenith)) ** c3) - c4
    d = -np.exp(delta * (d1 + d2 * zenith)) + d3 + delta * d4
    found[2:4] = np.where(category == 0, (c, d), found[2:4])
    return found


def _check(values: Vector, name: str, signed: bool = False) -> None:
    """Refuse what is not a number, or negative unless ``signed``."""
    bad = ~np.isfinite(values) if signed else ~(np.isfinite(values) & (values >= 0))
    if bad.any():
        first, more = int(np.flatnonzero(bad)[0]), int(bad.sum()) - 1
        raise ParameterError(
            f"Interval {first} has a {name} of {values[first]:g}{'' if signed else ' W/m²'}"
            f"{f', and {more} more are like it' if more else ''}: repair the weather first."
        )
