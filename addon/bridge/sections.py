"""Sections across a receiver: the line a person may move, and the plot's data."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.errors import SceneError
from ...engines.core.scene import Receiver
from ...engines.light.section import CURVES, Place, Section
from ..properties import scale_of
from .meshes import lines_to_blender
from .read import read_receiver
from .results import SECTION, name_of, owner_of, side_of

_LINE = "heliform_section_line"
_ACROSS = (0.0, 0.5), (1.0, 0.5)


def line_of(context: bpy.types.Context, picture: bpy.types.Image) -> tuple[Place, Place]:
    """Where the section line meets its receiver, in texture coordinates; the middle without one.

    Raises SceneError where the receiver is gone or the line has not two ends.
    """
    receiver = _receiver(context, picture)
    line = next((o for o in context.scene.objects if o.get(_LINE) == owner_of(picture)), None)
    if line is None:
        return _ACROSS
    line.update_from_editmode()
    if len(line.data.vertices) != 2:
        raise SceneError(f"“{line.name}” should have two vertices, the ends of the section.")
    scale = scale_of(context.scene)
    ends = np.array([line.matrix_world @ v.co for v in line.data.vertices]) * scale
    start, end = (_on(receiver, point) for point in ends)
    return start, end


def add_line(context: bpy.types.Context, picture: bpy.types.Image, scale: float) -> None:
    """A line just above the middle of the receiver, along its X, selected and active.

    Raises SceneError where the receiver is gone.
    """
    receiver = _receiver(context, picture)
    owner = owner_of(picture)
    for old in [o for o in context.scene.objects if o.get(_LINE) == owner]:
        bpy.data.objects.remove(old)
    name = f"{owner.name} section"
    block = bpy.data.meshes.new(name)
    start = receiver.origin + receiver.v / 2 + receiver.normal * 2e-3
    points = np.array([start, start + receiver.u]) / scale
    middle = points.mean(axis=0)
    lines_to_blender(points - middle, np.array([[0, 1]], dtype=np.int32), block)
    line = bpy.data.objects.new(name, block)
    line[_LINE] = owner
    line.location = middle
    line.show_in_front = True
    line.hide_render = True
    context.collection.objects.link(line)
    for other in context.selected_objects:
        other.select_set(False)
    line.select_set(True)
    context.view_layer.objects.active = line


def stage_section(picture: bpy.types.Image, section: Section) -> None:
    """Keep a section with its picture, for the plot, and as a text of its own."""
    columns = {name: _listed(getattr(section, name)) for name in ("distance", *CURVES)}
    meta = {key: section.meta[key] for key in ("quantity", "unit")}
    meta["receiver"] = name_of(picture)
    picture[SECTION] = json.dumps({**columns, **meta})
    name = text_name(picture)
    text = bpy.data.texts.get(name) or bpy.data.texts.new(name)
    with TemporaryDirectory() as folder:
        path = Path(folder, "section.csv")
        section.save_csv(path)
        text.from_string(path.read_text(encoding="utf-8"))


def section_of(picture: bpy.types.Image) -> dict[str, Any] | None:
    """What `stage_section` kept: lists of numbers, None where there is none."""
    kept = picture.get(SECTION)
    return json.loads(kept) if kept else None


def text_name(picture: bpy.types.Image) -> str:
    """The name of the text that holds a picture's section."""
    side = side_of(picture)
    return f"{owner_of(picture).name}{f' {side}' if side else ''} section.csv"


def _receiver(context: bpy.types.Context, picture: bpy.types.Image) -> Receiver:
    owner = owner_of(picture)
    if owner is None or owner.name not in context.scene.objects:
        raise SceneError(f"The receiver of “{picture.name}” is gone; trace photons onto another.")
    depsgraph = context.evaluated_depsgraph_get()
    found = read_receiver(owner, depsgraph, scale_of(context.scene))
    if not isinstance(found, Receiver):
        raise SceneError(f"“{owner.name}” is no flat rectangle, across which a section goes.")
    return found


def _on(receiver: Receiver, point: NDArray[np.float64]) -> Place:
    way = point - receiver.origin
    u, v = (float(way @ edge / (edge @ edge)) for edge in (receiver.u, receiver.v))
    return u, v


def _listed(values: NDArray[Any]) -> list[float | None]:
    return [round(v, 7) if np.isfinite(v) else None for v in values.astype(float).tolist()]
