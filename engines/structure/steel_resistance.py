"""What steel sections resist: axial force, moments, shear and torsion, EN 1993-1-1 6.2."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.parameters import param
from ..core.scene import Vector
from .grade import Grade
from .sections import SHAPES, Sections
from .steel_class import Classes, compression_class, material_factor
from .steel_effective import effective_sections, shear_buckling


@dataclass(frozen=True, slots=True, kw_only=True)
class SteelRules:
    """What EN 1993-1-1 leaves to the country, the mill and the frame."""

    partial_section: float = param(1.0, "", 0.5, 2.0, "γM0: resistance of cross-sections, 6.1(1)")
    partial_member: float = param(1.0, "", 0.5, 2.0, "γM1: resistance to instability, 6.1(1)")
    hollow: Literal["hot-finished", "cold-formed", "welded"] = param(
        "hot-finished", help="How hollow sections are made: buckling curve a, c or b, Table 6.2"
    )
    sway: bool = param(
        False, help="Members buckle by sway: moment factors of 0.9, whatever the diagram, Table B.3"
    )


@dataclass(frozen=True, slots=True)
class Resistance:
    """Design resistances of M sections, each (M,) in N or N·m.

    ``axial`` of the gross section, ``compression`` of what local buckling leaves of it;
    ``plastic_*``, ``elastic_*`` and ``effective_*``: moments of classes 1 and 2, 3, and 4;
    ``shear_y``, ``shear_z`` and ``torsion`` with shear buckling. ``area_y`` and ``area_z``: the
    shares of the area that carry shear along y and z; ``web_y`` and ``web_z``: the shares of the
    plastic moments about y and z that those areas carry. ``even``: class in pure compression.
    """

    axial: Vector
    compression: Vector
    plastic_y: Vector
    plastic_z: Vector
    elastic_y: Vector
    elastic_z: Vector
    effective_y: Vector
    effective_z: Vector
    shear_y: Vector
    shear_z: Vector
    torsion: Vector
    area_y: Vector
    area_z: Vector
    web_y: Vector
    web_z: Vector
    even: Classes


def resistance_of(sections: Sections, grade: Grade, partial: float) -> Resistance:
    """Design resistances of each section, with ``partial`` γ_M0.

    Torsion is Saint-Venant's: for an I section that leaves out warping, on the safe side.
    """
    strength = grade.yield_strength / partial
    even = compression_class(sections, grade)
    effective = effective_sections(sections, grade)
    area_y, area_z = shear_areas(sections)
    factor_y, factor_z = _shear_buckling(sections, grade)
    stress = strength / np.sqrt(3.0)
    web_y, web_z = _web_shares(sections, area_y, area_z)
    return Resistance(
        axial=sections.area * strength,
        compression=np.where(even == 4, effective.area, sections.area) * strength,
        plastic_y=sections.plastic_y * strength,
        plastic_z=sections.plastic_z * strength,
        elastic_y=sections.elastic_y * strength,
        elastic_z=sections.elastic_z * strength,
        effective_y=effective.modulus_y * strength,
        effective_z=effective.modulus_z * strength,
        shear_y=area_y * factor_y * stress,
        shear_z=area_z * factor_z * stress,
        torsion=sections.torsion_modulus * np.minimum(factor_y, factor_z) * stress,
        area_y=area_y / sections.area,
        area_z=area_z / sections.area,
        web_y=web_y,
        web_z=web_z,
        even=even,
    )


def shear_areas(sections: Sections) -> tuple[Vector, Vector]:
    """A_v (M,) in m² for shear along y and along z, EN 1993-1-1 6.2.6(3), η = 1.

    Rolled I sections a) and, along y, the flanges; hollow ones f) and g). Solid ones 2A/3: the
    greatest elastic stress, since 6.2.6 has no plastic area for them.
    """
    h, b, area = sections.height, sections.width, sections.area
    web, flange, root = sections.web, sections.flange, sections.radius
    clear = np.maximum(h - 2 * flange, 0.0)
    along_z = area - 2 * b * flange + (web + 2 * root) * flange
    kinds = [sections.shape == SHAPES.index(shape) for shape in ("rhs", "chs", "i")]
    return (
        np.select(kinds, [area * b / (b + h), 2 * area / np.pi, area - clear * web], area / 1.5),
        np.select(
            kinds,
            [area * h / (b + h), 2 * area / np.pi, np.maximum(along_z, clear * web)],
            area / 1.5,
        ),
    )


def _shear_buckling(sections: Sections, grade: Grade) -> tuple[Vector, Vector]:
    """χ_w of the walls that carry shear along y and along z."""
    factor = material_factor(grade)
    hollow = sections.shape == SHAPES.index("rhs")
    walled = hollow | (sections.shape == SHAPES.index("i"))
    with np.errstate(divide="ignore", invalid="ignore"):
        web = (sections.height - 2 * sections.flange) / sections.web / factor
        flange = (sections.width - 2 * sections.web) / sections.flange / factor
    return (
        shear_buckling(np.where(hollow, flange, 0.0)),
        shear_buckling(np.where(walled, web, 0.0)),
    )


def _web_shares(sections: Sections, area_y: Vector, area_z: Vector) -> tuple[Vector, Vector]:
    """How much of the plastic moments the walls carry that also carry shear, 6.2.8.

    A²/(4 Σt W_pl), equation 6.30, where there are walls: A is the clear web of an I section, A_v
    otherwise. All of it in tubes and solid sections.
    """
    hollow = sections.shape == SHAPES.index("rhs")
    rolled = sections.shape == SHAPES.index("i")
    clear = (sections.height - 2 * sections.flange) * sections.web
    webs = np.where(rolled, clear, area_z) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        webs /= np.where(rolled, 4.0, 8.0) * sections.web * sections.plastic_y
        flanges = area_y**2 / (8 * sections.flange * sections.plastic_z)
    walled = hollow | rolled
    return (
        np.where(walled, np.minimum(webs, 1.0), 1.0),
        np.where(walled, np.minimum(flanges, 1.0), 1.0),
    )
