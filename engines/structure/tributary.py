"""Loads on the cells between members, brought to the members around each cell."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..core.errors import SceneError
from ..core.scene import Vector
from .frame import Frame
from .model import NO_NODE

_ALIKE = 1e-9  # of two directions: their edges are taken for parallel
_PAIRS = ((0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, slots=True)
class Tributary:
    """How the cells of a frame lean on its members.

    ``weights`` (2 M, F): the line load in N/m at the start (row 2m) and the end (row 2m + 1) of
    member m for a pressure of 1 N/m² on a cell; ``vectors`` (F, 3) in m²: each cell's area along
    its normal, exact for a warped cell too; ``centres`` (F, 3) in m: the cells' centroids;
    ``members`` (M,) in m²: the area that each member carries.

    A warped cell is measured where it is flattened onto its mean plane.
    """

    weights: csr_array
    vectors: Vector
    corners: Vector
    centres: Vector
    members: Vector

    @property
    def areas(self) -> Vector:
        """The cells' areas (F,) in m²."""
        return np.linalg.norm(self.vectors, axis=1)

    @property
    def normals(self) -> Vector:
        """The cells' unit normals (F, 3)."""
        return self.vectors / np.maximum(self.areas, 1e-300)[:, None]

    @property
    def slopes(self) -> Vector:
        """Plan area over true area of each cell (F,)."""
        return np.abs(self.normals[:, 2])

    def line_loads(self, pressures: Vector) -> Vector:
        """Line loads (..., M, 2, 3) in N/m from ``pressures`` (..., F, 3) in N/m² of true area."""
        flat = np.moveaxis(pressures, -2, 0)
        cases = flat.shape[1:]
        lines = self.weights @ flat.reshape(len(flat), -1)
        return np.moveaxis(lines.reshape(-1, 2, *cases), (0, 1), (-3, -2))


def tributary_of(frame: Frame, cells: NDArray[np.int32]) -> Tributary:
    """How ``cells`` (F, 4), the last NO_NODE in a triangle, lean on the members of ``frame``.

    Within a cell every point goes to the nearest edge, by the bisectors of its corners (the roof
    over the cell); each edge's triangle or trapezium becomes the linear load of the same force and
    place. Edges without a member leave theirs to the others in proportion. A correction that is
    linear over the cell, the least in the mean square, then brings the resultant to the cell's
    centroid: force and moment are those of the pressure to rounding, but for a cell whose members
    lie on one line, which keeps the force, and for the height of a warped cell out of its mean
    plane. In a cell that is not convex the edges first share by their lengths.

    Raises SceneError for a cell none of whose edges is a member.
    """
    count = len(frame.members)
    nodes = np.where(cells == NO_NODE, cells[:, [0, 1, 2, 2]], cells)
    member, turned = _members_along(frame, nodes)
    corners = frame.nodes[nodes]
    vectors = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
    flat, basis, origin = _flattened(corners, vectors)
    lengths = np.linalg.norm(np.roll(flat, -1, axis=1) - flat, axis=2)
    loaded = (member >= 0) & (lengths > 0)
    bare = ~loaded.any(axis=1)
    if bare.any():
        first = int(np.argmax(bare))
        around = ", ".join(str(n) for n in cells[first] if n != NO_NODE)
        raise SceneError(
            f"Cell {first} (nodes {around}) has no member on any of its edges; "
            "leave it out or draw a member along one."
        )
    areas = np.linalg.norm(vectors, axis=1)
    centroids = _centroids(flat)
    shares = _balanced(flat, lengths, loaded, _roofs(flat, lengths), areas, centroids)

    at, edge = np.nonzero(loaded)
    found = member[at, edge]
    along = np.where(turned[at, edge, None], shares[at, edge, ::-1], shares[at, edge])
    along = along * (lengths[at, edge] / frame.lengths()[found])[:, None]
    rows = 2 * found[:, None] + np.arange(2)
    columns = np.repeat(at, 2)
    weights = csr_array((along.ravel(), (rows.ravel(), columns)), shape=(2 * count, len(cells)))
    carried = weights.sum(axis=1).reshape(-1, 2).sum(axis=1) * frame.lengths() / 2
    centres = origin + np.einsum("fk,fki->fi", centroids, basis)
    return Tributary(weights, vectors, corners, centres, carried)


def _members_along(frame: Frame, nodes: NDArray) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """For each cell's edges (F, 4) the member, -1 where none, and whether it runs the other way."""
    count = np.int64(len(frame.nodes))
    ends = np.sort(frame.members, axis=1).astype(np.int64)
    keys = ends[:, 0] * count + ends[:, 1]
    order = np.argsort(keys, kind="stable")
    after = np.roll(nodes, -1, axis=1)
    low, high = np.minimum(nodes, after).astype(np.int64), np.maximum(nodes, after)
    wanted = low * count + high
    place = np.minimum(np.searchsorted(keys[order], wanted), len(keys) - 1)
    member = order[place]
    member = np.where(keys[member] == wanted, member, -1)
    return member, frame.members[member, 0] != nodes


def _flattened(corners: Vector, vectors: Vector) -> tuple[Vector, Vector, Vector]:
    """Corners (F, 4, 2) in each cell's mean plane, the plane's axes (F, 2, 3) and origin (F, 3)."""
    normal = vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1e-300)[:, None]
    first: Vector = corners[:, 2] - corners[:, 0]
    first = first - (first * normal).sum(axis=1)[:, None] * normal
    first = first / np.maximum(np.linalg.norm(first, axis=1), 1e-300)[:, None]
    basis = np.stack([first, np.cross(normal, first)], axis=1)
    origin = corners.mean(axis=1)
    return (corners - origin[:, None]) @ basis.swapaxes(1, 2), basis, origin


def _dot(a: Vector, b: Vector) -> Vector:
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _centroids(flat: Vector) -> Vector:
    """Centroids (F, 2) of the flattened cells."""
    after = np.roll(flat, -1, axis=1)
    parts = _cross(flat, after)
    area = parts.sum(axis=1)
    moments = np.einsum("fc,fck->fk", parts, flat + after)
    return moments / np.where(area > 0, 3 * area, 1.0)[:, None]


def _roofs(flat: Vector, lengths: Vector) -> Vector:
    """The breadth (F, 4, 2) in m that falls to the start and end of each edge, linear between.

    Measured from edge i, s along it and d inward, edge j is (a + b s + c d) away, so the region
    nearest to i lies below d = (a + b s) / (1 − c) for each j: the least of three lines, integrated
    exactly between the points where they cross.
    """
    after = np.roll(flat, -1, axis=1)
    along = (after - flat) / np.where(lengths > 0, lengths, 1.0)[..., None]
    inward = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    far = 1e3 * np.abs(flat).max(axis=(1, 2))[:, None]
    lines = []
    for step in (1, 2, 3):
        other = np.roll(inward, -step, axis=1)
        opening = 1 - _dot(other, inward)
        beside = (opening > _ALIKE) & (np.roll(lengths, -step, axis=1) > 0)
        divisor = np.where(beside, opening, 1.0)
        level = np.where(beside, _dot(other, flat - np.roll(flat, -step, axis=1)) / divisor, far)
        lines.append((level, np.where(beside, _dot(other, along) / divisor, 0.0)))

    first, second, third = (_crossing(lines[i], lines[j], lengths) for i, j in _PAIRS)
    low, high = np.minimum(first, second), np.maximum(first, second)
    places = [
        np.zeros_like(lengths),
        np.minimum(low, third),
        np.maximum(low, np.minimum(high, third)),
        np.maximum(high, third),
        lengths,
    ]
    heights = [
        np.maximum(np.minimum.reduce([level + slope * place for level, slope in lines]), 0.0)
        for place in places
    ]
    force, moment = np.zeros_like(lengths), np.zeros_like(lengths)
    for (s, h), (t, k) in pairwise(zip(places, heights, strict=True)):
        force += (t - s) * (h + k) / 2
        moment += (t - s) * (s * h + t * k + (s + t) * (h + k)) / 6
    length = np.where(lengths > 0, lengths, 1.0)
    mean, lean = force / length, moment / length**2
    breadth = np.stack([4 * mean - 6 * lean, 6 * lean - 2 * mean], axis=-1)
    convex = (_cross(along, np.roll(along, -1, axis=1)) > -_ALIKE).all(axis=1)
    return np.where(convex[:, None, None], breadth, 1.0)


def _crossing(one: tuple[Vector, Vector], other: tuple[Vector, Vector], lengths: Vector) -> Vector:
    """Where two lines, each a level and a slope, cross between 0 and ``lengths``; else an end."""
    fall = one[1] - other[1]
    apart = np.abs(fall) > _ALIKE
    place = np.where(apart, (other[0] - one[0]) / np.where(apart, fall, 1.0), 0.0)
    return np.minimum(np.maximum(place, 0.0), lengths)


def _balanced(
    flat: Vector,
    lengths: Vector,
    loaded: NDArray,
    breadth: Vector,
    areas: Vector,
    centroids: Vector,
) -> Vector:
    """``breadth`` (F, 4, 2) on the loaded edges, scaled to the area and moved to the centroid."""
    length = np.where(loaded, lengths, 0.0)
    force = (length * breadth.sum(axis=2)).sum(axis=1) / 2
    scaled = np.where(loaded[..., None], breadth, 0.0)
    scaled = scaled * (areas / np.where(force > 0, force, 1.0))[:, None, None]

    start, end = flat, np.roll(flat, -1, axis=1)
    centre = np.einsum("fe,fek->fk", length, start + end) / 2 / length.sum(axis=1)[:, None]
    start, end = start - centre[:, None], end - centre[:, None]
    # ∫ of a product of two functions that are linear along an edge: L/6 · [2 1; 1 2].
    by_start = length[..., None] * (2 * start + end) / 6
    by_end = length[..., None] * (start + 2 * end) / 6
    arms = np.concatenate([start, end], axis=1)
    weighed = np.concatenate([by_start, by_end], axis=1)
    inertia = arms.swapaxes(1, 2) @ weighed
    placed = np.concatenate([scaled[..., 0], scaled[..., 1]], axis=1)
    missing = areas[:, None] * (centroids - centre) - (placed[:, None] @ weighed)[:, 0]
    added = (arms @ _solved(inertia, missing)[..., None])[..., 0]
    return scaled + np.where(loaded[:, None], added.reshape(-1, 2, 4), 0.0).swapaxes(1, 2)


def _solved(matrix: Vector, right: Vector) -> Vector:
    """The least x (F, 2) with ``matrix`` (F, 2, 2) x = ``right``, also where it has rank one."""
    trace = matrix[:, 0, 0] + matrix[:, 1, 1]
    determinant = matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0]
    full = determinant > _ALIKE * trace**2
    adjugate = trace[:, None, None] * np.eye(2) - matrix
    inverse = adjugate / np.where(full, determinant, 1.0)[:, None, None]
    single = matrix / np.where(trace > 0, trace, 1.0)[:, None, None] ** 2
    return np.einsum("fij,fj->fi", np.where(full[:, None, None], inverse, single), right)
