"""Blender's own lights as luminaires.

Blender's power is the radiant flux in W of white light, and a Sun's strength the irradiance in
W/m² across its rays; tests/addon/test_blender_lights.py measures both with Cycles.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.errors import SceneError
from ...engines.core.parameters import canonical, param
from ...engines.core.scene import Lamp, Luminaire
from ..properties import read
from .materials import Unclear, luminance, output_of, source_of, values_of

_MARGIN = 0.01  # of what a sun lights: how far its beam reaches beyond on each side
_HALF_SPACE = np.pi * (1 - 1e-4)
_FILE = "add a Heliform lamp with an IES file"


@dataclass(frozen=True, slots=True, kw_only=True)
class BlenderLight:
    """What Heliform has to know of a Blender light besides what Blender says."""

    efficacy: float = param(
        179.0, "lm/W", 1.0, 683.0, "Luminous flux of a watt of white light; Radiance takes 179"
    )


@dataclass(frozen=True, slots=True)
class LightReading:
    """A Blender light as it was understood, in its own axes and metres.

    A sun's lamp is a beam of 1 m × 1 m, so that its flux in lm is its illuminance in lx. Each of
    ``notes`` says what was left out or taken otherwise.
    """

    lamp: Lamp
    notes: tuple[str, ...] = ()


def is_sun(obj: bpy.types.Object) -> bool:
    """Whether an object is a light of infinite distance."""
    return obj.type == "LIGHT" and obj.data.type == "SUN"


def read_light(obj: bpy.types.Object, scale: float = 1.0) -> LightReading:
    """The lamp that a Blender light is; ``scale`` is the metres in a Blender unit.

    Raises SceneError, naming the light and the remedy, for a Spot and what else has no lamp.
    """
    light = obj.data
    try:
        if light.type not in _KINDS:
            raise Unclear("is a Spot, whose cone is not read", f"{_FILE} instead")
        watts = light.energy * 2**light.exposure * luminance(_colour(light))
        if watts <= 0:
            raise Unclear("gives no light", "raise its Power or Strength")
        efficacy = read(obj.heliform.blender_light, BlenderLight).efficacy
        return _KINDS[light.type](light, canonical(efficacy * watts), scale)
    except Unclear as said:
        remedy = said.remedy or "use a Heliform lamp instead"
        raise SceneError(f"Light “{obj.name}” {said}; {remedy}.") from None


def widened(sun: Luminaire, illuminance: float, points: Sequence[NDArray[np.float64]]) -> Luminaire:
    """A sun as a beam just above ``points`` (N, 3) m, and as wide as they are seen from it.

    ``illuminance`` in lx is that across the beam. Raises SceneError where there are no points.
    """
    if not points:
        raise SceneError(f"Sun “{sun.name}” has nothing to shine on; add a body or a receiver.")
    pose = sun.pose.copy()
    axes = pose[:3, :3] / np.linalg.norm(pose[:3, :3], axis=0)
    local = np.concatenate(points) @ axes
    low, high = local.min(axis=0), local.max(axis=0)
    margin = _MARGIN * np.linalg.norm(high - low)
    length, width, _ = high - low + 2 * margin
    pose[:3, :3] = axes
    pose[:3, 3] = axes @ [*(low + high)[:2] / 2, high[2] + margin]
    flux = illuminance * width * length
    lamp = replace(sun.lamp, flux=float(flux), width=float(width), length=float(length))
    return Luminaire(sun.name, lamp, pose)


def _point(light: Any, flux: float, scale: float) -> LightReading:
    radius = 1e3 * scale * light.shadow_soft_size
    notes = (f"Its ball of {radius:.3g} mm radius is taken as a point.",) if radius else ()
    return LightReading(Lamp(source="point", flux=flux), notes)


def _area(light: Any, flux: float, scale: float) -> LightReading:
    if not light.normalize:
        raise Unclear("grows brighter with its size", "tick Normalize")
    if getattr(getattr(light, "cycles", None), "is_portal", False):
        raise Unclear("is a portal, which gives no light of its own", "untick Portal")
    if light.spread < _HALF_SPACE:
        spread = f"has a Spread of {np.degrees(light.spread):.0f}°, which is not read"
        raise Unclear(spread, f"set it to 180°, or {_FILE}")
    if light.shape == "ELLIPSE":
        raise Unclear("is an Ellipse, which no lamp is", "make it a Disk or a Rectangle")
    length = canonical(light.size * scale)
    width = canonical((light.size_y if light.shape == "RECTANGLE" else light.size) * scale)
    opening = "round" if light.shape == "DISK" else "rectangular"
    return LightReading(Lamp(source="disk", flux=flux, opening=opening, width=width, length=length))


def _sun(light: Any, illuminance: float, scale: float) -> LightReading:
    beam = Lamp(source="beam", flux=illuminance, opening="rectangular", width=1.0, length=1.0)
    angle = np.degrees(light.angle)
    notes = (f"Its angle of {angle:.2g}° is left out: all rays are parallel.",) if angle else ()
    return LightReading(beam, notes)


_KINDS: dict[str, Callable[[Any, float, float], LightReading]] = {
    "POINT": _point,
    "AREA": _area,
    "SUN": _sun,
}


def _colour(light: Any) -> list[float]:
    """The light's colour times those of its temperature and its Emission node."""
    colour = np.array(light.color)
    if light.use_temperature:
        colour = colour * light.temperature_color
    if light.node_tree is None:
        return list(colour)
    source = source_of(output_of(light.node_tree).inputs["Surface"])
    if source is None or source.node.type != "EMISSION":
        raise Unclear("has nodes other than a plain Emission")
    values = values_of(source.node)
    return list(colour * values["Color"][:3] * values["Strength"])
