"""How fast a bead is laid down: speed from flow, held back by what the motors can do."""

from dataclasses import dataclass

import numpy as np

from ..core.scene import Vector
from .machine import Machine

# Shares of the accelerations, with some room for what happens between points.
_ACROSS, _ALONG = 0.75, 0.55  # going around bends, and speeding up
_BENDING, _HASTING = 0.45, 0.45  # of the bed: for changing bends, and for changing speed


@dataclass(frozen=True, slots=True)
class Pace:
    """A path to be timed: ``arc``, ``curvature`` and bead ``height``, (N,) each in m and 1/m.

    ``rise`` is the full layer height and ``thickness`` the wall's in m, (N,) where it changes;
    ``speed`` in m/s is the one asked for, or None for that of the machine's flow.
    """

    arc: Vector
    curvature: Vector
    height: Vector
    rise: float
    thickness: float | Vector
    speed: float | None


def pace(path: Pace, machine: Machine) -> tuple[Vector, Vector, Vector, Vector]:
    """Speed in m/s, bead width in m, flow in m³/s and time in s at each point, (N,) each.

    v = Q / (w h), within the machine's speeds. Bends slow it so that the bed turns no faster than
    it can, v κ ≤ ω, and the motors hold it, v² κ ≤ a; changes of bend and of speed so that both
    accelerations are kept. Where the melt runs at one flow, the width takes what the speed leaves,
    w = Q / (v h), and speed is held back no further than the widest bead of full height allows; in
    the ramps, where the height begins and ends at 0, what the widest bead cannot hold is surplus.
    Otherwise the flow follows and the width is the wall's thickness.
    """
    m = machine.value
    slowest, fastest = m("speed_min"), m("speed_max")
    runs = machine.extrusion == "none"
    nominal = m("flow") / (path.thickness * path.rise)
    height = np.maximum(path.height, 1e-9 * path.rise)
    if path.speed is not None:
        wanted = np.full(len(height), path.speed)
    elif runs:
        wanted = nominal * path.rise / height
    else:
        wanted = np.full(len(height), nominal)
    wanted = np.clip(wanted, slowest, fastest)
    if runs:
        floor = m("flow") / (m("width_max") * path.rise)
    else:
        floor = m("flow_min") / (path.thickness * path.rise)
    floor = np.minimum(np.maximum(floor, slowest), wanted)
    speed = _held_back(path, machine, wanted, floor)

    if runs:
        flow = np.full(len(speed), m("flow"))
        width = flow / (speed * height)
        ramp = path.height < path.rise * (1 - 1e-9)
        width[ramp] = np.minimum(width[ramp], m("width_max"))
    else:
        width = np.full(len(speed), path.thickness)
        flow = width * path.height * speed
    step = 2 * np.diff(path.arc) / (speed[1:] + speed[:-1])
    return speed, width, flow, np.concatenate([[0.0], np.cumsum(step)])


def _held_back(path: Pace, machine: Machine, wanted: Vector, floor: Vector) -> Vector:
    """The speed that the motors allow, not below ``floor`` but where speeding up to it takes time.

    A bend's cap leaves room for speeding up, and the two together keep to the acceleration.
    """
    bend = np.abs(path.curvature)
    tiny = np.finfo(float).tiny
    hold = machine.value("acceleration_max")
    cap = np.minimum(wanted, np.sqrt(_ACROSS * hold / np.maximum(bend, tiny)))
    gain = np.full(len(bend), _ALONG * hold)
    if machine.axes == "four":
        spin = machine.value("rotary_acceleration_max")
        change = np.abs(np.gradient(path.curvature, path.arc))
        cap = np.minimum(cap, machine.value("rotary_rate_max") / np.maximum(bend, tiny))
        cap = np.minimum(cap, np.sqrt(_BENDING * spin / np.maximum(change, tiny)))
        gain = np.minimum(gain, _HASTING * spin / np.maximum(bend, tiny))
    square = np.maximum(cap, floor) ** 2
    # More room than the fastest speed needs limits nothing, and its sum would swallow digits.
    room = np.minimum(np.minimum(gain[1:], gain[:-1]) * 2 * np.diff(path.arc), square.max())
    reached = np.concatenate([[0.0], np.cumsum(room)])
    square = np.minimum.accumulate(square - reached) + reached
    square = (np.minimum.accumulate((square + reached)[::-1]) - reached[::-1])[::-1]
    return np.sqrt(square)
