"""Where the sun stands in the sky, after NREL's solar position algorithm.

Reda & Andreas, *Solar Position Algorithm for Solar Radiation Applications*, NREL/TP-560-34302,
revised 2008: ±0.0003° for the years −2000 to 6000.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..core.errors import ParameterError
from ..core.scene import Vector
from .delta_t import delta_t_of
from .ephemeris import Geocentric, geocentric_sun
from .site import Site, check_site
from .times import Times, check_times, days_since_j2000, decimal_years, from_days

_EARTH_RADIUS, _FLATTENING = 6378140.0, 0.99664719  # m; polar by equatorial radius
_PARALLAX = np.radians(8.794 / 3600)  # of the sun at 1 AU, on the horizon
_SUN_RADIUS, _HORIZON_REFRACTION = 0.26667, 0.5667  # deg
_TURN = 360.98564736629  # deg that the earth turns in a day of universal time
_ROUNDS = 6  # each leaves less than 1 % of the error in a time of sunrise


@dataclass(frozen=True, slots=True)
class SunPosition:
    """The sun at T times.

    In degrees: ``azimuth`` (T,) clockwise from north, 0 to 360; ``altitude`` (T,) of its centre
    without refraction, and ``apparent_altitude`` (T,) with it. ``direction`` (T, 3): unit vectors
    to where it appears, X east, Y north, Z up. ``distance`` (T,) in AU; ``equation_of_time`` (T,)
    in minutes, apparent less mean solar time.
    """

    azimuth: Vector
    altitude: Vector
    apparent_altitude: Vector
    direction: Vector
    distance: Vector
    equation_of_time: Vector


@dataclass(frozen=True, slots=True)
class SunTimes:
    """Sunrise, transit and sunset (D,) in UTC, datetime64[ms]; NaT where the sun does not set or
    does not rise. ``day_length`` (D,) in h: 24 in polar day, 0 in polar night.
    """

    sunrise: Times
    transit: Times
    sunset: Times
    day_length: Vector


def sun_position(
    times: Times,
    site: Site,
    *,
    pressure: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    delta_t: ArrayLike | None = None,
    refraction: bool = True,
) -> SunPosition:
    """The sun at ``times`` (T,), datetime64 in UTC, in any order.

    ``pressure`` in Pa and ``temperature`` in °C bend its light, one for all or (T,); where None or
    NaN, those of the standard atmosphere at the site's elevation. ``delta_t`` in s, by default of
    Espenak & Meeus. Without ``refraction`` the sun appears where it is.

    Raises ParameterError for a site out of bounds and for times as `check_times` says.
    """
    check_site(site)
    days = days_since_j2000(check_times(times))
    shift = delta_t_of(decimal_years(days)) if delta_t is None else _checked(delta_t, "ΔT")
    terrestrial = days + shift / 86400
    sun = geocentric_sun(terrestrial)
    east, north, up = _horizontal(sun, _sidereal(days, sun) + site.longitude, site)
    azimuth = np.degrees(np.arctan2(east, north)) % 360
    altitude = np.degrees(np.arctan2(up, np.hypot(east, north)))
    apparent = altitude
    if refraction:
        apparent = altitude + _refraction(altitude, pressure, temperature, site)
    return SunPosition(
        azimuth,
        altitude,
        apparent,
        direction_of(azimuth, apparent),
        sun.distance,
        _equation_of_time(terrestrial, sun),
    )


def direction_of(azimuth: ArrayLike, altitude: ArrayLike) -> Vector:
    """Unit vectors (…, 3), X east, Y north, Z up, of azimuths and altitudes in degrees."""
    turn, rise = np.broadcast_arrays(np.radians(azimuth), np.radians(altitude))
    flat = np.cos(rise)
    return np.stack([flat * np.sin(turn), flat * np.cos(turn), np.sin(rise)], axis=-1)


def sun_times(dates: ArrayLike, site: Site, *, delta_t: ArrayLike | None = None) -> SunTimes:
    """Sunrise, transit and sunset of ``dates`` (D,), datetime64[D] of the site's calendar.

    The transit is the one nearest to noon by the site's clock; sunrise is before it and sunset
    after. Sunrise is when the upper limb stands on a level horizon under a mean refraction,
    altitude −0.8333°, as in the paper's appendix A.2, but solved for and not interpolated.
    """
    check_site(site)
    days = days_since_j2000(check_times(dates).astype("datetime64[D]"))
    noon = days + 0.5 - site.utc_offset / 24
    shift = delta_t_of(decimal_years(noon)) if delta_t is None else _checked(delta_t, "ΔT")

    def step(guess: Vector, side: int) -> tuple[Vector, Vector]:
        """A better time of transit (0), sunrise (−1) or sunset (1), and the day's half arc."""
        sun = geocentric_sun(guess + shift / 86400)
        x, y, z = sun.direction.T
        ascension = np.degrees(np.arctan2(y, x))
        hour_angle = _sidereal(guess, sun) + site.longitude - ascension
        arc = _half_arc(z, site)
        wrapped = (side * arc - hour_angle + 180) % 360 - 180
        return guess + wrapped / _TURN, arc

    def solved(guess: Vector, side: int) -> tuple[Vector, Vector]:
        arc = np.zeros_like(guess)
        for _ in range(_ROUNDS):
            guess, arc = step(guess, side)
        return guess, arc

    transit, arc = solved(noon, 0)
    ends = []
    for side in (-1, 1):
        end, last = solved(transit + side * arc / _TURN, side)
        ends.append(np.where((last > 0) & (last < 180), end, np.nan))
    rise, fall = ends
    always = np.where(arc >= 90, 24.0, 0.0)
    length = np.where(np.isnan(rise + fall), always, (fall - rise) * 24)
    return SunTimes(from_days(rise), from_days(transit), from_days(fall), length)


def _half_arc(sine_declination: Vector, site: Site) -> Vector:
    """The hour angle of sunset in degrees (appendix A.2.3): 0 in polar night, 180 in polar day."""
    latitude = np.radians(site.latitude)
    horizon = np.sin(np.radians(-_SUN_RADIUS - _HORIZON_REFRACTION))
    over = horizon - np.sin(latitude) * sine_declination
    cosine = over / np.maximum(np.cos(latitude) * np.sqrt(1 - sine_declination**2), 1e-12)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def _horizontal(sun: Geocentric, meridian: Vector, site: Site) -> tuple[Vector, Vector, Vector]:
    """East, north and up components (T,) of the sun seen from the site, not of length 1.

    ``meridian`` (T,): the site's sidereal time in degrees. The site's place on the ellipsoid is
    taken off the sun's: the parallax of equations 33 to 39.
    """
    latitude, turn = np.radians(site.latitude), np.radians(meridian)
    reduced = np.arctan(_FLATTENING * np.tan(latitude))
    height = site.elevation / _EARTH_RADIUS
    outward = np.cos(reduced) + height * np.cos(latitude)
    poleward = _FLATTENING * np.sin(reduced) + height * np.sin(latitude)
    parallax = np.sin(_PARALLAX / sun.distance)
    x, y, z = sun.direction.T
    south = np.cos(turn) * x + np.sin(turn) * y - parallax * outward
    pole = z - parallax * poleward
    east = np.cos(turn) * y - np.sin(turn) * x
    north = pole * np.cos(latitude) - south * np.sin(latitude)
    return east, north, south * np.cos(latitude) + pole * np.sin(latitude)


def _sidereal(days: Vector, sun: Geocentric) -> Vector:
    """Apparent sidereal time at Greenwich (T,) in degrees (equations 28 and 29)."""
    century = days / 36525
    mean = 280.46061837 + _TURN * days + 0.000387933 * century**2 - century**3 / 38710000
    return mean + sun.equinoxes


def _equation_of_time(terrestrial: Vector, sun: Geocentric) -> Vector:
    """Minutes (T,) that apparent solar time is ahead of the mean (appendix A.1)."""
    terms = (280.4664567, 360007.6982779, 0.03032028, 1 / 49931, -1 / 15300, -1 / 2000000)
    mean = np.polynomial.polynomial.polyval(terrestrial / 365250, terms)
    ascension = np.degrees(np.arctan2(sun.direction[:, 1], sun.direction[:, 0]))
    ahead = mean - 0.0057183 - ascension + sun.equinoxes
    return 4 * ((ahead + 180) % 360 - 180)


def _refraction(
    altitude: Vector, pressure: ArrayLike | None, temperature: ArrayLike | None, site: Site
) -> Vector:
    """Degrees (T,) that the air lifts the sun by (equation 42); 0 once it has set."""
    standard = 101325 * (1 - 2.25577e-5 * site.elevation) ** 5.25588  # ISO 2533
    hectopascal = _known(pressure, standard, "pressure") / 100
    celsius = _known(temperature, 15 - 0.0065 * site.elevation, "temperature")
    up = altitude >= -_SUN_RADIUS - _HORIZON_REFRACTION
    above = np.where(up, altitude, 0.0)
    lift = 1.02 / 60 / np.tan(np.radians(above + 10.3 / (above + 5.11)))
    return np.where(up, hectopascal / 1010 * 283 / (273 + celsius) * lift, 0.0)


def _known(values: ArrayLike | None, otherwise: float, name: str) -> Vector:
    """``values`` with ``otherwise`` for what is not known."""
    if values is None:
        return np.array(otherwise)
    array = np.asarray(values, dtype=np.float64)
    low = -273.0 if name == "temperature" else -1e-9
    bad = np.isfinite(array) & (array <= low)
    if bad.any():
        raise ParameterError(
            f"The air's {name} is {array[bad].flat[0]:g}, which it cannot be; give Pa and °C, or "
            "leave it out."
        )
    return np.where(np.isfinite(array), array, otherwise)


def _checked(values: ArrayLike, name: str) -> Vector:
    array = np.asarray(values, dtype=np.float64)
    if not np.isfinite(array).all():
        raise ParameterError(f"{name} holds a value that is no number; leave it out.")
    return array
