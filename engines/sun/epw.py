"""EnergyPlus weather files (EPW)."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from .repair import Columns, completed
from .site import Site
from .weather import Weather
from .weather_text import Rows, read_lines, rows_of, site_from
from .year_grid import Stamps, grid_of

_RECORD = re.compile(r"\s*\d{1,4}\s*,\s*\d{1,2}\s*,\s*\d{1,2}\s*,\s*\d{1,2}\s*,")
_OFFSET = re.compile(r"Irradiance Time Offset \(h\):\s*(-?\d+(?:\.\d+)?)")
_NO_TEMPERATURE = (99.9, 99.99, 999.0, 999.9, 9999.0)
_FEWEST = 16  # columns, up to the diffuse radiation


def read_epw(path: Path | str) -> Weather:
    """The weather of an EPW file [EnergyPlus, Auxiliary Programs, “EnergyPlus Weather File”].

    An hour's record is of the hour before its stamp, so hour 1 is half past midnight; shorter
    records share the hour evenly. Values that the format marks as missing are repaired as
    `completed` says. Years of months from several years are dated in one.

    Raises FileError, naming the line, for what is no EPW or cannot be repaired.
    """
    path = Path(path)
    lines = read_lines(path)
    place, site = _location(lines, path.name)
    start = next((k for k, line in enumerate(lines) if _RECORD.match(line)), None)
    if start is None:
        raise FileError(f"“{path.name}” has a LOCATION but no records; download it again.")
    rows = rows_of(lines, start, path.name, _FEWEST)
    per_hour, span = _periods(lines[:start], path.name)
    stamps, notes = _stamps(rows, per_hour)
    columns = Columns(
        global_horizontal=rows.column(13, "global horizontal radiation", 9999.0),
        direct_normal=rows.column(14, "direct normal radiation", 9999.0),
        diffuse_horizontal=rows.column(15, "diffuse horizontal radiation", 9999.0),
        temperature=_known_temperature(rows, 6, "dry-bulb temperature"),
        dew_point=_known_temperature(rows, 7, "dew-point temperature"),
        pressure=_possible_pressure(rows),
    )
    late, note = _moments("\n".join(lines[:start]))
    return completed(
        path.name,
        site,
        grid_of(rows, stamps, span, ahead=0 if late is None else 1),
        columns,
        place,
        notes + note,
        delay=0.0 if late is None else late - 0.5 / stamps.per_hour,
    )


def _location(lines: Sequence[str], name: str) -> tuple[str, Site]:
    at = next((k for k, line in enumerate(lines[:20]) if line.strip()), 0)
    first = lines[at].strip()
    if not first.upper().lstrip('"').startswith("LOCATION"):
        raise FileError(
            f"“{name}” is not an EPW file: its first line should begin with LOCATION, not "
            f"“{first[:30]}”."
        )
    fields = [field.strip().strip('"') for field in first.split(",")]
    while fields and not fields[-1]:
        fields.pop()
    if len(fields) != 10:
        raise FileError(
            f"“{name}” line {at + 1}: LOCATION has {len(fields)} fields, not 10 (a comma within a "
            "name or number, or one missing); correct the line."
        )
    place = ", ".join(field for field in fields[1:4] if field not in ("", "-"))
    return f"{place or 'Unnamed place'} ({fields[4]}, {name})", site_from(fields[6:], name, at + 1)


def _periods(header: Sequence[str], name: str) -> tuple[int, tuple[int, int] | None]:
    """Records an hour (0 where unsaid), and the first and last day of the data period."""
    at = next((k for k, line in enumerate(header) if line.upper().startswith("DATA PERIODS")), None)
    if at is None:
        return 0, None
    fields = [field.strip() for field in header[at].split(",")]
    if len(fields) < 3 or not fields[2].isdigit() or not 1 <= int(fields[2]) <= 60:
        raise FileError(
            f"“{name}” line {at + 1}: DATA PERIODS does not say how many records an hour has; "
            "correct the line."
        )
    dates = [date for field in fields[3:] if (date := _date(field))]
    span = (dates[0], dates[-1]) if len(dates) >= 2 and dates[0] <= dates[-1] else None
    return int(fields[2]), span


def _date(field: str) -> int | None:
    """Month · 100 + day of “ 1/ 1” or “1/1/2019”, None for anything else."""
    found = re.fullmatch(r"(\d{1,2})\s*/\s*(\d{1,2})(\s*/\s*\d+)?", field)
    if not found or not (1 <= int(found[1]) <= 12 and 1 <= int(found[2]) <= 31):
        return None
    return int(found[1]) * 100 + int(found[2])


def _moments(header: str) -> tuple[float | None, tuple[str, ...]]:
    """How long after a record's stamp its sunlight is of, in h; None where it is a mean up to it.

    PVGIS writes moments, and names them in a comment by their distance from the hour after the
    stamp; with that, its direct and diffuse add up to its global radiation.
    """
    found = _OFFSET.search(header)
    if not found or not -1.0 <= float(found[1]) <= 0.0:
        return None, ()
    late = 1.0 + float(found[1])
    said = f"Radiation is of the moments {60 * late:.0f} min after the stamps, as a comment says."
    return late, (said,)


def _stamps(rows: Rows, per_hour: int) -> tuple[Stamps, tuple[str, ...]]:
    years = rows.whole(0, "year", 0, 9999)
    months = rows.whole(1, "month", 1, 12)
    days = rows.whole(2, "day", 1, 31)
    hours = rows.whole(3, "hour", 0, 24)
    minutes = rows.whole(4, "minute", 0, 60)
    notes = []
    if hours.min() == 0 and hours.max() == 24:
        at = int(np.argmin(hours))
        raise FileError(
            f"“{rows.name}” line {rows.lines[at]}: hour 0, where others run to 24; hours must run "
            "from 1 to 24."
        )
    if hours.min() == 0:
        notes.append("Hours run from 0 to 23; each is taken as the hour that it begins.")
    else:
        hours = hours - 1
    count, parts = _parts(rows, np.stack([months, days, hours]), minutes)
    if per_hour and count != per_hour:
        notes.append(f"The header says {per_hour} records an hour; there are {count}.")
    return Stamps(years, months, days, hours, parts, count), tuple(notes)


def _parts(
    rows: Rows, moments: NDArray[np.int64], minutes: NDArray[np.int64]
) -> tuple[int, NDArray[np.int64]]:
    """How many records an hour has, and which of them each is, by the order of the minutes."""
    distinct, parts = np.unique(minutes, return_inverse=True)
    several = 2 * len(rows.lines) > 3 * len(np.unique(moments, axis=1).T)
    if not several:
        return 1, np.zeros(len(minutes), np.int64)
    if 60 % len(distinct) or len(set(np.diff(distinct).tolist())) > 1:
        raise FileError(
            f"“{rows.name}” has records at {len(distinct)} different minutes of the hour, which do "
            "not share it evenly; take a file of even intervals."
        )
    return len(distinct), parts


def _known_temperature(rows: Rows, index: int, what: str) -> NDArray[np.float64]:
    """Temperature in °C, NaN where it is one of the numbers that stand for none."""
    values = rows.column(index, what)
    return np.where(np.isin(values, _NO_TEMPERATURE), np.nan, values)


def _possible_pressure(rows: Rows) -> NDArray[np.float64]:
    """Pressure in Pa, NaN outside the 31,000 to 120,000 that the format allows."""
    values = rows.column(9, "atmospheric pressure", 999999.0)
    return np.where((values >= 31000.0) & (values <= 120000.0), values, np.nan)
