"""A whole study of daylight, on scenes whose light is known."""

import dataclasses

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError, SceneError
from heliform.engines.core.parameters import from_table, to_table
from heliform.engines.core.scene import Material, Receiver, Scene
from heliform.engines.sun import daylight
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.coefficients import Sought, daylight_coefficients
from heliform.engines.sun.daylight import Daylight, WorkingHours, illuminance_at, study_daylight
from heliform.engines.sun.dome import Dome
from heliform.engines.sun.hourly import hourly_skies
from heliform.engines.sun.illuminance import course_of
from heliform.engines.sun.maps import QUANTITIES, SunMaps
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.sensors import at_points, of_receiver
from heliform.engines.sun.site import Site
from heliform.engines.sun.surroundings import Surroundings
from heliform.engines.sun.weather import Weather
from sun.rooms import BOSTON, even, matte
from sun.shades import box, level
from sun.weather_files import cloudy, write_epw

MARCH = WorkingHours(span="dates", first_month=3, first_day=21, last_month=3, last_day=21)
QUICK = Daylight(subdivision=1, accuracy=5.0, error=0.05, paths=8192)


def plane(size=2.0, z=0.8, count=4, at=(0.0, 0.0), **more):
    corner = np.array([at[0] - size / 2, at[1] - size / 2, z])
    edges = np.array([size, 0, 0]), np.array([0, size, 0])
    return Receiver("work plane", corner, *edges, count, count, **more)


def room(glazed=True, size=4.0, height=3.0):
    """A room whose whole south side is open or glass."""
    s, t = size / 2, 0.2
    bodies = [
        box("floor", [size + 2 * t, size + 2 * t, t], [0, 0, -t / 2], matte(0.2)),
        box("ceiling", [size + 2 * t, size + 2 * t, t], [0, 0, height + t / 2], matte(0.8)),
        box("west", [t, size, height], [-s - t / 2, 0, height / 2], matte(0.5)),
        box("east", [t, size, height], [s + t / 2, 0, height / 2], matte(0.5)),
        box("north", [size + 2 * t, t, height], [0, s + t / 2, height / 2], matte(0.5)),
    ]
    if glazed:
        glass = Material(kind="dielectric", ior=1.52)
        bodies.append(box("pane", [size, 0.006, height], [0, -s - t / 2, height / 2], glass))
    return tuple(bodies)


def study(bodies=(), receiver=None, record=QUICK, **changes) -> SunMaps:
    scene = Scene(tuple(bodies), (), (receiver or plane(),))
    return study_daylight(scene, dataclasses.replace(record, **changes), seed=1)


@pytest.fixture(scope="module")
def weather(tmp_path_factory):
    return str(write_epw(tmp_path_factory.mktemp("weather") / "year.epw", cloudy()))


def test_outdoors_the_daylight_factor_is_100_and_nothing_is_lost():
    found = study(period=MARCH, error=0.002, paths=65536).maps[0].maps
    assert found["daylight_factor"] == pytest.approx(100, rel=0.004)
    assert found["illuminance"] == pytest.approx(found["open_illuminance"], rel=0.004)
    assert found["daylight_autonomy"] == pytest.approx(100)
    assert found["udi_low"] == pytest.approx(0)


def test_minutes_under_a_fine_sky_are_refused_before_they_fill_the_memory(monkeypatch):
    times = np.datetime64("2019-01-01", "s") + np.arange(525600) * np.timedelta64(60, "s")
    none = np.zeros(len(times))
    minutes = Weather(BOSTON, 2019, times, none + 1 / 60, *[none] * 6, source="a test's")
    monkeypatch.setattr(daylight, "weather_of", lambda *_: (minutes, BOSTON))
    whole = WorkingHours(span="dates", first_hour=0.0, last_hour=24.0)
    with pytest.raises(ParameterError, match="in 525,600 intervals is too large for memory"):
        study(subdivision=4, period=whole)


def test_seasons_by_boston_s_dates_are_said_elsewhere():
    quiet = {"bounces": 0, "paths": 2048, "open": False}
    winter = WorkingHours(span="heating season", first_hour=11.5, last_hour=12.5)
    notes = study(site=Site(latitude=60.2), period=winter, **quiet).meta["notes"]
    assert any("parted on Boston's dates" in note for note in notes)


def test_outdoors_the_mean_illuminance_is_the_weather_s(weather):
    found = study(weather_file=weather, period=WorkingHours(), accuracy=0.0, paths=2048)
    light = hourly_skies(cloudy(), BOSTON, "light")
    falling = light.diffuse + light.direct * np.maximum(light.sun[:, 2], 0)
    clock = np.arange(8760) % 24
    working = (clock >= 8) & (clock < 18)
    # An EPW rounds: its site, its temperatures and its pressure.
    for name in ("illuminance", "open_illuminance"):
        assert found.maps[0].mean(name) == pytest.approx(falling[working].mean(), rel=4e-3)
    assert found.hourly["illuminance"] == pytest.approx(falling[working], rel=0.03, abs=30)
    assert len(found.times) == 3650


def test_a_plane_that_looks_down_sees_the_ground_alone():
    down = plane()
    down = dataclasses.replace(down, u=down.v, v=down.u)
    for reflectance in (0.0, 0.3):
        found = study((), down, period=MARCH, ground_reflectance=reflectance).maps[0]
        over = study((), plane(), period=MARCH).maps[0].mean("open_illuminance")
        assert found.mean("illuminance") == pytest.approx(reflectance * over, rel=0.005)
        assert found.mean("daylight_factor") == pytest.approx(100 * reflectance, rel=0.005)


def test_shares_of_the_hours_make_up_the_whole():
    maps = study(room(), period=WorkingHours(), blinds=True).maps[0].maps
    low, useful, high = (maps[f"udi_{name}"] for name in ("low", "useful", "high"))
    assert low + useful + high == pytest.approx(100, rel=1e-4)
    assert (maps["udi_supplementary"] <= useful + 1e-3).all()
    assert (maps["daylight_autonomy"] <= maps["continuous_autonomy"] + 1e-3).all()


def test_sun_that_a_floor_reflects_is_the_floor_s_share_of_all():
    # A sensor over a wide floor that looks down sees ρ times what the floor gets, sun and sky.
    site = Site(latitude=20.0, longitude=0.0, utc_offset=0.0)
    weather = clear_weather(site)
    noon = np.flatnonzero(np.arange(8760) % 24 == 11)[::30]
    mask = np.zeros(8760, bool)
    mask[noon] = True
    dome = Dome(2, site)
    course = course_of(weather, site, dome, mask, accuracy=0.0, ground_reflectance=0.2)
    floor = (level("floor", 200, 200, 0.0, matte(0.4)),)
    sensors = at_points([[0, 0, 1.0]], [[0, 0, -1.0]])
    every = np.ones(course.direct.shape, bool)
    sought = Sought(even(dome), 1e-9, 1 << 15, course.aims(course.direct, every))
    found = daylight_coefficients(Surroundings(floor), sensors, dome, 1, sought)
    direct = course.sunlight(Occluders(floor), sensors)
    light = course.light(found, direct)[0]
    hourly = hourly_skies(weather, site, "light", mask)
    falling = hourly.diffuse + hourly.direct * hourly.sun[:, 2]
    assert not direct.any()
    # The sun is found exactly, as all paths scatter where it shines; the sky by chance.
    assert light == pytest.approx(0.4 * falling, rel=0.02)
    assert light.sum() == pytest.approx(0.4 * falling.sum(), rel=0.002)


def test_a_receiver_that_reflects_is_a_floor_and_one_that_does_not_is_a_mere_plane():
    bodies = (box("roof", [6, 6, 0.1], [0, 0, 3], matte(0.8)),)
    no_ground = {"period": MARCH, "ground_reflectance": 0.0}
    black = study(bodies, plane(6, 0, 8), **no_ground)
    white = study(bodies, plane(6, 0, 8, reflectance=0.9), **no_ground)
    assert white.maps[0].mean("illuminance") > 1.1 * black.maps[0].mean("illuminance")
    assert any("only measure" in note for note in black.meta["notes"])
    assert not any("only measure" in note for note in white.meta["notes"])


def test_more_bounces_give_more_light_and_none_gives_what_is_straight():
    found = [
        study(room(), period=MARCH, bounces=b, error=0.02).maps[0].mean("daylight_factor")
        for b in (0, 1, 4, 16)
    ]
    assert found == sorted(found)
    assert found[2] == pytest.approx(found[3], rel=0.06)


def test_blinds_close_when_the_sun_comes_in_and_darken_the_room():
    bare, veiled = (study(room(), blinds=on, period=WorkingHours()) for on in (False, True))
    assert "sda_300_50_without_blinds" in bare.figures()
    assert "sda_300_50" in veiled.figures()
    assert "sda_300_50" not in bare.figures()
    assert 500 < veiled.figures()["blinds_closed"]["value"] < 3650
    means = [one.maps[0].mean("illuminance") for one in (bare, veiled)]
    assert means[1] < 0.5 * means[0]
    for name in ("direct_hours", "open_illuminance"):
        assert np.array_equal(bare.maps[0].maps[name], veiled.maps[0].maps[name])
    # A closed hour has far less light, an open one what it has without blinds.
    before, after = bare.hourly["illuminance"], veiled.hourly["illuminance"]
    lit = before > 0
    dimmed = after[lit] < 0.6 * before[lit]
    closed = veiled.figures()["blinds_closed"]["value"]
    assert dimmed.sum() == closed
    assert after[lit][~dimmed] == pytest.approx(before[lit][~dimmed], rel=0.1)


@pytest.mark.parametrize("veiled", [False, True])
def test_a_picked_sensor_has_the_hours_that_its_mean_is_of(veiled):
    record = dataclasses.replace(QUICK, blinds=veiled, period=MARCH, error=0.03, paths=32768)
    scene = Scene(room(), (), (plane(3.0, count=6),))
    found = study_daylight(scene, record)
    sensors = of_receiver(scene.receivers[0])
    times, light = illuminance_at(scene, record, sensors.some(np.array([8, 30])))
    assert np.array_equal(times, found.times)
    means = found.maps[0].maps["illuminance"].ravel()[[8, 30]]
    assert light.mean(axis=1) == pytest.approx(means, rel=0.06)


def test_sensors_inside_a_solid_are_said():
    solid = box("block", [1.0, 1.0, 1.0], [-0.5, -0.5, 0.8], matte(0.5))
    found = study((solid,), plane(), period=MARCH)
    assert any("4 of 16 sensors lie inside “block”" in note for note in found.meta["notes"])


def test_a_study_can_be_stopped():
    class Stop(Exception):
        pass

    def stop(fraction, text):
        if fraction > 0.3:
            raise Stop

    with pytest.raises(Stop):
        study_daylight(Scene(room(), (), (plane(),)), QUICK, progress=stop)


def test_an_opening_without_glass_has_no_blinds_and_says_so():
    found = study(room(glazed=False), blinds=True, period=WorkingHours())
    assert "sda_300_50_without_blinds" in found.figures()
    assert any("no blinds to close" in note for note in found.meta["notes"])


def test_a_single_day_has_no_figures_of_a_year():
    figures = study(room(), period=MARCH).figures()
    assert not any(name.startswith(("sda", "ase", "en17037")) for name in figures)
    assert {"error_illuminance", "error_daylight_factor", "error_hour"} <= figures.keys()


def test_the_error_that_is_told_is_the_one_between_two_runs():
    scene = Scene(room(), (), (plane(3.0, count=8),))
    record = dataclasses.replace(QUICK, period=MARCH, error=0.02, paths=65536)
    one, other = (study_daylight(scene, record, seed=s) for s in (1, 2))
    means = [r.maps[0].maps["illuminance"].astype(float) for r in (one, other)]
    told = one.figures()["error_illuminance"]["value"] / 100
    assert told < 0.025
    real = np.sqrt(np.mean((means[0] - means[1]) ** 2) / 2) / np.mean(means)
    assert 1.96 * real == pytest.approx(told, rel=0.35)


def test_what_more_reflections_would_add_is_told_within_a_factor_of_two():
    few, many = (study(room(), period=MARCH, bounces=n, error=0.01) for n in (2, 16))
    means = [r.maps[0].mean("illuminance") for r in (few, many)]
    told = few.figures()["given_up"]["value"] / 100
    assert 0.5 < told / (means[1] / means[0] - 1) < 2
    assert any("would come by more reflections" in note for note in few.meta["notes"])
    assert many.figures()["given_up"]["value"] < 0.5


def test_the_same_seed_gives_the_same_maps():
    one, again = (study(room(), period=MARCH) for _ in range(2))
    assert np.array_equal(one.maps[0].maps["illuminance"], again.maps[0].maps["illuminance"])


def test_sensors_in_blocks_are_the_same_sensors(monkeypatch):
    whole = study(room(), plane(3, count=6), period=MARCH, error=0.03)
    monkeypatch.setattr("heliform.engines.sun.coefficients.BLOCK", 10)
    parts = study(room(), plane(3, count=6), period=MARCH, error=0.03)
    a, b = (r.maps[0].maps["illuminance"] for r in (whole, parts))
    assert b == pytest.approx(a, rel=0.08)
    assert parts.hourly["illuminance"] == pytest.approx(whole.hourly["illuminance"], rel=0.05)


def test_both_sides_of_a_receiver_have_maps():
    maps = study((), plane(sides="both"), period=MARCH).maps[0]
    assert maps.maps["illuminance"].shape == (2, 4, 4)
    front, back = maps.maps["illuminance"].mean(axis=(1, 2))
    assert back == pytest.approx(0.2 * front, rel=0.01)


def test_every_map_has_its_title_and_survives_a_file(tmp_path):
    found = study(room(), period=MARCH)
    assert set(found.maps[0].maps) <= QUANTITIES.keys()
    found.save(tmp_path)
    again = SunMaps.load(tmp_path)
    for name, values in found.maps[0].maps.items():
        assert np.array_equal(again.maps[0].maps[name], values)
    assert again.figures() == found.figures()


def test_polar_night_is_dark_and_breaks_nothing():
    site = Site(latitude=85.0, longitude=0.0, utc_offset=0.0)
    night = WorkingHours(span="months", first_month=12, last_month=12)
    found = study(room(), site=site, period=night)
    assert not found.maps[0].maps["illuminance"].any()
    assert found.maps[0].mean("daylight_factor") > 0


def test_nothing_to_measure_is_refused():
    with pytest.raises(SceneError, match="add a receiver"):
        study_daylight(Scene(room()), QUICK)


def test_a_day_that_there_is_not_is_refused():
    reached = []
    record = dataclasses.replace(
        QUICK, period=WorkingHours(), exposure_month=2, exposure_day=31, accuracy=20.0
    )
    scene = Scene(room(), (), (plane(),))
    with pytest.raises(ParameterError, match="no day 31"):
        study_daylight(scene, record, progress=lambda share, text: reached.append(share))
    assert reached == [0.0]  # before anything is traced


def test_the_record_is_written_and_read_with_its_working_hours():
    assert from_table(Daylight, to_table(Daylight()), "study") == Daylight()
    part = from_table(Daylight, {"period": {"span": "summer solstice"}}, "study")
    assert (part.period.first_hour, part.period.last_hour) == (8.0, 18.0)
