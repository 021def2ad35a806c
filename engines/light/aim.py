"""Which directions, or which parts of a beam, can meet a body at all.

Bodies are covered by balls, the opening by patches about a point; a cell is kept when light of it
could touch a ball. The cover errs only to the safe side, so leaving cells out is unbiased.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .luminaires import Source

VOXELS = 32


def cover(
    vertices: NDArray[np.floating[Any]], faces: NDArray[np.integer]
) -> tuple[NDArray[np.float64], float]:
    """Balls that contain the triangles ``faces`` (T, 3): centres (K, 3) and their common radius.

    The centres are those of the voxels that a vertex lies in; no place of a triangle is farther
    than longest edge ÷ √3 from a corner. Triangles larger than a voxel get a lattice of places.
    """
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    corners = vertices if used.all() else vertices[used]
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = max(float((high - low).max()) / VOXELS, 1e-9)
    reach = _longest_edges(vertices, faces)
    large = reach > size
    longest = float(reach[~large].max(initial=0.0))
    triangles = vertices[faces[large]].astype(np.float64)
    places = [corners, *_lattices(triangles, size)]
    index = ((np.concatenate(places) - low) / size).astype(np.int32).clip(0, VOXELS - 1)
    occupied = np.zeros((VOXELS,) * 3, bool)
    occupied[tuple(index.T)] = True
    centres = low + (np.argwhere(occupied) + 0.5) * size
    between = max(longest / np.sqrt(3), size * np.sqrt(1.25) if large.any() else 0.0)
    return centres, size * np.sqrt(3) / 2 + between


def _longest_edges(
    vertices: NDArray[np.floating[Any]], faces: NDArray[np.integer]
) -> NDArray[np.floating[Any]]:
    """The longest edge of each triangle (T,), through its square."""
    rows = np.ascontiguousarray(vertices.T)
    a, b, c = (rows[:, corner] for corner in faces.T)
    edges = (b - a, c - b, a - c)
    square = np.max([np.einsum("it,it->t", edge, edge) for edge in edges], axis=0)
    return np.sqrt(square)


def _lattices(triangles: NDArray[np.float64], size: float) -> Iterator[NDArray[np.float64]]:
    """Places (…, 3) on triangles (T, 3, 3) no farther than √1.25 ``size`` from any of theirs.

    They lie in rows along the longest edge, ``size`` apart: the feet of a triangle's places on
    its longest edge are within that edge, so each is within ``size`` of the row below it.
    """
    if not len(triangles):
        return
    edges = np.roll(triangles, -1, axis=1) - triangles
    square = np.einsum("tij,tij->ti", edges, edges)
    first = square.argmax(axis=1)
    order = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, order[..., None], axis=1).transpose(1, 0, 2)
    length = np.sqrt(square.max(axis=1))
    height = np.linalg.norm(np.cross(b - a, c - a), axis=1) / length
    steps = np.ceil(np.column_stack([length, height]) / size).astype(int).clip(1)
    for along, up in np.unique(steps, axis=0):
        these = (steps == (along, up)).all(axis=1)
        u, v = np.linspace(0, 1, along + 1)[:, None, None, None], np.linspace(0, 1, up + 1)
        v = v[:, None, None]
        yield ((1 - v) * (a[these] + u * (b - a)[these]) + v * c[these]).reshape(-1, 3)


def patches_of(source: Source, side: int) -> tuple[NDArray[np.float64], float]:
    """``side`` × ``side`` patches of the opening: a point of each (P, 2) in m, in rows, and a
    radius within which all of its patch lies.

    A round opening is the concentric image of a square [Shirley & Chiu 1997].
    """
    if source.shape == "point":
        return np.zeros((1, 2)), 0.0
    along = np.linspace(0, 1, 5)
    within = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    corner = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 1, 2)
    places = 2 * (corner + within) / side - 1
    if source.shape == "round":
        places = _concentric(places)
    places = places * np.array([source.length, source.width]) / 2
    middle = places.mean(axis=1)
    reach = np.linalg.norm(places - middle[:, None], axis=-1).max()
    # Between the sampled places a curved border bulges by less than a twentieth.
    return middle, 1.05 * float(reach)


def _concentric(square: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places of the square −1..1 (…, 2) on the unit disk."""
    x, y = square[..., 0], square[..., 1]
    wide = np.abs(x) > np.abs(y)
    radius = np.where(wide, x, y)
    turn = np.where(
        wide,
        np.pi / 4 * np.divide(y, x, out=np.zeros_like(x), where=wide),
        np.pi / 2 - np.pi / 4 * np.divide(x, y, out=np.zeros_like(x), where=~wide & (y != 0)),
    )
    return np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=-1)


def directions(
    source: Source,
    points: NDArray[np.float64],
    slack: float,
    cover: tuple[NDArray[np.float64], float],
    rows: int,
    columns: int,
) -> NDArray[np.bool_]:
    """Cells (P, rows in γ, columns in C) whose light can meet a ball of ``cover``; lengths in m.

    ``points`` (P, 2) on the opening stand for patches of radius ``slack``. Each ball covers a
    rectangle of cells: as high as it looks, and as wide as its cap is there.
    """
    centres, radius = cover
    local = (centres - source.origin) @ source.axes
    x, y = local[None, :, 0] - points[:, :1], local[None, :, 1] - points[:, 1:]
    depth = -local[None, :, 2]
    distance = np.sqrt(x * x + y * y + depth * depth)
    around = distance <= radius + slack
    sine = np.where(around, 1.0, (radius + slack) / np.maximum(distance, 1e-12))
    wide = np.where(around, np.pi, np.arcsin(np.minimum(sine, 1.0)))
    gamma = np.arccos(np.clip(depth / np.maximum(distance, 1e-12), -1, 1))
    low, high = gamma - wide, gamma + wide
    pole = (low <= 0) | (high >= np.pi)
    reach = np.arcsin(np.where(pole, 0.0, np.minimum(sine / np.maximum(np.sin(gamma), 1e-12), 1)))
    turn = np.mod(np.arctan2(y, x), 2 * np.pi)
    step = np.array([np.pi / rows, 2 * np.pi / columns])
    top, bottom = (np.clip(np.floor(e / step[0]), 0, rows - 1).astype(int) for e in (low, high))
    left = np.where(pole, 0, np.floor((turn - reach) / step[1])).astype(int)
    right = np.where(pole, columns - 1, np.floor((turn + reach) / step[1])).astype(int)
    right = np.minimum(right, left + columns - 1)
    shift = np.where(left < 0, columns, 0)
    left, right = left + shift, right + shift
    # Count rectangles by their corners, +1 where one begins and −1 past its end, with the columns
    # laid out twice for those that go round.
    shape = len(points), rows + 1, 2 * columns + 1
    patch = np.arange(len(points))[:, None]
    corners = [(top, left, 1), (top, right + 1, -1), (bottom + 1, left, -1)]
    corners += [(bottom + 1, right + 1, 1)]
    count = np.zeros(shape[0] * shape[1] * shape[2], np.int32)
    for row, column, sign in corners:
        index = ((patch * shape[1] + row) * shape[2] + column).ravel()
        count += sign * np.bincount(index, minlength=count.size).astype(np.int32)
    covered = count.reshape(shape).cumsum(axis=1).cumsum(axis=2)[:, :rows, : 2 * columns] > 0
    return covered[..., :columns] | covered[..., columns:]


def patches(
    source: Source, centres: NDArray[np.float64], radius: float, cells: int
) -> NDArray[np.bool_]:
    """Cells (cells in Y, cells in X) of a parallel beam's cross-section that can meet a ball."""
    local = (centres - source.origin) @ source.axes
    ahead = local[:, 2] < radius
    size = np.array([source.length, source.width])
    low = np.floor(((local[ahead, :2] - radius) / size + 0.5) * cells).astype(int)
    high = np.floor(((local[ahead, :2] + radius) / size + 0.5) * cells).astype(int)
    # Count rectangles by their corners: +1 where one starts, −1 past where it ends.
    edges = np.zeros((cells + 1, cells + 1), int)
    inside = (low < cells).all(axis=1) & (high >= 0).all(axis=1)
    low, high = low[inside].clip(0), high[inside].clip(max=cells - 1) + 1
    np.add.at(edges, (low[:, 1], low[:, 0]), 1)
    np.add.at(edges, (high[:, 1], high[:, 0]), 1)
    np.add.at(edges, (low[:, 1], high[:, 0]), -1)
    np.add.at(edges, (high[:, 1], low[:, 0]), -1)
    return edges.cumsum(axis=0).cumsum(axis=1)[:cells, :cells] > 0
