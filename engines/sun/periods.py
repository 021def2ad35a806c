"""Parts of a year: seasons, months, days and hours, and which intervals of a weather they hold."""

import calendar
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.parameters import check_value, fields_of, nested, param
from .degree_days import seasons
from .interval_sun import declination
from .site import Site, check_site, place_text
from .times import Times, check_order, hour_of_day, month_and_day, standard_time
from .turning import turning_points
from .weather import Weather

type Mask = NDArray[np.bool_]

_LONGEST = (31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)  # days of the months
_BOSTON = Site()
_NEAR = 3.0, 10.0
"""Degrees of latitude and longitude from Boston, within which its dates of seasons are taken."""
_TROPICAL, _WINTRY = 10.0, 5.0
"""Latitude below which no season is colder by the sun; and by how many degrees a season's mean sun
may stand over the other hemisphere."""
_TURNS = ("spring equinox", "summer solstice", "autumn equinox", "winter solstice")


@dataclass(frozen=True, slots=True, kw_only=True)
class CoolingSeason:
    """First and last day on which a building is cooled; it is heated on the others.

    By default Boston's, as the thesis has them from Reinhart 2014.
    """

    first_month: int = param(4, "", 1, 12, "Month in which the cooling season begins")
    first_day: int = param(25, "", 1, 31, "Its first day")
    last_month: int = param(10, "", 1, 12, "Month in which the cooling season ends")
    last_day: int = param(21, "", 1, 31, "Its last day, which belongs to it")


@dataclass(frozen=True, slots=True, kw_only=True)
class Period:
    """Part of a year by the site's standard time."""

    span: Literal[
        "year",
        "heating season",
        "cooling season",
        "months",
        "dates",
        "spring equinox",
        "summer solstice",
        "autumn equinox",
        "winter solstice",
    ] = param("year", help="Days that it holds; equinoxes and solstices are single days")
    seasons: Literal["dates", "degree days"] = param(
        "dates", help="What parts heating from cooling: the dates below, or the weather's own"
    )
    cooling: CoolingSeason = nested(CoolingSeason, "Cooling season by dates")  # noqa: RUF009
    first_month: int = param(1, "", 1, 12, "First month, for months and dates")
    first_day: int = param(1, "", 1, 31, "First day of a range of dates")
    last_month: int = param(12, "", 1, 12, "Last month; before the first, it is next year's")
    last_day: int = param(31, "", 1, 31, "Last day of a range of dates, which belongs to it")
    first_hour: float = param(0.0, "h", 0.0, 24.0, "Hour of the day from which on it counts")
    last_hour: float = param(
        24.0, "h", 0.0, 24.0, "Hour of the day up to which it counts; before the first, overnight"
    )


def selected(weather: Weather | Times, period: Period, site: Site) -> Mask:
    """Which of T intervals are in a period (T,): those whose middle is.

    ``weather``, or the intervals' middles (T,), datetime64 in UTC and in order. Ranges run over
    the year's end where they end before they begin. Summer is the site's: in the southern
    hemisphere its solstice is in December.

    Raises ParameterError for a date that no year has, times that are not in order, degree days
    without a weather, for a cooling season whose dates are the site's winter, and for a period that
    holds none of the intervals.
    """
    check_site(site)
    check_period(period)
    times = check_order(weather.times if isinstance(weather, Weather) else weather)
    if period.seasons == "degree days" and period.span.endswith("season"):
        days = _by_degree_days(weather, period)
    else:
        _check_summer(period, site)
        days = _days(times, period, site)
    mask = days & _hours(times, period, site)
    if not mask.any():
        raise ParameterError(
            f"The period “{period_text(period)}” holds none of the {len(times)} intervals; choose "
            "other days or hours."
        )
    return mask


def check_period(period: Period) -> None:
    """Raise ParameterError for a value out of bounds, or a day that its month never has."""
    for field in fields_of(Period):
        if field.kind != "record":
            check_value(field, getattr(period, field.name), "period")
    for field in fields_of(CoolingSeason):
        check_value(field, getattr(period.cooling, field.name), "period.cooling")
    ends = period if period.span == "dates" else period.cooling
    for month, day in ((ends.first_month, ends.first_day), (ends.last_month, ends.last_day)):
        if day > _LONGEST[month - 1]:
            raise ParameterError(
                f"{calendar.month_name[month]} has {_LONGEST[month - 1]} days and no day {day}; "
                "choose a date of the calendar."
            )


def season_notes(period: Period, site: Site) -> tuple[str, ...]:
    """A sentence where Boston's dates part the seasons of a place that is not near it."""
    if not _parted_by_dates(period) or period.cooling != CoolingSeason():
        return ()
    turn = abs((site.longitude - _BOSTON.longitude + 180) % 360 - 180)
    if abs(site.latitude - _BOSTON.latitude) <= _NEAR[0] and turn <= _NEAR[1]:
        return ()
    return (
        f"The seasons are parted on Boston's dates, {_dates_text(period.cooling)}; set those of "
        f"{place_text(site)}, or choose Parted by: Degree days, which asks the weather file.",
    )


def period_text(period: Period) -> str:
    """A period as a person reads it: “cooling season, 25 April to 21 October, 8 to 18 h”."""
    parts: list[str] = [period.span]
    if period.span == "months":
        parts = [_range(_month(period.first_month), _month(period.last_month))]
    elif period.span == "dates":
        parts = [_dates_text(period)]
    elif period.span.endswith("season") and period.seasons == "degree days":
        parts.append("by degree days")
    elif period.span == "cooling season":
        parts.append(_dates_text(period.cooling))
    elif period.span == "heating season":
        parts.append(f"all but {_dates_text(period.cooling)}")
    if (period.first_hour, period.last_hour) != (0, 24):
        parts.append(f"{period.first_hour:g} to {period.last_hour:g} h")
    return ", ".join(parts)


def _parted_by_dates(period: Period) -> bool:
    return period.span.endswith("season") and period.seasons == "dates"


def _check_summer(period: Period, site: Site) -> None:
    """A cooling season cannot be while the sun stands over the other hemisphere."""
    if not _parted_by_dates(period) or abs(site.latitude) < _TROPICAL:
        return
    ordinal = np.arange(1, 366)
    dates = np.datetime64("2019-01-01") + (ordinal - 1).astype("timedelta64[D]")
    months = dates.astype("datetime64[M]")
    date = (months.astype(np.int64) % 12 + 1) * 100 + (dates - months).astype(np.int64) + 1
    height = declination(ordinal[_in_dates(date, period.cooling)]).mean()
    if height * np.sign(site.latitude) < -_WINTRY:
        raise ParameterError(
            f"The cooling season of {_dates_text(period.cooling)} is winter at {place_text(site)}; "
            "set the dates of its summer, or choose Parted by: Degree days."
        )


def _by_degree_days(weather: Weather | Times, period: Period) -> Mask:
    if not isinstance(weather, Weather):
        raise ParameterError(
            "Seasons by degree days need a weather's temperatures; read a weather file, or give "
            "the season's dates."
        )
    parts = seasons(weather)
    return parts.heating if period.span == "heating season" else parts.cooling


def _days(times: Times, period: Period, site: Site) -> Mask:
    """Which times are on the period's days (T,)."""
    month, day = month_and_day(times, site)
    date = month * 100 + day
    match period.span:
        case "year":
            return np.ones(len(times), bool)
        case "months":
            return _between(month, period.first_month, period.last_month)
        case "dates":
            return _in_dates(date, period)
        case "cooling season":
            return _in_dates(date, period.cooling)
        case "heating season":
            return ~_in_dates(date, period.cooling)
        case turn:
            return _on_turn(times, turn, site)


def _in_dates(date: NDArray[np.int64], ends: Period | CoolingSeason) -> Mask:
    first, last = (ends.first_month, ends.first_day), (ends.last_month, ends.last_day)
    return _between(date, first[0] * 100 + first[1], last[0] * 100 + last[1])


def _between(values: NDArray[np.int64], first: int, last: int) -> Mask:
    """Which values are from first to last, round the year's end where the last is before."""
    after, before = values >= first, values <= last
    return after & before if first <= last else after | before


def _on_turn(times: Times, turn: str, site: Site) -> Mask:
    """Which times are on the site's date of an equinox or a solstice, year by year."""
    which = (_TURNS.index(turn) + (2 if site.latitude < 0 else 0)) % 4
    dates = standard_time(times, site).astype("datetime64[D]")
    mask = np.zeros(len(times), bool)
    for year in np.unique(dates.astype("datetime64[Y]")):
        point = turning_points(year.astype(np.int64) + 1970)[which : which + 1]
        mask |= dates == standard_time(point, site).astype("datetime64[D]")
    return mask


def _hours(times: Times, period: Period, site: Site) -> Mask:
    """Which times are within the period's hours of the day (T,)."""
    hour = hour_of_day(times, site)
    after, before = hour >= period.first_hour, hour < period.last_hour
    return after & before if period.first_hour <= period.last_hour else after | before


def _dates_text(ends: Period | CoolingSeason) -> str:
    first = f"{ends.first_day} {_month(ends.first_month)}"
    return _range(first, f"{ends.last_day} {_month(ends.last_month)}")


def _month(month: int) -> str:
    return calendar.month_name[month]


def _range(first: str, last: str) -> str:
    return first if first == last else f"{first} to {last}"
