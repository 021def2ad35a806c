"""Axial force, bending and shear together on steel cross-sections, EN 1993-1-1 6.2.8 to 6.2.10."""

import numpy as np

from ..core.scene import Vector
from .sections import SHAPES, Sections
from .steel_class import Classes
from .steel_demand import Forces
from .steel_resistance import Resistance

_LEAST = 0.01  # of what shear leaves of a resistance
_STEPS = 6


def combined(
    forces: Forces,
    resistance: Resistance,
    sections: Sections,
    classes: Classes,
    loss_y: Vector | None,
    loss_z: Vector | None,
) -> Vector:
    """What axial force and moments use of each cross-section (K, S, M).

    ``classes`` (K, S, M); ``loss_y`` and ``loss_z`` (K, S, M) or None: ρ of the walls that carry
    shear along y and z.
    """
    n = np.abs(forces.axial)
    n /= resistance.axial
    y = np.abs(forces.moment_y)
    y /= resistance.plastic_y
    z = np.abs(forces.moment_z)
    z /= resistance.plastic_z
    if loss_y is not None or loss_z is not None:
        lost_y = 0.0 if loss_y is None else loss_y
        lost_z = 0.0 if loss_z is None else loss_z
        taken = lost_y * resistance.area_y + lost_z * resistance.area_z
        n /= np.maximum(1.0 - taken, _LEAST)
        web_y, web_z = resistance.web_y, resistance.web_z
        y /= np.maximum(1.0 - lost_z * web_y - lost_y * (1.0 - web_y), _LEAST)
        z /= np.maximum(1.0 - lost_y * web_z - lost_z * (1.0 - web_z), _LEAST)
    elastic = classes > 2
    if elastic.all():
        return _elastic(n, y, z, forces, resistance, classes)
    used = _plastic(n, y, z, sections)
    if elastic.any():
        np.copyto(used, _elastic(n, y, z, forces, resistance, classes), where=elastic)
    return used


def _elastic(
    n: Vector, y: Vector, z: Vector, forces: Forces, resistance: Resistance, classes: Classes
) -> Vector:
    """6.2.9.2 and 6.2.9.3: stresses added up, those of class 4 on the effective section."""
    y_factor = resistance.plastic_y / resistance.elastic_y
    z_factor = resistance.plastic_z / resistance.elastic_z
    slender = classes == 4
    if not slender.any():
        return n + y * y_factor + z * z_factor
    pressed = slender & (forces.axial < 0.0)
    return (
        n * np.where(pressed, resistance.axial / resistance.compression, 1.0)
        + y * np.where(slender, resistance.plastic_y / resistance.effective_y, y_factor)
        + z * np.where(slender, resistance.plastic_z / resistance.effective_z, z_factor)
    )


def _plastic(n: Vector, y: Vector, z: Vector, sections: Sections) -> Vector:
    """6.2.9.1: plastic interaction by shape."""
    kinds = {"rhs": _hollow, "chs": _tube, "i": _rolled, "rectangle": _solid}
    first = sections.shape[0] if len(sections) else 0
    if (sections.shape == first).all():
        return kinds[SHAPES[first]](n, y, z, sections)
    used = np.empty_like(n)
    for number in np.unique(sections.shape):
        members = np.flatnonzero(sections.shape == number)
        used[..., members] = kinds[SHAPES[number]](
            n[..., members], y[..., members], z[..., members], sections.take(members)
        )
    return used


def _hollow(n: Vector, y: Vector, z: Vector, part: Sections) -> Vector:
    """Equations 6.39 to 6.41, times 1 − n: so they neither divide by nothing nor jump."""
    share_y = np.minimum(1.0 - 2.0 * part.width * part.flange / part.area, 0.5)
    share_z = np.minimum(1.0 - 2.0 * part.height * part.web / part.area, 0.5)
    left = np.maximum(1.0 - n, 0.0)
    y = y * np.maximum(left, 1.0 - 0.5 * share_y)
    z = z * np.maximum(left, 1.0 - 0.5 * share_z)
    power = 1.66 / (1.0 - 1.13 * np.minimum(n, 0.8) ** 2)
    np.minimum(power, 6.0, out=power)
    large, small = np.maximum(y, z), np.minimum(y, z)
    ratio = small / np.maximum(large, 1e-300)
    # Below 1e-3 the smaller moment adds less than 1e-5 of the larger.
    both = ratio > 1e-3
    if both.any():
        ratio[both] = (1.0 + ratio[both] ** power[both]) ** (1.0 / power[both])
        np.multiply(large, ratio, out=large, where=both)
    large += n
    return large


def _tube(n: Vector, y: Vector, z: Vector, part: Sections) -> Vector:
    """M_N = M_pl (1 − n^1.7), of the resultant moment (EN 1993-1-1:2022 8.2.9.1)."""
    return _exceeded(np.hypot(y, z), np.ones_like(n), n, np.full_like(n, 1.7))


def _rolled(n: Vector, y: Vector, z: Vector, part: Sections) -> Vector:
    """Equations 6.36 to 6.38 and 6.41, times 1 − n."""
    share = np.minimum(1.0 - 2.0 * part.width * part.flange / part.area, 0.5)
    left = np.maximum(1.0 - n, 1e-9)
    y = y * np.maximum(left, 1.0 - 0.5 * share)
    over = np.maximum((np.minimum(n, 1.0 - 1e-9) - share) / (1.0 - share), 0.0)
    z = z * left / (1.0 - over**2)
    return n + _exceeded(y, np.full_like(n, 2.0), z, np.clip(5.0 * n, 1.0, 5.0))


def _solid(n: Vector, y: Vector, z: Vector, part: Sections) -> Vector:
    """Equation 6.32, and moments about y and z added up."""
    bent = y + z
    return (bent + np.sqrt(bent**2 + 4.0 * n**2)) / 2.0


def _exceeded(x: Vector, a: Vector, y: Vector, b: Vector) -> Vector:
    """The u for which (x/u)^a + (y/u)^b = 1, of the shape of x; x, y ≥ 0 and a, b ≥ 1.

    Newton's method for 1/u: the sum is convex in it, so one step from below leads above and the
    others down to it.
    """
    scale = np.maximum(np.maximum(x, y), 1e-12)
    x, y = np.maximum(x / scale, 1e-9), np.maximum(y / scale, 1e-9)
    inverse = 1.0 / (x + y)
    for _ in range(_STEPS):
        first, second = (x * inverse) ** a, (y * inverse) ** b
        inverse = inverse * (1.0 - (first + second - 1.0) / (a * first + b * second))
    return scale / inverse
