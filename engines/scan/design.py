"""The design that a finished piece is compared with: its surface, its sides, its own layers."""

from dataclasses import dataclass

import numpy as np

from ..core.errors import SceneError
from ..core.scene import Body, Vector
from .around import Around, around_of
from .closest import Target, target_of
from .found import Found, Sides, layers_of
from .settle import lever_of

_SAMPLED = 300_000  # points that its layers are measured from
_RIM = 0.9  # of a face's normal is upright, or it is a side
_ASIDE = 1e-5  # m, by which a face is stepped off to see on which side it is


@dataclass(frozen=True, slots=True)
class Design:
    """A body that stands upright as printed.

    ``side`` (F,) says of the target's triangles 1 outside, −1 inside, 0 on a rim. ``around`` and
    ``found``, its own layers and widths, are None where it is no wall. ``size`` in m is how far
    its surface typically is from its middle.
    """

    name: str
    target: Target
    side: Vector
    around: Around | None
    found: Found | None
    size: float

    @property
    def pitch(self) -> float:
        """Its layer height in m, 0 without layers."""
        return self.found.pitch if self.found and np.isfinite(self.found.pitch) else 0.0

    def turn(self, points: Vector) -> Vector:
        """The share of a turn (N,) at which points (N, 3) in m lie."""
        if self.around:
            return self.around.unroll(points)[0]
        middle = self.target.anchors[:, :2].mean(axis=0)
        return np.mod(np.arctan2(*(points[:, :2] - middle).T[::-1]) / (2 * np.pi), 1.0)

    @property
    def girth(self) -> float:
        """The length of a turn in m."""
        if self.around:
            return self.around.girth
        return float(np.pi * np.ptp(self.target.anchors[:, :2], axis=0).mean())


def design_of(body: Body, seed: int = 0) -> Design:
    """What a scan is compared with. Raises SceneError where the body has no surface."""
    if not len(body.mesh.faces) or not np.isfinite(body.mesh.vertices).all():
        raise SceneError(
            f"The design “{body.name}” has no faces, or corners that are no numbers; choose the "
            "mesh of the wall."
        )
    target = target_of(body.mesh)
    sample, face = target.sample(_SAMPLED, np.random.default_rng(seed))
    around = around_of(target.mesh)
    side, found = _sides(target, around), None
    if around:
        found = layers_of(Sides(sample, side[face]), around)
        if np.isfinite(found.pitch):
            around = around_of(target.mesh, found.pitch) or around
            found = layers_of(Sides(sample, side[face]), around)
    return Design(body.name, target, side, around, found, lever_of(sample))


def _sides(target: Target, around: Around | None) -> Vector:
    """On which side each triangle is (F,): where a step off it leads."""
    middle = target.mesh.vertices[target.mesh.faces].mean(axis=1)
    if around:
        step = around.unroll(middle + _ASIDE * target.normals)[1] - around.unroll(middle)[1]
    else:
        centre = target.anchors[:, :2].mean(axis=0)
        step = ((middle[:, :2] - centre) * target.normals[:, :2]).sum(axis=1)
    return np.where(np.abs(target.normals[:, 2]) > _RIM, 0.0, np.sign(step))
