"""Wind on the cells of a structure."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..core.errors import ParameterError
from ..core.scene import Vector
from .tributary import Tributary

Method = Literal["drag", "normal", "walls"]
WINDS = {
    "+x": np.array([1.0, 0.0, 0.0]),
    "-x": np.array([-1.0, 0.0, 0.0]),
    "+y": np.array([0.0, 1.0, 0.0]),
    "-y": np.array([0.0, -1.0, 0.0]),
}

# EN 1991-1-4:2005 Table 7.1, c_pe,10 of vertical walls of buildings with a rectangular plan.
_RATIOS = np.array([0.25, 1.0, 5.0])  # height over depth
_WINDWARD = np.array([0.7, 0.8, 0.8])  # zone D
_LEEWARD = np.array([-0.3, -0.5, -0.7])  # zone E
_SIDES = (-1.2, -0.8, -0.5)  # zones A, B and C
_STEEPEST_ROOF = np.sin(np.radians(15.0))


def wind_pressures(
    tributary: Tributary, direction: ArrayLike, pressure: float, method: Method = "drag"
) -> Vector:
    """Load (F, 3) in N/m² of true area on each cell, of a wind that blows along ``direction``.

    ``direction`` (3,) is a unit vector, level; ``pressure`` in N/m² is the wind's.

    “drag”: windward faces take the pressure on their area projected along the wind, and pass it on
    along the wind, as a mesh load does that is given in a global direction and on the projected
    area. “normal”: windward faces take pressure · cos of the angle of incidence, against their
    normals. Faces in the lee take nothing in either, and nothing shelters anything else.

    “walls”: c_pe,10 of EN 1991-1-4:2005, Table 7.1, for the vertical walls of a building with a
    rectangular plan, of which pressure is q_p: zones A to E by the faces' normals (a face within
    45° of the wind is D or E) and, along the sides, by their distance from the windward edge. The
    lack of correlation of 7.2.2(3) and the pressure inside are left out.

    Raises ParameterError where “walls” is asked of faces that lean by more than 15°.
    """
    wind = np.asarray(direction, dtype=np.float64)
    normals = tributary.normals
    facing = normals @ wind
    exposed = np.maximum(-facing, 0.0)[:, None]
    if method == "drag":
        return pressure * exposed * wind
    if method == "normal":
        return -pressure * exposed * normals
    return -pressure * _wall_coefficients(tributary, wind)[:, None] * normals


def _wall_coefficients(tributary: Tributary, wind: Vector) -> Vector:
    """External pressure coefficients (F,) by Table 7.1, positive toward the face."""
    normals = tributary.normals
    leaning = np.abs(normals[:, 2]) > _STEEPEST_ROOF
    if leaning.any():
        worst = int(np.argmax(np.abs(normals[:, 2])))
        degrees = np.degrees(np.arcsin(np.abs(normals[worst, 2])))
        raise ParameterError(
            f"[structure.loading] wind_method “walls” is for vertical faces, but cell {worst} "
            f"leans by {degrees:.0f}°; take “drag” or “normal”."
        )
    across = np.array([-wind[1], wind[0], 0.0])
    facing = normals @ wind
    along = tributary.corners @ wind
    height = np.ptp(tributary.corners[..., 2])
    ratio = height / max(np.ptp(along), 1e-9)
    edge = min(np.ptp(tributary.corners @ across), 2 * height)
    behind = tributary.centres @ wind - along.min()
    sides = np.select([behind < edge / 5, behind < edge], _SIDES[:2], _SIDES[2])
    limit = np.sqrt(0.5) - 1e-9
    windward = np.interp(ratio, _RATIOS, _WINDWARD)
    leeward = np.interp(ratio, _RATIOS, _LEEWARD)
    return np.select([facing <= -limit, facing >= limit], [windward, leeward], sides)
