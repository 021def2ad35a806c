"""Staging a result of light: its images, on the receivers."""

import json
from collections.abc import Mapping

import bpy
import numpy as np

from ...engines.core.colour import Display
from ...engines.light import Irradiance, IrradianceMap
from ...engines.light.drawing import is_plane
from . import layers, results, shading, showing
from .results import CHANNELS, COLOUR, KINDS, PICTURE


def stage_irradiance(
    scene: bpy.types.Scene,
    receivers: Mapping[str, bpy.types.Object],
    result: Irradiance,
    display: Display,
) -> list[bpy.types.Image]:
    """Put the maps of a result on their receivers and return the pictures, in the maps' order.

    ``receivers`` has the objects by the names that they had when the light was traced; maps of one
    that is not there are left out. Reruns replace in place.
    """
    before = scene.heliform.shown
    name = before.heliform_map if results.is_result(before) else ""
    pictures, sides = [], {}
    for one in result.maps:
        receiver = receivers.get(one.meta["receiver"])
        if receiver is not None:
            pictures.append(_stage_map(receiver, one))
            sides.setdefault(receiver, []).append(one)
    for receiver, maps in sides.items():
        kept = {(kind, _side(one)) for one in maps for kind in _kinds(one)}
        results.drop_others(receiver, kept)
        layers.forget(receiver)
    showing.share_map(pictures, name)
    showing.redisplay(scene, display, pictures)
    for receiver, maps in sides.items():
        shading.show_pictures(receiver, "light", tuple(CHANNELS), [_side(one) for one in maps])
    return pictures


def _stage_map(receiver: bpy.types.Object, result: IrradianceMap) -> bpy.types.Image:
    shape, side = result.illuminance.shape, _side(result)
    for kind in _kinds(result):
        if kind != PICTURE:
            values = [getattr(result, name) for name in CHANNELS[kind]]
            image = results.image_for(receiver, kind, side, shape)
            results.fill(image, np.stack(values, axis=-1))
    picture = results.image_for(receiver, PICTURE, side, shape)
    picture[results.META] = json.dumps(result.meta)
    picture[results.FIGURES] = json.dumps(result.figures())
    picture[results.MAPS] = json.dumps(showing.offered_by(result))
    picture[results.PLANE] = is_plane(result)
    for stale in (results.SECTION, results.LEGEND):
        picture.pop(stale, None)
    return picture


def _kinds(result: IrradianceMap) -> list[str]:
    """The images that a map has."""
    coloured = any(getattr(result, name).any() for name in CHANNELS[COLOUR])
    return [kind for kind in KINDS if kind != COLOUR or coloured]


def _side(result: IrradianceMap) -> str:
    return result.meta.get("side", "")
