"""Exact clipping of a surface's faces with the texels of its map."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .scene import Vector

Indices = NDArray[np.integer[Any]]

_BATCH = 1 << 15  # pieces at a time: what stays in a processor's cache
_STRIPS = 1 << 18
_FLAT = 1e-9  # of a texel: a face of less has no place to spread over
_NOTHING = 1e-12  # of a texel: rounding


@dataclass(frozen=True, slots=True)
class Pieces:
    """Some of the pieces that the grid of texels cuts the faces into, none of them empty.

    ``face`` and ``texel`` (P,): what a piece is of, the latter as row · columns + column;
    ``covered`` (P,): how much of the texel it covers; ``part`` (P,): how much of the face it is;
    ``weights`` (3, P): where its centroid is, as shares of the face's three corners.
    """

    face: Indices
    texel: Indices
    covered: Vector
    part: Vector
    weights: Vector


def pieces(texture: Vector, columns: int, rows: int) -> Iterator[Pieces]:
    """The pieces of all faces, a batch at a time, in the order of the faces.

    ``texture`` (F, 3, 2) finite; what is outside 0..1 is moved to the border. A face that has no
    area in the map is one piece, whole, that covers nothing.
    """
    scaled = np.clip(texture, 0.0, 1.0) * [columns, rows]
    x, y = (np.ascontiguousarray(scaled[..., axis].T) for axis in (0, 1))
    twice = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    flat = np.abs(twice) < 2 * _FLAT
    if flat.any():
        yield _whole(np.flatnonzero(flat), x, y, columns, rows)
    faces = np.flatnonzero(~flat)
    first, last = _span(y[:, faces].min(axis=0), y[:, faces].max(axis=0), rows)
    for some in _batches(last - first + 1, _STRIPS):
        face, row = _spread(faces[some], first[some], last[some])
        left, right = _span(*_extent(x[:, face], y[:, face], row), columns)
        for strips in _batches(right - left + 1, _BATCH):
            strip, column = _spread(np.arange(len(face))[strips], left[strips], right[strips])
            yield _clipped(x, y, twice, face[strip], column, row[strip], columns)


def coverage(texture: Vector, columns: int, rows: int) -> Vector:
    """How often each texel (rows, columns) is claimed: the sum of what all faces cover of it."""
    claimed = np.zeros(rows * columns)
    for some in pieces(texture, columns, rows):
        np.add.at(claimed, some.texel, some.covered)
    return claimed.reshape(rows, columns)


def _whole(faces: Indices, x: Vector, y: Vector, columns: int, rows: int) -> Pieces:
    column = np.minimum(x[:, faces].mean(axis=0).astype(np.intp), columns - 1)
    row = np.minimum(y[:, faces].mean(axis=0).astype(np.intp), rows - 1)
    count = len(faces)
    thirds = np.full((3, count), 1 / 3)
    return Pieces(faces, row * columns + column, np.zeros(count), np.ones(count), thirds)


def _clipped(
    x: Vector,
    y: Vector,
    twice: Vector,
    face: Indices,
    column: Indices,
    row: Indices,
    columns: int,
) -> Pieces:
    """The pieces of ``face`` in the texels at ``column`` and ``row``.

    With h(x) an edge's height above the texel's floor, cut off at 0 and 1, area and moments are
    line integrals of h, x h and h²/2 along the edges over the texel's width (Green's theorem).
    The upright sides of the texel add nothing to them, so no polygon need be put together.
    """
    x, y, twice = x[:, face] - column, y[:, face] - row, twice[face]
    area, moment_x, moment_y = np.zeros((3, len(face)))
    for here, there in ((0, 1), (1, 2), (2, 0)):
        run, rise = x[there] - x[here], y[there] - y[here]
        slope = np.divide(rise, run, out=np.zeros_like(run), where=run != 0)
        start, end = np.clip(x[here], 0, 1), np.clip(x[there], 0, 1)
        low = y[here] + (start - x[here]) * slope
        high = y[there] + (end - x[there]) * slope
        inverse = np.divide(1.0, high - low, out=np.ones_like(low), where=high != low)
        floor, ceiling = np.clip(-low * inverse, 0, 1), np.clip((1 - low) * inverse, 0, 1)
        enter, leave = np.minimum(floor, ceiling), np.maximum(floor, ceiling)
        # Flat at `low` up to `enter`, then straight to `high` at `leave`, then flat again.
        low, high, width = np.clip(low, 0, 1), np.clip(high, 0, 1), end - start
        a, b = start + width * enter, start + width * leave
        before, within, after = width * enter * low, width * (leave - enter), width * (1 - leave)
        after *= high
        area -= before + within * (low + high) / 2 + after
        moment_x -= before * (start + a) / 2 + after * (b + end) / 2
        moment_x -= within * (a * (2 * low + high) + b * (low + 2 * high)) / 6
        moment_y -= (before * low + after * high) / 2
        moment_y -= within * (low * low + low * high + high * high) / 6
    covered = area * np.sign(twice)
    there = covered > _NOTHING
    x, y, twice, area = x[:, there], y[:, there], twice[there], area[there]
    middle_x = np.clip(moment_x[there] / area, 0, 1)
    middle_y = np.clip(moment_y[there] / area, 0, 1)
    x, y = x - middle_x, y - middle_y
    second, third = [1, 2, 0], [2, 0, 1]
    weights = np.maximum((x[second] * y[third] - x[third] * y[second]) / twice, 0)
    weights /= weights.sum(axis=0)
    return Pieces(
        face[there],
        (row * columns + column)[there],
        covered[there],
        2 * area / twice,
        weights,
    )


def _span(low: Vector, high: Vector, cells: int) -> tuple[Indices, Indices]:
    """The first and the last of the ``cells`` that reach from ``low`` to ``high``."""
    first = np.clip(np.floor(low).astype(np.intp), 0, cells - 1)
    last = np.clip(np.ceil(high).astype(np.intp) - 1, 0, cells - 1)
    return first, np.maximum(first, last)


def _extent(x: Vector, y: Vector, row: Indices) -> tuple[Vector, Vector]:
    """How far a triangle with corners ``x``, ``y`` (3, N) reaches along x within a row."""
    least, most = np.full((2, x.shape[1]), [[np.inf], [-np.inf]])
    for here, there in ((0, 1), (1, 2), (2, 0)):
        rise = y[there] - y[here]
        inverse = np.divide(1.0, rise, out=np.zeros_like(rise), where=rise != 0)
        high, low = np.maximum(y[here], y[there]), np.minimum(y[here], y[there])
        met = (high >= row) & (low <= row + 1)
        for line in (row, row + 1):
            at = x[here] + np.clip((line - y[here]) * inverse, 0, 1) * (x[there] - x[here])
            np.minimum(least, at, out=least, where=met)
            np.maximum(most, at, out=most, where=met)
    return least, most


def _spread(items: Indices, first: Indices, last: Indices) -> tuple[Indices, Indices]:
    """Each item as often as there are numbers from its first to its last, and those numbers."""
    counts = last - first + 1
    start = np.cumsum(counts) - counts
    return np.repeat(items, counts), np.arange(counts.sum()) + np.repeat(first - start, counts)


def _batches(counts: Indices, limit: int) -> Iterator[slice]:
    """Runs of items whose counts add up to ``limit`` at most, or single items of more."""
    total = np.concatenate([[0], np.cumsum(counts)])
    start = 0
    while start < len(counts):
        stop = int(np.searchsorted(total, total[start] + limit, "right")) - 1
        yield slice(start, max(stop, start + 1))
        start = max(stop, start + 1)
