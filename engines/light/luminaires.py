"""Luminaires as the photon loop and the direct light use them."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.scene import Luminaire
from . import ies, photometry
from .photometry import Photometry

Shape = Literal["round", "rectangular", "point"]


@dataclass(frozen=True, slots=True)
class Source:
    """A luminaire with everything settled.

    ``width`` (along its Y) and ``length`` (along its X) are those of the opening in m; light leaves
    each of its points alike. ``distribution`` is the luminous intensity of the whole opening, or
    None where all light is parallel to the axis. ``flux`` in lm is what leaves it. ``axes`` (3, 3)
    has the lamp's own X, Y, Z as columns; ``origin`` (3,) m is the opening's centre.
    """

    name: str
    distribution: Photometry | None
    shape: Shape
    width: float
    length: float
    flux: float
    axes: NDArray[np.float64]
    origin: NDArray[np.float64]

    @property
    def area(self) -> float:
        """Area of the opening in m²; 0 for a point."""
        if self.shape == "point":
            return 0.0
        return self.width * self.length * (np.pi / 4 if self.shape == "round" else 1.0)


def source(luminaire: Luminaire) -> Source:
    """What a luminaire emits and from where.

    Raises SceneError for a parallel beam without an opening or a lamp without flux, FileError for
    a photometric file that cannot be read.
    """
    lamp, pose = luminaire.lamp, luminaire.pose
    axes = pose[:3, :3] / np.linalg.norm(pose[:3, :3], axis=0)
    if not np.allclose(axes.T @ axes, np.eye(3), atol=1e-4):
        raise SceneError(f"Lamp “{luminaire.name}” is sheared or flat; apply its scale.")
    if lamp.source != "ies" and lamp.flux == 0:
        raise SceneError(f"Lamp “{luminaire.name}” has no luminous flux; give it one in lm.")
    distribution, shape, width, length = _emission(luminaire)
    if distribution is None:
        flux = lamp.flux
        if width * length == 0:
            raise SceneError(
                f"Lamp “{luminaire.name}” is a beam without an opening; give it a width."
            )
    else:
        if lamp.source == "ies" and lamp.flux > 0:
            distribution = photometry.scaled_to(distribution, lamp.flux)
        flux = photometry.luminous_flux(distribution)
    if shape == "round":
        length = length or width
    if width == length == 0:
        shape = "point"
    return Source(luminaire.name, distribution, shape, width, length, flux, axes, pose[:3, 3])


def _emission(luminaire: Luminaire) -> tuple[Photometry | None, Shape, float, float]:
    lamp = luminaire.lamp
    asked: Shape = "rectangular" if lamp.opening == "rectangular" else "round"
    length = lamp.length if asked == "rectangular" else lamp.width
    match lamp.source:
        case "point":
            return photometry.isotropic(lamp.flux), "point", 0.0, 0.0
        case "disk":
            return photometry.lambertian(lamp.flux), asked, lamp.width, length
        case "beam":
            return None, asked, lamp.width, length
    read = ies.read_ies(lamp.file or ies.sample_path())
    if lamp.opening == "file":
        return read, read.opening, read.width, read.length
    return read, asked, lamp.width, length
