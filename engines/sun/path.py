"""The sun's path over a site as lines on a dome of radius 1, to be drawn in the view."""

import calendar
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.scene import Vector
from .position import sun_position
from .site import Site, to_model
from .times import Times, month_and_day, universal_time
from .turning import turning_points

type Kind = Literal["day", "hour"]

_TURNS = (3, 6, 9, 12)  # months whose day is the equinox or solstice; of the others, the 21st
_MINUTES = 10  # between points of a day's arc
_DAYS = 3  # between points of an hour's loop


@dataclass(frozen=True, slots=True)
class PathLine:
    """One line of a sun path.

    ``points`` (K, 3): unit vectors in the model's axes, none below the horizon. ``kind``: the arc
    of a day, or the loop of an hour of the clock over the year. ``label``: “21 June” or “12 h”; a
    line that the horizon cuts in two comes as two of one label.
    """

    kind: Kind
    label: str
    points: Vector


def sun_path(site: Site, year: int = 2019) -> tuple[PathLine, ...]:
    """Arcs of the solstices, the equinoxes and the other months' 21sts, and the hours' loops.

    The site's standard time counts. Where the sun does not set an arc is a whole turn; a day or an
    hour without sun has no line. Raises ParameterError for a site out of bounds.
    """
    days: list[tuple[Kind, str, Times]] = [
        ("day", f"{date.astype(object).day} {_month_of(date)}", _day(date, site))
        for date in _dates(year, site)
    ]
    hours: list[tuple[Kind, str, Times]] = [
        ("hour", f"{hour} h", _hour(hour, year, site)) for hour in range(24)
    ]
    lines = days + hours
    points = sun_position(np.concatenate([times for *_, times in lines]), site).direction
    parts = np.split(points, np.cumsum([len(times) for *_, times in lines])[:-1])
    return tuple(
        PathLine(kind, label, to_model(piece, site))
        for (kind, label, _), part in zip(lines, parts, strict=True)
        for piece in _above(part)
    )


def _dates(year: int, site: Site) -> list[np.datetime64]:
    """One day of each month."""
    turns = zip(_TURNS, month_and_day(turning_points(year), site)[1], strict=True)
    days = dict.fromkeys(range(1, 13), 21) | dict(turns)
    return [np.datetime64(f"{year:04d}-{month:02d}-{days[month]:02d}") for month in range(1, 13)]


def _month_of(date: np.datetime64) -> str:
    return calendar.month_name[date.astype(object).month]


def _day(date: np.datetime64, site: Site) -> Times:
    """Times around a day from midnight to midnight, by the sun and not by the clock."""
    minutes = np.arange(0, 1440 + _MINUTES, _MINUTES).astype("timedelta64[m]")
    solar = np.timedelta64(round(site.longitude * 240), "s")
    return date.astype("datetime64[s]") + minutes - solar


def _hour(hour: int, year: int, site: Site) -> Times:
    """One hour of the clock every few days, and on the first day of the next year."""
    days = np.append(np.arange(0, 365, _DAYS), 365)
    hours = (days * 24 + hour).astype("timedelta64[h]")
    return universal_time(np.datetime64(f"{year:04d}-01-01", "h") + hours, site)


def _above(points: Vector) -> Iterator[Vector]:
    """The pieces of a line of directions (K, 3) above the horizon, cut where they meet it."""
    up = points[:, 2] >= 0
    crossings = np.flatnonzero(up[1:] != up[:-1])
    a, b = points[crossings], points[crossings + 1]
    share = a[:, 2] / (a[:, 2] - b[:, 2])
    cuts = a + share[:, None] * (b - a)
    cuts[:, 2] = 0.0
    cuts /= np.linalg.norm(cuts, axis=1, keepdims=True)
    whole = np.insert(points, crossings + 1, cuts, axis=0)
    seen = np.insert(up, crossings + 1, True)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], seen, [False]]).astype(np.int8)))
    for start, end in ends.reshape(-1, 2):
        if end - start > 1:
            yield whole[start:end]
