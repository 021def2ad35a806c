"""TMY3 files read as pvlib reads them, midnight and gaps and all."""

from pathlib import Path

import numpy as np
import pvlib
import pytest
from heliform.engines.core.errors import FileError
from heliform.engines.sun.tmy3 import read_tmy3

DATA = Path(pvlib.__file__).parent / "data"
GREENSBORO = DATA / "723170TYA.CSV"
SAND_POINT = DATA / "703165TY.csv"


@pytest.fixture(scope="module")
def lines():
    return GREENSBORO.read_text(encoding="latin-1").splitlines()


def written(tmp_path, lines):
    path = tmp_path / "greensboro ä.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


@pytest.mark.parametrize("path", [GREENSBORO, SAND_POINT], ids=["Greensboro", "Sand Point"])
def test_a_tmy3_file_reads_as_pvlib_reads_it(path):
    ours = read_tmy3(path)
    theirs, meta = pvlib.iotools.read_tmy3(path, coerce_year=2019, map_variables=True)
    for name, column in (
        ("global_horizontal", "ghi"),
        ("direct_normal", "dni"),
        ("diffuse_horizontal", "dhi"),
        ("temperature", "temp_air"),
        ("dew_point", "temp_dew"),
    ):
        assert np.array_equal(getattr(ours, name), theirs[column].to_numpy(float))
    assert np.allclose(ours.pressure, 100.0 * theirs["pressure"])
    ends = theirs.index.tz_convert("UTC").tz_localize(None).to_numpy()
    assert np.array_equal(ours.times, ends - np.timedelta64(30, "m"))
    site = ours.site
    assert (site.latitude, site.longitude) == (meta["latitude"], meta["longitude"])
    assert (site.elevation, site.utc_offset) == (meta["altitude"], meta["TZ"])


def test_its_source_and_years_are_told():
    ours = read_tmy3(GREENSBORO)
    assert ours.source == "GREENSBORO PIEDMONT TRIAD INT, NC (TMY3, 723170TYA.CSV)"
    assert ours.notes == ("The records are from 1980 to 2003; all are dated in 2019.",)


def test_midnight_may_be_the_next_days_first_stamp(lines, tmp_path):
    changed = list(lines)
    for k, line in enumerate(lines):
        date, clock, rest = line.split(",", 2)
        if clock == "24:00":
            month, day, year = map(int, date.split("/"))
            after = np.datetime64(f"{year}-{month:02}-{day:02}") + np.timedelta64(1, "D")
            y, m, d = str(after).split("-")
            changed[k] = f"{m}/{d}/{y},00:00,{rest}"
    ours, theirs = read_tmy3(written(tmp_path, changed)), read_tmy3(GREENSBORO)
    assert np.array_equal(ours.times, theirs.times)
    assert np.array_equal(ours.temperature, theirs.temperature)


def test_missing_values_are_filled_and_said(lines, tmp_path):
    changed = list(lines)
    titles = lines[1].split(",")
    for k in (2000, 2001):
        row = lines[k].split(",")
        row[titles.index("Dry-bulb (C)")] = row[titles.index("Pressure (mbar)")] = "-9900"
        changed[k] = ",".join(row)
    ours, whole = read_tmy3(written(tmp_path, changed)), read_tmy3(GREENSBORO)
    straight = np.interp([1, 2], [0, 3], whole.temperature[[1997, 2000]])
    assert np.allclose(ours.temperature[1998:2000], straight)
    assert "Temperature: 2 values interpolated." in ours.notes
    assert "Pressure: 2 values interpolated." in ours.notes


def test_a_cut_file_is_refused(lines, tmp_path):
    with pytest.raises(FileError, match=r"no records from 02-2\d .* to 12-31 23:00"):
        read_tmy3(written(tmp_path, lines[:1300]))


@pytest.mark.parametrize(
    ("line", "change", "said"),
    [
        (0, lambda text: "723170,Greensboro,NC,-5.0", "line 1 has 4 fields, not 7"),
        (0, lambda text: text.replace("-79.950", "79.950"), "longitude's sign looks wrong"),
        (0, lambda text: text.replace("36.100", "N36"), "“N36”, not a number"),
        (1, lambda text: "Year,Month,Day", "second line should begin"),
        (1, lambda text: text.replace("Time (HH:MM)", "Hour"), "second column should be"),
        (1, lambda text: text.replace("GHI (W/m^2)", "Global"), "no column “GHI"),
        (9, lambda text: text.replace("01/01/1988", "1988-01-01"), "line 10: “1988-01-01,08:00”"),
        (9, lambda text: text.replace("08:00", "25:00"), "line 10: “01/01/1988,25:00”"),
        (9, lambda text: text.replace(",0,", ",", 1), "line 10 has 70 columns, but line 3 has 71"),
        (9, lambda text: text.replace("08:00", "07:00"), "lines .* of the same interval"),
    ],
)
def test_what_is_wrong_is_named(lines, line, change, said, tmp_path):
    wrong = list(lines)
    wrong[line] = change(wrong[line])
    assert wrong[line] != lines[line]
    with pytest.raises(FileError, match=said):
        read_tmy3(written(tmp_path, wrong))
