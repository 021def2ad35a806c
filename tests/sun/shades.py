"""Simple bodies that shade, and directions to look in."""

import numpy as np
from heliform.engines.core.scene import Body, Material, Mesh

MATTE = Material(kind="diffuse")

_BOX = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]], np.int32
)


def box(name, size, centre, material=MATTE):
    """A closed box of quadrilaterals that look outward."""
    return Body(name, Mesh(_BOX * size + np.asarray(centre, float), _SIDES), material)


def sheet(name, corners, material=MATTE):
    """A polygon of four corners."""
    return Body(name, Mesh(np.array(corners, float), np.array([[0, 1, 2, 3]], np.int32)), material)


def level(name, width, length, z, material=MATTE):
    """A horizontal sheet about the Z axis that looks up."""
    x, y = width / 2, length / 2
    return sheet(name, [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]], material)


def dome(count):
    """Directions (count, 3) spread evenly over the upper half of the sphere, by a golden spiral."""
    z = (np.arange(count) + 0.5) / count
    turn = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    level = np.sqrt(1 - z * z)
    return np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=1)


def unit(vectors):
    vectors = np.asarray(vectors, float)
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def sky_view(visibility):
    """The share of the sky, weighted by the cosine, that sensors see in an even ``dome``."""
    count = len(visibility.directions)
    return visibility.dot(np.full(count, 2 * np.pi / count)) / np.pi
