"""Studies of sun and sky, and Blender's scene: what is asked, and the maps that come of it.

The values of all maps lie in float images beside the false-colour picture of the one that is shown,
three maps an image. What is said of a study lies with the scene, what belongs to a receiver with
that.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.analysis import Analysis
from ...engines.core.colour import ColourScale, Display, scale_for
from ...engines.core.errors import HeliformError, SceneError
from ...engines.core.scene import Body, Scene
from ...engines.light.drawing import shown
from ...engines.sun import SUN_RADIATION
from ...engines.sun.maps import QUANTITIES, SunMap, SunMaps
from ...engines.sun.radiation import Radiation
from ..properties import parameters, read, scale_of, write
from ..staging import Gathered, Objects, Staging
from . import layers, results, shading
from .read import body_material, objects_of, read_mesh, read_receiver
from .receivers import unwrap_receivers

_FACTS, _MAPS = "heliform_sun", "heliform_sun_maps"
_FAVOURITES = ("total", "daylight_autonomy", "daylight_factor")
_EACH = 3  # maps that an image holds
_GUTTER = 4  # texels that a picture is carried on around what a mesh's map covers


# What is asked


def gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    """The bodies and receivers that are on and visible; no lamp, for only the sky shines.

    Raises HeliformError where there is no receiver, or one of them cannot be read.
    """
    notes = unwrap_receivers(context)
    given = read_shaded(context)
    return Gathered(
        name=f"{given.receivers[0].name} sun",
        scene=given,
        parameters=asked(context.scene, analysis.record),
        objects={r.name: context.scene.objects[r.name] for r in given.receivers},
        notes=tuple(notes),
    )


def read_shaded(context: bpy.types.Context) -> Scene:
    """What sun and sky shine on, in metres. Raises HeliformError as `gather`."""
    depsgraph, scale = context.evaluated_depsgraph_get(), scale_of(context.scene)
    receivers = [
        read_receiver(o, depsgraph, scale) for o in objects_of(depsgraph.view_layer, "RECEIVER")
    ]
    if not receivers:
        raise SceneError("There is no receiver to measure on; add one with Add Receiver.")
    bodies = [
        Body(o.name, read_mesh(o, depsgraph, scale), body_material(o, scale))
        for o in objects_of(depsgraph.view_layer, "BODY")
    ]
    return Scene(tuple(bodies), (), tuple(receivers))


def asked(scene: bpy.types.Scene, record: type) -> Any:
    """The scene's record; place and weather are one for all studies of sun and sky.

    The weather file is named by its whole path.
    """
    ours = parameters(scene, Radiation)
    file = ours.weather_file and bpy.path.abspath(ours.weather_file)
    return replace(parameters(scene, record), site=ours.site, weather_file=file)


# What came of it


def stage(
    scene: bpy.types.Scene,
    there: Objects,
    result: SunMaps,
    folder: Path | None,
    notes: tuple[str, ...] = (),
    footing: str = "",
) -> bool:
    """Put the maps on their receivers. ``footing`` is what the legend says last."""
    first = not staged_on(scene)
    for one in result.maps:
        if one.receiver in there:
            _keep(there[one.receiver], one)
    meta = result.meta
    scene[_FACTS] = json.dumps(
        {
            "figures": result.figures(),
            "quantities": meta["quantities"],
            "notes": [*meta["notes"], *notes],
            "source": meta["source"],
            "period": meta["period"],
            "folder": str(folder or ""),
            "footing": footing,
        }
    )
    offered = offered_maps(scene)
    if scene.heliform.sun_map not in offered:
        scene.heliform.sun_map = next((n for n in _FAVOURITES if n in offered), next(iter(offered)))
    repaint(scene, lasting=folder is not None)
    return first


def _stage(
    scene: bpy.types.Scene,
    there: Objects,
    result: SunMaps,
    folder: Path,
    /,
    notes: tuple[str, ...] = (),
) -> bool:
    stage(scene, there, result, folder, notes)
    layers.show_in_views(bpy.context, layers.IN_TEXELS)
    return False


def _keep(obj: bpy.types.Object, one: SunMap) -> None:
    """The values of a receiver's maps as float images, in place of those of an earlier result."""
    if any(results.is_result(results.find(obj, results.PICTURE, s)) for s in ("", "front", "back")):
        results.drop_others(obj, set())  # a result of light
    names = list(one.maps)
    kinds = {
        ", ".join(part): part for part in (names[i : i + _EACH] for i in range(0, len(names), 3))
    }
    sides = dict(one.sides())
    for side, maps in sides.items():
        for kind, part in kinds.items():
            stacked = np.stack([maps[name] for name in [*part, *part[-1:] * 2][:_EACH]], axis=-1)
            results.fill(results.image_for(obj, kind, side, stacked.shape[:2]), stacked)
    kept = {(kind, side) for kind in (*kinds, results.PICTURE) for side in sides}
    results.drop_others(obj, kept)
    whole = bool((one.area > 0).all())
    means = {name: one.mean(name) for name in names}
    obj[_MAPS] = json.dumps(
        {"kinds": kinds, "sides": list(sides), "whole": whole, "means": means}
    )
    layers.note(obj, layers.Layer("", None))


def staged_on(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """The receivers that a study's maps lie on, by their names."""
    found = [
        obj
        for obj in scene.objects
        if _MAPS in obj
        and layers.layer_of(obj)
        and results.find(obj, results.PICTURE, _kept(obj)["sides"][0])
        or _MAPS in obj
    ]
    return sorted(found, key=lambda obj: obj.name)


def facts_of(scene: bpy.types.Scene) -> dict[str, Any] | None:
    """Figures, quantities, notes, source, period and folder of the scene's study, or None."""
    return json.loads(scene[_FACTS]) if _FACTS in scene and staged_on(scene) else None


def mean_on(obj: bpy.types.Object, name: str) -> float:
    """The mean of a map over a receiver."""
    return _kept(obj)["means"][name]


def offered_maps(scene: bpy.types.Scene) -> dict[str, list[str]]:
    """The maps that there are, with their titles and units."""
    return json.loads(scene[_FACTS])["quantities"] if _FACTS in scene else {}


def values_on(obj: bpy.types.Object, name: str) -> dict[str, NDArray[np.float32]]:
    """A map of a receiver by its sides (rows, columns). Raises SceneError where it is gone."""
    kept = _kept(obj)
    kind, part = next((k, part) for k, part in kept["kinds"].items() if name in part)
    images = {side: results.find(obj, kind, side) for side in kept["sides"]}
    if not all(images.values()):
        raise SceneError(f"The values on “{obj.name}” are gone; do the study again.")
    index = part.index(name)
    return {side: results.pixels_of(image)[..., index] for side, image in images.items()}


def repaint(scene: bpy.types.Scene, *, lasting: bool = True) -> None:
    """Colour all receivers by the map that is chosen, on one scale."""
