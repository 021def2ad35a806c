"""Daylight metrics on series of hours that are counted by hand."""

import numpy as np
import pytest
from heliform.engines.core.scene import Material
from heliform.engines.sun import blinds, en17037, metrics
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.daylight import WorkingHours
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.periods import selected
from heliform.engines.sun.position import sun_times
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.site import Site
from heliform.engines.sun.times import hour_of_day, moment
from sun.shades import box, level

BOSTON = Site()


def series(*rows):
    return np.array(rows, np.float32)


def test_autonomy_counts_the_hours_that_reach_the_target_itself():
    light = series([299.9, 300.0, 300.1, 1000.0], [0, 0, 0, 300])
    hours = np.array([1.0, 1.0, 1.0, 2.0])
    assert metrics.autonomy(light, hours) == pytest.approx([4 / 5, 2 / 5])
    assert metrics.autonomy(light, hours, 1000) == pytest.approx([2 / 5, 0])


def test_hours_outside_the_schedule_do_not_count_and_dark_ones_do():
    light = series([500.0, 0.0, 500.0, 0.0])
    assert metrics.autonomy(light, np.array([1.0, 1, 0, 0])) == pytest.approx(0.5)
    assert metrics.autonomy(light, np.array([0.0, 1, 0, 1])) == pytest.approx(0)
    assert metrics.mean_light(light, np.array([1.0, 1, 0, 0])) == pytest.approx(250)


def test_continuous_autonomy_gives_part_for_part():
    light = series([150.0, 300.0, 600.0, 0.0])
    assert metrics.continuous_autonomy(light, np.ones(4)) == pytest.approx(2.5 / 4)


def test_useful_illuminance_parts_the_hours_at_its_limits():
    light = series([99.9, 100.0, 299.9, 300.0, 3000.0, 3000.5, 0.0, 5000.0])
    dark, dim, bright, glaring = metrics.useful(light, np.ones(8))
    assert (dark[0] * 8, dim[0] * 8, bright[0] * 8, glaring[0] * 8) == pytest.approx((2, 2, 2, 2))


def test_hours_of_sun_are_those_with_more_than_the_limit():
    direct = series([1000.0, 1000.1, 5000.0, 0.0])
    assert metrics.hours_above(direct, np.array([1, 0.5, 0.25, 1])) == pytest.approx(0.75)


def test_sda_takes_half_of_the_hours_and_ase_more_than_250():
    areas = np.array([1.0, 2.0, 3.0, 4.0])
    half = 1825 / 3650
    assert metrics.spatial_autonomy(np.array([half, half - 1e-3, 1, 0]), areas) == pytest.approx(
        0.4
    )
    sunny = np.array([250.0, 250.5, 4000, 0])
    assert metrics.sunlight_exposure(sunny, areas) == pytest.approx(0.5)


@pytest.mark.parametrize("per_hour", [1, 2, 4, 6, 12, 60])
def test_a_tie_is_a_tie_however_long_the_intervals_are(per_hour):
    # Half of the working hours reach the target, and 250 h have the sun, to the interval.
    count = 3650 * per_hour
    hours = np.full(count, 1 / per_hour)
    at = np.arange(count)
    light = np.where(at % 2 == 0, 300, 0).astype(np.float32)[None]
    direct = np.where(at < 250 * per_hour, 2000, 0).astype(np.float32)[None]
    area = np.ones(1)
    assert metrics.spatial_autonomy(metrics.autonomy(light, hours), area) == 1
    assert metrics.sunlight_exposure(metrics.hours_above(direct, hours), area) == 0
    direct[0, 250 * per_hour] = 2000
    assert metrics.sunlight_exposure(metrics.hours_above(direct, hours), area) == 1


def test_sensors_without_area_count_alike():
    assert metrics.area_share(np.array([True, False, False, False]), np.zeros(4)) == 0.25


@pytest.mark.parametrize(("year", "days"), [(2019, 365), (2020, 366)])
def test_a_year_of_working_hours_has_ten_a_day(year, days):
    weather = clear_weather(BOSTON, year)
    chosen = selected(weather, WorkingHours(), BOSTON)
    assert weather.hours[chosen].sum() == 10 * days
    clock = hour_of_day(weather.times[chosen], BOSTON)
    assert (clock.min(), clock.max()) == (8.5, 17.5)


@pytest.mark.parametrize("count", [3650, 3660])
def test_half_of_a_year_s_working_hours_is_enough(count):
    light = np.zeros((2, count), np.float32)
    light[0, : count // 2] = 300
    light[1, : count // 2 - 1] = 300
    reached = metrics.autonomy(light, np.ones(count))
    assert metrics.spatial_autonomy(reached, np.ones(2)) == 0.5


def test_quarter_hours_come_to_the_same_as_hours():
    random = np.random.default_rng(0)
    light = random.uniform(0, 6000, (5, 300)).astype(np.float32)
    fine, hours, quarters = np.repeat(light, 4, axis=1), np.ones(300), np.full(1200, 0.25)
    for measure in (metrics.autonomy, metrics.continuous_autonomy, metrics.mean_light):
        assert measure(fine, quarters) == pytest.approx(measure(light, hours), rel=1e-6)


def share_of_hours(*illuminances):
    """Sensors (N, 4) that have so many lx in exactly half of the daylight hours."""
    return np.array(
        [[0.5 if lx >= limit else 0.49 for limit in en17037.LIMITS] for lx in illuminances]
    )


@pytest.mark.parametrize(
    ("lights", "level"),
    [
        ([300, 300, 100, 100], 1),
        ([300, 300, 100, 99], 0),
        ([300, 299, 299, 299], 0),
        ([500, 500, 300, 300], 2),
        ([500, 500, 300, 299], 1),
        ([750, 750, 500, 500], 3),
        ([2000, 2000, 2000, 2000], 3),
        ([750, 750, 750, 99], 0),
    ],
)
def test_provision_needs_both_illuminances_of_a_level(lights, level):
    found = en17037.provision(share_of_hours(*lights), np.ones(4))
    assert found.level == level


def test_provision_goes_by_area_and_allows_five_hundredths_of_it():
    areas = np.array([50.0, 45.0, 5.0])
    assert en17037.provision(share_of_hours(300, 100, 0), areas).level == 1
    assert en17037.provision(share_of_hours(300, 100, 0), np.array([50.0, 44.9, 5.1])).level == 0


def test_sunlight_levels_are_at_one_and_a_half_three_and_four_hours():
    levels = [en17037.sunlight_level(h) for h in (0, 1.49, 1.5, 2.99, 3, 3.99, 4, 12)]
    assert levels == [0, 0, 1, 1, 2, 2, 3, 3]


def test_an_open_field_has_sun_from_sunrise_to_sunset():
    sensors = at_points([[0, 0, 0]], [[0, 0, 1]])
    found = en17037.sunlight_hours(Occluders(()), sensors, BOSTON, (2019, 3, 21), 0.0)
    times = sun_times(moment(2019, 3, 21, 12.0, BOSTON), BOSTON)
    day = (times.sunset - times.sunrise).astype("timedelta64[s]").astype(float)[0] / 3600
    assert found[0] == pytest.approx(day, abs=0.17)


def test_sun_too_low_or_behind_a_building_does_not_count():
    sensors = at_points([[0, 0, 0], [0, 0, 0]], [[0, 0, 1], [1.0, 0, 0]])
    open_, east = en17037.sunlight_hours(Occluders(()), sensors, BOSTON, (2019, 3, 21), 0.0)
    # East of it the sun stands until noon.
    assert east == pytest.approx(open_ / 2, abs=0.15)
    high = en17037.sunlight_hours(Occluders(()), sensors, BOSTON, (2019, 3, 21), 20.0)
    # On the equinox the sun climbs to 20° in arcsin(sin 20° / cos 42.36°) / 15 hours.
    lost = np.degrees(np.arcsin(np.sin(np.radians(20)) / np.cos(np.radians(42.36)))) / 15
    assert high[0] == pytest.approx(12 - 2 * lost, abs=0.2)
    wall = box("wall", [100, 1, 1000], [0, -2, 500])
    hidden = en17037.sunlight_hours(Occluders((wall,)), sensors, BOSTON, (2019, 12, 21), 0.0)
    assert hidden[0] < 0.5


def test_sun_through_a_pane_counts_as_sun():
    sensors = at_points([[0, 0, 0]], [[0, 0, 1]])
    pane = level("pane", 1e3, 1e3, 1.0, Material(kind="dielectric", ior=1.5))
    day = (2019, 3, 21)
    bare, glazed = (
        en17037.sunlight_hours(Occluders(bodies), sensors, BOSTON, day, 5.0)[0]
        for bodies in ((), (pane,))
    )
    assert glazed == bare > 10


def test_blinds_close_beyond_two_hundredths_of_the_area():
    areas = np.full(100, 0.01)
    direct = np.zeros((100, 4), np.float32)
    direct[:2, 0] = 1500
    direct[:3, 1] = 1500
    direct[:50, 2] = 1000
    assert blinds.closed(blinds.sunny_area(direct, areas)).tolist() == [False, True, False, False]
