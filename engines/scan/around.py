"""Around a wall: where a point lies along the wall's outline, and how far in front of it.

The outline is that of the design's outer side, at the layers' crests, at as many heights as it
needs; what is along it is even in length, whatever the plan.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.spatial import KDTree

from ..core.scene import Mesh, Vector

_LEVELS = 25
_MARGIN = 0.02  # of the height, that levels stay away from the ends
_POINTS = 2048  # on an outline
_STRAIGHT = 2e-5  # m; outlines that differ by less are one
_AT_LEAST = 0.8  # of the levels must have an outline


@dataclass(frozen=True, slots=True)
class Around:
    """The outlines (K, N, 2) in m of a wall at ``levels`` (K,) in m, counter-clockwise.

    Points are evenly spaced; the first ones lie above one another, the lowest where the outline
    is farthest in +X from its middle. ``girth`` is the mean length in m.
    """

    levels: Vector
    outlines: Vector
    girth: float

    def unroll(self, points: Vector) -> tuple[Vector, Vector]:
        """Of points (N, 3) in m, the share of a turn along the outline, 0..1, and how far they
        stand out of it in m, (N,) each.
        """
        turn, offset = np.empty(len(points)), np.empty(len(points))
        place = np.interp(points[:, 2], self.levels, np.arange(len(self.levels), dtype=float))
        below = np.minimum(place.astype(int), max(len(self.levels) - 2, 0))
        for index in np.unique(below):
            some = np.flatnonzero(below == index)
            plan = points[some, :2]
            turn[some], offset[some] = _beside(self.outlines[index], plan)
            if len(self.levels) > 1:
                share = place[some] - index
                turn_up, offset_up = _beside(self.outlines[index + 1], plan)
                gap = np.mod(turn_up - turn[some] + 0.5, 1.0) - 0.5
                turn[some] = np.mod(turn[some] + share * gap, 1.0)
                offset[some] += share * (offset_up - offset[some])
        return turn, offset

    def outward(self, points: Vector) -> Vector:
        """The nearest outline's outward unit normals in plan (N, 2) beside points (N, 3) in m."""
        place = np.interp(points[:, 2], self.levels, np.arange(len(self.levels), dtype=float))
        level = np.round(place).astype(int)
        out = np.empty((len(points), 2))
        for index in np.unique(level):
            some = np.flatnonzero(level == index)
            line = self.outlines[index]
            at = KDTree(line).query(points[some, :2], workers=-1)[1]
            side = line[(at + 1) % len(line)] - line[at - 1]
            out[some] = np.column_stack([side[:, 1], -side[:, 0]]) / np.hypot(*side.T)[:, None]
        return out


def around_of(mesh: Mesh, pitch: float = 0.0) -> Around | None:
    """The outlines of a wall that stands upright, None where it has none.

    ``pitch`` is its layer height in m: outlines are then taken half-way up a layer.
    """
    low, high = mesh.vertices[:, 2].min(), mesh.vertices[:, 2].max()
    levels = np.linspace(low, high, _LEVELS + 2)[1:-1]
    if pitch:
        levels = low + pitch * (np.floor((levels - low) / pitch) + 0.5)
    room = _MARGIN * (high - low)
    levels = np.unique(levels[(levels > low + room) & (levels < high - room)])
    mesh = mesh.triangles()
    found = [(z, line) for z in levels if (line := _outline(mesh, z)) is not None]
    if len(found) < max(1, _AT_LEAST * len(levels)):
        return None
    first, *rest = (line for _, line in found)
    lines = [_from(first, first.mean(axis=0) + np.array([1e3, 0.0]))]
    for line in rest:
        lines.append(_from(line, lines[-1][0]))
    outlines = np.stack(lines)
    heights = np.array([z for z, _ in found])
    tree = KDTree(outlines[0])
    if all(np.abs(_beside(outlines[0], line, tree)[1]).max() < _STRAIGHT for line in outlines):
        outlines, heights = outlines[:1], heights[:1]
    steps = np.linalg.norm(outlines - np.roll(outlines, 1, axis=1), axis=2)
    return Around(heights, outlines, float(steps.sum(axis=1).mean()))


def _outline(mesh: Mesh, level: float) -> Vector | None:
    """The outline (N, 2) of the largest part of a mesh's section at a height."""
    vertices, faces = mesh.vertices, mesh.faces
    above = vertices[:, 2] >= level
    cut = faces[(above[faces].sum(axis=1) % 3) > 0]
    crossing = above[cut] != above[np.roll(cut, -1, axis=1)]
    edges = np.stack([cut, np.roll(cut, -1, axis=1)], axis=-1)[crossing]
    edges = np.where(above[edges[:, :1]], edges[:, ::-1], edges)
    a, b = vertices[edges[:, 0]], vertices[edges[:, 1]]
    share = ((level - a[:, 2]) / (b[:, 2] - a[:, 2]))[:, None]
    ends = (a[:, :2] + share * (b[:, :2] - a[:, :2])).reshape(-1, 2, 2)
    ends = ends[(ends[:, 0] != ends[:, 1]).any(axis=1)]
    if not len(ends):
        return None
    lines = np.asarray(shapely.linestrings(ends))
    parts = shapely.get_parts(shapely.polygonize(lines))
    whole = shapely.get_parts(shapely.union_all(parts))
    if not len(whole):
        return None
    ring = shapely.get_exterior_ring(whole[shapely.area(whole).argmax()])
    corners = shapely.get_coordinates(ring)
    if not shapely.is_ccw(ring):
        corners = corners[::-1]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    even = np.arange(_POINTS) * (along[-1] / _POINTS)
    return np.column_stack([np.interp(even, along, column) for column in corners.T])


def _from(line: Vector, place: Vector) -> Vector:
    """A closed line (N, 2) that starts nearest to a place (2,)."""
    return np.roll(line, -int(((line - place) ** 2).sum(axis=1).argmin()), axis=0)


def _beside(line: Vector, plan: Vector, tree: KDTree | None = None) -> tuple[Vector, Vector]:
    """The share of a turn and the distance, positive outside, of places (N, 2) by a closed line."""
    count = len(line)
    tree = tree or KDTree(line)
    nearest = tree.query(plan, workers=-1)[1]
    best = np.full(len(plan), np.inf)
    turn, offset = np.zeros(len(plan)), np.zeros(len(plan))
    for back in (1, 0):
        start = (nearest - back) % count
        side = line[(start + 1) % count] - line[start]
        length = np.hypot(*side.T)
        apart = plan - line[start]
        along = np.clip((apart * side).sum(axis=1) / length**2, 0.0, 1.0)
        rest = apart - along[:, None] * side
        away = np.hypot(*rest.T)
        out = apart[:, 0] * side[:, 1] - apart[:, 1] * side[:, 0]
        closer = away < best
        best = np.where(closer, away, best)
        turn = np.where(closer, np.mod((start + along) / count, 1.0), turn)
        offset = np.where(closer, np.where(out < 0, -away, away), offset)
    return turn, offset
