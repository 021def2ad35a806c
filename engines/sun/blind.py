"""Sensors that see nothing for a reason that a person should hear of."""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from . import bits
from .inside import inside
from .occlusion import Occluders
from .rays import Rays, facing

_NAMED = 3  # solids at most that have a sentence each


@dataclass
class Blind:
    """Of ``count`` sensors, ``away`` face away from every direction; ``inside``: how many by solid.

    Two add up, for sensors that are looked at in parts.
    """

    count: int = 0
    away: int = 0
    inside: Counter[str] = field(default_factory=Counter)

    def __add__(self, other: "Blind") -> "Blind":
        return Blind(self.count + other.count, self.away + other.away, self.inside + other.inside)

    def told(self) -> tuple[str, ...]:
        """A sentence on each kind; many solids have one together."""
        told = []
        if self.away:
            some = "All" if self.away == self.count else f"{self.away:,} of"
            told.append(
                f"{some} {self.count:,} sensors face away from every direction and see nothing; "
                "if they should not, turn their normals."
            )
        solids = {f"“{name}”": number for name, number in self.inside.items()}
        if len(solids) > _NAMED:
            most = max(solids, key=lambda name: solids[name])
            solids = {f"{len(solids):,} bodies, most of them in {most}": self.inside.total()}
        told += [
            f"{number:,} of {self.count:,} sensors lie inside {solid} and see nothing; move them, "
            "or turn their normals if that is the body they are on."
            for solid, number in solids.items()
        ]
        return tuple(told)


def blind(occluders: Occluders, fan: Rays, seen: bits.Bits) -> Blind:
    """Which of the sensors are; ``seen`` (N, bytes) is what they see.

    Who faces away or is inside a solid sees nothing, so only such sensors are looked at.
    """
    dark = fan.some(np.flatnonzero(~seen.any(axis=1)))
    front = facing(dark).any(axis=1)
    within = inside(occluders, dark.origins[front], dark.normals[front])
    return Blind(len(fan.origins), int(np.count_nonzero(~front)), within)
