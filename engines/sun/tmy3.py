"""Typical years of the American solar radiation data base, TMY3 (CSV)."""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..core.errors import FileError
from .repair import Columns, completed
from .weather import Weather
from .weather_text import Rows, read_lines, rows_of, site_from
from .year_grid import Stamps, grid_of

_DATE, _TIME = "Date (MM/DD/YYYY)", "Time (HH:MM)"


def read_tmy3(path: Path | str) -> Weather:
    """The weather of a TMY3 file [Wilcox and Marion, NREL/TP-581-43156, 2008].

    A record is of the time before its stamp; midnight is 24:00, or 00:00 of the next day as
    SolarAnywhere writes it. Missing values are repaired as `completed` says.

    Raises FileError, naming the line, for what is no TMY3 file or cannot be repaired.
    """
    path = Path(path)
    lines = read_lines(path)
    if len(lines) < 2 or not lines[1].lstrip('"').startswith(_DATE):
        raise FileError(
            f"“{path.name}” is not a TMY3 file: its second line should begin with “{_DATE}”."
        )
    head = next(csv.reader([lines[0]]))
    if len(head) < 7:
        raise FileError(
            f"“{path.name}” line 1 has {len(head)} fields, not 7: number, name, state, time zone, "
            "latitude, longitude and elevation; download the file again."
        )
    site = site_from([head[4], head[5], head[3], head[6]], path.name, 1)
    titles = [title.strip().strip('"') for title in lines[1].split(",")]
    if titles[:2] != [_DATE, _TIME]:
        raise FileError(f"“{path.name}” line 2: the second column should be “{_TIME}”.")
    rows = rows_of(lines, 2, path.name, len(titles) - 1)
    return completed(
        path.name,
        site,
        grid_of(rows, _stamps(rows)),
        Columns(
            global_horizontal=_named(rows, titles, "GHI (W/m"),
            direct_normal=_named(rows, titles, "DNI (W/m"),
            diffuse_horizontal=_named(rows, titles, "DHI (W/m"),
            temperature=_named(rows, titles, "Dry-bulb (C)"),
            dew_point=_named(rows, titles, "Dew-point (C)"),
            pressure=100.0 * _named(rows, titles, "Pressure (mbar)"),
        ),
        f"{head[1].strip()}, {head[2].strip()} (TMY3, {path.name})",
    )


def _named(rows: Rows, titles: Sequence[str], title: str) -> np.ndarray:
    at = next((k for k, known in enumerate(titles) if known.startswith(title)), None)
    if at is None:
        raise FileError(
            f"“{rows.name}” has no column “{title}…” on line 2; choose the full TMY3 file."
        )
    return rows.column(at, title)


def _stamps(rows: Rows) -> Stamps:
    """When each record begins; its stamp is when it ends."""
    ends = np.array([_end(rows, k) for k in range(len(rows.lines))])
    minutes = ends[:, 3] * 60 + ends[:, 4]
    per_hour = len(np.unique(ends[:, 4]))
    if 60 % per_hour:
        raise FileError(
            f"“{rows.name}” has records at {per_hour} different minutes of the hour, which do not "
            "share it evenly; take a file of even intervals."
        )
    length = 60 // per_hour
    begins = minutes - length
    before = begins < 0  # stamped 00:00: the last record of the day before
    days = ends[:, :3]
    if before.any():
        texts = [f"{y:04}-{m:02}-{d:02}" for y, m, d in ends[before, :3]]
        dates = np.array(texts, "datetime64[D]") - np.timedelta64(1, "D")
        days[before] = [[int(part) for part in str(date).split("-")] for date in dates]
        begins = begins % 1440
    return Stamps(
        years=days[:, 0],
        months=days[:, 1],
        days=days[:, 2],
        hours=begins // 60,
        parts=begins % 60 // length,
        per_hour=per_hour,
    )


def _end(rows: Rows, k: int) -> tuple[int, int, int, int, int]:
    """Year, month, day, hour and minute of record ``k``'s stamp."""
    texts = rows.fields[k][:2]
    try:
        month, day, year = (int(part) for part in texts[0].split("/"))
        hour, minute = (int(part) for part in texts[1].split(":"))
        if not (
            1 <= month <= 12
            and 1 <= day <= 31
            and 0 <= minute < 60
            and 0 <= hour * 60 + minute <= 1440
        ):
            raise ValueError
    except ValueError:
        raise FileError(
            f"“{rows.name}” line {rows.lines[k]}: “{texts[0]},{texts[1]}” is no date and time as "
            "MM/DD/YYYY,HH:MM; correct the line."
        ) from None
    return year, month, day, hour, minute
