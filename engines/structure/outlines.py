"""Outlines of cross-sections, as their solids are drawn."""

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .sections import SHAPES, Sections

# Corners run from the middle of the top, counter-clockwise about local x: by −y to the bottom and
# back by +y. Those at y = 0 lie where the cuts to the left and the right of a member meet.
BOX, ROUND = 6, 14
CAPS = {
    BOX: np.array([[0, 1, 2, 3], [0, 3, 4, 5]]),
    ROUND: np.array(
        [[0, 1, 2, 3], [0, 3, 4, 7], [4, 5, 6, 7], [7, 8, 9, 10], [7, 10, 11, 0], [11, 12, 13, 0]]
    ),
}
_SIDES = 12


def outlines(sections: Sections) -> list[tuple[NDArray[np.intp], Vector]]:
    """Which sections have the same count of corners, and their corners (n, P, 2), y and z in m.

    Rectangles and RHS are boxes of BOX corners; I-sections, without their root radii, and CHS, as
    12-gons on their circle, have ROUND. A group without sections is left out.
    """
    half_width, half_height = sections.width / 2, sections.height / 2
    flanged = sections.shape == SHAPES.index("i")
    tall = flanged | (sections.shape == SHAPES.index("chs"))
    boxes = np.flatnonzero(~tall)
    y, z = half_width[boxes], half_height[boxes]
    found = [(boxes, _mirrored(np.stack([y, y], axis=1), np.stack([z, -z], axis=1)))]

    others = np.flatnonzero(tall)
    y, z = half_width[others], half_height[others]
    web, inner = sections.web[others] / 2, z - sections.flange[others]
    i_y = np.stack([y, y, web, web, y, y], axis=1)
    i_z = np.stack([z, inner, inner, -inner, -inner, -z], axis=1)
    angle = np.pi / 2 - (np.arange(_SIDES // 2) + 0.5) * 2 * np.pi / _SIDES
    is_i = flanged[others, None]
    corner_y = np.where(is_i, i_y, z[:, None] * np.cos(angle))
    corner_z = np.where(is_i, i_z, z[:, None] * np.sin(angle))
    found.append((others, _mirrored(corner_y, corner_z)))
    return [(index, corners) for index, corners in found if len(index)]


def _mirrored(y: Vector, z: Vector) -> Vector:
    """The outline (n, 2 k + 2, 2) whose right half, from the top down, is at −y and z (n, k)."""
    zero = np.zeros((len(y), 1))
    top, bottom = z[:, :1], z[:, -1:]
    return np.stack(
        [
            np.concatenate([zero, -y, zero, y[:, ::-1]], axis=1),
            np.concatenate([top, z, bottom, z[:, ::-1]], axis=1),
        ],
        axis=-1,
    )
