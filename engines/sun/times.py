"""Instants: universal time, a site's standard time, and what a list of times must hold."""

import datetime
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .site import Site

type Times = NDArray[np.datetime64]

J2000 = np.datetime64("2000-01-01T12:00:00", "us")
FIRST_YEAR, LAST_YEAR = -2000, 6000
_DAY = np.timedelta64(1, "D")


def check_times(times: ArrayLike) -> Times:
    """``times`` as datetime64[us] (T,), of any unit before.

    Raises ParameterError where one is no time (NaT) or outside the years −2000 to 6000, which is
    as far as the periodic terms reach.
    """
    array = np.atleast_1d(np.asarray(times))
    if array.dtype.kind != "M":
        raise ParameterError(
            f"Times are numpy.datetime64 in UTC, not {array.dtype}; convert them first."
        )
    if array.ndim != 1:
        raise ParameterError(f"Times come in one row, not in the shape {array.shape}; ravel them.")
    missing = np.flatnonzero(np.isnat(array))
    if missing.size:
        raise ParameterError(
            f"Time {missing[0]} of {array.size} is no time (NaT); leave it out or fill it in."
        )
    years = array.astype("datetime64[Y]").astype(np.int64) + 1970
    outside = np.flatnonzero((years < FIRST_YEAR) | (years > LAST_YEAR))
    if outside.size:
        raise ParameterError(
            f"Time {outside[0]} is in the year {years[outside[0]]}; the sun's position is known "
            f"for the years {FIRST_YEAR} to {LAST_YEAR}."
        )
    return array.astype("datetime64[us]")


def check_order(times: ArrayLike) -> Times:
    """`check_times`, and ParameterError where a time is not after the one before it."""
    array = check_times(times)
    back = np.flatnonzero(np.diff(array) <= np.timedelta64(0, "us"))
    if back.size:
        at = int(back[0]) + 1
        raise ParameterError(
            f"Time {at} ({_said(array[at])}) is not after time {at - 1} ({_said(array[at - 1])}); "
            "sort the times and leave out what is there twice."
        )
    return array


def days_since_j2000(times: Times) -> Vector:
    """Days (T,) from noon of 1 January 2000 on, as float64, good to 1 µs for centuries."""
    return (times.astype("datetime64[us]") - J2000).astype(np.int64) / 86.4e9


def from_days(days: Vector) -> Times:
    """The times datetime64[ms] of ``days`` (T,) after J2000; NaN becomes NaT."""
    whole = np.where(np.isnan(days), 0.0, np.round(np.asarray(days) * 86.4e6))
    times = J2000.astype("datetime64[ms]") + whole.astype(np.int64).astype("timedelta64[ms]")
    return np.where(np.isnan(days), np.datetime64("NaT", "ms"), times)


def decimal_years(days: Vector) -> Vector:
    """Years (T,) with their fractions, of ``days`` after J2000."""
    return 2000.0 + (days + 0.5) / 365.2425


def standard_time(times: Times, site: Site) -> Times:
    """Universal times as a clock at the site shows them, daylight saving left out."""
    return times.astype("datetime64[us]") + _offset(site)


def universal_time(clock: Times, site: Site) -> Times:
    """The universal times at which the site's clock shows ``clock``: `standard_time` undone."""
    return clock.astype("datetime64[us]") - _offset(site)


def day_of_year(times: Times, site: Site) -> NDArray[np.int64]:
    """Ordinal dates (T,) at the site: 1 for 1 January."""
    clock = standard_time(times, site)
    return (clock.astype("datetime64[D]") - clock.astype("datetime64[Y]")) // _DAY + 1


def month_and_day(times: Times, site: Site) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Month 1 to 12 and day of the month 1 to 31 (T,) at the site."""
    clock = standard_time(times, site)
    month = clock.astype("datetime64[M]")
    days = (clock.astype("datetime64[D]") - month.astype("datetime64[D]")) // _DAY + 1
    return month.astype(np.int64) % 12 + 1, days.astype(np.int64)


def hour_of_day(times: Times, site: Site) -> Vector:
    """Hours (T,) since midnight at the site, 0 to less than 24."""
    clock = standard_time(times, site)
    return (clock - clock.astype("datetime64[D]")).astype(np.int64) / 3.6e9


def hours_of_year(year: int, site: Site) -> Times:
    """The middle of each hour of a year at the site, as universal times: 8,760 or 8,784."""
    first = np.datetime64(f"{year:04d}", "Y").astype("datetime64[m]")
    last = np.datetime64(f"{year + 1:04d}", "Y").astype("datetime64[m]")
    clock = np.arange(first, last, np.timedelta64(60, "m")) + np.timedelta64(30, "m")
    return universal_time(clock, site)


def moment(year: int, month: int, day: int, hour: float, site: Site) -> Times:
    """One instant (1,) by the site's calendar and clock. Raises ParameterError for no such day."""
    try:
        date = datetime.date(year, month, day)
    except ValueError:
        raise ParameterError(
            f"There is no day {day} in month {month} of {year}; choose a date of the calendar."
        ) from None
    microseconds = np.timedelta64(round(hour * 3.6e9), "us")
    return universal_time(np.array([np.datetime64(date, "us") + microseconds]), site)


def _offset(site: Site) -> Any:
    return np.timedelta64(round(site.utc_offset * 3600), "s")


def _said(time: Any) -> str:
    return np.datetime_as_string(time, unit="m").replace("T", " ")
