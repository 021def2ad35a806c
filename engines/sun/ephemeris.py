"""Where the sun stands among the stars: the geocentric part of NREL's algorithm."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from ..core.scene import Vector
from .spa_terms import Coordinate, nutation, orbit

_BLOCK = 4096  # times at once: 195 terms of them are 6 MB
_STEP = 1.0  # days between knots; the splines then err by less than 1e-7°
_MARGIN = 3  # knots beyond the first and last time

# Mean elongation of the moon, anomalies of sun and moon, the moon's argument of latitude and its
# ascending node, in degrees: polynomials of the century (equations 15 to 19).
_LUNAR = np.array(
    [
        [297.85036, 445267.111480, -0.0019142, 1 / 189474],
        [357.52772, 35999.050340, -0.0001603, -1 / 300000],
        [134.96298, 477198.867398, 0.0086972, 1 / 56250],
        [93.27191, 483202.017538, -0.0036825, 1 / 327270],
        [125.04452, -1934.136261, 0.0020708, 1 / 450000],
    ]
)
# Mean obliquity of the ecliptic in ″, by ten thousand years (equation 24).
_OBLIQUITY = (
    *(84381.448, -4680.93, -1.55, 1999.25, -51.38, -249.67),
    *(-39.05, 7.12, 27.87, 5.79, 2.45),
)


@dataclass(frozen=True, slots=True)
class Geocentric:
    """The sun seen from the earth's centre at T times.

    ``direction`` (T, 3) unit vectors in the equator and equinox of date, X to the equinox, Z to
    the north pole; ``distance`` (T,) in AU; ``equinoxes`` (T,): apparent less mean sidereal time,
    in degrees.
    """

    direction: Vector
    distance: Vector
    equinoxes: Vector


def geocentric_sun(days: Vector) -> Geocentric:
    """The sun ``days`` (T,) of terrestrial time after J2000 [Reda & Andreas 2008, 3.2 to 3.10].

    Where the times are closer together than one a day, the terms are summed once a day and
    interpolated by cubic splines, which changes no direction by 1e-7°.
    """
    low, high = (float(days.min()), float(days.max())) if days.size else (0.0, 0.0)
    count = int((high - low) / _STEP) + 2 + 2 * _MARGIN
    if count < len(days):
        knots = low + _STEP * (np.arange(count, dtype=np.float64) - _MARGIN)
        table = CubicSpline(knots, _sums(knots))(days)
    else:
        table = _sums(days)
    direction = table[:, :3] / np.linalg.norm(table[:, :3], axis=1, keepdims=True)
    return Geocentric(direction, table[:, 3], table[:, 4])


def _sums(days: Vector) -> Vector:
    """Direction, distance and equation of the equinoxes (T, 5), every term summed."""
    blocks = [days[i : i + _BLOCK] for i in range(0, max(len(days), 1), _BLOCK)]
    return np.concatenate([_block(block) for block in blocks])


def _block(days: Vector) -> Vector:
    century = days / 36525
    millennium = century / 10
    radius = _coordinate("radius", millennium)
    psi, epsilon = _nutation(century)
    tilt = np.radians(np.polynomial.polynomial.polyval(millennium / 10, _OBLIQUITY) / 3600)
    tilt += epsilon
    aberration = np.radians(-20.4898 / 3600 / radius)
    longitude = _coordinate("longitude", millennium) + np.pi + psi + aberration
    latitude = -_coordinate("latitude", millennium)
    flat, high = np.cos(latitude) * np.sin(longitude), np.sin(latitude)
    return np.column_stack(
        [
            np.cos(latitude) * np.cos(longitude),
            flat * np.cos(tilt) - high * np.sin(tilt),
            flat * np.sin(tilt) + high * np.cos(tilt),
            radius,
            np.degrees(psi * np.cos(tilt)),
        ]
    )


def _coordinate(name: Coordinate, millennium: Vector) -> Vector:
    """A heliocentric coordinate of the earth (T,), in rad or AU (equations 9 to 12)."""
    terms = orbit(name)
    waves = np.cos(terms.phase + np.multiply.outer(millennium, terms.frequency))
    powers = millennium[:, None] ** np.arange(terms.amplitude.shape[1])
    return np.einsum("tp,tp->t", waves @ terms.amplitude, powers) / 1e8


def _nutation(century: Vector) -> tuple[Vector, Vector]:
    """Nutation in longitude and obliquity (T,), in rad (equations 20 to 23)."""
    terms = nutation()
    lunar = (century[:, None] ** np.arange(4)) @ _LUNAR.T
    angles = np.radians(lunar) @ terms.arguments.T
    epoch = np.column_stack([np.ones_like(century), century])
    psi = np.einsum("tk,kp,tp->t", np.sin(angles), terms.longitude, epoch, optimize=True)
    epsilon = np.einsum("tk,kp,tp->t", np.cos(angles), terms.obliquity, epoch, optimize=True)
    return np.radians(psi / 36e6), np.radians(epsilon / 36e6)
