"""The text of a weather file: its lines, and columns of numbers out of them."""

import codecs
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..core.errors import FileError, ParameterError
from ..core.parameters import from_table
from ..core.scene import Vector
from .site import Site

_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_CUTS = 5  # separators in a line of any weather file, at least
_MOST_BYTES = 200_000_000  # a year of minutes in 35 columns is half of it


def read_lines(path: Path | str) -> list[str]:
    """The lines of a text file in UTF-8, UTF-16 with its mark, Windows-1252 or Latin-1.

    Raises FileError when the file cannot be read, is empty, too large or not text.
    """
    path = Path(path)
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise FileError(f"“{path.name}” is too large for a year of weather; choose another.")
        content = path.read_bytes()
    except ValueError as error:
        shown = "".join(c if c.isprintable() else "�" for c in str(path))
        raise FileError(
            f"“{shown}” cannot be the path of a file; choose a weather file again."
        ) from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise FileError(
            f"Cannot read “{path.name}” in the folder “{path.parent}” ({reason}): choose a weather "
            "file that is there."
        ) from error
    if content.startswith(b"PK\x03\x04"):
        raise FileError(f"“{path.name}” is a ZIP archive; unpack it and choose the file inside.")
    text = _decoded(content)
    if "\0" in text:
        raise FileError(f"“{path.name}” is not a text file, so no weather can be read from it.")
    if not text.strip():
        raise FileError(f"“{path.name}” is empty; download it again.")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    _check_commas(path.name, lines)
    return lines


def _check_commas(name: str, lines: Sequence[str]) -> None:
    """Raise FileError where the first line with text, or the middle one, is not cut at commas."""
    filled = [k for k, line in enumerate(lines) if line.strip()]
    for at in (filled[0], filled[len(filled) // 2]):
        line = lines[at]
        for mark, called in ((";", "semicolons"), ("\t", "tabs")):
            if line.count(mark) >= max(_CUTS, line.count(",")):
                raise FileError(
                    f"“{name}” line {at + 1} is separated by {called}; save the file with commas "
                    "between its fields and points in its numbers."
                )


def _decoded(content: bytes) -> str:
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            return content.decode(encoding, errors="replace")
    for encoding in ("utf-8", "cp1252"):
        try:
            return content.decode(encoding)
        except UnicodeDecodeError:
            continue
    return content.decode("latin-1")


@dataclass(frozen=True, slots=True)
class Rows:
    """R rows of fields, all of as many columns; ``lines`` (R,) are their numbers in ``name``."""

    name: str
    fields: tuple[Sequence[str], ...]
    lines: tuple[int, ...]

    def column(self, index: int, what: str, missing: float = np.inf) -> Vector:
        """Column ``index`` as numbers (R,), NaN where it is blank, −9900 or less, or ≥ ``missing``.

        Raises FileError naming the line where it is not a number.
        """
        texts = [row[index].strip() for row in self.fields]
        try:
            values = np.array([float(text) if text else np.nan for text in texts])
        except ValueError:
            at = next(k for k, text in enumerate(texts) if text and not _is_number(text))
            raise FileError(
                f"“{self.name}” line {self.lines[at]}: {what} is “{texts[at][:40]}”, not a number; "
                "correct the line or download the file again."
            ) from None
        values[~((values > -9900.0) & (values < missing))] = np.nan
        return values

    def whole(self, index: int, what: str, low: int, high: int) -> np.ndarray:
        """Column ``index`` as whole numbers (R,) from ``low`` to ``high``.

        Raises FileError naming the line where it is anything else.
        """
        values = self.column(index, what)
        wrong = ~((values >= low) & (values <= high) & (values == np.round(values)))
        if wrong.any():
            at = int(np.argmax(wrong))
            raise FileError(
                f"“{self.name}” line {self.lines[at]}: {what} is “{self.fields[at][index]}”, not a "
                f"whole number from {low} to {high}; correct the line or download the file again."
            )
        return values.astype(np.int64)


def rows_of(lines: Sequence[str], start: int, name: str, fewest: int) -> Rows:
    """The rows from index ``start`` of ``lines`` to the last that is not blank, cut at commas.

    Raises FileError when there is none, when one has fewer than ``fewest`` columns or not as many
    as the first.
    """
    kept = [(k, line) for k, line in enumerate(lines[start:], start + 1) if line.strip(" \t,\x1a")]
    if not kept:
        raise FileError(f"“{name}” has a header but no records after it; download it again.")
    fields = tuple(line.split(",") for _, line in kept)
    count = len(fields[0])
    for (number, _), row in zip(kept, fields, strict=True):
        if len(row) < fewest:
            raise FileError(
                f"“{name}” line {number} has {len(row)} columns where at least {fewest} are "
                "needed; it is cut short or not separated by commas. Download the file again."
            )
        if len(row) != count:
            raise FileError(
                f"“{name}” line {number} has {len(row)} columns, but line {kept[0][0]} has {count}:"
                " a comma is missing or too many. Correct the line or download the file again."
            )
    return Rows(name, fields, tuple(number for number, _ in kept))


def site_from(texts: Sequence[str], name: str, line: int) -> Site:
    """The site of ``texts``: latitude, longitude, UTC offset and elevation, in this order.

    Raises FileError where one is not a number or out of bounds.
    """
    keys = ("latitude", "longitude", "utc_offset", "elevation")
    for key, text in zip(keys, texts, strict=True):
        if not _is_number(text):
            raise FileError(
                f"“{name}” line {line}: the site's {key.replace('_', ' ')} is "
                f"“{text.strip()[:40]}”, not a number; correct the line."
            )
    try:
        return from_table(Site, dict(zip(keys, map(float, texts), strict=True)), name)
    except ParameterError as error:
        raise FileError(f"Line {line} does not give a place on earth: {error}") from error


def counted(count: int | np.integer, what: str) -> str:
    """“1 value”, “3 values”."""
    return f"{count} {what}" if count == 1 else f"{count:,} {what}s"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
