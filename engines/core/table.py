"""Tables of numbers as CSV, with what is known of them in comments above."""

import csv
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import FileError
from .files import written


def save_csv(
    path: Path | str, columns: Mapping[str, NDArray[Any]], meta: Mapping[str, Any]
) -> None:
    """Write ``columns``, 1-D arrays of one length; the unit stands in the name, "Illuminance (lx)".

    A line “# key: value” for each entry of ``meta`` comes first, then the names, then the rows.
    Floats keep 7 digits; whole numbers and text stay as they are. UTF-8.

    Raises FileError where the file cannot be written.
    """
    cells = [_cells(np.asarray(values)) for values in columns.values()]
    with written(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        file.writelines(f"# {key}: {_said(value)}\n" for key, value in meta.items())
        table = csv.writer(file, lineterminator="\n")
        table.writerow(columns)
        table.writerows(zip(*cells, strict=True))


def load_csv(path: Path | str) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
    """The columns by name, float64 or, where not all cells are numbers, text; and meta.

    Raises FileError where the file is missing or damaged.
    """
    path = Path(path)
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            lines = file.readlines()
    except FileNotFoundError as error:
        raise FileError(
            f"There is no table “{path.name}” in the folder “{path.parent}”."
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"“{path}” cannot be read as a table; save it as CSV in UTF-8.") from error

    comments = next((i for i, line in enumerate(lines) if not line.startswith("#")), len(lines))
    pairs = (line[1:].strip().partition(": ") for line in lines[:comments])
    meta = {key: _heard(value) for key, _, value in pairs}
    names, *rows = list(csv.reader(lines[comments:])) or [[]]
    if not names:
        raise FileError(f"“{path}” has no row of column names; make it again.")
    for number, row in enumerate(rows, start=comments + 2):
        if len(row) != len(names):
            raise FileError(
                f"Row {number} of “{path}” has {len(row)} cells under {len(names)} names; "
                "make the table again or mend that row."
            )
    columns = zip(*rows, strict=True) if rows else [()] * len(names)
    return {name: _array(cells) for name, cells in zip(names, columns, strict=True)}, meta


def _cells(values: NDArray[Any]) -> list[Any]:
    cells = values.tolist()
    return [f"{v:.7g}" for v in cells] if values.dtype.kind == "f" else cells


def _array(cells: tuple[str, ...]) -> NDArray[Any]:
    try:
        return np.array(cells, dtype=np.float64)
    except ValueError:
        return np.array(cells)


def _said(value: Any) -> str:
    """Text as it stands where it reads back as itself, anything else as JSON."""
    if isinstance(value, str) and value.strip() == value != "" and value.isprintable():
        return value if _heard(value) == value else json.dumps(value, ensure_ascii=False)
    return json.dumps(value, ensure_ascii=False)


def _heard(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text
