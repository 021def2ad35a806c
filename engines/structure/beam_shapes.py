"""How a member moves between its ends: shape functions of a Timoshenko beam and their integrals.

Where no load acts between the ends they are exact [Friedman and Kosmatka 1993].
"""

import numpy as np

from ..core.scene import Vector
from .frame import Rigidities

PLANES = ((1, 5, 7, 11, 1.0), (2, 4, 8, 10, -1.0))
"""The end freedoms that bend a member, along y and along z: deflection and rotation at the start,
the same at the end, and the sign of the rotation that follows a rising deflection."""

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_STATIONS, _WEIGHTS = (_POINTS + 1) / 2, _WEIGHTS / 2


def shear_ratio(bending: Vector, shear: Vector, lengths: Vector) -> Vector:
    """φ = 12 EI / (GA_s L²) of each member, 0 where shear does not give way."""
    return 12 * bending / (shear * lengths**2)


def bending_shapes(
    ratio: Vector, lengths: Vector, stations: Vector
) -> tuple[Vector, Vector, Vector]:
    """Deflection, its slope and the section's rotation by the end freedoms, each (M, S, 4).

    ``ratio`` φ and ``lengths`` in m, (M,); ``stations`` (S,) in 0..1. The freedoms are deflection
    and rotation at the start and at the end, the rotation positive where the deflection rises.
    """
    t = stations
    bow, wave = t * (1 - t), t * (1 - t) * (1 - 2 * t)
    bow_slope, wave_slope = 1 - 2 * t, 1 - 6 * t + 6 * t**2
    length, stiff = lengths[:, None], 1 / (1 + ratio[:, None])

    # Rotations of the ends from the chord: half their difference bows it, their mean makes it wave
    deflection = _freedoms(length, stiff * wave, bow, length) + _chord(t, 1 - t)
    slope = _freedoms(length, stiff * wave_slope, bow_slope, 1.0)
    slope = slope + _chord(1 / length, -1 / length)
    lag = 1 - stiff
    rotation = slope + _freedoms(length, lag + 0 * t, 0 * t, 1.0)
    return deflection, slope, rotation


def _freedoms(length: Vector, wave: Vector, bow: Vector, scale: Vector | float) -> Vector:
    """``scale`` · (wave · mean + bow · half difference) of the ends' rotations from the chord."""
    wave, bow = np.broadcast_arrays(scale * wave, scale * bow)
    by_chord = wave / length
    return np.stack([by_chord, (wave + bow) / 2, -by_chord, (wave - bow) / 2], axis=-1)


def _chord(end: Vector, start: Vector) -> Vector:
    """What the deflections of the ends add without any rotation from the chord."""
    end, start = np.broadcast_arrays(np.atleast_2d(end), np.atleast_2d(start))
    zero = np.zeros_like(end)
    return np.stack([start, zero, end, zero], axis=-1)


def local_geometric(axial_force: Vector, rigidities: Rigidities, lengths: Vector) -> Vector:
    """Geometric stiffness (M, 12, 12) of members under axial forces, in local axes, N, m and rad.

    ``axial_force`` (M, 2) in N at start and end, linear between, tension positive. ∫ N w′² of both
    deflections and i_p² ∫ N θ′² of twist, with i_p² = ρI_p ÷ ρA the polar radius (Wagner's term;
    warping is free) [McGuire, Gallagher and Ziemian 2000, ch. 9].
    """
    start, end = axial_force[:, :1], axial_force[:, 1:]
    weight = (start + (end - start) * _STATIONS) * lengths[:, None]
    matrix = np.zeros((len(lengths), 12, 12))
    for plane, bending, shear in _bending(rigidities):
        ratio = shear_ratio(bending, shear, lengths)
        _, slope, _ = bending_shapes(ratio, lengths, _STATIONS)
        _add(matrix, plane, _integral(slope, weight))
    twist = axial_force.mean(axis=1) * polar_radius_squared(rigidities) / lengths
    matrix[:, [3, 9], [3, 9]] += twist[:, None]
    matrix[:, [3, 9], [9, 3]] -= twist[:, None]
    return matrix


def local_mass(rigidities: Rigidities, lengths: Vector) -> Vector:
    """Consistent mass (M, 12, 12) of members, in local axes, in kg, kg·m and kg·m².

    With the sections' rotary inertia; ρI_p is shared between the bending axes as EI_y and EI_z are
    [Friedman and Kosmatka 1993].
    """
    matrix = np.zeros((len(lengths), 12, 12))
    both = rigidities.bending_y + rigidities.bending_z
    for plane, bending, shear in _bending(rigidities):
        ratio = shear_ratio(bending, shear, lengths)
        deflection, _, rotation = bending_shapes(ratio, lengths, _STATIONS)
        inertia = rigidities.rotary * bending / both
        _add(matrix, plane, _integral(deflection, (rigidities.mass * lengths)[:, None]))
        _add(matrix, plane, _integral(rotation, (inertia * lengths)[:, None]))
    for start, end, density in ((0, 6, rigidities.mass), (3, 9, rigidities.rotary)):
        third = (density * lengths / 3)[:, None]
        matrix[:, [start, end], [start, end]] += third
        matrix[:, [start, end], [end, start]] += third / 2
    return matrix


def polar_radius_squared(rigidities: Rigidities) -> Vector:
    """i_p² = I_p ÷ A of each member (M,) in m², 0 where a member has no mass."""
    mass = rigidities.mass
    return np.divide(rigidities.rotary, mass, out=np.zeros_like(mass), where=mass > 0)


def _bending(rigidities: Rigidities):
    """Each of PLANES with the rigidities against bending and shear in it."""
    yield PLANES[0], rigidities.bending_z, rigidities.shear_y
    yield PLANES[1], rigidities.bending_y, rigidities.shear_z


def _integral(shapes: Vector, weight: Vector) -> Vector:
    """∫ ``weight`` shapesᵀ shapes over the unit length, weight (M, 1) or at the stations (M, S)."""
    weighed = shapes * (weight * _WEIGHTS)[..., None]
    return shapes.transpose(0, 2, 1) @ weighed


def _add(matrix: Vector, plane: tuple[int, int, int, int, float], part: Vector) -> None:
    """Add a plane's part (M, 4, 4) to the whole matrix (M, 12, 12), in place."""
    *freedoms, sign = plane
    signs = np.array([1.0, sign, 1.0, sign])
    matrix[:, np.array(freedoms)[:, None], freedoms] += part * np.outer(signs, signs)
