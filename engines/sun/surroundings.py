"""All that daylight meets: bodies in one tree, with what each of their triangles does to light."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.scene import Body, Material, Vector
from . import panes
from .occlusion import is_pane
from .soup import Soup

RECORD = 8
"""Floats a triangle: its normal, CLEAR, GROUND or 0 for no pane, of panes index, tint and
whether it is a sheet, of others what they return, the share of that as a mirror does, and 0; and
the step in m off it."""
CLEAR, GROUND = 1.0, 2.0


class Surroundings:
    """All bodies about ``centre`` (3,) m in one tree, with what each triangle does to light."""

    def __init__(self, bodies: tuple[Body, ...], centre: Vector | None = None) -> None:
        if centre is None:
            centre = _middle(bodies)
        self.soup = Soup(bodies, centre)
        self.records: Any = None
        if self.soup.scene is not None:
            mi = runtime.mitsuba()
            self.records = mi.Float(_records(self.soup).ravel())

    @property
    def glazed(self) -> bool:
        """Whether there is a pane."""
        return any(is_pane(body.material) for body in self.soup.bodies)

    def told(self) -> tuple[str, ...]:
        """What is left out of how its materials treat light, a sentence each."""
        return (*_left_out(self.soup.bodies), *panes.told(self.soup))


def _records(soup: Soup) -> NDArray[np.float32]:
    """(T, RECORD) of the soup's triangles."""
    own = np.array([_own(soup, number) for number in range(len(soup.bodies))])
    outward = soup.normals() * soup.orientation[soup.owner, None]
    return np.concatenate([outward, own[soup.owner], soup.steps()[:, None]], axis=1).astype(
        np.float32
    )


def _own(soup: Soup, number: int) -> tuple[float, float, float, float]:
    material = soup.bodies[number].material
    if material.kind == "dielectric":
        finish = CLEAR if is_pane(material) else GROUND
        return finish, material.ior, panes.tint(material), float(not soup.closed(number))
    returned, mirrored = returned_by(material)
    return 0.0, returned, mirrored / returned if returned else 0.0, 0.0


def returned_by(material: Material) -> tuple[float, float]:
    """What an opaque surface returns in all, and as a mirror does."""
    match material.kind:
        case "diffuse":
            return material.reflectance, 0.0
        case "plastic":
            matte = (1 - material.specularity) * material.reflectance
            return material.specularity + matte, material.specularity
        case "mirror":
            return material.reflectance, material.reflectance
    return 0.0, 0.0


def is_shiny(material: Material) -> bool:
    """Whether it returns some of the light as a mirror does."""
    return returned_by(material)[1] > 0


def _left_out(bodies: tuple[Body, ...]) -> Iterator[str]:
    for body in bodies:
        if body.material.kind == "dielectric" and not is_pane(body.material):
            yield (
                f"“{body.name}” is ground glass: here it lets through as much as clear glass, "
                "scattered evenly."
            )
        elif body.material.kind == "mirror" and body.material.roughness > 0:
            yield f"“{body.name}” is a satin mirror, which is taken as a smooth one here."


def _middle(bodies: tuple[Body, ...]) -> Vector:
    places = [body.mesh.vertices for body in bodies if len(body.mesh.vertices)]
    if not places:
        return np.zeros(3)
    low = np.min([p.min(axis=0) for p in places], axis=0)
    high = np.max([p.max(axis=0) for p in places], axis=0)
    return (low + high) / 2
