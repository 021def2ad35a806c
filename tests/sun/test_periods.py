"""Which hours of a year a period holds."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.parameters import from_table, to_table
from heliform.engines.sun.degree_days import seasons
from heliform.engines.sun.periods import CoolingSeason, Period, period_text, season_notes, selected
from heliform.engines.sun.site import Site
from heliform.engines.sun.times import day_of_year, hour_of_day, hours_of_year, month_and_day
from heliform.engines.sun.turning import turning_points
from heliform.engines.sun.weather import Weather

BOSTON = Site()
HOURS = hours_of_year(2019, BOSTON)


def days_of(period: Period, times: np.ndarray = HOURS, site: Site = BOSTON) -> list[int]:
    """The ordinal dates that a period holds."""
    return np.unique(day_of_year(times[selected(times, period, site)], site)).tolist()


def weather_of(site: Site, times: np.ndarray, temperature: np.ndarray) -> Weather:
    zero = np.zeros(len(times))
    return Weather(
        site=site,
        year=2019,
        times=times.astype("datetime64[s]"),
        hours=zero + 1,
        global_horizontal=zero,
        direct_normal=zero,
        diffuse_horizontal=zero,
        temperature=temperature,
        dew_point=zero,
        pressure=zero + 101325,
        source="a sine",
    )


def test_the_year_holds_every_hour():
    assert selected(HOURS, Period(), BOSTON).all()


def test_boston_s_cooling_season_has_the_thesis_s_ordinal_dates():
    """25 April, 115, to 21 October, 294."""
    assert days_of(Period(span="cooling season")) == list(range(115, 295))


def test_heating_and_cooling_share_the_year_between_them():
    heating = selected(HOURS, Period(span="heating season"), BOSTON)
    cooling = selected(HOURS, Period(span="cooling season"), BOSTON)
    assert np.array_equal(heating, ~cooling)


def test_a_cooling_season_may_run_over_the_year_s_end():
    """As in the south."""
    southern = CoolingSeason(first_month=11, first_day=1, last_month=3, last_day=31)
    sydney = Site(latitude=-33.9, longitude=151.2, utc_offset=10.0)
    hours = hours_of_year(2019, sydney)
    summer = days_of(Period(span="cooling season", cooling=southern), hours, sydney)
    assert summer == [*range(1, 91), *range(305, 366)]
    winter = days_of(Period(span="heating season", cooling=southern), hours, sydney)
    assert winter == list(range(91, 305))


@pytest.mark.parametrize("span", ["cooling season", "heating season"])
def test_a_cooling_season_in_winter_is_refused(span):
    sydney = Site(latitude=-33.9, longitude=151.2, utc_offset=10.0)
    hours = hours_of_year(2019, sydney)
    with pytest.raises(ParameterError, match=r"is winter at 33\.90° S, 151\.20° E.*Degree days"):
        selected(hours, Period(span=span), sydney)
    all_year = CoolingSeason(first_month=1, first_day=1, last_month=12, last_day=31)
    one = Period(span="cooling season", cooling=all_year)
    assert selected(hours, one, sydney).all()
    assert selected(hours, Period(span="year"), sydney).all()


def test_boston_s_dates_are_said_elsewhere():
    cooling, helsinki = Period(span="cooling season"), Site(latitude=60.2, longitude=25.0)
    (note,) = season_notes(cooling, helsinki)
    assert "Boston's dates, 25 April to 21 October; set those of 60.20° N, 25.00° E" in note
    assert season_notes(replace(cooling, span="heating season"), Site(longitude=116.4))
    assert season_notes(cooling, Site(latitude=-5.0))
    for period, site in (
        (cooling, BOSTON),
        (cooling, Site(latitude=44.0, longitude=-77.0)),
        (replace(cooling, span="year"), helsinki),
        (replace(cooling, seasons="degree days"), helsinki),
        (replace(cooling, cooling=CoolingSeason(first_day=1)), helsinki),
    ):
        assert season_notes(period, site) == ()


def test_the_thesis_s_solstices():
    """Ordinal date 172, 20 June of a leap year, and 21 December."""
    leap = hours_of_year(2020, BOSTON)
    assert days_of(Period(span="summer solstice")) == [172]
    assert days_of(Period(span="summer solstice"), leap) == [172]
    held = leap[selected(leap, Period(span="summer solstice"), BOSTON)]
    assert [part[0] for part in month_and_day(held, BOSTON)] == [6, 20]
    for times in (HOURS, leap):
        held = times[selected(times, Period(span="winter solstice"), BOSTON)]
        assert [part[0] for part in month_and_day(held, BOSTON)] == [12, 21]
        assert len(held) == 24


def test_equinoxes_are_single_days():
    assert days_of(Period(span="spring equinox")) == [79]  # 20 March
    assert days_of(Period(span="autumn equinox")) == [266]  # 23 September


def test_the_southern_summer_solstice_is_in_december():
    sydney = Site(latitude=-33.87, longitude=151.21, utc_offset=10.0)
    times = hours_of_year(2019, sydney)
    assert days_of(Period(span="summer solstice"), times, sydney) == [356]  # 22 December there
    assert days_of(Period(span="winter solstice"), times, sydney) == [173]
    assert days_of(Period(span="spring equinox"), times, sydney) == [266]


@pytest.mark.parametrize(
    ("year", "published"),
    [
        (2000, ("03-20T07:35", "06-21T01:48", "09-22T17:28", "12-21T13:37")),
        (2019, ("03-20T21:58", "06-21T15:54", "09-23T07:50", "12-22T04:19")),
        (2020, ("03-20T03:50", "06-20T21:44", "09-22T13:31", "12-21T10:02")),
    ],
)
def test_the_year_turns_when_almanacs_say(year: int, published: tuple[str, ...]):
    """U.S. Naval Observatory, *Earth's Seasons*, to the minute."""
    printed = np.array([f"{year}-{time}" for time in published], "datetime64[s]")
    assert np.abs((turning_points(year) - printed) / np.timedelta64(1, "s")).max() < 60


def test_months_hold_their_days():
    assert days_of(Period(span="months", first_month=2, last_month=3)) == list(range(32, 91))
    winter = days_of(Period(span="months", first_month=12, last_month=2))
    assert winter == [*range(1, 60), *range(335, 366)]
    leap = hours_of_year(2024, BOSTON)
    assert len(days_of(Period(span="months", first_month=2, last_month=2), leap)) == 29


def test_dates_hold_their_first_and_last_day():
    dates = Period(span="dates", first_month=6, first_day=15, last_month=7, last_day=2)
    assert days_of(dates) == list(range(166, 184))
    over = Period(span="dates", first_month=12, first_day=30, last_month=1, last_day=2)
    assert days_of(over) == [1, 2, 364, 365]
    one = Period(span="dates", first_month=3, first_day=1, last_month=3, last_day=1)
    assert days_of(one) == [60]
    assert days_of(one, hours_of_year(2024, BOSTON)) == [61]


def test_the_29th_of_february_ends_a_range_in_any_year():
    february = Period(span="dates", first_month=2, first_day=1, last_month=2, last_day=29)
    assert len(days_of(february)) == 28
    assert len(days_of(february, hours_of_year(2024, BOSTON))) == 29


def test_hours_of_the_day_are_the_site_s():
    office = HOURS[selected(HOURS, Period(first_hour=8.0, last_hour=18.0), BOSTON)]
    assert len(office) == 3650
    hours = hour_of_day(office, BOSTON)
    assert (hours.min(), hours.max()) == (8.5, 17.5)
    half = hours_of_year(2019, Site(utc_offset=5.5))
    kept = half[selected(half, Period(first_hour=8.0, last_hour=9.0), Site(utc_offset=5.5))]
    assert str(kept[0].astype("datetime64[m]")) == "2019-01-01T03:00"


def test_hours_may_run_over_midnight():
    night = selected(HOURS, Period(first_hour=22.0, last_hour=6.0), BOSTON)
    day = selected(HOURS, Period(first_hour=6.0, last_hour=22.0), BOSTON)
    assert np.array_equal(night, ~day)


def test_quarters_of_an_hour_count_too():
    quarters = np.arange("2019-07-01T00:07", "2019-07-02", 15, dtype="datetime64[m]")
    site = Site(utc_offset=0.0)
    assert selected(quarters, Period(first_hour=9.0, last_hour=9.5), site).sum() == 2


def test_seasons_by_degree_days_are_the_weather_s():
    temperature = 10 - 12 * np.cos(2 * np.pi * (np.arange(8760) / 24 - 20) / 365)
    weather = weather_of(BOSTON, HOURS, temperature)
    cooling = Period(span="cooling season", seasons="degree days")
    heating = Period(span="heating season", seasons="degree days")
    mask = selected(weather, cooling, BOSTON)
    assert np.array_equal(mask, seasons(weather).cooling)
    assert np.array_equal(mask, ~selected(weather, heating, BOSTON))
    assert selected(weather, Period(span="summer solstice", seasons="degree days"), BOSTON).any()
    morning = selected(weather, replace(cooling, last_hour=12.0), BOSTON)
    assert 0 < morning.sum() < mask.sum()


def test_degree_days_need_a_weather():
    period = Period(span="heating season", seasons="degree days")
    with pytest.raises(ParameterError, match=r"need a weather's temperatures; read"):
        selected(HOURS, period, BOSTON)


def test_a_period_without_an_hour_is_said():
    january = HOURS[:744]
    expected = r"^The period “July” holds none of the 744 intervals; choose other days or hours\.$"
    with pytest.raises(ParameterError, match=expected):
        selected(january, Period(span="months", first_month=7, last_month=7), BOSTON)
    with pytest.raises(ParameterError, match="“year, 12 to 12 h”"):
        selected(HOURS, Period(first_hour=12.0, last_hour=12.0), BOSTON)
    with pytest.raises(ParameterError, match="holds none of the 0 intervals"):
        selected(HOURS[:0], Period(), BOSTON)


def test_a_day_that_no_month_has_is_refused():
    with pytest.raises(ParameterError, match=r"^June has 30 days and no day 31; choose a date"):
        selected(HOURS, Period(span="dates", last_month=6, last_day=31), BOSTON)
    with pytest.raises(ParameterError, match=r"\[period\.cooling\] first_month = 13"):
        selected(HOURS, Period(cooling=CoolingSeason(first_month=13)), BOSTON)
    with pytest.raises(ParameterError, match="last_hour = 25"):
        selected(HOURS, Period(last_hour=25.0), BOSTON)


def test_times_out_of_order_are_refused():
    with pytest.raises(ParameterError, match="is not after time"):
        selected(HOURS[::-1], Period(), BOSTON)


def test_a_period_reads_as_a_person_says_it():
    season = "25 April to 21 October"
    assert period_text(Period()) == "year"
    office = Period(span="cooling season", first_hour=8.0, last_hour=18.0)
    assert period_text(office) == f"cooling season, {season}, 8 to 18 h"
    assert period_text(Period(span="heating season")) == f"heating season, all but {season}"
    assert period_text(Period(span="heating season", seasons="degree days")) == (
        "heating season, by degree days"
    )
    assert (
        period_text(Period(span="months", first_month=12, last_month=2)) == "December to February"
    )
    assert period_text(Period(span="dates")) == "1 January to 31 December"
    assert period_text(Period(span="summer solstice")) == "summer solstice"


def test_a_period_is_written_and_read_back():
    period = Period(span="cooling season", cooling=CoolingSeason(first_day=1), first_hour=7.5)
    assert from_table(Period, to_table(period), "period") == period
