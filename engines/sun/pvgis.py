"""Typical years of the European Commission's PVGIS (CSV)."""

import re
from pathlib import Path

import numpy as np

from ..core.errors import FileError
from .humidity import dew_point
from .repair import Columns, completed
from .weather import Weather
from .weather_text import read_lines, rows_of, site_from
from .year_grid import Stamps, grid_of

_TITLES = {"T2m": "temperature", "RH": "relative humidity", "SP": "pressure"}
_STAMP = re.compile(r"(\d{4})(\d{2})(\d{2}):(\d{2})(\d{2})")


def read_pvgis(path: Path | str) -> Weather:
    """The weather of a PVGIS typical year as CSV [Huld et al., Solar Energy 86, 2012].

    Its stamps are UTC, and its radiation is of the moment that the header's “Irradiance Time
    Offset” puts after them. The file names no time zone: it is taken from the longitude, in whole
    hours.

    Raises FileError, naming the line, for what is no such file or cannot be repaired.
    """
    path = Path(path)
    lines = read_lines(path)
    start = next((k for k, line in enumerate(lines[:60]) if line.startswith("time(UTC)")), None)
    if start is None:
        raise FileError(f"“{path.name}” is not a PVGIS typical year: no line begins “time(UTC)”.")
    end = next((k for k in range(start, len(lines)) if not lines[k].strip()), len(lines))
    head = dict(line.split(":", 1) for line in lines[:start] if ":" in line)
    longitude = head.get("Longitude (decimal degrees)", "")
    offset = head.get("Irradiance Time Offset (h)", "0")
    try:
        east, late = float(longitude), float(offset)
    except ValueError:
        east = late = np.nan
    if not (abs(east) <= 180.0 and abs(late) <= 1.0):
        raise FileError(
            f"“{path.name}” has no longitude or time offset in its header; download it again."
        )
    zone = round(east / 15.0)
    latitude = head.get("Latitude (decimal degrees)", "")
    site = site_from([latitude, longitude, str(zone), head.get("Elevation (m)", "")], path.name, 1)
    rows = rows_of(lines[:end], start + 1, path.name, 6)
    titles = lines[start].split(",")

    def column(title: str) -> np.ndarray:
        if title not in titles:
            raise FileError(f"“{path.name}” line {start + 1} has no column “{title}”.")
        return rows.column(titles.index(title), _TITLES.get(title, title))

    found = [_STAMP.fullmatch(row[0].strip()) for row in rows.fields]
    if not all(found):
        at = found.index(None)
        raise FileError(
            f"“{path.name}” line {rows.lines[at]}: “{rows.fields[at][0]}” is no time as "
            "YYYYMMDD:HHMM; correct the line."
        )
    stamps = np.array([[int(part) for part in each.groups()] for each in found if each])
    years, months, days, hours, minutes = stamps.T
    temperature = column("T2m")
    return completed(
        path.name,
        site,
        grid_of(
            rows,
            Stamps(years, months, days, hours, np.zeros_like(hours), 1),
            ahead=zone,
        ),
        Columns(
            global_horizontal=column("G(h)"),
            direct_normal=column("Gb(n)"),
            diffuse_horizontal=column("Gd(h)"),
            temperature=temperature,
            dew_point=dew_point(temperature, column("RH") / 100.0),
            pressure=column("SP"),
        ),
        f"PVGIS ({path.name})",
        (f"The time zone is taken from the longitude: UTC{zone:+d} h.",),
        delay=late + float(minutes[0]) / 60.0 - 0.5,
    )
