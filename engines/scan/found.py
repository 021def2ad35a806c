"""Layer heights and wall widths as found on a scan, and on its design by the same measure."""

from dataclasses import dataclass, fields

import numpy as np

from ..core.scene import Vector
from .around import Around
from .beads import SECTORS, Beads, beads_of, levels_of, strip_of

_BAND = 5e-3  # m; the height of a band where there are no layers to measure
_FEWEST = 3  # sectors that must agree on a layer


@dataclass(frozen=True, slots=True)
class Layers:
    """The layers of a wall, from below; all (L,) float64, m, NaN where they were not seen.

    ``z`` is the middle of each, ``height`` and ``width`` are means around the wall, the
    ``_spread`` their standard deviations there and ``_error`` the standard deviations of the
    means; ``points`` how many each was measured from. The width goes from crest to crest through
    the wall. ``front`` is how far the crests stand out of the design's outline.
    """

    z: Vector
    height: Vector
    height_spread: Vector
    height_error: Vector
    width: Vector
    width_spread: Vector
    width_error: Vector
    front: Vector
    points: Vector

    def arrays(self, prefix: str) -> dict[str, Vector]:
        """The columns by name, for a file."""
        return {prefix + field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, slots=True)
class Found:
    """A wall as it was found.

    ``layers`` are empty where the wall has none. ``pitch`` is the mean layer height and ``width``
    the mean width in m with their standard deviations, NaN where they could not be measured;
    ``rise`` the layers climbed in a turn, ``depth`` in m the relief of a bead, ``share`` how much
    of the relief is bead.
    """

    layers: Layers
    pitch: float
    pitch_error: float
    width: float
    width_error: float
    front: float
    rise: int
    depth: float
    share: float


@dataclass(frozen=True, slots=True)
class Sides:
    """Points of a wall: places (N, 3) in m, and on which side: 1 out, −1 in, 0 on a rim (N,)."""

    points: Vector
    side: Vector


def layers_of(wall: Sides, around: Around) -> Found:
    """The layers and widths of a wall, unrolled around the design's outline."""
    turn, offset = around.unroll(wall.points)
    z = wall.points[:, 2]
    low, high = _ends(wall)
    strips = {
        side: strip_of(turn[which], z[which], side * offset[which], low, high)
        for side in (1, -1)
        if (which := wall.side == side).any()
    }
    beads = {side: one for side, strip in strips.items() if (one := beads_of(strip)) is not None}
    main = 1 if 1 in beads or -1 not in beads else -1
    if main in beads:
        floors = _with_ends(beads[main], wall, low, high)
    else:
        bands = np.linspace(low, high, max(2, round((high - low) / _BAND) + 1))
        floors = np.tile(bands, (SECTORS, 1))
    crests = {side: _crests(strips[side], beads.get(side), floors) for side in strips}
    width = crests[1] + crests[-1] if len(crests) == 2 else np.full(floors[:, 1:].shape, np.nan)
    height = np.diff(floors, axis=1) if beads else np.full(width.shape, np.nan)
    front = crests.get(1, np.full(width.shape, np.nan))
    there = [np.isfinite(height if beads else width).sum(axis=0) >= _FEWEST][0]
    turns = (np.arange(SECTORS)[:, None] + 0.5) / SECTORS
    rise = beads[main].rise * beads[main].pitch if beads else 0.0
    level = floors - rise * turns
    edges = _mean(level)[0]
    layers = Layers(
        (edges[:-1] + edges[1:])[there] / 2,
        *(column[there] for column in (*_mean(height), *_mean(width))),
        front=_mean(front)[0][there],
        points=_counted(strips, floors)[there],
    )
    pitch, pitch_error = _overall(height[:, 1:-1] if height.shape[1] > 2 else height)
    overall_width, width_error = _overall(width)
    return Found(
        layers=layers if beads else _none(),
        pitch=pitch,
        pitch_error=pitch_error,
        width=overall_width,
        width_error=width_error,
        front=_overall(front)[0],
        rise=beads[main].rise if beads else 0,
        depth=beads[main].depth if beads else 0.0,
        share=beads[main].share if beads else 0.0,
    )


def _none() -> Layers:
    return Layers(*np.zeros((len(fields(Layers)), 0)))


def _ends(wall: Sides) -> tuple[float, float]:
    """The heights between which nearly all of the sides lie."""
    z = wall.points[wall.side != 0, 2]
    low, high = np.percentile(z, [0.2, 99.8])
    return float(low), float(high)


def _with_ends(beads: Beads, wall: Sides, low: float, high: float) -> Vector:
    """The floors (S, K + 2), with the rims where they were seen."""
    rims = wall.points[wall.side == 0, 2]
    ends = []
    for end in (low, high):
        at = rims[np.abs(rims - end) < beads.pitch / 2]
        ends.append(np.full((SECTORS, 1), np.median(at) if len(at) > 50 else np.nan))
    floors = beads.floors
    gap = 1.5 * beads.pitch
    lower = np.where(floors[:, :1] - ends[0] < gap, ends[0], np.nan)
    upper = np.where(ends[1] - floors[:, -1:] < gap, ends[1], np.nan)
    return np.concatenate([lower, floors, upper], axis=1)


def _crests(strip, beads: Beads | None, floors: Vector) -> Vector:
    """How far a side stands out (S, L) in each of the layers between ``floors``."""
    if beads is None:
        return levels_of(strip, floors)
    middle = (floors[:, :-1] + floors[:, 1:]) / 2
    own = (beads.floors[:, :-1] + beads.floors[:, 1:]) / 2
    result = np.full(middle.shape, np.nan)
    for row, wanted, there, crest in zip(result, middle, own, beads.crests, strict=True):
        known = np.flatnonzero(np.isfinite(there) & np.isfinite(crest))
        asked = np.flatnonzero(np.isfinite(wanted))
        if not len(known) or not len(asked):
            continue
        nearest = known[np.abs(there[known] - wanted[asked][:, None]).argmin(axis=1)]
        close = np.abs(there[nearest] - wanted[asked]) < beads.pitch / 2
        row[asked[close]] = crest[nearest[close]]
    return result


def _mean(values: Vector) -> tuple[Vector, Vector, Vector]:
    """Mean, spread and error of the mean (L,) over the sectors (S, L)."""
    known = np.isfinite(values)
    count = known.sum(axis=0)
    total = np.where(known, values, 0.0).sum(axis=0)
    mean = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    square = (np.where(known, values - mean, 0.0) ** 2).sum(axis=0)
    spread = np.where(count > 1, np.sqrt(square / np.maximum(count - 1, 1)), np.nan)
    return mean, spread, spread / np.sqrt(np.maximum(count, 1))


def _overall(values: Vector) -> tuple[float, float]:
    """The mean of all (S, L), and its standard deviation by how the sectors differ."""
    each = _mean(values.T)[0]
    mean, _, error = _mean(each[:, None])
    return float(mean[0]), float(error[0])


def _counted(strips, floors: Vector) -> Vector:
    """How many points are in each layer (L,)."""
    total = np.zeros(floors.shape[1] - 1)
    for strip in strips.values():
        edges = np.where(np.isfinite(floors), floors, np.inf)
        for line, count in zip(edges, strip.count, strict=True):
            known = np.isfinite(line)
            sums = np.concatenate([[0.0], np.cumsum(count)])
            at = sums[np.searchsorted(strip.z, np.where(known, line, 0.0))]
            both = known[1:] & known[:-1]
            total += np.where(both, np.diff(at), 0.0)
    return total
