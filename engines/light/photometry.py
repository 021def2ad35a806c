"""Luminous intensity distributions: what they say, and those made in code.

Type C coordinates: γ counts from the nadir (the lamp's −Z) to the zenith, C turns about the
vertical axis.
"""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.errors import ParameterError
from .opening import OpeningShape
from .tilt import Tilt

Angles = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Photometry:
    """How much light a luminaire sends where, and the opening that it leaves from.

    ``vertical`` (V,) float64 is γ in degrees, ascending within 0..180; no light leaves outside its
    range. ``horizontal`` (H,) float64 is C in degrees, ascending from 0 to 360 whatever symmetry
    the file made use of; ``intensity`` (H, V) float64 is in cd, its last plane equal to its first.
    Between the nodes it is bilinear.

    ``flux`` is in lm: what the file states for its lamps, or, where it states nothing (absolute
    photometry), what the intensity adds up to. `luminous_flux` is what leaves the luminaire.

    ``width`` (along C90–C270), ``length`` (along C0–C180) and ``height`` are those of the opening
    in m. A round opening of unequal width and length is an ellipse; a line is a rectangle with one
    side of 0. ``keywords`` maps the file's keywords to their text, the lines of one joined by a
    line break; ``watts`` is the input power in W.

    ``tilt`` says how the light falls when the luminaire is tilted; ``intensity`` and ``flux`` are
    without it. ``notes`` are sentences on what the file says otherwise than it is taken here.
    """

    vertical: Angles
    horizontal: Angles
    intensity: NDArray[np.float64]
    flux: float
    opening: OpeningShape = "point"
    width: float = 0.0
    length: float = 0.0
    height: float = 0.0
    name: str = ""
    keywords: dict[str, str] = field(default_factory=dict)
    watts: float = 0.0
    tilt: Tilt | None = None
    notes: tuple[str, ...] = ()


# What a distribution says


def intensity_at(
    photometry: Photometry, gamma_deg: ArrayLike, c_deg: ArrayLike
) -> NDArray[np.float64]:
    """Luminous intensity in cd toward γ and C in degrees, arrays that broadcast together.

    Bilinear between the nodes; 0 where γ is outside the measured range. C may be any angle.
    """
    gamma, c = np.broadcast_arrays(np.asarray(gamma_deg, float), np.mod(c_deg, 360.0))
    light = bilinear(photometry.horizontal, photometry.vertical, photometry.intensity, c, gamma)
    measured = (gamma >= photometry.vertical[0]) & (gamma <= photometry.vertical[-1])
    return np.where(measured, light, 0.0)


def luminous_flux(photometry: Photometry) -> float:
    """Luminous flux in lm that leaves the luminaire: the bilinear intensity's exact integral."""
    planes = np.radians(photometry.horizontal)
    a, b = np.radians(photometry.vertical[:-1]), np.radians(photometry.vertical[1:])
    start, end = photometry.intensity[:, :-1], photometry.intensity[:, 1:]
    slope = (end - start) / (b - a)
    strips = start * np.cos(a) - end * np.cos(b) + slope * (np.sin(b) - np.sin(a))
    return float(np.trapezoid(strips.sum(axis=1), planes))


def beam_angle(photometry: Photometry, c_deg: float = 0.0) -> float:
    """Full angle in degrees between the 50 % directions in the plane C–C+180 of a downlight.

    The outermost directions, on both sides of the nadir, in which the intensity is half of the
    distribution's maximum [ANSI/IES LS-1].
    """
    return _full_angle(photometry, 0.5, c_deg)


def field_angle(photometry: Photometry, c_deg: float = 0.0) -> float:
    """As `beam_angle`, for the directions of 10 % of the maximum intensity."""
    return _full_angle(photometry, 0.1, c_deg)


def _full_angle(photometry: Photometry, share: float, c_deg: float) -> float:
    limit = share * photometry.intensity.max()
    angle = 0.0
    for plane in (c_deg, c_deg + 180.0):
        gamma = photometry.vertical
        profile = intensity_at(photometry, gamma, plane)
        bright = np.flatnonzero((profile >= limit) & (profile > 0))
        if not bright.size:
            continue
        k = bright[-1]
        angle += float(gamma[k])
        if k + 1 < len(gamma):
            fall = (profile[k] - limit) / (profile[k] - profile[k + 1])
            angle += float(fall * (gamma[k + 1] - gamma[k]))
    return angle


def bilinear(
    rows: Angles,
    columns: Angles,
    table: NDArray[np.float64],
    row: NDArray[np.float64],
    column: NDArray[np.float64],
) -> NDArray[np.float64]:
    """``table`` (R, C) between its nodes ``rows`` (R,) and ``columns`` (C,), two at least of each.

    ``row`` and ``column`` are arrays of one shape; beyond the nodes the last slope goes on.
    """
    i, u = _locate(columns, column)
    j, t = _locate(rows, row)
    near = (1 - u) * table[j, i] + u * table[j, i + 1]
    far = (1 - u) * table[j + 1, i] + u * table[j + 1, i + 1]
    return (1 - t) * near + t * far


def _locate(nodes: Angles, at: NDArray[np.float64]) -> tuple[NDArray[np.intp], Angles]:
    """The interval of ``nodes`` that holds each of ``at``, and how far along it lies."""
    i = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(nodes) - 2)
    return i, (at - nodes[i]) / (nodes[i + 1] - nodes[i])


# Distributions made in code


def isotropic(flux: float) -> Photometry:
    """A point that sends ``flux`` lm evenly in all directions: Φ / 4π cd."""
    return _axial(flux, np.linspace(0.0, 180.0, 721), lambda gamma: np.ones_like(gamma) / 4)


def lambertian(flux: float) -> Photometry:
    """A point that sends ``flux`` lm downward by the cosine law: Φ cos γ / π cd at the nodes."""
    return _axial(flux, np.linspace(0.0, 90.0, 361), lambda gamma: np.sin(np.radians(90 - gamma)))


def scaled_to(photometry: Photometry, flux: float) -> Photometry:
    """The same distribution with ``flux`` lm leaving the luminaire; `luminous_flux` agrees.

    Raises ParameterError when ``flux`` is not positive or the distribution is dark.
    """
    _check_flux(flux)
    present = luminous_flux(photometry)
    if not present > 0:
        raise ParameterError(
            f"The distribution “{photometry.name}” is dark and cannot be scaled to {flux:g} lm; "
            "take another photometric file."
        )
    intensity = photometry.intensity * (flux / present)
    return dataclasses.replace(photometry, intensity=intensity, flux=float(flux))


def dimmed(photometry: Photometry, factor: float) -> Photometry:
    """The same distribution with ``factor`` times the light, and the flux stated for it."""
    return dataclasses.replace(
        photometry, intensity=photometry.intensity * factor, flux=photometry.flux * factor
    )


def _axial(flux: float, vertical: Angles, shape: Callable[[Angles], Angles]) -> Photometry:
    _check_flux(flux)
    plane = flux / np.pi * shape(vertical)
    return Photometry(vertical, np.array([0.0, 360.0]), np.stack([plane, plane]), float(flux))


def _check_flux(flux: float) -> None:
    if not (np.isfinite(flux) and flux > 0):
        raise ParameterError(f"A luminous flux of {flux:g} lm cannot be; give one above 0 lm.")
