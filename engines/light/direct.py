"""Direct light: the closed form for an unobstructed opening, times the share of it that is seen.

Opening and texel are integrated by a product rule, finer where the lamp is close. What the bodies
hide is found by shadow rays from places drawn anew in several replicates; where they disagree, near
the edges of shadows, more are cast, and their spread gives the interval.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.special import stdtrit

from ..core import runtime
from ..core.scene import Receiver
from .emission import bilinear, intensity_grid
from .grid import Chart
from .interval import CONFIDENCE
from .luminaires import Source
from .stage import BEHIND, MM, OFFSET_MM, OFFSET_SHARE, Stage
from .targets import Side

mi = runtime.mitsuba()
import drjit as dr  # noqa: E402  (loads LLVM: only after the runtime has chosen which)

Float, UInt32, Bool = mi.Float, mi.UInt32, mi.Bool

REPLICATES = 8
FIRST, MORE = 2, 64
"""Shadow rays a texel and replicate: to find the edges of shadows, and there."""
MARGIN = 2
FACE, PIECE = 16, 4
"""Floats a face: corners (9), texture coordinates of the first (2) and, from there, what makes of
them the shares of the second corner (2) and of the third (2). Numbers a piece: face, those two
shares at its centroid, its share of the texel's light."""
GAUSS = 0.5 / np.sqrt(3.0)
MOST_CUTS = 32


def direct_light(
    stage: Stage, side: Side, chart: Chart | None, source: Source, seed: tuple[int, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Illuminance (rows, columns) in lx of ``source`` on a side, and its 95 % half-width.

    ``chart`` is the map of a mesh, None for a plane.
    """
    spots = _PlaneSpots(stage, side) if chart is None else _MeshSpots(stage, side, chart)
    lit = _Light(stage, spots, source)
    shape = (side.receiver.rows, side.receiver.columns)
    every = spots.texels
    clear = np.zeros(every.shape) if source.distribution is None else lit.unobstructed(every)
    occluded = stage.scene is not None or len(stage.planes) > 1
    value, spread = np.zeros(shape[0] * shape[1]), np.zeros(shape[0] * shape[1])
    if not occluded and source.distribution is not None:
        value[every] = clear
        return value.reshape(shape), spread.reshape(shape)

    def shares(texels: NDArray[np.uint32], rays: int, stream: int) -> NDArray[np.float64]:
        seeds = np.random.SeedSequence((3, *seed, stream)).generate_state(REPLICATES)
        return np.array([lit.share(texels, rays, int(s)) for s in seeds])

    seen = shares(every, FIRST, 0)
    edges = np.zeros(value.shape, bool)
    edges[every] = seen.min(axis=0) != seen.max(axis=0)
    wide = np.asarray(binary_dilation(edges.reshape(shape), iterations=MARGIN), dtype=bool)
    mixed = wide.ravel()[every]
    if source.distribution is None:
        mixed |= spots.rim(source)
    share, doubt = seen.mean(axis=0), np.zeros(every.shape)
    if mixed.any():
        finer = shares(every[mixed], MORE, 1)
        share[mixed] = finer.mean(axis=0)
        quantile = float(stdtrit(REPLICATES - 1, 0.5 + CONFIDENCE / 2))
        doubt[mixed] = quantile * finer.std(axis=0, ddof=1) / np.sqrt(REPLICATES)
    scale = lit.exitance if source.distribution is None else clear
    value[every], spread[every] = share * scale, doubt * scale
    return value.reshape(shape), spread.reshape(shape)


def _fixed(vector: NDArray[np.float64]) -> Any:
    return mi.Vector3f(*(dr.opaque(Float, float(c)) for c in vector))


class _PlaneSpots:
    """Places on the texels of a plane, in stage space."""

    def __init__(self, stage: Stage, side: Side) -> None:
        receiver = side.receiver
        assert isinstance(receiver, Receiver)
        self.receiver = receiver
        self.texels = np.arange(receiver.rows * receiver.columns, dtype=np.uint32)
        self.corner = mi.Point3f(_fixed(stage.place(receiver.origin)))
        self.across = _fixed(receiver.u / receiver.columns * MM)
        self.along = _fixed(receiver.v / receiver.rows * MM)
        self.facing = _fixed(-receiver.normal if side.back else receiver.normal)
        self.lift = 0.0
        self.columns = dr.opaque(UInt32, receiver.columns)
        sides = [np.linalg.norm(receiver.u), np.linalg.norm(receiver.v)]
        self.size = float(max(sides[0] / receiver.columns, sides[1] / receiver.rows))

    def place(self, texel: Any, s: Any, t: Any) -> Any:
        """Places at (s, t) in 0..1 of each texel."""
        row = texel // self.columns
        column = texel - row * self.columns
        return self.corner + self.across * (Float(column) + s) + self.along * (Float(row) + t)

    def normal(self, texel: Any) -> Any:
        """The unit normal of the lit side."""
        return self.facing

    def drawn(self, texel: Any, random: Any) -> tuple[Any, Any]:
        """Places by chance on each texel, and what they weigh among others of the texel."""
        return self.place(texel, random.next_float32(), random.next_float32()), Float(1)

    def distance(self, place: NDArray[np.float64]) -> float:
        """From ``place`` to the nearest place of the receiver in m."""
        receiver = self.receiver
        way = place - receiver.origin
        share = [np.clip(way @ e / (e @ e), 0.0, 1.0) for e in (receiver.u, receiver.v)]
        return float(np.linalg.norm(way - share[0] * receiver.u - share[1] * receiver.v))

    def rim(self, source: Source) -> NDArray[np.bool_]:
        """Texels (T,) that the outline of a parallel beam crosses."""
        receiver = self.receiver
        s = (np.arange(receiver.columns) + 0.5) / receiver.columns
        t = (np.arange(receiver.rows) + 0.5) / receiver.rows
        places = receiver.origin + s[None, :, None] * receiver.u + t[:, None, None] * receiver.v
        reach = np.hypot(
            np.linalg.norm(receiver.u) / receiver.columns,
            np.linalg.norm(receiver.v) / receiver.rows,
        )
        return _rim(source, places.reshape(-1, 3), float(reach))


class _MeshSpots:
    """Places on the texels of a mesh: about their centroids on the plane of their mean normal, or,
    for shadows, drawn from the faces themselves."""

    def __init__(self, stage: Stage, side: Side, chart: Chart) -> None:
        texels = chart.texels
        self.receiver = side.receiver
        self.texels = np.flatnonzero(texels.area.ravel() > 0).astype(np.uint32)
        self.centres = texels.place.reshape(-1, 3)[self.texels]
        normals = texels.normal.reshape(-1, 3)
        self.size = float(np.sqrt(texels.area.max()))

        def filed(values: NDArray[np.floating]) -> Any:
            return Float(values.astype(np.float32).ravel())

        self._centre = filed(stage.place(texels.place.reshape(-1, 3)))
        self._normal = filed(-normals if side.back else normals)
        self._width = filed(np.sqrt(texels.area) * MM)
        # The back of a mesh stands back too.
        step = OFFSET_MM + OFFSET_SHARE * stage.reach
        self.lift = dr.opaque(Float, 2 * BEHIND * step if side.back else 0.0)
        self._map = [dr.opaque(UInt32, n) for n in texels.area.shape[::-1]]
        self._first = UInt32(chart.cut.first.astype(np.uint32))
        self._faces = filed(_faces(stage, chart))
        self._pieces = filed(_pieces(chart))

    def place(self, texel: Any, s: Any, t: Any) -> Any:
        """Places at (s, t) in 0..1 of each texel."""
        frame = mi.Frame3f(self.normal(texel))
        width = dr.gather(Float, self._width, texel)
        centre = dr.gather(mi.Point3f, self._centre, texel)
        return centre + (frame.s * (s - 0.5) + frame.t * (t - 0.5)) * width

    def normal(self, texel: Any) -> Any:
        """The unit normal of the lit side."""
        return dr.gather(mi.Vector3f, self._normal, texel)

    def drawn(self, texel: Any, random: Any) -> tuple[Any, Any]:
        """Places by chance on each texel's pieces, and what they weigh among others of the texel.

        A place of the texel where it is on the piece's face, else the piece's centroid.
        """
        width = dr.width(texel)
        first = dr.gather(UInt32, self._first, texel)
        count = dr.gather(UInt32, self._first, texel + 1) - first
        index = first + dr.minimum(UInt32(random.next_float32() * Float(count)), count - 1)
        piece = dr.gather(mi.ArrayXf, self._pieces, index, shape=(PIECE, width))
        number: Any = dr.reinterpret_array(UInt32, piece[0])
        face = dr.gather(mi.ArrayXf, self._faces, number, shape=(FACE, width))
        columns, rows = self._map
        row = texel // columns
        u = (Float(texel - row * columns) + random.next_float32()) / Float(columns) - face[9]
        v = (Float(row) + random.next_float32()) / Float(rows) - face[10]
        second, third = face[11] * u + face[12] * v, face[13] * u + face[14] * v
        on = (second >= 0) & (third >= 0) & (second + third <= 1)
        second, third = dr.select(on, second, piece[1]), dr.select(on, third, piece[2])
        a, b, c = (mi.Point3f(face[i], face[i + 1], face[i + 2]) for i in (0, 3, 6))
        return a + second * (b - a) + third * (c - a), piece[3]

    def distance(self, place: NDArray[np.float64]) -> float:
        """From ``place`` to the nearest texel in m."""
        return float(np.sqrt(np.square(self.centres - place).sum(axis=1).min()))

    def rim(self, source: Source) -> NDArray[np.bool_]:
        """Texels (T,) that the outline of a parallel beam crosses."""
        return _rim(source, self.centres, self.size * 2**0.5)


def _faces(stage: Stage, chart: Chart) -> NDArray[np.float64]:
    mesh, texture = chart.surface.mesh, chart.surface.texture
    rows = np.zeros((len(mesh.faces), FACE))
    rows[:, :9] = stage.place(mesh.vertices[mesh.faces]).reshape(-1, 9)
    rows[:, 9:11] = texture[:, 0]
    (a, b), (c, d) = (texture[:, 1:] - texture[:, :1]).transpose(2, 1, 0)
    twice = a * d - b * c
    inverse = np.stack([d, -b, -c, a], axis=1)
    # No share is 0 or more where a face has no area in the map.
    rows[:, 11:15] = np.nan
    np.divide(inverse, twice[:, None], out=rows[:, 11:15], where=twice[:, None] != 0)
    return rows


def _pieces(chart: Chart) -> NDArray[np.float32]:
    cut = chart.cut
    rows = np.column_stack([cut.face, cut.weights[:, 1:], cut.share]).astype(np.float32)
    rows[:, 0] = cut.face.astype(np.uint32).view(np.float32)
    return rows


class _Light:
    """One source and the spots that it lights, on the device."""

    def __init__(self, stage: Stage, spots: _PlaneSpots | _MeshSpots, source: Source) -> None:
        self.stage, self.spots, self.source = stage, spots, source
        self.lamp = mi.Point3f(_fixed(stage.place(source.origin)))
        self.axes = [_fixed(axis) for axis in source.axes.T]
        self.half = [source.length * MM / 2, source.width * MM / 2]
        self.exitance = source.flux / source.area if source.distribution is None else 0.0
        if source.distribution is not None:
            grid = intensity_grid(source.distribution)
            self.shape = [dr.opaque(UInt32, n) for n in grid.shape]
            self.intensity = Float(grid.ravel())

    def from_opening(self, place: Any, normal: Any, x: Any, y: Any) -> tuple[Any, Any, Any]:
        """Illuminance in lx that the whole flux would give from (x, y) mm, direction, distance."""
        start = self.lamp + self.axes[0] * x + self.axes[1] * y
        ray = place - start
        distance = dr.norm(ray)
        ray /= distance
        facing = dr.maximum(-dr.dot(ray, normal), 0)
        return self.toward(ray) * facing / dr.square(distance / MM), ray, distance

    def toward(self, ray: Any) -> Any:
        """Luminous intensity in cd along unit vectors, bilinear in the fine grid."""
        x, y, z = (dr.dot(ray, axis) for axis in self.axes)
        gamma = dr.atan2(dr.sqrt(x * x + y * y), -z)
        turn = dr.atan2(y, x)
        turn = dr.select(turn < 0, turn + dr.two_pi, turn)
        return bilinear(self.intensity, self.shape, gamma, turn)

    def unobstructed(self, texels: NDArray[np.uint32]) -> NDArray[np.float64]:
        """The closed form: illuminance (T,) in lx with nothing in the way."""
        rule = _rule(self.source, self.spots)
        table = Float(rule.astype(np.float32).ravel())
        texel = UInt32(texels)
        normal = self.spots.normal(texel)

        def add(k: Any, total: Any) -> tuple[Any, Any]:
            s, t, x, y, weight = (dr.gather(Float, table, 5 * k + i) for i in range(5))
            place = self.spots.place(texel, s, t)
            lux, _, _ = self.from_opening(place, normal, x * MM, y * MM)
            return k + 1, total + lux * weight

        count = dr.opaque(UInt32, len(rule))
        start = dr.zeros(UInt32, len(texels)), dr.zeros(Float, len(texels))
        _, total = dr.while_loop(start, lambda k, total: k < count, add, label="direct")
        return total.numpy().astype(np.float64)

    def share(self, texels: NDArray[np.uint32], rays: int, seed: int) -> NDArray[np.float64]:
        """Share (T,) of the direct light that arrives, from ``rays`` places a texel."""
        texel = UInt32(texels)
        scrambled = mi.sample_tea_32(dr.opaque(UInt32, seed), texel)
        random = mi.PCG32(initstate=mi.UInt64(scrambled[0]), initseq=mi.UInt64(scrambled[1]))
        beam = self.source.distribution is None
        # A plane does not shade itself, whatever float32 makes of a place on it.
        others = [p for p in self.stage.planes if p.receiver is not self.spots.receiver]
        normal = self.spots.normal(texel)

        def add(k: Any, whole: Any, seen: Any, random: Any) -> tuple[Any, ...]:
            place, weight = self.spots.drawn(texel, random)
            if beam:
                lux, ray, distance = self.from_beam(place, normal)
            else:
                x, y = self.on_opening(random)
                lux, ray, distance = self.from_opening(place, normal, x, y)
            start = place + normal * self.spots.lift - ray * 1e-2
            visible = Bool(True)
            for plane in others:
                visible &= ~plane.blocks(start, -ray, distance - 2e-2)
            if self.stage.scene is not None:
                back = mi.Ray3f(start, -ray, distance - 2e-2, 0.0, [])
                visible &= ~self.stage.scene.ray_test(back, active=lux > 0)
            whole += weight if beam else weight * lux
            return k + 1, whole, seen + dr.select(visible, weight * lux, 0), random

        count = dr.opaque(UInt32, rays)
        zero = dr.zeros(Float, len(texels))
        start = dr.zeros(UInt32, len(texels)), zero, Float(zero), random
        end = dr.while_loop(start, lambda k, *_: k < count, add, label="shadows")
        whole, seen = end[1].numpy().astype(np.float64), end[2].numpy().astype(np.float64)
        return np.divide(seen, whole, out=np.zeros_like(seen), where=whole > 0)

    def on_opening(self, random: Any) -> tuple[Any, Any]:
        """A place on the opening in mm, even over its area."""
        if self.source.shape == "point":
            return Float(0), Float(0)
        point = mi.Point2f(random.next_float32(), random.next_float32())
        if self.source.shape == "round":
            point = mi.warp.square_to_uniform_disk_concentric(point)
        else:
            point = 2 * point - 1
        return point.x * self.half[0], point.y * self.half[1]

    def from_beam(self, place: Any, normal: Any) -> tuple[Any, Any, Any]:
        """Cosine where the parallel beam passes, 0 elsewhere; its direction and the way come."""
        ray = -self.axes[2]
        offset = place - self.lamp
        x, y = (dr.dot(offset, a) / h for a, h in zip(self.axes, self.half, strict=False))
        distance = dr.dot(offset, ray)
        inside = (
            x * x + y * y < 1 if self.source.shape == "round" else dr.maximum(abs(x), abs(y)) < 1
        )
        facing = dr.maximum(-dr.dot(ray, normal), 0)
        return dr.select(inside & (distance > 0), facing, 0), ray, distance


def _rule(source: Source, spots: _PlaneSpots | _MeshSpots) -> NDArray[np.float64]:
    """A product rule (P, 5): place in the texel (2) in 0..1, on the opening (2) in m, and weight.

    Texels are cut until a tenth of the lamp's distance holds one, openings until they are no
    larger than it: 0.1 % down to a distance of a tenth of the opening, for a 25° beam.
    """
    distance = max(spots.distance(source.origin), 1e-6)
    cuts = int(np.clip(np.ceil(10 * spots.size / distance), 1, MOST_CUTS))
    inner = np.concatenate([(np.arange(cuts) + 0.5 + shift) / cuts for shift in (-GAUSS, GAUSS)])
    within = np.stack(np.meshgrid(inner, inner), axis=-1).reshape(-1, 2)
    points, weights = _opening_rule(source, distance)
    return np.column_stack(
        [
            np.tile(within, (len(points), 1)),
            np.repeat(points, len(within), axis=0),
            np.repeat(weights, len(within)) / len(within),
        ]
    )


def _opening_rule(
    source: Source, distance: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points (P, 2) m on the opening and weights that add up to 1."""
    half = np.array([source.length, source.width]) / 2
    if source.shape == "point":
        return np.zeros((1, 2)), np.ones(1)
    finer = int(np.clip(np.ceil(2 * half.max() / distance), 1, 6))
    if source.shape == "rectangular":
        x, w = np.polynomial.legendre.leggauss(12)
        x = ((np.arange(finer)[:, None] * 2 + 1 + x) / finer - 1).ravel()
        w = np.tile(w, finer) / finer
        points = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2)
        return points * half, (w[:, None] * w[None, :]).ravel() / 4
    # Even in r², Gauss along it; a regular polygon of directions is exact to its last harmonic.
    x, w = np.polynomial.legendre.leggauss(8 * finer)
    around = 16 * finer
    radius, turn = np.sqrt((x + 1) / 2), np.arange(around) * 2 * np.pi / around
    points = radius[:, None, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return points.reshape(-1, 2) * half, np.repeat(w / 2, around) / around


def _rim(source: Source, places: NDArray[np.float64], reach: float) -> NDArray[np.bool_]:
    """Which ``places`` (T, 3) are within ``reach`` m of the outline of a parallel beam."""
    local = np.abs((places - source.origin) @ source.axes[:, :2])
    half = np.array([source.length, source.width]) / 2
    if source.shape == "round":
        radius = np.linalg.norm(local, axis=1)
        return np.abs(radius - half[0]) <= reach
    outer = (local <= half + reach).all(axis=1)
    return outer & ~(local < half - reach).all(axis=1)
