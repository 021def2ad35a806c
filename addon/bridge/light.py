"""Light and Blender's scene: what is traced, and the pictures that come of it."""

from pathlib import Path

import bpy

from ...engines.core.analysis import Analysis
from ...engines.core.colour import Display
from ...engines.core.errors import SceneError
from ...engines.light import Irradiance
from ..properties import parameters, read
from ..staging import Gathered, Objects, Staging
from . import results, shading, stage
from .instances import left_out
from .read import read_scene
from .receivers import unwrap_receivers


def _gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    """Everything that is on and visible; receivers get a map where they have none."""
    notes = unwrap_receivers(context)
    depsgraph = context.evaluated_depsgraph_get()
    given = read_scene(context.scene, depsgraph)
    notes += left_out(depsgraph)
    if not given.receivers:
        raise SceneError("There is no receiver to trace onto; add one with Add Receiver.")
    return Gathered(
        name=given.receivers[0].name,
        scene=given,
        parameters=parameters(context.scene, analysis.record),
        objects={r.name: context.scene.objects[r.name] for r in given.receivers},
        notes=tuple(notes),
    )


def _stage(
    scene: bpy.types.Scene,
    objects: Objects,
    result: Irradiance,
    folder: Path,
    notes: tuple[str, ...] = (),
) -> bool:
    """Put the maps on their receivers, and the foremost one forward."""
    for one in result.maps:
        one.meta["folder"] = str(folder)
        one.meta["notes"] += notes
    first = scene.heliform.shown is None
    display = read(scene.heliform.display, Display)
    pictures = stage.stage_irradiance(scene, objects, result, display)
    chosen = _foremost(scene, pictures)
    scene.heliform.shown = chosen
    shading.bring_forward(results.owner_of(chosen), results.side_of(chosen))
    return first


def _foremost(scene: bpy.types.Scene, pictures: list[bpy.types.Image]) -> bpy.types.Image:
    """The active receiver's, of its brighter side, else the one shown already or the first."""
    active = bpy.context.object if bpy.context.scene == scene else None
    shown = scene.heliform.shown
    mine = [picture for picture in pictures if active and results.owner_of(picture) == active]
    if shown in (mine or pictures):
        return shown
    return max(mine, key=_mean) if mine else pictures[0]


def _mean(picture: bpy.types.Image) -> float:
    return results.figures_of(picture)["mean_illuminance"]["value"]


STAGING = Staging(_gather, _stage)
