"""The sums over a year's intervals that its maps and figures are made of."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..core.progress import Progress, part
from ..core.scene import Vector
from . import en17037, metrics
from .blind import Blind
from .coefficients import Coefficients, Sought, daylight_coefficients
from .illuminance import Course, overcast
from .inside import inside
from .interior import Interior, tables
from .rays import rays_of

HOURS = 24
"""Lit hours, spread over the period, from which the error of a single hour is told."""
_LOOSEST = 2.0  # times the asked error

_NAMES = (
    "daylight_factor",
    "illuminance",
    "daylight_autonomy",
    "continuous_autonomy",
    "udi_low",
    "udi_supplementary",
    "udi_useful",
    "udi_high",
    "direct_hours",
)


class Asked(Protocol):
    """What of a `daylight.Daylight` the year depends on."""

    @property
    def bounces(self) -> int: ...
    @property
    def ground_reflectance(self) -> float: ...
    @property
    def target(self) -> float: ...
    @property
    def blinds_transmittance(self) -> float: ...
    @property
    def error(self) -> float: ...
    @property
    def paths(self) -> int: ...
    @property
    def open(self) -> bool: ...


@dataclass(frozen=True, slots=True)
class Year:
    """What a year of T intervals comes to on N sensors.

    ``values``: name of `tables.QUANTITIES` → (N,). ``reached`` (N, 4): shares of the daylight
    hours, in whose middle the sun is up, with each of `en17037.LIMITS`. ``course`` (T,): mean
    illuminance over the sensors by area in lx; ``closed`` (T,): when the blinds are closed in the
    hours that count. ``errors``: 95 % half-width ÷ mean, root mean square over the sensors, of
    "illuminance", "daylight_factor" and a single "hour". ``given_up``: what share of the light,
    about, is left out for being reflected too often. ``paths``: the most that were followed from a
    sensor.
    ``notes``: on sensors that lie inside a solid.
    """

    values: dict[str, Vector]
    reached: Vector
    course: Vector
    closed: NDArray[np.bool_]
    errors: dict[str, float]
    given_up: float
    paths: int
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Asking:
    """What is sought of coefficients with the blinds open, or with them closed.

    ``sought``: of the mean sky of the hours in which they are, ÷ all hours; of the overcast sky; of
    ``single`` (k,) hours. ``square``: the sums over the sensors, by their share of the area, of the
    squares of these skies' half-widths.
    """

    sought: Sought
    single: NDArray[np.int64]
    square: Vector


def _asking(
    course: Course, hours: Vector, chosen: NDArray[np.bool_], asked: Asked, loose: float
) -> _Asking:
    lit = np.flatnonzero((hours > 0) & chosen & course.sky.any(axis=0))
    single = lit[np.linspace(0, len(lit) - 1, min(HOURS, len(lit))).round().astype(np.int64)]
    weights = np.zeros((len(hours), 1 + len(single)))
    weights[:, 0] = np.where(chosen, hours, 0.0) / hours.sum()
    weights[single, 1 + np.arange(len(single))] = 1.0
    skies, suns = course.luminances(weights), course.normal(weights)
    cloudy = np.tile(overcast(course.dome, asked.ground_reflectance)[None, :, None], (3, 1, 1))
    sought = Sought(
        np.insert(skies, [1], cloudy, axis=2),
        loose * asked.error,
        asked.paths,
        course.aims(suns[:, 0], chosen),
        np.insert(suns, 1, 0.0, axis=1),
    )
    return _Asking(sought, single, np.zeros(2 + len(single)))


def _looseness(
    course: Course, hours: Vector, closed: NDArray[np.bool_], asked: Asked
) -> tuple[float, float]:
    """How many times the asked error the light of hours with open and with closed blinds may have.

    The less of the mean light there is in the one, as far as the sky outdoors tells, the less exact
    it need be; together they keep to what was asked.
    """
    if not closed.any():
        return 1.0, 1.0
    sky, sun = (part.sum(axis=0) * hours for part in (course.sky, course.spread))
    through = asked.blinds_transmittance * (sky + sun)[closed].sum()
    light = np.array([sky[~closed].sum(), through])
    share = light / max(light.sum(), 1e-300)
    first, second = np.minimum(np.sqrt(0.5) / np.maximum(share, 1e-9), _LOOSEST)
    return float(first), float(second)


class Summing:
    """The sums that make a `Year`, block by block."""

    def __init__(
        self,
        interior: Interior,
        course: Course,
        hours: Vector,
        closed: NDArray[np.bool_],
        asked: Asked,
    ) -> None:
        self.interior, self.course, self.hours, self.asked = interior, course, hours, asked
        self.closed = closed
        self.behind = course.some(closed)
        loose = _looseness(course, hours, closed, asked)
        self.open = _asking(course, hours, ~closed, asked, loose[0])
        self.veiled = _asking(course, hours, closed, asked, loose[1]) if closed.any() else None
        self.daylit = np.where(course.up, course.hours, 0.0)
        count = len(interior.sensors)
        self.values = {name: np.zeros(count) for name in _NAMES}
        self.reached = np.zeros((count, len(en17037.LIMITS)))
        self.mean = np.zeros(len(hours))
        self.paths = 0
        self.given_up = 0.0

    def add(self, rows: slice, seed: int, progress: Progress) -> None:
        """Trace and sum up a block of sensors."""
        plain, veiled = self.coefficients(rows, seed, part(progress, 0.0, 0.9))
        self.values["daylight_factor"][rows] = 100 * plain.value[:, 1]
        for table in tables(rows, len(self.hours)):
            done = (table.start - rows.start) / (rows.stop - rows.start)
            progress(0.9 + 0.1 * done, "Summing the hours")
            here = slice(table.start - rows.start, table.stop - rows.start)
            behind = veiled.some(here) if veiled else None
            self._sum(table, *self.light(table, plain.some(here), behind))

    def coefficients(
        self, rows: slice, seed: int, progress: Progress
    ) -> tuple[Coefficients, Coefficients | None]:
        """Of a block of sensors, with the blinds open, and closed where they ever are."""
        if not self.veiled:
            return self._found(rows, self.open, 0.0, (seed, rows.start), progress), None
        first, second = part(progress, 0.0, 0.5), part(progress, 0.5, 1.0)
        veil = self.asked.blinds_transmittance
        return (
            self._found(rows, self.open, 0.0, (seed, rows.start), first),
            self._found(rows, self.veiled, veil, (seed, rows.start, 1), second),
        )

    def light(
        self, rows: slice, plain: Coefficients, veiled: Coefficients | None
    ) -> tuple[metrics.Light, metrics.Light]:
        """Illuminance (n, T) of some sensors, and what the sun gives them through open blinds."""
        some = self.interior.sensors.some(rows)
        direct = self.course.sunlight(self.interior.occluders, some)
        light = self.course.light(plain, direct)
        if veiled is not None:
            shining = self.behind.sunlight(self.interior.shut, some)
            light[:, self.closed] = self.behind.light(veiled, shining)
        return light, direct

    def _found(
        self, rows: slice, asking: _Asking, veil: float, key: tuple[int, ...], progress: Progress
    ) -> Coefficients:
        found = daylight_coefficients(
            self.interior.around,
            self.interior.sensors.some(rows),
            self.course.dome,
            self.asked.bounces,
            asking.sought,
            veil=veil,
            seed=int(np.random.SeedSequence(key).generate_state(1)[0]),
            progress=progress,
        )
        asking.square[:] += self.interior.shares[rows] @ found.half_width**2
        self.paths = max(self.paths, found.paths)
        self.given_up += float((self.interior.shares[rows] * found.value[:, 0]) @ found.given_up)
        return found

    def _sum(self, rows: slice, light: metrics.Light, direct: metrics.Light) -> None:
        hours, target = self.hours, self.asked.target
        dark, dim, bright, glaring = metrics.useful(light, hours)
        found = {
            "illuminance": metrics.mean_light(light, hours),
            "daylight_autonomy": 100 * metrics.autonomy(light, hours, target),
            "continuous_autonomy": 100 * metrics.continuous_autonomy(light, hours, target),
            "udi_low": 100 * dark,
            "udi_supplementary": 100 * dim,
            "udi_useful": 100 * (dim + bright),
            "udi_high": 100 * glaring,
            "direct_hours": metrics.hours_above(direct, hours),
        }
        for name, values in found.items():
            self.values[name][rows] = values
        if self.daylit.any():
            for column, limit in enumerate(en17037.LIMITS):
                self.reached[rows, column] = metrics.autonomy(light, self.daylit, limit)
        self.mean += self.interior.shares[rows].astype(np.float32) @ light

    def year(self) -> Year:
        """What has been found of all blocks."""
        shares = self.interior.shares
        parts = [one for one in (self.open, self.veiled) if one]
        square = sum(float(one.square[0]) for one in parts)
        single = np.concatenate([one.square[2:] for one in parts])
        level = self.mean[np.concatenate([one.single for one in parts])]
        factor = float(shares @ self.values["daylight_factor"]) / 100
        mean = float(shares @ self.values["illuminance"])
        errors = {
            "illuminance": _ratio(np.sqrt(square), mean),
            "daylight_factor": _ratio(np.sqrt(self.open.square[1]), factor),
        }
        if len(single):
            share = np.divide(single, level**2, out=np.zeros_like(single), where=level > 0)
            errors["hour"] = float(np.sqrt(share.mean()))
        return Year(
            self.values,
            self.reached,
            self.mean,
            self.closed & (self.hours > 0),
            errors,
            _ratio(self.given_up, mean),
            self.paths,
            self._buried(),
        )

    def _buried(self) -> tuple[str, ...]:
        """How many sensors are inside of which solid: such ones are dark."""
        dark = np.flatnonzero(self.values["daylight_factor"] == 0)
        fan = rays_of(self.interior.occluders, self.interior.sensors.some(dark), np.zeros((0, 3)))
        found = inside(self.interior.occluders, fan.origins, fan.normals)
        return Blind(len(self.interior.sensors), 0, found).told()


def _ratio(error: float, level: float) -> float:
    return float(error / level) if level > 0 else 0.0
