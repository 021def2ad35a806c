"""True suns, and the few that stand for them: nothing lost, and little wrong in the shade."""

from collections.abc import Callable

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.sun.position import SunPosition, sun_position
from heliform.engines.sun.site import Site
from heliform.engines.sun.suns import merged_suns, true_suns
from heliform.engines.sun.times import hours_of_year
from heliform.engines.sun.weather import Weather

type Seen = Callable[[np.ndarray], np.ndarray]
"""From directions (D, 3) to whether the sun is seen there (D,)."""

BOSTON = Site()
PLACES = {
    "Boston": BOSTON,
    "Singapore": Site(latitude=1.3, longitude=103.8, utc_offset=8.0),
    "Sydney": Site(latitude=-33.87, longitude=151.21, utc_offset=10.0),
    "Oslo": Site(latitude=59.9, longitude=10.7, utc_offset=1.0),
}


def year_of(site: Site, year: int = 2019) -> tuple[SunPosition, np.ndarray]:
    """A year's suns, and the direct normal irradiance in W/m² of a clear sky [Meinel 1976]."""
    sun = sun_position(hours_of_year(year, site), site)
    sine = np.maximum(sun.direction[:, 2], 0.02)
    return sun, np.where(sun.direction[:, 2] > 0, 1353 * 0.7 ** (sine**-0.678), 0.0)


def wall(azimuth: float, distance: float, height: float = 3.0) -> Seen:
    """A wall without end at a distance from the sensor, to the sides and downward."""
    turn = np.radians(azimuth)
    toward = np.array([np.sin(turn), np.cos(turn), 0.0])
    return lambda d: d[:, 2] * distance > height * (d @ toward)


def slats(azimuth: float, shift: float) -> Seen:
    """Thin vertical slats without end, 0.3 m apart and 0.3 m high, 0.3 m above the sensor."""
    turn = np.radians(azimuth)
    across = np.array([np.sin(turn), np.cos(turn), 0.0])

    def seen(d: np.ndarray) -> np.ndarray:
        slope = (d @ across) / d[:, 2]
        low, high = (np.floor((shift + z * slope) / 0.3) for z in (0.3, 0.6))
        return low == high

    return seen


def errors(site: Site, accuracy: float, shades: list[Seen]) -> tuple[np.ndarray, np.ndarray]:
    """How wrong merged suns make a horizontal sensor's yearly irradiation under each shade.

    The first as a share of the irradiation without shade, the second of the shaded.
    """
    sun, light = year_of(site)
    true, merged = (
        true_suns(hours_of_year(2019, site), site),
        merged_suns(sun.direction, light, accuracy),
    )
    sums = []
    for suns in (true, merged):
        flux = (suns.weights @ light) * suns.directions[:, 2]
        sums.append([flux[seen(suns.directions)].sum() for seen in shades])
        total = flux.sum()
    wrong = np.abs(np.diff(sums, axis=0)[0])
    return wrong / total, wrong / np.array(sums[0])


def test_true_suns_are_those_above_the_horizon():
    sun, light = year_of(BOSTON)
    suns = true_suns(hours_of_year(2019, BOSTON), BOSTON)
    up = sun.direction[:, 2] > 0
    assert suns.accuracy == 0
    assert np.array_equal((suns.weights.T @ suns.directions)[up], sun.direction[up])
    assert np.array_equal(suns.weights.T @ (suns.weights @ light), np.where(up, light, 0))
    assert 4380 < len(suns.directions) < 4500


@pytest.mark.parametrize("accuracy", [0.0, 1.0])
def test_suns_that_follow_each_other_are_near(accuracy: float):
    sun, light = year_of(BOSTON)
    suns = merged_suns(sun.direction, light, accuracy).directions
    apart = np.linalg.norm(np.diff(suns, axis=0), axis=1)
    by_chance = np.linalg.norm(np.diff(np.random.default_rng(0).permutation(suns), axis=0), axis=1)
    assert np.mean(apart) < 0.1 * np.mean(by_chance)


def test_a_weather_s_air_bends_its_suns():
    times = hours_of_year(2019, BOSTON)
    full = np.ones(len(times))
    air = {"temperature": full * -30, "dew_point": full * -40, "pressure": full * 104000}
    flat = dict.fromkeys(("hours", "global_horizontal", "direct_normal"), full)
    weather = Weather(
        site=BOSTON, year=2019, times=times, diffuse_horizontal=full, source="-", **flat, **air
    )
    cold, mild = true_suns(weather, BOSTON), true_suns(times, BOSTON)
    days = weather.times[np.flatnonzero(mild.weights.sum(axis=0))]
    assert len(cold.directions) >= len(mild.directions)
    both = (cold.weights @ mild.weights.T).tocoo()
    lift = cold.directions[both.row, 2] - mild.directions[both.col, 2]
    assert len(days) == len(lift)
    assert (lift > 0).all()


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("accuracy", [1.0, 2.0])
def test_no_sun_is_farther_than_the_accuracy_from_the_one_that_stands_for_it(
    place: str, accuracy: float
):
    sun, light = year_of(PLACES[place])
    merged = merged_suns(sun.direction, light, accuracy)
    shares = merged.weights.tocoo()
    cosine = np.einsum("ij,ij->i", merged.directions[shares.row], sun.direction[shares.col])
    farthest = np.degrees(np.arccos(np.clip(cosine, -1, 1))).max()
    assert farthest <= accuracy + 1e-6
    assert np.degrees(merged.accuracy) == pytest.approx(farthest, abs=1e-5)
    assert np.linalg.norm(merged.directions, axis=1) == pytest.approx(1)
    assert (merged.directions[:, 2] > 0).all()


@pytest.mark.parametrize("place", PLACES)
def test_a_year_needs_about_three_hundred_suns_at_two_degrees(place: str):
    sun, light = year_of(PLACES[place])
    assert 250 < len(merged_suns(sun.direction, light, 2.0).directions) < 320


@pytest.mark.parametrize("accuracy", [0.0, 1.0, 2.0, 5.0])
def test_every_interval_s_light_is_kept(accuracy: float):
    sun, light = year_of(BOSTON)
    merged = merged_suns(sun.direction, light, accuracy)
    up = sun.direction[:, 2] > 0
    assert merged.weights.shape == (len(merged.directions), len(light))
    assert np.array_equal(merged.weights.sum(axis=0), up.astype(float))
    assert (merged.weights @ light).sum() == pytest.approx(light.sum())
    open_sky = (merged.weights @ light) @ merged.directions
    truth = light @ np.where(up[:, None], sun.direction, 0.0)
    assert np.linalg.norm(open_sky - truth) < 1e-3 * np.linalg.norm(truth) * max(accuracy, 1e-9)


@pytest.mark.parametrize("place", PLACES)
def test_a_shaded_year_of_merged_suns_is_within_two_per_cent(place: str):
    """Of true suns, under half-infinite walls and under slats, of any orientation."""
    rng = np.random.default_rng(11)
    walls = [wall(rng.uniform(0, 360), rng.uniform(0.5, 12)) for _ in range(150)]
    grids = [slats(rng.uniform(0, 360), rng.uniform(0, 0.3)) for _ in range(150)]
    of_open, of_shaded = errors(PLACES[place], 2.0, walls + grids)
    assert of_shaded.mean() < 0.02
    assert of_open.mean() < 0.006
    assert np.quantile(of_open, 0.95) < 0.02


def test_finer_suns_err_less():
    rng = np.random.default_rng(12)
    grids = [slats(rng.uniform(0, 360), rng.uniform(0, 0.3)) for _ in range(100)]
    means = [errors(BOSTON, accuracy, grids)[0].mean() for accuracy in (4.0, 2.0, 1.0)]
    assert means[0] > 1.5 * means[1] > 2.2 * means[2]
    assert errors(BOSTON, 0.0, grids)[0].max() < 1e-12


def test_at_the_pole_the_suns_stand_in_rings():
    pole = Site(latitude=90.0, longitude=0.0, utc_offset=0.0)
    sun, light = year_of(pole)
    merged = merged_suns(sun.direction, light, 2.0)
    azimuth = np.degrees(np.arctan2(merged.directions[:, 0], merged.directions[:, 1])) % 360
    assert len(merged.directions) > 200
    assert np.diff(np.sort(azimuth), append=360 + azimuth.min()).max() < 15
    assert np.degrees(np.arcsin(merged.directions[:, 2])).max() < 23.5


def test_polar_night_has_no_suns():
    pole = Site(latitude=90.0, longitude=0.0, utc_offset=0.0)
    january = hours_of_year(2019, pole)[:744]
    suns = true_suns(january, pole)
    assert suns.directions.shape == (0, 3)
    assert (suns.weights @ np.ones(744)).shape == (0,)
    sun = sun_position(january, pole)
    merged = merged_suns(sun.direction, np.ones(744), 2.0)
    assert merged.directions.shape == (0, 3)
    assert merged.weights.shape == (0, 744)
    assert merged.accuracy == 0


def test_suns_without_light_have_a_place_too():
    sun, _ = year_of(BOSTON)
    merged = merged_suns(sun.direction, np.zeros(8760), 2.0)
    assert np.array_equal(merged.weights.sum(axis=0) > 0, sun.direction[:, 2] > 0)


def test_one_sun_stays_where_it_is():
    direction = np.array([[0.6, 0.0, 0.8]])
    merged = merged_suns(direction, np.array([5.0]), 2.0)
    assert merged.directions == pytest.approx(direction)
    assert merged.accuracy == pytest.approx(0, abs=1e-7)


def test_merging_the_same_twice_gives_the_same():
    sun, light = year_of(BOSTON)
    first, second = (merged_suns(sun.direction, light, 1.5) for _ in range(2))
    assert np.array_equal(first.directions, second.directions)
    assert (first.weights != second.weights).nnz == 0


def test_a_month_of_minutes_keeps_the_accuracy():
    """More suns than are covered one by one."""
    times = np.arange("2019-06-01", "2019-07-01", dtype="datetime64[m]")
    sun = sun_position(times, BOSTON)
    light = np.maximum(sun.direction[:, 2], 0.0)
    merged = merged_suns(sun.direction, light, 2.0)
    shares = merged.weights.tocoo()
    assert (sun.direction[:, 2] > 0).sum() > 20_000
    miss = np.linalg.norm(merged.directions[shares.row] - sun.direction[shares.col], axis=1)
    assert np.degrees(2 * np.arcsin(miss.max() / 2)) <= 2.0
    assert (merged.weights @ light).sum() == pytest.approx(light.sum())
    assert len(merged.directions) < 200


def test_what_cannot_be_merged_is_said():
    up = np.array([[0.0, 0.0, 1.0], [0.0, 0.6, 0.8]])
    with pytest.raises(ParameterError, match=r"accuracy of 0 to 30°, not -1°"):
        merged_suns(up, np.ones(2), -1.0)
    with pytest.raises(ParameterError, match=r"accuracy of 0 to 30°, not nan°"):
        merged_suns(up, np.ones(2), float("nan"))
    with pytest.raises(ParameterError, match=r"not \(2, 3\) and \(3,\)"):
        merged_suns(up, np.ones(3), 2.0)
    with pytest.raises(ParameterError, match="The weight of sun 1 is nan; give 0"):
        merged_suns(up, np.array([1.0, np.nan]), 2.0)
    with pytest.raises(ParameterError, match="The weight of sun 0 is -1"):
        merged_suns(up, np.array([-1.0, 1.0]), 2.0)


def test_true_suns_need_times_in_order():
    with pytest.raises(ParameterError, match="is not after time"):
        true_suns(hours_of_year(2019, BOSTON)[::-1], BOSTON)
