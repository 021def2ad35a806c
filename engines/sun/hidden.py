"""Sensors that bodies leave neither sun nor sky, which a person should hear of."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Receiver, Surface, Vector
from . import bits
from .inside import holders
from .occlusion import Occluders
from .patches import patches_of
from .rays import rays_of, unblocked
from .sensors import Sensors, joined

_SLIPPED = 1e-3  # of the directions above the horizon
_ODD = 0.31  # rad: turned by it, the patches' directions run along no edge that is built square
_TURN = np.array([[np.cos(_ODD), np.sin(_ODD), 0], [-np.sin(_ODD), np.cos(_ODD), 0], [0, 0, 1]])
_LEVEL = -0.1  # the height of a normal, below which a sensor looks to the ground


def skyless(seen: bits.Bits, directions: Vector) -> NDArray[np.bool_]:
    """Which sensors see none of the ``directions`` (D, 3) above the horizon, or as good as none.

    ``seen`` (N, ceil(D / 8)) is what they see. A ray along an edge may slip between its faces.
    """
    above = directions[:, 2] > 0
    count = np.bitwise_count(seen & bits.packed(above)).sum(axis=1, dtype=np.int64)
    return count <= _SLIPPED * np.count_nonzero(above)


def hidden(
    occluders: Occluders,
    receivers: Sequence[Receiver | Surface],
    parts: Sequence[Sensors],
    dark: NDArray[np.bool_],
) -> tuple[str, ...]:
    """A sentence on each receiver with sensors that see neither sun nor sky.

    ``parts``: the sensors of each receiver; ``dark``: which of all of them, in this order, see
    none. Those that look to the ground are as they should be; of those inside a solid `blind`
    tells, and of receivers that look the wrong way `wound`.
    """
    told, first = [], 0
    for receiver, sensors in zip(receivers, parts, strict=True):
        rows = np.flatnonzero(dark[first : first + len(sensors)])
        first += len(sensors)
        if sensors.doubtful:
            continue
        rows = rows[sensors.normals[rows, 2] > _LEVEL]
        fan = rays_of(occluders, sensors.some(rows), np.zeros((0, 3)))
        number = sum(not name for name in holders(occluders, fan.origins, fan.normals))
        if number:
            some = "All" if 1 < number == len(sensors) else f"{number:,} of"
            see = "sees" if number == 1 else "see"
            told.append(
                f"{some} {len(sensors):,} sensors of “{receiver.name}” {see} neither sun nor sky, "
                "which bodies hide; if that is not meant, move what lies on the receiver or around "
                "it, or turn its normals."
            )
    return tuple(told)


def unlit(
    occluders: Occluders,
    receivers: Sequence[Receiver | Surface],
    parts: Sequence[Sensors],
    daylight: Vector,
) -> tuple[str, ...]:
    """As `hidden`, where what bodies reflect counts: of receivers that see no sky at all, and of
    sensors without any ``daylight`` (N,)."""
    dark = np.ones(len(daylight), bool)
    everywhere = joined(*parts)
    for subdivision in (1, 4):
        left = np.flatnonzero(dark)
        sky = patches_of(subdivision).directions @ _TURN
        fan = rays_of(occluders, everywhere.some(left), sky)
        seen = unblocked(occluders.moving, fan, unblocked(occluders.still, fan))
        dark[left] = skyless(seen, sky)
    ends = np.cumsum([len(part) for part in parts])[:-1]
    whole = [np.full(len(some), some.all()) for some in np.split(dark, ends)]
    return hidden(occluders, receivers, parts, dark & (np.concatenate(whole) | (daylight == 0)))
