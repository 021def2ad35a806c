"""Glazing of which the transmittance is known: how deep its tint is.

At normal incidence a plane-parallel pane of internal transmittance a lets
T = a (1 − R)² ÷ (1 − a² R²) through, R by Fresnel's equations [Born & Wolf, 1.6]. Solved for a it
gives the tint that a pane needs to let T through, as Radiance's “glass” does; −ln a is its optical
depth.
"""

import math
from dataclasses import replace

import numpy as np

from .scene import Body, Material, Mesh

_DARK = 1e-30
"""The least internal transmittance: single precision still has its square."""
_FLAT = 0.5
"""From which share of its faces looking one way on a solid is taken as a plate."""


def goes_by_transmittance(material: Material) -> bool:
    """Whether a material is glass of a given transmittance, rather than of a given absorption."""
    return material.kind == "dielectric" and material.transmittance < 1


def highest_transmittance(ior: float) -> float:
    """What a clear pane of that index lets through at normal incidence."""
    return 2 * ior / (ior**2 + 1)


def normal_depth(material: Material) -> float:
    """The optical depth, straight across, of a pane that lets its ``transmittance`` through.

    0 where even clear glass of its index lets no more through.
    """
    lost = ((material.ior - 1) / (material.ior + 1)) ** 2
    wanted, through = material.transmittance, (1 - lost) ** 2
    internal = 2 * wanted / (through + math.sqrt(through**2 + (2 * wanted * lost) ** 2))
    return -math.log(min(max(internal, _DARK), 1.0))


def by_absorption(body: Body) -> Body:
    """The body with the absorption that gives glass of its thickness its transmittance."""
    material = body.material
    if not goes_by_transmittance(material):
        return body
    depth, through = normal_depth(material), thickness(body.mesh)
    absorption = depth / through if through > 0 else 0.0
    return replace(body, material=replace(material, absorption=absorption, transmittance=1.0))


def thickness(mesh: Mesh) -> float:
    """How thick a closed solid is in m: exact for a plate, the mean for a bent one; 0 if hollow.

    A plate's volume is over what it shows from the front, any other solid's over half its surface.
    """
    corners = mesh.triangles().vertices[mesh.triangles().faces]
    a, b, c = (corners[:, k] - corners[:, 0].mean(axis=0) for k in range(3))
    areas = np.cross(b - a, c - a) / 2
    sizes = np.linalg.norm(areas, axis=1)
    volume = abs(np.einsum("ij,ij->", a, np.cross(b, c))) / 6
    units = np.divide(areas, sizes[:, None], out=np.zeros_like(areas), where=sizes[:, None] > 0)
    spread, ways = np.linalg.eigh(np.einsum("i,ij,ik->jk", sizes, units, units))
    shown = sizes.sum() / 2
    if spread[-1] > _FLAT * spread.sum():
        shown = np.abs(areas @ ways[:, -1]).sum() / 2
    return float(volume / shown) if shown > 0 else 0.0
