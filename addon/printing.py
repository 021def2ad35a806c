"""The print of a wall in Blender: its gate as a layer, its path as a curve, kept up to date."""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..engines.core.analysis import Analysis
from ..engines.core.colour import ColourScale
from ..engines.core.errors import HeliformError, SceneError
from ..engines.core.parameters import from_table
from ..engines.core.scene import Scene, Vector
from ..engines.glass.gate import Check, Verdict, gate
from ..engines.glass.loft import Loft, Wall, wall_loft
from ..engines.glass.machine import FILE, PROFILES, Machine, chosen_machine
from ..engines.glass.printing import Print as PrintRecord
from ..engines.glass.printing import Printed
from ..engines.glass.profile import Style, scalloped
from ..engines.glass.relief import Relief
from ..engines.glass.toolpath import Spiral, Toolpath, spiral
from . import objects
from .bridge import layers
from .bridge.layers import Layer, Mark
from .bridge.meshes import places_of
from .bridge.paths import path_of, path_to_blender
from .bridge.print_layers import add_modifier, skin_from_blender
from .properties import enum_items, read, scale_of, write
from .staging import Gathered, Objects, Staging

MACHINES = enum_items([*PROFILES, FILE], "Machine profile: shipped, or a TOML file of your own")

_VERDICT = "heliform_verdict"


@dataclass(frozen=True, slots=True)
class Print:
    """How a wall would be printed: the loft, the machine, the path on it and what the gate says."""

    wall: Wall
    loft: Loft
    spiral: Spiral
    machine: Machine
    path: Toolpath
    verdict: Verdict


def machine_of(scene: bpy.types.Scene) -> Machine:
    """The machine that the scene prints with. Raises FileError or ParameterError."""
    settings = scene.heliform
    return chosen_machine(settings.machine, bpy.path.abspath(settings.machine_file))


def print_of(obj: bpy.types.Object, context: bpy.types.Context) -> Print:
    """How the wall would be printed with the scene's machine and settings.

    Raises HeliformError where there is no such wall, path or machine.
    """
    wall, curves = objects.wall_of(obj, context)
    record = read(context.scene.heliform.spiral, Spiral, scale_of(context.scene))
    record = replace(record, layer_height=wall.bead.height)
    machine = machine_of(context.scene)
    loft = wall_loft(wall, curves)
    path = spiral(loft, wall.thickness, record, machine)
    return Print(wall, loft, record, machine, path, gate(loft, wall.thickness, path, machine))


def refresh(obj: bpy.types.Object, context: bpy.types.Context) -> None:
    """Bring what is shown of the wall's print up to date: its gate, its path, both or neither.

    What cannot be shown is taken away, and ``obj.heliform.problem`` says why.
    """
    own = obj.heliform
    shown = None
    if own.gate or own.path:
        try:
            shown = print_of(obj, context)
        except HeliformError as error:
            own.problem = str(error)
    if shown and own.gate:
        obj[_VERDICT] = json.dumps(shown.verdict.as_table())
        _paint(obj, shown, scale_of(context.scene))
    else:
        obj.pop(_VERDICT, None)
        layers.clear([obj])
    if shown and own.path:
        figures = {name: f["value"] for name, f in shown.verdict.figures.items()}
        path_to_blender(obj, shown.path, scale_of(context.scene), figures)
    elif (curve := path_of(obj)) is not None:
        bpy.data.hair_curves.remove(curve.data)


def verdict_of(obj: bpy.types.Object) -> dict[str, Any] | None:
    """What the gate said of the wall as it is shown, see `Verdict.as_table`, or None."""
    return json.loads(obj[_VERDICT]) if _VERDICT in obj else None


def _paint(obj: bpy.types.Object, shown: Print, scale: float) -> None:
    """Colour the wall by how much of a limit each place takes, the worst place marked."""
    one = _chosen(obj, shown.verdict)
    along = shown.verdict.utilisation() if one is None else one.utilisation
    assert along is not None
    turn = skin_from_blender(obj.data, scale).turn
    z = places_of(obj.data)[:, 2] * scale
    values = np.interp(turn_at(shown.path, turn, z), shown.path.turn, along)
    worst = one or shown.verdict.worst
    quantity = worst.label if one else "Print limits"
    layer = Layer(
        quantity=quantity,
        scale=ColourScale(0.0, 1.25, False, "viridis", quantity, "share of limit"),
        footing=[shown.machine.name, "passed" if shown.verdict.passed else "not printable"],
        marks=[_mark(worst, scale)],
    )
    layers.paint(obj, values, layer)


def turn_at(path: Toolpath, turn: Vector, z: Vector) -> Vector:
    """The path's turn (V,) whose bead is at the share ``turn`` of a turn and at height ``z`` in m.

    The first turn fills the first layer, a bead at turn t of the rest what lies up to a layer below
    the nozzle.
    """
    layers_up = z / path.layer_height
    turns_up = np.where(layers_up > 1 + 1e-6, np.ceil(layers_up - turn - 1e-6), 0.0)
    return np.minimum(turn + turns_up, path.turns)


def _chosen(obj: bpy.types.Object, verdict: Verdict) -> Check | None:
    """The check that a person asked to see, where it has a map."""
    name = obj.heliform.gate_check
    found = (c for c in verdict.checks if c.name == name and c.utilisation is not None)
    return next(found, None)


def _mark(worst: Check, scale: float) -> Mark:
    assert worst.point
    x, y, z = (c / scale for c in worst.point)
    word = "closest to its limit" if worst.passed else "beyond its limit"
    return Mark((x, y, z), f"{worst.label} {worst.worst:.3g} {worst.unit}, {word}")


# As an analysis: studies of prints


def _gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    obj, settings = context.object, context.scene.heliform
    if obj is None or obj.heliform.form != objects.WALL or obj.heliform.curves:
        raise SceneError("A print is of a wall with a plan of its own; select one.")
    wall, _ = objects.wall_of(obj, context)
    record = PrintRecord(
        wall=wall,
        spiral=read(settings.spiral, Spiral, scale_of(context.scene)),
        machine=settings.machine,
        machine_file=bpy.path.abspath(settings.machine_file),
    )
    return Gathered(obj.name, Scene(), record, {obj.name: obj})


def _stage(
    scene: bpy.types.Scene,
    there: Objects,
    result: Printed,
    folder: Path,
    /,
    notes: tuple[str, ...] = (),
) -> bool:
    record = from_table(PrintRecord, result.meta["parameters"], "parameters")
    bead = record.wall.bead
    relief = Relief(height=bead.height, amplitude=bead.depth, spiral=False)
    add_printed(scene, record, relief, scalloped(bead.height, bead.sag))
    return False


def add_printed(
    scene: bpy.types.Scene, record: PrintRecord, relief: Relief, style: Style
) -> bpy.types.Object:
    """Add the wall of a print, with its relief, its gate and its path, to a scene."""
    settings, scale = scene.heliform, scale_of(scene)
    write(settings.spiral, record.spiral, scale)
    settings.machine, settings.machine_file = record.machine, record.machine_file
    layer = scene.view_layers[0]
    with bpy.context.temp_override(scene=scene, view_layer=layer, collection=scene.collection):
        obj = objects.add_wall(bpy.context, record.wall, "Wall")
        add_modifier(obj, relief, style, scale)
        obj.heliform.gate = obj.heliform.path = True
    return obj


STAGING = Staging(_gather, _stage)
