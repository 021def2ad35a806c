"""Weather read from whatever file it is in, told apart by what it says."""

import shutil
from pathlib import Path

import numpy as np
import pvlib
import pytest
from heliform.engines.core.errors import FileError
from heliform.engines.sun.humidity import dew_point, relative_humidity
from heliform.engines.sun.interval_sun import sines
from heliform.engines.sun.nsrdb import read_nsrdb
from heliform.engines.sun.pvgis import read_pvgis
from heliform.engines.sun.read_weather import read_weather
from heliform.engines.sun.site import Site
from sun.weather_files import cloudy, write_epw

TURIN = Site(latitude=45.0, longitude=8.0, elevation=250.0, utc_offset=1.0)


@pytest.fixture(scope="module")
def weather():
    return cloudy(TURIN)


def light(weather, k):
    kinds = weather.global_horizontal, weather.direct_normal, weather.diffuse_horizontal
    return [f"{kind[k]:g}" for kind in kinds]


def write_pvgis(path, weather):
    """The weather as PVGIS writes it: in UTC, every month of another year, moments 9 min late."""
    head = ["Latitude (decimal degrees): 45.000", "Longitude (decimal degrees): 8.000"]
    head += ["Elevation (m): 250.0", "Irradiance Time Offset (h): 0.1500", "month,year"]
    head += [f"{month},{2004 + month}" for month in range(1, 13)]
    rows = ["time(UTC),T2m,RH,G(h),Gb(n),Gd(h),IR(h),WS10m,WD10m,SP"]
    starts = np.roll(weather.times, -1) - np.timedelta64(30, "m")  # 31 December, 23 h comes last
    for i, start in enumerate(starts):
        k = (i + 1) % len(starts)
        _, month, day, hour = start.item().timetuple()[:4]
        stamp = f"{2004 + month}{month:02}{day:02}:{hour:02}00"
        humidity = 100 * relative_humidity(weather.temperature[k], weather.dew_point[k])
        values = [f"{weather.temperature[k]:g}", f"{humidity:.3f}", *light(weather, k)]
        rows.append(",".join([stamp, *values, "280", "1.0", "90", "98500.0"]))
    path.write_text("\r\n".join([*head, *rows, "", "T2m: 2-m air temperature", ""]))
    return path


def write_nsrdb(path, weather, minutes=30, zone=1.0):
    """The weather as the NSRDB's service writes it, by a clock of UTC + ``zone``."""
    head = "Source,Location ID,City,State,Country,Latitude,Longitude,Time Zone,Elevation"
    head += ",Local Time Zone,Pressure Units\n"
    head += f"NSRDB,147,-,-,-,45.0,8.0,{zone:g},250,1,mbar\n"
    titles = "Year,Month,Day,Hour,Minute,GHI,DNI,DHI,Temperature,Dew Point,Pressure\n"
    moments = weather.times + np.timedelta64(round(60 * zone) + minutes - 30, "m")
    year_first = np.argsort((moments - np.datetime64("2019-01-01")) % np.timedelta64(365, "D"))
    rows = []
    for k in year_first:
        _, month, day, hour, minute = moments[k].item().timetuple()[:5]
        values = [*light(weather, k), weather.temperature[k], weather.dew_point[k], 985]
        rows.append(",".join(map(str, [2019, month, day, hour, minute, *values])))
    path.write_text(head + titles + "\n".join(rows) + "\n")
    return path


def test_a_pvgis_year_reads_as_pvlib_reads_it(weather, tmp_path):
    path = write_pvgis(tmp_path / "tmy.csv", weather)
    ours = read_pvgis(path)
    theirs, _ = pvlib.iotools.read_pvgis_tmy(path)
    for name, column in (
        ("global_horizontal", "ghi"),
        ("direct_normal", "dni"),
        ("diffuse_horizontal", "dhi"),
        ("temperature", "temp_air"),
        ("pressure", "pressure"),
    ):
        assert np.array_equal(getattr(ours, name), np.roll(theirs[column].to_numpy(float), 1))
    assert np.array_equal(ours.temperature, weather.temperature)
    assert np.allclose(ours.dew_point, weather.dew_point, atol=0.01)
    assert ours.site == TURIN
    assert ours.notes[1] == "The time zone is taken from the longitude: UTC+1 h."


def test_pvgis_moments_are_as_late_as_its_header_says(weather, tmp_path):
    ours = read_pvgis(write_pvgis(tmp_path / "tmy.csv", weather))
    starts = weather.times - np.timedelta64(30, "m")
    assert np.all(ours.times - starts == np.timedelta64(9, "m"))


def test_an_nsrdb_file_reads_as_it_was_written(weather, tmp_path):
    ours = read_nsrdb(write_nsrdb(tmp_path / "psm.csv", weather))
    theirs, meta = pvlib.iotools.read_nsrdb_psm4(tmp_path / "psm.csv")
    assert np.array_equal(ours.direct_normal, theirs["dni"].to_numpy(float))
    assert np.array_equal(ours.times, theirs.index.tz_convert("UTC").tz_localize(None).to_numpy())
    assert np.array_equal(ours.dew_point, weather.dew_point)
    assert np.all(ours.pressure == 98500.0)
    assert ours.site == TURIN
    assert ours.notes == ()
    assert meta["latitude"] == ours.site.latitude


def test_an_nsrdb_file_in_utc_is_turned_to_the_sites_clock(weather, tmp_path):
    ours = read_nsrdb(write_nsrdb(tmp_path / "utc.csv", weather, zone=0.0))
    assert np.array_equal(ours.times, weather.times)
    assert np.array_equal(ours.global_horizontal, weather.global_horizontal)
    assert ours.notes == ("The file's clock is UTC+0 h.",)


def test_nsrdb_stamps_are_the_moments_themselves(weather, tmp_path):
    ours = read_nsrdb(write_nsrdb(tmp_path / "full.csv", weather, minutes=0))
    assert np.all(weather.times - ours.times == np.timedelta64(30, "m"))


def test_a_file_is_told_by_what_it_says_whatever_its_name(weather, tmp_path):
    epw = write_epw(tmp_path / "weather.csv", weather)
    tmy3 = shutil.copy(Path(pvlib.__file__).parent / "data" / "703165TY.csv", tmp_path / "x.epw")
    pvgis = write_pvgis(tmp_path / "y.txt", weather)
    nsrdb = write_nsrdb(tmp_path / "z", weather)
    for path, name in ((epw, "Boston"), (tmy3, "SAND POINT"), (pvgis, "PVGIS"), (nsrdb, "NSRDB")):
        assert read_weather(path).source.startswith(name)


def test_every_reader_gives_arrays_of_one_length_in_order(weather, tmp_path):
    paths = write_pvgis(tmp_path / "a", weather), write_nsrdb(tmp_path / "b", weather)
    for path in paths:
        ours = read_weather(path)
        assert np.all(np.diff(ours.times) > np.timedelta64(0, "s"))
        assert np.all(ours.local_times.astype("datetime64[Y]") == np.datetime64("2019"))
        for name in ("hours", "global_horizontal", "temperature", "dew_point", "pressure"):
            assert getattr(ours, name).shape == ours.times.shape


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("notes.txt", "Dear reader,\n", "is not a weather file that is known here"),
        ("boston.epw", "Dear reader,\n", "is not an EPW file"),
        ("a.csv", "Source,Latitude\nNSRDB,42\nYear,Month\n2019,1\n", "longitude is “”"),
        ("a.csv", "Source;Location ID;City;State;Country;Latitude\n", "separated by semicolons"),
        ("a.csv", "1\tA\tMA\t-5\t42\t-71\t9\nDate (MM/DD/YYYY)\tTime\n", "separated by tabs"),
        ("a.csv", "time(UTC),T2m\n20190101:0000,1\n", "no longitude or time offset"),
    ],
)
def test_what_is_no_weather_is_refused(name, text, said, tmp_path):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(FileError, match=said):
        read_weather(path)


@pytest.mark.parametrize(
    ("writer", "old", "new", "said"),
    [
        (write_pvgis, "20050105:0300", "2005-01-05", "“2005-01-05” is no time"),
        (write_pvgis, "20050105:0300", "20051305:0300", "no year has a month 13, day 5, hour 3"),
        (write_pvgis, "20050105:0300", "20050105:9900", "hour 99"),
        (write_pvgis, "Offset (h): 0.1500", "Offset (h): nan", "no longitude or time offset"),
        (write_pvgis, "G(h)", "Gh", "no column “G"),
        (write_pvgis, "Longitude (decimal degrees): 8.000", "", "no longitude"),
        (write_nsrdb, "GHI", "Global", "no column “GHI”"),
        (write_nsrdb, "2019,1,5,3,30", "2019,1,32,3,30", "day is “32”"),
    ],
)
def test_a_damaged_file_is_named_with_its_line(weather, writer, old, new, said, tmp_path):
    path = writer(tmp_path / "a.csv", weather)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(FileError, match=said):
        read_weather(path)


def test_dew_point_and_humidity_are_each_others_inverse():
    warm = np.linspace(-20.0, 40.0, 13)
    for humidity in (0.1, 0.5, 1.0):
        back = relative_humidity(warm, dew_point(warm, np.full(13, humidity)))
        assert np.allclose(back, humidity)
    assert abs(dew_point(np.array([20.0]), np.array([0.5]))[0] - 9.27) < 0.02  # ASHRAE's chart


def test_the_suns_mean_height_in_an_hour_is_that_of_its_minutes():
    times = np.datetime64("2019-03-20T05:30", "s") + np.arange(14) * np.timedelta64(1, "h")
    mean, highest = sines(times, np.ones(14), TURIN)
    minutes = times[:, None] + np.arange(-1770, 1800, 60).astype("timedelta64[s]")
    position = pvlib.solarposition.get_solarposition(minutes.ravel(), 45.0, 8.0)
    sine = np.sin(np.radians(position.elevation.to_numpy())).reshape(minutes.shape)
    assert np.allclose(mean, np.maximum(sine, 0.0).mean(axis=1), atol=0.002)
    assert np.all(highest[mean > 0.01] >= mean[mean > 0.01])
