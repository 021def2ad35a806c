"""Scans of a printed sample whose truth is known. Shares no code with the engines.

The piece is cut from a tube: a cylinder of `radius`, a wall of `wall`, an arc of `arc` and a height
of `height`. Both faces carry beads: circular arcs whose valleys are filled by a fillet, and a
roughness whose spectrum is written down. Millimetres throughout. The scanner's noise, doubled
shells, holes, stray faces and outliers come on top, and everything is turned and moved.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class Piece:
    """What is scanned, and how badly. Lengths in mm, angles in degrees."""

    seed: int = 0
    points: int = 400_000
    noise: float = 0.05
    radius: float = 104.0  # 0 is a flat piece
    wall: float = 8.0
    arc: float = 73.0
    height: float = 49.0
    period: float = 5.0
    sag: float = 1.2
    depth: float = 0.933  # after the fillet; 0 is a smooth wall
    tilt: float = 2.0
    roughness: float = 0.02
    corner: float = 8.0  # wavelength at which the roughness begins to fall off
    steep: float = 3.0  # how quickly: glass that was liquid has few short waves
    shells: float = 0.03  # how far the second pass of the scanner is off; 0 is a single pass
    broken: int = 300  # faces doubled, vertices doubled, faces that hang on an edge
    holes: int = 6
    outliers: float = 0.004
    missing: float = 0.06  # share of the arc that a slanted edge takes away
    inner: bool = True
    inner_depth: float = 1.0  # of the beads on the inner face, over those on the outer
    outer: bool = True
    edges: bool = True
    turned: bool = True


@dataclass(frozen=True)
class Truth:
    """The piece without the scanner: what its reading is compared with."""

    piece: Piece
    pose: np.ndarray  # (3, 3) from piece to file
    shift: np.ndarray
    fields: tuple["Field", "Field"]
    offset: float  # phase at arc 0, z 0

    @property
    def axis(self) -> np.ndarray:
        return self.pose @ [0.0, 0.0, 1.0]

    @property
    def layer_normal(self) -> np.ndarray:
        """What is square to the layers in the middle of the piece, in the file's axes."""
        a = np.radians(self.piece.tilt)
        return self.pose @ [0.0, np.sin(a), np.cos(a)]

    def figures(self):
        """Layer height, depth and tilt in mm and degrees, at the mean radius of the outer face."""
        a, piece = np.radians(self.piece.tilt), self.piece
        relief = profile(piece, np.linspace(0, 1, 2000, endpoint=False))
        share = piece.radius / (piece.radius + relief.mean()) if piece.radius else 1.0
        wave = np.array([np.sin(a) * share, np.cos(a)]) / piece.period
        tilt = np.degrees(np.arctan2(*wave)) if piece.radius else 0.0
        return {"layer_height": 1 / np.hypot(*wave), "depth": piece.depth, "tilt": tilt}

    def phase(self, arc, z):
        a = np.radians(self.piece.tilt)
        return (z * np.cos(a) + arc * np.sin(a)) / self.piece.period + self.offset

    def lift(self, arc, z, side):
        """Height over the base surface, mm, positive out of the glass."""
        relief = profile(self.piece, self.phase(arc, z))
        relief = relief * self.piece.inner_depth if side else relief
        return relief + self.fields[side].at(arc, z)

    def surface(self, arc, z, side=0, smooth=False):
        """Points (N, 3) in the piece's own axes. Arc is measured on the outer base surface."""
        lift = 0 if smooth else self.lift(arc, z, side)
        out = -self.piece.wall - lift if side else lift
        if not self.piece.radius:
            return np.column_stack([out, arc, z])
        radius, angle = self.piece.radius + out, arc / self.piece.radius
        return np.column_stack(
            [radius * np.cos(angle) - self.piece.radius, radius * np.sin(angle), z]
        )

    def normals(self, arc, z, side=0, step=5e-3):
        """Unit normals out of the glass, by central differences, in the piece's own axes."""
        along = self.surface(arc + step, z, side) - self.surface(arc - step, z, side)
        up = self.surface(arc, z + step, side) - self.surface(arc, z - step, side)
        cross = np.cross(along, up) * (-1 if side else 1)
        return cross / np.linalg.norm(cross, axis=1)[:, None]

    def to_file(self, points):
        return points @ self.pose.T + self.shift

    def to_piece(self, points):
        """Arc, z and how far out a place in the file is."""
        x, y, z = ((points - self.shift) @ self.pose).T
        if not self.piece.radius:
            return y, z, x
        x = x + self.piece.radius
        return np.arctan2(y, x) * self.piece.radius, z, np.hypot(x, y) - self.piece.radius


@dataclass(frozen=True)
class Field:
    """A Gaussian random field of known spectrum, periodic over `size` mm."""

    values: np.ndarray
    size: float

    def at(self, arc, z):
        scale = len(self.values) / self.size
        places = np.stack([np.asarray(arc) * scale, np.asarray(z) * scale])
        return map_coordinates(self.values, places, order=3, mode="grid-wrap")


def density(piece: Piece, frequency):
    """The roughness's spectral density in mm² per (cycle/mm)² at a frequency in cycles/mm."""
    shape = (1 + (frequency * piece.corner) ** 2) ** -piece.steep * (frequency < 1.0)
    return piece.roughness**2 * shape / (_below(piece, 1.0) - _below(piece, 0.0))


def _below(piece: Piece, frequency: float) -> float:
    """∫ 2πk (1 + (ck)²)⁻ˢ dk up to a frequency, but for a constant."""
    power = 1 - piece.steep
    return np.pi / piece.corner**2 * (1 + (piece.corner * frequency) ** 2) ** power / power


def octave_rms(piece: Piece, shortest: float, longest: float) -> float:
    """RMS in mm of the roughness between two wavelengths in mm, by its spectrum's integral."""
    low, high = min(1.0, 1 / longest), min(1.0, 1 / shortest)
    share = (_below(piece, high) - _below(piece, low)) / (_below(piece, 1.0) - _below(piece, 0.0))
    return piece.roughness * float(np.sqrt(share))


def random_field(piece: Piece, rng) -> Field:
    size, count = 160.0, 1024
    k = np.fft.fftfreq(count, size / count)
    power = density(piece, np.hypot(*np.meshgrid(k, k))) / size**2
    white = np.fft.fft2(rng.normal(size=(count, count))) / count
    return Field(np.fft.ifft2(white * np.sqrt(power)).real * count**2, size)


def profile(piece: Piece, phase):
    """The bead: an arc of a circle through the boundaries, its valleys filled to `depth`."""
    if not piece.depth:
        return np.zeros_like(phase)
    h, s = piece.period, piece.sag
    radius = (h * h / 4 + s * s) / (2 * s)
    across = (np.asarray(phase) % 1.0 - 0.5) * h
    arc = np.sqrt(radius**2 - across**2) - radius + s
    fill = s - piece.depth
    if fill <= 0:
        return arc
    # A fillet of radius f outside the bead touches both arcs; its lowest point is at `fill`:
    # centre (h/2, c): (h/2)² + (c − centre of bead)² = (radius + f)², c − f = fill
    top = radius - s  # depth of the bead's centre below the boundary
    f = (h * h / 4 + (fill + top) ** 2 - radius**2) / (2 * (radius - fill - top))
    away = h / 2 - np.abs(across)
    touch = h / 2 * f / (radius + f)
    valley = fill + f - np.sqrt(np.maximum(f * f - away**2, 0))
    return np.where(away < touch, valley, arc)


def scan(piece: Piece) -> tuple[np.ndarray, np.ndarray, Truth]:
    """Vertices (V, 3) in mm, faces (F, 3), and the truth."""
    rng = np.random.default_rng(piece.seed)
    pose, shift = np.eye(3), np.zeros(3)
    if piece.turned:
        pose = Rotation.random(random_state=np.random.RandomState(piece.seed)).as_matrix()
        shift = rng.uniform(-300, 300, 3)
    fields = (random_field(piece, rng), random_field(piece, rng))
    truth = Truth(piece, pose, shift, fields, rng.uniform())
    sheets = _sheets(piece, truth, rng)
    vertices = np.concatenate([v for v, _ in sheets])
    starts = np.cumsum([0] + [len(v) for v, _ in sheets])
    faces = np.concatenate([f + start for (_, f), start in zip(sheets, starts, strict=False)])
    vertices, faces = _holed(piece, vertices, faces, rng)
    vertices, faces = _broken(piece, vertices, faces, rng)
    return truth.to_file(vertices), faces, truth


def _sheets(piece, truth, rng):
    sides = [side for side, on in ((0, piece.outer), (1, piece.inner)) if on]
    area = len(sides) * piece.arc * piece.height * (1.3 if piece.shells else 1.0)
    step = np.sqrt(area / piece.points)
    sheets = []
    for side in sides:
        sheets.append(_face(piece, truth, side, -piece.arc / 2, piece.arc / 2, step, rng))
        if piece.shells:
            middle = rng.uniform(-0.2, 0.2) * piece.arc
            half = 0.15 * piece.arc
            points, faces = _face(piece, truth, side, middle - half, middle + half, step, rng)
            off = rng.normal(size=3)
            sheets.append((points + piece.shells * off / np.linalg.norm(off), faces))
    if piece.edges and len(sides) == 2:
        sheets += _cuts(piece, truth, step, rng)
    return sheets


def _face(piece, truth, side, low, high, step, rng):
    columns, rows = int((high - low) / step) + 1, int(piece.height / step) + 1
    arc, z = np.meshgrid(
        np.linspace(low, high, columns), np.linspace(-piece.height / 2, piece.height / 2, rows)
    )
    inside = rng.uniform(-0.35, 0.35, (2, *arc.shape)) * step
    arc, z = (arc + inside[0]).ravel(), (z + inside[1]).ravel()
    points = truth.surface(arc, z, side)
    points += truth.normals(arc, z, side) * rng.normal(size=(len(arc), 1)) * piece.noise
    faces = _grid(rows, columns)
    if side:
        faces = faces[:, ::-1]
    return _slanted(piece, points, faces, arc, z)


def _slanted(piece, points, faces, arc, z):
    """Without the corner that the scanner did not see."""
    edge = piece.arc * (0.5 - piece.missing * (1 + 2 * z / piece.height))
    seen = arc <= edge
    return _kept(points, faces, seen)


def _kept(points, faces, seen):
    number = np.cumsum(seen) - 1
    return points[seen], number[faces[seen[faces].all(axis=1)]]


def _cuts(piece, truth, step, rng):
    """The sawn edges: below, above, left and right, straight through the wall."""
    through = np.linspace(0, 1, int(piece.wall / step) + 1)
    sheets = []
    for vertical in (False, True):
        length = piece.height if vertical else piece.arc
        along = np.linspace(-length / 2, length / 2, int(length / step) + 1)
        a, t = np.meshgrid(along, through)
        a, t = a.ravel(), t.ravel()
        for end in (-0.5, 0.5):
            fixed = np.full(len(a), end * (piece.arc if vertical else piece.height))
            arc, z = (fixed, a) if vertical else (a, fixed)
            points = truth.surface(arc, z, 0) * (1 - t)[:, None]
            points += truth.surface(arc, z, 1) * t[:, None]
            points += rng.normal(size=points.shape) * piece.noise
            faces = _grid(len(through), len(along))
            sheets.append(_slanted(piece, points, faces, arc, z))
    return sheets


def _grid(rows, columns):
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    lower, upper = np.stack([a, b, c], -1), np.stack([a, c, d], -1)
    return np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3)])


def _holed(piece, vertices, faces, rng):
    seen = np.ones(len(vertices), dtype=bool)
    for centre in vertices[rng.integers(len(vertices), size=piece.holes)]:
        seen &= ((vertices - centre) ** 2).sum(axis=1) > rng.uniform(0.5, 3.0) ** 2
    return _kept(vertices, faces, seen)


def _broken(piece, vertices, faces, rng):
    """Doubled faces and vertices, faces that hang on an edge or have no area, flakes in the air."""
    n = piece.broken
    if n:
        doubled = faces[rng.integers(len(faces), size=n)]
        torn = rng.integers(len(faces), size=n)
        copies = vertices[faces[torn, 0]]
        hung = vertices[faces[torn, 1]] + rng.normal(size=(n, 3)) * 0.3
        places = len(vertices) + np.arange(2 * n)
        hanging = np.column_stack([faces[torn, 1:], places[n:]])
        empty = np.repeat(faces[torn, :1], 3, axis=1)
        faces[torn, 0] = places[:n]
        vertices = np.concatenate([vertices, copies, hung])
        faces = np.concatenate([faces, doubled, hanging, empty])
    m = int(piece.outliers * len(vertices))
    if m:
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        room = 0.2 * (high - low)
        stray = rng.uniform(low - room, high + room, (m, 3))
        near = vertices[rng.integers(len(vertices), size=m)] + rng.normal(size=(m, 3)) * 0.8
        stray = np.where(rng.uniform(size=(m, 1)) < 0.5, stray, near)
        flakes = np.stack([stray, stray + 0.1, stray + np.array([0.1, 0, 0])], axis=1)
        faces = np.concatenate([faces, len(vertices) + np.arange(3 * m).reshape(-1, 3)])
        vertices = np.concatenate([vertices, flakes.reshape(-1, 3)])
    return vertices, faces
