"""The print gate: whether a machine can lay a path, check by check, each limit with its source."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .. import VERSION
from ..core.parameters import from_table, to_table
from ..core.scene import Vector
from .checks import Check, Spot, along, check, within
from .clearance import clearance
from .machine import Machine
from .reach import places
from .surface import Loft
from .toolpath import WHERE, Spiral, Toolpath, spiral, wound

_FEW = 4  # layers that hold both ramps and two turns that are as all others
_CLOSED = 1e-6  # m
_JUMP = 1.5  # steps; a longer move is no part of the path
_THIN = 0.1  # of a layer: thinner parts of a ramp lean nowhere


@dataclass(frozen=True, slots=True)
class Verdict:
    """What the gate says of a path.

    ``inputs`` is the hash of wall, spiral and machine; ``figures`` name → value and unit of the
    print: turns, length, time, mass, volume of the wall and surplus.
    """

    checks: tuple[Check, ...]
    machine: str
    inputs: str
    figures: dict[str, dict[str, Any]]

    @property
    def passed(self) -> bool:
        """Whether every check is passed."""
        return all(one.passed for one in self.checks)

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that are not passed."""
        return tuple(one for one in self.checks if not one.passed)

    @property
    def worst(self) -> Check:
        """The check that takes most of its limit, of those that have a place."""
        placed = [one for one in self.checks if one.point is not None]
        return max(placed, key=lambda one: (not one.passed, one.share))

    def utilisation(self) -> Vector:
        """The largest share of a limit at each point of the path (N,), of all checks with a map."""
        maps = [one.utilisation for one in self.checks if one.utilisation is not None]
        return np.max(maps, axis=0)

    def as_table(self) -> dict[str, Any]:
        """The verdict in plain values."""
        return {
            "heliform": VERSION,
            "inputs": self.inputs,
            "machine": self.machine,
            "passed": self.passed,
            "figures": self.figures,
            "checks": [one.as_table() for one in self.checks],
        }

    def as_json(self) -> str:
        """The verdict as JSON, without the maps."""
        return json.dumps(self.as_table(), indent=2, ensure_ascii=False, allow_nan=False)


def gate(
    loft: Loft, thickness: float, path: Toolpath, machine: Machine, purge: float = 0.0
) -> Verdict:
    """Every check of ``path`` on a wall around ``loft``, of ``thickness`` in m.

    ``purge`` is how far outside the start the purge lies in m, as `gcode` is given it; 0 for none.
    Each has its map over the path but for those that are one number. Layer height, width, flow and
    speed are judged where the bead has its full height: in the ramps it begins and ends at none.
    """
    return _verdict(loft, thickness, path, machine, purge, 0)


def gate_loft(loft: Loft, thickness: float, record: Spiral, machine: Machine) -> Verdict:
    """What `gate` says of the path that `spiral` would make, without maps; quick where it can be.

    A prismatic wall is the same in every turn between its ramps: a few turns tell all. Raises
    ParameterError as `spiral` does.
    """
    record = from_table(Spiral, to_table(record), WHERE)
    layers = round(loft.height / record.layer_height)
    repeated = max(layers - _FEW, 0) if loft.prismatic else 0
    if repeated:
        path = wound(loft, thickness, record, machine, _FEW, loft.height / layers)
    else:
        path = spiral(loft, thickness, record, machine)
    verdict = _verdict(loft, thickness, path, machine, record.purge, repeated)
    plain = (_moved(one, repeated, path.layer_height) for one in verdict.checks)
    return replace(verdict, checks=tuple(plain))


def _moved(one: Check, repeated: int, rise: float) -> Check:
    """A check of a few turns as one of all of them, without its map."""
    turn, point = one.turn, one.point
    if turn is not None and point is not None and turn > _FEW - 1:
        turn += repeated
        point = (point[0], point[1], point[2] + repeated * rise)
    return replace(one, turn=turn, point=point, utilisation=None)


def _verdict(
    loft: Loft, thickness: float, path: Toolpath, machine: Machine, purge: float, repeated: int
) -> Verdict:
    totals = _totals(path, machine, repeated)
    lean = np.zeros(len(path.turn)) if loft.prismatic else _lean(path)
    checks = [
        *_whole(path),
        *_motion(path, machine),
        *_turns(path, machine, lean),
        *_room(loft, thickness, path, repeated),
        *places(path, machine, purge, repeated),
        *_bead(path, machine),
        *_sums(totals, machine),
    ]
    units = {"turns": "", "length": "m", "time": "s", "mass": "kg", "laid": "m³", "surplus": "m³"}
    figures = {name: {"value": totals[name], "unit": unit} for name, unit in units.items()}
    return Verdict(tuple(checks), machine.name, path.inputs, figures)


def _totals(path: Toolpath, machine: Machine, repeated: int) -> dict[str, float]:
    """What the whole path comes to in SI, its one but last turn done ``repeated`` times more."""
    middle = (path.turn[:-1] >= path.turns - 2) & (path.turn[:-1] < path.turns - 1)
    weight = 1.0 + repeated * middle
    laid = float((weight * path.laid()).sum())
    return {
        "turns": path.turns + repeated,
        "length": float((weight * np.diff(path.arc)).sum()),
        "time": float((weight * np.diff(path.time)).sum()),
        "laid": laid,
        "surplus": max(laid - float((weight * path.held()).sum()), 0.0),
        "mass": laid * machine.value("density"),
    }


def _whole(path: Toolpath) -> Iterator[Check]:
    """One closed first turn, never down, never away."""
    start, end = path.points[0], path.points[np.searchsorted(path.turn, 1.0)]
    gap = float(np.hypot(*(end - start)[:2]))
    yield check("closure", gap / _CLOSED, gap, _CLOSED, None, Spot(1.0, end))
    drop = np.maximum(-np.diff(path.points[:, 2], prepend=path.points[0, 2]), 0.0)
    yield along("rising", path, drop, 1e-9)
    move = np.diff(path.arc, prepend=0.0)
    jump = np.maximum(move / path.step - 1, 0.0) / (_JUMP - 1)
    yield along("travel", path, move, _JUMP * path.step, share=jump)


def _motion(path: Toolpath, machine: Machine) -> Iterator[Check]:
    """What the motors have to do."""
    figure = machine.figures
    bend = np.maximum(np.abs(path.curvature), 1e-9)
    held = figure["acceleration_max"]
    limit, source = path.speed**2 / held.si, held
    if machine.axes == "four":
        turning = path.speed / figure["rotary_rate_max"].si
        hardest = np.argmax(np.maximum(turning, limit) * bend)
        source = figure["rotary_rate_max"] if turning[hardest] > limit[hardest] else held
        limit = np.maximum(turning, limit)
    yield along("curvature", path, 1 / bend, limit, source, below=True)
    rate = path.speed * path.curvature
    if machine.axes == "four":
        turning = figure["rotary_rate_max"]
        yield along("rotary_rate", path, np.abs(rate), turning.si, turning)
        spin = figure["rotary_acceleration_max"]
        speeding = np.abs(np.gradient(rate, path.time))
        yield along("rotary_acceleration", path, speeding, spin.si, spin)
    ahead = np.gradient(path.speed, path.time)
    force = np.hypot(ahead, path.speed * rate)
    yield along("acceleration", path, force, held.si, held)
    yield within("speed", path, np.where(path.full, path.speed, np.nan), machine)


def _turns(path: Toolpath, machine: Machine, lean: Vector) -> Iterator[Check]:
    """How a turn lies on the one below: not too soon, not too late, not beside it."""
    figure = machine.figures
    above = path.turn >= 1.0
    before = np.interp(path.turn - 1, path.turn, path.time)
    pause = np.where(above, path.time - before, path.time[np.searchsorted(path.turn, 1.0)])
    shortest, longest = figure["turn_time_min"], figure["turn_time_max"]
    yield along("turn_time_min", path, pause, shortest.si, shortest, below=True)
    yield along("turn_time_max", path, pause, longest.si, longest)

    thin = path.height < _THIN * path.layer_height
    angle = np.where(thin, 0.0, np.arctan2(lean, path.height))
    steepest = figure["overhang_max"]
    yield along("overhang", path, angle, steepest.si, steepest)

    half, under = path.width / 2, np.interp(path.turn - 1, path.turn, path.width) / 2
    contact = np.minimum(half, lean + under) - np.maximum(-half, lean - under)
    kept = np.where(above, contact / (2 * np.minimum(half, under)), 1.0)
    least = figure["overlap_min"]
    share = (1 - kept) / max(1 - least.si, 1e-9)
    yield along("overlap", path, kept, least.si, least, share, below=True)


def _lean(path: Toolpath) -> Vector:
    """How far each point (N,) lies beside the turn below, in plan and in m.

    The foot of the perpendicular is found on the path one turn before, by two steps of Newton.
    """
    x, y = path.points[:, 0], path.points[:, 1]
    heading = np.column_stack([np.cos(path.rotary), np.sin(path.rotary)])
    length = np.gradient(path.arc, path.turn)
    place = path.turn - 1
    for _ in range(2):
        ahead = (x - np.interp(place, path.turn, x)) * heading[:, 0]
        ahead += (y - np.interp(place, path.turn, y)) * heading[:, 1]
        place = place + ahead / length
    apart = np.hypot(x - np.interp(place, path.turn, x), y - np.interp(place, path.turn, y))
    return np.where(path.turn >= 1.0, apart, 0.0)


def _room(loft: Loft, thickness: float, path: Toolpath, repeated: int) -> Iterator[Check]:
    """Whether the wall, or the bead where it is wider, meets itself in a turn or between two."""
    last = round(path.turns) + repeated - 1 if path.turns > 1 else 1  # layers
    rise = path.layer_height
    count = 1 if loft.prismatic else last
    places = int(np.clip(len(path.turn) / path.turns, 64, 1024))
    levels = (np.arange(count, dtype=np.float64) + 0.5) * rise
    wide = np.where(path.full, np.maximum(path.width, thickness), thickness)
    around = np.arange(places) / places + np.arange(count)[:, None]
    if loft.prismatic and path.turns > 3:
        around += 2  # of the full turns, those that are as all others
    found = clearance(loft, levels, np.interp(around, path.turn, wide))

    level = np.clip(np.round(path.turn).astype(int) - 1, 0, count - 1)
    here = level, np.round(path.turn % 1 * places).astype(int) % places
    for name, room in (("room", found.room), ("room_between", found.between)):
        if name == "room_between" and count == 1:
            continue
        share = found.half / np.maximum(room, 1e-9)
        k, i = np.unravel_index(int(np.argmax(share)), share.shape)
        point = np.append(found.points[k, i], rise * (k + 1))
        spot = Spot(float(found.turn[i] + k + (k > 0)), point)
        at = float(share[k, i]), float(room[k, i]), float(found.half[k, i])
        yield check(name, *at, None, spot, share[here])


def _bead(path: Toolpath, machine: Machine) -> Iterator[Check]:
    """Height, width and flow of the bead where it is full."""
    full = path.full
    yield within("layer_height", path, np.where(full, path.layer_height, np.nan), machine)
    yield within("width", path, np.where(full, path.width, np.nan), machine)
    yield within("flow", path, np.where(full, path.flow, np.nan), machine)


def _sums(totals: dict[str, float], machine: Machine) -> Iterator[Check]:
    """What the whole print takes."""
    for name, limit in (("mass", "charge"), ("time", "time_max")):
        figure = machine.figures[limit]
        yield check(name, totals[name] / figure.si, totals[name], figure.si, figure)
