"""Walls, machines and paths that several tests print."""

import tomllib
from typing import Any

import numpy as np
import shapely
from heliform.engines.glass.fourier import Plan, plan_outline
from heliform.engines.glass.machine import DATA, Machine, machine_of
from heliform.engines.glass.outline import Outline
from heliform.engines.glass.surface import Loft
from heliform.engines.glass.toolpath import Spiral, Toolpath, spiral

THICKNESS = 8e-3


def table(profile: str = "glass-printer") -> dict[str, Any]:
    """A shipped profile as a plain table, to be changed."""
    return tomllib.loads((DATA / f"{profile}.toml").read_text(encoding="utf-8"))


def machine(profile: str = "glass-printer", **changes: Any) -> Machine:
    """A shipped profile with other values: figures in their own units, axes or extrusion."""
    found = table(profile)
    for name, value in changes.items():
        if name in found["figures"]:
            found["figures"][name]["value"] = value
        elif name in found:
            found[name] = value
        else:
            found["gcode"][name] = value
    return machine_of(found, "test")


def roomy(**changes: Any) -> Machine:
    """A glass printer that extrudes and whose limits are far away, but for those named."""
    wide = {
        "extrusion": "volumetric",
        "layer_height_min": 0.1,
        "layer_height_max": 50.0,
        "width_min": 0.1,
        "width_max": 100.0,
        "speed_min": 0.01,
        "speed_max": 1000.0,
        "acceleration_max": 1e6,
        "rotary_rate_max": 1e6,
        "rotary_acceleration_max": 1e6,
        "turn_time_min": 0.0,
        "turn_time_max": 1e6,
        "time_max": 1e3,
        "flow_min": 0.0,
        "flow_max": 1e5,
        "charge": 1e3,
        "reach_x": 5000.0,
        "reach_y": 5000.0,
        "reach_z": 5000.0,
        "bed_x": 5000.0,
        "bed_y": 5000.0,
        "overhang_max": 89.0,
        "overlap_min": 0.0,
    }
    return machine(**(wide | changes))


def circle(radius: float = 0.1, height: float = 0.05, **changes: float) -> Loft:
    """A round tube, or a cone or twisted one."""
    return Loft((plan_outline(Plan(radius=radius)),), np.zeros(1), height, **changes)


def lobed(radius: float = 0.1, height: float = 0.05, waves=3, wave=0.1, **changes: float) -> Loft:
    """A tube with waves around."""
    plan = Plan(radius=radius, period_1=waves, amplitude_1=wave)
    return Loft((plan_outline(plan),), np.zeros(1), height, **changes)


def blended(height: float = 0.05) -> Loft:
    """A tube with waves that become others further up."""
    plans = (
        Plan(radius=0.1, period_1=3, amplitude_1=0.1),
        Plan(radius=0.09, period_1=4, amplitude_1=0.1),
    )
    return Loft(tuple(plan_outline(p) for p in plans), np.array([0.0, 1.0]), height)


def polar(radius, height: float = 0.05) -> Loft:
    """A tube of any polar curve ``radius(θ)`` in m, as it is: not cleared of overlaps."""
    theta = np.linspace(0, 2 * np.pi, 32768, endpoint=False)
    return tube(radius(theta) * np.exp(1j * theta), height)


def waist(gap: float, height: float = 0.05) -> Loft:
    """Two bellies along X and a straight corridor between them, ``gap`` in m across."""
    bellies = [shapely.Point(x, 0).buffer(0.04, quad_segs=512) for x in (-0.06, 0.06)]
    corridor = shapely.box(-0.06, -gap / 2, 0.06, gap / 2)
    bone = shapely.union_all([*bellies, corridor]).buffer(0.012, 512).buffer(-0.012, 512)
    assert isinstance(bone, shapely.Polygon)
    x, y = np.array(shapely.segmentize(bone.exterior, 1e-4).coords)[:-1].T
    plane = x + 1j * y
    plane = plane if bone.exterior.is_ccw else plane[::-1]
    return tube(np.roll(plane, -int(np.argmax(plane.real))), height)


def tube(plane, height: float, count: int = 2048) -> Loft:
    """A tube of a closed polyline x + iy in m, as it is."""
    arc = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(plane, append=plane[:1])))])
    even = np.arange(count) * arc[-1] / count
    closed = np.append(plane, plane[0])
    points = np.column_stack([np.interp(even, arc, closed.real), np.interp(even, arc, closed.imag)])
    return Loft((Outline(points),), np.zeros(1), height)


LOFTS = {
    "tube": circle(),
    "lobed": lobed(),
    "cone": circle(scale=0.8),
    "twisted": lobed(twist=0.4),
    "blended": blended(),
}


def path_on(loft: Loft, printer: Machine | None = None, **changes: Any) -> Toolpath:
    """The path of a wall of 8 mm on a roomy machine."""
    return spiral(loft, THICKNESS, Spiral(**changes), printer or roomy())
