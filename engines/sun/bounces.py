"""Daylight's paths, traced backwards: from a sensor off matte and shiny surfaces to sky and suns.

A sensor's rays start by the cosine law. A matte surface scatters a ray by the same law, so that a
path's weight is nothing but the product of what its surfaces return and its panes let through
[Veach 1997, 8.2]; where it escapes, it has found that much of that patch of the sky, and wherever
it is scattered, a shadow ray looks for the sun. A surface returns light on both of its sides, by
its face and not by smooth normals. Clear panes are crossed straight, as `panes` says, ground ones
scatter what clear ones would let through; what they throw back is left out.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.scene import Vector
from .dome import Dome, escaped_to
from .meeting import LONGEST, meet
from .shadow_rays import Aims, Scattered, Shadows
from .surroundings import Surroundings


@dataclass(frozen=True, slots=True)
class Start:
    """Where paths start: ``origins`` and ``normals`` (n, 3) float32 about a `Surroundings`' centre;
    from each one strata² of them, one in each cell of a grid over the hemisphere."""

    origins: NDArray[np.float32]
    normals: NDArray[np.float32]
    strata: int


@dataclass(frozen=True, slots=True)
class Found:
    """What n sensors find, each as the mean over its paths.

    ``patches`` (n, 3, P) in lx for 1 cd/m² of the dome's P patches: what comes straight, is
    scattered last, and is mirrored last; all are π together under an open sky. ``suns`` (n, S) in
    lx for 1 lx normal to each of the S suns that are aimed at: what is scattered last.
    ``given_up`` (n,): the weight of paths where they were given up, 0..1; among surfaces that are
    as bright as the sensor it is the share of light that is missing.
    """

    patches: Vector
    suns: Vector
    given_up: Vector


def follow(
    around: Surroundings,
    start: Start,
    dome: Dome,
    bounces: int,
    veil: float,
    key: int,
    aims: Aims | None = None,
) -> Found:
    """What paths from n sensors find on the dome and, where there are ``aims``, of the suns.

    A path is given up at the surface after ``bounces`` reflections. Where ``veil`` is above 0, a
    screen hangs behind the first of any panes in a row: it lets that share through and scatters it
    by the cosine law. What is mirrored last finds no suns, as no ray can be aimed by a mirror.
    The same ``key`` gives the same.
    """
    mi = runtime.mitsuba()
    import drjit as dr

    count, strata = len(start.origins), start.strata
    lanes = count * strata**2
    index = dr.arange(mi.UInt32, lanes)
    # Opaque, so that one kernel serves all scenes.
    cells = dr.opaque(mi.UInt32, strata)
    row = index // (cells * cells)
    cell = index - row * (cells * cells)
    scrambled = mi.sample_tea_32(dr.opaque(mi.UInt32, key), index)
    random = mi.PCG32(initstate=mi.UInt64(scrambled[0]), initseq=mi.UInt64(scrambled[1]))
    across, along = cell % cells, cell // cells
    place = mi.Point2f(
        (mi.Float(across) + random.next_float32()) / mi.Float(cells),
        (mi.Float(along) + random.next_float32()) / mi.Float(cells),
    )
    origin = dr.gather(mi.Point3f, _loaded(mi.Point3f, start.origins), row)
    normal = dr.gather(mi.Vector3f, _loaded(mi.Vector3f, start.normals), row)
    direction = mi.Frame3f(normal).to_world(mi.warp.square_to_cosine_hemisphere(place))
    path = _Path(
        origin=origin,
        direction=direction,
        s=dr.ones(mi.Float, lanes),
        p=dr.ones(mi.Float, lanes),
        behind=dr.zeros(mi.Float, lanes),
        bounces=dr.zeros(mi.UInt32, lanes),
        met=dr.zeros(mi.UInt32, lanes),
        veiled=dr.zeros(mi.Bool, lanes),
        mirrored=dr.zeros(mi.Bool, lanes),
        given_up=dr.zeros(mi.Float, lanes),
        active=dr.full(mi.Bool, True, lanes),
        random=random,
    )
    shadows = Shadows(aims, count, row, across, along, key) if aims else None
    if around.soup.scene is not None:
        rules = _Rules(dr.opaque(mi.UInt32, bounces), dr.opaque(mi.Float, veil))
        (path,) = dr.while_loop(
            (path,),
            lambda p: p.active,
            lambda p: (_step(p, around, rules, shadows),),
            label="daylight",
        )
    patches = dr.opaque(mi.UInt32, dome.count)
    kind = dr.select((path.bounces > 0) | path.veiled, mi.UInt32(1), 0)
    kind = dr.select(path.mirrored, 2, kind)
    column = (row * 3 + kind) * patches + escaped_to(path.direction, dome)
    weight = (path.s + path.p) / 2
    dr.eval(column, weight, path.given_up)
    size = 3 * dome.count * count
    found = np.bincount(np.asarray(column), np.asarray(weight), size)
    found *= np.pi / strata**2
    return Found(
        found.reshape(count, 3, dome.count),
        shadows.found(strata**2) if shadows else np.zeros((count, 0)),
        np.asarray(path.given_up).reshape(count, -1).mean(axis=1, dtype=np.float64),
    )


@dataclass
class _Path:
    """The state that travels through the loop, a path a lane.

    ``s`` and ``p`` are what is left of light polarised either way, ``behind`` how far in m it is
    past the last surface of glass; ``met`` counts surfaces. ``veiled``: whether it has come through
    a screen or ground glass since the last opaque surface, ``mirrored``: whether the last to turn
    it was a mirror. ``given_up``: what was left where it was given up.
    """

    origin: Any
    direction: Any
    s: Any
    p: Any
    behind: Any
    bounces: Any
    met: Any
    veiled: Any
    mirrored: Any
    given_up: Any
    active: Any
    random: Any


@dataclass(frozen=True, slots=True)
class _Rules:
    """On the device: the most bounces, and the screen."""

    bounces: Any
    veil: Any


def _step(path: _Path, around: Surroundings, rules: _Rules, shadows: Shadows | None) -> _Path:
    """From one surface to the next, or out."""
    mi = runtime.mitsuba()
    import drjit as dr

    on = meet(around, path.origin, path.direction, path.behind, path.active)
    onward = dr.select(on.along > 0, on.normal, -on.normal)
    screens = on.leaves & ~path.veiled & (rules.veil > 0)
    veiling = screens | on.diffuses

    ends = on.opaque & (path.bounces >= rules.bounces)
    shines = on.opaque & (path.random.next_float32() < on.mirrored)
    scatters = (on.opaque & ~shines) | veiling
    point = mi.Point2f(path.random.next_float32(), path.random.next_float32())
    outward = dr.select(on.opaque, -onward, onward)
    lobe = mi.Frame3f(outward).to_world(mi.warp.square_to_cosine_hemisphere(point))
    direction = dr.select(scatters, lobe, path.direction)
    direction = dr.select(shines, path.direction - 2 * on.along * on.normal, direction)

    # Scattered light is no longer polarised.
    returned = (path.s + path.p) / 2 * on.returned
    given_up = path.given_up + dr.select(ends, returned, 0)
    returned = dr.select(ends, 0, returned)
    s, p = path.s * on.s, path.p * on.p
    screened = dr.select(screens, rules.veil, 1) * (s + p) / 2
    s, p = dr.select(veiling, screened, s), dr.select(veiling, screened, p)
    s, p = dr.select(on.opaque, returned, s), dr.select(on.opaque, returned, p)
    number = path.met + dr.select(on.met, mi.UInt32(1), 0)
    lost = on.met & (number >= LONGEST)
    s, p = dr.select(lost, 0, s), dr.select(lost, 0, p)

    off = dr.select(scatters, on.step * outward, on.step * path.direction)
    off = dr.select(shines, -on.step * onward, off)
    origin = path.origin + on.distance * path.direction + off
    veiled = (path.veiled | veiling) & ~on.opaque
    goes_on = on.met & (s + p > 0)
    if shadows:
        scattered = Scattered(origin, outward, s, on.step, veiled, rules.veil)
        event = 2 * path.bounces + dr.select(veiling, mi.UInt32(1), 0)
        shadows.send(around, scattered, event, scatters & goes_on)
    return _Path(
        origin=dr.select(on.met, origin, path.origin),
        direction=dr.select(on.met, direction, path.direction),
        s=dr.select(on.met, s, path.s),
        p=dr.select(on.met, p, path.p),
        behind=dr.select(on.met, on.step, path.behind),
        bounces=path.bounces + dr.select(on.opaque, mi.UInt32(1), 0),
        met=number,
        veiled=veiled,
        mirrored=(path.mirrored & ~scatters) | shines,
        given_up=given_up,
        active=goes_on,
        random=path.random,
    )


def _loaded(kind: Any, vectors: NDArray[np.float32]) -> Any:
    return kind(np.ascontiguousarray(vectors.T))
