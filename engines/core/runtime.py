"""Which Mitsuba runs here, decided before Dr.Jit can load an LLVM that would abort the process.

Dr.Jit compiles for CUDA or through LLVM. With LLVM 15 on an AVX-512 machine it aborts the whole
process, so LLVM's version is read from the library itself first, and only 17 or newer is let
through: the system's, else the one that the llvm-nanobind wheel brings. File names tell enough to
choose by; the library chosen is asked itself before Dr.Jit gets it.
"""

import ctypes
import fnmatch
import functools
import importlib.metadata
import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from .errors import RuntimeMissing

MITSUBA_VERSION = "3.9.1"
OLDEST_LLVM = 17
# libLLVM-15.so.1, libLLVM-14.0.6.so, libLLVM.so.19.1, libLLVM-a6b168f6.so.21.1
NAMED = re.compile(r"LLVM-(\d+)(?:\.(\d+))?(?:\.(\d+))?\.so|\.so\.(\d+)\.(\d+)")
PLACES = {
    "linux": (
        "usr/lib/*/libLLVM*.so*",
        "usr/lib64/libLLVM*.so*",
        "usr/lib/llvm-*/lib/libLLVM*.so*",
    ),
    "darwin": (
        "opt/homebrew/opt/llvm*/lib/libLLVM.dylib",
        "usr/local/opt/llvm*/lib/libLLVM.dylib",
    ),
    "win32": (),
}


@dataclass(frozen=True, slots=True)
class Llvm:
    """A libLLVM on this machine and its version."""

    path: str
    version: tuple[int, int, int]

    @property
    def usable(self) -> bool:
        """Whether Dr.Jit may load it."""
        return self.version[0] >= OLDEST_LLVM


@dataclass(frozen=True, slots=True)
class Choice:
    """What tracing runs on: ``backend`` is "cuda", "llvm" or "" with ``reason`` why not."""

    backend: str
    library: str
    reason: str


@functools.cache
def llvms() -> tuple[Llvm, ...]:
    """Every libLLVM found, the preferred first: named by the user, the system's, the wheel's."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH", "")
    root = Path(Path.cwd().anchor)
    system = [p for pattern in PLACES.get(sys.platform, ()) for p in sorted(root.glob(pattern))]
    paths = dict.fromkeys(str(Path(p).resolve()) for p in (named, *system, *_bundled()) if p)
    return tuple(found for p in paths if (found := _named(p) or _probe(p)))


def _bundled() -> list[str]:
    """The libLLVM inside the llvm-nanobind wheel, if that is installed."""
    try:
        files = importlib.metadata.files("llvm-nanobind") or []
    except importlib.metadata.PackageNotFoundError:
        return []
    return [
        str(f.locate()) for f in files if fnmatch.fnmatch(f.name, "*LLVM*") and f.suffix != ".pyi"
    ]


def _named(path: str) -> Llvm | None:
    """The version in the file's name, where it has one: nothing need be loaded to read that."""
    found = NAMED.search(Path(path).name)
    if not found:
        return None
    major, minor, patch = (
        int(part or 0) for part in (found[1] or found[4], found[2] or found[5], found[3])
    )
    return Llvm(path, (major, minor, patch))


def _probe(path: str) -> Llvm | None:
    """The library's own word for its version; before LLVM 16 it has none and counts as 15."""
    try:
        library = ctypes.CDLL(path)
    except OSError:
        return None
    if not hasattr(library, "LLVMGetVersion"):
        return Llvm(path, (15, 0, 0))
    parts = [ctypes.c_uint() for _ in range(3)]
    library.LLVMGetVersion(*(ctypes.byref(p) for p in parts))
    return Llvm(path, (parts[0].value, parts[1].value, parts[2].value))


@functools.cache
def choose() -> Choice:
    """What tracing will run on here, without loading Dr.Jit."""
    try:
        version = importlib.metadata.version("mitsuba")
    except importlib.metadata.PackageNotFoundError:
        return Choice("", "", "Mitsuba is not installed")
    if version != MITSUBA_VERSION:
        return Choice("", "", f"Mitsuba {version} is installed where {MITSUBA_VERSION} is needed")
    if os.environ.get("HELIFORM_BACKEND") != "llvm" and _has_cuda():
        return Choice("cuda", "", "")
    usable = [found for found in llvms() if found.usable]
    if usable:
        return Choice("llvm", usable[0].path, "")
    old = ", ".join(".".join(map(str, found.version)) for found in llvms())
    found = f"only LLVM {old} is here" if old else "no LLVM is here"
    return Choice("", "", f"{found} and tracing needs LLVM {OLDEST_LLVM} or newer")


def _has_cuda() -> bool:
    """A driver that initialises and counts a device. Untested: no GPU where this was written."""
    name = "nvcuda.dll" if sys.platform == "win32" else "libcuda.so.1"
    try:
        driver = ctypes.CDLL(name)
        count = ctypes.c_int(0)
        return (
            driver.cuInit(0) == 0
            and not driver.cuDeviceGetCount(ctypes.byref(count))
            and count.value > 0
        )
    except (OSError, AttributeError):
        return False


@functools.cache
def mitsuba() -> ModuleType:
    """Mitsuba with its variant set, once a process.

    Raises RuntimeMissing where neither CUDA nor a usable LLVM is there.
    """
    choice = choose()
    if not choice.backend:
        raise RuntimeMissing(
            f"Photon tracing is switched off: {choice.reason}. "
            "Install the llvm-nanobind and mitsuba packages, or the Heliform extension zip that "
            "brings them; geometry, files and the other analyses work without."
        )
    if choice.backend == "llvm":
        told = _probe(choice.library)
        if told is None or not told.usable:
            raise RuntimeMissing(
                f"Photon tracing is switched off: “{choice.library}” is not the LLVM that its name "
                "says; remove it, or point DRJIT_LIBLLVM_PATH at LLVM 17 or newer."
            )
        os.environ["DRJIT_LIBLLVM_PATH"] = choice.library
    import mitsuba as mi

    mi.set_variant(f"{choice.backend}_ad_mono")
    return mi
