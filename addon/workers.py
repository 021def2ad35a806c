"""Which Python runs the worker process beside this Blender."""

import functools
import shutil
import subprocess
import sys
from pathlib import Path

from ..engines.core.client import Worker
from ..engines.core.errors import WorkerDied


def new_worker() -> Worker:
    """A worker that runs in this Blender's kind of Python, with its packages."""
    return Worker(interpreter())


@functools.cache
def interpreter() -> str:
    """A Python of the version that Blender runs. Raises WorkerDied where there is none."""
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    beside = [Path(sys.prefix, *place) for place in (("bin", f"python{version}"), ("python.exe",))]
    for path in (sys.executable, *map(str, beside), shutil.which(f"python{version}") or ""):
        if path and _version(path) == version:
            return path
    raise WorkerDied(
        f"There is no Python {version} beside this Blender to compute with; install it, or take "
        "Blender from blender.org, which brings its own."
    )


def _version(path: str) -> str:
    ask = "import sys; print('%d.%d' % sys.version_info[:2])"
    try:
        said = subprocess.run([path, "-I", "-c", ask], capture_output=True, text=True, timeout=20)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return said.stdout.strip()
