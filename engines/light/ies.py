"""Photometric files, ANSI/IES LM-63-19 and its forerunners of 1986, 1991, 1995 and 2002."""

import re
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from . import goniometry
from .numerals import ANEW, Numerals, Row, check_count, fault, lines_of, numerals, read_text
from .opening import level_opening
from .photometry import Photometry, luminous_flux
from .tilt import read_tilt, tilt_file

FOOT = 0.3048
BRIGHTEST = 1e30
"""Luminous intensity in cd that nothing reaches; the sun has 3e27."""
_TYPES = {1: "C", 2: "B", 3: "A"}


def sample_path() -> Path:
    """The PAR20-like spot that comes with Heliform; its distribution is assumed, not measured."""
    return Path(__file__).parent / "data" / "par20.ies"


def read_ies(path: str | Path) -> Photometry:
    """The photometry in an IES LM-63 file of Type A, B or C [ANSI/IES LM-63-19].

    Editions 1986, 1991, 1995, 2002 and 2019, in UTF-8 or Latin-1. Candela values are multiplied
    with the file's multiplier and ballast factor, and in 1986 and 1991 with the ballast-lamp
    photometric factor, whose place later editions use for something else. Types A and B become
    Type C (see `goniometry`). The factors on a tilted lamp are in ``tilt`` and not applied; a
    tilt file lies beside the photometric one. ``notes`` tell what the file says otherwise.

    Raises FileError, naming the file, the line and the remedy, when it is missing, not LM-63, cut
    short or contradicts itself.
    """
    path = Path(path)
    label, (line, named), numbers = _split(path.name, read_text(path))
    year, keywords = _edition(label), _keywords(label)
    tilt = read_tilt(path, line, named, numbers)
    head, lines = _head(path.name, year, numbers)
    table = _table(path.name, year, head, lines, numbers)
    opening = level_opening(year, head.width, head.length, head.height)
    metre = FOOT if head.units == 1 else 1.0
    photometry = Photometry(
        *table,
        flux=head.lamps * head.lumens,
        opening=opening.shape,
        width=opening.width * metre,
        length=opening.length * metre,
        height=abs(head.height) * metre,
        name=_name(path, label, year, keywords),
        keywords=keywords,
        watts=head.watts,
        tilt=tilt,
        notes=tuple(_notes(path.name, head, opening.solid)),
    )
    if head.lumens > 0:
        return photometry
    return replace(photometry, flux=luminous_flux(photometry))


def files_beside(path: str | Path) -> list[Path]:
    """The files that a photometric file takes numbers from: that of its tilt, if it has one.

    Raises FileError where it or they cannot be read.
    """
    path = Path(path)
    _, (line, named), _ = _split(path.name, read_text(path))
    found = tilt_file(path, line, named)
    return [found] if found else []


class _Head(NamedTuple):
    """The thirteen numbers between TILT and the angles, or the lines that they stand in."""

    lamps: float
    lumens: float
    multiplier: float
    vertical: float
    horizontal: float
    kind: float
    units: float
    width: float
    length: float
    height: float
    ballast: float
    ballast_lamp: float
    watts: float


def _split(name: str, text: str) -> tuple[list[str], tuple[int, str], Numerals]:
    """The label lines before TILT=, its line and what it says, and the numbers after it."""
    lines = lines_of(text)
    for place, line in enumerate(lines, 1):
        tilt = re.match(r"\s*TILT\s*=\s*(.*?)\s*$", line, re.IGNORECASE)
        if tilt:
            label = [text.strip() for text in lines[: place - 1]]
            return label, (place, tilt[1]), numerals(name, lines[place:], place + 1)
    raise FileError(
        f"“{name}” is not an IES LM-63 file: it has no line that begins with TILT=; "
        "choose a photometric file of that format."
    )


_EDITION = re.compile(r"(?:ANSI/)?IES(?:NA)?[:\s]*(?:LM-63-)?(\d{4}|\d{2})\s*$", re.IGNORECASE)


def _edition(label: list[str]) -> int:
    """The year of the format; the first edition had no line that says so."""
    first = label[0] if label else ""
    header = _EDITION.match(first)
    if not header:
        return 1986
    year = int(header[1])
    return year if year > 99 else year + (1900 if year > 50 else 2000)


def _keywords(label: list[str]) -> dict[str, str]:
    found: dict[str, list[str]] = {}
    last = ""
    for line in label:
        keyword = re.match(r"\[\s*([^\]]+?)\s*\]\s*(.*)", line)
        if not keyword:
            continue
        name = keyword[1].upper()
        last = last if name == "MORE" and last else name
        found.setdefault(last, []).append(keyword[2])
    return {name: "\n".join(lines) for name, lines in found.items()}


def _name(path: Path, label: list[str], year: int, keywords: dict[str, str]) -> str:
    for keyword in ("LUMINAIRE", "LUMCAT", "LAMP"):
        if keywords.get(keyword):
            return keywords[keyword].replace("\n", " ")
    free = [line for line in label if line and not line.startswith("[")] if year == 1986 else []
    return free[0] if free else path.stem


def _head(name: str, year: int, numbers: Numerals) -> tuple[_Head, _Head]:
    """What stands between TILT and the angles, checked, and the line of each number."""
    row = numbers.take(13, "values that must follow TILT=")
    head, lines = _Head(*row.values.tolist()), _Head(*row.lines)
    if head.kind not in _TYPES:
        what = f"states photometric type {head.kind:g}, which does not exist"
        remedy = "it should be 1 (Type C), 2 (Type B) or 3 (Type A): get the file anew"
        raise fault(name, int(lines.kind), what, remedy)
    if head.units not in (1, 2):
        what = f"states unit type {head.units:g}, which does not exist"
        remedy = "it should be 1 (feet) or 2 (metres): correct it"
        raise fault(name, int(lines.units), what, remedy)
    check_count(name, int(lines.lamps), "lamps", head.lamps, 1)
    check_count(name, int(lines.vertical), "vertical angles", head.vertical, 2)
    check_count(name, int(lines.horizontal), "horizontal angles", head.horizontal, 1)
    factors = [
        ("a multiplier", head.multiplier, lines.multiplier),
        ("a ballast factor", head.ballast, lines.ballast),
        ("a ballast-lamp factor", head.ballast_lamp if year < 1995 else 1.0, lines.ballast_lamp),
    ]
    for what, factor, line in factors:
        if factor <= 0:
            what = f"states {what} of {factor:g}, with which there is no light"
            raise fault(name, int(line), what, "write 1 if it changes nothing, or correct it")
    return head, lines


def _table(name: str, year: int, head: _Head, lines: _Head, numbers: Numerals) -> goniometry.Table:
    """The intensity in cd at the angles that follow, as Type C."""
    columns, rows = int(head.vertical), int(head.horizontal)
    expected = columns + rows + columns * rows
    if len(numbers.values) != expected:
        raise fault(
            name,
            int(lines.vertical),
            f"asks for {expected} values ({columns} vertical angles, {rows} horizontal angles, "
            f"{columns * rows} candela values) and {len(numbers.values)} follow line "
            f"{int(lines.watts)}",
            "the file was cut short or edited: get it anew",
        )
    vertical = numbers.take(columns, "vertical angles")
    horizontal = numbers.take(rows, "horizontal angles")
    candela = numbers.take(columns * rows, "candela values")
    factor = head.multiplier * head.ballast * (head.ballast_lamp if year < 1995 else 1.0)
    with np.errstate(all="ignore"):
        intensity = (candela.values * factor).reshape(rows, columns)
    _check_intensity(name, vertical, horizontal, candela, intensity)
    kind = _TYPES[int(head.kind)]
    convert = {"A": goniometry.from_type_a, "B": goniometry.from_type_b}
    return convert.get(kind, goniometry.from_type_c)(name, vertical, horizontal, intensity)


def _check_intensity(
    name: str, vertical: Row, horizontal: Row, candela: Row, intensity: NDArray[np.float64]
) -> None:
    bad = np.argwhere(~((intensity >= 0) & (intensity < BRIGHTEST)))
    if bad.size:
        j, i = bad[0]
        raise fault(
            name,
            candela.lines[j * len(vertical.values) + i],
            f"has {intensity[j, i]:g} cd at the vertical angle {vertical.values[i]:g}°, horizontal "
            f"{horizontal.values[j]:g}°, which no lamp can send",
            ANEW,
        )


def _notes(name: str, head: _Head, solid: str) -> list[str]:
    """What is taken otherwise than the file says it."""
    notes = []
    if head.kind == 2:
        notes.append(f"“{name}” is of photometric Type B and was resampled as Type C.")
    if head.kind == 3:
        notes.append(
            f"“{name}” is of photometric Type A: its beam leaves along the lamp's own +X, as that "
            "of a headlight, not along −Z."
        )
    if solid:
        notes.append(
            f"“{name}” has a luminous opening that is {solid}; light leaves from its outline seen "
            "from below, at one height."
        )
    if head.lumens <= 0 and head.lumens != -1:
        notes.append(
            f"“{name}” states {head.lumens:g} lm a lamp; it was read as −1, absolute photometry."
        )
    return notes
