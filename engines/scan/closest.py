"""The closest places on a mesh of triangles, for a million points in seconds.

Anchors lie on the triangles, several on a large or slender one; a tree of them says which triangles
are likely to be the closest, and to those the distance is exact.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ..core.progress import SILENT, Progress
from ..core.scene import Mesh, Vector

Indices = NDArray[np.int32]

_BATCH = 1 << 16
_LIKELY = 6  # anchors whose triangles are measured to
_ANCHORS = 100_000  # about how many of them a mesh of few triangles gets
_SLENDER = 3.0  # longest edge of an anchor's part over the root of its fair share of the area
_ON_EDGE = 1e-6  # of two faces as close, the one that looks at the point gives the sign


@dataclass(frozen=True, slots=True)
class Target:
    """A mesh to measure to.

    ``mesh`` is of triangles with area; ``normals`` (F, 3) float64 their unit normals. ``tree``
    holds anchors, ``owner`` (A,) names the triangle each lies on, ``reach`` (A,) is how far in m
    its part of the triangle goes from it. ``frames`` (F, 15) are corner, two sides, normal and
    the sides' products.
    """

    mesh: Mesh
    normals: Vector
    tree: KDTree
    owner: Indices
    reach: Vector
    frames: Vector

    @property
    def anchors(self) -> Vector:
        """The anchors (A, 3) in m."""
        return np.asarray(self.tree.data)

    @property
    def areas(self) -> Vector:
        """The triangles' areas (F,) in m²."""
        uu, uv, vv = self.frames[:, 12:].T
        return np.sqrt(np.maximum(uu * vv - uv * uv, 0.0)) / 2

    def sample(self, count: int, rng: np.random.Generator) -> tuple[Vector, NDArray[np.intp]]:
        """``count`` points (N, 3) spread evenly at random over the surface, and their faces."""
        face = rng.choice(len(self.frames), count, p=self.areas / self.areas.sum())
        s, t = rng.random((2, count, 1))
        s, t = np.where(s + t > 1, (1 - s, 1 - t), (s, t))
        frame = self.frames[face]
        return frame[:, :3] + s * frame[:, 3:6] + t * frame[:, 6:9], face


@dataclass(frozen=True, slots=True)
class Feet:
    """The closest places of N points.

    ``place`` (N, 3) in m; ``face`` (N,) the triangle; ``distance`` (N,) in m, positive on the side
    that the face looks to; ``toward`` (N, 3) the unit vector along which the distance grows. Of a
    point that is too far away: itself, −1, the farthest that was asked for, and 0.
    """

    place: Vector
    face: Indices
    distance: Vector
    toward: Vector


def target_of(mesh: Mesh) -> Target:
    """What `closest` needs of a mesh; triangles without area are left out."""
    mesh = mesh.triangles()
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    twice = np.sqrt((cross * cross).sum(axis=1))
    longest = np.sqrt(np.max([((q - p) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))], 0))
    solid = twice > 1e-12 * longest**2
    mesh = Mesh(mesh.vertices, mesh.faces[solid])
    a, u, v, longest = a[solid], (b - a)[solid], (c - a)[solid], longest[solid]
    normals = cross[solid] / twice[solid, None]
    products = [np.einsum("fi,fi->f", *pair) for pair in ((u, u), (u, v), (v, v))]
    frames = np.column_stack([a, u, v, normals, *products])
    fair = np.sqrt(twice[solid].sum() / 2 / max(len(a), _ANCHORS))
    anchors, owner, reach = _anchors(mesh.vertices[mesh.faces], _SLENDER * fair)
    return Target(mesh, normals, KDTree(anchors), owner, reach, frames)


def _anchors(corners: Vector, longest: float) -> tuple[Vector, Indices, Vector]:
    """The middles of the triangles' parts (A, 3), whose they are, and how far the parts go.

    Triangles (F, 3, 3) are halved across their longest edge until none is over ``longest``.
    """
    owner = np.arange(len(corners), dtype=np.int32)
    found = []
    while len(corners):
        edges = corners[:, [1, 2, 0]] - corners
        squares = np.einsum("fij,fij->fi", edges, edges)
        large = squares.max(axis=1) > longest**2
        found.append((corners[~large], owner[~large]))
        side = squares[large].argmax(axis=1)[:, None]
        p, q, r = (
            np.take_along_axis(corners[large], (side[..., None] + turn) % 3, axis=1)[:, 0]
            for turn in range(3)
        )
        half = (p + q) / 2
        corners = np.concatenate([np.stack([p, half, r], 1), np.stack([half, q, r], 1)])
        owner = np.tile(owner[large], 2)
    corners, owner = (np.concatenate(part) for part in zip(*found, strict=True))
    middle = corners.mean(axis=1)
    return middle, owner, np.sqrt(((corners - middle[:, None]) ** 2).sum(axis=2).max(axis=1))


def closest(
    points: Vector, target: Target, within: float = np.inf, progress: Progress = SILENT
) -> Feet:
    """The closest place on the target of each of the points (N, 3) in m, ``within`` that many m.

    The distance is exact to the triangles of the six nearest anchors; on a printed wall a few
    points in ten thousand are closer to another, by microns. Where the closest place is on an
    edge, the face that the point is seen from most squarely gives the sign.

    Raises Cancelled when ``progress`` is asked to stop.
    """
    place, toward = points.astype(np.float64), np.zeros((len(points), 3))
    face, distance = np.full(len(points), -1, np.int32), np.full(len(points), within)
    workers = -1 if len(points) > _BATCH // 8 else 1  # threads cost more than a few points
    likely = [*range(1, min(_LIKELY, len(target.owner)) + 1)]
    for start in range(0, len(points), _BATCH):
        progress(start / len(points), f"{start:,} of {len(points):,} points")
        away, anchor = target.tree.query(
            points[start : start + _BATCH], likely, distance_upper_bound=within, workers=workers
        )
        some = np.flatnonzero(np.isfinite(away[:, 0]))
        away, anchor = away[some], anchor[some]
        anchor = np.where(np.isfinite(away), anchor, anchor[:, :1])
        some += start
        face[some], uv = _best(points[some], away, anchor, target)
        frame = target.frames[face[some]]
        place[some] = frame[:, :3] + uv[:, :1] * frame[:, 3:6] + uv[:, 1:] * frame[:, 6:9]
        distance[some], toward[some] = _signed(points[some] - place[some], frame[:, 9:12])
    return Feet(place, face, distance, toward)


def _signed(apart: Vector, normal: Vector) -> tuple[Vector, Vector]:
    """The distance with the sign that the ``normal`` gives it, and where to it grows."""
    length = np.sqrt(np.einsum("ij,ij->i", apart, apart))
    sign = np.where(np.einsum("ij,ij->i", apart, normal) < 0, -1.0, 1.0)
    clear = length > 1e-9
    direction = apart * (sign / np.where(clear, length, 1.0))[:, None]
    return sign * length, np.where(clear[:, None], direction, normal)


def _best(
    points: Vector, away: Vector, anchor: NDArray[np.intp], target: Target
) -> tuple[Indices, Vector]:
    """Of the triangles of ``anchor`` (N, K), as far ``away`` (N, K), the closest, and where on it,
    in its sides (N, 2).
    """
    first = target.owner[anchor[:, 0]]
    uv, square, weighed = _measured(points, target.frames[first])
    closer = away - target.reach[anchor] < np.sqrt(square)[:, None]
    closer &= target.owner[anchor] != first[:, None]
    row, column = np.nonzero(closer)
    if not len(row):
        return first, uv
    other = target.owner[anchor[row, column]]
    uv_other, _, weighed_other = _measured(points[row], target.frames[other])
    start = np.flatnonzero(np.diff(row, prepend=-1))
    least = np.minimum.reduceat(weighed_other, start)
    won = least < weighed[row[start]]
    is_it = weighed_other == np.repeat(np.where(won, least, -1.0), np.diff(start, append=len(row)))
    better, there = row[is_it][::-1], np.flatnonzero(is_it)[::-1]
    first = first.copy()
    first[better], uv[better] = other[there], uv_other[there]
    return first, uv


def _measured(points: Vector, frames: Vector) -> tuple[Vector, Vector, Vector]:
    """The closest place on a triangle each, in its sides (M, 2), the distance squared, and that
    made a hair less for a triangle that is seen squarely.
    """
    apart = points - frames[:, :3]
    along = np.einsum("ij,ij->i", apart, frames[:, 3:6])
    across = np.einsum("ij,ij->i", apart, frames[:, 6:9])
    height = np.einsum("ij,ij->i", apart, frames[:, 9:12])
    uu, uv, vv = frames[:, 12:15].T
    scale = 1 / (uu * vv - uv * uv)
    s, t = (vv * along - uv * across) * scale, (uu * across - uv * along) * scale
    level = height * height
    square = level.copy()
    out = np.flatnonzero((s < 0) | (t < 0) | (s + t > 1))
    if len(out):
        s[out], t[out], beside = _on_edges(s[out], t[out], uu[out], uv[out], vv[out])
        square[out] += beside
    return np.column_stack([s, t]), square, square - _ON_EDGE * level


def _on_edges(s: Vector, t: Vector, uu: Vector, uv: Vector, vv: Vector) -> tuple[Vector, ...]:
    """The closest places on the triangles' edges, and how far they are, squared."""
    on_u = np.clip(s + t * uv / uu, 0.0, 1.0)
    on_v = np.clip(t + s * uv / vv, 0.0, 1.0)
    slant = uu - 2 * uv + vv
    on_w = np.clip(((s - 1) * (uv - uu) + t * (vv - uv)) / slant, 0.0, 1.0)
    zero = np.zeros_like(s)
    options = ((on_u, zero), (zero, on_v), (1 - on_w, on_w))
    gaps = [(s - p, t - q) for p, q in options]
    squares = np.stack([uu * x * x + 2 * uv * x * y + vv * y * y for x, y in gaps])
    which = squares.argmin(axis=0)
    picked = (np.choose(which, [option[i] for option in options]) for i in (0, 1))
    return (*picked, np.choose(which, squares))
