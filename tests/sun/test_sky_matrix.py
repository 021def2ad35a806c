"""The year's sky on patches: what comes out is what the weather put in."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.sun.cie_sky import cie_sky
from heliform.engines.sun.hourly import hourly_skies
from heliform.engines.sun.luminance import luminance
from heliform.engines.sun.patches import patch_at, patches_of
from heliform.engines.sun.position import sun_position
from heliform.engines.sun.site import Site
from heliform.engines.sun.sky_matrix import (
    cumulative,
    ground_radiance,
    matrix_blocks,
    on_patches,
    sky_matrix,
)
from heliform.engines.sun.weather import Weather

DAYS = ("2019-01-15", "2019-03-21", "2019-06-21", "2019-10-05")


def some_days(site=None, step=3600) -> Weather:
    """Four days, two fair and two overcast, in intervals of ``step`` seconds."""
    site = site or Site()
    count = 86400 // step
    starts = np.array(DAYS, "datetime64[s]") - np.timedelta64(round(3600 * site.utc_offset), "s")
    times = (starts[:, None] + np.timedelta64(step, "s") * np.arange(count)).ravel()
    times = times + np.timedelta64(step // 2, "s")
    sine = np.sin(np.radians(sun_position(times, site).altitude))
    fair = np.repeat([1.0, 0.0, 1.0, 0.0], count)
    up = np.maximum(sine, 0)
    direct = 900 * fair * (sine > 0) * up**0.3
    diffuse = np.where(sine > -0.05, 10 + 90 * fair * up + 220 * (1 - fair) * up, 0.0)
    unknown = np.full(len(times), np.nan)
    return Weather(
        site=site,
        year=2019,
        times=times,
        hours=np.full(len(times), step / 3600),
        global_horizontal=diffuse + direct * up,
        direct_normal=direct,
        diffuse_horizontal=diffuse,
        temperature=unknown,
        dew_point=unknown,
        pressure=unknown,
        source="four days",
    )


WEATHER = some_days()


@pytest.mark.parametrize("subdivision", [1, 2, 4])
@pytest.mark.parametrize("quantity", ["radiation", "light"])
def test_the_patches_together_give_the_diffuse_light(subdivision, quantity):
    patches = patches_of(subdivision)
    hourly = hourly_skies(WEATHER, WEATHER.site, quantity)
    matrix = sky_matrix(WEATHER, WEATHER.site, subdivision, quantity=quantity, direct="none")
    assert matrix.shape == (len(patches.solid_angles), len(WEATHER.times))
    projected = patches.solid_angles * patches.directions[:, 2]
    assert projected @ matrix == pytest.approx(hourly.diffuse, rel=1e-12)


@pytest.mark.parametrize("subdivision", [1, 2, 4])
def test_the_sun_is_kept_on_four_patches_that_are_next_to_it(subdivision):
    patches = patches_of(subdivision)
    beam = sky_matrix(WEATHER, WEATHER.site, subdivision) - sky_matrix(
        WEATHER, WEATHER.site, subdivision, direct="none"
    )
    up = WEATHER.direct_normal > 0
    assert patches.solid_angles @ beam == pytest.approx(WEATHER.direct_normal, rel=1e-9, abs=1e-9)
    lit = beam > 1e-9 * WEATHER.direct_normal.max()
    assert (lit.sum(axis=0) == np.where(up, 4, 0)).all()
    sun = sun_position(WEATHER.times, WEATHER.site).direction
    reach = np.degrees(np.arccos((patches.directions @ sun.T)[lit]))
    assert reach.max() < 24 / subdivision
    own = patch_at(sun[up], subdivision)
    assert lit[own, np.flatnonzero(up)].mean() > 0.99


@pytest.mark.parametrize("subdivision", [1, 2, 4])
def test_a_standard_sky_on_patches_is_the_sky_at_their_centres(subdivision):
    patches = patches_of(subdivision)
    skies = cie_sky(12, 130.0, [25.0, 55.0])
    found = on_patches(skies, 10_000.0, patches)
    assert (patches.solid_angles * patches.directions[:, 2]) @ found == pytest.approx(10_000)
    ratio = found / luminance(skies, patches.directions, 10_000.0)
    assert np.ptp(ratio, axis=0) == pytest.approx(0, abs=1e-12)
    assert ratio == pytest.approx(1, abs=0.05 / subdivision**2)


def test_light_is_radiation_times_an_efficacy_of_daylight():
    radiation, light = (
        sky_matrix(WEATHER, WEATHER.site, 1, quantity=quantity, direct="none").sum(axis=0)
        for quantity in ("radiation", "light")
    )
    efficacy = light[radiation > 0] / radiation[radiation > 0]
    assert efficacy.min() > 90
    assert efficacy.max() < 190


def test_a_period_is_the_sum_of_its_intervals():
    half = some_days(step=1800)
    summer = half.times > np.datetime64("2019-05-01")
    for quantity in ("radiation", "light"):
        matrix = sky_matrix(half, half.site, 2, quantity=quantity)
        whole = cumulative(half, half.site, 2, quantity=quantity)
        part = cumulative(half, half.site, 2, summer, quantity=quantity)
        assert whole == pytest.approx(matrix.sum(axis=1) * 0.5 / 1000, rel=1e-12)
        assert part == pytest.approx(matrix[:, summer].sum(axis=1) * 0.5 / 1000, rel=1e-12)
    patches = patches_of(2)
    sky = cumulative(half, half.site, 2, direct="none")
    energy = half.diffuse_horizontal.sum() * 0.5 / 1000
    assert sky @ (patches.solid_angles * patches.directions[:, 2]) == pytest.approx(energy)


def test_an_empty_period_and_a_polar_night_are_black():
    nothing = np.zeros(len(WEATHER.times), bool)
    assert not cumulative(WEATHER, WEATHER.site, 1, nothing).any()
    north = replace(
        WEATHER,
        times=np.datetime64("2019-12-21", "s") + WEATHER.hours.cumsum().astype("timedelta64[h]"),
        direct_normal=0 * WEATHER.hours,
        diffuse_horizontal=0 * WEATHER.hours,
    )
    assert not sky_matrix(north, Site(latitude=80.0), 1).any()


def test_level_ground_reflects_what_falls_on_it():
    hourly = hourly_skies(WEATHER, WEATHER.site)
    assert ground_radiance(hourly, 0.3) * np.pi / 0.3 == pytest.approx(
        WEATHER.global_horizontal, rel=2e-2, abs=2.0
    )
    assert not ground_radiance(hourly, 0.0).any()
    with pytest.raises(ParameterError, match="share of 0 to 1"):
        ground_radiance(hourly, 1.2)


def test_east_is_brighter_in_the_morning_and_west_in_the_evening():
    patches = patches_of(2)
    matrix = sky_matrix(WEATHER, WEATHER.site, 2)
    fair = WEATHER.direct_normal > 0
    hour = (WEATHER.local_times - WEATHER.local_times.astype("datetime64[D]")).astype(float) / 3600
    lean = (patches.solid_angles * patches.directions[:, 0]) @ matrix
    assert (lean[fair & (hour < 11)] > 0).all()
    assert (lean[fair & (hour > 13)] < 0).all()


def test_a_long_time_is_summed_in_little_memory():
    long = some_days(step=60)
    patches = patches_of(4)
    assert len(long.times) * len(patches.solid_angles) * 8 > 100e6
    hourly = hourly_skies(long, long.site)
    tracemalloc.start()
    for _, block in matrix_blocks(hourly, patches):
        assert block.nbytes < 8e6
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 40e6


def test_direct_light_of_a_sun_that_is_down_is_left_out_and_said():
    weather = replace(WEATHER, direct_normal=np.full(len(WEATHER.times), 100.0))
    hourly = hourly_skies(weather, weather.site)
    down = sun_position(weather.times, weather.site).apparent_altitude <= 0
    assert (hourly.direct == np.where(down, 0.0, 100.0)).all()
    energy = down.sum() * 0.1
    assert f"{down.sum()} intervals with direct light: {energy:.3g} kWh/m²" in hourly.notes[0]


def test_daylight_at_night_is_noticed():
    assert not hourly_skies(WEATHER, WEATHER.site).notes
    wrong = hourly_skies(WEATHER, Site(longitude=108.9125)).notes
    assert any("check the latitude, longitude and UTC offset" in note for note in wrong)


def test_only_the_chosen_intervals_are_spoken_of():
    weather = replace(WEATHER, direct_normal=np.full(len(WEATHER.times), 100.0))
    up = sun_position(weather.times, weather.site).apparent_altitude > 0
    assert not hourly_skies(weather, weather.site, selected=up).notes
    night = hourly_skies(WEATHER, WEATHER.site, selected=~up).notes
    assert night == ("The sun is never above the horizon in the period: it gives no direct light.",)
    last = up & (np.cumsum(up) == up.sum())
    (note,) = hourly_skies(weather, weather.site, selected=~up | last).notes
    assert note.startswith(f"The sun is below the horizon in the middle of {(~up).sum()} intervals")


def test_an_unknown_dew_point_is_noticed_where_it_counts():
    assert any("no dew point" in note for note in hourly_skies(WEATHER, Site(), "light").notes)
    known = replace(WEATHER, dew_point=np.full(len(WEATHER.times), 11.0))
    assert not hourly_skies(known, Site(), "light").notes
    same = (sky_matrix(w, Site(), 1, quantity="light") for w in (WEATHER, known))
    assert np.array_equal(*same)


@pytest.mark.parametrize(
    ("change", "arguments", "said"),
    [
        (
            {"diffuse_horizontal": np.nan},
            {},
            "Interval 30 has a diffuse horizontal irradiance of nan",
        ),
        ({"direct_normal": -5.0}, {}, "Interval 30 has a direct normal irradiance of -5 W"),
        ({}, {"quantity": "heat"}, "“radiation” or of “light”, not of “heat”"),
        ({}, {"direct": "suns"}, "“patches” or to “none”, not to “suns”"),
        ({}, {"subdivision": 5}, "divided by 1, 2, 3 or 4"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(change, arguments, said):
    columns = {name: getattr(WEATHER, name).copy() for name in change}
    for name, value in change.items():
        columns[name][30] = value
    with pytest.raises(ParameterError, match=said):
        sky_matrix(replace(WEATHER, **columns), WEATHER.site, **({"subdivision": 1} | arguments))


def test_a_matrix_that_no_machine_holds_is_refused():
    minutes = np.datetime64("2019-01-01", "s") + np.timedelta64(60, "s") * np.arange(525600)
    nothing = np.zeros(len(minutes))
    columns = ("direct_normal", "diffuse_horizontal", "global_horizontal", "hours")
    year = replace(WEATHER, times=minutes, **dict.fromkeys(columns, nothing))
    with pytest.raises(ParameterError, match="2,305 patches in 525,600 intervals is too large"):
        sky_matrix(year, WEATHER.site, 4)
