"""The sky's patches as paths escape to them."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..core import runtime
from .patches import rows_of
from .site import Site, to_world


@dataclass(frozen=True, slots=True)
class Dome:
    """The patches that paths escape to: Reinhart's of ``subdivision``, and the ground as the last;
    they stand to the model as ``site`` has it."""

    subdivision: int
    site: Site

    @property
    def rows(self) -> tuple[int, ...]:
        """Patches in each row of altitude."""
        return rows_of(self.subdivision)

    @property
    def count(self) -> int:
        """Of patches, with the ground."""
        return sum(self.rows) + 1


def escaped_to(direction: Any, dome: Dome) -> Any:
    """As `patches.patch_at`, on the device and of directions in the model's axes."""
    mi = runtime.mitsuba()
    import drjit as dr

    rows = np.array(dome.rows, np.uint32)
    height = np.pi / 2 / (len(rows) - 0.5)
    first = mi.UInt32(np.cumsum(rows) - rows)
    (cosine, sine, _), _, _ = to_world(np.eye(3), dome.site)
    cosine, sine = dr.opaque(mi.Float, cosine), dr.opaque(mi.Float, -sine)
    x = direction.x * cosine + direction.y * sine
    y = direction.y * cosine - direction.x * sine
    altitude = dr.atan2(direction.z, dr.hypot(x, y))
    above = altitude >= 0
    row = mi.UInt32(dr.select(above, altitude / dr.opaque(mi.Float, height), 0))
    row = dr.minimum(row, dr.opaque(mi.UInt32, len(rows) - 1))
    count = dr.gather(mi.UInt32, mi.UInt32(rows), row)
    turn = dr.atan2(x, y) / dr.two_pi
    turn += dr.select(turn < 0, 1, 0)
    place = mi.UInt32(turn * mi.Float(count) + 0.5)
    place = dr.select(place >= count, 0, place)
    patch = dr.gather(mi.UInt32, first, row) + place
    return dr.select(above, patch, dr.opaque(mi.UInt32, dome.count - 1))
