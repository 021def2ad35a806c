"""Writing a scene as a study: a folder that runs elsewhere."""

import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from .analysis import Analysis
from .colour import Display
from .errors import FileError
from .files import safe_name, written
from .meshes import save_mesh
from .parameters import fields_of, to_table
from .scene import Body, Luminaire, Plane, Receiver, Scene, Surface
from .study import SCHEMA


def save_study(
    folder: Path,
    title: str,
    scene: Scene,
    analysis: Analysis,
    parameters: Any,
    seed: int,
    display: Display | None = None,
    carry: bool = True,
) -> Path:
    """Write a scene as a study that runs elsewhere: study.toml, its meshes and its lamps' files.

    ``display`` is how its pictures are coloured, the default where None. The files that
    ``parameters`` name are copied with it; unless ``carry``, they stay where they are, and the
    study runs on this machine alone.

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
        "parameters": _with_files(parameters, folder, carry),
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


def _with_files(record: Any, folder: Path, carry: bool, place: str = "") -> dict[str, Any]:
    """The record's table, with each file that it names where it is, by its whole path.

    To be carried, they are copied, each into a folder named like the field.
    """
    table = to_table(record)
    for field in fields_of(type(record)):
        value, here = getattr(record, field.name), f"{place}{field.name}/"
        if field.kind == "record":
            table[field.name] = _with_files(value, folder, carry, here)
        elif field.names_file and value:
            source = Path(value)
            if not carry:
                table[field.name] = str(source.absolute())
                continue
            table[field.name] = f"{here}{safe_name(source.stem)}{source.suffix}"
            _copy(source, folder / table[field.name], field.label)
    return table


def _copy(source: Path, target: Path, whose: str) -> None:
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.resolve() != target.resolve():
            shutil.copyfile(source, target)
    except OSError as failed:
        raise FileError(
            f"{whose} needs “{source}”, which cannot be copied: {failed.strerror}; choose another "
            "file."
        ) from None


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
            _copy(source, copy, f"Lamp “{luminaire.name}”")
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
