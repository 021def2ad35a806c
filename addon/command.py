"""The command line: ``heliform …`` in a Python environment, ``blender --command heliform …``."""

import argparse
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

from ..engines.core import doctor
from ..engines.core.client import Ended
from ..engines.core.errors import Cancelled, FileError, HeliformError

SHIPPED = Path(__file__).resolve().parents[1] / "studies"
CANCELLED = 130
PERIOD = 0.05
"""Seconds between two looks at what the worker said."""

_FULL = 30  # characters of the rewriting line that the bar takes


def main(argv: Sequence[str] | None = None) -> int:
    """Do what ``argv`` says (the program's own arguments if None); returns the exit code.

    0 done, 1 a sentence on stderr, 2 wrong usage, 130 cancelled.
    """
    try:
        options = _parser().parse_args(argv)
    except SystemExit as left:  # Blender must not be left with it
        return int(left.code or 0)
    try:
        return options.act(options)
    except HeliformError as error:
        print(f"heliform: {error}", file=sys.stderr)
        return 1
    except (Cancelled, KeyboardInterrupt):
        print("heliform: cancelled; nothing was written.", file=sys.stderr)
        return CANCELLED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="heliform", description="Light-driven form: run studies and see what came of them."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    run = commands.add_parser("run", help="run a study into a folder")
    run.add_argument("study", help="a study file, or the name of one that `heliform list` names")
    run.add_argument("--out", required=True, type=Path, metavar="DIR", help="the result's folder")
    demo = commands.add_parser("demo", help="run the demo: a printed tube under a lamp")
    demo.add_argument("--out", type=Path, default=Path("out", "demo"), metavar="DIR")
    demo.set_defaults(study="demo")
    for command in (run, demo):
        command.add_argument("--quick", action="store_true", help="a small version, for a look")
        command.add_argument("--seed", type=_seed, metavar="N", help="another random seed")
        command.add_argument(
            *("--set", "-s"),
            dest="settings",
            action="append",
            default=[],
            metavar="SECTION.KEY=VALUE",
            help="override a value of the study; may be repeated",
        )
        command.add_argument(
            "--refine",
            type=Path,
            metavar="FOLDER",
            help="go on from a result of the study that kept its sums (parameters.keep_sums)",
        )
        command.add_argument("--no-blend", action="store_true", help="make no scene.blend")
        command.set_defaults(act=_run)
    commands.add_parser("doctor", help="say what is installed, and what is missing").set_defaults(
        act=_doctor
    )
    commands.add_parser("list", help="name the studies that come along").set_defaults(act=_list)
    return parser


def _seed(text: str) -> int:
    seed = int(text)
    if not 0 <= seed < 2**31:
        raise argparse.ArgumentTypeError("a seed is a whole number from 0 to 2147483647")
    return seed


# run and demo


def _run(options: argparse.Namespace) -> int:
    study, out = find_study(options.study), options.out.absolute()
    settings = list(options.settings)
    if options.refine:
        settings.append(f"refine={json.dumps(str(options.refine.absolute()), ensure_ascii=False)}")
    given = {"quick": options.quick, "seed": options.seed, "settings": tuple(settings)}
    bpy = _blender(options.no_blend)  # before the engine's libraries, some clash the other way
    with _stoppable() as stopped:
        line = _Line(stopped)
        try:
            files = _compute(study, out, given, line)
        finally:
            line.end()
    if bpy is None:
        reason = "not asked for" if options.no_blend else "bpy is not installed"
        print(f"No scene.blend: {reason}.")
    else:
        from .bridge.studies import stage_study

        with _quiet():
            staged = stage_study(study, out, out / "scene.blend", **given)
        files = [*files, *(["scene.blend"] if staged else [])]
    print(f"Written into {out}:")
    for name in files:
        print(f"  {name:<28} {_size((out / name).stat().st_size)}")
    return 0


def _compute(study: Path, out: Path, given: dict[str, Any], line: "_Line") -> list[str]:
    """Run the study: in Blender by the worker that jobs have, elsewhere in this process."""
    if "bpy" in sys.modules and sys.modules["bpy"].app.binary_path:
        return _compute_apart(study, out, given, line)
    from ..engines.core.run import run_study

    return run_study(study, out, progress=line, **given)


def _compute_apart(study: Path, out: Path, given: dict[str, Any], line: "_Line") -> list[str]:
    from .jobs import result_of
    from .workers import new_worker

    with new_worker() as worker:
        job = worker.submit(study, out, **given)
        while True:
            for event in worker.poll():
                if isinstance(event, Ended):
                    folder = result_of(event)
                    return json.loads((folder / "result.json").read_text(encoding="utf-8"))["files"]
                line.show(event.fraction, event.text)
            if line.stopped():
                worker.cancel(job)
            time.sleep(PERIOD)


def find_study(name: str) -> Path:
    """The study file that ``name`` is a path of, or that comes along under that name.

    Raises FileError where there is neither.
    """
    for path in (Path(name), SHIPPED / f"{name}.toml"):
        if path.is_file():
            return path.absolute()
    known = ", ".join(path.stem for path in _shipped()) or "none"
    raise FileError(f"There is no study “{name}”; give a .toml file, or one of: {known}.")


def _shipped() -> list[Path]:
    return sorted(SHIPPED.glob("*.toml"))


def _blender(refused: bool) -> Any:
    """bpy with Heliform registered, or None where there is none or none is wanted."""
    if refused:
        return None
    try:
        import bpy
    except ImportError:
        return None
    if not hasattr(bpy.types.Scene, "heliform"):
        from . import register as register_all

        register_all()
    return bpy


@contextmanager
def _stoppable() -> Iterator[Callable[[], bool]]:
    """While this lasts, Ctrl-C asks to stop; a second one is not as patient."""
    asked = False

    def ask(number: int, frame: FrameType | None) -> None:
        nonlocal asked
        if asked:
            raise KeyboardInterrupt
        asked = True

    before = signal.signal(signal.SIGINT, ask)
    try:
        yield lambda: asked
    finally:
        signal.signal(signal.SIGINT, before or signal.SIG_DFL)  # None is Blender's own


class _Line:
    """Progress: one rewriting line on a terminal, else a line every ten percent."""

    def __init__(self, stopped: Callable[[], bool]) -> None:
        self.stopped = stopped
        self._terminal = sys.stdout.isatty()
        self._began = time.monotonic()
        self._told = -1

    def __call__(self, fraction: float, text: str) -> None:
        if self.stopped():
            raise Cancelled
        self.show(fraction, text)

    def show(self, fraction: float, text: str) -> None:
        """Say how far it is."""
        percent = int(100 * fraction)
        if self._terminal:
            full = round(fraction * _FULL)
            bar = "█" * full + "·" * (_FULL - full)
            print(f"\r{bar} {percent:3} %  {text}\033[K", end="", flush=True)
        elif percent // 10 > self._told:
            self._told = percent // 10
            print(f"{percent:3} %  {text} ({time.monotonic() - self._began:.0f} s)", flush=True)

    def end(self) -> None:
        """Leave the line."""
        if self._terminal:
            print()


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what Blender says about saving off the terminal."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{max(count / 1e3, 0.1):.1f} kB"


# doctor and list


def _doctor(options: argparse.Namespace) -> int:
    lines = doctor.examine()
    print(*lines, sep="\n")
    return 0 if all(line.ok for line in lines if line.name in ("Tracing", "Worker")) else 1


def _list(options: argparse.Namespace) -> int:
    import tomllib

    for path in _shipped():
        title = tomllib.loads(path.read_text(encoding="utf-8")).get("title", "")
        print(f"{path.stem:<20} {title}")
    return 0


# In Blender

_command: Any = None


def register() -> None:
    """Answer ``blender --command heliform``."""
    import bpy

    global _command
    _command = bpy.utils.register_cli_command("heliform", main)


def unregister() -> None:
    """Answer no more."""
    import bpy

    bpy.utils.unregister_cli_command(_command)
