"""Which directions, or which parts of a beam, can meet a body at all.

Bodies are covered by balls, the opening by points with a covering radius; a cell is kept when light
of it could touch a ball. The cover errs only to the safe side, so leaving cells out is unbiased.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from .luminaires import Source

VOXELS = 32
OPENING_POINTS = 64
CLASSES = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 180.0)
"""Angular radii in degrees that the balls are gathered into before their cells are spread."""


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


def opening_points(source: Source) -> tuple[NDArray[np.float64], float]:
    """Points (P, 2) m on the opening and a radius within which each of its places has one."""
    if source.shape == "point":
        return np.zeros((1, 2)), 0.0
    half = np.array([source.length, source.width]) / 2
    k = np.arange(OPENING_POINTS)
    if source.shape == "round":
        turn, reach = k * np.pi * (3 - np.sqrt(5)), np.sqrt((k + 0.5) / OPENING_POINTS)
        points = np.stack([reach * np.cos(turn), reach * np.sin(turn)], axis=1)
        # No place of the unit disk is farther than 1.8/√P from a point of this sunflower.
        return points * half, 1.8 / np.sqrt(OPENING_POINTS) * float(half.max())
    side = int(np.sqrt(OPENING_POINTS))
    grid = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(grid, grid)
    points = np.stack([x.ravel(), y.ravel()], axis=1) * half
    return points, float(np.linalg.norm(half)) / side


def directions(
    source: Source, centres: NDArray[np.float64], radius: float, rows: int, columns: int
) -> NDArray[np.bool_]:
    """Cells (rows in γ, columns in C) of direction that can meet a ball; lengths in m."""
    points, slack = opening_points(source)
    local = (centres - source.origin) @ source.axes
    mask = np.zeros((rows, columns), bool)
    classes = np.radians(CLASSES)
    marks = np.zeros((len(classes), rows, columns), bool)
    for x, y in points:
        ray = local - (x, y, 0.0)
        distance = np.linalg.norm(ray, axis=1)
        wide = np.arcsin(np.minimum((radius + slack) / np.maximum(distance, 1e-12), 1.0))
        wide = np.where(distance <= radius + slack, np.pi, wide)
        gamma = np.arccos(np.clip(-ray[:, 2] / np.maximum(distance, 1e-12), -1, 1))
        turn = np.mod(np.arctan2(ray[:, 1], ray[:, 0]), 2 * np.pi)
        row = np.minimum((gamma / np.pi * rows).astype(int), rows - 1)
        column = np.minimum((turn / (2 * np.pi) * columns).astype(int), columns - 1)
        marks[np.searchsorted(classes, wide), row, column] = True
    for angle, mark in zip(classes, marks, strict=True):
        if mark.any():
            mask |= _spread(mark, angle)
    return mask


def _spread(mark: NDArray[np.bool_], angle: float) -> NDArray[np.bool_]:
    """Cells within ``angle`` of a marked one: along C by the cap's width, then along γ."""
    rows, columns = mark.shape
    step = np.pi / rows
    cap = angle + step
    spread = np.zeros_like(mark)
    for row in np.flatnonzero(mark.any(axis=1)):
        low, high = row * step, (row + 1) * step
        sine = min(np.sin(low), np.sin(high))
        if cap >= np.pi / 2 or low <= cap or high >= np.pi - cap:
            spread[row] = True
            continue
        reach = int(np.ceil(np.arcsin(np.sin(cap) / sine) / (2 * np.pi) * columns)) + 1
        wide = min(2 * reach + 1, columns)
        spread[row] = maximum_filter1d(mark[row].view(np.uint8), wide, mode="wrap") > 0
    tall = 2 * (int(np.ceil(cap / step)) + 1) + 1
    return (
        maximum_filter1d(spread.view(np.uint8), min(tall, 2 * rows + 1), axis=0, mode="nearest") > 0
    )


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
