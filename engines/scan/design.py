"""The design that a finished piece is compared with: its surface, its sides, its own layers."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.scene import Body, Vector
from .around import Around, around_of
from .closest import Target, target_of
from .found import Found, Sides, layers_of
from .settle import lever_of

_GLANCED, _SAMPLED = 80_000, 240_000  # points to see its layers, and to measure them from
_RIM = 0.9  # of a face's normal is upright, or it is a side


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

    def unroll(self, points: Vector, faces: NDArray[np.integer[Any]]) -> Sides:
        """Points (N, 3) in m that belong to the triangles ``faces`` (N,), around the wall."""
        side = self.side[faces]
        if self.around:
            return Sides(points[:, 2], side, *self.around.unroll(points))
        middle = self.target.anchors[:, :2].mean(axis=0)
        turn = np.mod(np.arctan2(*(points[:, :2] - middle).T[::-1]) / (2 * np.pi), 1.0)
        return Sides(points[:, 2], side, turn, np.zeros(len(points)))

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
    around = around_of(target.mesh)
    design = Design(body.name, target, _sides(target, around), around, None, 0.0)
    sample, face = target.sample(_SAMPLED, np.random.default_rng(seed))
    design = replace(design, size=lever_of(sample))
    if around is None:
        return design
    glance = layers_of(design.unroll(sample[:_GLANCED], face[:_GLANCED]))
    if glance.rhythmic:
        design = replace(design, around=around_of(target.mesh, glance.pitch) or around)
    return replace(design, found=layers_of(design.unroll(sample, face)))


def _sides(target: Target, around: Around | None) -> Vector:
    """On which side each triangle is (F,), by where its normal looks."""
    middle = target.mesh.vertices[target.mesh.faces].mean(axis=1)
    plan = middle[:, :2]
    out = around.outward(middle) if around else plan - np.median(plan, axis=0)
    look = (target.normals[:, :2] * out).sum(axis=1)
    return np.where(np.abs(target.normals[:, 2]) > _RIM, 0.0, np.sign(look))
