"""What is drawn over the 3D view: the legend and marks of what is shown, and plots of sections.

Everything comes from what lies with the picture or the layer; nothing is computed here but
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from ..engines.core.colour import Axis, ColourScale
from .bridge import layers, results, sun
from .bridge.handles import owner_of
from .bridge.sections import section_of
from .pixels import (
    CARD,
    INK,
    QUIET,
    RULE,
    Box,
    batch,
    free_of,
    lines,
    ramp,
    rectangle,
    width_of,
    write,
)

_CURVES = (
    ("illuminance", "All light", (0.34, 0.71, 0.91, 1.0)),
    ("caustic", "Caustic", (0.9, 0.62, 0.0, 1.0)),
    ("direct", "Direct", (0.8, 0.47, 0.65, 1.0)),
)  # told apart by the colour-blind [Okabe & Ito 2008]
_DECADES = 1e4
"""What a logarithmic section spans."""
_BAND = (0.34, 0.71, 0.91, 0.25)
_MARK = (1.0, 0.36, 0.2, 1.0)


@dataclass(frozen=True, slots=True)
class _Legend:
    """A card's lines, and between them a scale, swatches, or nothing for the light's own colour."""

    heading: list[str]
    scale: ColourScale | None
    footing: list[str]
    swatches: list[tuple[str, tuple[int, int, int]]] = field(default_factory=list)


def draw(context: bpy.types.Context) -> None:
    """Draw the legend of the active object's layer, else of the scene's shown result.

    That of a study of sun and sky is there beside another object's layer, and alone.
    """
    settings = context.scene.heliform
    overlay = context.space_data.overlay if context.space_data else None
    if not settings.legend or (overlay and not overlay.show_overlays):
        return
    unit = context.preferences.system.ui_scale
    room = free_of(context.area, context.region, 12 * unit)
    obj = owner_of(context.object)
    shown = [obj] if layers.layer_of(obj) else []
    if not shown and results.is_result(settings.shown):
        _draw_result(settings.shown, room, unit)
        return
    studied = sun.staged_on(context.scene)
    if obj not in studied:  # what a structure that is dragged does to its shade
        shown += studied[:1]
    for one in shown:
        card = _draw_layer(context, one, room, unit)
        room = Box(room.left, room.bottom, card.left - 12 * unit, room.top)


def _draw_layer(context: bpy.types.Context, obj: bpy.types.Object, room: Box, unit: float) -> Box:
    """The marks and the legend of an object's layer; returns where the legend lies."""
    layer = layers.layer_of(obj)
    if layer is None:
        return Box(room.right, room.bottom, room.right, room.bottom)
    _draw_marks(context, obj, layer, unit)
    said = f", {layer.scale.unit or 'ratio'}" if layer.scale else ""
    heading = [layer.quantity, f"{obj.name}{said}"]
    return _draw_legend(_Legend(heading, layer.scale, layer.footing, layer.swatches), room, unit)


def _draw_result(picture: bpy.types.Image, room: Box, unit: float) -> None:
    legend = _draw_legend(_legend_of(picture), room, unit)
    section = section_of(picture)
    if section:
        scale = results.legend_of(picture)
        _draw_section(section, room, legend, scale is None or scale.log, unit)


# The legend


def _legend_of(picture: bpy.types.Image) -> _Legend:
    scale, meta = results.legend_of(picture), results.meta_of(picture)
    name = results.name_of(picture)
    if scale:
        heading = [scale.quantity, f"{name}, {scale.unit}"]
    else:
        heading = ["Colour", f"{name}, white {results.white_of(picture):.3g} {meta['unit']}"]
    photons = meta["photons"]["emitted"]
    footing = [f"{_count(photons)} photons"] * bool(photons)
    if meta["error"]:
        footing.insert(0, f"error {100 * meta['error']:.0f} %")
    return _Legend(heading, scale, footing)


def _draw_legend(legend: _Legend, room: Box, unit: float) -> Box:
    """A card at the right, below the view's own gizmos; returns where it lies."""
    heading, scale, footing = legend.heading, legend.scale, legend.footing
    line, pad, bar_width = 17 * unit, 10 * unit, 16 * unit
    count = len(heading) + len(footing) + len(legend.swatches)
    bar_height = min(240 * unit, room.height - (count + 2) * line - 2 * pad)
    if bar_height < 40 * unit:
        return Box(room.right, room.bottom, room.right, room.bottom)
    if scale is None:
        bar_height = 0.0
    ticks = scale.ticks(8 if bar_height > 150 * unit else 4) if scale else []
    plain = len(heading) + len(footing)
    texts = [*heading, *footing, *(label for label, _ in legend.swatches)]
    width = max(
        *(width_of(text, unit) + 19 * unit * (index >= plain) for index, text in enumerate(texts)),
        bar_width + 12 * unit + max((width_of(text, unit) for _, text in ticks), default=0.0),
    )
    height = bar_height + (len(texts) + 1.2) * line + pad
    width = min(width, 220 * unit)
    card = Box(room.right - width - 2 * pad, room.bottom, room.right, room.bottom + height + pad)
    rectangle(card, CARD)
    y = card.top - pad
    for index, text in enumerate(heading):
        y -= line
        write(
            text,
            card.left + pad,
            y + 4 * unit,
            unit,
            INK if index == 0 else QUIET,
            width,
        )
    top = y - line / 2
    bar = Box(card.left + pad, top - bar_height, card.left + pad + bar_width, top)
    if scale:
        ramp(bar, scale.table())
    for position, text in ticks:
        y = bar.bottom + position * bar.height
        lines([(bar.right, y), (bar.right + 4 * unit, y)], QUIET, unit)
        write(text, bar.right + 9 * unit, y - 4 * unit, unit, INK)
    y = bar.bottom - line / 2
    for label, colour in legend.swatches:
        y -= line
        red, green, blue = (value / 255 for value in colour)
        square = Box(bar.left, y, bar.left + 12 * unit, y + 12 * unit)
        rectangle(square, (red, green, blue, 1.0))
        write(label, square.right + 7 * unit, y + 2 * unit, unit, INK, width)
    for text in footing:
        y -= line
        write(text, card.left + pad, y + 2 * unit, unit, QUIET)
    return card


# Marks on a layer


def _draw_marks(
    context: bpy.types.Context, obj: bpy.types.Object, layer: layers.Layer, unit: float
) -> None:
    """A ring around each marked place, with its label beside it."""
    view = context.space_data.region_3d if context.space_data else None
    if view is None:
        return
    for mark in layer.marks:
        place = obj.matrix_world @ Vector(mark.place)
        point = location_3d_to_region_2d(context.region, view, place)
        if point is None:
            continue
        turn = np.linspace(0.0, 2 * np.pi, 33)
        x, y = point.x + 7 * unit * np.cos(turn), point.y + 7 * unit * np.sin(turn)
        ring = list(zip(x.tolist(), y.tolist(), strict=True))
        lines(ring, CARD, 5 * unit)  # stands out on any colour
        lines(ring, _MARK, 2 * unit)
        left, bottom = point.x + 14 * unit, point.y - 5 * unit
        width = width_of(mark.label, unit)
        card = Box(left - 5 * unit, bottom - 5 * unit, left + width + 5 * unit, bottom + 14 * unit)
        rectangle(card, CARD)
        write(mark.label, left, bottom, unit, INK)


# The section


def _draw_section(section: dict[str, Any], room: Box, legend: Box, log: bool, unit: float) -> None:
    """A card at the left with axes, curves and the interval of the first as a band."""
    width = min(460 * unit, legend.left - room.left - 12 * unit)
    height = min(230 * unit, room.height * 0.5)
    if width < 180 * unit or height < 110 * unit:
        return
    card = Box(room.left, room.bottom, room.left + width, room.bottom + height)
    rectangle(card, CARD)
    along = np.array(section["distance"])
    curves = {name: np.array(section[name], dtype=float) for name, *_ in _CURVES}
    lower, upper = (np.array(section[name], dtype=float) for name in ("lower", "upper"))
    x_axis = Axis(0.0, float(along[-1] + along[0]), False)
    high = 1.05 * float(np.nanmax([1e-6, *upper, *np.concatenate(list(curves.values()))]))
    y_axis = Axis(high / _DECADES if log else 0.0, high, log)
    y_ticks = y_axis.ticks(5)
    inner = Box(
        card.left + 16 * unit + max(width_of(text, unit) for _, text in y_ticks),
        card.bottom + 26 * unit,
        card.right - 14 * unit,
        card.top - 30 * unit,
    )
    title = f"{section['receiver']}: {section['quantity'].lower()}, {section['unit']}"
    write(title, card.left + 10 * unit, card.top - 19 * unit, unit, INK, inner.width / 2)
    _draw_key(card, unit)
    for position, text in y_ticks:
        y = inner.bottom + position * inner.height
        lines([(inner.left, y), (inner.right, y)], RULE, unit)
        write(text, inner.left - 6 * unit - width_of(text, unit), y - 4 * unit, unit, QUIET)
    for position, text in x_axis.ticks(6):
        x = inner.left + position * inner.width
        x = min(
            x - width_of(text, unit) / 2,
            inner.right + 8 * unit - width_of(f"{text} m", unit),
        )
        write(f"{text} m", x, card.bottom + 9 * unit, unit, QUIET)
    lines([(inner.left, inner.bottom), (inner.right, inner.bottom)], QUIET, unit)
    x = inner.left + x_axis.position(along) * inner.width
    _band(x, *(inner.bottom + y_axis.position(v) * inner.height for v in (lower, upper)))
    for name, _, colour in reversed(_CURVES):
        y = inner.bottom + y_axis.position(curves[name]) * inner.height
        for run in _runs(y):
            lines(list(zip(x[run].tolist(), y[run].tolist(), strict=True)), colour, 1.5 * unit)


def _draw_key(card: Box, unit: float) -> None:
    """A dash and a name a curve, at the card's upper right."""
    right, y = card.right - 14 * unit, card.top - 19 * unit
    for _, name, colour in reversed(_CURVES):
        right -= width_of(name, unit)
        write(name, right, y, unit, INK)
        lines(
            [(right - 18 * unit, y + 4 * unit), (right - 6 * unit, y + 4 * unit)], colour, 2 * unit
        )
        right -= 30 * unit


def _band(x: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> None:
    for run in _runs(lower + upper):
        if run.stop - run.start > 1:
            pairs = np.stack([np.stack([x, edge], axis=-1)[run] for edge in (lower, upper)], axis=1)
            batch("UNIFORM_COLOR", "TRI_STRIP", pairs.reshape(-1, 2).astype("f4"), _BAND)


def _runs(values: np.ndarray) -> Iterable[slice]:
    """The stretches that are numbers."""
    ends = np.flatnonzero(np.diff(np.isfinite(values), prepend=False, append=False))
    return [slice(first, last) for first, last in ends.reshape(-1, 2).tolist()]


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
