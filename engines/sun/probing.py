"""How far it is from single places to the next surface, and what lies below sensors."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.scene import Vector
from .occlusion import Occluders
from .rays import rays_of
from .sensors import Sensors
from .soup import Soup

type Places = NDArray[np.float32] | NDArray[np.float64]

UP = np.array([0.0, 0.0, 1.0])
_SAID = 0.01
"""The share of sensors without a floor from which on it is said."""


def distances(soups: Iterable[Soup], origins: Places, directions: Places) -> Vector:
    """m (N,) from ``origins`` (N, 3) along unit ``directions`` (N, 3) to a triangle, inf for none.

    All are about the soups' centre. Raises RuntimeMissing where nothing can be traced.
    """
    found = np.full(len(origins), np.inf)
    for soup in soups:
        if soup.scene is None or not len(origins):
            continue
        mi = runtime.mitsuba()
        ray = mi.Ray3f(mi.Point3f(_loaded(origins)), mi.Vector3f(_loaded(directions)))
        hit = soup.scene.ray_intersect_preliminary(ray)
        met = np.asarray(hit.is_valid())
        found = np.minimum(found, np.where(met, np.asarray(hit.t), np.inf))
    return found


def floor_below(occluders: Occluders, sensors: Sensors) -> Vector:
    """m (N,) from where sensors' rays start straight down to a body or a pane, inf for none."""
    fan = rays_of(occluders, sensors, np.zeros((0, 3)))
    soups = (occluders.still, occluders.moving, occluders.panes)
    return distances(soups, fan.origins, np.tile(-UP, (len(sensors), 1)))


def told_open(name: str, occluders: Occluders, sensors: Sensors) -> tuple[str, ...]:
    """A sentence where sensors that look up under a roof have open ground below.

    A receiver that only measures lets that ground's light through to what is over it.
    """
    fan = rays_of(occluders, sensors, np.zeros((0, 3)))
    up = np.flatnonzero(sensors.normals[:, 2] > 0)
    soups = (occluders.still, occluders.moving)
    roofed = np.isfinite(distances(soups, fan.origins[up], np.tile(UP, (len(up), 1))))
    under = up[roofed]
    bare = np.isinf(floor_below(occluders, sensors.some(under)))
    share = np.count_nonzero(bare) / max(len(sensors), 1)
    if share < _SAID:
        return ()
    where = f"“{name}”" if share == 1 else f"{100 * share:.0f} % of “{name}”"
    return (
        f"No floor lies below {where}: light of the open ground comes up through it; model the "
        "floor, or give the receiver its reflectance.",
    )


def _loaded(vectors: Places) -> NDArray[np.float32]:
    return np.ascontiguousarray(vectors.T.astype(np.float32))
