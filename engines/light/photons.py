"""Photons from the luminaires through the glass onto the receivers: one loop, batch by batch."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..core import runtime
from .emission import Emitter, draw
from .stage import KINDS, OFFSET_MM, OFFSET_SHARE, OWNER, RECORD, Stage
from .tally import FATES, ROUTES, Landing
from .targets import MESH, NOWHERE, Met, texel_at

mi = runtime.mitsuba()
import drjit as dr  # noqa: E402  (loads LLVM: only after the runtime has chosen which)

from . import surfaces  # noqa: E402

Float, UInt32, Bool = mi.Float, mi.UInt32, mi.Bool

LANDED, ABSORBED, ESCAPED, CUT_OFF = FATES.values()
DIRECT, CAUSTIC, INDIRECT = ROUTES.values()
SURFACE, DIELECTRIC = KINDS.index("surface"), KINDS.index("dielectric")
ROULETTE = range(32, 54)
"""Bounces at which chance decides: ten photons become one of ten times the weight, and no more;
light that glass traps would else end in ever fewer, ever heavier photons."""
SURVIVAL = 0.9
LONGEST = 512
NEAR = 2.0
"""Times the largest coordinate: the corner of a cube is √3 away."""


def step_at(place: Any) -> Any:
    """How far in mm a photon is set off a surface at ``place``: a few float32 steps there."""
    largest = dr.maximum(dr.maximum(dr.abs(place.x), dr.abs(place.y)), dr.abs(place.z))
    return OFFSET_MM + OFFSET_SHARE * largest


@dataclass
class Photon:
    """The state that travels through the loop, a photon a lane.

    ``slack`` is how far in mm behind it a plane may lie that it still meets, and ``left`` the
    number of the plane that returned it, or MESH. ``inside`` has a bit for each medium that the
    photon is in, lowest first; ``band`` is its place among the wavelengths, or () where there is
    one.
    """

    origin: Any
    direction: Any
    weight: Any
    active: Any
    bounces: Any
    slack: Any
    left: Any
    route: Any
    fate: Any
    texel: Any
    gained: Any
    inside: Any
    band: Any
    random: Any
    light: Any


def trace_batch(
    stage: Stage, emitter: Emitter, count: int, polarised: bool, seed: tuple[int, ...]
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
        # A lamp may be let into a plane, as in a ceiling.
        slack=-2 * step_at(origin),
        left=dr.full(UInt32, MESH, count),
        route=dr.full(UInt32, DIRECT, count),
        fate=dr.full(UInt32, ESCAPED, count),
        texel=dr.full(UInt32, NOWHERE, count),
        gained=dr.zeros(Float, count),
        inside=dr.zeros(UInt32, count),
        band=random.next_float32() if stage.bands > 1 else (),
        random=random,
        light=surfaces.unpolarised(direction) if polarised else (),
    )
    (end,) = dr.while_loop(
        (state,), lambda p: p.active, lambda p: (_step(p, stage),), label="photons"
    )
    found = [end.fate, end.route, end.texel, end.weight, end.gained]
    found += [end.band] if stage.bands > 1 else []
    dr.eval(found)
    return Landing(*(a.numpy() for a in found))


def _near(origin: Any, direction: Any, stage: Stage) -> Any:
    """Start photons of far lamps where they come near the scene: float32 is fine only there."""
    ahead = -dr.dot(mi.Vector3f(origin), direction) - NEAR * stage.reach
    return origin + dr.maximum(ahead, 0) * direction


def _step(p: Photon, stage: Stage) -> Photon:
    """From one surface to the next."""
    nearest = Met(Float(dr.inf), UInt32(NOWHERE), Float(0), mi.Vector3f(0, 0, 1), UInt32(MESH))
    for plane in stage.planes:
        met = plane.meet(p.origin, p.direction, p.slack)
        nearer = (met.distance < nearest.distance) & (met.plane != p.left)
        nearest = dr.select(nearer, met, nearest)
    if stage.scene is None:
        return _roulette(_land(p, p.active & dr.isfinite(nearest.distance), nearest, stage))

    # Glass that lies on a plane comes before it.
    reach = nearest.distance + 2 * step_at(p.origin)
    ray = mi.Ray3f(p.origin, p.direction, reach, 0.0, [])
    hit = stage.scene.ray_intersect_preliminary(ray, coherent=False, active=p.active)
    met = p.active & hit.is_valid()
    on_plane = p.active & ~met & dr.isfinite(nearest.distance)
    p = replace(p, active=met | on_plane)
    landed = _land(p, on_plane, nearest, stage)
    width = dr.width(hit.t)
    row = dr.gather(mi.ArrayXf, stage.triangles, hit.prim_index, met, shape=(RECORD, width))
    own = dr.gather(mi.ArrayXf, stage.owners, UInt32(row[12]), met, shape=(OWNER, width))
    if "surface" in stage.kinds:
        found, surface = _surface(p, hit, row, own, met)
        landed = dr.select(found, _land(p, found, surface, stage), landed)
        met &= ~found
    scattered = _scatter(p, stage, hit, row, own, met) if stage.kinds != {"surface"} else p
    return _roulette(dr.select(met, scattered, landed))


def _land(p: Photon, landing: Any, met: Met, stage: Stage) -> Photon:
    """End the photons that a receiver takes; send the share that it returns on, matte.

    A photon is counted where it ends. Dividing by the share that a receiver takes makes of that
    what arrives: independent counts, whatever was returned before (`tally.Tally.add`).
    """
    going = Bool(False)
    absorbed = landing & _tinted(p, stage, met.distance, p.inside, landing)
    here = landing & ~absorbed
    direction, origin, light, route = p.direction, p.origin, p.light, p.route
    if "reflecting" in stage.features:
        going = here & (p.random.next_float32(here) < met.reflectance)
        point = mi.Point2f(p.random.next_float32(here), p.random.next_float32(here))
        matte = mi.Frame3f(met.normal).to_world(mi.warp.square_to_cosine_hemisphere(point))
        place = p.origin + met.distance * p.direction
        # Behind a plane, so that glass that lies on it is met.
        side = dr.select(met.plane == MESH, step_at(place), -step_at(place))
        origin = dr.select(going, place + side * met.normal, origin)
        direction = dr.select(going, matte, direction)
        route = dr.select(going, UInt32(INDIRECT), route)
        if p.light:
            light = dr.select(going, surfaces.unpolarised(direction), light)
    gathers = here & ~going & (met.texel != NOWHERE)
    fate = dr.select(gathers, UInt32(LANDED), UInt32(ABSORBED))
    return replace(
        p,
        origin=origin,
        direction=direction,
        light=light,
        route=route,
        bounces=p.bounces + 1,
        slack=Float(0),
        left=met.plane,
        fate=dr.select(landing & ~going, fate, p.fate),
        texel=dr.select(gathers, met.texel, p.texel),
        active=going,
    )


def _tinted(p: Photon, stage: Stage, distance: Any, inside: Any, active: Any) -> Any:
    """Whether the medium takes the photon on its way, by chance [Beer–Lambert]."""
    if "tinted" not in stage.features:
        return Bool(False)
    absorption = dr.gather(Float, stage.absorption, _medium(inside), active)
    return p.random.next_float32(active) >= dr.exp(-absorption * distance)


def _medium(inside: Any) -> Any:
    """The medium of highest rank in a set, 0 for none."""
    return 32 - dr.lzcnt(inside)


def _ior(stage: Stage, p: Photon, medium: Any, active: Any) -> Any:
    """Index of refraction of a medium at the photon's wavelength."""
    if stage.bands == 1:
        return dr.gather(Float, stage.ior, medium, active)
    # As `spectrum.Bands.table` says.
    place = dr.clip(p.band * stage.bands - 0.5, 0, stage.bands - 1)
    low = dr.minimum(UInt32(place), stage.bands - 2)
    first = medium * stage.bands + low
    return dr.lerp(
        dr.gather(Float, stage.ior, first, active),
        dr.gather(Float, stage.ior, first + 1, active),
        place - Float(low),
    )


def _surface(p: Photon, hit: Any, row: Any, own: Any, met: Any) -> tuple[Any, Met]:
    """Which photons met a receiver's mesh, and where."""
    s, t = hit.prim_uv.x, hit.prim_uv.y
    u, v = (row[i] * (1 - s - t) + row[i + 2] * s + row[i + 4] * t for i in range(2))
    columns, rows, front, back = (dr.reinterpret_array(UInt32, own[i]) for i in range(3, 7))
    flat = mi.Vector3f(row[9], row[10], row[11])
    before = dr.dot(p.direction, flat) < 0
    texel = texel_at(dr.select(before, front, back), u, v, columns, rows)
    normal = dr.select(before, flat, -flat)
    return met & (own[0] == SURFACE), Met(hit.t, texel, own[2], normal, UInt32(MESH))


def _scatter(p: Photon, stage: Stage, hit: Any, row: Any, own: Any, met: Any) -> Photon:
    """Reflect, refract or absorb the photons that met a body."""
    s, t = hit.prim_uv.x, hit.prim_uv.y
    smooth = dr.normalize(
        mi.Vector3f(*(row[i] * (1 - s - t) + row[i + 3] * s + row[i + 6] * t for i in range(3)))
    )
    flat = mi.Vector3f(row[9], row[10], row[11])
    outside = dr.dot(p.direction, flat) < 0
    # A smooth normal that faces away from the ray would turn the surface inside out.
    smooth = dr.select((dr.dot(p.direction, smooth) < 0) == outside, smooth, flat)

    # The surface says on which side of its own body the photon is, whatever was lost before.
    clear = own[0] == DIELECTRIC
    bit = dr.select(clear, UInt32(1) << (UInt32(dr.maximum(own[1], 1)) - 1), UInt32(0))
    within, without = p.inside | bit, p.inside & ~bit
    here = dr.select(outside, without, within)
    beyond = dr.select(outside, within, without)
    inner, outer = _medium(within), _medium(without)
    ior = _ior(stage, p, inner, met) / _ior(stage, p, outer, met)
    taken = met & _tinted(p, stage, hit.t, here, met)

    # Between two places of one body nothing is met.
    bare = clear & (inner == outer)
    rough = dr.select(bare, 0, own[4]) if "rough" in stage.features else ()
    meeting = surfaces.Meeting(
        p.direction, smooth, flat, outside, ior, own[2], own[3], rough, p.random, met, p.light
    )
    first, *others = (name for name in KINDS if name in stage.kinds - {"surface"})
    outcome = surfaces.SCATTER[first](meeting)
    for name in others:
        of_kind = own[0] == KINDS.index(name)
        outcome = dr.select(of_kind, surfaces.SCATTER[name](meeting), outcome)

    absorbed = met & (outcome.absorbed | taken)
    # Leave the surface by a few float32 steps to the side where the photon goes on. Outside of a
    # body on a plane that may be behind the plane.
    place = p.origin + hit.t * p.direction
    place += dr.select(outside == outcome.through, -1, 1) * step_at(place) * flat
    seen = dr.select(bare, p.route, dr.maximum(p.route, UInt32(CAUSTIC)))
    return replace(
        p,
        origin=place,
        direction=outcome.direction,
        fate=dr.select(absorbed, UInt32(ABSORBED), p.fate),
        route=dr.select(outcome.matte, UInt32(INDIRECT), seen),
        inside=dr.select(outcome.through, beyond, here),
        bounces=p.bounces + 1,
        slack=dr.select(outside != outcome.through, 2 * step_at(place), 0),
        left=UInt32(MESH),
        active=met & ~absorbed,
        light=outcome.light,
    )


def _roulette(p: Photon) -> Photon:
    """End long paths by chance, without bias: survivors carry on for those that end."""
    late = p.active & (p.bounces >= ROULETTE.start) & (p.bounces < ROULETTE.stop)
    lost = late & (p.random.next_float32(late) >= SURVIVAL)
    spared = late & ~lost
    lost |= p.active & (p.bounces >= LONGEST)
    gain = dr.select(spared, p.weight * (1 / SURVIVAL - 1), 0)
    return replace(
        p,
        weight=p.weight + gain,
        gained=p.gained + gain,
        fate=dr.select(lost, UInt32(CUT_OFF), p.fate),
        active=p.active & ~lost,
    )
