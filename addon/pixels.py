"""Drawing over a region: cards, lines, colour ramps and letters, in its pixels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

Colour = tuple[float, float, float, float]
Point = tuple[float, float]

CARD = (0.055, 0.06, 0.065, 0.86)
INK = (0.94, 0.95, 0.96, 1.0)
QUIET = (0.68, 0.71, 0.74, 1.0)
RULE = (1.0, 1.0, 1.0, 0.1)
_FONT = 0


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle in pixels of the region."""

    left: float
    bottom: float
    right: float
    top: float

    @property
    def width(self) -> float:
        return self.right - self.left

    @property
    def height(self) -> float:
        return self.top - self.bottom


def free_of(area: bpy.types.Area | None, region: bpy.types.Region, margin: float) -> Box:
    """What the sidebar, the tools and the headers leave free of the region."""
    left, bottom, right, top = 0.0, 0.0, float(region.width), float(region.height)
    for other in area.regions if area else ():
        if other.type == "WINDOW" or other.width <= 1 or other.height <= 1:
            continue
        x, y = other.x - region.x, other.y - region.y
        if other.alignment in ("LEFT",):
            left = max(left, x + other.width)
        elif other.alignment == "RIGHT":
            right = min(right, x)
        elif other.alignment == "TOP":
            top = min(top, y)
        elif other.alignment == "BOTTOM":
            bottom = max(bottom, y + other.height)
    return Box(left + margin, bottom + margin, right - margin, top - margin)


def ramp(bar: Box, table: np.ndarray) -> None:
    """The palette from the bottom up."""
    heights = np.linspace(bar.bottom, bar.top, len(table))
    points = np.empty((len(table), 2, 2), dtype=np.float32)
    points[:, 0, 0], points[:, 1, 0] = bar.left, bar.right
    points[..., 1] = heights[:, None]
    colours = np.ones((len(table), 2, 4), dtype=np.float32)
    colours[..., :3] = table[:, None] / 255
    batch("SMOOTH_COLOR", "TRI_STRIP", points.reshape(-1, 2), color=colours.reshape(-1, 4))


def rectangle(box: Box, colour: Colour) -> None:
    corners = [
        (box.left, box.bottom),
        (box.right, box.bottom),
        (box.left, box.top),
        (box.right, box.top),
    ]
    batch("UNIFORM_COLOR", "TRI_STRIP", corners, colour)


def lines(points: Sequence[Point], colour: Colour, thickness: float) -> None:
    """A line through the points, smooth at its edges."""
    if len(points) < 2:
        return
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    batch = batch_for_shader(shader, "LINE_STRIP", {"pos": [(x, y, 0.0) for x, y in points]})
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", thickness)
    shader.uniform_float("color", colour)
    _blended(batch, shader)


def batch(
    shader: str, kind: str, points: Any, colour: Colour | None = None, **attributes: Any
) -> None:
    program = gpu.shader.from_builtin(shader)
    batch = batch_for_shader(program, kind, {"pos": points, **attributes})
    if colour:
        program.uniform_float("color", colour)
    _blended(batch, program)


def _blended(batch: gpu.types.GPUBatch, shader: gpu.types.GPUShader) -> None:
    gpu.state.blend_set("ALPHA")  # for each: drawing a text switches it off
    batch.draw(shader)
    gpu.state.blend_set("NONE")


def write(
    text: str, x: float, y: float, unit: float, colour: Colour, width: float | None = None
) -> None:
    """A line of text, cut off with an ellipsis where it is wider than ``width``."""
    blf.size(_FONT, 11 * unit)
    if width and width_of(text, unit) > width:
        while text and width_of(f"{text}…", unit) > width:
            text = text[:-1]
        text += "…"
    blf.color(_FONT, *colour)
    blf.position(_FONT, x, y, 0)
    blf.draw(_FONT, text)


def width_of(text: str, unit: float) -> float:
    blf.size(_FONT, 11 * unit)
    return blf.dimensions(_FONT, text)[0]
