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
from mathutils import Vector
from numpy.typing import NDArray

from ...engines.core.analysis import Analysis
from ...engines.core.colour import ColourScale, Display
from ...engines.core.errors import HeliformError, SceneError
from ...engines.core.scene import Scene, Surface
from ...engines.light.drawing import shown
from ...engines.sun.drawing import scale_of as colour_scale_of
from ...engines.sun.maps import SunMap, SunMaps
from ...engines.sun.radiation import Radiation
from ...engines.sun.words import number_text
from ..properties import parameters, read, scale_of, write
from ..staging import Gathered, Objects, Staging
from ..sun_place import take_site
from . import layers, results, shading, sun_inside, sun_said
from .instances import left_out
from .read import objects_of, read_bodies, read_receiver
from .receivers import onto_vertices, unwrap_receivers

_FACTS, _MAPS = "heliform_sun", "heliform_sun_maps"
_MARKS = "heliform_sun_marks"
_AREA = "area"
_NO_TIMES = np.empty(0, dtype="datetime64[s]")
_SIDES = ("", "front", "back")
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
    notes += left_out(context.evaluated_depsgraph_get())
    return Gathered(
        name=f"{given.receivers[0].name} sun",
        scene=given,
        parameters=sun_said.asked(context.scene, analysis.record),
        objects={r.name: context.scene.objects[r.name] for r in given.receivers},
        notes=tuple(notes),
        remarks=sun_said.hidden_notes(context.view_layer),
        display=sun_said.display_of(context.scene),
    )


def read_shaded(context: bpy.types.Context) -> Scene:
    """What sun and sky shine on, in metres. Raises HeliformError as `gather`."""
    depsgraph, scale = context.evaluated_depsgraph_get(), scale_of(context.scene)
    receivers = [
        read_receiver(o, depsgraph, scale) for o in objects_of(depsgraph.view_layer, "RECEIVER")
    ]
    if not receivers:
        raise SceneError("There is no receiver to measure on; add one with Add Receiver.")
    return Scene(tuple(read_bodies(depsgraph, scale)), (), tuple(receivers))


# What came of it


def stage(
    scene: bpy.types.Scene,
    there: Objects,
    result: SunMaps,
    folder: Path | None,
    notes: tuple[str, ...] = (),
    footing: str = "",
) -> bool:
    """Put the maps on their receivers, and take those of an earlier study off all others.

    ``folder`` is None for an answer that has no files: those of the last study stay known.
    ``footing`` is what the legend says last.
    """
    earlier, chosen = staged_on(scene), scene.heliform.sun_map
    before = json.loads(scene.get(_FACTS, "{}"))
    _take_off([obj for obj in earlier if obj not in there.values()])
    for one in result.maps:
        if one.receiver in there:
            _keep(there[one.receiver], one)
    meta = result.meta
    scene[_FACTS] = json.dumps(
        {
            "kind": meta["kind"],
            "figures": result.figures(),
            "quantities": meta["quantities"],
            "notes": [*meta["notes"], *notes],
            "source": meta["source"],
            "period": meta["period"],
            "facts": meta["facts"],
            "asked": meta["parameters"],
            "folder": str(folder or before.get("folder", "")),
            "live": folder is None,
            "stale": False,
            "footing": footing,
        }
    )
    offered = offered_maps(scene)
    if chosen not in offered:
        scene.heliform.sun_map = next((n for n in _FAVOURITES if n in offered), next(iter(offered)))
    sun_inside.follow(scene)
    recheck(scene)
    repaint(scene)
    return not earlier


def _stage(
    scene: bpy.types.Scene,
    there: Objects,
    result: SunMaps,
    folder: Path,
    /,
    notes: tuple[str, ...] = (),
) -> bool:
    stage(scene, there, result, folder, notes)
    if result.meta["kind"] == "daylight":
        scene.heliform.live_sun = False  # it would take the study's place at the first move
    layers.show_in_views(bpy.context, layers.IN_TEXELS)
    return False


def _keep(obj: bpy.types.Object, one: SunMap) -> None:
    """The values of a receiver's maps as float images, in place of those of an earlier result."""
    if any(results.is_result(results.find(obj, results.PICTURE, side)) for side in _SIDES):
        results.drop_others(obj, set())  # a result of light
    names = list(one.maps)
    parts = [names[start : start + _EACH] for start in range(0, len(names), _EACH)]
    kinds = {", ".join(part): part for part in parts}
    sides = dict(one.sides())
    for side, maps in sides.items():
        area = results.image_for(obj, _AREA, side, one.area.shape)
        results.fill(area, np.repeat(one.area[..., None], 3, axis=-1))
        for kind, part in kinds.items():
            channels = [maps[name] for name in [*part, *part[-1:] * _EACH][:_EACH]]
            image = results.image_for(obj, kind, side, channels[0].shape)
            results.fill(image, np.stack(channels, axis=-1))
    results.drop_others(
        obj, {(k, side) for k in (*kinds, _AREA, results.PICTURE) for side in sides}
    )
    means = {name: one.mean(name) for name in names}
    obj.pop(_MARKS, None)
    kept = {"receiver": one.receiver, "kinds": kinds, "sides": list(sides), "means": means}
    obj[_MAPS] = json.dumps(kept)


def say(scene: bpy.types.Scene, **facts: Any) -> None:
    """Change what is said of the scene's study, in the legend too."""
    scene[_FACTS] = json.dumps(json.loads(scene[_FACTS]) | facts)
    repaint(scene)


def recheck(scene: bpy.types.Scene) -> None:
    """Have the legend say whether the study is of the settings that there are now."""
    facts = facts_of(scene)
    if facts is None or "asked" not in facts or scene.heliform.live_sun:
        return
    stale = sun_said.is_stale(scene, facts)
    if stale != facts["stale"]:
        say(scene, stale=stale)


def staged_on(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """The receivers that a study's maps lie on, by their names."""
    return sorted((obj for obj in scene.objects if _is_staged(obj)), key=lambda obj: obj.name)


def _is_staged(obj: bpy.types.Object) -> bool:
    """Whether the maps that an object says it has are its own, and there."""
    if _MAPS not in obj:
        return False
    kept = _kept(obj)
    return all(
        results.find(obj, kind, side) for side in kept["sides"] for kind in (_AREA, *kept["kinds"])
    )


def _kept(obj: bpy.types.Object) -> dict[str, Any]:
    return json.loads(obj[_MAPS])


def facts_of(scene: bpy.types.Scene) -> dict[str, Any] | None:
    """Kind, figures, quantities, notes, source, period and folder of the scene's study, or None."""
    return json.loads(scene[_FACTS]) if _FACTS in scene and staged_on(scene) else None


def offered_maps(scene: bpy.types.Scene) -> dict[str, list[str]]:
    """The maps that there are, with their titles and units."""
    return json.loads(scene[_FACTS])["quantities"] if _FACTS in scene else {}


def mean_on(obj: bpy.types.Object, name: str) -> float:
    """The mean of a map over a receiver, NaN where it does not have it."""
    return _kept(obj)["means"].get(name, float("nan"))


def name_in_study(obj: bpy.types.Object) -> str:
    """What its study calls a receiver, whose object may have been renamed since."""
    return _kept(obj).get("receiver", obj.name)


def map_on(obj: bpy.types.Object) -> SunMap:
    """The maps of a receiver, from its images. Raises SceneError where they are gone."""
    kept = _kept(obj)
    sides = [_values(obj, kept["kinds"], side) for side in kept["sides"]]
    area = sides[0].pop(_AREA)
    maps = {name: np.stack([side[name] for side in sides]) for name in sides[0]}
    if len(sides) == 1:
        maps = {name: values[0] for name, values in maps.items()}
    return SunMap(obj.name, maps, area)


def _values(
    obj: bpy.types.Object, kinds: dict[str, list[str]], side: str
) -> dict[str, NDArray[np.float32]]:
    """The maps of one side (rows, columns), and the area of its texels."""
    found = {}
    for kind, names in {_AREA: [_AREA], **kinds}.items():
        image = results.find(obj, kind, side)
        if image is None:
            raise SceneError(f"The values on “{obj.name}” are gone; do the study again.")
        pixels = results.pixels_of(image)
        found |= {name: pixels[..., index] for index, name in enumerate(names)}
    return found


def values_to_vertices(context: bpy.types.Context) -> list[str]:
    """Write the shown map onto the vertices of the receivers that are meshes; their names.

    The attribute is called as the map, "total" or "sun_hours front". Raises SceneError where there
    is no such receiver, and as `receivers.onto_vertices`.
    """
    name = context.scene.heliform.sun_map
    depsgraph, scale = context.evaluated_depsgraph_get(), scale_of(context.scene)
    meshes = [
        obj
        for obj in staged_on(context.scene)
        if isinstance(read_receiver(obj, depsgraph, scale), Surface)
    ]
    if not meshes:
        raise SceneError("Only a receiver that is a mesh of its own takes values on its vertices.")
    for obj in meshes:
        one = map_on(obj)
        named = {f"{name} {side}".strip(): maps[name] for side, maps in one.sides()}
        onto_vertices(context, obj, one.area, named)
    return [obj.name for obj in meshes]


# What is shown


def repaint(scene: bpy.types.Scene) -> None:
    """Colour all receivers by the map that is chosen, on one scale.

    Where the range that is asked for is none, ``facts_of`` says so, and the range is automatic.
    """
    facts, name = facts_of(scene), scene.heliform.sun_map
    if facts is None or name not in facts["quantities"]:
        return
    objects = [obj for obj in staged_on(scene) if name in _kept(obj)["means"]]
    known = SunMaps(tuple(map_on(obj) for obj in objects), _NO_TIMES, {}, {})
    display = replace(read(scene.heliform.sun_display, Display), log=False)
    problem = ""
    try:
        scale = colour_scale_of(known, name, display)
    except HeliformError as error:
        problem = str(error)
        scale = colour_scale_of(known, name, replace(display, automatic=True))
    if problem != facts.get("problem", ""):
        scene[_FACTS] = json.dumps(facts | {"problem": problem})
    for obj, one in zip(objects, known.maps, strict=True):
        mean = one.mean(name)
        said = [f"mean {number_text(mean)} {scale.unit}".strip()] * bool(np.isfinite(mean))
        if "asked" in facts:
            said += sun_said.footing(facts, scene.heliform.live_sun)
        _paint(obj, one, name, scale, said)


def _paint(
    obj: bpy.types.Object, one: SunMap, name: str, scale: ColourScale, footing: list[str]
) -> None:
    covered, sides = one.area > 0, []
    for side, maps in one.sides():
        sides.append(side)
        colours = scale.colours(shown(maps[name], covered, _GUTTER))
        image = results.image_for(obj, results.PICTURE, side, covered.shape)
        results.fill(image, colours / np.float32(255))
    shading.show_pictures(obj, "sun", [*_kept(obj)["kinds"], _AREA], sides)
    marks = [layers.Mark((x, y, z), said) for x, y, z, said in json.loads(obj.get(_MARKS, "[]"))]
    layers.note(obj, layers.Layer(scale.quantity, scale, footing, marks))


def mark(obj: bpy.types.Object, place: Vector, label: str) -> None:
    """Point out a place of a receiver, in its own coordinates, and no other."""
    obj[_MARKS] = json.dumps([[*place, label]])
    layer = layers.layer_of(obj)
    if layer is not None:
        layers.note(obj, replace(layer, marks=[layers.Mark((place.x, place.y, place.z), label)]))


def clear(scene: bpy.types.Scene) -> None:
    """Take the study off the receivers."""
    _take_off(staged_on(scene))
    scene.pop(_FACTS, None)


def _take_off(objects: list[bpy.types.Object]) -> None:
    layers.clear(objects)
    for obj in objects:
        for key in (_MAPS, _MARKS):
            obj.pop(key, None)


def _add(scene: bpy.types.Scene, record: Any) -> None:
    """Place and weather of a study of daylight are those of the scene.

    The scene's own place stays where the weather brings its own.
    """
    ours = parameters(scene, Radiation)
    kept = replace(ours.site, north=record.site.north) if record.weather_file else record.site
    ours = replace(ours, site=kept, weather_file=record.weather_file)
    write(scene.heliform.radiation, ours, scale_of(scene))
    take_site(scene)


STAGING = Staging(gather, _stage, _add)
