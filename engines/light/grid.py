"""The texels of all receivers: how large they are, and which of them answer for which."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.scene import Receiver, Scene
from . import atlas
from .atlas import Texels
from .targets import Side, sides_of

Sums = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Grid:
    """Texels (T,) of all ``sides``.

    ``area`` in m², 0 where a map has no surface; ``scale`` in 1/m², what makes illuminance of flux:
    1 ÷ area ÷ the share that a receiver takes; ``home`` (T,) the texel that answers for each, or
    None where each answers for itself. ``charts`` has for each side of a mesh what its texels
    cover, None for a plane.
    """

    sides: tuple[Side, ...]
    area: Sums
    scale: Sums
    home: NDArray[np.int64] | None
    charts: tuple[Texels | None, ...]

    def gathered(self, sums: Sums) -> Sums:
        """Sums (T,) with those of slivers brought to the texels that answer for them."""
        if self.home is None:
            return sums
        return np.bincount(self.home, sums, sums.size)


def grid_of(scene: Scene) -> Grid:
    """The texels of a scene.

    Raises SceneError for a mesh whose UV map cannot take light, and for a receiver that returns all
    light: what arrives is counted by what stays.
    """
    for receiver in scene.receivers:
        if receiver.reflectance >= 1:
            raise SceneError(
                f"Receiver “{receiver.name}” returns all light, so that none stays to be counted; "
                "lower its reflectance below 1."
            )
    sides = sides_of(scene)
    charts: dict[int, Texels] = {}
    for receiver in scene.receivers:
        if not isinstance(receiver, Receiver):
            atlas.require_chart(receiver)
            charts[id(receiver)] = atlas.texels(receiver)
    found = tuple(charts.get(id(side.receiver)) for side in sides)
    count = sides[-1].texels.stop if sides else 0
    area, scale, home = np.zeros(count), np.zeros(count), np.arange(count)
    for side, chart in zip(sides, found, strict=True):
        receiver = side.receiver
        if chart is None:
            assert isinstance(receiver, Receiver)
            area[side.texels] = receiver.texel_area
        else:
            area[side.texels] = chart.area.ravel()
            home[side.texels] = chart.home.ravel() + side.first
        taken = 1.0 - receiver.reflectance
        own = area[side.texels]
        scale[side.texels] = np.divide(1.0, own * taken, out=np.zeros_like(own), where=own > 0)
    return Grid(sides, area, scale, home if charts else None, found)
