"""Files of the American solar radiation data base's viewer and service (PSM, CSV)."""

from pathlib import Path

import numpy as np

from ..core.errors import FileError
from .repair import Columns, completed
from .weather import Weather
from .weather_text import read_lines, rows_of, site_from
from .year_grid import Stamps, grid_of

_NEEDED = ("Year", "Month", "Day", "Hour", "Minute", "GHI")


def read_nsrdb(path: Path | str) -> Weather:
    """The weather of an NSRDB file [Sengupta et al., Renew. Sust. Energy Reviews 89, 2018].

    A record is of its stamp, so that is the middle of its interval. A file in UTC is turned to the
    site's standard time; the hours that then leave the year come in at its other end.

    Raises FileError, naming the line, for what is no such file or cannot be repaired.
    """
    path = Path(path)
    lines = read_lines(path)
    if len(lines) < 4 or not lines[0].startswith("Source,"):
        raise FileError(f"“{path.name}” is not an NSRDB file: it should begin with “Source,”.")
    head = dict(zip(lines[0].split(","), lines[1].split(","), strict=False))
    keys = ("Latitude", "Longitude", "Local Time Zone", "Elevation")
    site = site_from([head.get(key, "") for key in keys], path.name, 2)
    titles = [title.strip() for title in lines[2].split(",")]
    for title in _NEEDED:
        if title not in titles:
            raise FileError(
                f"“{path.name}” line 3 has no column “{title}”; ask for GHI, DNI and DHI "
                "when you download it."
            )
    rows = rows_of(lines, 3, path.name, len(_NEEDED))
    minutes = rows.whole(titles.index("Minute"), "minute", 0, 59)
    distinct, parts = np.unique(minutes, return_inverse=True)
    per_hour = len(distinct)
    stamps = Stamps(
        years=rows.whole(titles.index("Year"), "year", 1900, 2200),
        months=rows.whole(titles.index("Month"), "month", 1, 12),
        days=rows.whole(titles.index("Day"), "day", 1, 31),
        hours=rows.whole(titles.index("Hour"), "hour", 0, 23),
        parts=parts,
        per_hour=per_hour,
    )
    zone = site_from(
        [head["Latitude"], head["Longitude"], head.get("Time Zone", ""), "0"], path.name, 2
    ).utc_offset
    ahead = int(np.floor((site.utc_offset - zone) * per_hour))
    delay = site.utc_offset - zone - ahead / per_hour + distinct[0] / 60.0 - 0.5 / per_hour

    def column(title: str) -> np.ndarray:
        if title not in titles:
            return np.full(len(rows.lines), np.nan)
        return rows.column(titles.index(title), title)

    return completed(
        path.name,
        site,
        grid_of(rows, stamps, ahead=ahead),
        Columns(
            global_horizontal=column("GHI"),
            direct_normal=column("DNI"),
            diffuse_horizontal=column("DHI"),
            temperature=column("Temperature"),
            dew_point=column("Dew Point"),
            pressure=100.0 * column("Pressure"),
        ),
        f"NSRDB {head.get('Location ID', '').strip()} ({path.name})",
        (f"The file's clock is UTC{zone:+g} h.",) if zone != site.utc_offset else (),
        delay=delay,
    )
