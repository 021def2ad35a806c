"""The wall: its vertical section, a closed loop of two beaded sides and two flat rims."""

from dataclasses import dataclass

import numpy as np

from ..core.scene import Vector
from .bead import Bead, relief

_SLIVER = 1e-6  # m; a layer that would be cut off thinner than this is left out


@dataclass(frozen=True, slots=True)
class Section:
    """A wall's vertical section: a closed loop of K points, up the outside and down the inside.

    ``offset`` (K,) in m along the base curve's normal, 0 at the outermost apexes; ``height`` (K,)
    in m. Segment i runs from point i to the next; ``start`` and ``end`` (K, 2) are the unit
    normals at its ends, along the base curve's normal and upward: they differ from the
    neighbouring segment's where the surface is creased. All float64.
    """

    offset: Vector
    height: Vector
    start: Vector
    end: Vector


def half_layers(height: float, bead: Bead) -> int:
    """How many half layers stand in a wall of ``height`` in m, the cut-off one at the top too."""
    return max(1, int(np.ceil((height - _SLIVER) / (bead.height / 2))))


def levels(height: float, bead: Bead, parts: int) -> Vector:
    """Heights in m of a wall's points, from 0 to ``height``, ``parts`` steps to a half layer.

    Layer boundaries and bead apexes are among them; the last half layer is cut off at ``height``.
    """
    half = bead.height / 2
    whole = half_layers(height, bead) - 1
    last = max(1, int(np.ceil(parts * (height - whole * half) / half - 1e-3)))
    lower = np.arange(whole * parts) * (half / parts)
    upper = np.linspace(whole * half, height, last + 1)
    return np.concatenate([lower, upper], dtype=np.float64)


def wall_section(thickness: float, height: float, bead: Bead, parts: int, rings: int) -> Section:
    """The section of a wall of ``thickness`` from apex to apex and ``height``, in m.

    ``parts`` steps to a half layer, ``rings`` to a rim. Both sides carry the bead's relief. The
    sag must be less than half the thickness.
    """
    z = levels(height, bead, parts)
    layer = np.minimum(np.arange(len(z) - 1) // parts, half_layers(height, bead) - 1) // 2
    floor = layer * bead.height
    low, tilt_low = relief(bead, z[:-1] - floor)
    high, tilt_high = relief(bead, z[1:] - floor)
    depth = np.append(low, high[-1]) - bead.depth
    rim = np.arange(1, rings) / rings

    inner = -thickness - depth
    up, down = np.array([0.0, 1.0]), np.array([0.0, -1.0])
    rise = np.column_stack([np.cos(tilt_low), -np.sin(tilt_low)])
    crest = np.column_stack([np.cos(tilt_high), -np.sin(tilt_high)])
    mirror = np.array([-1.0, 1.0])
    return Section(
        offset=np.concatenate(
            [
                depth,
                depth[-1] + rim * (inner[-1] - depth[-1]),
                inner[::-1],
                inner[0] + rim * (depth[0] - inner[0]),
            ]
        ),
        height=np.concatenate([z, np.full(rings - 1, height), z[::-1], np.zeros(rings - 1)]),
        start=np.concatenate(
            [rise, np.tile(up, (rings, 1)), crest[::-1] * mirror, np.tile(down, (rings, 1))]
        ),
        end=np.concatenate(
            [crest, np.tile(up, (rings, 1)), rise[::-1] * mirror, np.tile(down, (rings, 1))]
        ),
    )
