"""Build the extension's zip for each platform, with the wheels it needs inside, into dist.

    python tools/package.py [--platform linux-x64 …] [--out DIR]

Wheels are downloaded once into build/wheels. A zip whose contents would be the same is left alone.
"""

import argparse
import hashlib
import importlib.util
import json
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import tomli_w

ROOT = Path(__file__).resolve().parents[1]
SHIPPED = (
    "__init__.py",
    "addon",
    "operators",
    "panels",
    "engines",
    "studies",
    "LICENSE",
    "README.md",
)
BLENDERS_OWN = {"numpy"}
"""Never shipped: an extension's packages come before Blender's own, for every other add-on too."""


@dataclass(frozen=True, slots=True)
class Platform:
    """A platform as Blender names it, as wheels name it, and the Pythons of the Blenders on it."""

    name: str
    tags: tuple[str, ...]
    pythons: tuple[str, ...]
    tested: bool


GLIBCS = ("2_35", "2_34", "2_31", "2_28", "2_27", "2_24", "2_17")
PLATFORMS = (
    # blender.org's Blender 5.2 has Python 3.13, that of Linux distributions has their own
    Platform(
        "linux-x64",
        tuple(f"manylinux_{glibc}_x86_64" for glibc in GLIBCS),
        ("3.13", "3.14"),
        tested=True,
    ),
    Platform("windows-x64", ("win_amd64",), ("3.13",), tested=False),
    Platform("macos-arm64", ("macosx_14_0_arm64",), ("3.13",), tested=False),
)


class Failed(Exception):
    """What went wrong, in a sentence."""


def main() -> int:
    """Build what the command line asks for; returns the exit code."""
    known = {platform.name: platform for platform in PLATFORMS}
    parser = argparse.ArgumentParser(description="Build the extension's zip for each platform.")
    parser.add_argument(
        *("--platform", "-p"), action="append", choices=known, help="only this one; may be repeated"
    )
    parser.add_argument("--out", type=Path, default=ROOT / "dist", metavar="DIR")
    options = parser.parse_args()
    try:
        for name in options.platform or known:
            path = build(known[name], options.out)
            untested = "" if known[name].tested else "; untested: its makers have no such machine"
            print(f"{path} ({path.stat().st_size / 1e6:.0f} MB{untested})", flush=True)
    except Failed as failed:
        print(f"package: {failed}", file=sys.stderr)
        return 1
    return 0


def build(platform: Platform, out: Path) -> Path:
    """The extension's zip for a platform, built unless it is there as it would be."""
    wheels = wheels_for(platform)
    shipped = shipped_files()
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    manifest["platforms"] = [platform.name]
    manifest["wheels"] = sorted(f"./wheels/{wheel.name}" for wheel in wheels)
    path = out / f"{manifest['id']}-{manifest['version']}-{platform.name}.zip"
    key = ROOT / "build" / f"{path.name}.key"
    contents = _digest(tomli_w.dumps(manifest).encode(), *(_named(f) for f in shipped))
    if path.is_file() and key.is_file() and key.read_text() == f"{contents} {_stamp(path)}":
        return path
    stage = ROOT / "build" / "stage" / platform.name
    shutil.rmtree(stage, ignore_errors=True)
    for file in shipped:
        _copy(ROOT / file, stage / file)
    for wheel in wheels:
        _copy(wheel, stage / "wheels" / wheel.name)
    (stage / "blender_manifest.toml").write_text(tomli_w.dumps(manifest), encoding="utf-8")
    out.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    _blender_ext("build", "--source-dir", stage, "--output-filepath", path)
    _blender_ext("validate", path)
    shutil.rmtree(stage)
    key.write_text(f"{contents} {_stamp(path)}")
    return path


def shipped_files() -> list[Path]:
    """What of the checkout goes into the zip, relative to it: nothing that git ignores."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--"]
    listed = _run([*command, *SHIPPED], "The list of files could not be had from git").split("\0")
    return sorted(Path(name) for name in set(listed) if name and (ROOT / name).is_file())


# Wheels


def wheels_for(platform: Platform) -> list[Path]:
    """The wheels of everything that pyproject.toml depends on, but for what Blender brings."""
    wheels = {w.name: w for python in platform.pythons for w in _downloaded(platform, python)}
    return [wheels[name] for name in sorted(wheels)]


def _downloaded(platform: Platform, python: str) -> Iterable[Path]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    folder = ROOT / "build" / "wheels" / platform.name / python
    asked = folder / "asked.json"
    question = json.dumps([project["dependencies"], platform.tags, python])
    if not (asked.is_file() and asked.read_text(encoding="utf-8") == question):
        print(f"Downloading wheels for {platform.name}, Python {python}.", flush=True)
        shutil.rmtree(folder, ignore_errors=True)
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--only-binary=:all:"]
        command += ["--disable-pip-version-check", "--dest", str(folder)]
        command += ["--python-version", python]
        command += [word for tag in platform.tags for word in ("--platform", tag)]
        _run([*command, *project["dependencies"]], f"There are no wheels for {platform.name}")
        for wheel in folder.glob("*.whl"):
            if _project_of(wheel) in BLENDERS_OWN:
                wheel.unlink()
        asked.write_text(question, encoding="utf-8")
    return folder.glob("*.whl")


def _project_of(wheel: Path) -> str:
    return re.sub(r"[-_.]+", "-", wheel.name.partition("-")[0]).lower()


# Blender's own builder


def _blender_ext(command: str, *arguments: str | Path) -> None:
    """Blender's own program for extensions, which its Python package brings along."""
    spec = importlib.util.find_spec("bpy")
    if spec is None or spec.origin is None:
        raise Failed("Blender's extension builder comes with bpy; install it by “make setup”.")
    program = next(Path(spec.origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    words = [sys.executable, str(program), command, *map(str, arguments)]
    _run(words, f"Blender's extension program could not {command} the extension")


def _run(command: list[str], trouble: str) -> str:
    done = subprocess.run(command, cwd=ROOT, capture_output=True, encoding="utf-8", check=False)
    if done.returncode:
        raise Failed(f"{trouble}:\n{done.stdout}{done.stderr}".strip())
    return done.stdout


def _copy(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


def _named(file: Path) -> bytes:
    return file.as_posix().encode() + b"\0" + (ROOT / file).read_bytes()


def _digest(*parts: bytes) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()


def _stamp(path: Path) -> str:
    return f"{path.stat().st_size} {path.stat().st_mtime_ns}"


if __name__ == "__main__":
    sys.exit(main())
