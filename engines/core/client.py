"""Jobs, as Blender, the command line and tests hand them to the worker process.

    with Worker() as worker:
        job = worker.submit("study.toml", "results")
        ended = worker.wait(job)

Where waiting would freeze a window, call `Worker.poll` a few times a second instead. Nothing here
blocks for longer than it takes a process to die, and nothing happens behind the caller's back:
threads only listen, and every decision is taken inside a call. Call from one thread.
"""

import atexit
import contextlib
import itertools
import json
import math
import os
import queue
import shutil
import signal
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import Thread
from time import monotonic
from typing import Any, Literal, Self

from .errors import WorkerDied
from .files import draft_of

Outcome = Literal["done", "error", "cancelled", "died", "bug"]

PACKAGE = Path(__file__).resolve().parents[2]
START = """
import importlib.util, os, sys
folder = sys.argv[1]
spec = importlib.util.spec_from_file_location(
    "heliform", os.path.join(folder, "__init__.py"), submodule_search_locations=[folder]
)
sys.modules["heliform"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(sys.modules["heliform"])
from heliform.engines.core import worker
worker.main()
"""
"""Imports this folder as ``heliform``, whatever it is called here, and serves."""


@dataclass(frozen=True, slots=True)
class Job:
    """A study that was submitted, and where its result goes; ``live`` where it is a question."""

    id: int
    study: Path
    out: Path
    quick: bool = False
    seed: int | None = None
    settings: tuple[str, ...] = ()
    live: bool = False

    @property
    def part(self) -> Path:
        """Where the result grows before it is renamed to ``out``."""
        return draft_of(self.out)


@dataclass(frozen=True, slots=True)
class Progressed:
    """A job got to ``fraction`` (0..1) and is at ``text``."""

    job: Job
    fraction: float
    text: str


@dataclass(frozen=True, slots=True)
class Ended:
    """A job ended, once: ``text`` is the sentence or traceback, ``out`` the folder of one done."""

    job: Job
    outcome: Outcome
    text: str = ""
    out: Path | None = None


Event = Progressed | Ended


def package_folders() -> list[str]:
    """The folders that this process takes installed packages from."""
    return [folder for folder in sys.path if folder and any(Path(folder).glob("*.dist-info"))]


class Worker:
    """One worker process, started when first needed and again after it died.

    ``python`` is the interpreter and ``paths`` the folders that it finds numpy and the others in;
    both are this process's own where left out. ``environment`` is added to the variables it
    inherits. ``patience`` is how many seconds a job has to obey a cancel. ``command`` starts
    another program that serves in the worker's stead.
    """

    def __init__(
        self,
        python: str | None = None,
        paths: Sequence[str] | None = None,
        environment: Mapping[str, str] | None = None,
        *,
        patience: float = 0.7,
        command: Sequence[str] | None = None,
    ) -> None:
        options = ["-s", "-P", "-u", "-X", "faulthandler"]
        self._command = command or [python or sys.executable, *options, "-c", START, str(PACKAGE)]
        self._environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(package_folders() if paths is None else paths),
            "PYTHONIOENCODING": "utf-8",
            **(environment or {}),
        }
        self._patience = patience
        self._ids = itertools.count(1)
        self._process: _Process | None = None
        self._waiting: deque[Job] = deque()
        self._running: Job | None = None
        self._deadline = math.inf
        self._events: list[Event] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    @property
    def pid(self) -> int | None:
        """The process's number, while there is one."""
        return self._process and self._process.pid

    def start(self) -> None:
        """Have a process, so that the first job need not wait for it.

        Raises WorkerDied where it cannot be started.
        """
        if self._process and self._process.over():
            self._let_go()
        if self._process:
            return
        try:
            self._process = _Process(self._command, self._environment)
        except OSError as error:
            raise WorkerDied(
                f"The worker “{self._command[0]}” cannot be started ({error.strerror}); "
                "choose a Python that exists and may be run."
            ) from error
        atexit.register(self.stop)

    def warm(self, *rooms: str) -> None:
        """Have the process load what jobs of these rooms need, for example "light"."""
        self.start()
        self._send({"warm": rooms})

    def submit(
        self,
        study: str | Path,
        out: str | Path,
        quick: bool = False,
        seed: int | None = None,
        settings: Sequence[str] = (),
    ) -> Job:
        """Run the study file into the folder ``out`` once the jobs before it have ended.

        ``quick``, ``seed`` and ``settings`` are those of `run.run_study`.
        """
        places = Path(study).absolute(), Path(out).absolute()
        job = Job(next(self._ids), *places, quick, seed, tuple(settings))
        return self._queued(job)

    def ask(self, study: str | Path, out: str | Path) -> Job:
        """Have the study answered live into the folder ``out``, once the jobs before have ended.

        See `live.answer_study`. Where that comes to nothing, part of ``out`` may be there.
        """
        return self._queued(
            Job(next(self._ids), Path(study).absolute(), Path(out).absolute(), live=True)
        )

    def _queued(self, job: Job) -> Job:
        self._waiting.append(job)
        self._update()
        return job

    def poll(self) -> list[Event]:
        """What happened since the last call, without waiting."""
        self._update()
        events, self._events = self._events, []
        return events

    def wait(
        self,
        job: Job,
        on_progress: Callable[[Progressed], None] | None = None,
        timeout: float | None = None,
    ) -> Ended:
        """How the job ended, once it has; what happens to other jobs is kept for `poll`.

        Raises TimeoutError after ``timeout`` seconds (the job runs on), and ValueError if the end
        was handed out before.
        """
        latest = math.inf if timeout is None else monotonic() + timeout
        while True:
            while event := next((e for e in self._events if e.job == job), None):
                self._events.remove(event)
                if isinstance(event, Ended):
                    return event
                if on_progress:
                    on_progress(event)
            if job != self._running and job not in self._waiting:
                raise ValueError(f"Job {job.id} has ended before.")
            if monotonic() > latest:
                raise TimeoutError(f"“{job.study}” has not ended within {timeout:g} s.")
            self._update(pause=0.05)

    def cancel(self, job: Job) -> None:
        """Ask the job to stop; `poll` and `wait` end the process if it does not obey."""
        if job in self._waiting:
            self._waiting.remove(job)
            self._events.append(Ended(job, "cancelled"))
        elif job == self._running and self._deadline == math.inf:
            self._send({"cancel": job.id})
            self._deadline = monotonic() + self._patience

    def stop(self) -> None:
        """End the process and cancel what it has not done."""
        for job in [*self._waiting, *filter(None, [self._running])]:
            self.cancel(job)
        if self._process:
            self._process.close(self._patience)
            self._hear()
            self._let_go()

    def _update(self, pause: float = 0.0) -> None:
        """Take in what the process said, waiting ``pause`` seconds for it, and do what is due."""
        if self._process:
            over = self._process.over()
            self._hear(0.0 if over else pause)
            if over or (self._running and monotonic() > self._deadline):
                self._let_go()
        if self._waiting and not self._running:
            self._begin(self._waiting.popleft())

    def _begin(self, job: Job) -> None:
        try:
            self.start()
        except WorkerDied as error:
            self._events.append(Ended(job, "died", str(error)))
            return
        self._running = job
        if job.live:
            self._send({"job": job.id, "live": str(job.study), "out": str(job.out)})
            return
        self._send(
            {
                "job": job.id,
                "study": str(job.study),
                "out": str(job.out),
                "quick": job.quick,
                "seed": job.seed,
                "settings": job.settings,
            }
        )

    def _send(self, request: dict[str, Any]) -> None:
        if self._process:
            self._process.send(request)

    def _hear(self, pause: float = 0.0) -> None:
        for reply in self._process.replies(pause) if self._process else ():
            job = self._running
            if job is None or reply.get("job") != job.id:
                continue
            match reply:
                case {"progress": fraction, "text": text}:
                    self._events.append(Progressed(job, fraction, text))
                case {"done": out}:
                    self._end("done", out=Path(out))
                case {"error": text}:
                    self._end("error", text)
                case {"bug": text}:
                    self._end("bug", text)
                case {"cancelled": _}:
                    self._end("cancelled")

    def _let_go(self) -> None:
        """Part with the process, dead or alive, and end the job that it has left undone."""
        process, self._process = self._process, None
        if process is None:
            return
        atexit.unregister(self.stop)
        process.kill()
        if self._running is None:
            return
        shutil.rmtree(self._running.part, ignore_errors=True)
        if self._deadline < math.inf:
            self._end("cancelled")
        else:
            self._end("died", process.obituary(self._running.study))

    def _end(self, outcome: Outcome, text: str = "", out: Path | None = None) -> None:
        if self._running:
            self._events.append(Ended(self._running, outcome, text, out))
        self._running = None
        self._deadline = math.inf


class _Process:
    """A process that serves, from birth to death, and the threads that listen to it."""

    TAIL = 20_000

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        # A group of its own: Ctrl-C in a terminal is the parent's to answer, and what the worker
        # has started is killed with it.
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            process_group=0,
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )
        self._replies: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        self._tail = b""
        self._listeners = [
            Thread(target=listen, daemon=True) for listen in (self._listen, self._listen_to_stderr)
        ]
        for listener in self._listeners:
            listener.start()

    @property
    def pid(self) -> int:
        return self._process.pid

    def send(self, request: dict[str, Any]) -> None:
        """Write a request, unless nobody is there to read it."""
        assert self._process.stdin
        with contextlib.suppress(OSError):
            self._process.stdin.write(json.dumps(request).encode() + b"\n")
            self._process.stdin.flush()

    def replies(self, pause: float) -> Iterator[dict[str, Any]]:
        """What it said, waiting at most ``pause`` seconds for the first word."""
        with contextlib.suppress(queue.Empty):
            while True:
                yield self._replies.get(timeout=pause)
                pause = 0.0

    def over(self) -> bool:
        """Whether it has ended; its last words are then there to be heard."""
        if self._process.poll() is None:
            return False
        for listener in self._listeners:
            listener.join(0.5)  # not for ever: a process that it started may hold the pipe
        return True

    def close(self, patience: float) -> None:
        """Ask it to end, and wait so many seconds for that."""
        assert self._process.stdin
        with contextlib.suppress(OSError):
            self._process.stdin.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(patience)
        self.over()

    def kill(self) -> None:
        """End it now."""
        if self._process.poll() is None:
            if sys.platform == "win32":
                self._process.kill()
            else:
                os.killpg(self.pid, signal.SIGKILL)
        self.close(1.0)

    def obituary(self, study: Path) -> str:
        """What it died of, and its last lines."""
        code = self._process.returncode
        cause = f"exit code {code}"
        if code is not None and code < 0:
            cause = f"signal {-code} ({signal.strsignal(-code)})"
        text = (
            f"The worker process ended with {cause} before “{study}” was done. "
            "Run it again; if it repeats, run it smaller, for memory may be short, "
            "or report it with what the worker said last."
        )
        lines = self._tail.decode(errors="replace").split("\n")
        last = [line.rstrip()[:200] for line in lines if line.strip()][-20:]
        return "\n".join([text, *last])

    def _listen(self) -> None:
        assert self._process.stdout
        with self._process.stdout as stream:
            for line in stream:
                with contextlib.suppress(ValueError):  # a start-up file of Python's may chat
                    reply = json.loads(line)
                    if isinstance(reply, dict):
                        self._replies.put(reply)
        self._replies.put({})  # wakes who waits

    def _listen_to_stderr(self) -> None:
        assert self._process.stderr
        with self._process.stderr as stream:
            while chunk := os.read(stream.fileno(), 4096):
                self._tail = (self._tail + chunk)[-self.TAIL :]
