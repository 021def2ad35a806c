"""Luminaires as the photon loop and the direct light use them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.scene import Luminaire
from . import ies, photometry
from .opening import OpeningShape
from .photometry import Photometry
from .tilt import lamp_tilt, tilt_factor


@dataclass(frozen=True, slots=True)
class Source:
    """A luminaire with everything settled.

    ``width`` (along its Y) and ``length`` (along its X) are those of the opening in m; light leaves
    each of its points alike. ``distribution`` is the luminous intensity of the whole opening, or
    None where all light is parallel to the axis. ``flux`` in lm is what leaves it. ``axes`` (3, 3)
    has the lamp's own X, Y, Z as columns; ``origin`` (3,) m is the opening's centre. ``notes`` say
    what the photometric file says otherwise than it is taken.
    """

    name: str
    distribution: Photometry | None
    shape: OpeningShape
    width: float
    length: float
    flux: float
    axes: NDArray[np.float64]
    origin: NDArray[np.float64]
    notes: tuple[str, ...] = ()

    @property
    def area(self) -> float:
        """Area of the opening in m²; 0 for a point."""
        if self.shape == "point":
            return 0.0
        return self.width * self.length * (np.pi / 4 if self.shape == "round" else 1.0)


def source(luminaire: Luminaire) -> Source:
    """What a luminaire emits and from where.

    The flux that the lamp states, or what its photometric file says at the tilt it hangs with,
    times the lamp's multiplier.

    Raises SceneError for a parallel beam without an opening or a lamp that sends no light,
    FileError for a photometric file that cannot be read.
    """
    lamp, pose = luminaire.lamp, luminaire.pose
    axes = pose[:3, :3] / np.linalg.norm(pose[:3, :3], axis=0)
    if not np.allclose(axes.T @ axes, np.eye(3), atol=1e-4):
        raise SceneError(f"Lamp “{luminaire.name}” is sheared or flat; apply its scale.")
    if lamp.source != "ies" and lamp.flux == 0:
        raise SceneError(f"Lamp “{luminaire.name}” has no luminous flux; give it one in lm.")
    distribution, shape, width, length = _emission(luminaire)
    if distribution is None:
        flux = lamp.flux * lamp.multiplier
        if width * length == 0:
            raise SceneError(
                f"Lamp “{luminaire.name}” is a beam without an opening; give it a width."
            )
    else:
        distribution = photometry.dimmed(_hung(luminaire, distribution, axes), lamp.multiplier)
        flux = photometry.luminous_flux(distribution)
    if not flux > 0:
        raise SceneError(
            f"Lamp “{luminaire.name}” has a multiplier of {lamp.multiplier:g} and sends no light; "
            "raise it or remove the lamp."
        )
    if shape == "round":
        length = length or width
    if width == length == 0:
        shape = "point"
    notes = distribution.notes if distribution else ()
    return Source(
        luminaire.name, distribution, shape, width, length, flux, axes, pose[:3, 3], notes
    )


def _hung(luminaire: Luminaire, read: Photometry, axes: NDArray[np.float64]) -> Photometry:
    """The distribution of a lamp that hangs as ``axes`` say, less its multiplier."""
    lamp = luminaire.lamp
    if not photometry.luminous_flux(read) > 0:
        raise SceneError(
            f"Lamp “{luminaire.name}” sends no light: the intensity in its photometric file is 0; "
            "choose another file."
        )
    if lamp.flux > 0:
        return photometry.scaled_to(read, lamp.flux)
    tilted = lamp_tilt(read.tilt, axes)
    factor = float(tilt_factor(read.tilt, tilted))
    if factor == 0:
        raise SceneError(
            f"Lamp “{luminaire.name}” sends no light: its photometric file has the tilt factor 0 "
            f"for {tilted:.0f}°; turn the lamp or choose another file."
        )
    return photometry.dimmed(read, factor)


def _emission(luminaire: Luminaire) -> tuple[Photometry | None, OpeningShape, float, float]:
    lamp = luminaire.lamp
    asked: OpeningShape = "rectangular" if lamp.opening == "rectangular" else "round"
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
