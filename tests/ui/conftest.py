"""A real Blender with the extension installed from its zip, as a person has it."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
OLDEST = (5, 2)
PLATFORM = {"linux": "linux-x64", "win32": "windows-x64", "darwin": "macos-arm64"}[sys.platform]

HERE = Path(__file__).parent

Blender = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def blender() -> str:
    """The Blender that HELIFORM_BLENDER names, else the one on the PATH; skips where none is."""
    program = os.environ.get("HELIFORM_BLENDER") or shutil.which("blender")
    if not program:
        pytest.skip("needs a Blender 5.2 on the PATH or in HELIFORM_BLENDER")
    try:
        told = subprocess.run([program, "--version"], capture_output=True, encoding="utf-8")
    except OSError as failed:
        pytest.fail(f"HELIFORM_BLENDER is “{program}”, which does not run: {failed.strerror}")
    found = re.search(r"Blender (\d+)\.(\d+)", told.stdout)
    if not found or tuple(map(int, found.groups())) < OLDEST:
        pytest.skip(f"needs Blender 5.2 or newer; “{program}” is {found and found[0]}")
    return program


@pytest.fixture(scope="session")
def extension() -> Path:
    """The zip for this platform, built where it is not there as it would be."""
    build = [sys.executable, ROOT / "tools" / "package.py", "--platform", PLATFORM]
    built = subprocess.run(build, capture_output=True, encoding="utf-8")
    assert built.returncode == 0, built.stderr
    return next((ROOT / "dist").glob(f"heliform-*-{PLATFORM}.zip"))


@pytest.fixture(scope="session")
def scripts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of this folder among the temporary files: a boxed-in Blender may see nothing else."""
    return shutil.copytree(HERE, tmp_path_factory.mktemp("scripts") / HERE.name)


@pytest.fixture(scope="session")
def installed_blender(
    blender: str, extension: Path, tmp_path_factory: pytest.TempPathFactory
) -> Blender:
    """Runs Blender with the words given, the extension installed in a user folder of its own.

    What Blender said comes back; a failure is one of the test unless ``check`` is False.
    """
    user = tmp_path_factory.mktemp("Blender für Jörg")
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("BLENDER_", "PYTHON"))}
    environment["BLENDER_USER_RESOURCES"] = str(user)

    def run(*words: object, check: bool = True, timeout: float = 100.0, **more: str):
        done = subprocess.run(
            [blender, *map(str, words)],
            capture_output=True,
            encoding="utf-8",
            env=environment | more,
            timeout=timeout,
        )
        assert not check or done.returncode == 0, f"{done.stdout}\n{done.stderr}"
        return done

    visible = shutil.copy(extension, user)
    run("--command", "extension", "install-file", "-r", "user_default", "--enable", visible)
    return run
