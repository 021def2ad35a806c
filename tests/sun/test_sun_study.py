"""Studies of sun and sky as they are run from a file."""

import json
from html import escape
from pathlib import Path

import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.run import run_study
from heliform.engines.core.study import load_study
from heliform.engines.sun import SunMaps
from sun.weather_files import cloudy, write_epw

STUDIES = Path(__file__).resolve().parents[2] / "studies"
SMALL = """
title = "A table"
analysis = "sun.radiation"

[parameters]
subdivision = 1
accuracy = 3.0
weather_file = "town.epw"

[parameters.period]
span = "cooling season"
first_hour = 9.0
last_hour = 17.0

[display]
log = false

[bodies.table]
form = "structure.sized"
shape = { form = "roof", roof = { length = 12.0, width = 8.0, spacing = 4.0 } }

[receivers.floor]
width = 16.0
length = 12.0
resolution = 16
"""


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    write_epw(folder / "town.epw", cloudy())
    (folder / "small.toml").write_text(SMALL, encoding="utf-8")
    files = run_study(folder / "small.toml", folder / "out")
    return folder / "out", files


def test_a_study_leaves_maps_hours_pictures_and_a_report(done):
    out, files = done
    assert {"sun.exr", "hourly.npz", "hourly.csv", "total.png", "hours direct.png"} <= set(files)
    assert all((out / name).stat().st_size for name in files)
    report = (out / "report.html").read_text(encoding="utf-8")
    assert "hours direct.png" in report
    assert "mean_shading" in report
    assert "<figcaption>floor: irradiation</figcaption>" in report
    assert "± 95 %" not in report
    assert "nan" not in report.partition("<h2>Figures")[2]


def test_report_result_and_table_say_where_and_when(done):
    out, _ = done
    summary = json.loads((out / "result.json").read_text(encoding="utf-8"))
    report = (out / "report.html").read_text(encoding="utf-8")
    table = (out / "hourly.csv").read_text(encoding="utf-8")
    assert {"Place", "Clock", "Weather", "Period"} <= summary["facts"].keys()
    assert summary["facts"]["Period"] == "cooling season, 25 April to 21 October, 9 to 17 h"
    for name, text in summary["facts"].items():
        assert f"<td>{escape(text)}</td>" in report
        assert f"# {name}: " in table


def test_its_figures_are_those_of_its_maps(done):
    out, _ = done
    summary = json.loads((out / "result.json").read_text(encoding="utf-8"))
    result = SunMaps.load(out)
    (one,) = result.maps
    assert one.receiver == "floor"
    assert summary["figures"] == result.figures()
    assert summary["figures"]["mean_total"]["value"] == pytest.approx(one.mean("total"))
    assert summary["notes"] == result.meta["notes"]
    assert result.meta["period"].endswith("9 to 17 h")
    assert 0.5 < one.mean("shading") < 60
    assert len(result.times) == 180 * 8  # 25 April to 21 October


def test_a_key_that_there_is_not_is_named(tmp_path):
    (tmp_path / "wrong.toml").write_text(SMALL.replace("accuracy", "accuracies"), encoding="utf-8")
    with pytest.raises(ParameterError, match="did you mean “accuracy”"):
        load_study(tmp_path / "wrong.toml")


@pytest.mark.slow
def test_the_waffle_roofs_seasons_make_up_its_year(tmp_path):
    run_study(STUDIES / "sun-waffle.toml", tmp_path / "out", quick=True)
    of = {case: SunMaps.load(tmp_path / "out" / case) for case in ("year", "heating", "cooling")}
    means = {case: result.maps[0].mean("total") for case, result in of.items()}
    assert means["heating"] + means["cooling"] == pytest.approx(means["year"], rel=2e-3)
    shading = {case: result.maps[0].mean("shading") for case, result in of.items()}
    assert shading["heating"] > shading["year"] > shading["cooling"]
