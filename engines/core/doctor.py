"""What is here, what is missing, and what works without it: one line for each."""

import contextlib
import importlib
import importlib.metadata
import platform
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from . import meshlab, runtime
from .client import Worker

NEEDED_FOR = {
    "numpy": "everything",
    "scipy": "intervals and sampling",
    "mitsuba": "tracing photons",
    "drjit": "tracing photons",
    "trimesh": "checking and reading meshes",
    "pymeshlab": "cleaning scanned meshes",
    "shapely": "walls that would run into themselves, and checking prints",
    "lxml": "3MF files",
    "networkx": "3MF files",
    "OpenEXR": "saving and loading results",
    "pillow": "pictures",
    "plotly": "interactive reports",
    "tomli-w": "saving studies",
}
PATIENCE = 60.0


@dataclass(frozen=True, slots=True)
class Line:
    """One thing that was looked at; ``text`` is its version, or what is missing and what for."""

    name: str
    ok: bool
    text: str

    def __str__(self) -> str:
        return f"{'ok     ' if self.ok else 'MISSING'}  {self.name:<10}  {self.text}"


def examine(worker: Worker | None = None) -> list[Line]:
    """Look at everything that Heliform stands on; takes seconds, for a worker is started.

    ``worker`` starts the process as jobs do; left out, it is this Python.
    """
    return [
        Line("Python", True, f"{platform.python_version()} on {platform.platform()}"),
        *(_package(name, use) for name, use in NEEDED_FOR.items()),
        _llvm(),
        _cuda(),
        _blender(),
        _tracing(),
        _worker(worker or Worker()),
    ]


def backend_text() -> str:
    """What photons are traced with, or why they are not, in a line."""
    choice = runtime.choose()
    if choice.backend == "cuda":
        return "CUDA (untested)"
    if not choice.backend:
        return f"Off: {choice.reason}"
    found = next(f for f in runtime.llvms() if f.path == choice.library)
    return f"LLVM {_dotted(found)}, {_origin(found)}"


def _package(name: str, use: str) -> Line:
    try:
        version = importlib.metadata.version(name)
        lacks = f"; {meshlab.lacking()}" if name == "pymeshlab" and meshlab.lacking() else ""
        return Line(name, True, f"{version}{lacks}")
    except importlib.metadata.PackageNotFoundError:
        with contextlib.suppress(ImportError):  # Blender's own numpy may come without a record
            version = getattr(importlib.import_module(name), "__version__", "of unknown version")
            return Line(name, True, version)
        return Line(name, False, f"not installed; without it there is no {use}")


def _llvm() -> Line:
    found = runtime.llvms()
    if not found:
        return Line("LLVM", False, "none found; install the llvm-nanobind package")
    used = next((llvm for llvm in found if llvm.usable), None)
    told = [
        f"{_dotted(llvm)} ({_origin(llvm)}"
        + (", used)" if llvm is used else ")" if llvm.usable else ", too old)")
        for llvm in found
    ]
    return Line("LLVM", used is not None, "; ".join(told))


def _dotted(llvm: runtime.Llvm) -> str:
    if llvm.version[0] < 16:  # these cannot say which they are
        return "15 or older"
    return ".".join(map(str, llvm.version))


def _origin(llvm: runtime.Llvm) -> str:
    bundled = "llvm_nanobind" in llvm.path
    return "from the bundled wheel" if bundled else f"of the system, {llvm.path}"


def _cuda() -> Line:
    if runtime.choose().backend == "cuda":
        return Line("CUDA", True, "a device is there and is used; untested by Heliform's makers")
    return Line("CUDA", True, "no device; LLVM is used instead")


def _blender() -> Line:
    bpy = sys.modules.get("bpy")
    if bpy is not None:
        return Line("Blender", True, f"{bpy.app.version_string}, running")
    try:
        return Line("Blender", True, f"bpy {importlib.metadata.version('bpy')}, not loaded")
    except importlib.metadata.PackageNotFoundError:
        return Line("Blender", False, "no bpy here; studies run, but no scene.blend is made")


def _tracing() -> Line:
    ok = bool(runtime.choose().backend)
    rest = "" if ok else "; shapes, files and displays work without"
    return Line("Tracing", ok, backend_text() + rest)


def _worker(worker: Worker) -> Line:
    """Starts a process and hands it a study that is not there: the sentence is the answer."""
    with worker, tempfile.TemporaryDirectory() as folder:
        missing = Path(folder, "nothing.toml")
        seconds = []
        for _ in range(2):
            began = time.perf_counter()
            try:
                ended = worker.wait(worker.submit(missing, Path(folder, "out")), timeout=PATIENCE)
            except TimeoutError:
                return Line("Worker", False, f"no answer within {PATIENCE:g} s; no job can run")
            seconds.append(time.perf_counter() - began)
            if ended.outcome != "error":
                said = ended.text.strip().splitlines() or [ended.outcome]
                return Line("Worker", False, f"no job can run: {said[-1]}")
    start, again = seconds
    return Line("Worker", True, f"started in {start:.1f} s, answers in {1000 * again:.1f} ms")
