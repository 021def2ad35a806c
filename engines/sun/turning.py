"""When a year turns: its equinoxes and solstices."""

import numpy as np

from .delta_t import delta_t_of
from .ephemeris import geocentric_sun
from .times import Times, check_times, days_since_j2000, decimal_years, from_days

_NEAR = ("03-20", "06-21", "09-22", "12-21")
_SPEED = 360 / 365.2422  # deg a day
_ROUNDS = 8  # each leaves a tenth of the error, or less


def turning_points(year: int) -> Times:
    """March equinox, June solstice, September equinox and December solstice (4,) of a year, in UTC.

    The sun's apparent right ascension is then 0, 6, 12 and 18 h. Good to a minute.
    """
    dates = [np.datetime64(f"{year:04d}-{day}", "us") for day in _NEAR]
    days = days_since_j2000(check_times(np.array(dates)))
    delta_t = delta_t_of(decimal_years(days)) / 86400
    for _ in range(_ROUNDS):
        x, y, _z = geocentric_sun(days + delta_t).direction.T
        ahead = np.degrees(np.arctan2(y, x)) - [0, 90, 180, 270]
        days = days - ((ahead + 180) % 360 - 180) / _SPEED
    return from_days(days)
