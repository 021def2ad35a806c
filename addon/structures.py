"""Structures in Blender: made, sized while they are changed, and moved by their handles."""

from dataclasses import fields, replace
from pathlib import Path

import bpy
import numpy as np

from ..engines.core.analysis import Analysis
from ..engines.core.errors import HeliformError, ParameterError, SceneError
from ..engines.core.parameters import digest, from_table
from ..engines.core.scene import Body, Material, Scene, Vector
from ..engines.structure.controls import control_places, level_places, levels_for, net_for
from ..engines.structure.level_set import Nine
from ..engines.structure.live import Live
from ..engines.structure.sized import Sized
from ..engines.structure.structure import Structure, size_structure
from ..engines.structure.surface import Net
from . import live, objects
from .bridge import handles, layers, members
from .bridge.meshes import network_from_blender
from .properties import read, scale_of, write
from .staging import Gathered, Objects, Staging

STRUCTURE = "structure"
"""What a form says of a mesh that is a structure."""

NAMES = {"roof": "Roof", "shell": "Shell", "facade": "Façade", "mesh": "Structure"}

_BUILT = "heliform_built"
"""The record that the mesh was made of: undo may have brought back another."""
_NETS = [f.name for f in fields(Net)]
_NINES = [f.name for f in fields(Nine)]
_GROUPS = {"net": _NETS, "material": _NINES, "turn": _NINES}
"""The handles of a structure: which record they move, and its fields."""
_STILL = 1e-5  # of the structure's size, that float32 may move a handle by
_lives: dict[int, Live] = {}
"""What structures were last sized to, by their place in this session: sizing begins there."""
_MANY = 2500  # members, beyond which sizing always begins with the sections that are there
_HASTE = 4  # rounds of sizing while a handle moves
_PAUSE = 0.3  # seconds without a move, after which sizing goes on to its end


def add_structure(
    context: bpy.types.Context,
    record: Structure,
    name: str,
    source: bpy.types.Object | None = None,
) -> bpy.types.Object:
    """A sized structure that stands at the 3D cursor, or on the mesh whose edges it is made of.

    Raises HeliformError where there can be none; adds nothing then.
    """
    sized = size_structure(_scene(source, context.scene), record)
    obj = _new(context, record, name, source)
    _keep(obj, sized, context.scene)
    layers.show_in_views(context, layers.IN_TEXELS)
    return obj


def _new(
    context: bpy.types.Context, record: Structure, name: str, source: bpy.types.Object | None
) -> bpy.types.Object:
    """An object with the settings of a structure, and no mesh yet."""
    obj = objects.added(context, name, bpy.data.meshes.new(name), "BODY", STRUCTURE)
    own = obj.heliform
    own.source = source
    own.material.kind = "diffuse"
    if source is not None:
        obj.location = (0.0, 0.0, 0.0)
    write(own.structure, record, scale_of(context.scene))
    return obj


def active_structure(context: bpy.types.Context) -> bpy.types.Object | None:
    """The active object, or the one whose handle is active, where that is a structure."""
    obj = handles.owner_of(context.object)
    return obj if obj is not None and obj.heliform.form == STRUCTURE else None


def record_of(obj: bpy.types.Object, scene: bpy.types.Scene) -> Structure:
    """What a structure object says of its structure."""
    return read(obj.heliform.structure, Structure, scale_of(scene))


def scene_of(obj: bpy.types.Object, scene: bpy.types.Scene) -> Scene:
    """The mesh that the structure's members are the edges of, where it follows one.

    Raises SceneError where that is gone.
    """
    return _scene(obj.heliform.source, scene)


def _scene(source: bpy.types.Object | None, scene: bpy.types.Scene) -> Scene:
    if source is None:
        return Scene()
    evaluated = source.evaluated_get(bpy.context.evaluated_depsgraph_get())
    matrix = np.array(evaluated.matrix_world)
    matrix[:3] *= scale_of(scene)
    network = network_from_blender(evaluated).moved(matrix)
    return Scene((Body(source.name, network, Material()),))


def rebuild(
    obj: bpy.types.Object, scene: bpy.types.Scene, *, anew: bool = False, hasty: bool = False
) -> None:
    """Bring a structure up to date with its settings: geometry, analysis, sections, colours.

    ``hasty``: sizing begins with the sections that it has and ends after few rounds. Else it begins
    from the start, so that what is shown is what a study finds, unless there are many members.
    What is not live is left as it is, but ``anew``. Where it cannot be brought up to date
    ``obj.heliform.problem`` says why.
    """
    own, problem = obj.heliform, ""
    try:
        if obj.mode != "OBJECT":
            raise ParameterError(f"“{obj.name}” is being edited; leave Edit Mode to change it.")
        if obj.data.users > 1:
            obj.data = obj.data.copy()
        record = record_of(obj, scene)
        if own.live or anew:
            asked = record
            if hasty:
                rules = replace(record.rules, stability=0.0, service=False)
                rules = replace(rules, rounds=min(rules.rounds, _HASTE))
                asked = replace(record, rules=rules)
            elif anew or _count(obj) <= _MANY:
                _lives.pop(obj.session_uid, None)
            kept = _lives.setdefault(obj.session_uid, Live())
            _show(obj, kept.size(asked, scene_of(obj, scene)), scene)
            obj[_BUILT] = digest(asked)
        _place_handles(obj, record, scene)
    except HeliformError as error:
        problem = str(error)
    if own.problem != problem:
        own.problem = problem


def change(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    """Bring a structure up to date in haste while a person changes it, then at leisure."""
    hasty = obj.heliform.live and not bpy.app.background
    rebuild(obj, scene, hasty=hasty)
    if hasty:
        live.settle(obj, _PAUSE)


def _count(obj: bpy.types.Object) -> int:
    """Members that the structure last had, 0 where that is not known."""
    kept = _lives.get(obj.session_uid)
    return 0 if kept is None or kept.last is None else len(kept.last.rows)


def _keep(obj: bpy.types.Object, sized: Sized, scene: bpy.types.Scene) -> None:
    """Put a result on its structure, and go on from there."""
    _show(obj, sized, scene)
    _lives[obj.session_uid] = Live(sized)
    obj[_BUILT] = digest(record_of(obj, scene))


def _show(obj: bpy.types.Object, sized: Sized, scene: bpy.types.Scene) -> None:
    members.stage_members(obj, sized, obj.heliform.joint, scale_of(scene))
    repaint(obj, scene)


def sized_of(obj: bpy.types.Object, scene: bpy.types.Scene) -> Sized:
    """The structure's last result, or a new one where the file was opened since.

    Raises HeliformError where it cannot be sized.
    """
    record, known = record_of(obj, scene), _lives.get(obj.session_uid)
    if known is not None and known.last is not None and obj.get(_BUILT) == digest(record):
        return known.last
    return size_structure(scene_of(obj, scene), record)


def repaint(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    """Colour the members by what the object says that they are coloured by."""
    members.paint_map(obj, obj.heliform.member_map, scene.heliform.display.palette)


# Handles


def show_handles(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    """Have the view show the handles that the object says, and no others."""
    own, record = obj.heliform, record_of(obj, scene)
    size = float(np.max(obj.dimensions)) / 60
    for shown, kind, names, shape, label in (
        (own.controls, "net", _NETS, "SPHERE", "control"),
        (own.levels, "material", _NINES, "CUBE", "material"),
        (own.turns, "turn", _NINES, "CONE", "turn"),
    ):
        if shown and record.form != "mesh":
            labels = {f"{kind}.{name}": f"{label} {name[1:]}" for name in names}
            handles.add_handles(obj, labels, shape, size)
        else:
            handles.remove_handles(obj, f"{kind}.")
    _place_handles(obj, record, scene)


def _place_handles(obj: bpy.types.Object, record: Structure, scene: bpy.types.Scene) -> None:
    scale = scale_of(scene)
    if handles.handles_of(obj):
        places = {
            f"{kind}.{name}": place / scale
            for kind, names in _GROUPS.items()
            for name, place in zip(names, _places(record, kind), strict=False)
        }
        handles.place(obj, places)


def _places(record: Structure, kind: str) -> Vector:
    """Where the handles of a kind belong (n, 3) in m."""
    if kind == "net":
        return control_places(record).reshape(-1, 3)
    return level_places(record, getattr(record, kind)).reshape(-1, 3)


def follow_handles(obj: bpy.types.Object, scene: bpy.types.Scene) -> None:
    """Take over where hands, keyframes or undo have put the handles, and rebuild if that is new."""
    own, scale = obj.heliform, scale_of(scene)
    record, there = record_of(obj, scene), handles.places_of(obj)
    for kind, names in _GROUPS.items():
        found = [there.get(f"{kind}.{name}") for name in names]
        if any(place is None for place in found):
            continue
        places, before = scale * np.array(found), _places(record, kind)
        if np.abs(places - before).max() <= _STILL * max(scale, float(np.abs(before).max())):
            continue
        if kind == "net":
            write(own.structure.net, net_for(record, places.reshape(4, 4, 3)), scale)
        else:
            levels = levels_for(record, places.reshape(3, 3, 3))
            write(getattr(own.structure, kind), levels, scale)
    if obj.get(_BUILT) == digest(record_of(obj, scene)):
        return
    change(obj, scene)


# As an analysis


def _gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    """The active structure."""
    obj, scene = active_structure(context), context.scene
    if obj is None:
        raise SceneError("Select a structure to size, or add one with Add Structure.")
    record = record_of(obj, scene)
    given = scene_of(obj, scene)
    return Gathered(obj.name, given, record, {obj.name: obj})


def _stage(
    scene: bpy.types.Scene,
    there: Objects,
    result: Sized,
    folder: Path,
    /,
    notes: tuple[str, ...] = (),
) -> bool:
    """Put the result on its structure, or on a new one where there is none."""
    obj = next(iter(there.values()), None)
    if obj is None:
        obj = _found(scene, from_table(Structure, result.meta["parameters"], "parameters"))
    _keep(obj, result, scene)
    members.note_folder(obj, str(folder), notes)
    layers.show_in_views(bpy.context, layers.IN_TEXELS)
    return False


def _add(scene: bpy.types.Scene, record: Structure) -> None:
    """Add the structure of a study, and size it."""
    obj = _found(scene, record)
    rebuild(obj, scene)
    layers.show_in_views(bpy.context, layers.IN_TEXELS)


def _found(scene: bpy.types.Scene, record: Structure) -> bpy.types.Object:
    """A new structure for a record; one of a mesh follows the first body of the scene."""
    source = None
    if record.form == "mesh":
        bodies = (obj for obj in scene.objects if obj.heliform.role == "BODY")
        source = next((obj for obj in bodies if obj.heliform.form != STRUCTURE), None)
    layer = scene.view_layers[0]
    with bpy.context.temp_override(scene=scene, view_layer=layer, collection=scene.collection):
        return _new(bpy.context, record, NAMES[record.form], source)


STRUCTURE_STAGING = Staging(_gather, _stage, _add)


def register() -> None:
    """Have structures follow their handles."""
    live.follow(STRUCTURE, follow_handles, rebuild)


def unregister() -> None:
    """Forget what structures were last sized to."""
    _lives.clear()
