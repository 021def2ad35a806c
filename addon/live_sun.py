"""Live Sun: while it is on, the colours on the receivers follow whatever moves.

Blender says that something moved; the scene is then asked of the worker, where what does not change
is remembered. There is never more than one question on its way, and what moves meanwhile is asked
about next. In background there are no timers, and a change is answered at once.
"""

import shutil
import tempfile
import time
from collections import deque
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import bpy

from ..engines.core.client import Ended
from ..engines.core.errors import HeliformError
from ..engines.core.export import save_study
from ..engines.core.live import same
from ..engines.core.scene import Receiver, Scene, Surface
from ..engines.sun import SUN_RADIATION
from . import jobs
from .bridge import layers, sun
from .bridge.instances import may_instance

_LOOK = 0.004  # seconds between two looks for the answer
_WINDOW = 3.0  # seconds over which answers are counted


@dataclass(slots=True)
class State:
    """What the panel shows: why there is no answer, and how many come a second."""

    problem: str = ""
    rate: float = 0.0
    times: deque[float] = field(default_factory=deque)


@dataclass(frozen=True, slots=True)
class _Question:
    """A scene that is asked about, as uids, for names and pointers may change."""

    scene: int
    objects: dict[str, int]
    folder: Path
    asked: tuple[Scene, Any]
    notes: tuple[str, ...]


state = State()
_wanted: set[int] = set()
_question: _Question | None = None
_answered: dict[int, tuple[Scene, Any]] = {}
"""The scene and the record that each scene's colours are the answer to."""


def switched(scene: bpy.types.Scene) -> None:
    """Live Sun was switched on or off."""
    _answered.pop(scene.session_uid, None)
    state.problem, state.rate = "", 0.0
    state.times.clear()
    if scene.heliform.live_sun:
        layers.show_in_views(bpy.context, layers.IN_TEXELS)
    elif sun.facts_of(scene):
        sun.say(scene, footing="")
    changed(scene)


def changed(scene: bpy.types.Scene) -> None:
    """Something that the answer rests on has changed."""
    if not scene.heliform.live_sun:
        return
    _wanted.add(scene.session_uid)
    if not bpy.app.background:
        if not bpy.app.timers.is_registered(_tick):
            bpy.app.timers.register(_tick, first_interval=0.0)
        return
    while (pause := _tick()) is not None:
        time.sleep(pause)


def _tick() -> float | None:
    """Take in an answer, ask the next question; ends where there is neither."""
    if _question is not None:
        jobs.hear()
    if _question is None and _wanted:
        _ask()
    if _question is None:
        return None
    return jobs.PERIOD if jobs.state.running else _LOOK


def _ask() -> None:
    """Ask about the scene that is in the window, unless its colours are the answer already."""
    global _question
    scene = bpy.context.scene
    wanted = scene.session_uid in _wanted
    _wanted.clear()
    if not wanted or not scene.heliform.live_sun:
        return
    try:
        given = sun.gather(bpy.context, SUN_RADIATION)
        coarse = replace(
            given.scene, receivers=tuple(_coarse(scene, r) for r in given.scene.receivers)
        )
        asked = coarse, given.parameters
        if same(asked, _answered.get(scene.session_uid)):
            _say("")
            return
        folder = Path(tempfile.mkdtemp(prefix="live-", dir=bpy.app.tempdir))
        uids = {name: obj.session_uid for name, obj in given.objects.items()}
        notes = given.notes + given.remarks
        _question = _Question(scene.session_uid, uids, folder, asked, notes)
        study = save_study(
            folder, scene.name, coarse, SUN_RADIATION, given.parameters, 0, carry=False
        )
        jobs.ask(study, folder / "answer", _hear)
    except HeliformError as error:
        _drop()
        _say(str(error))


def _coarse(scene: bpy.types.Scene, receiver: Receiver | Surface) -> Receiver | Surface:
    """The receiver with no more texels along its longer side than Live Sun is to have."""
    longer = max(receiver.columns, receiver.rows)
    share = min(1.0, scene.heliform.live_texels / longer)
    columns, rows = (max(1, round(share * n)) for n in (receiver.columns, receiver.rows))
    return replace(receiver, columns=columns, rows=rows)


def _hear(ended: Ended) -> None:
    """Show an answer, or say why there is none."""
    question = _question
    assert question is not None
    try:
        result = SUN_RADIATION.shows.load(jobs.result_of(ended))
        scene = next((s for s in bpy.data.scenes if s.session_uid == question.scene), None)
        if scene is None or not scene.heliform.live_sun:
            return
        there = {obj.session_uid: obj for obj in scene.objects}
        objects = {name: there[uid] for name, uid in question.objects.items() if uid in there}
        _count()
        sun.stage(scene, objects, result, None, question.notes, _rate_text())
        _answered[scene.session_uid] = question.asked
        _say("")
    except HeliformError as error:
        _say(str(error))
    finally:
        _drop()


def _drop() -> None:
    """Be done with the question."""
    global _question
    if _question is not None:
        shutil.rmtree(_question.folder, ignore_errors=True)
    _question = None


def _count() -> None:
    now = time.perf_counter()
    if state.times and now - state.times[-1] > _WINDOW:
        state.times.clear()
    state.times.append(now)
    while now - state.times[0] > _WINDOW:
        state.times.popleft()
    span = now - state.times[0]
    state.rate = (len(state.times) - 1) / span if span else 0.0


def _rate_text() -> str:
    return f"live, {state.rate:.1f} a second" if state.rate else "live"


def _say(problem: str) -> None:
    """Keep what is wrong, and have the sidebars show it."""
    state.problem = problem
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()


# What Blender says


@bpy.app.handlers.persistent
def _moved(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if not scene.heliform.live_sun or bpy.app.background:
        return
    if any(_matters(update) for update in depsgraph.updates):
        changed(scene)


def _matters(update: bpy.types.DepsgraphUpdate) -> bool:
    """Whether a body, a receiver or what shows bodies as instances moved or changed its shape, or
    the scene what it holds."""
    if isinstance(update.id, (bpy.types.Scene, bpy.types.Collection)):
        return True
    if not isinstance(update.id, bpy.types.Object):
        return False
    moved = update.is_updated_transform or update.is_updated_geometry
    obj = update.id.original
    return moved and (obj.heliform.role in ("BODY", "RECEIVER") or may_instance(obj))


@bpy.app.handlers.persistent
def _framed(scene: bpy.types.Scene, *_: object) -> None:
    changed(scene)


@bpy.app.handlers.persistent
def _undone(*_: object) -> None:
    _answered.clear()
    for scene in bpy.data.scenes:
        if not bpy.app.background:
            changed(scene)


@bpy.app.handlers.persistent
def _loading(*_: object) -> None:
    """Another file comes: what is asked is of no interest any more."""
    _drop()
    _wanted.clear()
    _answered.clear()


_HANDLERS = (
    (bpy.app.handlers.depsgraph_update_post, _moved),
    (bpy.app.handlers.frame_change_post, _framed),
    (bpy.app.handlers.undo_post, _undone),
    (bpy.app.handlers.redo_post, _undone),
    (bpy.app.handlers.load_pre, _loading),
    (bpy.app.handlers.load_post, _undone),
)


def register() -> None:
    """Begin to follow."""
    for handlers, act in _HANDLERS:
        handlers.append(act)


def unregister() -> None:
    """Follow no more."""
    for handlers, act in _HANDLERS:
        handlers.remove(act)
    if bpy.app.timers.is_registered(_tick):
        bpy.app.timers.unregister(_tick)
    _loading()
