"""Where and when the sun shines on a scene: the site of its weather, and the sun as a lamp."""

import json
from dataclasses import dataclass, replace

import bpy
import numpy as np
from mathutils import Vector

from ..engines.core.errors import HeliformError
from ..engines.sun.clear_sky import ineichen_perez, monthly_turbidity
from ..engines.sun.extraterrestrial import extraterrestrial
from ..engines.sun.position import sun_position
from ..engines.sun.read_weather import read_weather
from ..engines.sun.site import Site, to_model
from ..engines.sun.times import moment
from .bridge.read import objects_of
from .properties import read, scale_of, write

YEAR = 2019
"""The year that a date without one is taken of."""
_TAKEN = "heliform_weather"
_HEIGHT = 1.3  # of the scene's radius, that the lamp stands off its middle


@dataclass(frozen=True, slots=True)
class SunNow:
    """The sun at the scene's date and hour, in degrees, and unit vector to it in the scene's axes.

    ``direct`` is what it gives across its rays under a cloudless sky, in W/m².
    """

    azimuth: float
    altitude: float
    direction: Vector
    direct: float


def site_of(scene: bpy.types.Scene) -> Site:
    """Where the scene stands."""
    return read(scene.heliform.radiation.site, Site, scale_of(scene))


def take_site(scene: bpy.types.Scene) -> None:
    """Where another weather file was chosen, take the place that it is of; north and air stay.

    What is wrong with the file is kept for `weather_problem`.
    """
    chosen = scene.heliform.radiation.weather_file
    if chosen == json.loads(scene.get(_TAKEN, '["", ""]'))[0]:
        return
    problem = ""
    try:
        if chosen:
            there = read_weather(bpy.path.abspath(chosen)).site
            ours = site_of(scene)
            site = replace(there, north=ours.north, turbidity=ours.turbidity)
            write(scene.heliform.radiation.site, site, scale_of(scene))
    except HeliformError as error:
        problem = str(error)
    scene[_TAKEN] = json.dumps([chosen, problem])


def weather_problem(scene: bpy.types.Scene) -> str:
    """Why the chosen weather file cannot be used, or an empty text."""
    chosen, problem = json.loads(scene.get(_TAKEN, '["", ""]'))
    return problem if chosen == scene.heliform.radiation.weather_file else ""


def sun_now(scene: bpy.types.Scene) -> SunNow:
    """The sun at the scene's date and hour. Raises ParameterError for a day that there is not."""
    own, site = scene.heliform, site_of(scene)
    times = moment(YEAR, own.sun_month, own.sun_day, own.sun_hour, site)
    sun = sun_position(times, site)
    _, direct, _ = ineichen_perez(
        sun.apparent_altitude,
        extraterrestrial(times),
        monthly_turbidity(site)[own.sun_month - 1],
        site.elevation,
    )
    up = sun.apparent_altitude[0] > 0
    return SunNow(
        float(sun.azimuth[0]),
        float(sun.apparent_altitude[0]),
        Vector(to_model(sun.direction, site)[0]),
        float(direct[0]) if up else 0.0,
    )


def middle_and_radius(layer: bpy.types.ViewLayer) -> tuple[Vector, float]:
    """The middle of the ground below bodies and receivers, and how far they reach from it."""
    corners = np.array(
        [
            obj.matrix_world @ Vector(corner)
            for role in ("BODY", "RECEIVER")
            for obj in objects_of(layer, role)
            for corner in obj.bound_box
        ]
    ).reshape(-1, 3)
    if not len(corners):
        return Vector((0.0, 0.0, 0.0)), 10.0
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle = np.array([*(low + high)[:2] / 2, low[2]])
    return Vector(middle), max(float(np.linalg.norm(corners - middle, axis=1).max()), 1e-3)


def add_lamp(context: bpy.types.Context) -> bpy.types.Object:
    """The scene's sun lamp, a new one unless it is there, shining as the sun does now."""
    own = context.scene.heliform
    if own.sun_lamp is None or own.sun_lamp.name not in context.scene.objects:
        light = bpy.data.lights.new("Sun", "SUN")
        light.angle = np.radians(0.533)
        own.sun_lamp = bpy.data.objects.new("Sun", light)
        context.collection.objects.link(own.sun_lamp)
    place_lamp(context)
    return own.sun_lamp


def place_lamp(context: bpy.types.Context) -> None:
    """Have the sun lamp, where there is one, shine as the sun does at the scene's date and hour."""
    lamp = context.scene.heliform.sun_lamp
    if lamp is None or lamp.type != "LIGHT":
        return
    try:
        now = sun_now(context.scene)
    except HeliformError:
        return
    middle, radius = middle_and_radius(context.view_layer)
    lamp.rotation_mode = "XYZ"
    lamp.rotation_euler = now.direction.to_track_quat("Z", "Y").to_euler()
    lamp.location = middle + _HEIGHT * radius * now.direction
    lamp.data.energy = now.direct
