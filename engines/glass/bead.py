"""The bead: the relief that one printed layer leaves on a wall."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..core.parameters import param
from ..core.scene import Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class Bead:
    """Relief that one printed layer leaves on a wall."""

    height: float = param(5.0e-3, "m", 5e-4, 2e-2, "Layer height")
    sag: float = param(1.2e-3, "m", 0.0, 5e-3, "How far the bead bulges from the wall")
    style: Literal["scalloped", "flat"] = param(
        "scalloped", help="Cross-section of the bead: circular arc, or none (a plain wall)"
    )

    @property
    def depth(self) -> float:
        """How far the relief stands out, in m: the sag, or 0 for a plain wall."""
        return self.sag if self.style == "scalloped" else 0.0


def arc_radius(bead: Bead) -> float:
    """Radius in m of the arc through both layer boundaries; the bead must have a depth."""
    return (bead.height**2 / 4 + bead.depth**2) / (2 * bead.depth)


def relief(bead: Bead, position: ArrayLike) -> tuple[Vector, Vector]:
    """How far the bead stands out at ``position``, and how its surface leans there.

    ``position`` is the height above the layer's lower boundary in m, of any shape, held within
    0..``bead.height``. Returns, of the same shape in float64, the offset in m (0 at the layer
    boundaries, the sag at mid-height) and the tilt in radians: the offset's slope is its tangent,
    the surface's normal (cos tilt, −sin tilt) along the wall's normal and upward. A scalloped bead
    is the arc of a circle, so that its curvature is 1 / `arc_radius` everywhere. The sag must be
    at most half the height.
    """
    across = np.clip(position, 0.0, bead.height) - bead.height / 2
    if bead.depth == 0:
        return np.zeros_like(across), np.zeros_like(across)
    radius = arc_radius(bead)
    tilt = -np.arcsin(np.clip(across / radius, -1.0, 1.0))
    return bead.depth - across**2 / (radius * (1 + np.cos(tilt))), tilt
