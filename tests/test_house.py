"""The house's own rules: what may import what, what ships, and that versions agree."""

import ast
import itertools
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("addon", "operators", "panels", "engines")
SHIPPED = [ROOT / "__init__.py", *(p for f in FOLDERS for p in sorted((ROOT / f).rglob("*.py")))]

FLOORS = ("panels", "operators", "addon", "engines")
"""Imports run down these, never up."""

ROOMS = ("glass", "scan", "light", "sun", "structure", "explore", "caustics")
MAY_USE = {"light": {"sun"}, "caustics": {"glass", "light"}, "explore": set(ROOMS)}
"""Which rooms a room may import; none where it is not named."""


def module_of(path: Path) -> tuple[str, ...]:
    """The module in a file as the names below the package: ``("engines", "core", "exr")``."""
    return path.relative_to(ROOT).with_suffix("").parts


def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def absolute_imports(path: Path) -> Iterator[str]:
    """The modules that a file imports by their full name."""
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
            yield node.module


def own_imports(path: Path) -> Iterator[tuple[str, ...]]:
    """What a file imports of the package: every module, and every name that may be one."""
    here = module_of(path)
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = here[: len(here) - node.level] + tuple((node.module or "").split("."))
            base = tuple(filter(None, base))
            yield from (base + (alias.name,) for alias in node.names)


def names(paths: list[Path]) -> list:
    return [pytest.param(path, id=path.relative_to(ROOT).as_posix()) for path in paths]


def test_engines_import_where_there_is_no_blender():
    modules = [".".join(("heliform", *module_of(p))) for p in SHIPPED if "engines" in p.parts]
    code = f"""
import importlib, sys
sys.modules.update(dict.fromkeys(("bpy", "mathutils", "gpu", "blf", "bmesh")))  # None blocks
for name in {[name.removesuffix(".__init__") for name in modules]}:
    importlib.import_module(name)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, encoding="utf-8")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("path", names(SHIPPED))
def test_the_package_is_imported_relatively(path):
    """As an extension its name is another one, and not ours to know."""
    tops = {name.partition(".")[0] for name in absolute_imports(path)}
    assert not tops & {"heliform", "bl_ext", *FOLDERS}


@pytest.mark.parametrize("path", names(SHIPPED))
def test_imports_run_one_way(path):
    here = module_of(path)
    if here in (("__init__",), ("addon", "__init__")):
        return  # registration knows everything
    for there in own_imports(path):
        assert there[0] in FLOORS or there == ("VERSION",), f"imports {there}"
        if there[0] in FLOORS:
            assert FLOORS.index(there[0]) >= FLOORS.index(here[0]), f"imports {there}"
        if here[0] == there[0] == "engines" and there[1] in (*ROOMS, "core"):
            allowed = {"core", here[1], *MAY_USE.get(here[1], ())}
            assert there[1] in allowed, f"imports {there}"


def test_rooms_use_one_another_in_no_circle():
    used = {room: MAY_USE.get(room, set()) - {room} for room in ROOMS}
    for room in ROOMS:
        reached, ahead = set(), list(used[room])
        while ahead:
            there = ahead.pop()
            if there not in reached:
                reached.add(there)
                ahead += used[there]
        assert room not in reached


@pytest.mark.parametrize("path", names(SHIPPED))
def test_no_file_that_is_opened_can_run_code(path):
    assert not set(absolute_imports(path)) & {"pickle", "shelve", "marshal", "dill", "joblib"}
    for call in (node for node in ast.walk(tree_of(path)) if isinstance(node, ast.Call)):
        if isinstance(call.func, ast.Name):
            assert call.func.id not in ("eval", "exec"), f"line {call.lineno}"
        for keyword in call.keywords:
            if keyword.arg == "allow_pickle":
                assert isinstance(keyword.value, ast.Constant), f"line {call.lineno}"
                assert keyword.value.value is False, f"line {call.lineno}"
            assert keyword.arg != "shell", f"line {call.lineno}"


def test_versions_agree():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
    engines = (ROOT / "engines" / "__init__.py").read_text(encoding="utf-8")
    version = project["version"]
    assert manifest["version"] == version
    assert f'VERSION = "{version}"' in engines
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## {re.escape(version)}\b", changelog, re.MULTILINE)


def test_mitsuba_is_the_one_that_is_asked_for():
    from heliform.engines.core.runtime import MITSUBA_VERSION

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"mitsuba=={MITSUBA_VERSION}" in project["dependencies"]


def test_every_folder_that_ships_is_in_the_wheel():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = set(settings["tool"]["setuptools"]["packages"])
    folders = {path.parent.relative_to(ROOT).parts for path in SHIPPED}
    assert listed == {".".join(("heliform", *parts)) for parts in folders}


def test_every_data_file_that_ships_is_in_the_wheel():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = settings["tool"]["setuptools"]["package-data"]
    found = itertools.chain.from_iterable(
        (ROOT / Path(*package.split(".")[1:])).glob(pattern)
        for package, pattern in ((k, p) for k, listed in patterns.items() for p in listed)
    )
    places = [ROOT / folder for folder in (*FOLDERS, "studies")]
    data = {
        path
        for place in places
        for path in place.rglob("*")
        if path.is_file() and path.suffix not in (".py", ".pyc")
    }
    assert data <= set(found)
