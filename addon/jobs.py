"""Analyses as jobs of one warm worker process, for the window and for scripts.

In the window `begin` returns at once and a timer follows the job; elsewhere `run` waits for it.
Either way the scene is written as a study, the worker runs it, and the result is staged here.
"""

import contextlib
import itertools
import shutil
import sys
import tempfile
import textwrap
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy

from ..engines.core.analysis import Analysis
from ..engines.core.client import Ended, Job, Progressed, Worker
from ..engines.core.colour import Display
from ..engines.core.errors import Cancelled, FileError, HeliformError, SceneError, WorkerDied
from ..engines.core.export import save_study
from ..engines.core.files import safe_name
from .bridge.shading import show_in_views
from .preferences import results_folder
from .properties import read
from .rooms import staging_of
from .staging import Gathered, Staging
from .workers import new_worker

PERIOD = 0.1
"""Seconds between two looks at what the worker said."""


@dataclass(slots=True)
class State:
    """What the panel shows of the job that runs, or of how the last one ended."""

    running: bool = False
    label: str = ""
    fraction: float = 0.0
    text: str = ""
    message: str = ""
    started: float = 0.0
    cancelling: bool = False

    @property
    def elapsed(self) -> float:
        """Seconds since the job began."""
        return time.monotonic() - self.started


@dataclass(slots=True)
class _Task:
    """A job and what is to become of its result: uids, for names and pointers may change."""

    analysis: Analysis
    staging: Staging
    label: str
    folder: Path
    out: Path
    scene: int
    objects: dict[str, int]
    settings: tuple[str, ...]
    notes: tuple[str, ...]
    remarks: tuple[str, ...]
    job: Job | None = None
    forgotten: bool = False


state = State()
_worker: Worker | None = None
_tasks: dict[int, _Task] = {}
_asked: dict[int, Callable[[Ended], None]] = {}
_shown: tuple[str, int, int] | None = None


# What operators call


def begin(
    context: bpy.types.Context,
    analysis: Analysis,
    label: str,
    settings: Sequence[str] = (),
    staging: Staging | None = None,
) -> None:
    """Start a job on the context's scene and follow it while the window stays alive.

    ``settings`` override its study, see `load_study`; ``staging`` is that of the analysis unless
    given. Raises HeliformError where the scene cannot be read or the worker not be started.
    """
    task = _prepare(context, analysis, label, settings, staging)
    if task.notes:  # an object got a map: a step of its own, for the result is another
        bpy.ops.ed.undo_push(message="Unwrap")
    _submit(task)
    if not bpy.app.timers.is_registered(_follow):
        bpy.app.timers.register(_follow, first_interval=PERIOD, persistent=True)
    _redraw()


def run(
    context: bpy.types.Context,
    analysis: Analysis,
    label: str,
    settings: Sequence[str] = (),
    staging: Staging | None = None,
) -> None:
    """Run a job to its end and stage the result; ``settings`` and ``staging`` as in `begin`.

    Raises HeliformError as the engine does, Cancelled where it was cancelled.
    """
    task = _prepare(context, analysis, label, settings, staging)
    job = _submit(task)
    try:
        ended = worker().wait(job, _progressed)
    except KeyboardInterrupt:
        worker().cancel(job)
        ended = worker().wait(job)
    finally:
        del _tasks[job.id]
        state.running = False
        _tidy(task)
    try:
        _conclude(task, ended)
    except WorkerDied as error:
        raise WorkerDied(_told(task, error)) from None


def ask(study: Path, out: Path, answered: Callable[[Ended], None]) -> Job:
    """Have the worker answer a study live into ``out``; `hear` calls ``answered`` with how it went.

    Raises WorkerDied where there is no worker.
    """
    job = worker().ask(study, out)
    _asked[job.id] = answered
    return job


def cancel() -> None:
    """Ask the running job to stop."""
    for task in _tasks.values():
        if task.job and _worker:
            state.cancelling = True
            _worker.cancel(task.job)


def worker() -> Worker:
    """The session's worker. Raises WorkerDied where there is no Python to run it."""
    global _worker
    if _worker is None:
        _worker = new_worker()
    return _worker


# From the scene to a result folder


def _prepare(
    context: bpy.types.Context,
    analysis: Analysis,
    label: str,
    settings: Sequence[str] = (),
    staging: Staging | None = None,
) -> _Task:
    """Write the scene as a study, and say where its result belongs."""
    staging = staging or staging_of(analysis)
    assert staging, f"{analysis.name} has no staging"
    given = staging.gather(context, analysis)
    folder = Path(tempfile.mkdtemp(prefix="job-", dir=bpy.app.tempdir))
    try:
        export(context.scene, given, analysis, folder, carry=False)
        out = _new_folder(given.name)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    return _Task(
        analysis=analysis,
        staging=staging,
        label=label,
        folder=folder,
        out=out,
        scene=context.scene.session_uid,
        objects={name: obj.session_uid for name, obj in given.objects.items()},
        settings=tuple(settings),
        notes=given.notes,
        remarks=given.remarks,
    )


def export(
    scene: bpy.types.Scene, given: Gathered, analysis: Analysis, folder: Path, carry: bool = True
) -> Path:
    """Write what was gathered of a scene as a study of ``analysis``; ``carry`` as in `save_study`.

    Raises FileError.
    """
    title = Path(bpy.data.filepath).stem or given.name
    settings = scene.heliform
    display = given.display or read(settings.display, Display)
    return save_study(
        folder, title, given.scene, analysis, given.parameters, settings.seed, display, carry
    )


def _new_folder(name: str) -> Path:
    """A folder for a result, made at once: another Blender may want one in the same second.

    Raises FileError where there can be none.
    """
    stamp, folder = f"{safe_name(name)} {time.strftime('%Y-%m-%d %H.%M.%S')}", results_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for tail in itertools.chain([""], (f" {n}" for n in itertools.count(2))):
            with contextlib.suppress(FileExistsError):
                (folder / f"{stamp}{tail}").mkdir()
                return folder / f"{stamp}{tail}"
        raise AssertionError
    except OSError as failed:
        raise FileError(
            f"The folder “{folder}” cannot be written: {failed.strerror}; choose another."
        ) from None


def _tidy(task: _Task) -> None:
    """Drop what a job that has ended needs no more: its study, and the folder of no result."""
    shutil.rmtree(task.folder, ignore_errors=True)
    with contextlib.suppress(OSError):  # a result is in it
        task.out.rmdir()


def _submit(task: _Task) -> Job:
    global state
    task.job = worker().submit(task.folder / "study.toml", task.out, settings=task.settings)
    _tasks[task.job.id] = task
    state = State(running=True, label=task.label, text="Starting", started=time.monotonic())
    return task.job


# From the worker's words to the scene


def _follow() -> float | None:
    """Called by Blender's timer: take in what happened, end when there is nothing to follow."""
    global _shown
    hear()
    news = (state.text, round(100 * state.fraction), int(state.elapsed))
    if state.running and news != _shown:
        _shown = news
        _redraw()
    return PERIOD if _tasks else None


def hear() -> None:
    """Take in what the worker said: how far jobs are, how they ended, and answers."""
    for event in worker().poll():
        if isinstance(event, Ended) and event.job.id in _asked:
            _asked.pop(event.job.id)(event)
        task = _tasks.get(event.job.id)
        if task is None:
            continue
        if isinstance(event, Ended):
            del _tasks[event.job.id]
            _tidy(task)
            _finish(task, event)
        elif not task.forgotten:
            _progressed(event)


def _progressed(event: Progressed) -> None:
    state.fraction, state.text = event.fraction, event.text


def _finish(task: _Task, ended: Ended) -> None:
    """End a job of the window: its result becomes an undo step, its trouble a sentence."""
    if task.forgotten:
        return
    state.running = False
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, screen=window.screen):
        try:
            first = _conclude(task, ended)
            if first:
                show_in_views(bpy.context)
            bpy.ops.ed.undo_push(message=task.label)
        except Cancelled:
            state.message = ""
        except HeliformError as error:
            state.message = _told(task, error)
            _popup(task.label, state.message)
        finally:
            _redraw()
            bpy.app.timers.register(_redraw, first_interval=0.3)  # the panels have moved


def _conclude(task: _Task, ended: Ended) -> bool:
    """Stage what a job gave; whether it is the scene's first result.

    Raises HeliformError for what went wrong, and Cancelled.
    """
    out = result_of(ended)
    result = task.analysis.shows.load(out)
    scene = _by_uid(bpy.data.scenes, task.scene)
    there = scene.objects if scene else ()  # undo holds on to objects that are in no scene
    found = {name: _by_uid(there, uid) for name, uid in task.objects.items()}
    objects = {name: obj for name, obj in found.items() if obj}
    if scene is None or (found and not objects):
        raise SceneError(f"{_gone(task, found)}; the result lies in “{out}”.")
    lost = (f"{_gone(task, found)}.",) if len(objects) < len(found) else ()
    return task.staging.stage(scene, objects, result, out, task.notes + task.remarks + lost)


def _gone(task: _Task, found: dict[str, bpy.types.Object | None]) -> str:
    names = [f"“{name}”" for name, obj in found.items() if obj is None] or ["The scene"]
    were = "was" if len(names) == 1 else "were"
    return f"{', '.join(names)} {were} deleted while “{task.label}” ran"


def _told(task: _Task, error: HeliformError) -> str:
    """What went wrong, without a folder that nobody knows of."""
    return str(error).replace(f"“{task.folder / 'study.toml'}”", f"“{task.label}”")


def result_of(ended: Ended) -> Path:
    """The result folder of a job that is done; raises what ended another, in one sentence."""
    if ended.out:
        return ended.out
    if ended.outcome == "cancelled":
        raise Cancelled
    if ended.outcome == "error":
        raise HeliformError(ended.text)
    print(ended.text, file=sys.stderr)
    first, *_, last = ended.text.strip().splitlines() * 2
    if ended.outcome == "died":
        raise WorkerDied(first)
    raise HeliformError(f"Heliform has a bug; report it with what the console says: {last}")


def _by_uid(collection: Any, uid: int) -> Any:
    return next((block for block in collection if block.session_uid == uid), None)


# The window


def _redraw() -> None:
    """Show the state: in the sidebars and the status bar, the 3D view itself is costly."""
    percent = f"{state.label} {100 * state.fraction:.0f} %: {state.text}"
    for window in bpy.context.window_manager.windows:
        window.workspace.status_text_set(percent if state.running else None)
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI" or not state.running:
                        region.tag_redraw()


def _popup(title: str, sentence: str) -> None:
    def draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
        for line in textwrap.wrap(sentence, 90):
            menu.layout.label(text=line)

    bpy.context.window_manager.popup_menu(draw, title=title, icon="ERROR")


@bpy.app.handlers.persistent
def _forget(*_: object) -> None:
    """Another file is loaded: what runs is cancelled, and its result belongs nowhere."""
    global state
    if _tasks:
        cancel()
        for task in _tasks.values():
            task.forgotten = True
    _asked.clear()
    state = State()
    _redraw()


def register() -> None:
    """Follow the loading of files."""
    bpy.app.handlers.load_pre.append(_forget)


def unregister() -> None:
    """End the worker and what it does."""
    global _worker, state
    bpy.app.handlers.load_pre.remove(_forget)
    if bpy.app.timers.is_registered(_follow):
        bpy.app.timers.unregister(_follow)
    if _worker:
        _worker.stop()
        _worker = None
    for task in _tasks.values():
        _tidy(task)
    _tasks.clear()
    _asked.clear()
    if state.running:  # not now: when Blender quits, its windows are half gone
        bpy.app.timers.register(_redraw)
    state = State()
