"""Where in a year a file's records belong, and which are not there."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from ..core.scene import Vector
from .weather_text import Rows

NOMINAL = 2019
NOMINAL_LEAP = 2020
"""What a typical year, put together from several, is dated in."""

_MONTHS = np.array([31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31])


@dataclass(frozen=True, slots=True)
class Stamps:
    """When R records are, by the file's clock: each (R,) int.

    ``hours`` count from 0, the one after midnight; ``parts`` from 0 within the hour, which has
    ``per_hour``.
    """

    years: NDArray[np.int64]
    months: NDArray[np.int64]
    days: NDArray[np.int64]
    hours: NDArray[np.int64]
    parts: NDArray[np.int64]
    per_hour: int


@dataclass(frozen=True, slots=True)
class Grid:
    """T intervals in a row, of which records fill some.

    ``middles`` (T,) datetime64[s] in standard time, all in ``year``; ``at`` (R,) int: which
    interval each record is of; ``lines`` (T,) int: the line a record is from, 0 for none; ``hours``
    that each lasts.
    """

    year: int
    middles: NDArray[np.datetime64]
    at: NDArray[np.int64]
    lines: NDArray[np.int64]
    hours: float
    notes: tuple[str, ...]

    def spread(self, column: Vector) -> Vector:
        """A column (R,) of the file over the intervals (T,), NaN where there is no record."""
        values = np.full(len(self.middles), np.nan)
        values[self.at] = column
        return values


def grid_of(
    rows: Rows, stamps: Stamps, span: tuple[int, int] | None = None, *, ahead: int = 0
) -> Grid:
    """The intervals of the year, or of the days of ``span``, and where ``rows`` stand in them.

    ``span`` holds the first and last day as month · 100 + day. Records of a typical year, whose
    months come from several, are dated in one. ``ahead``: how many intervals the site's clock is
    ahead of the stamps; what leaves the year at one end comes in at the other. Raises FileError for
    a day that is in no calendar and for two records of one interval.
    """
    leap = bool(np.any((stamps.months == 2) & (stamps.days == 29)))
    lengths = _MONTHS + (np.arange(12) == 1) * leap
    _check_days(rows, stamps, lengths)
    before = np.concatenate([[0], np.cumsum(lengths)])
    per_day = 24 * stamps.per_hour
    day = before[stamps.months - 1] + stamps.days - 1
    slots = day * per_day + stamps.hours * stamps.per_hour + stamps.parts
    slots = (slots + ahead) % (int(before[-1]) * per_day)
    first, last = 0, int(before[-1]) * per_day - 1
    if span:
        opened, closed = (int(before[date // 100 - 1]) + date % 100 - 1 for date in span)
        first = min(opened * per_day, int(slots.min()))
        last = max((closed + 1) * per_day - 1, int(slots.max()))
    year, note = _year_of(stamps.years, leap)
    grid_slots = np.arange(first, last + 1)
    seconds = np.round((grid_slots % per_day + 0.5) * 3600.0 / stamps.per_hour)
    days = np.datetime64(f"{year}-01-01", "s") + _days(grid_slots // per_day, year, leap)
    middles = days + seconds.astype("timedelta64[s]")
    at = slots - first
    lines = np.zeros(len(middles), np.int64)
    lines[at] = rows.lines
    _check_once(rows, at, lines)
    return Grid(year, middles, at, lines, 1.0 / stamps.per_hour, note)


def _days(days: NDArray[np.int64], year: int, leap: bool) -> NDArray[np.timedelta64]:
    """Days since 1 January, past a leap day that the file left out of its leap year."""
    skips = not leap and _is_leap(year)
    return (days + (days >= 59) * skips).astype("timedelta64[D]")


def _is_leap(year: int) -> bool:
    return year % 4 == 0 and (year % 100 != 0 or year % 400 == 0)


def _year_of(years: NDArray[np.int64], leap: bool) -> tuple[int, tuple[str, ...]]:
    low, high = int(years.min()), int(years.max())
    if low == high and 1900 <= low <= 2200 and (_is_leap(low) or not leap):
        return low, ()
    year = NOMINAL_LEAP if leap else NOMINAL
    span = f"of {low}" if low == high else f"from {low} to {high}"
    return year, (f"The records are {span}; all are dated in {year}.",)


def _check_days(rows: Rows, stamps: Stamps, lengths: NDArray[np.int64]) -> None:
    months = np.clip(stamps.months, 1, 12)
    wrong = (stamps.months != months) | (stamps.days < 1) | (stamps.days > lengths[months - 1])
    wrong |= (stamps.hours < 0) | (stamps.hours > 23)
    if wrong.any():
        at = int(np.argmax(wrong))
        raise FileError(
            f"“{rows.name}” line {rows.lines[at]}: no year has a month {stamps.months[at]}, day "
            f"{stamps.days[at]}, hour {stamps.hours[at]}; correct the line."
        )


def _check_once(rows: Rows, at: NDArray[np.int64], lines: NDArray[np.int64]) -> None:
    twice = lines[at] != np.array(rows.lines)
    if twice.any():
        k = int(np.argmax(twice))
        raise FileError(
            f"“{rows.name}” lines {rows.lines[k]} and {lines[at[k]]} are of the same interval of "
            "the year; give one year, in standard time, without summer time."
        )
