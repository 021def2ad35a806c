"""Weather files written for the tests: a cloudy year anywhere, in the formats that are read."""

from pathlib import Path

import numpy as np
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.site import Site
from heliform.engines.sun.weather import Weather

HEADER = """LOCATION,{place},{latitude},{longitude},{offset},{elevation}
DESIGN CONDITIONS,0
TYPICAL/EXTREME PERIODS,0
GROUND TEMPERATURES,0
HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0
COMMENTS 1,{comment}
COMMENTS 2,
DATA PERIODS,1,{per_hour},Data,Sunday,{period}"""

BOSTON = Site()
PLACE = "Boston,MA,USA,TMY3,725090"


def cloudy(site: Site = BOSTON, year: int = 2019, hours: float = 1.0, seed: int = 7) -> Weather:
    """A year under clouds, whose diffuse and direct light make up the global, in whole W/m².

    Temperatures follow a sine over the year and the day.
    """
    clear = clear_weather(site, year, hours=hours)
    random = np.random.default_rng(seed)
    clouds = np.repeat(random.uniform(0.0, 1.0, len(clear.times) // 24 + 1), 24)[: len(clear.times)]
    place = np.arange(len(clear.times)) * hours
    summer = -np.cos(2.0 * np.pi * (place / 24.0 - 20.0) / 365.0) * np.sign(site.latitude)
    temperature = np.round(10.0 + 12.0 * summer - 4.0 * np.cos(2.0 * np.pi * place / 24.0), 1)
    return Weather(
        site=site,
        year=year,
        times=clear.times,
        hours=clear.hours,
        global_horizontal=np.round((1.0 - 0.7 * clouds) * clear.global_horizontal),
        direct_normal=np.round((1.0 - clouds) * clear.direct_normal),
        diffuse_horizontal=np.round(
            (1.0 - clouds) * clear.diffuse_horizontal + 0.3 * clouds * clear.global_horizontal
        ),
        temperature=temperature,
        dew_point=np.round(temperature - 4.0, 1),
        pressure=np.full(len(clear.times), 101200.0),
        source="test",
    )


def epw_rows(weather: Weather) -> list[list[str]]:
    """The weather's records as an EPW's rows of 35 columns."""
    span = (weather.hours * 3600.0).astype("timedelta64[s]")
    ends = (weather.local_times + span // 2).astype("datetime64[m]")
    before = ends - np.timedelta64(1, "m")
    rows = []
    for k, (end, begin) in enumerate(zip(ends.tolist(), before.tolist(), strict=True)):
        stamp = [begin.year, begin.month, begin.day, begin.hour + 1, end.minute or 60]
        values = [weather.temperature[k], weather.dew_point[k], 80, weather.pressure[k]]
        light = (
            weather.global_horizontal[k],
            weather.direct_normal[k],
            weather.diffuse_horizontal[k],
        )
        fields = [*stamp, "?9?9", *values, 9999, 9999, 9999, *light]
        rows.append([f"{field:g}" if isinstance(field, float) else str(field) for field in fields])
        rows[-1] += ["0"] * (35 - len(fields))
    return rows


def epw_lines(weather: Weather, rows: list[list[str]] | None = None, **header) -> list[str]:
    """The lines of an EPW; ``header`` replaces what stands in HEADER."""
    site = weather.site
    known = {
        "place": PLACE,
        "latitude": site.latitude,
        "longitude": site.longitude,
        "offset": site.utc_offset,
        "elevation": site.elevation,
        "comment": "",
        "per_hour": round(1.0 / weather.hours[0]),
        "period": " 1/ 1,12/31",
    }
    kept = epw_rows(weather) if rows is None else rows
    return [*HEADER.format(**{**known, **header}).split("\n"), *(",".join(row) for row in kept)]


def write_epw(path: Path, weather: Weather, rows: list[list[str]] | None = None, **header) -> Path:
    """An EPW at ``path``, as on Windows."""
    path.write_bytes("\r\n".join([*epw_lines(weather, rows, **header), ""]).encode())
    return path
