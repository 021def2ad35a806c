"""Temporal maps: hour of the day by day of the year, of the means or of one sensor."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from ..core.colour import ColourScale, Display
from ..core.picture import (
    Curve,
    drawable,
    font_of,
    legend_image,
    save_picture,
    section_png,
)
from ..core.scene import Vector
from .maps import SunMaps
from .tables import HOURLY
from .weather import seconds

_PAPER, _INK, _QUIET = (255, 255, 255), (28, 32, 36), (96, 103, 110)
_WIDE, _HIGH, _GAP, _TEXT = 1095, 480, 28, 18  # pixels
_LINE = 24  # pixels from line to line
_EVERY = 3  # hours between labels
_MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")


@dataclass(frozen=True, slots=True)
class Temporal:
    """Values by day and hour.

    ``days`` (M,) datetime64[D] in a row by the site's calendar; ``values`` (H, M), the first row
    from midnight on, NaN where the period has nothing.
    """

    days: NDArray[np.datetime64]
    values: Vector


def temporal_map(times: NDArray[np.datetime64], values: Vector, utc_offset: float) -> Temporal:
    """``values`` (T,) at ``times`` (T,), UTC, as a map for a clock ``utc_offset`` hours ahead.

    A day has a row an interval, which is a whole part of an hour.
    """
    local = times.astype("datetime64[s]") + seconds(3600 * utc_offset)
    days = local.astype("datetime64[D]")
    shortest = float(np.diff(local).astype(np.int64).min(initial=3600))
    rows = 24 * max(1, round(3600 / shortest))
    row = (local - days).astype(np.int64) * rows // 86400
    span = np.arange(days.min(), days.max() + np.timedelta64(1, "D"))
    grid = np.full((rows, len(span)), np.nan)
    grid[row, (days - span[0]).astype(np.int64)] = values
    return Temporal(span, grid)


def save_hours(folder: Path, result: SunMaps, display: Display) -> list[str]:
    """Write a temporal map of each hourly mean, of a single day its course; returns their names.

    Raises FileError where they cannot be written.
    """
    if not len(result.times):
        return []
    offset = result.meta["site"]["utc_offset"]
    grids = {n: temporal_map(result.times, v, offset) for n, v in result.hourly.items()}
    if all(len(grid.days) == 1 for grid in grids.values()):
        return [_save_course(folder, grids)] if grids else []
    files = []
    for name, grid in grids.items():
        scale = hourly_scale(result.hourly, name, display)
        title = f"{HOURLY[name][0]}: mean over the sensors, {result.meta['period']}"
        files.append(f"hours {name}.png")
        save_picture(temporal_picture(grid, scale, title), folder / files[-1], title)
    return files


def _save_course(folder: Path, grids: Mapping[str, Temporal]) -> str:
    """A day's hourly means as curves."""
    count = len(next(iter(grids.values())).values)
    hours = (np.arange(count) + 0.5) * 24 / count
    curves: list[Curve] = [
        (HOURLY[name][0], grid.values[:, 0], None, None) for name, grid in grids.items()
    ]
    title, unit = HOURLY[next(iter(grids))]
    quantity = title if len(grids) == 1 else "Mean over the sensors"
    section_png(folder / "hours.png", hours, curves, quantity, unit, False, "Hour of the day (h)")
    return "hours.png"


def hourly_scale(hourly: Mapping[str, Vector], name: str, display: Display) -> ColourScale:
    """The scale of an hourly mean, evenly spaced from the values: all of one unit share it."""
    title, unit = HOURLY[name]
    together = [v for n, v in hourly.items() if HOURLY[n][1] == unit]
    return ColourScale.automatic(np.concatenate(together), False, display.palette, title, unit)


def temporal_picture(grid: Temporal, scale: ColourScale, title: str) -> Image.Image:
    """The map in false colour, months along and hours up, with its legend; a title of any lines."""
    rows, columns = grid.values.shape
    size = (columns * max(1, round(_WIDE / columns)), rows * max(1, round(_HIGH / rows)))
    picture = Image.fromarray(scale.colours(grid.values[::-1]))
    picture = picture.resize(size, Image.Resampling.NEAREST)
    legend = Image.fromarray(legend_image(scale, max(size[1], 240)))
    lines = title.splitlines()
    left, top = 2 * _GAP + _TEXT, _GAP + 2 * _TEXT + (len(lines) - 1) * _LINE
    width = left + size[0] + 2 * _GAP + legend.width
    page = Image.new("RGB", (width, top + max(size[1], legend.height) + 3 * _GAP), _PAPER)
    page.paste(picture, (left, top))
    page.paste(legend, (left + size[0] + _GAP, top))
    pen, font = ImageDraw.Draw(page), font_of(_TEXT)
    for number, line in enumerate(lines):
        pen.text((left, _GAP // 2 + number * _LINE), drawable(line), _INK, font)
    for hour in range(0, 25, _EVERY):
        y = top + size[1] * (1 - hour / 24)
        pen.line((left - 6, y, left, y), _QUIET)
        pen.text((left - 10, y), str(hour), _QUIET, font, anchor="rm")
    for index, text in _labels(grid.days):
        x = left + size[0] * index / columns
        pen.line((x, top + size[1], x, top + size[1] + 6), _QUIET)
        pen.text((x + 3, top + size[1] + 8), text, _QUIET, font)
    return page


def _labels(days: NDArray[np.datetime64]) -> list[tuple[int, str]]:
    """Where each month begins; of less than two months, the first day."""
    dates = [day.astype(object) for day in days]
    if len(dates) < 60:
        return [(0, f"{dates[0].day} {_MONTHS[dates[0].month - 1]}")]
    starts = [(i, date) for i, date in enumerate(dates) if date.day == 1]
    return [(index, _MONTHS[date.month - 1]) for index, date in starts]
