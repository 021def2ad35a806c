"""Photons from the luminaires through the glass onto the receiver: one loop, batch by batch."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.scene import Receiver
from .emission import Emitter, draw
from .stage import KINDS, RECORD, Stage
from .tally import FATES, ROUTES, Landing

mi = runtime.mitsuba()
import drjit as dr  # noqa: E402  (loads LLVM: only after the runtime has chosen which)

from . import surfaces  # noqa: E402

Float, UInt32, Bool = mi.Float, mi.UInt32, mi.Bool

LANDED, ABSORBED, ESCAPED, CUT_OFF = FATES.values()
DIRECT, CAUSTIC, INDIRECT = ROUTES.values()
ROULETTE_FROM = 32
SURVIVAL = 0.9
LONGEST = 512
OFFSET_MM = 1e-3
OFFSET_SHARE = 2e-6
NEAR = 2.0
"""Times the largest coordinate: the corner of a cube is √3 away."""


def step_of(stage: Stage) -> float:
    """How far in mm a photon is set off a surface that it leaves: a few float32 steps."""
    return OFFSET_MM + OFFSET_SHARE * stage.reach


class Plane:
    """A receiver on the device, in stage space."""

    def __init__(self, receiver: Receiver, stage: Stage) -> None:
        def fixed(vector: NDArray[np.float64]) -> Any:
            return mi.Vector3f(*(dr.opaque(Float, float(c)) for c in vector))

        u, v = receiver.u * 1000.0, receiver.v * 1000.0
        self.origin = mi.Point3f(fixed(stage.place(receiver.origin)))
        self.normal = fixed(receiver.normal)
        # Rows of the inverse: dot with a place on the plane gives its texture coordinate.
        self.to_u, self.to_v = fixed(u / (u @ u)), fixed(v / (v @ v))
        self.slack = dr.opaque(Float, 2 * step_of(stage))

    def meet(self, origin: Any, direction: Any) -> tuple[Any, Any, Any, Any]:
        """Distance (inf where missed), u, v and whether it is met from the gathering side."""
        facing = dr.dot(direction, self.normal)
        height = dr.dot(origin - self.origin, self.normal)
        distance = dr.maximum(-height / facing, 0)
        offset = origin + distance * direction - self.origin
        u, v = dr.dot(offset, self.to_u), dr.dot(offset, self.to_v)
        # A photon that has just left glass on the plane may stand a step behind it.
        ahead = dr.select(facing < 0, height > -self.slack, height < -self.slack)
        met = ahead & (u >= 0) & (u < 1) & (v >= 0) & (v < 1)
        return dr.select(met, distance, dr.inf), u, v, facing < 0


@dataclass
class Photon:
    """The state that travels through the loop, a photon a lane."""

    origin: Any
    direction: Any
    weight: Any
    active: Any
    bounces: Any
    route: Any
    fate: Any
    u: Any
    v: Any
    gained: Any
    random: Any
    light: Any


def trace_batch(
    stage: Stage, plane: Plane, emitter: Emitter, count: int, polarised: bool, seed: tuple[int, ...]
) -> Landing:
    """Send ``count`` photons of one luminaire and follow each to its end."""
    cell = mi.UInt32(draw(emitter.emission, count, np.random.default_rng((1, *seed))))
    key = int(np.random.SeedSequence((2, *seed)).generate_state(1)[0])
    scrambled = mi.sample_tea_32(dr.opaque(UInt32, key), dr.arange(UInt32, count))
    random = mi.PCG32(initstate=mi.UInt64(scrambled[0]), initseq=mi.UInt64(scrambled[1]))
    origin, direction, weight = emitter.emit(cell, random)
    origin = _near(origin, direction, stage)
    state = Photon(
        origin=origin,
        direction=direction,
        weight=weight,
        active=weight > 0,
        bounces=dr.zeros(UInt32, count),
        route=dr.full(UInt32, DIRECT, count),
        fate=dr.full(UInt32, ESCAPED, count),
        u=dr.zeros(Float, count),
        v=dr.zeros(Float, count),
        gained=dr.zeros(Float, count),
        random=random,
        light=surfaces.unpolarised(direction) if polarised else (),
    )
    (end,) = dr.while_loop(
        (state,), lambda p: p.active, lambda p: (_step(p, stage, plane),), label="photons"
    )
    dr.eval(end.fate, end.route, end.u, end.v, end.weight, end.gained)
    return Landing(
        *(a.numpy() for a in (end.fate, end.route, end.u, end.v, end.weight, end.gained))
    )


def _near(origin: Any, direction: Any, stage: Stage) -> Any:
    """Start photons of far lamps where they come near the scene: float32 is fine only there."""
    ahead = -dr.dot(mi.Vector3f(origin), direction) - NEAR * stage.reach
    return origin + dr.maximum(ahead, 0) * direction


def _step(p: Photon, stage: Stage, plane: Plane) -> Photon:
    """From one surface to the next."""
    distance, u, v, front = plane.meet(p.origin, p.direction)
    if stage.scene is None:
        landed = p.active & dr.isfinite(distance)
        fate = dr.select(landed, dr.select(front, UInt32(LANDED), UInt32(ABSORBED)), p.fate)
        return replace(p, fate=fate, u=u, v=v, active=Bool(False))

    # Glass that lies on the plane comes before it.
    ray = mi.Ray3f(p.origin, p.direction, distance + plane.slack, 0.0, [])
    hit = stage.scene.ray_intersect_preliminary(ray, coherent=False, active=p.active)
    met = p.active & hit.is_valid()
    on_plane = p.active & ~met & dr.isfinite(distance)
    fate = dr.select(on_plane, dr.select(front, UInt32(LANDED), UInt32(ABSORBED)), p.fate)
    p = replace(
        p, fate=fate, u=dr.select(on_plane, u, p.u), v=dr.select(on_plane, v, p.v), active=met
    )
    return _roulette(_scatter(p, stage, hit))


def _scatter(p: Photon, stage: Stage, hit: Any) -> Photon:
    """Reflect, refract or absorb the photons that met a body."""
    row = dr.gather(
        mi.ArrayXf, stage.triangles, hit.prim_index, p.active, shape=(RECORD, dr.width(hit.t))
    )
    s, t = hit.prim_uv.x, hit.prim_uv.y
    smooth = dr.normalize(
        mi.Vector3f(*(row[i] * (1 - s - t) + row[i + 3] * s + row[i + 6] * t for i in range(3)))
    )
    flat = mi.Vector3f(row[9], row[10], row[11])
    outside = dr.dot(p.direction, flat) < 0
    # A smooth normal that faces away from the ray would turn the surface inside out.
    smooth = dr.select((dr.dot(p.direction, smooth) < 0) == outside, smooth, flat)
    meeting = surfaces.Meeting(
        p.direction, smooth, flat, outside, row[13], row[14], row[15], p.random, p.active, p.light
    )
    first, *others = (name for name in KINDS if name in stage.kinds)
    outcome = surfaces.SCATTER[first](meeting)
    for name in others:
        of_kind = row[12] == KINDS.index(name)
        outcome = dr.select(of_kind, surfaces.SCATTER[name](meeting), outcome)

    absorbed = p.active & outcome.absorbed
    # Leave the surface by a few float32 steps to the side where the photon goes on.
    step = step_of(stage)
    place = p.origin + hit.t * p.direction
    place += dr.select(outside == outcome.through, -step, step) * flat
    specular = dr.maximum(p.route, UInt32(CAUSTIC))
    return replace(
        p,
        origin=dr.select(p.active, place, p.origin),
        direction=dr.select(p.active, outcome.direction, p.direction),
        fate=dr.select(absorbed, UInt32(ABSORBED), p.fate),
        route=dr.select(p.active, dr.select(outcome.matte, UInt32(INDIRECT), specular), p.route),
        bounces=p.bounces + 1,
        active=p.active & ~absorbed,
        light=outcome.light,
    )


def _roulette(p: Photon) -> Photon:
    """End long paths by chance, without bias: survivors carry on for those that end."""
    late = p.active & (p.bounces >= ROULETTE_FROM)
    lost = late & ((p.random.next_float32(late) >= SURVIVAL) | (p.bounces >= LONGEST))
    spared = late & ~lost
    gain = dr.select(spared, p.weight * (1 / SURVIVAL - 1), 0)
    return replace(
        p,
        weight=p.weight + gain,
        gained=p.gained + gain,
        fate=dr.select(lost, UInt32(CUT_OFF), p.fate),
        active=p.active & ~lost,
    )
