"""What of the results is shown, and in which colours: one map, on one scale, on all receivers."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import bpy
import numpy as np

from ...engines.core.colour import Display, scale_for
from ...engines.core.errors import HeliformError
from ...engines.core.picture import toned, white_of
from ...engines.light import IrradianceMap
from ...engines.light.drawing import shown
from ..properties import enum_items, group_for, read
from . import results
from .results import COLOUR

MAPS = {
    "illuminance": ("Illuminance", "All light that lands, as it was counted"),
    "smooth": (
        "Smoothed illuminance",
        "All light that lands, gathered over as many texels as it needs: for the eye",
    ),
    "caustic": ("Caustic light", "Light that came through glass or off mirrors alone"),
    "direct": ("Direct light", "Light that met nothing on its way from the lamp"),
    "indirect": ("Scattered light", "Light that a matte surface scattered"),
    COLOUR: ("Colour", "The light's own colour, the brightest 0.5 % white"),
    "half_width": (
        "95 % half-width",
        "Half the width of the 95 % confidence interval: how sure each texel is",
    ),
    "smooth_bias": ("Bias of smoothing", "What the blur is estimated to add to the smoothed map"),
}
"""The maps that can be shown, with their names and what they are."""

_GUTTER = 4
"""Texels that a picture is carried on around what a mesh's map covers."""


def offered_by(result: IrradianceMap) -> list[str]:
    """The maps of a result that there is something to see in."""
    smoothed = bool(result.smooth_bias.any())
    coloured = any(getattr(result, n).any() for n in results.CHANNELS[COLOUR])
    there = {"smooth": smoothed, "smooth_bias": smoothed, COLOUR: coloured}
    return [name for name in MAPS if there.get(name, True)]


def share_map(pictures: Sequence[bpy.types.Image], name: str = "") -> None:
    """Have all pictures that offer it show the map, by default that of the first."""
    global _quiet
    _quiet = True
    try:
        for picture in pictures:
            offered = json.loads(picture[results.MAPS])
            name = name or picture.heliform_map
            chosen = name if name in offered else "illuminance"
            if picture.heliform_map != chosen:
                picture.heliform_map = chosen
    finally:
        _quiet = False


def recolour(pictures: Sequence[bpy.types.Image], display: Display) -> None:
    """Colour pictures anew from their values, those that show the same map on one scale.

    Raises ParameterError for a range that is none, SceneError where the values are gone.
    """
    for name in dict.fromkeys(picture.heliform_map for picture in pictures):
        _recolour([p for p in pictures if p.heliform_map == name], name, display)


def _recolour(pictures: Sequence[bpy.types.Image], name: str, display: Display) -> None:
    values = [_shown(picture, name) for picture in pictures]
    if name == COLOUR:
        white = white_of(np.concatenate([v.reshape(-1, 3) for v in values]))
        colours = [toned(v, white) for v in values]
        legend: dict[str, Any] = {"white": white}
    else:
        unit = results.meta_of(pictures[0])["unit"]
        every = values[0] if len(values) == 1 else np.concatenate([v.ravel() for v in values])
        scale = scale_for(every, display, MAPS[name][0], unit)
        colours = [scale.colours(v) for v in values]
        legend = asdict(scale)
    for picture, coloured in zip(pictures, colours, strict=True):
        results.fill(picture, coloured / np.float32(255))
        picture[results.LEGEND] = json.dumps(legend)


def _shown(picture: bpy.types.Image, name: str) -> np.ndarray:
    values = results.values_of(picture, name)
    if results.is_plane(picture):
        return values
    return shown(values, results.values_of(picture, "area") > 0, _GUTTER)


def redisplay(
    scene: bpy.types.Scene, display: Display, fresh: Sequence[bpy.types.Image] = ()
) -> None:
    """Recolour the scene's pictures; what is wrong with that is kept for `problem_of`.

    ``fresh`` ones, just staged, get colours in any case: of an automatic range.
    """
    pictures = list(dict.fromkeys([*fresh, *results.results_of(scene)]))
    problem = ""
    try:
        recolour(pictures, display)
    except HeliformError as error:
        problem = str(error)
        if fresh:
            recolour(fresh, Display())
    for picture in pictures:
        picture[results.PROBLEM] = problem


def problem_of(picture: bpy.types.Image) -> str:
    """Why a picture could not be recoloured, or an empty text."""
    return picture.get(results.PROBLEM, "")


# What a person chooses


def _chosen(picture: bpy.types.Image, context: bpy.types.Context) -> None:
    if _quiet or not results.is_result(picture):
        return
    share_map(results.results_of(context.scene), picture.heliform_map)
    redisplay(context.scene, read(context.scene.heliform.display, Display))


def _changed() -> None:
    scene = bpy.context.scene
    redisplay(scene, read(scene.heliform.display, Display))


_quiet = False
_ITEMS = [
    (key, *MAPS[key], number) for key, _, _, number in enum_items(MAPS)
]  # kept: Blender holds on to their texts


def _offered(picture: bpy.types.Image, context: bpy.types.Context | None) -> list[Any]:
    offered = json.loads(picture.get(results.MAPS, '["illuminance"]'))
    return [item for item in _ITEMS if item[0] in offered]


_owner = object()


def _listen() -> None:
    """Recolour when a person changes how results are displayed."""
    bpy.msgbus.clear_by_owner(_owner)
    for field in group_for(Display).__annotations__:
        bpy.msgbus.subscribe_rna(
            key=(group_for(Display), field),
            owner=_owner,
            args=(),
            notify=_changed,
            options={"PERSISTENT"},
        )


def register() -> None:
    """Give images a choice of map, and follow the display settings."""
    bpy.types.Image.heliform_map = bpy.props.EnumProperty(
        name="Map",
        description="Which part of the light is shown, on all receivers",
        items=_offered,
        default=_ITEMS[0][-1],
        update=_chosen,
    )
    bpy.app.handlers.load_post.append(_reopened)
    for undone in (bpy.app.handlers.undo_post, bpy.app.handlers.redo_post):
        undone.append(_undone)
    _listen()


def unregister() -> None:
    """Take both away."""
    bpy.msgbus.clear_by_owner(_owner)
    for undone in (bpy.app.handlers.undo_post, bpy.app.handlers.redo_post):
        undone.remove(_undone)
    bpy.app.handlers.load_post.remove(_reopened)
    del bpy.types.Image.heliform_map


@bpy.app.handlers.persistent
def _reopened(*_: object) -> None:
    _listen()


@bpy.app.handlers.persistent
def _undone(*_: object) -> None:
    """Undo brings packed files back, but not always the pixels that were loaded from them."""
    for image in bpy.data.images:
        if results.is_ours(image):
            image.buffers_free()
            image.gl_free()
            image.update_tag()
