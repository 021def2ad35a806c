"""Whether a year of weather can be of the place that its file names."""

import dataclasses

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from ..core.scene import Vector
from .interval_sun import sines
from .site import Site
from .weather import Weather
from .weather_text import counted

_LIT = 20.0  # W/m²: more than dusk and sensors give while the sun is down
_TOO_MANY = 0.05
_MOST_OVER = 0.2
_CLOCK = 3.5  # h: farther from the sun no country's standard time is
_COLDEST, _WARMEST = -90.0, 65.0


def check_plausible(
    name: str,
    weather: Weather,
    given: Vector,
    sine: Vector,
    highest: Vector,
    above: Vector,
    lines: NDArray[np.int64],
) -> list[str]:
    """What is odd, as notes; ``given`` (T,) is the file's global radiation, NaN where missing.

    ``sine``, ``highest`` (T,) of the sun as in `interval_sun.sines`, ``above`` (T,)
    extraterrestrial irradiance, ``lines`` (T,) of the file. Raises FileError where the sun shines
    at night or more reaches the ground than the air too often for chance, and for a temperature
    that is none on earth.
    """
    _check_temperatures(name, weather, lines)
    _check_nights(name, weather, highest)
    return [*_over(name, weather, given, sine, above, lines), *_clock(weather.site)]


def _check_temperatures(name: str, weather: Weather, lines: NDArray[np.int64]) -> None:
    values = weather.temperature
    wrong = (values < _COLDEST) | (values > _WARMEST)
    if wrong.any():
        at = int(np.argmax(wrong))
        raise FileError(
            f"“{name}” line {lines[at]}: an air temperature of {values[at]:g} °C is none on earth; "
            "temperatures must be in °C."
        )


def _check_nights(name: str, weather: Weather, highest: Vector) -> None:
    """Sunshine at night means that the site or the clock is wrong: say which mends it."""
    share = _night_share(weather, highest)
    if share <= _TOO_MANY:
        return
    site = weather.site
    reasons = {
        "the longitude's sign looks wrong (west is negative)": {"longitude": -site.longitude},
        "the latitude's sign looks wrong (south is negative)": {"latitude": -site.latitude},
        "the UTC offset's sign looks wrong (west is negative)": {"utc_offset": -site.utc_offset},
        "its records look to be in UTC": {"utc_offset": 0.0},
    }
    remedy = "correct the site's longitude, latitude or UTC offset in the header"
    best = share / 4.0
    for said, change in reasons.items():
        other = dataclasses.replace(site, **change)
        shift = np.timedelta64(round(3600 * (site.utc_offset - other.utc_offset)), "s")
        _, height = sines(weather.times + shift, weather.hours, other)
        if _night_share(weather, height) < best:
            best, remedy = _night_share(weather, height), f"{said}; correct the header"
    raise FileError(
        f"“{name}” has sunshine at night in {share:.0%} of its lit hours for a site at "
        f"{_place(site)} and UTC{site.utc_offset:+g} h: {remedy}."
    )


def _night_share(weather: Weather, highest: Vector) -> float:
    lit = weather.global_horizontal > _LIT
    return float(np.mean(highest[lit] < 0.0)) if lit.any() else 0.0


def _place(site: Site) -> str:
    north, east = "NS"[site.latitude < 0], "EW"[site.longitude < 0]
    return f"{abs(site.latitude):g}° {north}, {abs(site.longitude):g}° {east}"


def _over(
    name: str,
    weather: Weather,
    given: Vector,
    sine: Vector,
    above: Vector,
    lines: NDArray[np.int64],
) -> list[str]:
    """Radiation on the ground beyond what comes to the air."""
    excess = given - above * sine
    over = excess > _LIT
    day = sine > 0.1
    if day.any() and np.mean(over[day]) > _MOST_OVER:
        raise FileError(
            f"“{name}” has more global radiation than reaches the air in {np.mean(over[day]):.0%} "
            "of its daylight hours: its unit is not W/m², or its site is wrong. Correct the file."
        )
    notes = []
    if over.any():
        worst = int(np.nanargmax(excess))
        most = f"{given[worst]:.0f} of {(above * sine)[worst]:.0f} W/m²"
        notes.append(
            f"Global radiation: {counted(np.count_nonzero(over), 'record')} above what reaches the "
            f"air, most on line {lines[worst]} ({most})."
        )
    beyond = weather.direct_normal > above
    if beyond.any():
        notes.append(
            f"Direct radiation: {counted(np.count_nonzero(beyond), 'record')} above what reaches "
            "the air."
        )
    return notes


def _clock(site: Site) -> list[str]:
    ahead = (site.utc_offset - site.longitude / 15.0 + 12.0) % 24.0 - 12.0
    if abs(ahead) <= _CLOCK:
        return []
    return [
        f"The clock of UTC{site.utc_offset:+g} h is {abs(ahead):.1f} h off the sun's at "
        f"{_place(site)}, but the radiation agrees with it."
    ]
