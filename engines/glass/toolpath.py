"""The spiral toolpath: one continuous line from the bed to the rim, evaluated on the loft."""

import hashlib
import json
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.parameters import from_table, param, to_table
from ..core.scene import Vector
from .machine import Machine
from .pace import Pace, pace
from .surface import Loft

WHERE = "glass.spiral"
_COARSE = 256  # places around a turn by which the points are spaced
_FINEST = 0.05  # of the step, the closest that points stand in a tight bend
_MOST = 4_000_000  # points


@dataclass(frozen=True, slots=True, kw_only=True)
class Spiral:
    """How a wall is laid down in one continuous line."""

    layer_height: float = param(
        5.0e-3, "m", 1e-4, 2e-2, "Rise of one turn; adjusted so that whole turns reach the top"
    )
    step: float = param(2.0e-3, "m", 1e-5, 2e-2, "Longest distance between points of the path")
    chord: float = param(
        1.0e-5, "m", 1e-7, 1e-3, "How far the straight moves may cut a bend; sets the step there"
    )
    pace: Literal["flow", "speed"] = param(
        "flow", help="Speed from the machine's flow, or a speed of its own"
    )
    speed: float = param(5.0e-3, "m/s", 1e-4, 1.0, "Speed at the nozzle, where it has its own")
    purge: float = param(
        0.02, "m", 0.0, 0.5, "How far outside the wall's start the purge is; 0 leaves it out"
    )


@dataclass(frozen=True, slots=True)
class Toolpath:
    """A path of the nozzle of N points, all arrays float64.

    ``points`` (N, 3) in m are the nozzle's tip, ``turn`` (N,) counts turns from 0, ``arc`` (N,) is
    the length gone in m, ``rotary`` (N,) the unwrapped angle of the path in plan in rad.
    ``width``, ``height``, ``speed`` and ``flow`` (N,) are the bead's width and its height above
    what lies below in m, the speed in m/s and the flow in m³/s; ``time`` (N,) in s;
    ``curvature`` (N,) in 1/m that of the path in plan, positive where it is convex.

    ``layer_height`` in m is the rise of a turn, ``step`` in m the longest distance between points
    that was asked for, ``inputs`` the hash of what the path was made of.
    """

    points: Vector
    turn: Vector
    arc: Vector
    rotary: Vector
    width: Vector
    height: Vector
    speed: Vector
    time: Vector
    flow: Vector
    curvature: Vector
    layer_height: float
    step: float
    inputs: str

    @property
    def turns(self) -> float:
        """How many turns the path goes around."""
        return float(self.turn[-1])

    @property
    def seconds(self) -> float:
        """How long the path takes in s."""
        return float(self.time[-1])

    @property
    def full(self) -> NDArray[np.bool_]:
        """Where (N,) the bead has its full height: all but the two turns that are ramps."""
        return self.height > self.layer_height * (1 - 1e-9)

    @property
    def sides(self) -> Vector:
        """Unit vectors (N, 2) in plan to the right of the path, outward on a wall."""
        return np.column_stack([np.sin(self.rotary), -np.cos(self.rotary)])

    def laid(self) -> Vector:
        """What the nozzle lays down from each point to the next in m³ (N − 1,)."""
        return self._between(self.flow) * np.diff(self.time)

    def held(self) -> Vector:
        """What the bead's width and height hold from each point to the next in m³ (N − 1,)."""
        return self._between(self.width * self.height) * np.diff(self.arc)

    def _between(self, values: Vector) -> Vector:
        """Means from each point to the next of what breaks off where the first ramp begins."""
        ends = values[1:].copy()
        foot = self.turn[1:] == 1.0
        ends[foot] = values[:-1][foot]
        return (values[:-1] + ends) / 2


def spiral(loft: Loft, thickness: float, record: Spiral, machine: Machine) -> Toolpath:
    """The path that prints a wall of ``thickness`` in m as one bead wide.

    The height is divided into n whole layers h. The first turn lies flat at the nozzle's height h;
    then the path rises by h a turn, with the length gone around, up to the top; the last turn is
    flat again. So the bead's own height ramps from 0 to h in the second turn and back in the last,
    and width times height around the path is the wall's volume. Everywhere the path lies on the
    loft, half a layer below the nozzle: nothing jumps at the end of a turn, and the ramps lie
    right above the beads that carry them.

    Raises ParameterError when a value of ``record`` is out of bounds, the height holds no layer or
    the path would have more than four million points.
    """
    record = from_table(Spiral, to_table(record), WHERE)
    layers = round(loft.height / record.layer_height)
    if layers < 1:
        raise ParameterError(
            f"[{WHERE}] A height of {loft.height * 1e3:.4g} mm holds no layer of "
            f"{record.layer_height * 1e3:.4g} mm; raise the wall or lower the layer height."
        )
    return wound(loft, thickness, record, machine, layers, loft.height / layers)


def wound(
    loft: Loft, thickness: float, record: Spiral, machine: Machine, layers: int, rise: float
) -> Toolpath:
    """`spiral` of just so many layers of height ``rise`` in m, whatever the loft's height is."""
    turns = layers + 1 if layers > 1 else 1
    turn = _spaced(loft, record, turns, layers, rise)
    level = rise * np.clip(turn, 1.0, layers)
    height = np.where(turn < 1.0, rise, level - rise * np.clip(turn - 1.0, 1.0, layers))
    if turns > 1:
        height[turn == 1.0] = 0.0  # the ramp's foot, not the end of the first turn
    place = loft.at(turn, level - rise / 2)
    climb = rise * ((turn >= 1.0) & (turn < layers))
    heading = place.along[:, :2] + place.rise[:, :2] * climb[:, None]
    points = np.column_stack([place.points[:, :2], level])
    length = np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1))
    arc = np.concatenate([[0.0], np.cumsum(length)])
    given = Pace(
        arc=arc,
        curvature=place.curvature,
        height=height,
        rise=rise,
        thickness=thickness,
        speed=record.speed if record.pace == "speed" else None,
    )
    speed, width, flow, time = pace(given, machine)
    return Toolpath(
        points=points,
        turn=turn,
        arc=arc,
        rotary=np.unwrap(np.arctan2(heading[:, 1], heading[:, 0])),
        width=width,
        height=height,
        speed=speed,
        time=time,
        flow=flow,
        curvature=place.curvature,
        layer_height=rise,
        step=record.step,
        inputs=inputs_of(loft, thickness, record, machine),
    )


def inputs_of(loft: Loft, thickness: float, record: Spiral, machine: Machine) -> str:
    """Sixteen hex digits that name what a path is made of: wall, spiral and machine.

    Places count to a nanometre, so that the same wall has the same name on every machine.
    """
    digest = hashlib.sha256()
    for one in loft.outlines:
        digest.update(np.round(one.points * 1e9).astype(np.int64).tobytes())
    shape = [*np.atleast_1d(loft.levels), loft.height, loft.twist, loft.scale, thickness]
    said = [[f"{float(v):.9g}" for v in shape], to_table(record), machine.digest]
    digest.update(json.dumps(said, sort_keys=True).encode())
    return digest.hexdigest()[:16]


def _spaced(loft: Loft, record: Spiral, turns: int, layers: int, rise: float) -> Vector:
    """The turns at which the path has points, each whole turn among them.

    Their distance is the step, or less where a chord of that length would cut the bend too far.
    """
    distinct = 1 if loft.prismatic else turns
    coarse = np.arange(distinct * _COARSE + 1) / _COARSE
    place = loft.at(coarse, rise * np.clip(coarse, 1.0, layers) - rise / 2)
    bend = np.sqrt(np.abs(place.curvature) / (8 * record.chord))
    crowd = np.maximum(np.minimum(bend, 1 / (_FINEST * record.step)), 1 / record.step)
    climb = rise * ((coarse >= 1.0) & (coarse < layers))
    density = np.hypot(*(place.along + place.rise * climb[:, None])[:, :2].T) * crowd
    total = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / (2 * _COARSE))])
    whole = total[::_COARSE]
    counts = np.maximum(np.ceil(np.diff(whole) * (1 + 1e-3)), 16)
    if counts.sum() * (turns / distinct) > _MOST:
        raise ParameterError(
            f"[{WHERE}] The path would have more than {_MOST // 1_000_000} million points; raise "
            "step or chord, or lower the wall."
        )
    ends = np.concatenate([[0.0], np.cumsum(counts)])
    along = np.interp(np.arange(ends[-1] + 1), ends, whole)
    found = np.interp(along, total, coarse)
    found[ends.astype(np.intp)] = np.arange(distinct + 1)
    if distinct == turns:
        return found
    return np.append((np.arange(turns)[:, None] + found[:-1]).ravel(), float(turns))
