"""The process that jobs run in: requests come in on stdin, replies go out on stdout.

Both are JSON, an object a line. Requests:

    {"job": 7, "study": "…/study.toml", "out": "…/results", "quick": false, "seed": null,
     "settings": []}
    {"job": 8, "live": "…/study.toml", "out": "…/answer"}     see `live.answer_study`
    {"cancel": 7}
    {"warm": ["light"]}     load what these rooms need, before a job asks for it

Replies:

    {"ready": "3.13.5"}     once, with the version of Python
    {"job": 7, "progress": 0.42, "text": "Tracing"}

and one ending a job: {"job": 7, …} with "done": the result folder, "error": a sentence,
"bug": a traceback, or "cancelled": true. The process ends when its stdin is closed, which the
system does when the parent dies; a job that is running is cancelled.
"""

import contextlib
import importlib
import json
import os
import platform
import traceback
from collections.abc import Sequence
from pathlib import Path
from queue import SimpleQueue
from threading import Event, Thread
from typing import Any, BinaryIO, Protocol

from .errors import Cancelled, HeliformError
from .progress import Progress

PATIENCE = 5.0
"""Seconds that a job has to clean up once stdin is closed."""


class Run(Protocol):
    """What does a job: `run_study`, or a stand-in for it."""

    def __call__(
        self,
        study_path: Path,
        out: Path,
        *,
        quick: bool,
        seed: int | None,
        settings: Sequence[str],
        progress: Progress,
    ) -> Any: ...


def main(run: Run | None = None) -> None:
    """Serve this process's stdin and stdout, which are kept for requests and replies alone.

    What jobs print to stdout goes to stderr, and what they read from stdin is empty.
    """
    requests = os.fdopen(os.dup(0), "rb")
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    with contextlib.suppress(BrokenPipeError):  # the parent is dead
        serve(requests, replies, run or _run_study)


def _run_study(study_path: Path, out: Path, **options: Any) -> Any:
    from .run import run_study  # not needed to be ready

    return run_study(study_path, out, **options)


def _answer_study(study_path: Path, out: Path, *, progress: Progress) -> None:
    from .live import answer_study

    answer_study(study_path, out, progress=progress)


def serve(requests: BinaryIO, replies: BinaryIO, run: Run) -> None:
    """Do the jobs in ``requests`` one after the other until it ends."""
    todo: SimpleQueue[dict[str, Any] | None] = SimpleQueue()
    stops: dict[int, Event] = {}
    over = Event()
    Thread(target=_listen, args=(requests, todo, stops, over), daemon=True).start()
    try:
        _reply(replies, ready=platform.python_version())
        while (request := todo.get()) is not None:
            if "warm" in request:
                _warm(request["warm"])
                continue
            job = request["job"]
            progress = _progress(replies, job, stops[job])
            _reply(replies, job=job, **_attempt(request, run, progress))
            del stops[job]
    finally:
        over.set()


def _listen(
    requests: BinaryIO,
    todo: SimpleQueue[dict[str, Any] | None],
    stops: dict[int, Event],
    over: Event,
) -> None:
    """Pass requests on; a cancel overtakes the others."""
    for line in requests:
        request = json.loads(line)
        if "cancel" in request:
            if stop := stops.get(request["cancel"]):
                stop.set()
            continue
        if "job" in request:
            stops[request["job"]] = Event()
        todo.put(request)
    for stop in list(stops.values()):
        stop.set()
    todo.put(None)
    if not over.wait(PATIENCE):
        os._exit(1)


def _reply(replies: BinaryIO, **reply: Any) -> None:
    replies.write(json.dumps(reply).encode() + b"\n")
    replies.flush()


def _progress(replies: BinaryIO, job: int, stop: Event) -> Progress:
    """Send on what the job reports, where it differs to the eye, until it is to stop."""
    last = None

    def report(fraction: float, text: str) -> None:
        nonlocal last
        if stop.is_set():
            raise Cancelled
        news = (round(float(fraction), 3), text)
        if news != last:
            last = news
            _reply(replies, job=job, progress=news[0], text=text)

    return report


def _attempt(request: dict[str, Any], run: Run, progress: Progress) -> dict[str, Any]:
    """How the job ended."""
    try:
        out = Path(request["out"])
        if "live" in request:
            _answer_study(Path(request["live"]), out, progress=progress)
            return {"done": request["out"]}
        run(
            Path(request["study"]),
            out,
            quick=request["quick"],
            seed=request["seed"],
            settings=request["settings"],
            progress=progress,
        )
    except Cancelled:
        return {"cancelled": True}
    except HeliformError as error:
        return {"error": str(error)}
    except Exception:
        return {"bug": traceback.format_exc()}
    return {"done": request["out"]}


def _warm(rooms: list[str]) -> None:
    """Load the rooms; what fails is told when a job needs it."""
    for room in rooms:
        try:
            module = importlib.import_module(f"..{room}", __package__)
            getattr(module, "warm", lambda: None)()
        except Exception:
            traceback.print_exc()
