"""Catalogues of sections as TOML: the shipped ones, and those a user writes.

Strict: an unknown key, a wrong value or a section that cannot be is told with its file, family and
row, and nothing is taken from the file.
"""

import itertools
import math
import textwrap
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from ..core.errors import FileError, ParameterError
from ..core.files import written
from .family import Family, by_area, nearest
from .grade import Grade, grade_of, grades, table_of
from .sections import (
    SHAPES,
    Sections,
    Shape,
    circular_hollow,
    i_section,
    joined_sections,
    rectangle,
    rectangular_hollow,
)

_BUILDERS = {
    "rhs": rectangular_hollow,
    "chs": circular_hollow,
    "i": i_section,
    "rectangle": rectangle,
}
_LENGTHS: dict[Shape, tuple[str, ...]] = {
    "rhs": ("height", "width", "thickness", "radius"),
    "chs": ("diameter", "thickness"),
    "i": ("height", "width", "web", "flange", "radius"),
    "rectangle": ("height", "width"),
}
_LEAST = {"radius": 0.0, "thickness": 0.1, "web": 0.1, "flange": 0.1}
_LEAST |= dict.fromkeys(("height", "width", "diameter"), 5.0)  # mm: more than a beam has in m
_LARGEST = 10_000_000  # bytes
_MOST = 50_000  # sections in a family
_MILLIMETRE = 1e-3
_MARGIN = "#           "

HEAD = """\
# Sections to choose from. Every [family.…] is offered under its name beside the shipped ones.
#
#   about   what it is, in your words; may be left out
#   grade   one of your own below, or a shipped one:
{grades}
#   shape   rhs, chs, i or rectangle
#   rows    the sections, all lengths in mm:
#             rhs        height, width, thickness; radius of the outer corners
#                        (0 is sharp; left out it is 1.5 times the thickness)
#             chs        diameter, thickness
#             i          height, width, web, flange (their thicknesses), radius at the root
#             rectangle  height, width
#           Any length may be a list: a row stands for every combination of its lists.
#           name may be given to a row of a single section. The height is measured across the
#           surface, and the order does not matter: sections are taken by area.
#
# A grade of your own is a [grade.…] with kind = "steel" or "timber"; youngs, shear and strengths in
# N/mm²; density in kg/m³; energy in MJ/kg and carbon in kg of CO₂ equivalent per kg; source and
# climate say where the figures are from. Steel has yield_strength; timber has bending, tension,
# compression, shear_strength (characteristic), youngs_low and shear_low (5 % fractiles) and may
# have glued = true, or has nothing but a yield_strength as Karamba3D gives it.

"""


def read_catalogue(path: Path | str) -> dict[str, Family]:
    """The families in a catalogue file, by name.

    Raises FileError naming file, family and row where something is missing, unknown or cannot be.
    """
    path = Path(path)
    try:
        if path.stat().st_size > _LARGEST:
            raise FileError(f"“{path.name}” is too large for a catalogue; split it up.")
        tables = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise FileError(
            f"The catalogue “{path}” cannot be read ({error.strerror or error}); choose another."
        ) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise FileError(f"“{path.name}” is no TOML ({error}); correct it there.") from error
    try:
        return _families(tables)
    except ParameterError as error:
        raise FileError(f"“{path.name}”: {error}") from error


def write_catalogue(path: Path | str, families: Mapping[str, Family]) -> None:
    """Write families with their grades as a catalogue, which `read_catalogue` reads back.

    The sections of a family are of one shape, as they are in every family of this room.
    Raises FileError where it cannot be written.
    """
    used = {family.grade.name: family.grade for family in families.values()}
    own = {name: table_of(grade) for name, grade in used.items() if grades().get(name) != grade}
    tables = {"grade": own} if own else {}
    tables["family"] = {name: _table(family) for name, family in families.items()}
    shipped = textwrap.fill(
        ", ".join(grades()), 98, initial_indent=_MARGIN, subsequent_indent=_MARGIN
    )
    text = HEAD.format(grades=shipped) + tomli_w.dumps(tables)
    with written(path) as draft:
        draft.write_text(text, encoding="utf-8")


def _families(tables: Mapping[str, Any]) -> dict[str, Family]:
    for key in tables:
        if key not in ("family", "grade"):
            raise ParameterError(
                f"“{key}” is not known here; families are [family.…] and grades [grade.…]."
            )
    for key in tables:
        if not isinstance(tables[key], Mapping):
            raise ParameterError(f"“{key}” should be tables, [{key}.…].")
    own = {name: grade_of(name, table) for name, table in tables.get("grade", {}).items()}
    families = tables.get("family", {})
    if not families:
        raise ParameterError("there is no [family.…] in it; add one.")
    return {name: _family(name, table, {**grades(), **own}) for name, table in families.items()}


def _family(name: str, table: Any, known: Mapping[str, Grade]) -> Family:
    said = f"family “{name}”"
    if not isinstance(table, Mapping):
        raise ParameterError(f"{said} should be a table, [family.{name}].")
    keys = ("about", "grade", "shape", "rows")
    for key in table:
        if key not in keys:
            raise ParameterError(f"{said} has an unknown key “{key}”; {nearest(key, keys)}")
    if not isinstance(table.get("about", ""), str):
        raise ParameterError(f"{said}: about should be text in quotes.")
    for key in keys[1:]:
        if key not in table:
            raise ParameterError(f"{said} has no “{key}”; add it.")
    grade, shape, rows = table["grade"], table["shape"], table["rows"]
    if not isinstance(grade, str) or grade not in known:
        raise ParameterError(f"{said} has an unknown grade “{grade}”; {nearest(str(grade), known)}")
    if shape not in SHAPES:
        raise ParameterError(
            f"{said} has an unknown shape “{shape}”; {nearest(str(shape), SHAPES)}"
        )
    if not isinstance(rows, list) or not rows:
        raise ParameterError(f"{said} has no rows; add rows = [ … ] with a section each.")
    parts, count = [], 0
    for number, row in enumerate(rows, 1):
        parts.append(_row(shape, row, f"{said}, row {number}"))
        count += len(parts[-1])
        if count > _MOST:
            raise ParameterError(f"{said} has more than {_MOST} sections; split it up.")
    sections = joined_sections(parts)
    names, counts = np.unique(sections.name, return_counts=True)
    if (counts > 1).any():
        twice = names[np.argmax(counts > 1)]
        raise ParameterError(
            f"{said} has “{twice}” more than once; take one out or name it otherwise."
        )
    return Family(name, known[grade], by_area(sections), table.get("about", ""))


def _row(shape: Shape, row: Any, said: str) -> Sections:
    """The sections of one row: every combination of its lengths."""
    lengths = _LENGTHS[shape]
    if not isinstance(row, Mapping):
        raise ParameterError(f"{said} should be a table, {{ {lengths[0]} = 200, … }}.")
    for key in row:
        if key not in (*lengths, "name"):
            raise ParameterError(
                f"{said} has an unknown key “{key}”; {nearest(key, (*lengths, 'name'))}"
            )
    needed = lengths[:3] if shape == "rhs" else lengths
    for key in needed:
        if key not in row:
            raise ParameterError(f"{said} has no “{key}”; add it.")
    given = [key for key in lengths if key in row]
    values = [_values(said, key, row[key]) for key in given]
    if math.prod(len(v) for v in values) > _MOST:
        raise ParameterError(f"{said} is more than {_MOST} sections; shorten its lists.")
    grid = np.array(list(itertools.product(*values))).T * _MILLIMETRE
    try:
        sections = _BUILDERS[shape](*grid)
    except ParameterError as error:
        raise ParameterError(f"{said}: {error}") from error
    name = row.get("name")
    if name is None:
        return sections
    if not isinstance(name, str) or not name.strip():
        raise ParameterError(f"{said}: name should be text in quotes.")
    if len(sections) > 1:
        raise ParameterError(
            f"{said} is {len(sections)} sections and cannot have one name; take it out."
        )
    return sections.named([name])


def _values(said: str, key: str, value: Any) -> list[float]:
    values = value if isinstance(value, list) else [value]
    least = _LEAST[key]
    for v in values:
        good = isinstance(v, int | float) and not isinstance(v, bool) and least <= v <= 1e5
        if not good:
            raise ParameterError(
                f"{said}: {key} = {v!r} should be a length in mm, from {least:g} to 100000; "
                "lengths in m are to be multiplied by 1000."
            )
    if not values:
        raise ParameterError(f"{said}: {key} is an empty list; put a length in.")
    return [float(v) for v in values]


def _table(family: Family) -> dict[str, Any]:
    shape = SHAPES[int(family.sections.shape[0])]
    about = {"about": family.about} if family.about else {}
    return {**about, "grade": family.grade.name, "shape": shape, "rows": _rows(family, shape)}


def _rows(family: Family, shape: Shape) -> list[dict[str, Any]]:
    sections = family.sections
    fields = {"diameter": "height", "thickness": "web"}
    rows = []
    for i, name in enumerate(sections.name):
        row: dict[str, Any] = {"name": str(name)}
        for key in _LENGTHS[shape]:
            value = getattr(sections, fields.get(key, key))[i] / _MILLIMETRE
            length = float(f"{value:.9g}")
            row[key] = int(length) if length.is_integer() else length
        rows.append(row)
    return rows
