"""Cloudless skies against pvlib's, and what a year of them must hold."""

import numpy as np
import pandas as pd
import pvlib
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.sun.air_mass import relative_air_mass, standard_pressure
from heliform.engines.sun.clear_sky import (
    MONTHLY_TURBIDITY,
    Air,
    bird_hulstrom,
    clear_weather,
    clear_weather_bird,
    ineichen_perez,
)
from heliform.engines.sun.site import Site

ALTITUDE = np.concatenate([np.linspace(-20.0, 0.0, 5), np.linspace(0.5, 90.0, 180)])
ABOVE = np.full(ALTITUDE.shape, 1361.0)
UP = slice(5, None)
DOWN = slice(5)
KINDS = ("ghi", "dni", "dhi")


@pytest.mark.parametrize("turbidity", [2.0, 3.0, 5.0, 7.0])
@pytest.mark.parametrize("elevation", [0.0, 1830.0, 4000.0])
def test_ineichen_and_perez_are_pvlibs(turbidity, elevation):
    zenith = 90.0 - ALTITUDE[UP]
    mass = pvlib.atmosphere.get_relative_airmass(zenith, "kastenyoung1989")
    mass = pvlib.atmosphere.get_absolute_airmass(mass, standard_pressure(elevation))
    theirs = pvlib.clearsky.ineichen(zenith, mass, turbidity, elevation, ABOVE[UP])
    ours = ineichen_perez(ALTITUDE, ABOVE, turbidity, elevation)
    for mine, kind in zip(ours, KINDS, strict=True):
        assert np.allclose(mine[UP], theirs[kind], rtol=1e-9, atol=1e-6)
        assert np.all(mine[DOWN] == 0.0)


@pytest.mark.parametrize("air", [Air(), Air(water=4.0, aerosol_380=0.6, aerosol_500=0.45)])
@pytest.mark.parametrize("pressure", [101325.0, 84000.0])
def test_bird_and_hulstrom_are_pvlibs(air, pressure):
    mass = relative_air_mass(ALTITUDE[UP])
    theirs = pvlib.clearsky.bird(
        90.0 - ALTITUDE[UP], mass, air.aerosol_380, air.aerosol_500, air.water, air.ozone, pressure,
        ABOVE[UP], air.asymmetry, air.albedo,
    )  # fmt: skip
    ours = bird_hulstrom(ALTITUDE, ABOVE, pressure, air)
    for mine, kind in zip(ours, KINDS, strict=True):
        # The report's equation for ozone has the exponent −0.3035, pvlib −0.3034.
        assert np.allclose(mine[UP], theirs[kind], rtol=0.0, atol=0.05)
        assert np.all(mine[DOWN] == 0.0)


def test_air_mass_and_pressure_are_pvlibs():
    altitude = np.linspace(0.0, 90.0, 181)
    theirs = pvlib.atmosphere.get_relative_airmass(90.0 - altitude, "kastenyoung1989")
    assert np.allclose(relative_air_mass(altitude), theirs)
    for elevation in (0.0, 100.0, 1800.0, 4500.0):
        pressure = pvlib.atmosphere.alt2pres(elevation)
        assert standard_pressure(elevation) == pytest.approx(pressure, rel=1e-3)


def test_turbidity_by_month_is_the_worlds_map_of_it_in_boston():
    days = pd.DatetimeIndex([f"2019-{month:02}-15" for month in range(1, 13)])
    theirs = pvlib.clearsky.lookup_linke_turbidity(days, 42.3603, -71.0875, interp_turbidity=False)
    assert np.allclose(MONTHLY_TURBIDITY, theirs)


@pytest.mark.filterwarnings("ignore:DatetimeIndex.dayofyear")
def test_a_clear_year_is_pvlibs_clear_year():
    site = Site()
    ours = clear_weather(site, 2020, turbidity=3.0, hours=0.25)
    place = pvlib.location.Location(site.latitude, site.longitude, altitude=site.elevation)
    some = slice(40, None, 977)
    # At the middles of quarters of hours; their means are within 2 W/m² but at sunrise and sunset.
    theirs = place.get_clearsky(pd.DatetimeIndex(ours.times[some], tz="UTC"), linke_turbidity=3.0)
    error = ours.global_horizontal[some] - theirs["ghi"].to_numpy()
    assert np.abs(error).max() < 4.0
    assert np.sqrt(np.mean(error**2)) < 1.5


@pytest.mark.parametrize("make", [clear_weather, clear_weather_bird])
def test_a_clear_year_is_whole_and_consistent(make):
    site = Site(latitude=-33.9, longitude=151.2, utc_offset=10.0, elevation=40.0)
    year = make(site, 2024)
    assert (len(year.times), year.year, year.site) == (8784, 2024, site)
    assert year.local_times[0] == np.datetime64("2024-01-01T00:30:00")
    assert year.local_times[-1] == np.datetime64("2024-12-31T23:30:00")
    for kind in (year.global_horizontal, year.direct_normal, year.diffuse_horizontal):
        assert kind.min() >= 0.0
        assert np.all(np.isfinite(kind))
    assert np.all(year.diffuse_horizontal <= year.global_horizontal + 1e-9)
    assert 850.0 < year.direct_normal.max() < 1050.0
    assert 2000.0 < year.global_horizontal.sum() / 1000.0 < 2600.0
    summer = year.local_times.astype("datetime64[M]") == np.datetime64("2024-12")
    winter = year.local_times.astype("datetime64[M]") == np.datetime64("2024-06")
    assert year.global_horizontal[summer].sum() > 1.8 * year.global_horizontal[winter].sum()


def test_shorter_intervals_hold_the_same_energy():
    hourly, quarters = clear_weather(Site()), clear_weather(Site(), hours=0.25)
    for name in ("global_horizontal", "direct_normal", "diffuse_horizontal"):
        whole = np.sum(getattr(hourly, name))
        assert np.sum(getattr(quarters, name)) / 4.0 == pytest.approx(whole, rel=1e-3)


def test_more_turbid_air_gives_less_direct_and_more_diffuse_light():
    clean, dull = clear_weather(Site(), turbidity=2.0), clear_weather(Site(), turbidity=6.0)
    assert dull.direct_normal.sum() < 0.75 * clean.direct_normal.sum()
    assert dull.diffuse_horizontal.sum() > 1.5 * clean.diffuse_horizontal.sum()


def test_monthly_turbidity_counts_in_its_month_and_turns_over_the_equator():
    months = [2.0] * 6 + [6.0] + [2.0] * 5
    mixed, clean = clear_weather(Site(), turbidity=months), clear_weather(Site(), turbidity=2.0)
    july = mixed.local_times.astype("datetime64[M]") == np.datetime64("2019-07")
    assert np.array_equal(mixed.direct_normal[~july], clean.direct_normal[~july])
    assert mixed.direct_normal[july].sum() < 0.8 * clean.direct_normal[july].sum()
    south = Site(latitude=-42.3603)
    turned = clear_weather(south, turbidity=np.roll(MONTHLY_TURBIDITY, 6))
    assert np.array_equal(clear_weather(south).direct_normal, turned.direct_normal)


def test_a_sites_turbidity_is_that_of_its_months():
    air = clear_weather(Site(turbidity=4.5))
    assert np.array_equal(air.direct_normal, clear_weather(Site(), turbidity=4.5).direct_normal)
    assert air.source.endswith("turbidity 4.5")
    assert air.notes[-1] == "The air's Linke turbidity is 4.5, as it was set."
    (note,) = (note for note in clear_weather(Site()).notes if "Boston" in note)
    assert "Linke turbidity is Boston's, 2.45 to 3.95 by month" in note
    with pytest.raises(ParameterError, match="Linke turbidity"):
        clear_weather(Site(turbidity=0.5))


def test_polar_night_is_dark_and_polar_day_is_not():
    year = clear_weather(Site(latitude=78.2, longitude=15.6, utc_offset=1.0))
    month = year.local_times.astype("datetime64[M]")
    assert year.global_horizontal[month == np.datetime64("2019-12")].max() == 0.0
    assert year.global_horizontal[month == np.datetime64("2019-06")].min() > 0.0


@pytest.mark.parametrize("turbidity", [0.5, 30.0, float("nan"), [3.0] * 11])
def test_a_turbidity_that_no_air_has_is_refused(turbidity):
    with pytest.raises(ParameterError, match="Linke turbidity"):
        clear_weather(Site(), turbidity=turbidity)


@pytest.mark.parametrize("hours", [0.0, -1.0, 0.7, 5.0])
def test_intervals_that_make_up_no_day_are_refused(hours):
    with pytest.raises(ParameterError, match="do not make up a day"):
        clear_weather(Site(), hours=hours)
