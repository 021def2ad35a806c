"""Printed pieces and scans of them whose truth is known. Shares no code with the engines.

A piece is a wall around r(θ) = radius (1 + a₁ cos(k₁θ + p₁) + a₂ cos(k₂θ + p₂)), wider toward the
top by `taper`, of layers that bulge as parabolas on both sides. A scan of it sees some of it, with
noise, strays and holes, from anywhere. Metres and radians throughout.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class Piece:
    """A wall; `wall` goes from crest to crest, `layers` is how many there are."""

    radius: float = 0.1
    waves: tuple[tuple[int, float, float], ...] = ((2, 0.07, 0.3), (5, 0.03, 1.0))
    taper: float = 0.06
    layers: int = 24
    layer: float = 5e-3
    sag: float = 1.2e-3
    wall: float = 8e-3
    uneven: float = 0.0  # standard deviation of the layer heights
    bulge: tuple[float, float, float, float] | None = None  # angle, z, height, width (σ)
    seed: int = 0

    @property
    def floors(self) -> np.ndarray:
        """The layers' boundaries, one more than there are layers."""
        more = np.random.default_rng(self.seed).normal(0, self.uneven, self.layers)
        return np.concatenate([[0.0], np.cumsum(self.layer + more - more.mean())])

    @property
    def height(self) -> float:
        return float(self.floors[-1])

    def plan(self, angle, z):
        """The wall's middle and its outward normal in plan, (N, 2) each."""
        r, slope = np.ones_like(angle), np.zeros_like(angle)
        for count, size, phase in self.waves:
            r = r + size * np.cos(count * angle + phase)
            slope = slope - size * count * np.sin(count * angle + phase)
        grown = self.radius * (1 + self.taper * z / self.height)
        out = np.stack([np.cos(angle), np.sin(angle)], -1)
        on = np.stack([-np.sin(angle), np.cos(angle)], -1)
        normal = r[..., None] * out - slope[..., None] * on
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        return (grown * r)[..., None] * out, normal

    def sunk(self, z):
        """How far the faces lie behind the crests."""
        floors = self.floors
        layer = np.clip(np.searchsorted(floors, z, "right") - 1, 0, self.layers - 1)
        across = (z - floors[layer]) / (floors[layer + 1] - floors[layer])
        return self.sag * (2 * across - 1) ** 2

    def bulged(self, angle, z):
        """How far the outside stands out beyond what was meant."""
        if self.bulge is None:
            return np.zeros_like(z)
        where, level, height, width = self.bulge
        arc = self.radius * (np.mod(angle - where + np.pi, 2 * np.pi) - np.pi)
        return height * np.exp(-(arc**2 + (z - level) ** 2) / (2 * width**2))

    def face(self, angle, z, side):
        """Points (N, 3) on the outside, `side` 1, the inside, −1, or between."""
        middle, normal = self.plan(angle, z)
        out = side * (self.wall / 2 - self.sunk(z)) + (side > 0) * self.bulged(angle, z)
        return np.concatenate([middle + out[..., None] * normal, z[..., None]], -1)

    def mesh(self, around: int = 480, steps: int = 6):
        """Vertices and quadrilaterals of the closed surface."""
        floors = self.floors
        z = np.concatenate([np.linspace(a, b, steps, False) for a, b in pairwise(floors)])
        z = np.append(z, floors[-1])
        levels = np.concatenate([z, z[::-1]])
        sides = np.repeat([1.0, -1.0], len(z))
        angle = np.arange(around) * (2 * np.pi / around)
        grid = np.broadcast_arrays(angle[None], levels[:, None], sides[:, None])
        vertices = self.face(*grid).reshape(-1, 3)
        k, n = np.arange(len(levels))[:, None], np.arange(around)[None]
        after, ahead = (k + 1) % len(levels), (n + 1) % around
        corners = (k * around + n, k * around + ahead, after * around + ahead, after * around + n)
        return vertices, np.stack(corners, -1).reshape(-1, 4).astype(np.int32)


@dataclass(frozen=True)
class Scanner:
    """What is seen of a piece, and how badly."""

    points: int = 100_000
    noise: float = 5e-5
    outliers: float = 0.05
    missing: float = 0.3  # share of the surface
    inside: bool = False
    rims: bool = True
    turned: bool = True
    seed: int = 1

    def pose(self):
        """The matrix (4, 4) from the piece to the file."""
        rng = np.random.default_rng(self.seed + 100)
        pose = np.eye(4)
        if self.turned:
            pose[:3, :3] = Rotation.random(rng=rng).as_matrix()
            pose[:3, 3] = rng.uniform(-0.5, 0.5, 3)
        return pose

    def scan(self, piece: Piece):
        """Points (N, 3) in the file's place, in the order of the scanner's whim."""
        rng = np.random.default_rng(self.seed)
        count = int(self.points * (1 - self.outliers))
        wanted = int(count / (1 - self.missing) * 1.1) + 1000
        angle, z = rng.uniform(0, 2 * np.pi, wanted), rng.uniform(0, piece.height, wanted)
        side = np.where(rng.random(wanted) < (0.5 if self.inside else 0.0), -1.0, 1.0)
        if self.rims:
            rim = rng.random(wanted) < 2 * piece.wall / (2 * piece.height)
            z = np.where(rim, np.where(rng.random(wanted) < 0.5, 0.0, piece.height), z)
            side = np.where(rim, rng.uniform(-1, 1, wanted), side)
        seen = self.seen(angle, z, piece, rng)
        points = piece.face(angle[seen], z[seen], side[seen])[:count]
        points = points + rng.normal(0, self.noise, points.shape)
        low, high = points.min(0), points.max(0)
        strays = rng.uniform(low - 0.02, high + 0.02, (self.points - count, 3))
        points = np.concatenate([points, strays])
        points = points[rng.permutation(len(points))]
        pose = self.pose()
        return points @ pose[:3, :3].T + pose[:3, 3]

    def seen(self, angle, z, piece, rng):
        """Holes: a slice of a sixth at most, and round ones until enough is missing."""
        slice_ = min(self.missing, 1 / 6)
        seen = np.mod(angle - rng.uniform(0, 7), 2 * np.pi) > 2 * np.pi * slice_
        while seen.mean() > 1 - self.missing:
            where, level = rng.uniform(0, 2 * np.pi), rng.uniform(0, piece.height)
            arc = piece.radius * (np.mod(angle - where + np.pi, 2 * np.pi) - np.pi)
            seen &= np.hypot(arc, z - level) > 0.02
        return seen


ROUND = Piece(waves=(), taper=0.0)


def apart(matrix, pose):
    """How far a found matrix is from undoing a pose: metres at the origin's place, and radians."""
    rest = matrix @ pose
    return np.linalg.norm(rest[:3, 3]), Rotation.from_matrix(rest[:3, :3]).magnitude()


def changed(piece: Piece, **differences) -> Piece:
    return replace(piece, **differences)
