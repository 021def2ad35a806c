"""Effective sections of class 4, EN 1993-1-5 section 4, and shear buckling, section 5."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..core.scene import Vector
from .grade import Grade
from .sections import SHAPES, Sections
from .steel_class import flat_walls, internal_limits, material_factor, slenderness_of_walls

_EVEN_INTERNAL, _EVEN_OUTSTAND = 42.0, 14.0  # the limits of class 3, in c/(tε)


@dataclass(frozen=True, slots=True)
class Effective:
    """What local buckling leaves of M sections: ``area`` in m², moduli in m³, each (M,)."""

    area: Vector
    modulus_y: Vector
    modulus_z: Vector


def buckling_coefficient(psi: ArrayLike) -> Vector:
    """k_σ of a wall held at both edges, EN 1993-1-5 Table 4.1, ψ from −3 to 1."""
    psi = np.clip(psi, -3.0, 1.0)
    return np.where(
        psi >= 0.0,
        8.2 / (1.05 + np.maximum(psi, 0.0)),
        np.where(psi >= -1.0, 7.81 - 6.29 * psi + 9.78 * psi**2, 5.98 * (1.0 - psi) ** 2),
    )


def internal_reduction(slenderness: ArrayLike, psi: ArrayLike) -> Vector:
    """ρ of a wall held at both edges with c/(tε) as given, EN 1993-1-5 equation 4.2."""
    plate = np.asarray(slenderness) / (28.4 * np.sqrt(buckling_coefficient(psi)))
    psi = np.clip(psi, -3.0, 1.0)
    limit = 0.5 + np.sqrt(0.085 - 0.055 * psi)
    plate = np.maximum(plate, limit)
    return np.minimum((plate - 0.055 * (3.0 + psi)) / plate**2, 1.0)


def outstand_reduction(slenderness: ArrayLike, coefficient: float = 0.43) -> Vector:
    """ρ of an outstand with c/(tε) as given, EN 1993-1-5 equation 4.3; k_σ is 0.43 if even."""
    plate = np.maximum(np.asarray(slenderness) / (28.4 * np.sqrt(coefficient)), 0.748)
    return np.minimum((plate - 0.188) / plate**2, 1.0)


def effective_sections(sections: Sections, grade: Grade) -> Effective:
    """A_eff in pure compression and W_eff in bending about y and about z alone.

    EN 1993-1-5 4.4. Only walls beyond class 3 are reduced. In bending the stress ratio of the web
    is that of the gross web with the reduced flange, 4.4(3). Both axes are of symmetry, so the
    centroid stays in compression: e_N = 0. Shear lag (3.1) is left out: flanges are narrow.
    Gross values where nothing is reduced, for tubes and for solid sections.
    """
    area = sections.area.copy()
    modulus_y, modulus_z = sections.elastic_y.copy(), sections.elastic_z.copy()
    web, flange = slenderness_of_walls(sections, grade)
    rolled = sections.shape == SHAPES.index("i")
    slender = (web > _EVEN_INTERNAL) | (flange > np.where(rolled, _EVEN_OUTSTAND, _EVEN_INTERNAL))
    for members, reduced in ((slender & ~rolled, _hollow), (slender & rolled, _rolled)):
        if members.any():
            area[members], modulus_y[members], modulus_z[members] = reduced(
                sections.take(members), web[members], flange[members], material_factor(grade)
            )
    return Effective(area, modulus_y, modulus_z)


def shear_buckling(slenderness: ArrayLike) -> Vector:
    """χ_w of an unstiffened web with h_w/(tε) as given, EN 1993-1-5 Table 5.1, η = 1.

    Stiffeners at supports only, end posts that are not rigid.
    """
    plate = np.asarray(slenderness) / 86.4
    return 0.83 / np.maximum(plate, 0.83)


def _hollow(
    part: Sections, web: Vector, flange: Vector, factor: float
) -> tuple[Vector, Vector, Vector]:
    flat_web, flat_flange = flat_walls(part)
    gone = 2 * part.web * flat_web * (1 - _even(web)) + 2 * part.flange * flat_flange * (
        1 - _even(flange)
    )
    return (
        part.area - gone,
        _bent(
            *(part.height, part.area, part.inertia_y, flat_web, part.web, 2.0),
            *((1 - _even(flange)) * flat_flange * part.flange, part.flange, factor),
        ),
        _bent(
            *(part.width, part.area, part.inertia_z, flat_flange, part.flange, 2.0),
            *((1 - _even(web)) * flat_web * part.web, part.web, factor),
        ),
    )


def _rolled(
    part: Sections, web: Vector, flange: Vector, factor: float
) -> tuple[Vector, Vector, Vector]:
    flat_web, outstand = flat_walls(part)
    tip = np.where(flange > _EVEN_OUTSTAND, 1 - outstand_reduction(flange), 0.0) * outstand
    lost = 2 * tip * part.flange  # of one flange, both tips
    modulus_y = _bent(
        *(part.height, part.area, part.inertia_y, flat_web, part.web, 1.0),
        *(lost, part.flange, factor),
    )
    # About z the tips of one side are compressed, as much as if they were so evenly.
    place = (part.width - tip) / 2
    left = part.area - lost
    shift = lost * place / left
    inertia = part.inertia_z - lost * (place**2 + tip**2 / 12) - left * shift**2
    modulus_z = inertia / (part.width / 2 + shift)
    area = part.area - 2 * lost - part.web * flat_web * (1 - _even(web))
    return area, modulus_y, modulus_z


def _even(slenderness: Vector) -> Vector:
    """ρ of an internal wall compressed evenly, 1 up to class 3."""
    return np.where(slenderness > _EVEN_INTERNAL, internal_reduction(slenderness, 1.0), 1.0)


def _bent(
    depth: Vector,
    area: Vector,
    inertia: Vector,
    flat: Vector,
    thickness: Vector,
    webs: float,
    lost: Vector,
    flange: Vector,
    factor: float,
) -> Vector:
    """W_eff (M,) of sections of which ``lost`` m² of the compressed flange do not count.

    ``flat`` and ``thickness`` of each of the ``webs``, ``flange`` the flange's thickness.
    """
    place = (depth - flange) / 2
    left = area - lost
    centroid = -lost * place / left
    compressed = flat / 2 - centroid
    psi = -(flat / 2 + centroid) / compressed
    slenderness = flat / thickness / factor
    _, _, limit = internal_limits(1.0, psi)
    reduction = np.where(slenderness > limit, internal_reduction(slenderness, psi), 1.0)
    # 0.4 of what counts is at the flange, the rest at the neutral axis: a gap lies between.
    gap = (1 - reduction) * compressed
    middle = flat / 2 - 0.4 * reduction * compressed - gap / 2
    hole = webs * thickness * gap
    left = left - hole
    centroid = -(lost * place + hole * middle) / left
    counted = inertia - lost * (place**2 + flange**2 / 12) - hole * (middle**2 + gap**2 / 12)
    return (counted - left * centroid**2) / (depth / 2 - centroid)
