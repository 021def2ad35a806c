"""Blinds that close against the sun, as LM-83 has them for spatial daylight autonomy.

All panes have them, and for the light on one receiver they move together: closed in an hour in
which sun through panes gives more than 1000 lx to more than 2 % of that receiver's front, else open
[LM-83-12, 2.2.6, which closes the panes of one façade at a time]. Closed, they are a screen behind
the pane that scatters by the cosine law what it lets through; the sun does not shine through it.
What the screen throws back is left out.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Body, Material, Vector
from .metrics import SUNNY, Light
from .occlusion import is_pane

MOST_AREA = 0.02
"""The share of the area in the sun, beyond which blinds close."""


def sunny_area(direct: Light, areas: Vector) -> Vector:
    """The area (T,) that has more than 1000 lx from the sun, hour by hour; `closed` takes shares.

    ``direct`` (N, T) in lx through panes, their blinds open, ``areas`` (N,).
    """
    return (areas.astype(np.float32) @ (direct > SUNNY)).astype(np.float64)


def closed(sunny: Vector) -> NDArray[np.bool_]:
    """In which hours the blinds are closed, where that share (T,) of the area is in the sun."""
    return sunny > MOST_AREA + 1e-6


def shut(bodies: tuple[Body, ...]) -> tuple[Body, ...]:
    """The bodies as the sun meets them with the blinds closed: panes block it."""
    black = Material(kind="absorber")
    return tuple(replace(b, material=black) if is_pane(b.material) else b for b in bodies)
