"""The numbers of a text file, each with the line it stands in."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError

ANEW = "correct it or get the file anew"
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


class Row(NamedTuple):
    """Some numbers in a row, and the line of each."""

    values: NDArray[np.float64]
    lines: list[int]


@dataclass(slots=True)
class Numerals:
    """What is left to take of a file's numbers; ``last`` is the line that it ends in."""

    name: str
    values: NDArray[np.float64]
    lines: list[int]
    last: int

    def take(self, count: int, what: str) -> Row:
        """The next ``count`` numbers. Raises FileError when fewer are left."""
        if len(self.values) < count:
            raise FileError(
                f"“{self.name}” ends in line {self.last} after {len(self.values)} of {count} "
                f"{what}; it was cut short: get the file anew."
            )
        row = Row(self.values[:count], self.lines[:count])
        self.values, self.lines = self.values[count:], self.lines[count:]
        return row


def read_text(path: Path, what: str = "photometric file") -> str:
    """A file's text in UTF-8 or, failing that, Latin-1. Raises FileError."""
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise FileError(f"There is no {what} “{path}”; check its path.") from None
    except OSError as error:
        raise FileError(
            f"The {what} “{path}” cannot be read ({error.strerror}); choose a file that you may "
            "open."
        ) from None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.rstrip("\x1a\0 \t\r\n")


def lines_of(text: str) -> list[str]:
    """The lines of a text, whatever ends them."""
    return re.split(r"\r\n|\r|\n", text)


def numerals(name: str, lines: list[str], first: int) -> Numerals:
    """The numbers in ``lines``, the first of which is line ``first`` of the file ``name``.

    Raises FileError at a word that is no finite number.
    """
    values, places = [], []
    for place, line in enumerate(lines, first):
        for word in re.split(r"[\s,]+", line):
            if not word:
                continue
            if not _NUMBER.fullmatch(word) or np.isinf(float(word)):
                raise fault(name, place, f"has “{word[:40]}” where a number belongs", ANEW)
            values.append(float(word))
            places.append(place)
    last = first + max(len(lines), 1) - 1
    return Numerals(name, np.array(values, float), places, last)


def fault(name: str, line: int, what: str, remedy: str) -> FileError:
    """The error that says what a line of a file does, and what to do about it."""
    return FileError(f"Line {line} of “{name}” {what}; {remedy}.")


def check_count(name: str, line: int, what: str, count: float, least: int) -> int:
    """``count`` as a whole number. Raises FileError when it is none or below ``least``."""
    if count < least or count != int(count):
        raise fault(
            name, line, f"states {count:g} {what}, not a whole number from {least} on", ANEW
        )
    return int(count)


def check_ascending(name: str, what: str, row: Row, low: float, high: float) -> None:
    """Raises FileError where the angles in ``row`` fall or leave ``low``..``high``."""
    angles = row.values
    falls = np.flatnonzero(np.diff(angles) <= 0)
    if falls.size:
        k = falls[0]
        raise fault(
            name,
            row.lines[k + 1],
            f"has {what} angles that do not ascend ({angles[k]:g}° is followed by "
            f"{angles[k + 1]:g}°)",
            "put them in order or get the file anew",
        )
    if angles[0] < low or angles[-1] > high:
        raise fault(
            name,
            row.lines[0 if angles[0] < low else -1],
            f"has {what} angles from {angles[0]:g}° to {angles[-1]:g}°, which do not lie within "
            f"{low:g}° and {high:g}°",
            ANEW,
        )
