"""What sections are put together from: rounded corners, and walls that carry shear."""

import numpy as np

from ..core.scene import Vector

CORNER_AREA = 1 - np.pi / 4
CORNER_CENTROID = 1 - 1 / (6 * CORNER_AREA)
CORNER_INERTIA = 1 / 3 - np.pi / 16 - 1 / (36 * CORNER_AREA)
"""Between a corner and a circle of radius 1 in it: area, centroid off the edge, own inertia."""


def rounded_area(h: Vector, b: Vector, r: Vector) -> Vector:
    """Area of a rectangle with corners of radius ``r``, in m²."""
    return h * b - 4 * CORNER_AREA * r**2


def rounded_inertia(h: Vector, b: Vector, r: Vector) -> Vector:
    """Second moment of area of it about the axis across its height ``h``, in m⁴."""
    corner = CORNER_INERTIA * r**4 + CORNER_AREA * r**2 * (h / 2 - CORNER_CENTROID * r) ** 2
    return b * h**3 / 12 - 4 * corner


def rounded_plastic(h: Vector, b: Vector, r: Vector) -> Vector:
    """Plastic section modulus of it about that axis, in m³."""
    return b * h**2 / 4 - 4 * CORNER_AREA * r**2 * (h / 2 - CORNER_CENTROID * r)


def two_webs(h: Vector, b: Vector, web: Vector, flange: Vector) -> Vector:
    """Shear area along h of two webs ``h`` high between flanges ``b`` wide, on the middle line.

    The flow in a flange is nought in the middle of a tube's, at the tips of an I's, and either way
    grows over half of the width; an I's web counts as two halves.
    """
    inertia = web * h**3 / 6 + b * flange * h**2 / 2
    top = b * flange * h / 4  # first moment of what each web has above it
    rise = web * h**2 / 8
    webs = h / web * (top**2 + 4 / 3 * top * rise + 8 / 15 * rise**2)
    flanges = flange * b**3 * h**2 / 24
    return inertia**2 / (2 * webs + flanges)
