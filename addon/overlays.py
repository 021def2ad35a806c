"""What is drawn over the 3D view: the legend of the shown result, and the plot of its section.

Everything comes from what lies with the picture; nothing is computed here but pixels.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..engines.core.colour import Axis
from .bridge import results
from .bridge.sections import section_of

Colour = tuple[float, float, float, float]
Point = tuple[float, float]

_CARD = (0.055, 0.06, 0.065, 0.86)
_INK = (0.94, 0.95, 0.96, 1.0)
_QUIET = (0.68, 0.71, 0.74, 1.0)
_RULE = (1.0, 1.0, 1.0, 0.1)
_CURVES = (
    ("illuminance", "All light", (0.34, 0.71, 0.91, 1.0)),
    ("caustic", "Caustic", (0.9, 0.62, 0.0, 1.0)),
    ("direct", "Direct", (0.8, 0.47, 0.65, 1.0)),
)  # told apart by the colour-blind [Okabe & Ito 2008]
_DECADES = 1e4
"""What a logarithmic section spans."""
_BAND = (0.34, 0.71, 0.91, 0.25)
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


def draw(context: bpy.types.Context) -> None:
    """Draw the legend and the section of the scene's shown result into the context's region."""
    settings = context.scene.heliform
    overlay = context.space_data.overlay if context.space_data else None
    picture = settings.shown
    if (
        not settings.legend
        or not results.is_result(picture)
        or (overlay and not overlay.show_overlays)
    ):
        return
    unit = context.preferences.system.ui_scale
    room = free_of(context.area, context.region, 12 * unit)
    legend = _draw_legend(picture, room, unit)
    section = section_of(picture)
    if section:
        scale = results.legend_of(picture)
        _draw_section(section, room, legend, scale is None or scale.log, unit)


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


# The legend


def _draw_legend(picture: bpy.types.Image, room: Box, unit: float) -> Box:
    """A card at the right, below the view's own gizmos; returns where it lies."""
    scale, meta = results.legend_of(picture), results.meta_of(picture)
    line, pad, bar_width = 17 * unit, 10 * unit, 16 * unit
    name = results.name_of(picture)
    if scale:
        heading = [scale.quantity, f"{name}, {scale.unit}"]
    else:
        heading = ["Colour", f"{name}, white {results.white_of(picture):.3g} {meta['unit']}"]
    photons = meta["photons"]["emitted"]
    footing = [f"{_count(photons)} photons"] * bool(photons)
    if meta["error"]:
        footing.insert(0, f"error {100 * meta['error']:.0f} %")
    bar_height = min(240 * unit, room.height - (len(heading) + len(footing) + 2) * line - 2 * pad)
    if bar_height < 40 * unit:
        return Box(room.right, room.bottom, room.right, room.bottom)
    if scale is None:
        bar_height = 0.0
    ticks = scale.ticks(8 if bar_height > 150 * unit else 4) if scale else []
    texts = [*heading, *footing]
    width = max(
        *(_width(text, unit) for text in texts),
        bar_width + 12 * unit + max((_width(text, unit) for _, text in ticks), default=0.0),
    )
    height = bar_height + (len(texts) + 1.2) * line + pad
    width = min(width, 220 * unit)
    card = Box(room.right - width - 2 * pad, room.bottom, room.right, room.bottom + height + pad)
    _rectangle(card, _CARD)
    y = card.top - pad
    for index, text in enumerate(heading):
        y -= line
        _text(text, card.left + pad, y + 4 * unit, unit, _INK if index == 0 else _QUIET, width)
    top = y - line / 2
    bar = Box(card.left + pad, top - bar_height, card.left + pad + bar_width, top)
    if scale:
        _ramp(bar, scale.table())
    for position, text in ticks:
        y = bar.bottom + position * bar.height
        _lines([(bar.right, y), (bar.right + 4 * unit, y)], _QUIET, unit)
        _text(text, bar.right + 9 * unit, y - 4 * unit, unit, _INK)
    y = bar.bottom - line / 2
    for text in footing:
        y -= line
        _text(text, card.left + pad, y + 2 * unit, unit, _QUIET)
    return card


def _ramp(bar: Box, table: np.ndarray) -> None:
    """The palette from the bottom up."""
    heights = np.linspace(bar.bottom, bar.top, len(table))
    points = np.empty((len(table), 2, 2), dtype=np.float32)
    points[:, 0, 0], points[:, 1, 0] = bar.left, bar.right
    points[..., 1] = heights[:, None]
    colours = np.ones((len(table), 2, 4), dtype=np.float32)
    colours[..., :3] = table[:, None] / 255
    _batch("SMOOTH_COLOR", "TRI_STRIP", points.reshape(-1, 2), color=colours.reshape(-1, 4))


# The section


def _draw_section(section: dict[str, Any], room: Box, legend: Box, log: bool, unit: float) -> None:
    """A card at the left with axes, curves and the interval of the first as a band."""
    width = min(460 * unit, legend.left - room.left - 12 * unit)
    height = min(230 * unit, room.height * 0.5)
    if width < 180 * unit or height < 110 * unit:
        return
    card = Box(room.left, room.bottom, room.left + width, room.bottom + height)
    _rectangle(card, _CARD)
    along = np.array(section["distance"])
    curves = {name: np.array(section[name], dtype=float) for name, *_ in _CURVES}
    lower, upper = (np.array(section[name], dtype=float) for name in ("lower", "upper"))
    x_axis = Axis(0.0, float(along[-1] + along[0]), False)
    high = 1.05 * float(np.nanmax([1e-6, *upper, *np.concatenate(list(curves.values()))]))
    y_axis = Axis(high / _DECADES if log else 0.0, high, log)
    y_ticks = y_axis.ticks(5)
    inner = Box(
        card.left + 16 * unit + max(_width(text, unit) for _, text in y_ticks),
        card.bottom + 26 * unit,
        card.right - 14 * unit,
        card.top - 30 * unit,
    )
    title = f"{section['receiver']}: {section['quantity'].lower()}, {section['unit']}"
    _text(title, card.left + 10 * unit, card.top - 19 * unit, unit, _INK, inner.width / 2)
    _draw_key(card, unit)
    for position, text in y_ticks:
        y = inner.bottom + position * inner.height
        _lines([(inner.left, y), (inner.right, y)], _RULE, unit)
        _text(text, inner.left - 6 * unit - _width(text, unit), y - 4 * unit, unit, _QUIET)
    for position, text in x_axis.ticks(6):
        x = inner.left + position * inner.width
        x = min(x - _width(text, unit) / 2, inner.right + 8 * unit - _width(f"{text} m", unit))
        _text(f"{text} m", x, card.bottom + 9 * unit, unit, _QUIET)
    _lines([(inner.left, inner.bottom), (inner.right, inner.bottom)], _QUIET, unit)
    x = inner.left + x_axis.position(along) * inner.width
    _band(x, *(inner.bottom + y_axis.position(v) * inner.height for v in (lower, upper)))
    for name, _, colour in reversed(_CURVES):
        y = inner.bottom + y_axis.position(curves[name]) * inner.height
        for run in _runs(y):
            _lines(list(zip(x[run].tolist(), y[run].tolist(), strict=True)), colour, 1.5 * unit)


def _draw_key(card: Box, unit: float) -> None:
    """A dash and a name a curve, at the card's upper right."""
    right, y = card.right - 14 * unit, card.top - 19 * unit
    for _, name, colour in reversed(_CURVES):
        right -= _width(name, unit)
        _text(name, right, y, unit, _INK)
        _lines(
            [(right - 18 * unit, y + 4 * unit), (right - 6 * unit, y + 4 * unit)], colour, 2 * unit
        )
        right -= 30 * unit


def _band(x: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> None:
    for run in _runs(lower + upper):
        if run.stop - run.start > 1:
            pairs = np.stack([np.stack([x, edge], axis=-1)[run] for edge in (lower, upper)], axis=1)
            _batch("UNIFORM_COLOR", "TRI_STRIP", pairs.reshape(-1, 2).astype("f4"), _BAND)


def _runs(values: np.ndarray) -> Iterable[slice]:
    """The stretches that are numbers."""
    ends = np.flatnonzero(np.diff(np.isfinite(values), prepend=False, append=False))
    return [slice(first, last) for first, last in ends.reshape(-1, 2).tolist()]


# Pixels


def _rectangle(box: Box, colour: Colour) -> None:
    corners = [
        (box.left, box.bottom),
        (box.right, box.bottom),
        (box.left, box.top),
        (box.right, box.top),
    ]
    _batch("UNIFORM_COLOR", "TRI_STRIP", corners, colour)


def _lines(points: Sequence[Point], colour: Colour, thickness: float) -> None:
    """A line through the points, smooth at its edges."""
    if len(points) < 2:
        return
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    batch = batch_for_shader(shader, "LINE_STRIP", {"pos": [(x, y, 0.0) for x, y in points]})
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", thickness)
    shader.uniform_float("color", colour)
    _blended(batch, shader)


def _batch(
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


def _text(
    text: str, x: float, y: float, unit: float, colour: Colour, width: float | None = None
) -> None:
    """A line of text, cut off with an ellipsis where it is wider than ``width``."""
    blf.size(_FONT, 11 * unit)
    if width and _width(text, unit) > width:
        while text and _width(f"{text}…", unit) > width:
            text = text[:-1]
        text += "…"
    blf.color(_FONT, *colour)
    blf.position(_FONT, x, y, 0)
    blf.draw(_FONT, text)


def _width(text: str, unit: float) -> float:
    blf.size(_FONT, 11 * unit)
    return blf.dimensions(_FONT, text)[0]


def _count(number: int) -> str:
    return f"{number / 1e6:.1f} M" if number >= 1e6 else f"{number:,}".replace(",", "\u2009")


_handle: Any = None


def register() -> None:
    """Draw over every 3D view."""
    global _handle

    def in_view() -> None:
        draw(bpy.context)

    _handle = bpy.types.SpaceView3D.draw_handler_add(in_view, (), "WINDOW", "POST_PIXEL")


def unregister() -> None:
    """Draw no more."""
    global _handle
    bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
    _handle = None
