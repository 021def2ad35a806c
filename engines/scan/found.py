"""Layer heights and wall widths as found on a scan, and on its design by the same measure."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np

from ..core.scene import Vector
from .beads import SECTORS, Beads, Strip, beads_of, crests_of, levels_of, strip_of

_BAND = 5e-3  # m; the height of a band where there are no layers to measure
_SEEN = 0.01  # of the points must be on a side that was scanned
_FEWEST = 3  # sectors that must agree on a layer


@dataclass(frozen=True, slots=True)
class LayerTable:
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

    @classmethod
    def of(cls, arrays: Mapping[str, Vector], prefix: str) -> "LayerTable":
        """The table that `arrays` gave. Raises KeyError where a column is missing."""
        return cls(*(arrays[prefix + field.name] for field in fields(cls)))

    @classmethod
    def empty(cls) -> "LayerTable":
        """No layers."""
        return cls(*np.zeros((len(fields(cls)), 0)))


@dataclass(frozen=True, slots=True)
class Found:
    """A wall as it was found.

    ``layers`` are empty where the wall has none. ``pitch`` is the mean layer height, ``width``
    the mean width and ``front`` how far the crests stand out of the design's outline, in m with
    their standard deviations, NaN where they could not be measured; ``rise`` the layers climbed in
    a turn, ``depth`` in m the relief of a bead.
    """

    layers: LayerTable
    pitch: float
    pitch_error: float
    width: float
    width_error: float
    front: float
    front_error: float
    rise: int
    depth: float

    @property
    def rhythmic(self) -> bool:
        """Whether there are layers."""
        return bool(np.isfinite(self.pitch))


@dataclass(frozen=True, slots=True)
class Sides:
    """Points of a wall, unrolled; all (N,).

    ``z`` in m; ``side`` is 1 outside, −1 inside and 0 on a rim; ``turn`` in 0..1 along the
    design's outline, ``offset`` in m out of it.
    """

    z: Vector
    side: Vector
    turn: Vector
    offset: Vector


def layers_of(wall: Sides) -> Found:
    """The layers and widths of a wall."""
    z, turn, offset = wall.z, wall.turn, wall.offset
    low, high = _ends(wall)
    strips = {
        side: strip_of(turn[which], z[which], side * offset[which], low, high)
        for side in (1, -1)
        if (which := wall.side == side).mean() > _SEEN
    }
    beads = {side: one for side, strip in strips.items() if (one := beads_of(strip)) is not None}
    floors = {side: _with_ends(one, wall, low, high) for side, one in beads.items()}
    crests = {side: crests_of(strips[side], floors[side], one.shape) for side, one in beads.items()}
    main = next(iter(beads), 0)
    if main:
        edges = floors[main]
    else:
        edges = np.tile(np.linspace(low, high, max(2, round((high - low) / _BAND))), (SECTORS, 1))
    fronts = {
        side: _matched(edges, floors[side], crests[side], beads[side].pitch)
        if side in beads
        else levels_of(strip, edges)
        for side, strip in strips.items()
    }
    unknown = np.full(edges[:, 1:].shape, np.nan)
    width = fronts[1] + fronts[-1] if len(fronts) == 2 else unknown
    height = np.diff(edges, axis=1) if main else unknown
    front = fronts.get(1, unknown)
    table = LayerTable.empty()
    if main:
        climb = beads[main].rise * beads[main].pitch
        level = _mean(edges - climb * strips[main].turn)[0]
        there = np.isfinite(height).sum(axis=0) >= _FEWEST
        columns = ((level[:-1] + level[1:]) / 2, *_mean(height), *_mean(width), _mean(front)[0])
        table = LayerTable(*(c[there] for c in (*columns, _counted(strips, edges))))
    return Found(
        table,
        *_overall(height[:, 1:-1]),
        *_overall(width),
        *_overall(front),
        rise=beads[main].rise if main else 0,
        depth=beads[main].depth if main else 0.0,
    )


def grown(found: Found, scale: float) -> Found:
    """The same with all lengths times ``scale``, but for where the layers are."""
    table = found.layers.arrays("")
    table = {name: v if name in ("z", "points") else scale * v for name, v in table.items()}
    lengths = ("pitch", "pitch_error", "width", "width_error", "front", "front_error", "depth")
    return replace(
        found,
        layers=LayerTable(**table),
        **{name: scale * getattr(found, name) for name in lengths},
    )


def _ends(wall: Sides) -> tuple[float, float]:
    """The heights between which nearly all of the sides lie."""
    z = wall.z[wall.side != 0]
    low, high = np.percentile(z, [0.2, 99.8])
    return float(low), float(high)


def _with_ends(beads: Beads, wall: Sides, low: float, high: float) -> Vector:
    """The floors (S, K + 2), with the rims where they were seen."""
    rims = wall.z[wall.side == 0]
    ends = []
    for end in (low, high):
        at = rims[np.abs(rims - end) < beads.pitch / 2]
        ends.append(np.full((SECTORS, 1), np.median(at) if len(at) > 50 else np.nan))
    floors = beads.floors
    gap = 1.5 * beads.pitch
    lower = np.where(floors[:, :1] - ends[0] < gap, ends[0], np.nan)
    upper = np.where(ends[1] - floors[:, -1:] < gap, ends[1], np.nan)
    return np.concatenate([lower, floors, upper], axis=1)


def _matched(edges: Vector, floors: Vector, crests: Vector, pitch: float) -> Vector:
    """The crests between own ``floors``, each for the layer between ``edges`` beside it (S, L)."""
    wanted, own = (edges[:, :-1] + edges[:, 1:]) / 2, (floors[:, :-1] + floors[:, 1:]) / 2
    result = np.full(wanted.shape, np.nan)
    for row, asked, there, crest in zip(result, wanted, own, crests, strict=True):
        known = np.flatnonzero(np.isfinite(there) & np.isfinite(crest))
        some = np.flatnonzero(np.isfinite(asked))
        if len(known) and len(some):
            gaps = np.abs(there[known] - asked[some][:, None])
            close = gaps.min(axis=1) < pitch / 2
            row[some[close]] = crest[known[gaps.argmin(axis=1)[close]]]
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


def _counted(strips: dict[int, Strip], floors: Vector) -> Vector:
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
