"""Classes of steel cross-sections under their axial force and moments, EN 1993-1-1 Table 5.2."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.scene import Vector
from .grade import Grade
from .sections import SHAPES, Sections

Classes = NDArray[np.int8]
_NOTHING = 1e-6  # moments below this share of yielding are none


def material_factor(grade: Grade) -> float:
    """ε = √(235 MPa/f_y)."""
    return float(np.sqrt(235e6 / grade.yield_strength))


def flat_walls(sections: Sections) -> tuple[Vector, Vector]:
    """The flat widths c (M,) in m of web and flange between their roots or corners.

    Of an I section the flange's is that of one outstand; 0 where there are no walls.
    """
    i = sections.shape == SHAPES.index("i")
    corner = np.maximum(sections.radius, sections.flange)
    web = np.where(
        i,
        sections.height - 2 * sections.flange - 2 * sections.radius,
        sections.height - 2 * corner,
    )
    flange = np.where(
        i,
        (sections.width - sections.web) / 2 - sections.radius,
        sections.width - 2 * np.maximum(sections.radius, sections.web),
    )
    walled = i | (sections.shape == SHAPES.index("rhs"))
    return np.where(walled, web, 0.0), np.where(walled, flange, 0.0)


def slenderness_of_walls(sections: Sections, grade: Grade) -> tuple[Vector, Vector]:
    """c/(tε) of web and flange (M,), 0 where there are no walls."""
    web, flange = flat_walls(sections)
    factor = material_factor(grade)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = web / sections.web / factor, flange / sections.flange / factor
    walled = web > 0
    return np.where(walled, ratios[0], 0.0), np.where(walled, ratios[1], 0.0)


def internal_limits(alpha: ArrayLike, psi: ArrayLike) -> tuple[Vector, Vector, Vector]:
    """The greatest c/(tε) of classes 1, 2 and 3 of a wall held at both edges.

    ``alpha``: the share of the wall in compression when it is plastic; ``psi``: the stress at one
    edge over that at the other, more compressed, when it is elastic.
    """
    alpha = np.clip(alpha, 1e-3, 1.0)
    psi = np.asarray(psi, dtype=np.float64)
    mostly = alpha > 0.5
    part = 1.0 / np.where(mostly, 13.0 * alpha - 1.0, alpha)
    pulled = np.minimum(psi, -1.0)
    third = np.where(
        psi > -1.0,
        42.0 / (0.67 + 0.33 * np.maximum(psi, -1.0)),
        62.0 * (1.0 - pulled) * np.sqrt(-pulled),
    )
    return np.where(mostly, 396.0, 36.0) * part, np.where(mostly, 456.0, 41.5) * part, third


def outstand_class(slenderness: Vector) -> Classes:
    """The class of outstand flanges with c/(tε) as given, compressed evenly: 9, 10 and 14."""
    return _class_by(slenderness, 9.0, 10.0, 14.0)


def compression_class(sections: Sections, grade: Grade) -> Classes:
    """The class (M,) of each section in pure compression."""
    web, flange = slenderness_of_walls(sections, grade)
    found = _class_by(web, 33.0, 38.0, 42.0)
    i = sections.shape == SHAPES.index("i")
    flanges = np.where(i, outstand_class(flange), _class_by(flange, 33.0, 38.0, 42.0))
    return np.where(
        sections.shape == SHAPES.index("chs"),
        _tube_class(sections, grade),
        np.maximum(found, flanges),
    )


def section_class(
    axial: Vector, moment_y: Vector, moment_z: Vector, sections: Sections, grade: Grade
) -> Classes:
    """The class of each section under each set of forces, of their shape (…, M).

    ``axial`` in N, positive in tension; moments in N·m, of either sign. The axial force is what it
    is and the moments grow in proportion until the section yields, fully for classes 1 and 2, at
    its edge for class 3: with one moment that is α = (1 + N/(c t f_y))/2 and ψ = 2N/(A f_y) − 1, as
    the tables of SCI P363 have it; tension helps no wall. Walls are judged where they are most
    compressed: those of a hollow section also by the other moment, outstand flanges as if
    compressed evenly. Where the axial force stresses a section more than the moments do, its class
    is no better than in pure compression; where nothing is compressed, it is 1. Solid sections are
    of class 1.
    """
    force = sections.area * grade.yield_strength
    n = np.minimum(axial / -force, 1.0)
    bent_y = np.abs(moment_y) / (sections.elastic_y * grade.yield_strength)
    bent_z = np.abs(moment_z) / (sections.elastic_z * grade.yield_strength)
    bent = bent_y + bent_z
    even = compression_class(sections, grade)
    found = np.ones(n.shape, dtype=np.int8)
    for shape, judged in (("rhs", _hollow_class), ("i", _rolled_class)):
        # What is of class 1 in pure compression always is.
        members = np.flatnonzero((sections.shape == SHAPES.index(shape)) & (even > 1))
        if members.size:
            some = np.maximum(n[..., members], 0.0), bent_y[..., members], bent_z[..., members]
            found[..., members] = judged(*some, sections.take(members), grade)
    tubes = sections.shape == SHAPES.index("chs")
    found[..., tubes] = even[tubes]
    np.copyto(found, np.maximum(found, even), where=n > bent)
    found[n + bent <= 0.0] = 1
    return found


def member_class(
    classes: Classes, axial: Vector, moment_y: Vector, moment_z: Vector, sections: Sections
) -> Classes:
    """The class (K, M) of whole members: that of their most stressed cross-section.

    ``classes`` (K, S, M) as `section_class` has them, for the same forces (Boissonnade et al. 2006,
    Rules for member stability in EN 1993-1-1, ECCS 119).
    """
    stress = np.abs(axial) / sections.area
    stress += np.abs(moment_y) / sections.elastic_y
    stress += np.abs(moment_z) / sections.elastic_z
    worst = stress.argmax(axis=1)[:, None]
    return np.take_along_axis(classes, worst, axis=1)[:, 0]


def _hollow_class(
    n: Vector, bent_y: Vector, bent_z: Vector, part: Sections, grade: Grade
) -> Classes:
    web, flange = flat_walls(part)
    web_ratio, flange_ratio = slenderness_of_walls(part, grade)
    # The moments over the plastic ones, grown until the section is plastic. On a circle, that is
    # later than by 6.2.9.1(6) with its exponent of 1.66 and what the axial force takes: safe.
    y, z = bent_y * (part.elastic_y / part.plastic_y), bent_z * (part.elastic_z / part.plastic_z)
    size = np.sqrt(y**2 + z**2)
    none = size < _NOTHING
    size[none] = 1.0
    y /= size
    z /= size
    share = bent_y / np.maximum(bent_y + bent_z, 1e-300)
    share_z = 1.0 - share
    share[none] = share_z[none] = 0.0
    y[none] = z[none] = np.inf
    web, flange = np.maximum(web * part.web, 1e-12), np.maximum(flange * part.flange, 1e-12)
    z *= part.plastic_z / (web * (part.width - part.web))
    y *= part.plastic_y / (flange * (part.height - part.flange))
    return np.maximum(
        _wall_class(web_ratio, n, part.area / (2.0 * web), z, share),
        _wall_class(flange_ratio, n, part.area / (2.0 * flange), y, share_z),
    )


def _wall_class(
    slenderness: Vector, n: Vector, weight: Vector, pressed: Vector, share: Vector
) -> Classes:
    """The class of one of a hollow section's walls (…, M).

    ``weight``: the section's area over that of the two walls; ``pressed``: what share of the
    plastic wall the other moment compresses, infinite where nothing bends; ``share``: of the
    moments, the one that this wall is the web for.
    """
    if (slenderness <= 33.0).all():
        return np.ones(n.shape, dtype=np.int8)
    alpha = 0.5 * (1.0 + n * weight + pressed)
    psi = 1.0 - 2.0 * share * (1.0 - n)
    return _class_by(slenderness, *internal_limits(alpha, psi))


def _rolled_class(
    n: Vector, bent_y: Vector, bent_z: Vector, part: Sections, grade: Grade
) -> Classes:
    web, _ = flat_walls(part)
    web_ratio, flange_ratio = slenderness_of_walls(part, grade)
    bent = bent_y + bent_z
    share = np.where(bent < _NOTHING, 0.0, bent_y / np.maximum(bent, 1e-300))
    high = share * (1.0 - n)
    edge = n + high
    compressed = edge > 1e-9
    edge = np.where(compressed, edge, 1.0)
    psi = np.where(compressed, (n - high) / edge, -1e3)
    plastic = 0.5 * (1.0 + n * (part.area / (part.web * web)))
    # Bent about z too, the web cannot have more in tension than it has while it is elastic.
    elastic = 1.0 / np.maximum(1.0 - psi, 1.0)
    alpha = np.where(compressed, np.maximum(plastic, elastic), 0.0)
    return np.maximum(
        _class_by(web_ratio, *internal_limits(alpha, psi)), outstand_class(flange_ratio)
    )


def _tube_class(sections: Sections, grade: Grade) -> Classes:
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = sections.height / sections.web / material_factor(grade) ** 2
    return _class_by(ratio, 50.0, 70.0, 90.0)


def _class_by(
    ratio: Vector, first: Vector | float, second: Vector | float, third: Vector | float
) -> Classes:
    found = (ratio > first).astype(np.int8)
    beyond = ratio > second
    found += beyond
    found += beyond & (ratio > third)
    return found + np.int8(1)
