"""The house's own rules: what may import what, what ships, and that versions agree."""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = ("addon", "operators", "panels", "engines")
SHIPPED = [ROOT / "__init__.py", *(p for f in FOLDERS for p in sorted((ROOT / f).rglob("*.py")))]

FLOORS = ("panels", "operators", "addon", "engines")
"""Imports run down these, never up."""

ROOMS = ("glass", "scan", "light", "sun", "structure", "explore", "caustics")
MAY_USE = {
    "scan": {"glass"},
    "light": {"sun"},
    "caustics": {"glass", "light"},
    "explore": set(ROOMS),
}
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
            yield from ((*base, alias.name) for alias in node.names)


def said(path: Path, what: object) -> str:
    return f"{path.relative_to(ROOT).as_posix()}: {what}"


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


def test_the_package_is_imported_relatively():
    """As an extension its name is another one, and not ours to know."""
    own = {"heliform", "bl_ext", *FOLDERS}
    found = [said(p, n) for p in SHIPPED for n in absolute_imports(p) if n.split(".")[0] in own]
    assert not found


def test_imports_run_one_way():
    registration = (("__init__",), ("addon", "__init__"))  # knows everything
    files = [path for path in SHIPPED if module_of(path) not in registration]
    assert not [said(p, ".".join(t)) for p in files for t in own_imports(p) if not down(p, t)]


def down(path: Path, there: tuple[str, ...]) -> bool:
    """Whether a file may import that."""
    here = module_of(path)
    if there[0] not in FLOORS or FLOORS.index(there[0]) < FLOORS.index(here[0]):
        return False
    if here[0] == there[0] == "engines" and there[1] in ROOMS:
        return here[1] != "core" and there[1] in {here[1], *MAY_USE.get(here[1], ())}
    return True


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


def test_no_file_that_is_opened_can_run_code():
    assert not [said(path, danger) for path in SHIPPED for danger in dangers(path)]


def dangers(path: Path) -> Iterator[str]:
    """Imports and calls by which a file could bring code along."""
    unsafe = {"pickle", "shelve", "marshal", "dill", "joblib"}
    yield from (name for name in absolute_imports(path) if name.split(".")[0] in unsafe)
    for call in (node for node in ast.walk(tree_of(path)) if isinstance(node, ast.Call)):
        if isinstance(call.func, ast.Name) and call.func.id in ("eval", "exec"):
            yield f"line {call.lineno}"
        for keyword in call.keywords:
            value = keyword.value
            safe = isinstance(value, ast.Constant) and value.value is False
            if keyword.arg in ("allow_pickle", "shell") and not safe:
                yield f"line {call.lineno}"


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


def test_every_file_that_ships_is_in_the_wheel():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    settings = settings["tool"]["setuptools"]
    folders = {ROOT.joinpath(*name.split(".")[1:]): name for name in settings["packages"]}
    data = {
        path
        for folder, name in folders.items()
        for pattern in settings["package-data"].get(name, ())
        for path in folder.glob(pattern)
    }
    code = {path for folder in folders for path in folder.glob("*.py")}
    shipped = {p for f in (*FOLDERS, "studies") for p in (ROOT / f).rglob("*") if p.is_file()}
    shipped = {path for path in shipped if path.suffix != ".pyc"} | {ROOT / "__init__.py"}
    assert shipped | {ROOT / "blender_manifest.toml"} == code | data
