"""A file's records made into a whole year of weather; short gaps are closed, and said."""

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from ..core.scene import Vector
from .extraterrestrial import extraterrestrial
from .interval_sun import sines
from .plausible import check_plausible
from .site import Site
from .split import split_reindl
from .weather import Weather, seconds
from .weather_text import counted
from .year_grid import Grid

MOST_HOURS = 6.0
"""The longest gap that is filled: longer ones hide a morning or an afternoon."""

_LOW = 0.05  # sine of 3°: below, a direct irradiance does not follow from a horizontal one
_YEAR = 300 * 24.0  # h: as long, there are clear days anywhere
_SENSOR = -50.0  # W/m²: what a sensor shows below zero at night; less is no measurement


@dataclass(frozen=True, slots=True)
class Columns:
    """What a file says of R records, each (R,), NaN where missing; units as in Weather."""

    global_horizontal: Vector
    direct_normal: Vector
    diffuse_horizontal: Vector
    temperature: Vector
    dew_point: Vector
    pressure: Vector


def completed(
    name: str,
    site: Site,
    grid: Grid,
    columns: Columns,
    source: str,
    notes: tuple[str, ...] = (),
    *,
    delay: float = 0.0,
) -> Weather:
    """The weather of ``columns`` on the intervals of ``grid``.

    Radiation that is missing follows from the other two kinds, or by Reindl's split from the global
    one alone, or is interpolated in time as a share of what reaches the air; so do temperatures in
    short gaps. ``delay`` in h: how long after an interval's middle its sunlight is of.

    Raises FileError for a gap longer than MOST_HOURS, for no radiation at all, and for what cannot
    be at this site (`check_plausible`).
    """
    said = [*grid.notes, *notes]
    times = grid.middles - seconds(3600.0 * site.utc_offset) + seconds(3600.0 * delay)
    hours = np.full(len(times), grid.hours)
    _check_gaps(name, grid, said)
    sine, highest = sines(times, hours, site)
    above = extraterrestrial(times)
    kinds = {
        "Global horizontal": grid.spread(columns.global_horizontal),
        "Direct normal": grid.spread(columns.direct_normal),
        "Diffuse horizontal": grid.spread(columns.diffuse_horizontal),
    }
    _scale_energies(kinds, sine, above, grid.hours, said)
    _clear_nights(kinds, highest, said)
    _forget_empty(kinds, sine)
    given = {kind: values.copy() for kind, values in kinds.items()}
    _close(kinds, sine, above, said)
    _interpolate_radiation(name, kinds, grid, sine, above, said)
    weather = Weather(
        site=site,
        year=grid.year,
        times=times,
        hours=hours,
        global_horizontal=kinds["Global horizontal"],
        direct_normal=kinds["Direct normal"],
        diffuse_horizontal=kinds["Diffuse horizontal"],
        temperature=_bridged(grid.spread(columns.temperature), grid, "Temperature", said),
        dew_point=_bridged(grid.spread(columns.dew_point), grid, "Dew point", said),
        pressure=_bridged(grid.spread(columns.pressure), grid, "Pressure", said),
        source=source,
    )
    said += check_plausible(name, weather, given, sine, highest, above, grid.lines)
    return dataclasses.replace(weather, notes=tuple(said))


def _check_gaps(name: str, grid: Grid, said: list[str]) -> None:
    gaps = _runs(grid.lines == 0)
    if not len(gaps):
        return
    start, end = max(gaps, key=lambda gap: gap[1] - gap[0])
    when = f"from {_moment(grid, start)} to {_moment(grid, end - 1)}"
    if (end - start) * grid.hours > MOST_HOURS:
        raise FileError(
            f"“{name}” has no records {when} ({(end - start) * grid.hours:g} h); gaps of up to "
            f"{MOST_HOURS:g} h are filled. Take a file of the whole year."
        )
    count = sum(end - start for start, end in gaps)
    said.append(f"{counted(count, 'missing record')} interpolated, the longest gap {when}.")


def _scale_energies(
    kinds: dict[str, Vector], sine: Vector, above: Vector, hours: float, said: list[str]
) -> None:
    """Make mean powers of Wh/m² where a file of short intervals holds those.

    Both are in use. Skies are clear at times, so a year whose clearness never passes its square
    root of the interval's share is of energies. A part of a year may be dull throughout.
    """
    high = (sine > 0.3) & np.isfinite(kinds["Global horizontal"])
    if hours >= 1.0 or np.count_nonzero(high) < 100:
        return
    clearness = kinds["Global horizontal"][high] / (above * sine)[high]
    if np.quantile(clearness, 0.98) >= 0.8 * np.sqrt(hours):
        return
    if len(sine) * hours < _YEAR:
        said.append(
            "Radiation is never near that of a clear sky and is taken as W/m²; if the records hold "
            f"Wh/m², multiply them by {1 / hours:g}."
        )
    else:
        for kind in kinds:
            kinds[kind] = kinds[kind] / hours
        said.append(f"Radiation is taken as Wh/m² a record, so × {1 / hours:g} in W/m².")


def _clear_nights(kinds: dict[str, Vector], highest: Vector, said: list[str]) -> None:
    """Set what is missing at night, or a sensor's little below zero, to zero."""
    for kind, values in kinds.items():
        values[values < _SENSOR] = np.nan
        below = counted(np.count_nonzero(values < -1.0), "value")
        if np.any(values < -1.0):
            said.append(f"{kind} radiation: {below} below zero set to zero.")
        values[values < 0.0] = 0.0
        values[np.isnan(values) & (highest <= 0.0)] = 0.0


def _forget_empty(kinds: dict[str, Vector], sine: Vector) -> None:
    """Take as unknown what is written as zero: global radiation, or both of the others."""
    total, direct, diffuse = kinds.values()
    parts = np.nansum(direct) + np.nansum(diffuse)
    if np.nansum(total) > 0.0 and not parts:
        direct[sine > 0.0] = diffuse[sine > 0.0] = np.nan
    elif parts and not np.nansum(total):
        total[sine > 0.0] = np.nan


def _close(kinds: dict[str, Vector], sine: Vector, above: Vector, said: list[str]) -> None:
    """Find the kind of radiation that is missing from the other two, or two from the global one."""
    total, direct, diffuse = kinds.values()
    found = np.isnan(total) & np.isfinite(direct + diffuse)
    total[found] = (direct * sine + diffuse)[found]
    _say(said, found, "Global horizontal", "added up from direct and diffuse")

    found = np.isnan(diffuse) & np.isfinite(total + direct)
    diffuse[found] = np.maximum(total - direct * sine, 0.0)[found]
    _say(said, found, "Diffuse horizontal", "taken as what global leaves over direct")

    found = np.isnan(direct) & np.isfinite(total + diffuse)
    left = np.maximum(total - diffuse, 0.0) / np.maximum(sine, _LOW)
    direct[found] = np.where(sine > _LOW, np.minimum(left, above), 0.0)[found]
    _say(said, found, "Direct normal", "taken as what global leaves over diffuse")

    found = np.isfinite(total) & np.isnan(direct) & np.isnan(diffuse)
    altitude = np.degrees(np.arcsin(sine[found]))
    direct[found], diffuse[found] = split_reindl(total[found], altitude, above[found])
    _say(said, found, "Direct and diffuse", "split from global after Reindl 1990")


def _say(said: list[str], found: NDArray[np.bool_], kind: str, how: str) -> None:
    if found.any():
        said.append(f"{kind} radiation: {counted(np.count_nonzero(found), 'value')} {how}.")


def _interpolate_radiation(
    name: str,
    kinds: dict[str, Vector],
    grid: Grid,
    sine: Vector,
    above: Vector,
    said: list[str],
) -> None:
    """Interpolate direct and diffuse as shares of what reaches the air; global is their sum."""
    total, direct, diffuse = kinds.values()
    absent = np.isnan(direct) | np.isnan(diffuse)
    known = ~absent & (sine > _LOW)
    if not known.any() or not np.any(total[known] > 0.0):
        raise FileError(f"“{name}” has no solar radiation; choose a file that has.")
    if not absent.any():
        return
    start, end = max(_runs(absent), key=lambda gap: gap[1] - gap[0])
    if (end - start) * grid.hours > MOST_HOURS:
        raise FileError(
            f"“{name}” has no solar radiation from {_moment(grid, start)} to "
            f"{_moment(grid, end - 1)}; gaps of up to {MOST_HOURS:g} h are filled. Take another "
            "file."
        )
    place = np.arange(len(sine))
    for values, most in ((direct, above * (sine > 0.0)), (diffuse, above * sine)):
        share = np.interp(place, place[known], values[known] / most[known])
        values[:] = np.where(np.isnan(values), share * most, values)
    total[absent] = (direct * sine + diffuse)[absent]
    if (grid.lines[absent] > 0).any():
        said.append(f"Radiation: {counted(np.count_nonzero(absent), 'interval')} interpolated.")


def _bridged(values: Vector, grid: Grid, what: str, said: list[str]) -> Vector:
    """Straight lines over gaps of up to MOST_HOURS; longer ones stay unknown."""
    absent = np.isnan(values)
    if absent.all():
        said.append(f"{what}: unknown.")
        return values
    place = np.arange(len(values))
    line = np.interp(place, place[~absent], values[~absent])
    left = bridged = 0
    for start, end in _runs(absent):
        if (end - start) * grid.hours <= MOST_HOURS:
            values[start:end] = line[start:end]
            bridged += np.count_nonzero(grid.lines[start:end])
        else:
            left += end - start
    if left:
        said.append(f"{what}: unknown for {left * grid.hours:g} h.")
    if bridged:
        said.append(f"{what}: {counted(bridged, 'value')} interpolated.")
    return values


def _runs(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Where ``flags`` (T,) are true in a row: first index and the one after the last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]])))
    return [(int(start), int(end)) for start, end in edges.reshape(-1, 2)]


def _moment(grid: Grid, index: int) -> str:
    """The interval's beginning as a person reads it, without the nominal year."""
    begin = grid.middles[index] - seconds(1800.0 * grid.hours)
    day, clock = str(begin).split("T")
    return f"{day[5:]} {clock[:5]}"
