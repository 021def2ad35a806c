"""Studies as Blender's scenes: their objects and settings, and what came out of them."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ...engines.core.analysis import find_form
from ...engines.core.files import safe_name, written
from ...engines.core.parameters import from_table, merged, to_table
from ...engines.core.scene import Body, Lamp, Luminaire, Mesh, Plane, Receiver, Surface
from ...engines.core.study import Case, load_study
from ...engines.glass import GlassObject
from .. import objects
from ..properties import group_name, scale_of, write
from ..rooms import staging_of
from .meshes import to_blender
from .shading import show_in_views

SHIPPED = Path(__file__).resolve().parents[2] / "studies"
"""The studies that come with Heliform."""


def stage_study(
    path: Path,
    out: Path,
    blend: Path,
    *,
    quick: bool = False,
    seed: int | None = None,
    settings: Sequence[str] = (),
) -> bool:
    """Save a study that was run into ``out`` as a .blend: a scene a case, with its result.

    Replaces the session's data. The options are those that the study was run with. Returns whether
    there is anything to show: a result may be for files alone. Raises HeliformError where the study
    or a result cannot be read, or the file not be written.
    """
    study = load_study(path, quick=quick, seed=seed, settings=settings)
    if not any(staging_of(case.analysis) for case in study.cases):
        return False
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    for index, case in enumerate(study.cases):
        scene = bpy.data.scenes.new("") if index else bpy.context.scene
        scene.name = case.name or study.title
        found = add_case(scene, case, study.seed)
        folder = out / safe_name(case.name) if case.name else out
        if staging := staging_of(case.analysis):
            staging.stage(scene, found, case.analysis.shows.load(folder), folder)
        scene.view_settings.view_transform = "Standard"
    show_in_views(bpy.context)
    with written(blend) as draft:
        draft.unlink()  # Blender would keep it as an older version
        bpy.ops.wm.save_as_mainfile(filepath=str(draft), check_existing=False, compress=True)
    return True


def add_case(scene: bpy.types.Scene, case: Case, seed: int) -> dict[str, bpy.types.Object]:
    """Add a case's objects and settings to a scene; returns the receivers by their study names."""
    settings = scene.heliform
    group = getattr(settings, group_name(case.analysis.record), None)
    if group is not None:
        write(group, case.parameters, scale_of(scene))
    write(settings.display, case.display)
    settings.seed = seed
    layer = scene.view_layers[0]
    with bpy.context.temp_override(scene=scene, view_layer=layer, collection=scene.collection):
        for body in case.scene.bodies:
            _add_body(bpy.context, body, case.table["bodies"][body.name])
        for lamp in case.scene.luminaires:
            _add_lamp(bpy.context, lamp)
        return {r.name: _add_receiver(bpy.context, r) for r in case.scene.receivers}


def _add_body(context: bpy.types.Context, body: Body, table: dict[str, Any]) -> None:
    """A glass object that stays one to be reshaped, or else a plain mesh."""
    scale = scale_of(context.scene)
    if table.get("form") == objects.GLASS:
        presets = find_form(objects.GLASS, body.name).presets
        preset = presets[table["preset"]] if "preset" in table else GlassObject()
        shape = merged(to_table(preset), table.get("shape", {}))
        record = from_table(GlassObject, shape, body.name)
        obj = objects.add_glass(context, record, body.name)
        _place(obj, table, scale)
    else:
        mesh = Mesh(body.mesh.vertices / scale, body.mesh.faces, body.mesh.normals)
        obj = bpy.data.objects.new(body.name, to_blender(mesh, body.name))
        context.collection.objects.link(obj)
    obj.heliform.role = "BODY"
    write(obj.heliform.material, body.material)


def _place(obj: bpy.types.Object, table: dict[str, Any], scale: float) -> None:
    """What a study says of a thing's place is what Blender calls location, rotation and scale."""
    if "matrix" in table:
        obj.matrix_world = _matrix(table["matrix"], scale)
        return
    obj.location = [value / scale for value in table.get("at", (0, 0, 0))]
    obj.rotation_euler = [math.radians(angle) for angle in table.get("turn", (0, 0, 0))]
    obj.scale = table.get("scale", (1, 1, 1))


def _add_lamp(context: bpy.types.Context, luminaire: Luminaire) -> None:
    lamp: Lamp = luminaire.lamp
    obj = objects.add_lamp(context, lamp, luminaire.name)
    obj.matrix_world = _matrix(luminaire.pose, scale_of(context.scene))


def _add_receiver(context: bpy.types.Context, receiver: Receiver | Surface) -> bpy.types.Object:
    resolution = max(receiver.columns, receiver.rows)
    kept = {"sides": receiver.sides, "reflectance": receiver.reflectance}
    if isinstance(receiver, Surface):
        return _add_surface(context, receiver, Plane(resolution=resolution, **kept))
    width, length = (math.hypot(*edge) for edge in (receiver.u, receiver.v))
    plane = Plane(width=width, length=length, resolution=resolution, **kept)
    obj = objects.add_receiver(context, plane, receiver.name)
    matrix = Matrix.Identity(4)
    axes = (receiver.u / width, receiver.v / length, receiver.normal)
    middle = receiver.origin + (receiver.u + receiver.v) / 2
    for column, values in enumerate((*axes, middle)):
        matrix.col[column][:3] = values
    obj.matrix_world = _matrix(matrix, scale_of(context.scene))
    return obj


def _add_surface(context: bpy.types.Context, surface: Surface, plane: Plane) -> bpy.types.Object:
    scale = scale_of(context.scene)
    block = to_blender(Mesh(surface.mesh.vertices / scale, surface.mesh.faces), surface.name)
    layer = block.uv_layers.new(name="UVMap", do_init=False)
    layer.uv.foreach_set("vector", surface.texture.astype(np.float32).ravel())
    obj = bpy.data.objects.new(surface.name, block)
    context.collection.objects.link(obj)
    obj.heliform.role = "RECEIVER"
    write(obj.heliform.plane, plane, scale)
    return obj


def _matrix(rows: Any, scale: float) -> Matrix:
    """A 4×4 of metres as Blender's, its place in Blender units."""
    matrix = Matrix([list(row) for row in rows])
    matrix.translation /= scale
    return matrix
