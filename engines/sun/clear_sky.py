"""Sunlight under cloudless skies, by published models, and a whole year of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.parameters import param
from ..core.scene import Vector
from .air_mass import SEA_LEVEL, relative_air_mass, standard_pressure
from .extraterrestrial import extraterrestrial
from .interval_sun import instants
from .position import SunPosition, sun_position
from .site import Site
from .weather import Weather, seconds

MONTHLY_TURBIDITY = (2.45, 2.6, 2.6, 3.05, 3.25, 3.7, 3.65, 3.95, 3.35, 2.9, 3.05, 2.55)
"""Linke turbidity in Boston by month, from the world's map of it [Remund et al., ISES 2003]; it is
middling for the temperate zones."""

_SOLAR_CONSTANT = 1361.1  # W/m² [Gueymard 2018]


@dataclass(frozen=True, slots=True, kw_only=True)
class Air:
    """What Bird and Hulstrom's cloudless air holds."""

    water: float = param(1.5, "cm", 0.0, 10.0, "Precipitable water, as a depth of rain")
    ozone: float = param(0.3, "cm", 0.0, 1.0, "Ozone, as a depth at sea level's pressure")
    aerosol_380: float = param(0.15, "", 0.0, 4.0, "Optical depth of aerosols at 380 nm")
    aerosol_500: float = param(0.1, "", 0.0, 4.0, "Optical depth of aerosols at 500 nm")
    asymmetry: float = param(0.85, "", 0.5, 1.0, "Share of scattered light that goes forward")
    albedo: float = param(0.2, "", 0.0, 1.0, "How much of its light the ground sends back")


def ineichen_perez(
    apparent_altitude: Vector, extraterrestrial: Vector, turbidity: Vector | float, elevation: float
) -> tuple[Vector, Vector, Vector]:
    """Global horizontal, direct normal and diffuse horizontal irradiance (T,) in W/m².

    Ineichen and Perez, Solar Energy 73(3), 2002: ``apparent_altitude`` (T,) in deg,
    ``extraterrestrial`` (T,) normal to the sun, Linke ``turbidity`` at air mass 2, ``elevation`` in
    m.
    """
    sine = np.maximum(np.sin(np.radians(apparent_altitude)), 0.0)
    mass = relative_air_mass(apparent_altitude) * standard_pressure(elevation) / SEA_LEVEL
    low, high = np.exp(-elevation / 8000.0), np.exp(-elevation / 1250.0)
    reach = 5.09e-5 * elevation + 0.868
    loss = 3.92e-5 * elevation + 0.0387
    total = (
        reach * extraterrestrial * sine * np.exp(-loss * mass * (low + high * (turbidity - 1.0)))
    )
    direct = extraterrestrial * (0.664 + 0.163 / low) * np.exp(-0.09 * mass * (turbidity - 1.0))
    # At low sun direct and global are fitted apart; at least some of global must be diffuse.
    share = np.clip(1.0 - (0.1 - 0.2 * np.exp(-turbidity)) / (0.1 + 0.882 / low), 0.0, None)
    most = np.divide(total * share, sine, out=np.zeros_like(total), where=sine > 0.0)
    direct = np.minimum(direct, most)
    return total, direct, total - direct * sine


def bird_hulstrom(
    apparent_altitude: Vector, extraterrestrial: Vector, pressure: Vector | float, air: Air
) -> tuple[Vector, Vector, Vector]:
    """Global horizontal, direct normal and diffuse horizontal irradiance (T,) in W/m².

    Bird and Hulstrom, SERI/TR-642-761, 1981: ``apparent_altitude`` (T,) in deg,
    ``extraterrestrial`` (T,) normal to the sun, ``pressure`` in Pa.
    """
    sine = np.maximum(np.sin(np.radians(apparent_altitude)), 0.0)
    mass = relative_air_mass(apparent_altitude)
    pressed = mass * pressure / SEA_LEVEL
    rayleigh = np.exp(-0.0903 * pressed**0.84 * (1.0 + pressed - pressed**1.01))
    ozone = air.ozone * mass
    ozone = (
        1.0
        - 0.1611 * ozone * (1.0 + 139.48 * ozone) ** -0.3035
        - 0.002715 * ozone / (1.0 + 0.044 * ozone + 0.0003 * ozone**2)
    )
    gases = np.exp(-0.0127 * pressed**0.26)
    water = air.water * mass
    water = 1.0 - 2.4959 * water / ((1.0 + 79.034 * water) ** 0.6828 + 6.385 * water)
    depth = 0.2758 * air.aerosol_380 + 0.35 * air.aerosol_500
    aerosol = np.exp(-(depth**0.873) * (1.0 + depth - depth**0.7088) * mass**0.9108)
    absorbed = 1.0 - 0.1 * (1.0 - mass + mass**1.06) * (1.0 - aerosol)
    scattered = aerosol / absorbed
    back = 0.0685 + (1.0 - air.asymmetry) * (1.0 - scattered)
    lit = sine > 0.0
    direct = np.where(
        lit, 0.9662 * extraterrestrial * rayleigh * ozone * gases * water * aerosol, 0.0
    )
    sky = extraterrestrial * sine * 0.79 * ozone * gases * water * absorbed
    sky = sky * (0.5 * (1.0 - rayleigh) + air.asymmetry * (1.0 - scattered))
    sky = np.maximum(sky / (1.0 - mass + mass**1.02), 0.0)  # its fit is below zero on the horizon
    total = (direct * sine + sky) / (1.0 - air.albedo * back)
    return total, direct, total - direct * sine


def clear_weather(
    site: Site,
    year: int = 2019,
    turbidity: float | Sequence[float] | None = None,
    *,
    hours: float = 1.0,
) -> Weather:
    """A year without a cloud at ``site``, by Ineichen and Perez's model.

    Linke ``turbidity``: one for the year, twelve for the months, or None for that of the site. 2 is
    very clean cold air, 3 clean warm air, 5 a humid summer, 7 a polluted town. ``hours``: how long
    each interval is; a whole number makes up a day. Temperature and dew point are unknown; pressure
    is the standard atmosphere's.

    Raises ParameterError for a turbidity below 1, or for intervals that do not make up a day.
    """
    months = monthly_turbidity(site) if turbidity is None else _months(turbidity)

    def model(moments: NDArray[np.datetime64], sun: SunPosition) -> tuple[Vector, Vector, Vector]:
        local = moments + seconds(3600.0 * site.utc_offset)
        month = local.astype("datetime64[M]").astype(np.int64) % 12
        above = extraterrestrial(moments, _SOLAR_CONSTANT)
        return ineichen_perez(sun.apparent_altitude, above, months[month], site.elevation)

    said = "monthly values" if np.ptp(months) else f"{months[0]:g}"
    found = _cloudless(site, year, hours, model, f"Clear sky, Ineichen–Perez, turbidity {said}")
    note = f"The air's Linke turbidity is {_range_text(months)}, as it was set."
    if turbidity is None and not site.turbidity:
        note = (
            f"The air's Linke turbidity is Boston's, {_range_text(months)}; set the site's where "
            "the air is cleaner or more polluted."
        )
    return replace(found, notes=(*found.notes, note))


def _range_text(months: Vector) -> str:
    low, high = months.min(), months.max()
    return f"{low:g}" if low == high else f"{low:g} to {high:g} by month"


def clear_weather_bird(
    site: Site, year: int = 2019, air: Air | None = None, *, hours: float = 1.0
) -> Weather:
    """A year without a cloud at ``site``, by Bird and Hulstrom's model; else as `clear_weather`."""
    held = air or Air()
    pressure = standard_pressure(site.elevation)

    def model(moments: NDArray[np.datetime64], sun: SunPosition) -> tuple[Vector, Vector, Vector]:
        above = extraterrestrial(moments, _SOLAR_CONSTANT)
        return bird_hulstrom(sun.apparent_altitude, above, pressure, held)

    return _cloudless(site, year, hours, model, "Clear sky, Bird–Hulstrom")


def _cloudless(site: Site, year: int, hours: float, model, source: str) -> Weather:
    """A year of the means of ``model`` over intervals of ``hours``."""
    if not hours > 0.0 or abs(24.0 / hours - round(24.0 / hours)) > 1e-9:
        raise ParameterError(f"Intervals of {hours:g} h do not make up a day; 1 h does.")
    begin = np.datetime64(f"{year:04}-01-01", "s")
    days = int(
        (np.datetime64(f"{year + 1:04}-01-01", "D") - begin).astype("timedelta64[D]").astype(int)
    )
    middles = (np.arange(days * round(24.0 / hours)) + 0.5) * hours * 3600.0
    times = begin + middles.astype("timedelta64[s]") - seconds(3600.0 * site.utc_offset)
    lengths = np.full(len(times), float(hours))
    moments = instants(times, lengths)
    kinds = model(moments.ravel(), sun_position(moments.ravel(), site))
    total, direct, diffuse = (kind.reshape(moments.shape).mean(axis=0) for kind in kinds)
    unknown = np.full(len(times), np.nan)
    return Weather(
        site=site,
        year=year,
        times=times,
        hours=lengths,
        global_horizontal=total,
        direct_normal=direct,
        diffuse_horizontal=diffuse,
        temperature=unknown,
        dew_point=unknown.copy(),
        pressure=np.full(len(times), standard_pressure(site.elevation)),
        source=source,
    )


def monthly_turbidity(site: Site) -> Vector:
    """A site's Linke turbidity by month (12,).

    Where the site does not say it, MONTHLY_TURBIDITY, turned by half a year south of the equator.
    Raises ParameterError for one below 1.
    """
    if site.turbidity:
        return _months(site.turbidity)
    return np.roll(MONTHLY_TURBIDITY, 0 if site.latitude >= 0.0 else 6).astype(np.float64)


def _months(turbidity: float | Sequence[float]) -> Vector:
    values = np.asarray(turbidity, np.float64)
    if values.shape not in ((), (12,)) or not np.all((values >= 1.0) & (values <= 20.0)):
        raise ParameterError(
            "The Linke turbidity must be one number or twelve, from 1 (air alone) to 20."
        )
    return np.broadcast_to(values, 12).astype(np.float64)
