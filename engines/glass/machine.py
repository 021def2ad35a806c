"""The machine profile: what a printer can do, each figure with its unit and where it is from."""

import hashlib
import json
import string
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, cast, get_args

from ..core.errors import FileError, ParameterError
from ..core.parameters import check_keys
from .figures import NO_LIMITS, Figure, figures_of, table_in, text_in

DATA = Path(__file__).parent / "data"
MachineName = Literal["glass-printer", "desktop-printer", "file"]
"""What a record's machine can be: a shipped profile, or a file of one's own."""

FILE = "file"
PROFILES = tuple(name for name in get_args(MachineName) if name != FILE)
"""The shipped profiles by name; the first one is taken where none is named."""

_LARGEST = 1_000_000  # bytes

PLACEHOLDERS = (
    *("name", "inputs", "x", "y", "z", "c", "purge_x", "purge_y", "feed", "clearance"),
    *("turns", "minutes", "grams"),
)
"""What lines of G-code may name in braces: the print's name and inputs, where the path starts (mm,
degrees), where the purge is, the speed there in mm/min, a height in mm clear of the piece, turns,
minutes and grams."""


@dataclass(frozen=True, slots=True)
class Dialect:
    """How a machine wants its G-code.

    ``feed`` "inverse-time" gives each move its duration (G93), as a bed that turns needs: what the
    linear axes do says little of the speed at the nozzle. Lines hold placeholders in braces.
    """

    comment: Literal[";", "()"]
    feed: Literal["mm/min", "inverse-time"]
    start: tuple[str, ...]
    purge: tuple[str, ...]
    end: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Machine:
    """A printer. ``axes`` "four" has a bed that turns so that the nozzle always lays to one side.

    ``extrusion`` "relative" counts E in mm of filament, "volumetric" in mm³, both move by move;
    "none" lets the melt run at one flow, so that speed sets the width.
    """

    name: str
    about: str
    axes: Literal["three", "four"]
    extrusion: Literal["relative", "volumetric", "none"]
    figures: Mapping[str, Figure]
    dialect: Dialect

    def value(self, name: str) -> float:
        """A figure in SI units."""
        return self.figures[name].si

    @property
    def limits(self) -> tuple[Figure, ...]:
        """The figures that a print is held against."""
        return tuple(f for f in self.figures.values() if f.name not in NO_LIMITS)

    @property
    def digest(self) -> str:
        """Sixteen hex digits that name what the profile says, but for names and sources."""
        figures = {f.name: float(f"{f.si:.9g}") for f in self.figures.values()}
        d = self.dialect
        said = [self.axes, self.extrusion, figures, d.comment, d.feed, d.start, d.purge, d.end]
        return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:16]


def chosen_machine(name: str, file: str = "") -> Machine:
    """The shipped machine of that ``name``, or for FILE the one in a TOML ``file``.

    Raises ParameterError where the file is not named, or named beside a shipped machine, and as
    `load_machine` does.
    """
    if name != FILE and file:
        raise ParameterError(
            f'machine_file is named but machine is {name}; set machine = "{FILE}", or leave '
            "machine_file empty."
        )
    if name != FILE:
        return load_machine(name)
    if not file:
        raise ParameterError(
            f"The machine is one of your own, but no profile is named; name its TOML file, or take "
            f"{' or '.join(PROFILES)}."
        )
    return load_machine(Path(file))


def load_machine(profile: Path | str | None = None) -> Machine:
    """The machine of a TOML file, or of a shipped profile by its name, the first for None or "".

    Raises FileError for a file that is missing, larger than a megabyte or no TOML, and
    ParameterError for an unknown, missing or impossible figure, unit or line.
    """
    name = str(profile or PROFILES[0])
    path = DATA / f"{name}.toml" if name in PROFILES else Path(name)
    try:
        with path.open("rb") as file:
            content = file.read(_LARGEST + 1)
    except FileNotFoundError:
        raise FileError(
            f"There is no machine profile “{path}”; choose a file, or one of {', '.join(PROFILES)}."
        ) from None
    except OSError as failed:
        raise FileError(
            f"The machine profile “{path}” cannot be read: {failed.strerror}."
        ) from None
    if len(content) > _LARGEST:
        raise FileError(
            f"“{path.name}” is larger than a megabyte and no machine profile; choose another file."
        )
    try:
        table = tomllib.loads(content.decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as wrong:
        raise FileError(f"The machine profile “{path.name}” is not valid TOML: {wrong}.") from None
    return machine_of(table, path.name)


def machine_of(table: Mapping[str, Any], where: str) -> Machine:
    """The machine that a table describes; ``where`` names it in messages. Raises ParameterError."""
    check_keys(table, ("name", "about", "axes", "extrusion", "figures", "gcode"), where)
    axes = _choice(table, "axes", ("three", "four"), where)
    extrusion = _choice(table, "extrusion", ("relative", "volumetric", "none"), where)
    figures = figures_of(table_in(table, "figures", where), axes, extrusion, where)
    return Machine(
        name=text_in(table, "name", where, required=True),
        about=text_in(table, "about", where),
        axes=cast(Any, axes),
        extrusion=cast(Any, extrusion),
        figures=figures,
        dialect=_dialect(table_in(table, "gcode", where), f"{where} gcode"),
    )


def filled(lines: tuple[str, ...], values: Mapping[str, str]) -> list[str]:
    """Lines of G-code with the text of each placeholder in its place."""
    return [
        "".join(text + (values[name] if name else "") for text, name in _pieces(line))
        for line in lines
    ]


def _pieces(line: str) -> list[tuple[str, str]]:
    """Stretches of text, each with the placeholder after it or "". Raises ValueError."""
    found = []
    for text, name, form, conversion in string.Formatter().parse(line):
        if name is not None and (name not in PLACEHOLDERS or form or conversion):
            raise ValueError(f"{{{name}}}")
        found.append((text, name or ""))
    return found


def _dialect(table: Mapping[str, Any], where: str) -> Dialect:
    check_keys(table, ("comment", "feed", "start", "purge", "end"), where)
    return Dialect(
        comment=cast(Any, _choice(table, "comment", (";", "()"), where)),
        feed=cast(Any, _choice(table, "feed", ("mm/min", "inverse-time"), where)),
        start=_lines(table, "start", where),
        purge=_lines(table, "purge", where),
        end=_lines(table, "end", where),
    )


def _lines(table: Mapping[str, Any], key: str, where: str) -> tuple[str, ...]:
    lines = table.get(key, [])
    if not isinstance(lines, list) or not all(isinstance(line, str) for line in lines):
        raise ParameterError(f"[{where}] {key} should be a list of lines of text.")
    for line in lines:
        if not line.isprintable():
            raise ParameterError(f"[{where}] {key}: “{line[:40]!r}” should be one line of text.")
        try:
            _pieces(line)
        except ValueError:
            known = ", ".join(f"{{{p}}}" for p in PLACEHOLDERS)
            raise ParameterError(
                f"[{where}] {key}: “{line}” names what there is not; known are {known}."
            ) from None
    return tuple(lines)


def _choice(table: Mapping[str, Any], key: str, choices: tuple[str, ...], where: str) -> str:
    value = table.get(key)
    if value not in choices:
        raise ParameterError(
            f"[{where}] {key} = {value!r} is not a choice; take one of {', '.join(choices)}."
        )
    return value
