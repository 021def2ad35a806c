"""Photometric files, ANSI/IES LM-63-19 and its forerunners of 1986, 1991, 1995 and 2002, Type C."""

import re
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from .photometry import Angles, Opening, Photometry, luminous_flux

FOOT = 0.3048


def sample_path() -> Path:
    """The PAR20-like spot that comes with Heliform; its distribution is assumed, not measured."""
    return Path(__file__).parent / "data" / "par20.ies"


def read_ies(path: str | Path) -> Photometry:
    """The photometry in an IES LM-63 file, Type C [ANSI/IES LM-63-19].

    Editions 1986, 1991, 1995, 2002 and 2019, in UTF-8 or Latin-1. Candela values are multiplied
    with the file's multiplier and ballast factor, and in 1986 and 1991 with the ballast-lamp
    photometric factor, whose place later editions use for something else. Tilt factors in the file
    are passed over when they leave the upright lamp as it is.

    Raises FileError, naming the file and the remedy, when it is missing, not LM-63, cut short or
    contradicts itself, or when it uses what Heliform cannot: Types A and B, a tilt file, factors
    that change the upright lamp, or an upright opening.
    """
    path = Path(path)
    text = _read_text(path)
    label, tilt, numbers = _split(path, text)
    year = _edition(label)
    keywords = _keywords(label)
    head, rest = _take(path, _skip_tilt(path, tilt, numbers), 13)
    head = _Head(*head)
    _check_head(path, head)
    columns, rows = int(head.vertical), int(head.horizontal)
    expected = columns + rows + columns * rows
    if len(rest) != expected:
        raise FileError(
            f"“{path.name}” should hold {expected} values ({columns} vertical angles, {rows} "
            f"horizontal angles, {columns * rows} candela values) and has {len(rest)}; it was cut "
            "short or edited: get the file anew."
        )
    vertical, horizontal, candela = np.split(np.array(rest), [columns, columns + rows])
    _check_ascending(path, "vertical", vertical, 180.0)
    _check_ascending(path, "horizontal", horizontal, 360.0)
    factor = head.multiplier * head.ballast * (head.ballast_lamp if year < 1995 else 1.0)
    with np.errstate(all="ignore"):
        intensity = candela.reshape(rows, columns) * factor
    _check_intensity(path, vertical, horizontal, intensity)
    horizontal, intensity = _unfold(path, horizontal, intensity)
    opening, width, length = _opening(path, year, head.width, head.length, head.height)
    metre = FOOT if head.units == 1 else 1.0
    photometry = Photometry(
        vertical,
        horizontal,
        intensity,
        flux=head.lamps * head.lumens,
        opening=opening,
        width=width * metre,
        length=length * metre,
        height=abs(head.height) * metre,
        name=_name(path, label, year, keywords),
        keywords=keywords,
        watts=head.watts,
    )
    if head.lumens > 0:
        return photometry
    return replace(photometry, flux=luminous_flux(photometry))


class _Head(NamedTuple):
    """The thirteen numbers between TILT and the angles."""

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


def _read_text(path: Path) -> str:
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise FileError(f"There is no photometric file “{path}”; check its path.") from None
    except OSError as error:
        raise FileError(
            f"The photometric file “{path}” cannot be read ({error.strerror}); choose a file that "
            "you may open."
        ) from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.rstrip("\x1a\0 \t\r\n")


def _split(path: Path, text: str) -> tuple[list[str], str, list[float]]:
    """The label lines before TILT=, what TILT= says, and the numbers after it."""
    lines = re.split(r"\r\n|\r|\n", text)
    for place, line in enumerate(lines):
        tilt = re.match(r"\s*TILT\s*=\s*(.*?)\s*$", line, re.IGNORECASE)
        if tilt:
            numbers = _numbers(path, lines[place + 1 :], place + 2)
            return [label.strip() for label in lines[:place]], tilt[1], numbers
    raise FileError(
        f"“{path.name}” is not an IES LM-63 file: it has no line that begins with TILT=; "
        "choose a photometric file of that format."
    )


NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def _numbers(path: Path, lines: list[str], first: int) -> list[float]:
    numbers = []
    for place, line in enumerate(lines, first):
        for word in re.split(r"[\s,]+", line):
            if not word:
                continue
            if not NUMBER.fullmatch(word) or np.isinf(float(word)):
                raise FileError(
                    f"“{path.name}” has “{word[:40]}” in line {place} where a number belongs; "
                    "correct the line or get the file anew."
                )
            numbers.append(float(word))
    return numbers


def _take(path: Path, numbers: list[float], count: int) -> tuple[list[float], list[float]]:
    if len(numbers) < count:
        raise FileError(
            f"“{path.name}” ends after {len(numbers)} of {count} values that must follow TILT=; "
            "it was cut short: get the file anew."
        )
    return numbers[:count], numbers[count:]


def _skip_tilt(path: Path, tilt: str, numbers: list[float]) -> list[float]:
    """The numbers after the lamp's tilt factors, which must not change the upright lamp."""
    if tilt.upper() == "NONE":
        return numbers
    if tilt.upper() != "INCLUDE":
        raise FileError(
            f"“{path.name}” keeps its tilt factors in another file (TILT={tilt}), which Heliform "
            "does not read; write TILT=NONE if the lamp hangs upright."
        )
    (_, pairs), numbers = _take(path, numbers, 2)
    _check_count(path, "pairs of tilt angles and factors", pairs, 1)
    table, numbers = _take(path, numbers, 2 * int(pairs))
    angles, factors = np.split(np.array(table), 2)
    _check_ascending(path, "tilt", angles, 180.0)
    upright = float(np.interp(0.0, angles, factors))
    if abs(upright - 1) > 1e-6:
        raise FileError(
            f"“{path.name}” has a tilt factor of {upright:g} for the upright lamp, which Heliform "
            "does not apply; multiply it into the candela multiplier and write TILT=NONE."
        )
    return numbers


EDITION = re.compile(r"(?:ANSI/)?IES(?:NA)?[:\s]*(?:LM-63-)?(\d{4}|\d{2})\s*$", re.IGNORECASE)


def _edition(label: list[str]) -> int:
    """The year of the format; the first edition had no line that says so."""
    first = label[0] if label else ""
    header = EDITION.match(first)
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


def _check_head(path: Path, head: _Head) -> None:
    if head.kind in (2, 3):
        kind = "B" if head.kind == 2 else "A"
        raise FileError(
            f"“{path.name}” is of photometric type {kind} and Heliform reads Type C; "
            "ask the maker for the Type C file or convert it."
        )
    if head.kind != 1:
        raise FileError(
            f"“{path.name}” states photometric type {head.kind:g}, which does not exist; "
            "it should be 1 (Type C): get the file anew."
        )
    if head.units not in (1, 2):
        raise FileError(
            f"“{path.name}” states unit type {head.units:g}, which does not exist; "
            "it should be 1 (feet) or 2 (metres): correct it."
        )
    _check_count(path, "vertical angles", head.vertical, 2)
    _check_count(path, "horizontal angles", head.horizontal, 1)


def _check_count(path: Path, what: str, count: float, least: int) -> None:
    if count < least or count != int(count):
        raise FileError(
            f"“{path.name}” states {count:g} {what}; it must be a whole number from {least} on: "
            "correct it or get the file anew."
        )


def _check_ascending(path: Path, what: str, angles: Angles, high: float) -> None:
    falls = np.flatnonzero(np.diff(angles) <= 0)
    if falls.size:
        k = falls[0]
        raise FileError(
            f"“{path.name}” has {what} angles that do not ascend ({angles[k]:g}° is followed by "
            f"{angles[k + 1]:g}°); put them in order or get the file anew."
        )
    if angles[0] < 0 or angles[-1] > high:
        raise FileError(
            f"“{path.name}” has {what} angles from {angles[0]:g}° to {angles[-1]:g}°; they must "
            f"lie within 0° and {high:g}°: correct them or get the file anew."
        )


def _check_intensity(
    path: Path, vertical: Angles, horizontal: Angles, intensity: NDArray[np.float64]
) -> None:
    bad = np.argwhere(~((intensity >= 0) & (intensity < np.inf)))
    if bad.size:
        j, i = bad[0]
        raise FileError(
            f"“{path.name}” has {intensity[j, i]:g} cd at γ = {vertical[i]:g}°, "
            f"C = {horizontal[j]:g}°, which no lamp can send; correct the value or its multiplier."
        )


def _unfold(
    path: Path, planes: Angles, intensity: NDArray[np.float64]
) -> tuple[Angles, NDArray[np.float64]]:
    """The planes of a file, mirrored by its symmetry until they go once round from 0 to 360."""
    first, last = planes[0], planes[-1]
    if len(planes) == 1 and first == 0:
        return np.array([0.0, 360.0]), np.repeat(intensity, 2, axis=0)
    if (first, last) == (0, 90):
        planes, intensity = _mirror(planes, intensity, 90.0)
        last = 180.0
    if (first, last) == (0, 180):
        planes, intensity = _mirror(planes, intensity, 180.0)
        last = 360.0
    if (first, last) == (90, 270):
        planes, intensity = _mirror(planes, intensity, 270.0)
        if 360.0 not in planes:
            k = np.searchsorted(planes, 360.0)
            share = (360.0 - planes[k - 1]) / (planes[k] - planes[k - 1])
            between = (1 - share) * intensity[k - 1] + share * intensity[k]
            planes, intensity = np.insert(planes, k, 360.0), np.insert(intensity, k, between, 0)
        k = np.searchsorted(planes, 360.0)
        planes = np.concatenate([planes[k:-1] - 360.0, planes[: k + 1]])
        intensity = np.concatenate([intensity[k:-1], intensity[: k + 1]])
        first, last = 0.0, 360.0
    if first != 0 or last <= 180:
        raise FileError(
            f"“{path.name}” has horizontal angles from {first:g}° to {last:g}°; Type C goes from "
            "0° to 0°, 90°, 180° or 360°, or from 90° to 270°: get a complete file."
        )
    if last < 360:
        return np.append(planes, 360.0), np.concatenate([intensity, intensity[:1]])
    return planes, np.concatenate([intensity[:-1], intensity[:1]])


def _mirror(
    planes: Angles, intensity: NDArray[np.float64], at: float
) -> tuple[Angles, NDArray[np.float64]]:
    """The planes followed by their mirror images in the last of them, at ``at`` degrees."""
    return (
        np.concatenate([planes, 2 * at - planes[-2::-1]]),
        np.concatenate([intensity, intensity[-2::-1]]),
    )


def _opening(
    path: Path, year: int, width: float, length: float, height: float
) -> tuple[Opening, float, float]:
    """Shape, width and length of the opening as seen from below, in the file's unit.

    A negative size is that of a rounded shape. Up to 1995 a circle has no length (−d, 0, 0) and
    (−d, 0, −d) is a sphere; from 2002 on a circle is (−d, −d, 0), (−d, 0, −d) a disc that stands
    upright, and rounded sizes across a straight one are those of a lying cylinder.
    """
    if width == 0 and length == 0:
        return "point", 0.0, 0.0
    if year >= 2002 and height < 0 and width * length == 0 and min(width, length) < 0:
        raise FileError(
            f"“{path.name}” has an upright luminous opening ({width:g}, {length:g}, {height:g}) "
            "and Heliform knows level ones; write the width and length that are seen from below."
        )
    if height < 0 and width * length == 0 and max(width, length) > 0:
        return "rectangular", width or -height, length or -height
    if year >= 2002 and height < 0 and width * length < 0:
        return "rectangular", abs(width), abs(length)
    if width < 0 or length < 0:
        return "round", abs(width or length), abs(length or width)
    return "rectangular", width, length
