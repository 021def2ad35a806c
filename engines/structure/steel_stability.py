"""Buckling of steel members: reduction factors, critical loads and the interaction of Annex B."""

import numpy as np
from numpy.typing import ArrayLike

from ..core.scene import Vector
from .grade import Grade
from .sections import SHAPES, Sections

IMPERFECTION = {"a0": 0.13, "a": 0.21, "b": 0.34, "c": 0.49, "d": 0.76}
"""α of the buckling curves, EN 1993-1-1 Table 6.1; those of Table 6.3 are the same."""

_PLATEAU, _BETA = 0.4, 0.75
_HOLLOW = {"hot-finished": "a", "cold-formed": "c", "welded": "b"}


def reduction_factor(slenderness: ArrayLike, imperfection: Vector | float) -> Vector:
    """χ of flexural buckling, EN 1993-1-1 equation 6.49, of the shape of its arguments."""
    slenderness = np.asarray(slenderness, dtype=np.float64)
    offset = np.maximum(slenderness - 0.2, 0.0)
    half = 0.5 * (1.0 + imperfection * offset + slenderness**2)
    return 1.0 / (half + np.sqrt(np.maximum(half**2 - slenderness**2, 0.0)))


def lateral_reduction_factor(slenderness: ArrayLike, imperfection: Vector | float) -> Vector:
    """χ_LT of rolled sections, EN 1993-1-1 equation 6.57 with its plateau 0.4 and β = 0.75."""
    slenderness = np.asarray(slenderness, dtype=np.float64)
    square = _BETA * slenderness**2
    offset = np.maximum(slenderness - _PLATEAU, 0.0)
    half = 0.5 * (1.0 + imperfection * offset + square)
    factor = 1.0 / (half + np.sqrt(np.maximum(half**2 - square, 0.0)))
    factor = np.minimum(factor, 1.0 / np.maximum(slenderness, 1.0) ** 2)
    return np.where(slenderness <= _PLATEAU, 1.0, factor)


def critical_force(rigidity: ArrayLike, length: ArrayLike) -> Vector:
    """Euler's load π²EI/L² in N; infinite where the length is 0."""
    length = np.asarray(length, dtype=np.float64)
    held = length <= 0.0
    return np.where(
        held, np.inf, np.pi**2 * np.asarray(rigidity) / np.where(held, 1.0, length) ** 2
    )


def warping_constant(sections: Sections) -> Vector:
    """I_w (M,) in m⁶: I_z (h − t_f)²/4 of an I section, nothing for the others."""
    is_i = sections.shape == SHAPES.index("i")
    return np.where(is_i, sections.inertia_z * (sections.height - sections.flange) ** 2 / 4, 0.0)


def critical_moment(sections: Sections, grade: Grade, length: Vector) -> Vector:
    """M_cr (M,) in N·m under uniform moment, between forks at ``length`` (M,); infinite at 0.

    √(π²EI_z/L² (GJ + π²EI_w/L²)) of a doubly symmetric section loaded in its shear centre
    (Timoshenko and Gere 1961, 6.2).
    """
    lateral = critical_force(grade.youngs * sections.inertia_z, length)
    warping = critical_force(grade.youngs * warping_constant(sections), length)
    return np.sqrt(lateral * (grade.shear * sections.torsion + warping))


def critical_torsion(sections: Sections, grade: Grade, length: Vector) -> Vector:
    """N_cr,T (M,) in N of torsional buckling, EN 1993-1-1 6.3.1.4: (GJ + π²EI_w/L²)/i₀²."""
    polar = (sections.inertia_y + sections.inertia_z) / sections.area
    warping = critical_force(grade.youngs * warping_constant(sections), length)
    return (grade.shear * sections.torsion + warping) / polar


def imperfections(sections: Sections, grade: Grade, hollow: str) -> tuple[Vector, Vector]:
    """α about y and about z (M,) by EN 1993-1-1 Table 6.2, S460 included.

    ``hollow`` says how hollow sections are made: "hot-finished", "cold-formed" or "welded".
    I sections are rolled; solid ones have curve c.
    """
    strong = grade.yield_strength >= 459e6
    curve = "a0" if strong and hollow == "hot-finished" else _HOLLOW[hollow]
    about_y = np.full(len(sections), IMPERFECTION[curve])
    about_z = about_y.copy()
    solid = sections.shape == SHAPES.index("rectangle")
    about_y[solid] = about_z[solid] = IMPERFECTION["c"]
    rolled = sections.shape == SHAPES.index("i")
    if rolled.any():
        slim = sections.height > 1.2 * sections.width
        thin = sections.flange <= np.where(slim, 0.04, 0.1)
        # y and z of each row of the table: slim and thin, slim, stocky and thin, stocky.
        rows = ("a0 a0", "a a", "a a", "c c") if strong else ("a b", "b c", "b c", "d d")
        values = np.array([[IMPERFECTION[name] for name in row.split()] for row in rows])
        row = np.where(slim, 0, 2) + np.where(thin, 0, 1)
        about_y[rolled], about_z[rolled] = values[row[rolled]].T
    return about_y, about_z


def lateral_imperfections(sections: Sections) -> Vector:
    """α_LT (M,): curve b up to h/b = 2, c up to 3.1, d beyond, and d for solid rectangles.

    EN 1993-1-1 Table 6.5 for rolled sections; curve d and hollow sections by NA.2.17 of BS EN
    1993-1-1, since EN 1993-1-1 says nothing of slender hollow ones.
    """
    ratio = sections.height / sections.width
    solid = sections.shape == SHAPES.index("rectangle")
    curve = np.where(solid, 2, (ratio > 2.0).astype(int) + (ratio > 3.1))
    return np.array([IMPERFECTION[name] for name in "bcd"])[curve]


def equivalent_moment(start: Vector, middle: Vector, end: Vector) -> Vector:
    """C_m by EN 1993-1-1 Table B.3 from signed moments at the ends and in the middle.

    Arrays of one shape, and so is what is returned; between 0.4 and 1. The columns for uniform
    load, which are never below those for a concentrated one; without load along the member they
    are 0.6 + 0.4 ψ.
    """
    larger = np.where(np.abs(start) >= np.abs(end), start, end)
    smaller = np.where(np.abs(start) >= np.abs(end), end, start)
    hogging = np.abs(larger) >= np.abs(middle)
    with np.errstate(divide="ignore", invalid="ignore"):
        psi = np.where(larger == 0.0, 1.0, smaller / larger)
        ratio = np.where(hogging, middle / larger, larger / middle)
    ratio = np.where(larger == 0.0, np.where(middle == 0.0, 1.0, 0.0), ratio)
    reverse = np.minimum(psi, 0.0)
    ends = np.where(ratio >= 0.0, 0.2 + 0.8 * ratio, 0.1 * (1.0 - reverse) - 0.8 * ratio)
    span = 0.95 + 0.05 * ratio * np.where(ratio < 0.0, 1.0 + 2.0 * reverse, 1.0)
    return np.clip(np.where(hogging, ends, span), 0.4, 1.0)


def moment_gradient(start: Vector, middle: Vector, end: Vector) -> Vector:
    """C_1 from signed moments at the ends and in the middle, of their shape.

    12.5 M/(2.5 M + 3 M_A + 4 M_B + 3 M_C) with the greatest moment M and those at the quarter
    points (Kirby and Nethercot 1979; AISC 360 equation F1-1), on a parabola through the three:
    1 under uniform moment, 1.14 under uniform load (exact: 1.13), 1.67 for ψ = 0 (1.77).
    """
    half = np.abs(middle)
    first = np.abs(3 * start + 6 * middle - end) / 8
    last = np.abs(3 * end + 6 * middle - start) / 8
    most = np.maximum(np.maximum(np.abs(start), np.abs(end)), half)
    most = np.maximum(np.maximum(most, np.maximum(first, last)), 1e-300)
    return 12.5 * most / (2.5 * most + 3 * first + 4 * half + 3 * last)


def ends_and_middle(moments: Vector) -> tuple[Vector, Vector, Vector]:
    """Moments at the start, in the middle and at the end (K, M) of (K, S, M) at even stations."""
    last = moments.shape[1] - 1
    middle = (moments[:, last // 2] + moments[:, (last + 1) // 2]) / 2
    return moments[:, 0], middle, moments[:, last]
