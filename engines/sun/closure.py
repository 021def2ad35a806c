"""Whether a file's kinds of radiation agree: global is diffuse and direct times the sun's sine."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from ..core.scene import Vector
from .interval_sun import sines
from .site import Site, place_text
from .weather import Weather, seconds
from .weather_text import counted

type Kinds = dict[str, Vector]

_HIGH = np.sin(np.radians(10.0))
_LIT = 50.0  # W/m²: where closure can be asked for, as BSRN does [Long and Shi 2008]
_FEWEST = 10
_MOST_OFF = 0.1
"""Of the year's global radiation; typical years are within 0.003, measured ones mostly 0.05."""
_FITS = 0.05
_ONE_OFF = 0.5, 150.0
"""Share of a record's radiation, and W/m², beyond both of which it is named."""
_MIRRORED = 0.02
"""Of the year's global radiation: what contradicts itself by more may be of the other hemisphere;
5° beyond the equator make 0.04."""
_SHIFTS = (-1.0, -0.5, 0.5, 1.0)


def check_closure(
    name: str,
    weather: Weather,
    given: Kinds,
    sine: Vector,
    lines: NDArray[np.int64],
    sound: NDArray[np.bool_],
) -> list[str]:
    """What contradicts itself in a file, as notes.

    ``given``: global horizontal, direct normal and diffuse horizontal radiation (T,) in W/m² as
    they stand in the file, NaN where missing; ``sine`` (T,) as in `interval_sun.sines`; ``lines``
    (T,) of the file; ``sound`` (T,) those that are not too high to be true.

    Raises FileError where direct or diffuse radiation is zero throughout although global is not
    made up of the other alone, and where columns look exchanged.
    """
    total, direct, diffuse = given.values()
    use = (sine > _HIGH) & np.isfinite(total + direct + diffuse)
    use &= np.fmax(total, direct * sine + diffuse) > _LIT
    if np.count_nonzero(use) < _FEWEST:
        return []
    total, direct, diffuse, high = total[use], direct[use], diffuse[use], sine[use]
    summed = direct * high + diffuse
    off = _off(total, summed)
    sums = _sums(total, summed, weather.hours[use])
    _check_empty(name, direct, diffuse, off, sums)
    _check_latitude(name, weather, given, use, off)
    if off > _MOST_OFF:
        _check_columns(name, total, direct, diffuse, high, off, sums)
        hint = _clock_hint(weather, given, use, off)
        return [
            f"Global, direct and diffuse radiation contradict one another by {off:.0%}: {sums}. "
            f"{hint or 'Leave the wrong column blank, and it is found from the other two.'}"
        ]
    return _single(total, direct, diffuse, high, lines[use], sound[use])


def _off(total: Vector, summed: Vector) -> float:
    return float(np.abs(total - summed).sum() / max(total.sum(), 1e-9))


def _sums(total: Vector, summed: Vector, hours: Vector) -> str:
    parts = float(summed @ hours) / 1000
    return (
        f"with the sun above 10°, global is {float(total @ hours) / 1000:.4g} kWh/m², direct on "
        f"the horizontal and diffuse together {parts:.4g}"
    )


def _check_empty(name: str, direct: Vector, diffuse: Vector, off: float, sums: str) -> None:
    for kind, other, empty in (
        ("direct", "diffuse", not direct.any() and off > _MOST_OFF),
        ("diffuse", "direct", not diffuse.any() and direct.any()),
    ):
        if empty:
            raise FileError(
                f"“{name}” has no {kind} radiation at all: {sums}. Leave the {kind} column blank "
                f"(9999 in an EPW), and it is found from global and {other}."
            )


def _check_columns(
    name: str,
    total: Vector,
    direct: Vector,
    diffuse: Vector,
    high: Vector,
    off: float,
    sums: str,
) -> None:
    """Refuse columns that agree in another order, or with direct light of another plane."""
    read_otherwise = {
        "direct and diffuse look swapped": (total, diffuse * high + direct),
        "global and diffuse look swapped": (diffuse, direct * high + total),
        "global and direct look swapped": (direct, total * high + diffuse),
        "direct looks measured on the horizontal, not normal to the sun": (total, direct + diffuse),
    }
    fits = {said: _off(*columns) for said, columns in read_otherwise.items()}
    said = min(fits, key=lambda one: fits[one])
    if fits[said] < min(_FITS, off / 2):
        raise FileError(
            f"“{name}” contradicts itself in its radiation: {sums}. Its columns of {said}; correct "
            "the file."
        )


def _clock_hint(weather: Weather, given: Kinds, use: NDArray[np.bool_], off: float) -> str:
    """By how much the clock is wrong, where the kinds agree far better with another."""
    fits = {shift: _off_at(weather, given, use, weather.site, shift) for shift in _SHIFTS}
    best = min(fits, key=lambda one: fits[one])
    if fits[best] > off / 2:
        return ""
    way = "later" if best > 0 else "earlier"
    return f"They agree with the clock {abs(best):g} h {way}: check the stamps and the UTC offset."


def _check_latitude(
    name: str, weather: Weather, given: Kinds, use: NDArray[np.bool_], off: float
) -> None:
    """Refuse a site whose radiation agrees as far beyond the equator alone."""
    if off < _MIRRORED:
        return
    site = weather.site
    beyond = replace(site, latitude=-site.latitude)
    if _off_at(weather, given, use, beyond) < off / 3:
        raise FileError(
            f"“{name}” has direct and diffuse radiation that make up its global at "
            f"{place_text(beyond)}, not at {place_text(site)}: the latitude's sign looks wrong "
            "(south is negative); correct the header."
        )


def _off_at(
    weather: Weather, given: Kinds, use: NDArray[np.bool_], site: Site, shift: float = 0.0
) -> float:
    """How far off the kinds are at another site, or with the clock ``shift`` h later."""
    total, direct, diffuse = (kind[use] for kind in given.values())
    high, _ = sines(weather.times[use] + seconds(3600 * shift), weather.hours[use], site)
    return _off(total, direct * high + diffuse)


def _single(
    total: Vector,
    direct: Vector,
    diffuse: Vector,
    high: Vector,
    lines: NDArray[np.int64],
    sound: NDArray[np.bool_],
) -> list[str]:
    summed = direct * high + diffuse
    gap = np.abs(total - summed)
    wrong = sound & (gap > _ONE_OFF[0] * np.maximum(total, summed)) & (gap > _ONE_OFF[1])
    if not wrong.any():
        return []
    worst = int(np.argmax(np.where(wrong, gap, 0.0)))
    return [
        "Global, direct and diffuse radiation contradict one another in "
        f"{counted(np.count_nonzero(wrong), 'record')}, most on line {lines[worst]}: global "
        f"{total[worst]:.0f}, direct on the horizontal {direct[worst] * high[worst]:.0f}, diffuse "
        f"{diffuse[worst]:.0f} W/m²."
    ]
