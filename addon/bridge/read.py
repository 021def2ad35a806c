"""The Blender scene as the engines' scene: metres, with everything evaluated."""

import itertools
from dataclasses import replace

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.copies import joined
from ...engines.core.errors import SceneError
from ...engines.core.scene import (
    Body,
    Lamp,
    Luminaire,
    Material,
    Mesh,
    Plane,
    Receiver,
    Scene,
    Surface,
)
from ...engines.light.shape import placed_lamp, receiver_of
from ..properties import read, scale_of
from .instances import Shown, any_instancer, is_instancer, is_pattern, read_instances
from .lights import is_sun, read_light, widened
from .materials import read_material
from .meshes import from_blender, has_faces, no_faces, textured_from_blender

SQUARE = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]])
"""The texture coordinates of one quadrilateral that has the whole picture."""


def read_scene(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> Scene:
    """The bodies, lamps and receivers that are on and visible, in the order of their names.

    Raises SceneError or FileError, naming the object, where one cannot be what it is said to be.
    """
    scale = scale_of(scene)
    bodies = read_bodies(depsgraph, scale)
    receivers = [
        read_receiver(o, depsgraph, scale) for o in objects_of(depsgraph.view_layer, "RECEIVER")
    ]
    lit = [body.mesh.vertices for body in bodies] + [_points(r) for r in receivers]
    lamps = [
        _sun(o, depsgraph, scale, lit) if is_sun(o) else read_lamp(o, depsgraph, scale)
        for o in objects_of(depsgraph.view_layer, "LAMP")
    ]
    return Scene(tuple(bodies), tuple(lamps), tuple(receivers))


def read_bodies(depsgraph: bpy.types.Depsgraph, scale: float = 1.0) -> list[Body]:
    """The bodies that are on and visible, all their instances among them, by their names.

    What an instancer shows of its own is part of it; what it shows of another body is one body,
    named after both. Raises SceneError as `read_scene`.
    """
    bodies = objects_of(depsgraph.view_layer, "BODY")
    if not any_instancer(depsgraph):
        return [_body(o, depsgraph, scale) for o in bodies]
    shown = read_instances(depsgraph)
    meshes = {copies.instancer: copies.mesh(scale) for copies in shown.copies if copies.is_own}
    found = []
    for obj in bodies:
        if not is_pattern(obj):
            found += _with_own(obj, meshes.get(obj), shown, depsgraph, scale)
    names = {body.name for body in found}
    for copies in shown.copies:
        mesh = None if copies.is_own else copies.mesh(scale)
        if mesh is not None:
            name = _free(f"{copies.owner.name} ({copies.instancer.name})", names)
            names.add(name)
            found.append(Body(name, mesh, body_material(copies.owner, scale)))
    return sorted(found, key=lambda body: body.name)


def objects_of(layer: bpy.types.ViewLayer, role: str) -> list[bpy.types.Object]:
    """The objects of a role that Heliform sees: on, and visible in the view layer."""
    found = [
        o
        for o in layer.objects
        if o.heliform.role == role and o.heliform.on and o.visible_get(view_layer=layer)
    ]
    return sorted(found, key=lambda o: o.name)


def read_mesh(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, scale: float = 1.0) -> Mesh:
    """An object's evaluated mesh in the world, in metres. Raises SceneError without faces."""
    return from_blender(obj.evaluated_get(depsgraph)).moved(_matrix(obj, depsgraph, scale, scale))


def read_lamp(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, scale: float = 1.0
) -> Luminaire:
    """A lamp in the world, in metres."""
    return placed_lamp(obj.name, lamp_record(obj, scale), _matrix(obj, depsgraph, 1.0, scale))


def lamp_record(obj: bpy.types.Object, scale: float = 1.0) -> Lamp:
    """The lamp that an object holds or a Blender light is, its file as an absolute path."""
    if obj.type == "LIGHT":
        return read_light(obj, scale).lamp
    lamp = read(obj.heliform.lamp, Lamp, scale)
    if not lamp.file:
        return lamp
    return replace(lamp, file=bpy.path.abspath(lamp.file, library=obj.library))


def read_receiver(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, scale: float = 1.0
) -> Receiver | Surface:
    """A receiver in the world, in metres: a flat rectangle, or any surface with a UV map.

    Raises SceneError, naming it, where it has no faces, no UV map (`unwrap_receivers` gives it
    one), or is mirrored.
    """
    found = textured_from_blender(obj.evaluated_get(depsgraph))
    if found.texture is None and found.mesh.faces.shape == (1, 4):
        found = replace(found, texture=SQUARE)
    if found.texture is None:
        raise SceneError(
            f"Receiver “{obj.name}” has no UV map; add one with UV › Smart UV Project in Edit Mode."
        )
    plane = read(obj.heliform.plane, Plane)
    return receiver_of(obj.name, found.moved(_matrix(obj, depsgraph, scale, scale)), plane)


def body_material(obj: bpy.types.Object, scale: float = 1.0) -> Material:
    """What light meets on a body: its own settings, or its Blender material at its own priority.

    Raises SceneError where that is asked for and not understood.
    """
    own = read(obj.heliform.material, Material)
    if obj.heliform.material_from == "OWN":
        return own
    return replace(read_material(obj, scale).material, priority=own.priority)


def _body(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, scale: float) -> Body:
    return Body(obj.name, read_mesh(obj, depsgraph, scale), body_material(obj, scale))


def _with_own(
    obj: bpy.types.Object,
    copies: Mesh | None,
    shown: Shown,
    depsgraph: bpy.types.Depsgraph,
    scale: float,
) -> list[Body]:
    """A body with the ``copies`` of its own geometry; none where others' is all that it shows."""
    parts = [] if copies is None else [copies]
    if obj.type != "EMPTY" and obj not in shown.replaced:
        shows_others = is_instancer(obj, depsgraph)
        if not shows_others or (obj in shown.own and has_faces(obj.evaluated_get(depsgraph))):
            parts.insert(0, read_mesh(obj, depsgraph, scale))
    if parts:
        return [Body(obj.name, joined(parts), body_material(obj, scale))]
    if any(c.instancer == obj for c in shown.copies):
        return []
    raise no_faces(obj.name)


def _free(name: str, taken: set[str]) -> str:
    """The name, with a number where it is taken."""
    if name not in taken:
        return name
    return next(n for k in itertools.count(2) if (n := f"{name} {k}") not in taken)


def _sun(
    obj: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    scale: float,
    lit: list[NDArray[np.float64]],
) -> Luminaire:
    """A sun over everything that is ``lit``."""
    illuminance = lamp_record(obj, scale).flux
    return widened(read_lamp(obj, depsgraph, scale), illuminance, lit)


def _points(receiver: Receiver | Surface) -> NDArray[np.float64]:
    """Points (N, 3) m between which a receiver lies."""
    if isinstance(receiver, Surface):
        return receiver.mesh.vertices
    corner, u, v = receiver.origin, receiver.u, receiver.v
    return np.stack([corner, corner + u, corner + v, corner + u + v])


def _matrix(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, size: float, distance: float
) -> NDArray[np.float64]:
    """The evaluated world matrix; ``size`` scales its axes, ``distance`` its place."""
    matrix = np.array(obj.evaluated_get(depsgraph).matrix_world, dtype=np.float64)
    matrix[:3, :3] *= size
    matrix[:3, 3] *= distance
    return matrix
