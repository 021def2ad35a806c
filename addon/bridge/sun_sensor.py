"""One sensor on a receiver: its hours over the period as a picture in the file."""

from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

from ...engines.core.analysis import Analysis
from ...engines.core.colour import scale_for
from ...engines.core.scene import Receiver, Scene
from ...engines.sun import SUN_DAYLIGHT, SUN_RADIATION
from ...engines.sun.maps import SunMaps
from ...engines.sun.occlusion import bodies_of
from ...engines.sun.rooms import surfaces_of
from ...engines.sun.temporal import temporal_map, temporal_picture
from ...engines.sun.words import number_text
from ..properties import scale_of
from ..staging import Gathered, Objects, Staging
from . import results, sun, sun_said

_SENSOR = "heliform_sun_sensor"
_SIZE = 1e-3  # m, the side of what stands for the sensor


def analysis_for(scene: bpy.types.Scene) -> Analysis:
    """What a sensor measures: what the study whose maps are shown does, irradiance without one."""
    facts = sun.facts_of(scene)
    return SUN_DAYLIGHT if facts and facts.get("kind") == "daylight" else SUN_RADIATION


def staging_at(obj: bpy.types.Object, place: Vector, normal: Vector) -> Staging:
    """How a study meets the scene that measures only here on a receiver, seen along ``normal``.

    Both are in the world, ``place`` in Blender units.
    """

    def gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
        given = sun.read_shaded(context)
        across = normal.orthogonal().normalized()
        u, v = (_SIZE * np.array(axis) for axis in (across, normal.cross(across)))
        origin = scale_of(context.scene) * np.array(place) - (u + v) / 2
        sensor = Receiver(f"{obj.name} sensor", origin, u, v, 1, 1)
        bodies = surfaces_of if analysis is SUN_DAYLIGHT else bodies_of
        scene = Scene(bodies(given), (), (sensor,))
        record = sun_said.asked(context.scene, analysis.record)
        display = sun_said.display_of(context.scene)
        return Gathered(sensor.name, scene, record, {sensor.name: obj}, display=display)

    def stage(
        scene: bpy.types.Scene,
        there: Objects,
        result: SunMaps,
        folder: Path,
        /,
        notes: tuple[str, ...] = (),
    ) -> bool:
        scene[_SENSOR] = _picture(scene, obj.name, result)
        sun.mark(obj, obj.matrix_world.inverted() @ place, f"Sensor: {_figure(result)}")
        return False

    return Staging(gather, stage)


def picture_of(scene: bpy.types.Scene) -> bpy.types.Image | None:
    """The hours of the sensor that was picked last."""
    return scene.get(_SENSOR)


def _picture(scene: bpy.types.Scene, name: str, result: SunMaps) -> bpy.types.Image:
    """Hour of the day by day of the year, of all that comes from sun and sky."""
    light = result.meta["kind"] == "daylight"
    quantity, unit = ("Illuminance", "lx") if light else ("Irradiance", "W/m²")
    values = np.sum([result.hourly[n] for n in result.hourly if n != "open"], axis=0)
    colours = scale_for(values, sun_said.display_of(scene), quantity, unit)
    grid = temporal_map(result.times, values, result.meta["site"]["utc_offset"])
    said = result.meta["facts"]
    where = ", ".join(said[fact] for fact in ("Period", "Place", "Weather"))
    page = temporal_picture(grid, colours, f"{quantity} on “{name}” in {unit}\n{where}")
    pixels = np.asarray(page)[::-1] / np.float32(255)
    rows, columns = pixels.shape[:2]
    image = picture_of(scene)
    if image is None:
        image = bpy.data.images.new(f"{name} sensor", columns, rows, alpha=False)
        image.use_fake_user = True
    image.name = f"{name} sensor"
    if tuple(image.size) != (columns, rows):
        image.scale(columns, rows)
    results.fill(image, pixels)
    return image


def _figure(result: SunMaps) -> str:
    """What the mark says."""
    name = "illuminance" if result.meta["kind"] == "daylight" else "total"
    value = number_text(result.maps[0].mean(name))
    return f"{value} {result.meta['quantities'][name][1]}, {result.meta['period']}"
