"""What a study's tables say is there: bodies, lamps and receivers, read and checked."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .analysis import Analysis, find_form
from .errors import ParameterError, SceneError
from .material_presets import material_of
from .meshes import load_mesh, load_textured
from .parameters import check_keys, fields_of, from_table, merged, to_table
from .scene import (
    Body,
    Lamp,
    Luminaire,
    Mesh,
    Plane,
    Receiver,
    Scene,
    Surface,
    Vector,
    plane_receiver,
)

PLACE = ("at", "turn", "scale", "matrix")


def scene_of(table: Mapping[str, Any], folder: Path, analysis: Analysis) -> Scene:
    """The scene of a study's ``table``, its files looked for in ``folder``.

    Raises ParameterError for an unknown key or a value out of bounds, FileError and SceneError for
    a mesh that cannot be read or used.
    """
    return Scene(
        bodies=tuple(_body(n, t, folder) for n, t in _tables(table, "bodies")),
        luminaires=tuple(_luminaire(n, t, folder) for n, t in _tables(table, "lamps")),
        receivers=tuple(_receiver(n, t, folder, analysis) for n, t in _tables(table, "receivers")),
    )


def text_of(table: Mapping[str, Any], key: str, where: str) -> str:
    """The text under ``key``, "" where there is none. Raises ParameterError for anything else."""
    value = table.get(key, "")
    if not isinstance(value, str):
        raise ParameterError(f"[{where}] {key} = {value!r} should be text.")
    return value


def found_files(record: type, table: Any, folder: Path) -> Any:
    """``table`` with the files that a record of this type names looked for in ``folder``.

    They are its texts called ``file``, or something_file; empty ones stay so.
    """
    if not isinstance(table, Mapping):
        return table
    found = dict(table)
    for field in fields_of(record):
        value = table.get(field.name)
        if field.kind == "record" and value is not None:
            found[field.name] = found_files(field.record, value, folder)
        elif field.names_file and isinstance(value, str) and value:
            found[field.name] = str(folder / value)
    return found


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


def _body(name: str, table: Mapping[str, Any], folder: Path) -> Body:
    where = f"bodies.{name}"
    keys = ("form", "preset", "shape", "mesh", "unit", "material", "on")
    check_keys(table, (*keys, *PLACE), where)
    if "form" in table:
        mesh = _formed(table, where, folder)
    elif "mesh" in table:
        mesh = load_mesh(folder / text_of(table, "mesh", where), table.get("unit", "m"))
    else:
        raise ParameterError(f"[{where}] has neither a form nor a mesh; add one of them.")
    material = material_of(table.get("material", {}), f"{where}.material")
    return Body(name, mesh.moved(_place(table, where)), material)


def _formed(table: Mapping[str, Any], where: str, folder: Path) -> Mesh:
    """The mesh of a form, its shape laid over a preset where one is named."""
    form = find_form(table["form"], where)
    shape: Mapping[str, Any] = found_files(form.record, table.get("shape", {}), folder)
    preset = table.get("preset")
    if preset is not None:
        if preset not in form.presets:
            known = ", ".join(form.presets)
            raise ParameterError(
                f"[{where}] preset = {preset!r} is not a choice; take one of {known}."
            )
        shape = merged(to_table(form.presets[preset]), shape)
    return form.build(from_table(form.record, shape, f"{where}.shape"))


def _luminaire(name: str, table: Mapping[str, Any], folder: Path) -> Luminaire:
    where = f"lamps.{name}"
    if "scale" in table:
        raise ParameterError(f"[{where}] has a scale, which a lamp cannot; set its size.")
    own = {k: v for k, v in table.items() if k not in (*PLACE, "on")}
    if text_of(own, "file", where):
        own["file"] = str(folder / own["file"])
    return Luminaire(name, from_table(Lamp, own, where), _place(table, where))


def _receiver(
    name: str, table: Mapping[str, Any], folder: Path, analysis: Analysis
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
    loaded = load_textured(folder / text_of(table, "mesh", where), table.get("unit", "m"))
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
