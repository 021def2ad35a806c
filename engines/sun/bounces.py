"""Daylight's paths, traced backwards: from a sensor off matte and shiny surfaces to the sky.

A sensor's rays start by the cosine law. A matte surface scatters a ray by the same law, so that a
path's weight is nothing but the product of what its surfaces return and its panes let through
[Veach 1997, 8.2]; where it escapes, it has found that much of that patch of the sky. A surface
returns light on both of its sides, by its face and not by smooth normals. Panes are crossed
straight, as `panes` says; what they throw back is left out.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.scene import Vector
from . import panes
from .patches import rows_of
from .site import Site, to_world
from .soup import CLOSE
from .surroundings import RECORD, Surroundings

_LONGEST = 256
"""Surfaces, panes among them, that a path may meet."""


@dataclass(frozen=True, slots=True)
class Start:
    """Where paths start: ``origins`` and ``normals`` (n, 3) float32 about a `Surroundings`' centre;
    from each one strata² of them, one in each cell of a grid over the hemisphere."""

    origins: NDArray[np.float32]
    normals: NDArray[np.float32]
    strata: int


@dataclass(frozen=True, slots=True)
class Dome:
    """The patches that paths escape to: Reinhart's of ``subdivision``, and the ground as the last;
    they stand to the model as ``site`` has it."""

    subdivision: int
    site: Site

    @property
    def rows(self) -> tuple[int, ...]:
        """Patches in each row of altitude."""
        return rows_of(self.subdivision)

    @property
    def count(self) -> int:
        """Of patches, with the ground."""
        return sum(self.rows) + 1


def escapes(
    around: Surroundings, start: Start, dome: Dome, bounces: int, veil: float, key: int
) -> Vector:
    """What n sensors find on the dome's P patches: straight, and scattered on the way (n, 2, P).

    Each is the mean over the sensor's paths of their weights, 0..1: all would be 1 together under
    an open sky. A path is given up at the surface after ``bounces`` reflections. Where ``veil`` is
    above 0, a screen hangs behind the first of any panes in a row: it lets that share through and
    scatters it by the cosine law. The same ``key`` gives the same paths.
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
        active=dr.full(mi.Bool, True, lanes),
        random=random,
    )
    if around.soup.scene is not None:
        reach = max(around.soup.reach, float(np.abs(start.origins).max(initial=0.0)))
        rules = _Rules(
            dr.opaque(mi.Float, 2 * CLOSE * reach),
            dr.opaque(mi.UInt32, bounces),
            dr.opaque(mi.Float, veil),
        )
        (path,) = dr.while_loop(
            (path,),
            lambda p: p.active,
            lambda p: (_step(p, around, rules),),
            label="daylight",
        )
    column = row * (2 * dr.opaque(mi.UInt32, dome.count)) + _patch(path.direction, dome)
    column += dr.select((path.bounces > 0) | path.veiled, dr.opaque(mi.UInt32, dome.count), 0)
    weight = (path.s + path.p) / 2
    dr.eval(column, weight)
    size = 2 * dome.count * count
    found = np.bincount(np.asarray(column), np.asarray(weight), size) / strata**2
    return found.reshape(count, 2, dome.count)


@dataclass
class _Path:
    """The state that travels through the loop, a path a lane.

    ``s`` and ``p`` are what is left of light polarised either way, ``behind`` how far in m it is
    past the last surface of glass; ``met`` counts surfaces.
    """

    origin: Any
    direction: Any
    s: Any
    p: Any
    behind: Any
    bounces: Any
    met: Any
    veiled: Any
    active: Any
    random: Any


@dataclass(frozen=True, slots=True)
class _Rules:
    """On the device: the step in m off a surface, the most bounces, and the screen."""

    step: Any
    bounces: Any
    veil: Any


def _step(path: _Path, around: Surroundings, rules: _Rules) -> _Path:
    """From one surface to the next, or out."""
    mi = runtime.mitsuba()
    import drjit as dr

    ray = mi.Ray3f(path.origin, path.direction)
    hit = around.soup.scene.ray_intersect_preliminary(ray, coherent=False, active=path.active)
    met = path.active & hit.is_valid()
    record = dr.gather(
        mi.ArrayXf, around.records, hit.prim_index, met, shape=(RECORD, dr.width(hit.t))
    )
    normal = mi.Vector3f(record[0], record[1], record[2])
    along = dr.dot(path.direction, normal)
    onward = dr.select(along > 0, normal, -normal)
    pane = met & (record[3] > 0)
    matte = met & ~pane

    # A pane counts where the ray leaves it.
    sheet = record[6] > 0
    counts = pane & (sheet | (along > 0))
    kept_s, kept_p = panes.slab(along, record[4], record[5], sheet, path.behind + hit.t)
    veiling = counts & ~path.veiled & (rules.veil > 0)

    ends = matte & (path.bounces >= rules.bounces)
    shines = matte & (path.random.next_float32() < record[5])
    scatters = (matte & ~shines) | veiling
    point = mi.Point2f(path.random.next_float32(), path.random.next_float32())
    lobe = mi.Frame3f(dr.select(matte, -onward, onward)).to_world(
        mi.warp.square_to_cosine_hemisphere(point)
    )
    direction = dr.select(scatters, lobe, path.direction)
    direction = dr.select(shines, path.direction - 2 * along * normal, direction)

    # Scattered light is no longer polarised.
    mean = (path.s + path.p) / 2
    returned = dr.select(ends, 0, mean * record[4])
    through = dr.select(counts, kept_s, 1), dr.select(counts, kept_p, 1)
    s, p = path.s * through[0], path.p * through[1]
    screened = rules.veil * (s + p) / 2
    s, p = dr.select(veiling, screened, s), dr.select(veiling, screened, p)
    s, p = dr.select(matte, returned, s), dr.select(matte, returned, p)
    number = path.met + dr.select(met, mi.UInt32(1), 0)
    lost = met & (number >= _LONGEST)
    s, p = dr.select(lost, 0, s), dr.select(lost, 0, p)

    place = path.origin + hit.t * path.direction
    off = dr.select(matte, -rules.step * onward, rules.step * path.direction)
    off = dr.select(veiling, rules.step * onward, off)
    return _Path(
        origin=dr.select(met, place + off, path.origin),
        direction=dr.select(met, direction, path.direction),
        s=dr.select(met, s, path.s),
        p=dr.select(met, p, path.p),
        behind=dr.select(met, rules.step, path.behind),
        bounces=path.bounces + dr.select(matte, mi.UInt32(1), 0),
        met=number,
        veiled=(path.veiled | veiling) & ~matte,
        active=met & (s + p > 0),
        random=path.random,
    )


def _patch(direction: Any, dome: Dome) -> Any:
    """As `patches.patch_at`, on the device and of directions in the model's axes."""
    mi = runtime.mitsuba()
    import drjit as dr

    rows = np.array(dome.rows, np.uint32)
    height = np.pi / 2 / (len(rows) - 0.5)
    first = mi.UInt32(np.cumsum(rows) - rows)
    (cosine, sine, _), _, _ = to_world(np.eye(3), dome.site)
    cosine, sine = dr.opaque(mi.Float, cosine), dr.opaque(mi.Float, -sine)
    x = direction.x * cosine + direction.y * sine
    y = direction.y * cosine - direction.x * sine
    altitude = dr.atan2(direction.z, dr.hypot(x, y))
    above = altitude >= 0
    row = mi.UInt32(dr.select(above, altitude / dr.opaque(mi.Float, height), 0))
    row = dr.minimum(row, dr.opaque(mi.UInt32, len(rows) - 1))
    count = dr.gather(mi.UInt32, mi.UInt32(rows), row)
    turn = dr.atan2(x, y) / dr.two_pi
    turn += dr.select(turn < 0, 1, 0)
    place = mi.UInt32(turn * mi.Float(count) + 0.5)
    place = dr.select(place >= count, 0, place)
    patch = dr.gather(mi.UInt32, first, row) + place
    return dr.select(above, patch, dr.opaque(mi.UInt32, dome.count - 1))


def _loaded(kind: Any, vectors: NDArray[np.float32]) -> Any:
    return kind(np.ascontiguousarray(vectors.T))
