"""Weather from whatever file it is in."""

from pathlib import Path

from ..core.errors import FileError
from .epw import read_epw
from .nsrdb import read_nsrdb
from .pvgis import read_pvgis
from .tmy3 import read_tmy3
from .weather import Weather
from .weather_text import read_lines


def read_weather(path: Path | str) -> Weather:
    """The weather of an EPW, TMY3, NSRDB or PVGIS file, told apart by what it says, not its name.

    Raises FileError when it is none of these, and as the format's own reader does.
    """
    path = Path(path)
    lines = [line.lstrip('" ') for line in read_lines(path)[:60]]
    if any(line.upper().startswith("LOCATION") for line in lines[:20]):
        return read_epw(path)
    if len(lines) > 1 and lines[1].startswith("Date (MM/DD/YYYY)"):
        return read_tmy3(path)
    if lines[0].startswith("Source,"):
        return read_nsrdb(path)
    if any(line.startswith("time(UTC)") for line in lines):
        return read_pvgis(path)
    if path.suffix.lower() == ".epw":
        return read_epw(path)  # which says what is wrong with it
    raise FileError(
        f"“{path.name}” is not a weather file that is known here; choose an EPW, a TMY3 or NSRDB "
        "CSV or a PVGIS typical year as CSV."
    )
