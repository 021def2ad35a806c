"""Radiance's skies: its own sun, gendaylit's parameters and gendaymtx's matrices."""

import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pvlib
import pyradiance
from heliform.engines.sun.position import SunPosition
from heliform.engines.sun.site import Site
from heliform.engines.sun.weather import Weather

EFFICACY = 179.0
"""The lumens of a watt of Radiance's white light."""


def typical_year(name: str = "723170TYA.CSV") -> Weather:
    """A typical year that pvlib ships, as it reads it: Greensboro, or 703165TY.csv, Sand Point."""
    path = Path(pvlib.__file__).parent / "data" / name
    table, place = pvlib.iotools.read_tmy3(path, coerce_year=2019, map_variables=True)
    site = Site(
        latitude=place["latitude"],
        longitude=place["longitude"],
        elevation=place["altitude"],
        utc_offset=place["TZ"],
    )
    ends = table.index.tz_convert("UTC").tz_localize(None).to_numpy()
    columns = ("ghi", "dni", "dhi", "temp_air", "temp_dew")
    ghi, dni, dhi, temperature, dew_point = (table[name].to_numpy(float) for name in columns)
    return Weather(
        site=site,
        year=2019,
        times=ends.astype("datetime64[s]") - np.timedelta64(1800, "s"),
        hours=np.ones(len(ends)),
        global_horizontal=ghi,
        direct_normal=dni,
        diffuse_horizontal=dhi,
        temperature=temperature,
        dew_point=dew_point,
        pressure=table["pressure"].to_numpy(float) * 100,
        source=name,
    )


def part(weather: Weather, chosen) -> Weather:
    """The weather's ``chosen`` intervals."""
    columns = {
        name: getattr(weather, name)[chosen]
        for name in (
            *("times", "hours", "global_horizontal", "direct_normal", "diffuse_horizontal"),
            *("temperature", "dew_point", "pressure"),
        )
    }
    others = {name: getattr(weather, name) for name in ("site", "year", "source", "notes")}
    return Weather(**columns, **others)


def local(weather: Weather):
    """Month, day, day of the year and hour (T,) by the site's standard time."""
    times = weather.local_times
    month = times.astype("datetime64[M]").astype(int) % 12 + 1
    day = (times.astype("datetime64[D]") - times.astype("datetime64[M]")).astype(int) + 1
    hour = (times - times.astype("datetime64[D]")).astype(float) / 3600
    of_year = (times.astype("datetime64[D]") - times.astype("datetime64[Y]")).astype(int) + 1
    return month, day, of_year, hour


def radiance_sun(weather: Weather):
    """Azimuth from north and altitude (T,) in rad of the sun as gendaylit and gendaymtx have it."""
    _, _, day, hour = local(weather)
    site = weather.site
    declination = 0.4093 * np.sin((2 * np.pi / 365) * (day - 81))
    shift = 0.170 * np.sin((4 * np.pi / 373) * (day - 80)) - 0.129 * np.sin(
        (2 * np.pi / 355) * (day - 8)
    )
    turn = (hour + shift + site.longitude / 15 - site.utc_offset) * np.pi / 12
    latitude = np.radians(site.latitude)
    sine, cosine = np.sin(latitude), np.cos(latitude)
    altitude = np.arcsin(sine * np.sin(declination) - cosine * np.cos(declination) * np.cos(turn))
    azimuth = np.pi - np.arctan2(
        np.cos(declination) * np.sin(turn),
        -cosine * np.sin(declination) - sine * np.cos(declination) * np.cos(turn),
    )
    return azimuth, altitude


def radiance_position(weather: Weather) -> SunPosition:
    """`radiance_sun` as our own sun position."""
    azimuth, altitude = radiance_sun(weather)
    direction = np.stack(
        [np.sin(azimuth) * np.cos(altitude), np.cos(azimuth) * np.cos(altitude), np.sin(altitude)],
        axis=1,
    )
    degrees = np.degrees(altitude)
    ones = np.ones(len(azimuth))
    return SunPosition(np.degrees(azimuth) % 360, degrees, degrees, direction, ones, 0 * ones)


def gendaylit(weather: Weather, index: int, output: int):
    """gendaylit's ten numbers for one interval, its sun's radiance and ε and Δ.

    ``output``: 1 for W/(m² sr), 2 for cd/m². None where it gives up with a black sky.
    """
    month, day, _, hour = (column[index] for column in local(weather))
    site = weather.site
    command = (
        *("gendaylit", month, day, hour, "-a", site.latitude, "-o", -site.longitude),
        *("-m", -15 * site.utc_offset, "-d", weather.dew_point[index], "-w", "-O", output),
        *("-W", weather.direct_normal[index], weather.diffuse_horizontal[index]),
    )
    done = subprocess.run(
        [str(pyradiance.BINPATH / command[0]), *map(str, command[1:])],
        capture_output=True,
        text=True,
        check=True,
    )
    indices = re.search(r"epsilon, delta.*: (\S+) (\S+)", done.stdout)
    if not indices:
        return None
    numbers = np.array(done.stdout.split("\n10 ")[1].split(), float)
    sun = float(done.stdout.split("\n3 ")[1].split()[0])
    return numbers, sun, float(indices[1]), float(indices[2])


def perezlum(numbers, directions):
    """What perezlum.cal makes of gendaylit's numbers (D,), before the ground's share."""
    scale, _, a, b, c, d, e = numbers[:7]
    cosine = directions @ numbers[7:]
    gamma = np.arccos(np.clip(cosine, -1, 1))
    height = np.maximum(directions[:, 2], 0.01)
    return scale * (1 + a * np.exp(b / height)) * (1 + c * np.exp(d * gamma) + e * cosine**2)


def gendaymtx(weather: Weather, subdivision: int, *options):
    """gendaymtx's matrix (P + 1, T), white, W/(m² sr), with the ground in its first row."""
    month, day, _, hour = local(weather)
    site = weather.site
    lines = [
        "place somewhere",
        f"latitude {site.latitude}",
        f"longitude {-site.longitude}",
        f"time_zone {-15 * site.utc_offset}",
        f"site_elevation {site.elevation}",
        "weather_data_file_units 1",
    ]
    columns = (month, day, hour, weather.direct_normal, weather.diffuse_horizontal)
    lines += [f"{m} {d} {h:.3f} {b:g} {s:g}" for m, d, h, b, s in zip(*columns, strict=True)]
    with tempfile.TemporaryDirectory() as folder:
        tape = Path(folder) / "tape.wea"
        tape.write_text("\n".join(lines) + "\n")
        command = [pyradiance.BINPATH / "gendaymtx", "-h", "-of", "-m", subdivision]
        command += [*options, "-c", 1, 1, 1] if "-d" not in options else options
        done = subprocess.run([*map(str, command), str(tape)], capture_output=True, check=True)
    patches = 144 * subdivision**2 + 2
    return np.frombuffer(done.stdout, "<f4").reshape(patches, -1, 3)[:, :, 1].astype(float)
