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
from .emission import intensity_grid
from .interval import CONFIDENCE
from .luminaires import Source
from .stage import MM, Stage

mi = runtime.mitsuba()
import drjit as dr  # noqa: E402  (loads LLVM: only after the runtime has chosen which)

Float, UInt32, Bool = mi.Float, mi.UInt32, mi.Bool

REPLICATES = 8
FIRST, MORE = 2, 64
"""Shadow rays a texel and replicate: to find the edges of shadows, and there."""
MARGIN = 2
GAUSS = 0.5 / np.sqrt(3.0)
MOST_CUTS = 32


def direct_light(
    stage: Stage, receiver: Receiver, source: Source, seed: tuple[int, ...]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Illuminance (rows, columns) in lx of ``source`` on ``receiver``, and its 95 % half-width."""
    lit = _Light(stage, receiver, source)
    shape = (receiver.rows, receiver.columns)
    every = np.arange(receiver.rows * receiver.columns, dtype=np.uint32)
    clear = np.zeros(every.shape) if source.distribution is None else lit.unobstructed(every)
    if stage.scene is None and source.distribution is not None:
        return clear.reshape(shape), np.zeros(shape)

    def shares(texels: NDArray[np.uint32], rays: int, stream: int) -> NDArray[np.float64]:
        seeds = np.random.SeedSequence((3, *seed, stream)).generate_state(REPLICATES)
        return np.array([lit.share(texels, rays, int(s)) for s in seeds])

    seen = shares(every, FIRST, 0)
    edges = (seen.min(axis=0) != seen.max(axis=0)).reshape(shape)
    mixed = np.asarray(binary_dilation(edges, iterations=MARGIN), dtype=bool).ravel()
    if source.distribution is None:
        mixed |= _rim(source, receiver)
    value, spread = seen.mean(axis=0), np.zeros(every.shape)
    if mixed.any():
        finer = shares(every[mixed], MORE, 1)
        value[mixed] = finer.mean(axis=0)
        quantile = float(stdtrit(REPLICATES - 1, 0.5 + CONFIDENCE / 2))
        spread[mixed] = quantile * finer.std(axis=0, ddof=1) / np.sqrt(REPLICATES)
    scale = lit.exitance if source.distribution is None else clear
    return (value * scale).reshape(shape), (spread * scale).reshape(shape)


class _Light:
    """One source and one receiver on the device."""

    def __init__(self, stage: Stage, receiver: Receiver, source: Source) -> None:
        def fixed(vector: NDArray[np.float64]) -> Any:
            return mi.Vector3f(*(dr.opaque(Float, float(c)) for c in vector))

        self.stage, self.receiver, self.source = stage, receiver, source
        self.corner = mi.Point3f(fixed(stage.place(receiver.origin)))
        self.across = fixed(receiver.u / receiver.columns * MM)
        self.along = fixed(receiver.v / receiver.rows * MM)
        self.normal = fixed(receiver.normal)
        self.lamp = mi.Point3f(fixed(stage.place(source.origin)))
        self.axes = [fixed(axis) for axis in source.axes.T]
        self.half = [source.length * MM / 2, source.width * MM / 2]
        self.columns = dr.opaque(UInt32, receiver.columns)
        self.exitance = source.flux / source.area if source.distribution is None else 0.0
        if source.distribution is not None:
            grid = intensity_grid(source.distribution)
            self.shape = [dr.opaque(UInt32, n) for n in grid.shape]
            self.intensity = Float(grid.ravel())

    def place(self, texel: Any, s: Any, t: Any) -> Any:
        """Places in stage space at (s, t) in 0..1 of each texel."""
        row = texel // self.columns
        column = texel - row * self.columns
        return self.corner + self.across * (Float(column) + s) + self.along * (Float(row) + t)

    def from_opening(self, place: Any, x: Any, y: Any) -> tuple[Any, Any, Any]:
        """Illuminance in lx that the whole flux would give from (x, y) mm, direction, distance."""
        start = self.lamp + self.axes[0] * x + self.axes[1] * y
        ray = place - start
        distance = dr.norm(ray)
        ray /= distance
        facing = dr.maximum(-dr.dot(ray, self.normal), 0)
        return self.toward(ray) * facing / dr.square(distance / MM), ray, distance

    def toward(self, ray: Any) -> Any:
        """Luminous intensity in cd along unit vectors, bilinear in the fine grid."""
        x, y, z = (dr.dot(ray, axis) for axis in self.axes)
        rows, columns = self.shape
        gamma = dr.atan2(dr.sqrt(x * x + y * y), -z) / dr.pi * Float(rows - 1)
        turn = dr.atan2(y, x) / dr.two_pi
        turn = (turn - dr.floor(turn)) * Float(columns - 1)
        i, j = dr.minimum(UInt32(gamma), rows - 2), dr.minimum(UInt32(turn), columns - 2)
        u, v = gamma - Float(i), turn - Float(j)
        low, high = i * columns + j, (i + 1) * columns + j
        near = dr.lerp(
            dr.gather(Float, self.intensity, low), dr.gather(Float, self.intensity, low + 1), v
        )
        far = dr.lerp(
            dr.gather(Float, self.intensity, high), dr.gather(Float, self.intensity, high + 1), v
        )
        return dr.lerp(near, far, u)

    def unobstructed(self, texels: NDArray[np.uint32]) -> NDArray[np.float64]:
        """The closed form: illuminance (T,) in lx with nothing in the way."""
        rule = _rule(self.source, self.receiver)
        table = Float(rule.astype(np.float32).ravel())
        texel = UInt32(texels)

        def add(k: Any, total: Any) -> tuple[Any, Any]:
            s, t, x, y, weight = (dr.gather(Float, table, 5 * k + i) for i in range(5))
            lux, _, _ = self.from_opening(self.place(texel, s, t), x * MM, y * MM)
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

        def add(k: Any, whole: Any, seen: Any, random: Any) -> tuple[Any, ...]:
            place = self.place(texel, random.next_float32(), random.next_float32())
            if beam:
                lux, ray, distance = self.from_beam(place)
            else:
                x, y = self.on_opening(random)
                lux, ray, distance = self.from_opening(place, x, y)
            visible = Bool(True)
            if self.stage.scene is not None:
                back = mi.Ray3f(place - ray * 1e-2, -ray, distance - 2e-2, 0.0, [])
                visible = ~self.stage.scene.ray_test(back, active=lux > 0)
            return k + 1, whole + (1 if beam else lux), seen + dr.select(visible, lux, 0), random

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

    def from_beam(self, place: Any) -> tuple[Any, Any, Any]:
        """Cosine where the parallel beam passes, 0 elsewhere; its direction and the way come."""
        ray = -self.axes[2]
        offset = place - self.lamp
        x, y = (dr.dot(offset, a) / h for a, h in zip(self.axes, self.half, strict=False))
        distance = dr.dot(offset, ray)
        inside = (
            x * x + y * y < 1 if self.source.shape == "round" else dr.maximum(abs(x), abs(y)) < 1
        )
        facing = dr.maximum(-dr.dot(ray, self.normal), 0)
        return dr.select(inside & (distance > 0), facing, 0), ray, distance


def _rule(source: Source, receiver: Receiver) -> NDArray[np.float64]:
    """A product rule (P, 5): place in the texel (2) in 0..1, on the opening (2) in m, and weight.

    Texels are cut until a tenth of the lamp's distance holds one, openings until they are no
    larger than it: 0.1 % down to a distance of a tenth of the opening, for a 25° beam.
    """
    distance = max(_distance(source, receiver), 1e-6)
    sides = np.array([np.linalg.norm(receiver.u), np.linalg.norm(receiver.v)])
    texel = float((sides / (receiver.columns, receiver.rows)).max())
    cuts = int(np.clip(np.ceil(10 * texel / distance), 1, MOST_CUTS))
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


def _distance(source: Source, receiver: Receiver) -> float:
    """From the opening's centre to the nearest place of the receiver in m."""
    way = source.origin - receiver.origin
    share = [np.clip(way @ e / (e @ e), 0.0, 1.0) for e in (receiver.u, receiver.v)]
    return float(np.linalg.norm(way - share[0] * receiver.u - share[1] * receiver.v))


def _rim(source: Source, receiver: Receiver) -> NDArray[np.bool_]:
    """Texels (T,) that the outline of a parallel beam crosses."""
    s = (np.arange(receiver.columns) + 0.5) / receiver.columns
    t = (np.arange(receiver.rows) + 0.5) / receiver.rows
    place = receiver.origin + s[None, :, None] * receiver.u + t[:, None, None] * receiver.v
    local = np.abs((place - source.origin) @ source.axes[:, :2]).reshape(-1, 2)
    half = np.array([source.length, source.width]) / 2
    reach = np.hypot(
        np.linalg.norm(receiver.u) / receiver.columns, np.linalg.norm(receiver.v) / receiver.rows
    )
    if source.shape == "round":
        radius = np.linalg.norm(local, axis=1)
        return np.abs(radius - half[0]) <= reach
    outer = (local <= half + reach).all(axis=1)
    return outer & ~(local < half - reach).all(axis=1)
