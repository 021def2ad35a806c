"""The flow coupon: a small stadium in bands of different speed, to be measured with a calliper."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .. import VERSION
from ..core.errors import ParameterError
from ..core.parameters import from_table, param, to_table
from ..core.scene import Vector
from ..core.table import save_csv
from .gcode import write_gcode
from .machine import Machine
from .outline import Outline
from .pace import Pace, pace
from .reach import places
from .surface import Loft
from .toolpath import Spiral, Toolpath, spiral

WHERE = "glass.coupon"
_POINTS = 1024
_STRAIGHT = 0.1  # of the ends' curvature: what bends less is a straight side


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupon:
    """A test piece for the flow: straight sides, and a bead that changes from band to band."""

    straight: float = param(0.1, "m", 1e-3, 1.0, "Length of the straight sides")
    radius: float = param(0.04, "m", 1e-3, 0.5, "Radius of the round ends, midway in the wall")
    width: float = param(8.0e-3, "m", 1e-4, 0.05, "Width of the bead in the middle band")
    layer_height: float = param(5.0e-3, "m", 1e-4, 2e-2, "Rise of one turn")
    bands: int = param(5, "", 2, 20, "How many widths are tried")
    turns: int = param(3, "", 2, 20, "Turns to a band")
    spread: float = param(0.12, "", 0.01, 0.8, "How far the outer bands' widths are off the middle")


@dataclass(frozen=True, slots=True)
class CouponPrint:
    """A coupon's path, and which band is which.

    ``bands`` are columns of one row a band: where it is, the path's speed and flow on its straight
    sides, and the width that comes of them if the flow is as the profile says. The flow that there
    really is, is the width that is measured there times layer height times speed.
    """

    loft: Loft
    path: Toolpath
    bands: dict[str, Vector]

    def save(self, folder: Path, machine: Machine) -> list[str]:
        """Write coupon.gcode and coupon.csv; returns their names. Raises FileError."""
        write_gcode(folder / "coupon.gcode", self.path, machine, name="Flow coupon")
        meta = {"heliform": VERSION, "machine": machine.name, "inputs": self.path.inputs}
        save_csv(folder / "coupon.csv", self.bands, meta)
        return ["coupon.gcode", "coupon.csv"]


def coupon(record: Coupon, machine: Machine) -> CouponPrint:
    """The path of a coupon, band upon band in one spiral, each with a speed of its own.

    The flow is the machine's throughout, so that the width is Q / (v h). Raises ParameterError when
    a value is out of bounds, a band asks for a speed that the machine has not, or the coupon is
    beyond the machine's reach or bed.
    """
    record = from_table(Coupon, to_table(record), WHERE)
    rise, flow = record.layer_height, machine.value("flow")
    widths = record.width * np.linspace(1 - record.spread, 1 + record.spread, record.bands)
    speeds = flow / (widths * rise)
    slowest, fastest = machine.value("speed_min"), machine.value("speed_max")
    if speeds.min() < slowest or speeds.max() > fastest:
        raise ParameterError(
            f"[{WHERE}] The bands ask for {speeds.min() * 1e3:.3g} to {speeds.max() * 1e3:.3g} "
            f"mm/s, and {machine.name} has {slowest * 1e3:.3g} to {fastest * 1e3:.3g}; lower the "
            "spread, or change width or layer_height."
        )
    layers = record.bands * record.turns
    outline = _stadium(record.straight, record.radius)
    loft = Loft((outline,), np.zeros(1), layers * rise)
    asked = Spiral(layer_height=rise, step=max(1e-5, min(2e-3, record.radius / 10)))
    path = spiral(loft, record.width, asked, machine)
    band = np.clip(path.turn // record.turns, 0, record.bands - 1).astype(int)
    given = Pace(path.arc, path.curvature, path.height, rise, widths[band], None)
    speed, width, given_flow, time = pace(given, machine)
    path = replace(path, speed=speed, width=width, flow=given_flow, time=time)
    for one in places(path, machine, 0.0):
        if not one.passed:
            raise ParameterError(f"[{WHERE}] {one.sentence}")
    straight = path.full & (np.abs(path.curvature) < _STRAIGHT / record.radius)
    gone = [straight & (band == row) for row in range(record.bands)]
    speeds = np.array([path.speed[there].mean() for there in gone])
    flows = np.array([path.flow[there].mean() for there in gone])
    first = np.arange(record.bands) * record.turns * rise
    bands = {
        "Band": np.arange(1, record.bands + 1),
        "From z (mm)": first * 1e3,
        "To z (mm)": (first + record.turns * rise) * 1e3,
        "Speed (mm/s)": speeds * 1e3,
        "Flow (mm³/s)": flows * 1e9,
        "Layer height (mm)": np.full(record.bands, rise * 1e3),
        "Expected width (mm)": flows / (speeds * rise) * 1e3,
    }
    return CouponPrint(loft, path, bands)


def _stadium(straight: float, radius: float) -> Outline:
    """Two straight sides along X and two half circles, from the middle of the right side's end."""
    bend = np.pi * radius
    length = 2 * (straight + bend)
    along = np.arange(_POINTS) * (length / _POINTS) + straight / 2
    corners = np.array([0.0, straight, straight + bend, 2 * straight + bend, length])
    along %= length
    piece = np.searchsorted(corners, along, side="right") - 1
    part = along - corners[piece]
    angle = part / radius - np.pi / 2 + np.pi * (piece > 1)
    end = np.where(piece < 2, straight / 2, -straight / 2)
    side = np.where(piece == 0, -1.0, 1.0)
    flat = piece % 2 == 0
    x = np.where(flat, side * (straight / 2 - part), end + radius * np.cos(angle))
    y = np.where(flat, side * radius, radius * np.sin(angle))
    return Outline(np.column_stack([x, y]))
