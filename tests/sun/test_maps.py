"""The result of a sun study: what is saved, summed up and drawn."""

import gzip

import numpy as np
import pytest
from heliform.engines.core.colour import Display
from heliform.engines.core.errors import FileError, ParameterError
from heliform.engines.core.parameters import to_table
from heliform.engines.core.table import load_csv
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.drawing import draw, scale_of
from heliform.engines.sun.maps import SunMap, SunMaps, figures_of, quantities_of
from heliform.engines.sun.site import Site
from heliform.engines.sun.temporal import hourly_scale, temporal_map, temporal_picture
from heliform.engines.sun.times import hours_of_year, moment
from PIL import Image

RNG = np.random.default_rng(11)
AREA = np.array([[1, 1, 2], [0, 4, 4]], np.float32)
META = {
    "site": to_table(Site(utc_offset=1.0)),
    "source": "a test’s",
    "period": "year",
    "facts": {"Place": "42.36° N, 71.09° W", "Weather": "a test’s", "Period": "year"},
    "notes": ["One."],
}


def some(name="Floor", sides=1):
    """A receiver's maps at random; nothing where there is no area."""
    shape = AREA.shape if sides == 1 else (sides, *AREA.shape)
    free = RNG.uniform(100, 200, shape)
    kept = RNG.uniform(0, 1, shape)
    maps = {
        "sun_hours": 4000 * kept,
        "total": free * kept,
        "open": free,
        "shading": 100 * (1 - kept),
    }
    held = {n: np.where(AREA > 0, v, np.nan).astype(np.float32) for n, v in maps.items()}
    return SunMap(name, held, AREA)


def result(*maps, count=8760):
    times = hours_of_year(2019, Site(utc_offset=1.0)).astype("datetime64[s]")[:count]
    hourly = {name: RNG.uniform(0, 500, len(times)) for name in ("direct", "diffuse", "open")}
    meta = {**META, "figures": figures_of(maps), "quantities": quantities_of(maps)}
    return SunMaps(maps, times, hourly, meta)


@pytest.mark.parametrize("sides", [1, 2])
@pytest.mark.parametrize("receivers", [1, 11])
def test_what_is_saved_is_loaded(tmp_path, sides, receivers):
    saved = result(*(some(f"Nr {i}", sides) for i in range(receivers)))
    files = saved.save(tmp_path)
    assert sorted(files) == sorted(p.name for p in tmp_path.iterdir())
    loaded = SunMaps.load(tmp_path)
    assert loaded.meta == saved.meta
    assert (loaded.times == saved.times).all()
    assert loaded.hourly.keys() == saved.hourly.keys()
    assert all((loaded.hourly[n] == v).all() for n, v in saved.hourly.items())
    for one, other in zip(saved.maps, loaded.maps, strict=True):
        assert one.receiver == other.receiver
        assert list(one.maps) == list(other.maps)
        assert np.array_equal(one.area, other.area)
        for name, values in one.maps.items():
            assert other.maps[name].dtype == np.float32
            assert np.array_equal(values, other.maps[name], equal_nan=True)


def test_what_is_missing_or_damaged_is_said(tmp_path):
    with pytest.raises(FileError, match="holds no sun study"):
        SunMaps.load(tmp_path)
    result(some()).save(tmp_path)
    (tmp_path / "hourly.npz").write_bytes(b"no archive")
    with pytest.raises(FileError, match="no whole sun study"):
        SunMaps.load(tmp_path)
    (tmp_path / "sun.exr").write_bytes(b"no picture")
    with pytest.raises(FileError):
        SunMaps.load(tmp_path)


def test_figures_are_means_by_area_and_sums():
    one = some()
    figures = result(one).figures()
    inside = AREA > 0
    mean = np.average(one.maps["total"][inside], weights=AREA[inside])
    assert figures["mean_total"]["value"] == pytest.approx(mean, rel=1e-6)
    assert (figures["mean_total"]["unit"], figures["mean_total"]["title"]) == (
        "kWh/m²",
        "Irradiation",
    )
    assert figures["sum_total"]["value"] == pytest.approx(12 * mean, rel=1e-6)
    assert figures["min_sun_hours"]["value"] == one.maps["sun_hours"][inside].min()
    assert figures["max_shading"]["value"] == one.maps["shading"][inside].max()
    assert "sum_sun_hours" not in figures
    assert {"A.mean_open", "B.mean_open"} <= result(some("A"), some("B")).figures().keys()


def test_both_sides_count_in_a_mean():
    one = some(sides=2)
    halves = [SunMap("", maps, AREA).mean("open") for _, maps in one.sides()]
    assert one.mean("open") == pytest.approx(np.mean(halves))


def test_a_map_without_any_value_has_no_figures():
    empty = SunMap("", {"shading": np.full(AREA.shape, np.nan, np.float32)}, AREA)
    assert figures_of((empty,)) == {}
    assert np.isnan(empty.mean("shading"))


def test_the_table_of_hours_reads_back_and_is_packed_where_it_is_long(tmp_path):
    long, short = result(some()), result(some(), count=24)
    assert "hourly.csv.gz" in long.save(tmp_path)
    plain = tmp_path / "plain.csv"
    plain.write_bytes(gzip.decompress((tmp_path / "hourly.csv.gz").read_bytes()))
    columns, meta = load_csv(plain)
    assert meta["Weather"] == "a test’s"
    assert meta["Place"] == "42.36° N, 71.09° W"
    assert columns["Direct (W/m²)"] == pytest.approx(long.hourly["direct"], rel=1e-6)
    clock = columns["Middle of the interval"]
    assert (clock[0], clock[-1]) == ("2019-01-01 00:30", "2019-12-31 23:30")
    assert "hourly.csv" in short.save(tmp_path)


@pytest.mark.parametrize("sides", [1, 2])
def test_every_map_has_a_picture(tmp_path, sides):
    files = draw(result(some(sides=sides)), tmp_path, Display(log=False))
    maps = {f"{n}{s}.png" for n in some().maps for s in (("",), (" front", " back"))[sides - 1]}
    assert set(files) == maps | {f"hours {n}.png" for n in ("direct", "diffuse", "open")}
    assert all((tmp_path / name).stat().st_size > 2000 for name in files)


def test_irradiation_with_and_without_buildings_is_on_one_scale():
    drawn = result(some("A"), some("B"))
    scales = {name: scale_of(drawn, name, Display()) for name in drawn.maps[0].maps}
    assert scales["total"].high == scales["open"].high >= 190
    assert scales["shading"].low == 0
    assert not scales["shading"].log
    assert not scales["sun_hours"].log


def test_irradiation_far_below_the_open_skys_has_a_scale_of_its_own():
    one = some()
    dark = {**one.maps, "total": one.maps["total"] / 20}
    drawn = result(SunMap("Room", dark, AREA))
    assert 0 < scale_of(drawn, "total", Display()).high <= 10
    assert scale_of(drawn, "open", Display()).high >= 150


@pytest.mark.parametrize("name", ["daylight_factor", "udi_low", "sun_hours", "shading", "total"])
def test_a_range_set_by_hand_is_obeyed_by_every_map(name):
    held = {n: np.full(AREA.shape, 40.0, np.float32) for n in (name, "open")}
    drawn = result(SunMap("Room", held, AREA))
    scale = scale_of(drawn, name, Display(automatic=False, low=1.0, high=3.0))
    assert (scale.low, scale.high, scale.log) == (1, 3, False)
    with pytest.raises(ParameterError):
        scale_of(drawn, name, Display(automatic=False, low=3.0, high=1.0))


def test_a_small_daylight_factor_is_drawn_up_to_its_own_and_shares_of_time_to_100():
    few = {n: np.full(AREA.shape, 3.62, np.float32) for n in ("daylight_factor", "udi_low")}
    drawn = result(SunMap("Room", few, AREA))
    assert scale_of(drawn, "daylight_factor", Display()).high == pytest.approx(3.7)
    assert scale_of(drawn, "udi_low", Display()).high == 100


def test_pictures_of_a_study_are_evenly_spaced_whatever_is_set():
    drawn = result(some())
    assert not any(scale_of(drawn, n, Display(log=True)).log for n in drawn.maps[0].maps)
    assert not hourly_scale(drawn.hourly, "direct", Display(log=True)).log


def test_the_hours_picture_says_its_title_and_draws_squares(tmp_path):
    values = np.arange(8760.0)
    grid = temporal_map(hours_of_year(2019, Site()), values, -5.0)
    scale = hourly_scale({"direct": values}, "direct", Display())
    one, two = (temporal_picture(grid, scale, title) for title in ("W/m²", "W/m²\nyear"))
    assert two.height > one.height
    draw(result(some()), tmp_path, Display())
    with Image.open(tmp_path / "hours direct.png") as picture:
        assert picture.info["Title"].startswith("Direct: mean over the sensors")


def test_a_temporal_map_is_by_the_sites_clock():
    site = Site(utc_offset=-5.0)
    times = hours_of_year(2019, site)
    values = np.arange(8760.0)
    grid = temporal_map(times, values, site.utc_offset)
    assert grid.values.shape == (24, 365)
    assert grid.values[13, 31] == 31 * 24 + 13
    picked = moment(2019, 2, 1, 13.5, site)
    assert values[np.flatnonzero(times == picked)] == grid.values[13, 31]


def test_a_temporal_map_leaves_out_what_is_not_in_the_period():
    site = Site(utc_offset=5.5)
    times = hours_of_year(2019, site)
    clock = np.arange(8760) % 24
    chosen = (clock >= 8) & (clock < 18) & (np.arange(8760) > 24 * 40)
    grid = temporal_map(times[chosen], clock[chosen].astype(float), site.utc_offset)
    assert grid.values.shape == (24, 365 - 40)
    assert (grid.values[8:18, 1:] == np.arange(8, 18)[:, None]).all()
    assert np.isnan(grid.values[:8]).all()
    one = temporal_map(times[:1], np.ones(1), site.utc_offset)
    assert one.values.shape == (24, 1)
    parts = (times[:24, None] + np.arange(4) * np.timedelta64(15, "m")).ravel()
    assert temporal_map(parts, np.ones(96), site.utc_offset).values.shape == (96, 2)


@pytest.mark.parametrize("parts", [3, 7, 12])
def test_parts_of_an_hour_fill_their_rows(parts):
    site = Site(utc_offset=-5.0)
    times = clear_weather(site, hours=1 / parts).times[: 48 * parts]
    grid = temporal_map(times, np.arange(48.0 * parts), site.utc_offset)
    assert (grid.values.T.ravel() == np.arange(48 * parts)).all()


def test_of_a_single_day_the_course_is_drawn(tmp_path):
    files = draw(result(some(), count=24), tmp_path, Display(log=False))
    assert files[-1] == "hours.png"
    assert len(files) == 5
