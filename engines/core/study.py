"""Study files: one job or experiment, said completely in TOML.

A study names an analysis and holds its parameters, the bodies, lamps and receivers, overrides for a
quick look, and cases that vary it. Reading checks every key and value; writing gives a folder that
runs elsewhere.
"""

import re
import shutil
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from .analysis import Analysis, find_analysis, find_form
from .colour import Display, scale_for
from .errors import FileError, ParameterError, SceneError
from .files import safe_name, written
from .meshes import load_mesh, load_textured, save_mesh
from .parameters import check_keys, from_table, to_table
from .scene import (
    Body,
    Lamp,
    Luminaire,
    Material,
    Mesh,
    Plane,
    Receiver,
    Scene,
    Surface,
    Vector,
    plane_receiver,
)

SCHEMA = 1
KEYS = (
    *("heliform", "title", "about", "analysis", "seed", "parameters", "display"),
    *("bodies", "lamps", "receivers", "quick", "cases", "refine"),
)
PLACE = ("at", "turn", "scale", "matrix")


@dataclass(frozen=True, slots=True)
class Case:
    """One run of a study: a name ("" where the study has no cases) and what is run.

    ``sums`` is a file of an earlier result that the run goes on from, or None.
    """

    name: str
    analysis: Analysis
    parameters: Any
    scene: Scene
    display: Display
    table: Mapping[str, Any]
    sums: Path | None = None


@dataclass(frozen=True, slots=True)
class Study:
    """A study file, read and checked."""

    name: str
    title: str
    about: str
    seed: int
    quick: bool
    cases: tuple[Case, ...]


def load_study(
    path: Path, *, quick: bool = False, seed: int | None = None, settings: Sequence[str] = ()
) -> Study:
    """The study in a TOML file, with the overrides of ``quick`` and ``settings`` merged in.

    ``settings`` are lines "section.key=value" in TOML's own notation; a value that is not TOML
    counts as text. Raises FileError for a missing or damaged file, ParameterError for an unknown
    key or a value out of bounds.
    """
    table = _read(path)
    _check_types(table, path)
    if quick:
        table = merged(table, table.get("quick", {}))
    for line in settings:
        table = merged(table, _setting(line))
    if seed is not None:
        table["seed"] = seed
    _check_types(table, path)
    schema = table.get("heliform", SCHEMA)
    if schema != SCHEMA:
        raise FileError(
            f"“{path.name}” has format {schema} and this Heliform reads {SCHEMA}; update Heliform."
        )
    number = table.get("seed", 0)
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < 2**31:
        raise ParameterError(
            f"[{path.name}] seed = {number!r} is out of bounds; allowed is 0 to 2147483647."
        )
    variants: dict[str, Any] = table.get("cases", {}) or {"": {}}
    return Study(
        name=path.stem,
        title=table.get("title", path.stem),
        about=table.get("about", ""),
        seed=number,
        quick=quick,
        cases=tuple(_case(name, table, v, path) for name, v in variants.items()),
    )


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise FileError(f"There is no study “{path}”; check its name and folder.") from None
    except OSError as failed:
        raise FileError(f"The study “{path}” cannot be read: {failed.strerror}.") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as wrong:
        raise FileError(f"The study “{path.name}” is not valid TOML: {wrong}.") from None


def _check_types(table: Mapping[str, Any], path: Path) -> None:
    """Raise ParameterError where a section is no table or a text no text."""
    check_keys(table, KEYS, path.name)
    for key in ("parameters", "display", "bodies", "lamps", "receivers", "quick", "cases"):
        if not isinstance(table.get(key, {}), Mapping):
            raise ParameterError(f"[{path.name}] {key} should be a table: [{key}].")
    for key in ("title", "about", "analysis", "refine"):
        _text(table, key, path.name)


def _text(table: Mapping[str, Any], key: str, where: str) -> str:
    """The text under ``key``, "" where there is none. Raises ParameterError for anything else."""
    value = table.get(key, "")
    if not isinstance(value, str):
        raise ParameterError(f"[{where}] {key} = {value!r} should be text.")
    return value


def _setting(line: str) -> dict[str, Any]:
    key, equals, value = line.partition("=")
    if not equals or not key.strip():
        raise ParameterError(f"“{line}” is no setting; write section.key=value.")
    try:
        return tomllib.loads(f"{key} = {value}")
    except tomllib.TOMLDecodeError:
        pass
    try:
        text = value.strip().replace("\\", "\\\\").replace('"', '\\"')
        return tomllib.loads(f'{key} = "{text}"')
    except tomllib.TOMLDecodeError:
        raise ParameterError(f"“{line}” is no setting; write section.key=value.") from None


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """``base`` with the values of ``over`` laid on top, table by table."""
    result = dict(base)
    for key, value in over.items():
        below = result.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            value = merged(below, value)
        result[key] = value
    return result


def _case(name: str, base: Mapping[str, Any], variant: Any, path: Path) -> Case:
    if not isinstance(variant, Mapping):
        raise ParameterError(f"[cases] {name} should be a table: [cases.{name}].")
    table = merged(base, variant)
    _check_types(table, path)
    if "analysis" not in table:
        raise ParameterError(
            f'[{path.name}] has no analysis; add for example analysis = "light.trace".'
        )
    analysis = find_analysis(table["analysis"], path.name)
    parameters = from_table(analysis.record, table.get("parameters", {}), "parameters")
    scene = Scene(
        bodies=tuple(_body(n, t, path) for n, t in _tables(table, "bodies")),
        luminaires=tuple(_luminaire(n, t, path) for n, t in _tables(table, "lamps")),
        receivers=tuple(_receiver(n, t, path, analysis) for n, t in _tables(table, "receivers")),
    )
    display = from_table(Display, table.get("display", {}), "display")
    scale_for(np.ones(1), display, "", "")
    return Case(
        name, analysis, parameters, scene, display, table, _sums(name, table, path, analysis)
    )


def _sums(name: str, table: Mapping[str, Any], path: Path, analysis: Analysis) -> Path | None:
    """What the result folder that the study refines has kept for this case."""
    if not table.get("refine"):
        return None
    if analysis.refine is None:
        raise ParameterError(f"[{path.name}] refine is not for {analysis.name}; remove it.")
    folder = path.parent / table["refine"]
    folder = folder / safe_name(name) if name else folder
    if not folder.is_dir():
        raise FileError(f"There is no result “{folder}” to go on from; check its name and folder.")
    if not (folder / analysis.sums).is_file():
        raise FileError(
            f"“{folder}” has no {analysis.sums} to go on from; trace anew with "
            "parameters.keep_sums = true."
        )
    return folder / analysis.sums


def _tables(table: Mapping[str, Any], section: str) -> list[tuple[str, Mapping[str, Any]]]:
    """The entries of a section that are switched on."""
    entries = table.get(section, {})
    for name, entry in entries.items():
        if not isinstance(entry, Mapping):
            raise ParameterError(f"[{section}] {name} should be a table: [{section}.{name}].")
        if not isinstance(entry.get("on", True), bool):
            raise ParameterError(
                f"[{section}.{name}] on = {entry['on']!r} should be true or false."
            )
    return [(name, entry) for name, entry in entries.items() if entry.get("on", True)]


def _body(name: str, table: Mapping[str, Any], path: Path) -> Body:
    where = f"bodies.{name}"
    keys = ("form", "preset", "shape", "mesh", "unit", "material", "on")
    check_keys(table, (*keys, *PLACE), where)
    if "form" in table:
        mesh = _formed(table, where)
    elif "mesh" in table:
        mesh = load_mesh(path.parent / _text(table, "mesh", where), table.get("unit", "m"))
    else:
        raise ParameterError(f"[{where}] has neither a form nor a mesh; add one of them.")
    material = from_table(Material, table.get("material", {}), f"{where}.material")
    return Body(name, mesh.moved(_place(table, where)), material)


def _formed(table: Mapping[str, Any], where: str) -> Mesh:
    """The mesh of a form, its shape laid over a preset where one is named."""
    form = find_form(table["form"], where)
    shape: Mapping[str, Any] = table.get("shape", {})
    preset = table.get("preset")
    if preset is not None:
        if preset not in form.presets:
            known = ", ".join(form.presets)
            raise ParameterError(
                f"[{where}] preset = {preset!r} is not a choice; take one of {known}."
            )
        shape = merged(to_table(form.presets[preset]), shape)
    return form.build(from_table(form.record, shape, f"{where}.shape"))


def _luminaire(name: str, table: Mapping[str, Any], path: Path) -> Luminaire:
    where = f"lamps.{name}"
    if "scale" in table:
        raise ParameterError(f"[{where}] has a scale, which a lamp cannot; set its size.")
    own = {k: v for k, v in table.items() if k not in (*PLACE, "on")}
    if _text(own, "file", where):
        own["file"] = str(path.parent / own["file"])
    return Luminaire(name, from_table(Lamp, own, where), _place(table, where))


def _receiver(
    name: str, table: Mapping[str, Any], path: Path, analysis: Analysis
) -> Receiver | Surface:
    where = f"receivers.{name}"
    own = {k: v for k, v in table.items() if k not in (*PLACE, "on")}
    if "mesh" not in table:
        return plane_receiver(name, from_table(Plane, own, where), _place(table, where))
    for key in ("width", "length"):
        if key in own:
            raise ParameterError(f"[{where}] has the size of its mesh; set scale, not {key}.")
    own = {k: v for k, v in own.items() if k not in ("mesh", "unit", "texels")}
    plane = from_table(Plane, own, where)
    loaded = load_textured(path.parent / _text(table, "mesh", where), table.get("unit", "m"))
    if not len(loaded.mesh.faces):
        raise SceneError(f"Receiver “{name}” has no faces; choose a mesh with some.")
    found = loaded.triangles().moved(_place(table, where))
    texture = found.texture
    if texture is None:
        texture = _unwrapped(name, found.mesh, plane.resolution, analysis)
    square = (plane.resolution, plane.resolution)
    columns, rows = (int(n) for n in _numbers(table, "texels", (2,), square, where))
    if min(columns, rows) < 1:
        raise ParameterError(f"[{where}] texels = {table['texels']!r} should be at least 1.")
    return Surface(name, found.mesh, texture, columns, rows, plane.sides, plane.reflectance)


def _unwrapped(name: str, mesh: Mesh, resolution: int, analysis: Analysis) -> Vector:
    if analysis.unwrap is None:
        raise SceneError(f"Receiver “{name}” has no UV map; save its mesh with one.")
    try:
        return analysis.unwrap(mesh, resolution)
    except SceneError as error:
        raise SceneError(f"Receiver “{name}”: {error}") from None


def _place(table: Mapping[str, Any], where: str) -> NDArray[np.float64]:
    """The 4×4 ``matrix``, or that of ``at`` (m), ``turn`` (degrees about X, Y, Z) and ``scale``."""
    matrix = _matrix(table, where)
    if abs(np.linalg.det(matrix[:3, :3])) < 1e-12:
        raise ParameterError(f"[{where}] has a scale of 0; make it another.")
    return matrix


def _matrix(table: Mapping[str, Any], where: str) -> NDArray[np.float64]:
    if "matrix" in table:
        return _numbers(table, "matrix", (4, 4), np.eye(4), where)
    at = _numbers(table, "at", (3,), np.zeros(3), where)
    turn = np.radians(_numbers(table, "turn", (3,), np.zeros(3), where))
    scale = _numbers(table, "scale", (3,), np.ones(3), where)
    (cx, cy, cz), (sx, sy, sz) = np.cos(turn), np.sin(turn)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    matrix = np.eye(4)
    matrix[:3, :3] = about_z @ about_y @ about_x * scale
    matrix[:3, 3] = at
    return matrix


def _numbers(
    table: Mapping[str, Any], key: str, shape: tuple[int, ...], default: Any, where: str
) -> NDArray[np.float64]:
    try:
        value = np.asarray(table.get(key, default), dtype=np.float64)
    except (TypeError, ValueError):
        value = np.empty(0)
    if value.shape != shape or not np.isfinite(value).all():
        size = " × ".join(map(str, shape))
        raise ParameterError(f"[{where}] {key} = {table[key]!r} should be {size} numbers.")
    return value


def save_study(
    folder: Path,
    title: str,
    scene: Scene,
    analysis: Analysis,
    parameters: Any,
    seed: int,
    display: Display | None = None,
) -> Path:
    """Write a scene as a study that runs elsewhere: study.toml, its meshes and its lamps' files.

    ``display`` is how its pictures are coloured, the default where None.

    Returns the study's path. Raises FileError where the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as failed:
        raise FileError(
            f"The folder “{folder}” cannot be made: {failed.strerror}; choose another."
        ) from None
    table: dict[str, Any] = {
        "heliform": SCHEMA,
        "title": title,
        "analysis": analysis.name,
        "seed": seed,
        "parameters": to_table(parameters),
        "display": to_table(display or Display()),
    }
    bodies = {b.name: _saved_body(b, folder, i) for i, b in enumerate(scene.bodies)}
    lamps = {
        lamp.name: _saved_lamp(lamp, folder, i, analysis) for i, lamp in enumerate(scene.luminaires)
    }
    receivers = {r.name: _saved_receiver(r, folder, i) for i, r in enumerate(scene.receivers)}
    for key, entries in (("bodies", bodies), ("lamps", lamps), ("receivers", receivers)):
        if entries:
            table[key] = entries
    path = folder / "study.toml"
    with written(path) as draft:
        draft.write_text(tomli_w.dumps(table), encoding="utf-8")
    return path


def _saved_body(body: Body, folder: Path, index: int) -> dict[str, Any]:
    file = f"{index}-{safe_name(body.name)}.npz"
    save_mesh(folder / file, body.mesh)
    return {"mesh": file, "material": to_table(body.material)}


def _saved_lamp(
    luminaire: Luminaire, folder: Path, index: int, analysis: Analysis
) -> dict[str, Any]:
    """The lamp's table; its file is copied, with those that it needs into a folder of its own."""
    table = to_table(luminaire.lamp)
    if luminaire.lamp.source == "ies" and luminaire.lamp.file:
        origin = Path(luminaire.lamp.file)
        stem = re.sub(r"\.ies$", "", origin.name, flags=re.I)
        name = f"{index}-{safe_name(stem)}"
        beside = analysis.lamp_files(origin)
        table["file"] = f"{name}/{name}.ies" if beside else f"{name}.ies"
        target = folder / table["file"]
        copies = [(origin, target), *((file, target.with_name(file.name)) for file in beside)]
        for source, copy in copies:
            try:
                copy.parent.mkdir(exist_ok=True)
                if source.resolve() != copy.resolve():
                    shutil.copyfile(source, copy)
            except OSError as failed:
                raise FileError(
                    f"Lamp “{luminaire.name}” needs “{source}”, which cannot be copied: "
                    f"{failed.strerror}; choose another file."
                ) from None
    return table | {"matrix": luminaire.pose.tolist()}


def _saved_receiver(receiver: Receiver | Surface, folder: Path, index: int) -> dict[str, Any]:
    resolution = max(receiver.columns, receiver.rows)
    kept = {"sides": receiver.sides, "reflectance": receiver.reflectance}
    if isinstance(receiver, Surface):
        file = f"receiver-{index}-{safe_name(receiver.name)}.npz"
        save_mesh(folder / file, receiver.mesh, receiver.texture)
        table = {"mesh": file, "resolution": resolution, **kept}
        if receiver.columns != receiver.rows:
            table["texels"] = [receiver.columns, receiver.rows]
        return table
    width, length = (float(np.linalg.norm(e)) for e in (receiver.u, receiver.v))
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack([receiver.u / width, receiver.v / length, receiver.normal])
    matrix[:3, 3] = receiver.origin + (receiver.u + receiver.v) / 2
    plane = Plane(width=width, length=length, resolution=resolution, **kept)
    return to_table(plane) | {"matrix": matrix.tolist()}
