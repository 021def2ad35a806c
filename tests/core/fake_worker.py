"""A worker whose jobs are small tricks, each named by its study file."""

import ctypes
import os
import sys
import time
from pathlib import Path

from heliform.engines.core.errors import SceneError
from heliform.engines.core.files import draft_of
from heliform.engines.core.worker import main


def ping(out, progress, **asked):
    pass


def steps(out, progress, **asked):
    for done in range(5):
        progress(done / 5, f"Step {done}")


def echo(out, progress, study, quick, seed, settings):
    out.mkdir()
    (out / "echo.txt").write_text(f"{study}\n{quick} {seed} {settings}", encoding="utf-8")


def endless(out, progress, **asked):
    while True:
        progress(0.5, "Round and round")
        time.sleep(0.005)


def stuck(out, progress, **asked):
    """Sleep in C like a long kernel; where it can be had, with Python's lock held."""
    draft_of(out).mkdir()
    progress(0.1, "Into C")
    sleep = time.sleep if sys.platform == "win32" else ctypes.PyDLL(None).sleep
    sleep(60)


def mistake(out, progress, **asked):
    raise SceneError("Tube “Vase ä/1” is open: 14 edges have one face.")


def bug(out, progress, **asked):
    return 1 / 0


def chatter(out, progress, **asked):
    print('{"job": 1, "done": "not so"}')
    os.write(1, b"and without a line's end")
    os.system("echo a child speaks")
    progress(0.5, f"stdin holds {sys.stdin.read()!r}")


def crash(out, progress, **asked):
    ctypes.string_at(0)


def run(study_path, out, *, progress, **asked):
    trick = globals()[study_path.stem]
    trick(out, progress, study=study_path, **asked)


if __name__ == "__main__":
    main(run)
    if "GOODBYE" in os.environ:
        Path(os.environ["GOODBYE"]).touch()
