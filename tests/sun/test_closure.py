"""Global, direct and diffuse radiation that contradict one another, or their site."""

import dataclasses
import re

import numpy as np
import pytest
from heliform.engines.core.errors import FileError
from heliform.engines.sun.clear_sky import clear_weather
from heliform.engines.sun.epw import read_epw
from heliform.engines.sun.site import Site
from sun.weather_files import BOSTON, cloudy, epw_rows, write_epw

NOON = 12 + 24 * 172  # 21 June, hour 12 to 13; its line is 9 farther down
MUMBAI = Site(latitude=19.0, longitude=73.0, elevation=10.0, utc_offset=5.0)


@pytest.fixture(scope="module")
def weather():
    return cloudy()


def read(path, weather, rows=None, **header):
    return read_epw(write_epw(path / "file.epw", weather, rows, **header))


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ((0, 2, 1), "columns of direct and diffuse look swapped"),
        ((2, 1, 0), "columns of global and diffuse look swapped"),
        ((1, 0, 2), "columns of global and direct look swapped"),
    ],
)
def test_swapped_columns_are_refused_and_named(weather, columns, said, tmp_path):
    rows = epw_rows(weather)
    for row in rows:
        row[13:16] = [row[13 + k] for k in columns]
    with pytest.raises(FileError, match=said) as caught:
        read(tmp_path, weather, rows)
    assert "kWh/m²" in str(caught.value)


def test_direct_radiation_on_the_horizontal_is_refused(weather, tmp_path):
    level = weather.global_horizontal - weather.diffuse_horizontal
    wrong = dataclasses.replace(weather, direct_normal=np.maximum(level, 0.0))
    with pytest.raises(FileError, match="direct looks measured on the horizontal"):
        read(tmp_path, wrong)


@pytest.mark.parametrize(("column", "kind"), [(14, "direct"), (15, "diffuse")])
def test_a_kind_that_is_zero_all_year_is_refused_and_its_remedy_works(
    weather, column, kind, tmp_path
):
    rows = epw_rows(weather)
    for row in rows:
        row[column] = "0"
    with pytest.raises(FileError, match=f"no {kind} radiation at all.*{kind} column blank"):
        read(tmp_path, weather, rows)
    for row in rows:
        row[column] = ""
    ours = read(tmp_path, weather, rows)
    truth = getattr(weather, {14: "direct_normal", 15: "diffuse_horizontal"}[column])
    found = {14: ours.direct_normal, 15: ours.diffuse_horizontal}[column]
    assert found.sum() == pytest.approx(truth.sum(), rel=0.015)


def test_global_radiation_that_is_zero_all_year_is_added_up(weather, tmp_path):
    rows = epw_rows(weather)
    for row in rows:
        row[13] = "0"
    ours = read(tmp_path, weather, rows)
    assert ours.global_horizontal.sum() == pytest.approx(weather.global_horizontal.sum(), rel=0.01)
    assert "added up from direct and diffuse" in ours.notes[0]


def test_a_month_without_direct_radiation_is_overcast(weather, tmp_path):
    grey = dataclasses.replace(
        weather,
        direct_normal=0 * weather.direct_normal,
        diffuse_horizontal=weather.global_horizontal,
    )
    rows = [row for row in epw_rows(grey) if row[1] == "11"]
    assert read(tmp_path, grey, rows, period="11/1,11/30").notes == ()


def test_halved_direct_radiation_is_said_with_the_sums(weather, tmp_path):
    dim = dataclasses.replace(weather, direct_normal=np.round(weather.direct_normal / 2))
    (note,) = read(tmp_path, dim).notes
    off = (weather.global_horizontal - weather.diffuse_horizontal).sum() / 2
    share = off / weather.global_horizontal.sum()
    assert f"contradict one another by {share:.0%}" in note
    assert "global is" in note
    assert "Leave the wrong column blank" in note


@pytest.mark.parametrize(
    ("column", "value", "said"),
    [
        (14, "9000", rf"Direct normal radiation: 1 record above .* line {NOON + 9} \(9000 of"),
        (15, "9000", rf"Diffuse horizontal radiation: 1 record above .* line {NOON + 9} \(9000 of"),
        (
            15,
            "900",
            rf"contradict one another in 1 record, most on line {NOON + 9}: .* diffuse 900 W",
        ),
    ],
)
def test_one_impossible_value_is_named_with_its_line(weather, column, value, said, tmp_path):
    rows = epw_rows(weather)
    rows[NOON][column] = value
    (note,) = read(tmp_path, weather, rows).notes
    assert re.search(said, note)


def test_a_clock_an_hour_off_is_what_the_radiation_says(tmp_path):
    early = cloudy(dataclasses.replace(BOSTON, utc_offset=-4.0))
    notes = " ".join(read(tmp_path, early, offset=-5.0).notes)
    assert "agree with the clock 1 h earlier" in notes


@pytest.mark.parametrize("latitude", [4.0, -12.0])
def test_the_wrong_hemisphere_is_told_by_the_suns_height_near_the_equator(latitude, tmp_path):
    site = Site(latitude=latitude, longitude=100.0, utc_offset=7.0)
    with pytest.raises(FileError, match="latitude's sign looks wrong"):
        read(tmp_path, cloudy(site), latitude=-latitude)


@pytest.mark.parametrize("latitude", [19.0, -23.0])
def test_the_wrong_hemisphere_is_told_by_the_days_where_there_is_global_alone(latitude, tmp_path):
    tropical = cloudy(dataclasses.replace(MUMBAI, latitude=latitude))
    rows = epw_rows(tropical)
    for row in rows:
        row[14] = row[15] = "9999"
    assert "Reindl" in read(tmp_path, tropical, rows).notes[0]
    with pytest.raises(FileError, match=r"long days while they are short at .*latitude's sign"):
        read(tmp_path, tropical, rows, latitude=-latitude)


def test_remedies_that_mend_as_much_are_all_named(tmp_path):
    east = Site(latitude=10.0, longitude=100.0, utc_offset=7.0)
    with pytest.raises(FileError, match=r"longitude's sign .* or the UTC offset's sign"):
        read(tmp_path, cloudy(east), offset=-7)


@pytest.mark.parametrize(("clear_share", "notes"), [(0.45, 1), (1.0, 0)])
def test_a_dull_month_of_half_hours_keeps_its_watts(clear_share, notes, tmp_path):
    clear = clear_weather(BOSTON, hours=0.5)
    level = np.round(clear_share * clear.global_horizontal)
    grey = dataclasses.replace(
        clear,
        global_horizontal=level,
        direct_normal=0 * level,
        diffuse_horizontal=level,
        temperature=0 * level,
        dew_point=0 * level,
    )
    november = np.flatnonzero(clear.local_times.astype("datetime64[M]").astype(int) % 12 == 10)
    every = epw_rows(grey)
    ours = read(tmp_path, grey, [every[k] for k in november], period="11/1,11/30")
    assert np.array_equal(ours.global_horizontal, level[november])
    dull = [note for note in ours.notes if "taken as W/m²; if the records hold Wh/m²" in note]
    assert len(dull) == notes
