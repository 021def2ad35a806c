"""The print of a wall in Blender: its gate as a layer, its path as a curve, kept up to date."""

import json
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np

from ..engines.core.colour import ColourScale, Display, Palette
from ..engines.core.errors import HeliformError, SceneError
from ..engines.core.scene import Vector
from ..engines.glass.gate import Check, Verdict, gate
from ..engines.glass.loft import Loft, Wall, wall_loft
from ..engines.glass.machine import FILE, PROFILES, Machine, chosen_machine
from ..engines.glass.toolpath import Spiral, Toolpath, spiral
from .bridge import layers
from .bridge.layers import Layer, Mark
from .bridge.meshes import places_of
from .bridge.paths import path_of, path_to_blender
from .bridge.print_layers import skin_from_blender
from .bridge.walls import wall_of
from .properties import enum_items, read, scale_of

MACHINES = enum_items([*PROFILES, FILE], "Machine profile: shipped, or a TOML file of your own")

_VERDICT, _PROBLEM = "heliform_verdict", "heliform_print_problem"


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
    return chosen_machine(*machine_named(scene))


def machine_named(scene: bpy.types.Scene) -> tuple[str, str]:
    """The name of the scene's machine, and the profile's file where it is one of one's own."""
    settings = scene.heliform
    own = settings.machine == FILE
    return settings.machine, bpy.path.abspath(settings.machine_file) if own else ""


def print_of(obj: bpy.types.Object, context: bpy.types.Context) -> Print:
    """How the wall would be printed with the scene's machine and settings.

    Raises HeliformError where there is no such wall, path or machine.
    """
    return _print_of(obj, context.scene)


def _print_of(obj: bpy.types.Object, scene: bpy.types.Scene) -> Print:
    if any(abs(side - 1) > 1e-6 for side in obj.matrix_world.to_scale()):
        raise SceneError(
            f"“{obj.name}” is scaled, which its print would not be; set its scale to 1 and change "
            "width, depth, height and thickness instead."
        )
    wall, drawn = wall_of(obj, scene)
    record = read(scene.heliform.spiral, Spiral, scale_of(scene))
    record = replace(record, layer_height=wall.bead.height)
    machine = machine_of(scene)
    loft = wall_loft(wall, drawn.loops)
    path = spiral(loft, wall.thickness, record, machine)
    verdict = gate(loft, wall.thickness, path, machine, record.purge)
    return Print(wall, loft, record, machine, path, verdict)


def refresh(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    """Bring what is shown of the wall's print up to date: its gate, its path, both or neither.

    What cannot be shown is taken away, and ``obj.heliform.problem`` says why.
    """
    own = obj.heliform
    if own.problem == obj.pop(_PROBLEM, None):
        own.problem = ""
    shown = None
    if own.gate or own.path:
        try:
            shown = _print_of(obj, scene)
        except HeliformError as error:
            own.problem = obj[_PROBLEM] = str(error)
    if shown and own.gate:
        obj[_VERDICT] = json.dumps(shown.verdict.as_table())
        palette = read(scene.heliform.display, Display).palette
        layers.paint(obj, *_layer(obj, shown, palette, scale_of(scene)))
    elif _VERDICT in obj:
        del obj[_VERDICT]
        layers.clear([obj])
    if shown and own.path:
        figures = {name: f["value"] for name, f in shown.verdict.figures.items()}
        path_to_blender(obj, shown.path, scale_of(scene), figures)
    elif (curve := path_of(obj)) is not None:
        bpy.data.hair_curves.remove(curve.data)


def verdict_of(obj: bpy.types.Object) -> dict[str, Any] | None:
    """What the gate said of the wall as it is shown, see `Verdict.as_table`, or None."""
    return json.loads(obj[_VERDICT]) if _VERDICT in obj else None


def _layer(
    obj: bpy.types.Object, shown: Print, palette: Palette, scale: float
) -> tuple[Vector, Layer]:
    """How much of a limit each vertex takes, and the legend with the worst place marked."""
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
        scale=ColourScale(0.0, 1.25, False, palette, quantity, "share of limit"),
        footing=[shown.machine.name, "passed" if shown.verdict.passed else "not printable"],
        marks=[_mark(worst, scale)],
    )
    return values, layer


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
