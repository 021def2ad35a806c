"""The texels of all receivers: how large they are, and which of them answer for which."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..core import atlas
from ..core.atlas import Texels
from ..core.clipping import Indices, pieces
from ..core.errors import SceneError
from ..core.scene import Receiver, Scene, Surface
from .targets import Side, sides_of

Sums = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Cut:
    """The pieces (P,) that a mesh's map cuts its faces into, texel by texel.

    Those of texel t are ``first`` [t] to ``first`` [t + 1]. ``face`` is what a piece is of, with
    the shares ``weights`` (P, 3) of its corners at the piece's centroid; ``share`` is its area over
    the mean of its texel's pieces.
    """

    first: Indices
    face: Indices
    weights: Sums
    share: Sums


@dataclass(frozen=True, eq=False)
class Chart:
    """A mesh as its map shows it: what the ``texels`` cover, and of which pieces they are."""

    surface: Surface
    texels: Texels

    @cached_property
    def cut(self) -> Cut:
        """The pieces of the faces that have an area, each with the texel that answers for it."""
        surface = self.surface
        a, b, c = surface.mesh.vertices[surface.mesh.faces].transpose(1, 0, 2)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        solid = np.flatnonzero(areas > 0)
        found = list(pieces(surface.texture[solid], surface.columns, surface.rows))
        face = solid[np.concatenate([p.face for p in found])]
        area = np.concatenate([p.part for p in found]) * areas[face]
        texel = self.texels.home.ravel()[np.concatenate([p.texel for p in found])]
        weights = np.concatenate([p.weights for p in found], axis=1).T
        order = np.argsort(texel, kind="stable")
        count = np.bincount(texel, minlength=self.texels.home.size)
        mean = np.bincount(texel, area, count.size) / np.maximum(count, 1)
        share = area / np.maximum(mean[texel], np.finfo(float).tiny)
        first = np.concatenate([[0], np.cumsum(count)])
        return Cut(first, face[order], weights[order], share[order])


@dataclass(frozen=True, slots=True)
class Grid:
    """Texels (T,) of all ``sides``.

    ``area`` in m², 0 where a map has no surface; ``scale`` in 1/m², what makes illuminance of flux:
    1 ÷ area ÷ the share that a receiver takes; ``home`` (T,) the texel that answers for each, or
    None where each answers for itself. ``charts`` has the map of each side of a mesh, None for a
    plane.
    """

    sides: tuple[Side, ...]
    area: Sums
    scale: Sums
    home: NDArray[np.int64] | None
    charts: tuple[Chart | None, ...]

    def gathered(self, sums: Sums) -> Sums:
        """Sums (T,) with those of slivers brought to the texels that answer for them."""
        if self.home is None:
            return sums
        return np.bincount(self.home, sums, sums.size)

    def staying(self, lux: Sums) -> float:
        """The flux in lm that the receivers take of an illuminance (T,)."""
        lit = self.scale > 0
        return float((lux[lit] / self.scale[lit]).sum())


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
    charts: dict[int, Chart] = {}
    for receiver in scene.receivers:
        if not isinstance(receiver, Receiver):
            atlas.require_chart(receiver)
            charts[id(receiver)] = Chart(receiver, atlas.texels(receiver))
    found = tuple(charts.get(id(side.receiver)) for side in sides)
    count = sides[-1].texels.stop if sides else 0
    area, scale, home = np.zeros(count), np.zeros(count), np.arange(count)
    for side, chart in zip(sides, found, strict=True):
        receiver = side.receiver
        if chart is None:
            assert isinstance(receiver, Receiver)
            area[side.texels] = receiver.texel_area
        else:
            area[side.texels] = chart.texels.area.ravel()
            home[side.texels] = chart.texels.home.ravel() + side.first
        taken = 1.0 - receiver.reflectance
        own = area[side.texels]
        scale[side.texels] = np.divide(1.0, own * taken, out=np.zeros_like(own), where=own > 0)
    return Grid(sides, area, scale, home if charts else None, found)
