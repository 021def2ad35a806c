"""The sky's patches after Tregenza and Reinhart, in the order of Radiance's gendaymtx -m."""

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .sky import Patches

TREGENZA = (30, 30, 24, 24, 18, 12, 6)
"""Patches in each of Tregenza's rows from the horizon up; the zenith's cap is one more.
[Tregenza 1987, Lighting Research & Technology 19(1):13–14]"""

BELOW = -1
"""The index of a direction under the horizon."""


def patches_of(subdivision: int) -> Patches:
    """The 144 · subdivision² + 1 patches of the dome, ``subdivision`` 1 (Tregenza) to 4.

    Reinhart's division cuts each of Tregenza's patches into subdivision²: all rows are equally high
    but for the zenith's cap, which is half a row. Row by row from the horizon up, in each row
    clockwise from the patch that is centred on north; as gendaymtx -m orders them, whose first
    row, the ground, is left out here. A direction is at the middle of the patch's altitudes.

    Raises ParameterError for another subdivision.
    """
    height = _row_height(subdivision)
    rows = rows_of(subdivision)
    row = np.repeat(np.arange(len(rows)), rows)
    place = np.concatenate([np.arange(count) for count in rows])
    count = np.array(rows)[row]
    altitude = np.where(row < len(rows) - 1, height * (row + 0.5), np.pi / 2)
    azimuth = 2 * np.pi * place / count
    horizontal = np.where(row < len(rows) - 1, np.cos(altitude), 0.0)
    directions = np.stack(
        [horizontal * np.sin(azimuth), horizontal * np.cos(azimuth), np.sin(altitude)], axis=1
    )
    edges = np.append(height * np.arange(len(rows)), np.pi / 2)
    return Patches(directions, (2 * np.pi * np.diff(np.sin(edges)) / rows)[row], rows)


def patch_at(directions: Vector, subdivision: int) -> NDArray[np.int64]:
    """The index (D,) of the patch that each of ``directions`` (D, 3), unit vectors, lies in.

    `BELOW` for those under the horizon. As Radiance's reinhartb.cal has it.

    Raises ParameterError for a subdivision that `patches_of` has not.
    """
    height = _row_height(subdivision)
    rows = np.array(rows_of(subdivision))
    x, y, z = np.moveaxis(np.asarray(directions, float), -1, 0)
    altitude = np.arctan2(z, np.hypot(x, y))
    row = np.clip((altitude / height).astype(np.int64), 0, len(rows) - 1)
    turn = np.arctan2(x, y) / (2 * np.pi)
    place = np.floor(turn * rows[row] + 0.5).astype(np.int64) % rows[row]
    first = np.cumsum(rows) - rows
    return np.where(altitude >= 0, first[row] + place, BELOW)


def rows_of(subdivision: int) -> tuple[int, ...]:
    """How many patches each row has, from the horizon up; the zenith's, the last, has one."""
    return (*(count * subdivision for count in TREGENZA for _ in range(subdivision)), 1)


def _row_height(subdivision: int) -> float:
    """The altitude that a row spans, in rad."""
    if subdivision not in (1, 2, 3, 4):
        raise ParameterError(
            f"A sky's patches are Tregenza's divided by 1, 2, 3 or 4 each way, not {subdivision!r}."
        )
    return np.pi / 2 / (len(TREGENZA) * subdivision + 0.5)
