"""Whether a year of weather can be of the place that its file names."""

import dataclasses

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from ..core.scene import Vector
from .closure import Kinds, check_closure
from .interval_sun import declination, sines
from .site import Site, place_text
from .weather import Weather
from .weather_text import counted

_LIT = 20.0  # W/m²: more than dusk and sensors give while the sun is down
_TOO_MANY = 0.05
_MOST_OVER = 0.2
_CLOCK = 3.5  # h: farther from the sun no country's standard time is
_ALIKE = 0.02
_WHOLE = 300  # days
_TELLING = 0.5  # h: how much day lengths on both sides of the equator differ, at 7° and more
_DAWN = 5.0  # W/m²
_OTHER = 0.25
_COLDEST, _WARMEST = -90.0, 65.0


def check_plausible(
    name: str,
    weather: Weather,
    given: Kinds,
    sine: Vector,
    highest: Vector,
    above: Vector,
    lines: NDArray[np.int64],
) -> list[str]:
    """What is odd, as notes; ``given`` (T,) are the file's kinds of radiation, NaN where missing.

    ``sine``, ``highest`` (T,) of the sun as in `interval_sun.sines`, ``above`` (T,)
    extraterrestrial irradiance, ``lines`` (T,) of the file. Raises FileError where the sun shines
    at night, the days are long in the other hemisphere's summer, or more reaches the ground than
    the air too often for chance; for a temperature that is none on earth, and as `check_closure`.
    """
    _check_temperatures(name, weather, lines)
    _check_nights(name, weather, highest)
    _check_hemisphere(name, weather)
    most = dict(zip(given, (above * sine, above, above * sine), strict=True))
    sound = ~np.any([given[kind] - most[kind] > _LIT for kind in given], axis=0)
    said = check_closure(name, weather, given, sine, lines, sound)
    return [*said, *_over(name, given, most, sine, lines), *_clock(weather.site)]


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
    shares = {}
    for said, change in reasons.items():
        other = dataclasses.replace(site, **change)
        shift = np.timedelta64(round(3600 * (site.utc_offset - other.utc_offset)), "s")
        _, height = sines(weather.times + shift, weather.hours, other)
        shares[said] = _night_share(weather, height)
    best = min(shares.values())
    if best < share / 4.0:
        fitting = [said for said in reasons if shares[said] <= best + _ALIKE]
        remedy = f"{', or '.join(fitting)}; correct the header"
    raise FileError(
        f"“{name}” has sunshine at night in {share:.0%} of its lit hours for a site at "
        f"{place_text(site)} and UTC{site.utc_offset:+g} h: {remedy}."
    )


def _night_share(weather: Weather, highest: Vector) -> float:
    lit = weather.global_horizontal > _LIT
    return float(np.mean(highest[lit] < 0.0)) if lit.any() else 0.0


def _check_hemisphere(name: str, weather: Weather) -> None:
    """The lit hours of a year's days must follow the site's days, not those beyond the equator.

    What the site's days of 12 h + d (D,) should be beyond the equator is 12 h − d: how much of that
    the lit hours hold, by least squares, is −1 where the site is right. Near the equator days do
    not tell.
    """
    days, which = np.unique(weather.local_times.astype("datetime64[D]"), return_inverse=True)
    ordinal = (days - days.astype("datetime64[Y]")).astype(np.int64) + 1
    height, north = np.radians(declination(ordinal)), np.radians(weather.site.latitude)
    rises = np.arcsin(np.clip(np.tan(north) * np.tan(height), -1.0, 1.0))
    beyond = -24.0 / np.pi * rises
    beyond -= beyond.mean()
    if len(days) < _WHOLE or np.sqrt(np.mean(beyond**2)) < _TELLING:
        return
    lit = np.bincount(which, (weather.global_horizontal > _DAWN) * weather.hours, len(days))
    if beyond @ (lit - lit.mean()) / (beyond @ beyond) > _OTHER:
        raise FileError(
            f"“{name}” has its long days while they are short at {place_text(weather.site)}: the "
            "latitude's sign looks wrong (south is negative); correct the header."
        )


def _over(
    name: str,
    given: Kinds,
    most: Kinds,
    sine: Vector,
    lines: NDArray[np.int64],
) -> list[str]:
    """Radiation on the ground beyond the ``most`` (T,) of its kind that comes to the air."""
    notes = []
    for kind, values in given.items():
        excess = values - most[kind]
        over = excess > _LIT
        share = np.mean(over[sine > 0.1]) if np.any(sine > 0.1) else 0.0
        if share > _MOST_OVER:
            raise FileError(
                f"“{name}” has more {kind.lower()} radiation than reaches the air in {share:.0%} "
                "of its daylight hours: its unit is not W/m², or its site is wrong. Correct the "
                "file."
            )
        if over.any():
            worst = int(np.nanargmax(excess))
            notes.append(
                f"{kind} radiation: {counted(np.count_nonzero(over), 'record')} above what reaches "
                f"the air, most on line {lines[worst]} ({values[worst]:.0f} of "
                f"{most[kind][worst]:.0f} W/m²)."
            )
    return notes


def _clock(site: Site) -> list[str]:
    ahead = (site.utc_offset - site.longitude / 15.0 + 12.0) % 24.0 - 12.0
    if abs(ahead) <= _CLOCK:
        return []
    return [
        f"The clock of UTC{site.utc_offset:+g} h is {abs(ahead):.1f} h off the sun's at "
        f"{place_text(site)}, but the radiation agrees with it."
    ]
