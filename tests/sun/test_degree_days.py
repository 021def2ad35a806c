"""Degree days and seasons of years whose temperatures are known."""

import dataclasses

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.degree_days import (
    cooling_degree_days,
    heating_degree_days,
    seasons,
)
from heliform.engines.sun.site import Site

BOSTON = (29.9, 31.8, 38.3, 48.6, 58.4, 68.0, 74.1, 72.7, 65.6, 54.8, 44.7, 35.7)
"""Monthly normals at Logan Airport, 1991 to 2020 [NOAA], in °F."""


@pytest.fixture(scope="module")
def clear():
    return clear_weather(Site())


def with_temperature(weather, temperature):
    return dataclasses.replace(weather, temperature=np.asarray(temperature, float))


def day_of(weather):
    first = np.datetime64(f"{weather.year}-01-01")
    return (weather.local_times - first) / np.timedelta64(1, "D")


def wave(weather, mean, swing, warmest=201.0):
    day = day_of(weather)
    daily = -4.0 * np.cos(2.0 * np.pi * day)
    return mean + swing * np.cos(2.0 * np.pi * (day - warmest) / 365.0) + daily


def boston(weather):
    middles = np.cumsum([0, 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30]) + 15.0
    celsius = (np.array(BOSTON) - 32.0) / 1.8
    return np.interp(day_of(weather), middles, celsius, period=365.0)


def test_degree_days_of_a_steady_year(clear):
    year = with_temperature(clear, np.full(8760, 5.0))
    assert heating_degree_days(year).sum() == pytest.approx(365 * 13.3)
    assert cooling_degree_days(year).sum() == 0.0
    year = with_temperature(clear, np.full(8760, 25.0))
    assert heating_degree_days(year).sum() == 0.0
    assert cooling_degree_days(year).sum() == pytest.approx(365 * 15.0)


def test_a_days_mean_counts_not_its_hours(clear):
    swinging = 18.3 + 10.0 * np.sin(2.0 * np.pi * day_of(clear))
    assert heating_degree_days(with_temperature(clear, swinging)).sum() < 1e-6


def test_degree_days_of_boston_are_the_published_ones(clear):
    spread = np.repeat(np.random.default_rng(2).normal(0.0, 4.0, 365), 24)
    year = with_temperature(clear, boston(clear) + spread)
    # 5,544 °F-days below 65 °F by the same normals [National Weather Service, Boston].
    assert heating_degree_days(year).sum() == pytest.approx(5544 / 1.8, rel=0.03)


def test_the_cooling_season_is_where_a_wave_crosses_the_limit(clear):
    year = with_temperature(clear, wave(clear, 10.0, 12.0))
    found = seasons(year)
    half = np.degrees(np.arccos((12.0 - 10.0) / 12.0)) / 360.0 * 365.0
    first = np.datetime64("2019-01-01")
    assert abs((found.cooling_begin - first).astype(int) - (201.0 - half)) <= 1.0
    assert abs((found.cooling_end - first).astype(int) - (201.0 + half)) <= 1.0


def test_in_boston_it_is_within_a_week_of_the_thesiss_dates(clear):
    found = seasons(with_temperature(clear, boston(clear)))
    assert found.cooling_begin == np.datetime64("2019-05-01")
    assert found.cooling_end == np.datetime64("2019-10-19")
    assert abs((found.cooling_begin - np.datetime64("2019-04-25")).astype(int)) <= 7
    assert abs((found.cooling_end - np.datetime64("2019-10-21")).astype(int)) <= 7


def test_masks_share_the_year_and_follow_the_dates(clear):
    found = seasons(with_temperature(clear, wave(clear, 10.0, 12.0)))
    assert np.array_equal(found.heating, ~found.cooling)
    days = clear.local_times.astype("datetime64[D]")
    between = (days >= found.cooling_begin) & (days <= found.cooling_end)
    assert np.array_equal(found.cooling, between)
    assert found.cooling.sum() % 24 == 0


def test_south_of_the_equator_it_spans_the_new_year(clear):
    found = seasons(with_temperature(clear, wave(clear, 14.0, 8.0, warmest=18.0)))
    assert found.cooling_begin > found.cooling_end
    assert found.cooling[:24].all()
    assert found.cooling[-24:].all()
    assert not found.cooling[180 * 24]


def test_a_warm_week_in_winter_and_a_cold_one_in_summer_move_nothing(clear):
    plain = wave(clear, 10.0, 12.0)
    odd = plain.copy()
    odd[24 * 30 : 24 * 37] += 20.0
    odd[24 * 190 : 24 * 197] -= 15.0
    before, after = (seasons(with_temperature(clear, t)) for t in (plain, odd))
    assert np.array_equal(before.cooling, after.cooling)


def test_noise_of_days_moves_the_dates_by_days_only(clear):
    plain = wave(clear, 10.0, 12.0)
    noise = np.repeat(np.random.default_rng(1).normal(0.0, 4.0, 365), 24)
    before, after = (seasons(with_temperature(clear, t)) for t in (plain, plain + noise))
    assert abs((before.cooling_begin - after.cooling_begin).astype(int)) <= 14
    assert abs((before.cooling_end - after.cooling_end).astype(int)) <= 14


@pytest.mark.parametrize(("mean", "cooling"), [(27.0, True), (-20.0, False)])
def test_where_all_year_is_one_season_it_has_no_dates(clear, mean, cooling):
    found = seasons(with_temperature(clear, wave(clear, mean, 3.0)))
    assert np.all(found.cooling == cooling)
    assert found.cooling_begin is None
    assert found.cooling_end is None


def test_days_without_a_temperature_are_bridged(clear):
    plain = wave(clear, 10.0, 12.0)
    holes = plain.copy()
    holes[24 * 100 : 24 * 105] = np.nan
    before, after = (seasons(with_temperature(clear, t)) for t in (plain, holes))
    assert abs((before.cooling_begin - after.cooling_begin).astype(int)) <= 1


def test_weather_without_temperatures_is_refused(clear):
    with pytest.raises(ParameterError, match="holds no temperatures"):
        seasons(clear)
