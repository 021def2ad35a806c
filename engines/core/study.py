"""Study files: one job or experiment, said completely in TOML.

A study names an analysis and holds its parameters, the bodies, lamps and receivers, overrides for a
quick look, and cases that vary it. Reading checks every key and value.
"""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .analysis import Analysis, find_analysis
from .colour import Display, scale_for
from .contents import found_files, scene_of, text_of
from .errors import FileError, ParameterError
from .files import safe_name
from .parameters import check_keys, from_table, merged
from .scene import Scene

SCHEMA = 1
KEYS = (
    *("heliform", "title", "about", "analysis", "seed", "parameters", "display"),
    *("bodies", "lamps", "receivers", "quick", "cases", "refine"),
)


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
        text_of(table, key, path.name)


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
    given = found_files(analysis.record, table.get("parameters", {}), path.parent)
    parameters = from_table(analysis.record, given, "parameters")
    scene = scene_of(table, path.parent, analysis)
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
