"""What each patch of the sky gives in each interval of a year, and in a period together.

As Radiance's gendaymtx: a patch is as bright as the sky at its centre, and all together they give
the diffuse irradiance that was asked for; the sun is spread over the four nearest patches.
"""

from collections.abc import Iterator
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .hourly import HourlySkies, Quantity, hourly_skies
from .luminance import relative_blocks
from .patches import patches_of
from .site import Site
from .sky import Patches, Skies
from .weather import Weather

Direct = Literal["patches", "none"]

_SHARERS = 4
_NEARNESS = 1.002
_LARGEST = 1 << 29


def sky_matrix(
    weather: Weather,
    site: Site,
    subdivision: int,
    *,
    quantity: Quantity = "radiation",
    direct: Direct = "patches",
) -> Vector:
    """The radiance (P, T) in W/(m² sr), or the luminance in cd/m², of each patch in each interval.

    Patches in the order of `patches_of`, in world directions. With ``direct`` "patches" they hold
    the sun too, as `matrix_blocks` says; with "none" it is left to true suns.

    Raises ParameterError as `hourly_skies` and `patches_of` do, and for a matrix beyond 4 GiB.
    """
    patches = patches_of(subdivision)
    count = len(patches.solid_angles), len(weather.times)
    require_size(*count)
    found = np.zeros(count[::-1])
    for which, block in matrix_blocks(hourly_skies(weather, site, quantity), patches, direct):
        found[which] = block
    return found.T


def require_size(patches: int, intervals: int) -> None:
    """Raise ParameterError for a sky matrix of more numbers than 4 GiB hold in float64."""
    if patches * intervals > _LARGEST:
        raise ParameterError(
            f"A sky of {patches:,} patches in {intervals:,} intervals is too large for memory: "
            "choose a coarser Subdivision, a shorter period, or weather of longer intervals."
        )


def cumulative(
    weather: Weather,
    site: Site,
    subdivision: int,
    selected: NDArray[np.bool_] | None = None,
    *,
    quantity: Quantity = "radiation",
    direct: Direct = "patches",
) -> Vector:
    """What each patch gives (P,) in the ``selected`` (T,) intervals together, or in all.

    In kWh/(m² sr), or in kcd h/m² for light. Summed block by block, without a matrix.

    Raises ParameterError as `hourly_skies` and `patches_of` do.
    """
    patches = patches_of(subdivision)
    hourly = hourly_skies(weather, site, quantity, selected)
    total = np.zeros(len(patches.solid_angles))
    for which, block in matrix_blocks(hourly, patches, direct):
        total += hourly.hours[which] @ block
    return total / 1000


def matrix_blocks(
    hourly: HourlySkies, patches: Patches, direct: Direct = "patches"
) -> Iterator[tuple[NDArray[np.int64], Vector]]:
    """The sky matrix in pieces of bounded size: the indices (t,) of intervals, and their (t, P).

    Intervals without light are left out: they are black. With ``direct`` "patches", a sun's light
    is shared by the four patches whose centres are nearest, by 1 / (1.002 − cos γ) at γ from the
    sun: its flux is kept, its direction blurred.

    Raises ParameterError for another ``direct``.
    """
    if direct not in get_args(Direct):
        raise ParameterError(f"Direct light goes to the “patches” or to “none”, not to “{direct}”.")
    lit = np.flatnonzero((hourly.diffuse > 0) | (hourly.direct > 0))
    for part, block in _sky_blocks(hourly.skies[lit], hourly.diffuse[lit], patches):
        which = lit[part]
        if direct == "patches":
            _add_suns(block, hourly.sun[which], hourly.direct[which], patches)
        yield which, block


def on_patches(skies: Skies, horizontal: ArrayLike, patches: Patches) -> Vector:
    """The luminance or radiance (P, T) of the patches under any skies, as the CIE's.

    ``horizontal`` (T,) or one for all: what a sky's patches together give to a horizontal plane, in
    lx for cd/m² or in W/m² for W/(m² sr).
    """
    found = np.empty((len(skies), len(patches.solid_angles)))
    for part, block in _sky_blocks(skies, np.broadcast_to(horizontal, len(skies)), patches):
        found[part] = block
    return found.T


def ground_radiance(hourly: HourlySkies, reflectance: float = 0.2) -> Vector:
    """The radiance (T,) in W/(m² sr), or the luminance in cd/m², of level diffuse ground.

    What gendaymtx puts in the matrix's first row, for ground that sees the whole sky.

    Raises ParameterError for a ``reflectance`` outside 0 to 1.
    """
    if not 0 <= reflectance <= 1:
        raise ParameterError(f"The ground reflects a share of 0 to 1, not {reflectance:g}.")
    falling = hourly.diffuse + hourly.direct * np.maximum(hourly.sun[:, 2], 0.0)
    return falling * reflectance / np.pi


def _sky_blocks(
    skies: Skies, horizontal: Vector, patches: Patches
) -> Iterator[tuple[slice, Vector]]:
    """The skies on patches in pieces of bounded size: which skies, and (t, P) of theirs."""
    projected = patches.solid_angles * patches.directions[:, 2]
    for part, block in relative_blocks(skies, patches.directions):
        block *= (horizontal[part] / (block @ projected))[:, None]
        yield part, block


def _add_suns(block: Vector, sun: Vector, direct: Vector, patches: Patches) -> None:
    """Add the suns (t, 3) that shine to the patches (t, P), in place."""
    shining = np.flatnonzero(direct > 0)
    if not shining.size:
        return
    nearness = sun[shining] @ patches.directions.T
    nearest = np.argpartition(nearness, -_SHARERS, axis=1)[:, -_SHARERS:]
    share = 1 / (_NEARNESS - np.take_along_axis(nearness, nearest, axis=1))
    share *= (direct[shining] / share.sum(axis=1))[:, None]
    block[shining[:, None], nearest] += share / patches.solid_angles[nearest]
