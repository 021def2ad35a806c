"""EPW files read as others read them, repaired where little is missing, else refused."""

import dataclasses

import numpy as np
import pvlib
import pytest
from heliform.engines.core.errors import FileError
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.epw import read_epw
from heliform.engines.sun.site import Site
from sun.weather_files import BOSTON, cloudy, epw_lines, epw_rows, write_epw

NOON = 12 + 24 * 172  # 21 June, hour 12 to 13
KINDS = ("global_horizontal", "direct_normal", "diffuse_horizontal")


@pytest.fixture(scope="module")
def weather():
    return cloudy()


@pytest.fixture(scope="module")
def rows(weather):
    return epw_rows(weather)


def copy_of(rows):
    return [list(row) for row in rows]


def test_an_epw_reads_as_pvlib_reads_it(weather, tmp_path):
    path = write_epw(tmp_path / "boston.epw", weather)
    ours = read_epw(path)
    theirs, meta = pvlib.iotools.read_epw(path)
    for name, column in zip(
        (*KINDS, "temperature", "dew_point", "pressure"),
        ("ghi", "dni", "dhi", "temp_air", "temp_dew", "atmospheric_pressure"),
        strict=True,
    ):
        assert np.array_equal(getattr(ours, name), theirs[column].to_numpy(float))
    begins = theirs.index.tz_convert("UTC").tz_localize(None).to_numpy()
    assert np.array_equal(ours.times, begins + np.timedelta64(30, "m"))
    assert (ours.site.latitude, ours.site.utc_offset) == (meta["latitude"], meta["TZ"])
    assert ours.site == BOSTON
    assert ours.notes == ()


def test_the_first_hour_is_half_past_midnight_by_the_sites_clock(weather, tmp_path):
    ours = read_epw(write_epw(tmp_path / "a.epw", weather))
    assert ours.local_times[0] == np.datetime64("2019-01-01T00:30:00")
    assert ours.times[0] == np.datetime64("2019-01-01T05:30:00")
    assert ours.local_times[-1] == np.datetime64("2019-12-31T23:30:00")
    assert np.all(ours.hours == 1.0)


def test_months_of_several_years_are_dated_in_one(weather, rows, tmp_path):
    mixed = copy_of(rows)
    for row in mixed:
        row[0] = str(1980 + int(row[1]))
    ours = read_epw(write_epw(tmp_path / "typical.epw", weather, mixed))
    assert ours.year == 2019
    assert np.all(np.diff(ours.times) == np.timedelta64(1, "h"))
    assert ours.notes == ("The records are from 1981 to 1992; all are dated in 2019.",)


def test_a_leap_year_keeps_its_29_february(tmp_path):
    leap = cloudy(year=2020)
    ours = read_epw(write_epw(tmp_path / "leap.epw", leap))
    assert (len(ours.times), ours.year) == (8784, 2020)
    assert np.array_equal(ours.times, leap.times)
    assert np.array_equal(ours.direct_normal, leap.direct_normal)


def test_a_leap_year_without_its_29_february_keeps_its_dates(tmp_path):
    leap = cloudy(year=2020)
    kept = [row for row in epw_rows(leap) if row[1:3] != ["2", "29"]]
    ours = read_epw(write_epw(tmp_path / "leap.epw", leap, kept))
    assert len(ours.times) == 8760
    assert ours.local_times[59 * 24] == np.datetime64("2020-03-01T00:30:00")
    assert ours.local_times[-1] == np.datetime64("2020-12-31T23:30:00")


@pytest.mark.parametrize("stamp", ["end", "beginning"])
def test_quarters_of_hours_keep_their_middles(stamp, tmp_path):
    quarters = cloudy(hours=0.25)
    rows = epw_rows(quarters)
    if stamp == "beginning":
        for row in rows:
            row[4] = str(int(row[4]) - 15)
    ours = read_epw(write_epw(tmp_path / "quarters.epw", quarters, rows))
    assert np.array_equal(ours.times, quarters.times)
    assert ours.local_times[1] == np.datetime64("2019-01-01T00:22:30")
    assert np.array_equal(ours.global_horizontal, quarters.global_horizontal)
    assert np.all(ours.hours == 0.25)


def test_quarters_that_hold_energies_become_powers(tmp_path):
    quarters = cloudy(hours=0.25)
    energies = dataclasses.replace(
        quarters, **{kind: getattr(quarters, kind) / 4.0 for kind in KINDS}
    )
    ours = read_epw(write_epw(tmp_path / "energies.epw", energies))
    assert np.allclose(ours.direct_normal, quarters.direct_normal, rtol=1e-5)
    assert "Wh/m²" in ours.notes[0]


def test_hours_from_0_to_23_are_taken_as_those_they_begin(weather, rows, tmp_path):
    shifted = copy_of(rows)
    for row in shifted:
        row[3] = str(int(row[3]) - 1)
    ours = read_epw(write_epw(tmp_path / "zero.epw", weather, shifted))
    assert np.array_equal(ours.times, weather.times)
    assert "0 to 23" in ours.notes[0]


@pytest.mark.parametrize(
    ("encoding", "ending"),
    [
        ("utf-8", "\n"),
        ("utf-8-sig", "\r\n"),
        ("latin-1", "\r\n"),
        ("cp1252", "\r"),
        ("utf-16", "\n"),
    ],
)
def test_names_with_accents_read_in_any_usual_encoding(weather, encoding, ending, tmp_path):
    place = "Köln “West”,-,DEU,x,1" if encoding != "latin-1" else "Köln,-,DEU,x,1"
    text = ending.join(epw_lines(weather, place=place, comment="±5 % für Wärme"))
    path = tmp_path / "Köln West (1).epw"
    path.write_bytes((text + ending + "\x1a").encode(encoding))
    ours = read_epw(path)
    assert ours.source.startswith("Köln")
    assert len(ours.times) == 8760


@pytest.mark.parametrize(
    ("column", "code", "name"),
    [(6, "99.9", "temperature"), (7, "99.9", "dew_point"), (9, "999999", "pressure")],
)
def test_a_missing_value_is_bridged_and_said(weather, rows, column, code, name, tmp_path):
    holes = copy_of(rows)
    for k in range(NOON, NOON + 3):
        holes[k][column] = code
    ours = read_epw(write_epw(tmp_path / "holes.epw", weather, holes))
    values = getattr(weather, name)
    straight = np.interp([1, 2, 3], [0, 4], values[[NOON - 1, NOON + 3]])
    assert np.allclose(getattr(ours, name)[NOON : NOON + 3], straight)
    assert ours.notes == (f"{name.replace('_', ' ').capitalize()}: 3 values interpolated.",)


def test_a_long_gap_in_the_temperature_stays_unknown(weather, rows, tmp_path):
    holes = copy_of(rows)
    for k in range(NOON, NOON + 30):
        holes[k][6] = "99.9"
    ours = read_epw(write_epw(tmp_path / "holes.epw", weather, holes))
    assert np.isnan(ours.temperature).sum() == 30
    assert ours.notes == ("Temperature: unknown for 30 h.",)


@pytest.mark.parametrize("kind", [0, 1, 2])
def test_a_missing_kind_of_radiation_follows_from_the_other_two(weather, rows, kind, tmp_path):
    holes = copy_of(rows)
    for row in holes:
        row[13 + kind] = "9999"
    ours = read_epw(write_epw(tmp_path / "holes.epw", weather, holes))
    truth = getattr(weather, KINDS[kind])
    error = (getattr(ours, KINDS[kind]) - truth)[weather.global_horizontal > 250.0]
    # The file holds whole watts, and an hour's mean of direct light has lost where the sun stood.
    assert np.sqrt(np.mean(error**2)) < (2.5, 5.0, 2.5)[kind]
    assert abs(getattr(ours, KINDS[kind]).sum() / truth.sum() - 1.0) < 0.015
    assert len(ours.notes) == 1


@pytest.mark.parametrize("code", ["9999", "0"])
def test_global_radiation_alone_is_split(weather, rows, code, tmp_path):
    holes = copy_of(rows)
    for row in holes:
        row[14] = row[15] = code
    ours = read_epw(write_epw(tmp_path / "global.epw", weather, holes))
    position = pvlib.solarposition.get_solarposition(ours.times, 42.3603, -71.0875)
    sine = np.sin(np.radians(position.elevation.to_numpy()))
    high = sine > 0.3
    again = (ours.direct_normal * sine + ours.diffuse_horizontal)[high]
    assert np.allclose(again, ours.global_horizontal[high], rtol=0.01)
    assert np.array_equal(ours.global_horizontal, weather.global_horizontal)
    assert "Reindl" in ours.notes[0]


def test_night_is_dark_where_its_radiation_is_missing_or_below_zero(weather, rows, tmp_path):
    holes = copy_of(rows)
    holes[0][13:16] = ["9999", "9999", "9999"]
    holes[1][13:16] = ["-2", "", "-0.0"]
    ours = read_epw(write_epw(tmp_path / "night.epw", weather, holes))
    assert ours.global_horizontal[:2].tolist() == [0.0, 0.0]
    assert ours.direct_normal[:2].tolist() == [0.0, 0.0]
    assert ours.notes == ("Global horizontal radiation: 1 value below zero set to zero.",)


def test_missing_hours_of_a_clear_morning_come_back_within_a_fifth(tmp_path):
    clear = dataclasses.replace(
        clear_weather(BOSTON), temperature=np.full(8760, 10.0), dew_point=np.full(8760, 5.0)
    )
    rows = epw_rows(clear)
    gap = slice(NOON - 6, NOON - 2)
    del rows[gap]
    ours = read_epw(write_epw(tmp_path / "gap.epw", clear, rows))
    assert np.allclose(ours.global_horizontal[gap], clear.global_horizontal[gap], rtol=0.2)
    assert np.allclose(ours.temperature, 10.0)
    assert ours.notes == (
        "4 missing records interpolated, the longest gap from 06-22 06:00 to 06-22 09:00.",
    )


def test_more_missing_hours_are_refused_by_their_date(weather, rows, tmp_path):
    cut = rows[:NOON] + rows[NOON + 7 :]
    with pytest.raises(FileError, match=r"no records from 06-22 12:00 to 06-22 18:00 \(7 h\)"):
        read_epw(write_epw(tmp_path / "gap.epw", weather, cut))


def test_radiation_that_is_missing_all_day_is_refused(weather, rows, tmp_path):
    holes = copy_of(rows)
    for k in range(NOON - 5, NOON + 5):
        holes[k][13:16] = ["9999"] * 3
    with pytest.raises(FileError, match="no solar radiation from 06-22 07:00 to 06-22 16:00"):
        read_epw(write_epw(tmp_path / "gap.epw", weather, holes))


@pytest.mark.parametrize("code", ["9999", "0"])
def test_a_year_without_any_radiation_is_refused(weather, rows, code, tmp_path):
    holes = copy_of(rows)
    for row in holes:
        row[13:16] = [code] * 3
    with pytest.raises(FileError, match="no solar radiation"):
        read_epw(write_epw(tmp_path / "dark.epw", weather, holes))


def test_a_file_that_ends_early_is_refused(weather, rows, tmp_path):
    with pytest.raises(FileError, match="no records from 07-03 12:00 to 12-31 23:00"):
        read_epw(write_epw(tmp_path / "short.epw", weather, rows[:4404]))


def test_a_data_period_of_part_of_the_year_is_read_as_it_is(weather, rows, tmp_path):
    spring = [row for row in rows if row[1] in ("3", "4", "5")]
    ours = read_epw(write_epw(tmp_path / "spring.epw", weather, spring, period="3/1,5/31/2019"))
    assert len(ours.times) == 92 * 24
    assert ours.local_times[0] == np.datetime64("2019-03-01T00:30:00")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"longitude": 71.0875}, "longitude's sign looks wrong"),
        ({"latitude": -42.3603}, "latitude's sign looks wrong"),
        ({"offset": 5}, "UTC offset's sign looks wrong|longitude's sign looks wrong"),
    ],
)
def test_a_wrong_sign_in_the_header_is_found_by_sunshine_at_night(weather, change, said, tmp_path):
    with pytest.raises(FileError, match=said) as caught:
        read_epw(write_epw(tmp_path / "signs.epw", weather, **change))
    assert "sunshine at night" in str(caught.value)


def test_a_clock_far_from_the_suns_is_said_where_the_radiation_follows_it(tmp_path):
    utc = cloudy(dataclasses.replace(BOSTON, utc_offset=0.0))
    ours = read_epw(write_epw(tmp_path / "utc.epw", utc))
    assert "4.7 h off the sun's" in ours.notes[0]


def test_a_site_across_the_date_line_is_not_called_odd(tmp_path):
    line_islands = cloudy(Site(latitude=1.9, longitude=-157.4, utc_offset=14.0, elevation=3.0))
    assert read_epw(write_epw(tmp_path / "kiritimati.epw", line_islands)).notes == ()


def test_more_sun_than_reaches_the_air_is_said_with_its_line(weather, rows, tmp_path):
    bright = copy_of(rows)
    bright[NOON][13] = "1420"
    ours = read_epw(write_epw(tmp_path / "bright.epw", weather, bright))
    assert f"1 record above what reaches the air, most on line {NOON + 9} (1420 of" in ours.notes[0]


def test_radiation_in_kilojoules_is_refused(weather, tmp_path):
    joules = dataclasses.replace(weather, **{kind: 3.6 * getattr(weather, kind) for kind in KINDS})
    with pytest.raises(FileError, match="its unit is not W/m²"):
        read_epw(write_epw(tmp_path / "joules.epw", joules))


def test_temperatures_in_kelvin_are_refused(weather, tmp_path):
    kelvin = dataclasses.replace(weather, temperature=weather.temperature + 273.15)
    rows = epw_rows(kelvin)
    with pytest.raises(FileError, match="must be in °C"):
        read_epw(write_epw(tmp_path / "kelvin.epw", kelvin, rows))


def test_moments_of_a_pvgis_epw_are_where_its_comment_puts_them(weather, tmp_path):
    comment = "Irradiance Time Offset (h):-0.8239"
    ours = read_epw(write_epw(tmp_path / "pvgis.epw", weather, comment=comment))
    later = (ours.times[1:] - weather.times[:-1]) / np.timedelta64(1, "s")
    assert np.allclose(later, (0.5 + 0.1761) * 3600.0, atol=1.0)
    assert np.array_equal(ours.direct_normal[1:], weather.direct_normal[:-1])
    assert ours.local_times[0] == np.datetime64("2019-01-01T00:10:34")  # the stamp of hour 24
    assert "11 min after the stamps" in ours.notes[0]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is empty"),
        (b"  \r\n \r\n", "is empty"),
        (b"PK\x03\x04....", "is a ZIP archive"),
        (b"LOCATION\x00\x01\x02", "is not a text file"),
        (b"<html><body>404 Not Found</body></html>", "is not an EPW file"),
        (b"LOCATION;Boston;MA;USA;TMY3;1;42;-71;-5;10\n", "line 1 is separated by semicolons"),
        (b"LOCATION\tBoston\tMA\tUSA\tTMY3\t1\t42\t-71\t-5\t10\n", "separated by tabs"),
        (b"LOCATION;Boston;MA;USA;TMY3;1;42,3;-71,1;-5;10\n", "points in its numbers"),
        (b"LOCATION,Boston,MA,USA,TMY3,1,42,-71,-5,10\n1995;1;1;1;60;?;1\n", "line 2 is separated"),
        (b"LOCATION,Boston,MA,USA,TMY3,1,42,-71,-5\n", "9 fields, not 10"),
        (b"LOCATION,Ahmedabad,-,-,MN8,999,23.015,72.592,5,5,49\n", "11 fields, not 10"),
        (b"LOCATION,Boston,MA,USA,TMY3,1,142,-71,-5,10\n1995,1,1,1,60,?,1\n", "latitude"),
        (b"LOCATION,Boston,MA,USA,TMY3,1,north,-71,-5,10\n", "“north”, not a number"),
        (b"LOCATION,Boston,MA,USA,TMY3,1,42,-71,-5,10\nDATA PERIODS,1,1\n", "no records"),
    ],
)
def test_what_is_no_epw_is_refused_in_one_sentence(content, said, tmp_path):
    path = tmp_path / "odd name.epw"
    path.write_bytes(content)
    with pytest.raises(FileError, match=said) as caught:
        read_epw(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("path", ["odd\0name.epw", "half \ud800.epw"])
def test_what_can_be_no_path_is_said_in_print(path):
    with pytest.raises(FileError, match=r"“.*�.*epw” cannot be the path of a file") as caught:
        read_epw(path)
    assert str(caught.value).isprintable()


def test_a_missing_file_and_a_folder_are_named(tmp_path):
    with pytest.raises(FileError, match=r"Cannot read “nowhere\.epw”"):
        read_epw(tmp_path / "nowhere.epw")
    with pytest.raises(FileError, match="Cannot read"):
        read_epw(tmp_path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda row: row.pop(), "line 109 has 34 columns, but line 9 has 35"),
        (lambda row: row.__delitem__(slice(9, None)), "line 109 has 9 columns where at least 16"),
        (lambda row: row.__setitem__(13, "bright"), "line 109: global .* “bright”, not a number"),
        (lambda row: row.__setitem__(1, "13"), "line 109: month is “13”"),
        (lambda row: row.__setitem__(3, "25"), "line 109: hour is “25”"),
        (lambda row: row.__setitem__(2, "1.5"), "line 109: day is “1.5”"),
        (
            lambda row: row.__setitem__(slice(1, 3), ["4", "31"]),
            "line 109: no year has a month 4, day 31",
        ),
        (lambda row: row.__setitem__(3, "4"), "lines 108 and 109|lines 109 and 108"),
        (lambda row: row.__setitem__(6, "80"), "line 109: an air temperature of 80 °C"),
    ],
)
def test_a_wrong_line_is_named(weather, rows, change, said, tmp_path):
    wrong = copy_of(rows)
    change(wrong[100])
    with pytest.raises(FileError, match=said):
        read_epw(write_epw(tmp_path / "wrong.epw", weather, wrong))


def test_summer_time_is_refused(weather, rows, tmp_path):
    twice = copy_of(rows)
    twice.insert(300 * 24 + 2, list(twice[300 * 24 + 1]))
    del twice[88 * 24 + 2]
    with pytest.raises(FileError, match="without summer time"):
        read_epw(write_epw(tmp_path / "summer.epw", weather, twice))
