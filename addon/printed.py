"""Studies of prints and Blender's scene: the wall of a panel as a study, and the other way."""

from pathlib import Path

import bpy

from ..engines.core.analysis import Analysis
from ..engines.core.errors import SceneError
from ..engines.core.parameters import from_table, to_table
from ..engines.core.scene import Scene
from ..engines.glass.printing import Print, Printed
from ..engines.glass.profile import Style, scalloped
from ..engines.glass.relief import Relief
from ..engines.glass.toolpath import Spiral
from ..engines.scan.to_wall import ScannedWall
from . import objects
from .bridge import scan
from .bridge.print_layers import add_modifier, relief_of_wall
from .bridge.walls import WALL, wall_of
from .printing import machine_named
from .properties import read, scale_of, write
from .staging import Gathered, Objects, Staging


def _gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    """The active wall and how the scene prints it."""
    obj, scene = context.object, context.scene
    if obj is None or obj.heliform.form != WALL or obj.heliform.curves:
        raise SceneError("A study of a print is of a wall with a plan of its own; select one.")
    wall, _ = wall_of(obj, scene)
    machine, file = machine_named(scene)
    spiral = to_table(read(scene.heliform.spiral, Spiral, scale_of(scene)))
    given = {"spiral": spiral, "machine": machine, "machine_file": file}
    record = from_table(Print, {"wall": to_table(wall), **given}, "parameters")
    return Gathered(obj.name, Scene(), record, {obj.name: obj})


def _stage_print(
    scene: bpy.types.Scene,
    there: Objects,
    result: Printed,
    folder: Path,
    /,
    notes: tuple[str, ...] = (),
) -> bool:
    """The wall of a print, with the relief of its beads."""
    record = from_table(Print, result.meta["parameters"], "parameters")
    bead = record.wall.bead
    _add(scene, record, relief_of_wall(record.wall), scalloped(bead.height, bead.sag))
    return False


def _stage_scanned(
    scene: bpy.types.Scene,
    there: Objects,
    result: ScannedWall,
    folder: Path,
    /,
    notes: tuple[str, ...] = (),
) -> bool:
    """What was read of a sample, and the wall that has its relief."""
    scan.STAGING.stage(scene, there, result.reading, folder)
    record = from_table(Print, result.printed.meta["parameters"], "parameters")
    _add(scene, record, result.relief, result.reading.style)
    return False


def _add(scene: bpy.types.Scene, record: Print, relief: Relief, style: Style) -> None:
    """Add the wall of a print, with its relief, its gate and its path."""
    settings, scale = scene.heliform, scale_of(scene)
    write(settings.spiral, record.spiral, scale)
    settings.machine, settings.machine_file = record.machine, record.machine_file
    layer = scene.view_layers[0]
    with bpy.context.temp_override(scene=scene, view_layer=layer, collection=scene.collection):
        obj = objects.add_wall(bpy.context, record.wall, "Wall")
        add_modifier(obj, relief, style, scale)
        obj.heliform.gate = obj.heliform.path = True


def _none(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    raise SceneError(
        "In Blender, read the scan and put it on a wall; this study does both at once."
    )


PRINT_STAGING = Staging(_gather, _stage_print)
SCANNED_STAGING = Staging(_none, _stage_scanned)
