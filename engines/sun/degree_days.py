"""Degree days, and when a year's heating and cooling seasons begin and end."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .weather import Weather

HEATING_BASE, COOLING_BASE = 18.3, 10.0
"""In °C: 65 °F and 50 °F [ANSI/ASHRAE/IES 90.1]."""

HEATING_LIMIT = 12.0
"""In °C: the day's mean below which a building is heated [SIA 381/3]."""


@dataclass(frozen=True, slots=True)
class Seasons:
    """The heating and the cooling season of a year of T intervals.

    ``heating``, ``cooling`` (T,) bool: each interval is in one of them. ``cooling_begin`` and
    ``cooling_end``: the cooling season's first and last day, datetime64[D] in the weather's year,
    by the site's standard time, the end before the beginning where the season spans the new year;
    None where all year is one season.
    """

    heating: NDArray[np.bool_]
    cooling: NDArray[np.bool_]
    cooling_begin: np.datetime64 | None
    cooling_end: np.datetime64 | None


def seasons(weather: Weather, limit: float = HEATING_LIMIT) -> Seasons:
    """The cooling season, in which degree days above ``limit`` most outweigh those below.

    The sum of the days' means less the limit, run through the year, is lowest when the season
    begins and highest when it ends, as the onset and end of rains are found [Liebmann and Marengo,
    J. Climate 14, 2001]: single warm days in winter or cold ones in summer move neither. With
    Boston's monthly normals of 1991 to 2020, 12 °C gives 1 May to 19 October.

    Raises ParameterError where the weather holds no temperatures.
    """
    days, means, which = daily_means(weather)
    begin, length = _warmest_arc(means - limit, whole=len(days) >= 365)
    if length in (0, len(days)):
        cooling = np.full(len(which), length > 0)
        return Seasons(~cooling, cooling, None, None)
    inside = (np.arange(len(days)) - begin) % len(days) < length
    cooling = inside[which]
    return Seasons(~cooling, cooling, days[begin], days[(begin + length - 1) % len(days)])


def heating_degree_days(weather: Weather, base: float = HEATING_BASE) -> Vector:
    """Kelvin that each day's mean temperature (D,) lies below ``base`` in °C [ISO 15927-6].

    Raises ParameterError where the weather holds no temperatures.
    """
    return np.maximum(base - daily_means(weather)[1], 0.0)


def cooling_degree_days(weather: Weather, base: float = COOLING_BASE) -> Vector:
    """Kelvin that each day's mean temperature (D,) lies above ``base`` in °C [ISO 15927-6].

    Raises ParameterError where the weather holds no temperatures.
    """
    return np.maximum(daily_means(weather)[1] - base, 0.0)


def daily_means(
    weather: Weather,
) -> tuple[NDArray[np.datetime64], Vector, NDArray[np.int64]]:
    """The D days (D,) by the site's standard time, their mean temperatures (D,) in °C, and the day
    of each interval (T,).

    Days without a temperature are interpolated. Raises ParameterError where none has one.
    """
    days, which = np.unique(weather.local_times.astype("datetime64[D]"), return_inverse=True)
    known = np.isfinite(weather.temperature)
    if not known.any():
        raise ParameterError(
            f"The weather of {weather.source} holds no temperatures to find its seasons from; give "
            "the season's dates instead, or take a weather file that has them."
        )
    hours = np.where(known, weather.hours, 0.0)
    length = np.bincount(which, hours, len(days))
    total = np.bincount(which, hours * np.where(known, weather.temperature, 0.0), len(days))
    there = length > 0.0
    place = np.arange(len(days))
    means = np.interp(place, place[there], total[there] / length[there], period=len(days))
    return days, means, which


def _warmest_arc(balance: Vector, whole: bool) -> tuple[int, int]:
    """First index and length of the run of ``balance`` (D,) with the largest sum.

    In a ``whole`` year a run may pass from its end to its beginning.
    """
    count = len(balance)
    if np.all(balance >= 0.0):
        return 0, count
    run = np.concatenate([[0.0], np.cumsum(np.concatenate([balance, balance[: whole * count]]))])
    best, arc = 0.0, (0, 0)
    for begin in range(count):
        ends = run[begin + 1 : begin + count] if whole else run[begin + 1 :]
        if len(ends) and (gain := float(ends.max()) - run[begin]) > best:
            best, arc = gain, (begin, int(ends.argmax()) + 1)
    return arc
