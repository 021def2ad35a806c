"""The glasses of the comparison, where they stand: Table 1's tube, a wavy plate, a prism."""

import numpy as np
from heliform.engines.core.scene import Mesh
from peers.tube import tube

PLATE, THICKNESS, HEIGHT = 0.16, 0.008, 0.04
"""Metres: the plate's side, its thickness, and how high it lies above the plane."""
WAVE, RELIEF = 0.02, 0.6e-3
"""Metres: length and amplitude of the waves on the plate."""
STEPS = 256
SIDE, LENGTH, LIFT = 0.04, 0.12, 0.01
"""Metres: the sides of the prism's triangle, its length, and how high it lies."""


def plate(steps: int = STEPS) -> Mesh:
    """A plate with waves both ways on its upper side, which focus about on the plane."""
    along = np.linspace(-PLATE / 2, PLATE / 2, steps + 1)
    x, y = np.meshgrid(along, along)
    k = 2 * np.pi / WAVE
    top = HEIGHT + THICKNESS + RELIEF * np.cos(k * x) * np.cos(k * y)
    slope = (
        RELIEF
        * k
        * np.stack(
            [np.sin(k * x) * np.cos(k * y), np.cos(k * x) * np.sin(k * y), np.zeros_like(x)],
            axis=-1,
        )
    )
    normal = slope + np.array([0.0, 0.0, 1.0])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    count = x.size
    vertices = np.concatenate(
        [np.stack([x, y, z], axis=-1).reshape(-1, 3) for z in (top, np.full_like(x, HEIGHT))]
    )
    index = np.arange(count).reshape(steps + 1, steps + 1)
    corners = (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1])
    upper = np.stack(corners, axis=-1).reshape(-1, 4)
    edges = [index[0], index[:, -1], index[-1, ::-1], index[::-1, 0]]
    sides = np.concatenate(
        [np.stack([e[:-1] + count, e[1:] + count, e[1:], e[:-1]], axis=-1) for e in edges]
    )
    faces = np.concatenate([upper, upper[:, ::-1] + count, sides]).astype(np.int32)
    normals = flat(vertices, faces)
    normals[: len(upper)] = normal.reshape(-1, 3)[upper]
    return Mesh(vertices, faces, normals).triangles()


def prism() -> Mesh:
    """A prism of 60° that lies on one side along Y."""
    half = SIDE / 2
    triangle = np.array([[-half, 0.0], [half, 0.0], [0.0, SIDE * np.sqrt(3) / 2]])
    ends = [
        np.column_stack([triangle[:, 0], np.full(3, y), triangle[:, 1] + LIFT])
        for y in (-LENGTH / 2, LENGTH / 2)
    ]
    vertices = np.concatenate(ends)
    faces = [[0, 1, 2], [5, 4, 3]]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        faces += [[b, a, a + 3], [b, a + 3, b + 3]]
    faces = np.array(faces, np.int32)
    return Mesh(vertices, faces, flat(vertices, faces))


def flat(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The faces' own normals at their corners."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.repeat(normal[:, None], faces.shape[1], axis=1).astype(np.float32)


def turned_alike(values: np.ndarray) -> list[np.ndarray]:
    """A map under the eight symmetries of a square."""
    return [np.rot90(v, k) for v in (values, values.T) for k in range(4)]


def mirrored_alike(values: np.ndarray) -> list[np.ndarray]:
    """A map under the four symmetries of a rectangle."""
    return [values[::i, ::j] for i in (1, -1) for j in (1, -1)]


def square_lamp(text: str) -> str:
    """The sample lamp's file with a square opening instead of a round one.

    Radiance's photon map emits a disk's light from the square of its area. A glass with flat faces
    shows the opening's image, and there the two must be of one shape.
    """
    return text.replace("2 -0.05 -0.05 0", "2 0.05 0.05 0")


GLASSES = {
    "tube": (tube, turned_alike, str),
    "plate": (plate, turned_alike, square_lamp),
    "prism": (prism, mirrored_alike, square_lamp),
}
"""Each glass's mesh, the maps as likely as its own, and what becomes of the lamp's file."""
