"""The sun's path over the scene, drawn in the view: days, hours, and where the sun stands now."""

import functools
from typing import Any

import bpy
import gpu
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from gpu_extras.batch import batch_for_shader
from mathutils import Vector
from numpy.typing import NDArray

from ..engines.core.errors import HeliformError
from ..engines.sun.path import PathLine, sun_path
from ..engines.sun.site import Site, to_model
from .pixels import CARD, INK, Box, Colour, rectangle, width_of, write
from .sun_place import middle_and_radius, site_of, sun_now

_REACH = 1.25  # of the scene's radius
_DAY: Colour = (0.95, 0.62, 0.1, 0.9)
_MONTH: Colour = (0.95, 0.62, 0.1, 0.35)
_HOUR: Colour = (0.45, 0.55, 0.65, 0.55)
_GROUND: Colour = (0.5, 0.53, 0.56, 0.7)
_SUN: Colour = (1.0, 0.78, 0.1, 1.0)
_TURNS = (" March", " June", " September", " December")
_BEFORE = 7
"""Points before sunset, ten minutes each, where a day's label is: between those of hours."""
_COMPASS = {"N": (0, 1, 0), "E": (1, 0, 0), "S": (0, -1, 0), "W": (-1, 0, 0)}

_handles: list[Any] = []


@functools.lru_cache(maxsize=4)
def _path(site: Site) -> tuple[PathLine, ...]:
    try:
        return sun_path(site)
    except HeliformError:
        return ()


@functools.lru_cache(maxsize=4)
def _strokes(site: Site) -> tuple[tuple[Colour, float, NDArray[np.float32]], ...]:
    """Colour, width and the ends (2 n, 3) of the pieces of lines on a dome of radius 1."""
    kinds: dict[tuple[Colour, float], list[NDArray[np.float64]]] = {}
    for line in _path(site):
        kinds.setdefault(_look(line), []).append(_pieces(line.points))
    turn = np.linspace(0.0, 2 * np.pi, 97)
    circle = np.stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)], axis=1)
    kinds[_GROUND, 1.5] = [_pieces(circle)]
    kinds[_GROUND, 1.5] += [
        to_model(np.array([way, 1.05 * np.array(way)], dtype=float), site)
        for way in _COMPASS.values()
    ]
    return tuple((*look, np.concatenate(p).astype(np.float32)) for look, p in kinds.items())


def _look(line: PathLine) -> tuple[Colour, float]:
    if line.kind == "hour":
        return _HOUR, 1.0
    return (_DAY, 2.0) if line.label.endswith(_TURNS) else (_MONTH, 1.0)


def _pieces(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.repeat(points, 2, axis=0)[1:-1]


def _labels(site: Site) -> list[tuple[str, NDArray[np.float64]]]:
    """Texts and their places on the dome: the compass, days before sunset, hours at their top."""
    found: dict[str, NDArray[np.float64]] = {}
    for line in _path(site):
        if line.kind == "hour":
            top = line.points[line.points[:, 2].argmax()]
            if line.label not in found or top[2] > found[line.label][2]:
                found[line.label] = 1.03 * top
        elif line.label.endswith((" March", " June", " December")):
            found[line.label] = 1.05 * line.points[max(0, len(line.points) - _BEFORE)]
    north = to_model(np.array(list(_COMPASS.values()), dtype=float), site)
    dates = sorted(found.items(), key=lambda item: item[0].endswith(" h"))
    return [*zip(_COMPASS, 1.12 * north, strict=True), *dates]


def draw_lines(context: bpy.types.Context) -> None:
    """The dome's lines, in the view's space."""
    if not _is_on(context):
        return
    middle, radius = _dome(context)
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    unit = context.preferences.system.ui_scale
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    for colour, width, ends in _strokes(site_of(context.scene)):
        batch = batch_for_shader(shader, "LINES", {"pos": middle + radius * ends})
        shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
        shader.uniform_float("lineWidth", width * unit)
        shader.uniform_float("color", colour)
        batch.draw(shader)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def draw_labels(context: bpy.types.Context) -> None:
    """The sun at the scene's date and hour, the compass, dates and hours, none over another."""
    if not _is_on(context):
        return
    unit = context.preferences.system.ui_scale
    middle, radius = _dome(context)
    taken: list[Box] = []
    _draw_sun(context, middle, radius, unit, taken)
    for text, place in _labels(site_of(context.scene)):
        point = _pixel(context, middle + radius * place)
        if point is not None:
            _write_on_card(text, point, unit, taken)


def _draw_sun(
    context: bpy.types.Context,
    middle: NDArray[np.float32],
    radius: float,
    unit: float,
    taken: list[Box],
) -> None:
    try:
        now = sun_now(context.scene)
    except HeliformError:
        return
    point = _pixel(context, middle + radius * np.array(now.direction))
    if now.altitude <= 0 or point is None:
        return
    _disc(point, 7 * unit)
    said = f"{_clock(context.scene.heliform.sun_hour)}  {now.altitude:.0f}° high"
    beside = Vector((point.x + 14 * unit + width_of(said, unit) / 2, point.y))
    _write_on_card(said, beside, unit, taken)


def _is_on(context: bpy.types.Context) -> bool:
    overlay = context.space_data.overlay if context.space_data else None
    shown = overlay is None or overlay.show_overlays
    return shown and context.scene.heliform.sun_path


def _dome(context: bpy.types.Context) -> tuple[NDArray[np.float32], float]:
    middle, radius = middle_and_radius(context.view_layer)
    return np.array(middle, dtype=np.float32), _REACH * radius


def _pixel(context: bpy.types.Context, place: NDArray[np.floating]) -> Vector | None:
    view = context.space_data.region_3d if context.space_data else None
    return view and location_3d_to_region_2d(context.region, view, Vector(place))


def _write_on_card(text: str, middle: Vector, unit: float, taken: list[Box]) -> None:
    """Write a text on a card about a place of the region, where no other card is ``taken``."""
    wide, pad = width_of(text, unit), 3 * unit
    left, bottom = middle.x - wide / 2, middle.y - 4 * unit
    card = Box(left - pad, bottom - pad, left + wide + pad, bottom + 9 * unit + pad)
    if any(
        card.left < other.right
        and other.left < card.right
        and card.bottom < other.top
        and other.bottom < card.top
        for other in taken
    ):
        return
    taken.append(card)
    rectangle(card, CARD)
    write(text, left, bottom, unit, INK)


def _disc(middle: Vector, radius: float) -> None:
    turn = np.linspace(0.0, 2 * np.pi, 33)
    ring = np.stack([middle.x + radius * np.cos(turn), middle.y + radius * np.sin(turn)], axis=1)
    corners = np.empty((32, 3, 2), dtype=np.float32)
    corners[:, 0] = middle.x, middle.y
    corners[:, 1], corners[:, 2] = ring[:-1], ring[1:]
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    batch = batch_for_shader(shader, "TRIS", {"pos": corners.reshape(-1, 2)})
    shader.uniform_float("color", _SUN)
    batch.draw(shader)


def _clock(hour: float) -> str:
    minutes = round(60 * hour)
    return f"{minutes // 60}:{minutes % 60:02d}"


def register() -> None:
    """Draw in every 3D view."""
    for draw, when in ((draw_lines, "POST_VIEW"), (draw_labels, "POST_PIXEL")):
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(_in_view, (draw,), "WINDOW", when))


def _in_view(draw: Any) -> None:
    draw(bpy.context)


def unregister() -> None:
    """Draw no more."""
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
