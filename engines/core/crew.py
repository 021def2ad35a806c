"""A crew of processes that share one list of tasks.

    with Crew("heliform.engines.glass.judging:judged", setting, count=4) as crew:
        for news in crew.work(tasks): ...

Each process imports this folder as ``heliform`` and calls the named function with ``setting`` and
one task after the other. Both are what JSON can say, the answers arrays. A process ends when its
stdin is closed, which the system does when the parent dies; leaving the block ends them at once.
"""

import contextlib
import importlib
import io
import json
import os
import queue
import subprocess
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from threading import Thread
from typing import IO, Any, Self

import numpy as np

from .client import PACKAGE, package_folders
from .errors import HeliformError, WorkerDied

_BOOT = """
import importlib.util, os, sys
folder = sys.argv[1]
spec = importlib.util.spec_from_file_location(
    "heliform", os.path.join(folder, "__init__.py"), submodule_search_locations=[folder]
)
sys.modules["heliform"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(sys.modules["heliform"])
from heliform.engines.core import crew
crew.main()
"""
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_LOOK = 0.1  # seconds between two looks at whether to stop


class Crew:
    """``count`` processes that call ``function``, "package.module:name", with setting and task.

    The function returns an array, or what numpy makes one of, without objects in it.
    """

    def __init__(self, function: str, setting: Any, count: int) -> None:
        self._order = _line({"function": function, "setting": setting})
        self._count = count
        self._members: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Self:
        environment = os.environ | dict.fromkeys(_ONE_THREAD, "1")
        environment["PYTHONPATH"] = os.pathsep.join(package_folders())
        for _ in range(self._count):
            member = subprocess.Popen(
                [sys.executable, "-s", "-P", "-u", "-c", _BOOT, str(PACKAGE)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=environment,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
            self._members.append(member)
            assert member.stdin
            with contextlib.suppress(OSError):  # one that is dead already is told of by `work`
                member.stdin.write(self._order)
        return self

    def __exit__(self, *_: object) -> None:
        for member in self._members:
            member.kill()
        for member in self._members:
            member.wait()
            for pipe in (member.stdin, member.stdout):
                assert pipe
                with contextlib.suppress(OSError):
                    pipe.close()

    def work(self, tasks: Sequence[Any]) -> Iterator[tuple[int, Any] | None]:
        """Index and answer of each task as they come, and None every tenth of a second between.

        Raises what a task raised where that is a HeliformError, WorkerDied where a process died.
        """
        todo: queue.SimpleQueue[int] = queue.SimpleQueue()
        for index in range(len(tasks)):
            todo.put(index)
        done: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
        for member in self._members:
            Thread(target=self._serve, args=(member, tasks, todo, done), daemon=True).start()
        left = len(tasks)
        while left:
            try:
                index, answer = done.get(timeout=_LOOK)
            except queue.Empty:
                yield None
                continue
            if isinstance(answer, Exception):
                raise answer
            left -= 1
            yield index, answer

    def _serve(
        self,
        member: "subprocess.Popen[bytes]",
        tasks: Sequence[Any],
        todo: "queue.SimpleQueue[int]",
        done: "queue.SimpleQueue[tuple[int, Any]]",
    ) -> None:
        """Hand tasks to one process until there are none or it ends."""
        assert member.stdin
        assert member.stdout
        try:
            while True:
                index = todo.get_nowait()
                member.stdin.write(_line(tasks[index]))
                member.stdin.flush()
                done.put((index, _read(member.stdout)))
        except queue.Empty:
            return
        except (OSError, ValueError):
            died = WorkerDied("A process that shared the work ended early; run it again.")
            done.put((-1, died))


def main() -> None:
    """Serve this process's stdin and stdout, which are kept for tasks and answers alone."""
    tasks = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    with contextlib.suppress(BrokenPipeError, KeyboardInterrupt):
        order = json.loads(tasks.readline() or "null")
        if order is None:  # the parent is dead
            return
        module, _, name = order["function"].partition(":")
        act = getattr(importlib.import_module(module), name)
        for task in tasks:
            answers.write(_answer(act, order["setting"], json.loads(task)))
            answers.flush()


def _answer(act: Callable[[Any, Any], Any], setting: Any, task: Any) -> bytes:
    """A line of how many bytes follow, with the array in them, or of what went wrong."""
    array = io.BytesIO()
    try:
        np.save(array, act(setting, task), allow_pickle=False)
    except HeliformError as error:
        return _line({"error": str(error)})
    except Exception:
        return _line({"bug": traceback.format_exc()})
    return _line({"bytes": array.tell()}) + array.getvalue()


def _read(answers: IO[bytes]) -> Any:
    """The array of an answer, or the exception that it tells of."""
    head = json.loads(answers.readline())
    if "error" in head:
        return HeliformError(head["error"])
    if "bug" in head:
        return RuntimeError(head["bug"])
    return np.load(io.BytesIO(answers.read(head["bytes"])), allow_pickle=False)


def _line(value: Any) -> bytes:
    return json.dumps(value).encode() + b"\n"
