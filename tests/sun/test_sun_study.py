"""Studies of sun and sky as they are run from a file."""

import json
from pathlib import Path

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.run import run_study
from heliform.engines.core.study import load_study
from heliform.engines.sun import SunMaps
from heliform.engines.sun.box import Box, box_mesh
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
    assert 0.005 < one.mean("shading") < 0.6
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


@pytest.mark.parametrize("quick", [False, True])
def test_the_room_is_read_with_and_without_its_blinds(quick):
    bare, veiled = load_study(STUDIES / "sun-room.toml", quick=quick).cases
    assert (bare.parameters.blinds, veiled.parameters.blinds) == (False, True)
    assert len(bare.scene.bodies) == 10
    low, high = (
        getattr(np.concatenate([b.mesh.vertices for b in bare.scene.bodies]), end)(axis=0)
        for end in ("min", "max")
    )
    assert low == pytest.approx([-2.8, -3.8, -0.3])
    assert high == pytest.approx([2.8, 3.8, 3.3])


@pytest.mark.slow
def test_blinds_take_light_from_the_room_and_no_sun(tmp_path):
    run_study(STUDIES / "sun-room.toml", tmp_path / "out", quick=True)
    bare, veiled = (SunMaps.load(tmp_path / "out" / case) for case in ("bare", "blinds"))
    first, second = bare.figures(), veiled.figures()
    assert first["sda_300_50_without_blinds"]["value"] == 100
    assert 20 < second["sda_300_50"]["value"] < 70
    assert first["ase_1000_250"] == second["ase_1000_250"]
    assert 1500 < second["blinds_closed"]["value"] < 2500
    factors = [one.maps[0].mean("daylight_factor") for one in (bare, veiled)]
    assert factors[0] == pytest.approx(factors[1], rel=0.06)


def test_a_box_stands_on_its_base_and_looks_outward():
    solid = box_mesh(Box(width=2.0, length=3.0, height=4.0))
    assert solid.vertices.min(axis=0) == pytest.approx([-1, -1.5, 0])
    assert solid.vertices.max(axis=0) == pytest.approx([1, 1.5, 4])
    corners = solid.triangles().vertices[solid.triangles().faces]
    volume = np.einsum("ti,ti->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert volume == pytest.approx(24)


def test_a_box_without_a_thickness_is_refused(tmp_path):
    text = (STUDIES / "sun-room.toml").read_text(encoding="utf-8")
    (tmp_path / "flat.toml").write_text(text.replace("length = 0.01", "length = 0"), "utf-8")
    with pytest.raises(ParameterError, match=r"window.*length"):
        load_study(tmp_path / "flat.toml")
