"""The sky and the sun of each interval of a year's weather."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .efficacy import DEW_POINT, diffuse_efficacy, direct_efficacy, precipitable_water
from .extraterrestrial import extraterrestrial
from .perez import perez_sky
from .position import sun_position
from .site import Site
from .sky import Skies
from .weather import Weather

Quantity = Literal["radiation", "light"]

_NIGHT = -10.0
"""The sun's altitude in degrees, below which it has not been up for a moment of the hour."""

_TRIFLE = 2e-3
"""Of a period's direct light, which may be left out without a word."""


@dataclass(frozen=True, slots=True)
class HourlySkies:
    """T intervals of daylight, of one quantity.

    ``skies``: Perez's; ``diffuse`` (T,): what each gives to a horizontal plane, in W/m² or lx;
    ``sun`` (T, 3) unit vectors to where the sun appears, X east, Y north, Z up; ``direct`` (T,)
    normal to it, in W/m² or lx, 0 while it is down. ``hours`` (T,): how long each lasts.
    ``notes``: what was left out, guessed or looks wrong.
    """

    skies: Skies
    diffuse: Vector
    sun: Vector
    direct: Vector
    hours: Vector
    notes: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.hours)


def hourly_skies(
    weather: Weather,
    site: Site,
    quantity: Quantity = "radiation",
    selected: NDArray[np.bool_] | None = None,
) -> HourlySkies:
    """The skies and suns of the weather's intervals, or of those ``selected`` (T,).

    The sun stands where it appears in an interval's middle. Light is radiation times Perez's
    luminous efficacies, by the interval's own dew point.

    Raises ParameterError for an irradiance that is negative or not a number, for another quantity,
    for times or a site as `sun_position` says.
    """
    if quantity not in get_args(Quantity):
        raise ParameterError(f"A sky is of “radiation” or of “light”, not of “{quantity}”.")
    at = sun_position(
        weather.times, site, pressure=weather.pressure, temperature=weather.temperature
    )
    altitude = at.apparent_altitude
    sky = perez_sky(
        at.azimuth,
        altitude,
        weather.direct_normal,
        weather.diffuse_horizontal,
        outside=extraterrestrial(weather.local_times),
    )
    up = altitude > 0
    diffuse = weather.diffuse_horizontal
    direct = np.where(up, weather.direct_normal, 0.0)
    if quantity == "light":
        water = precipitable_water(weather.dew_point)
        diffuse = diffuse * diffuse_efficacy(sky, water)
        direct = direct * direct_efficacy(sky, water)
    chosen = np.ones(len(altitude), bool) if selected is None else selected
    return HourlySkies(
        sky.skies[chosen],
        diffuse[chosen],
        at.direction[chosen],
        direct[chosen],
        weather.hours[chosen],
        _notes(weather, altitude, quantity, chosen),
    )


def _notes(
    weather: Weather, altitude: Vector, quantity: Quantity, chosen: NDArray[np.bool_]
) -> tuple[str, ...]:
    """What a user should know of the light of the ``chosen`` (T,) intervals."""
    notes = []
    if not np.any(altitude[chosen] > 0):
        notes.append("The sun is never above the horizon in the period: it gives no direct light.")
    lost = chosen & (altitude <= 0) & (weather.direct_normal > 0)
    energy, whole = (
        float(weather.direct_normal[some] @ weather.hours[some]) / 1000 for some in (lost, chosen)
    )
    if energy > _TRIFLE * whole:
        notes.append(
            f"The sun is below the horizon in the middle of {int(lost.sum()):,} intervals with "
            f"direct light: {energy:.3g} kWh/m² normal to it are left out."
        )
    night = chosen & (altitude < _NIGHT) & (weather.global_horizontal > 0)
    if night.any():
        notes.append(
            f"{int(night.sum()):,} intervals of “{weather.source}” have daylight with the sun more "
            f"than {-_NIGHT:g}° below the horizon: check the latitude, longitude and UTC offset of "
            "the site."
        )
    dry = int(np.isnan(weather.dew_point[chosen]).sum())
    if quantity == "light" and dry:
        notes.append(f"{dry:,} intervals have no dew point: {DEW_POINT:g} °C is taken for them.")
    return tuple(notes)
