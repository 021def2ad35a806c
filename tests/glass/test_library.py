"""The print library: what is counted, what the rows say, and going on after a stop."""

import json
import os
import time
from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.analysis import find_analysis
from heliform.engines.core.colour import Display
from heliform.engines.core.errors import Cancelled, FileError, ParameterError
from heliform.engines.core.run import run_study
from heliform.engines.core.scene import Scene
from heliform.engines.core.table import load_csv
from heliform.engines.glass import (
    PRINT_LIBRARY,
    Library,
    Plan,
    PrintLibrary,
    print_library,
    wall_loft,
)
from heliform.engines.glass.candidates import asked_plans, drawn, folded, wall_of
from heliform.engines.glass.fourier import plan_curve
from heliform.engines.glass.gate import gate
from heliform.engines.glass.judging import ACCEPTED, plan_of
from heliform.engines.glass.machine import load_machine
from heliform.engines.glass.store import store_path
from heliform.engines.glass.toolpath import spiral
from PIL import Image

SMALL = PrintLibrary(
    lowest_period=3,
    periods=3,
    amplitudes=2,
    offsets=3,
    amplitude_high=0.12,
    height=0.05,
    processes=1,
)


@pytest.fixture
def record(tmp_path):
    return replace(SMALL, store_file=str(tmp_path / "rows.npz"))


def test_the_default_grid_is_68355_shapes_none_of_them_twice():
    asked = asked_plans(PrintLibrary())
    assert len(asked) == 68_355
    assert len(folded(asked)) == 68_355


def test_folding_counts_the_shapes_that_there_are():
    grid = replace(SMALL, amplitude_low=-0.06, amplitude_high=0.06, amplitudes=3, periods=4)
    asked = asked_plans(grid)
    theta = np.arange(1440) * (2 * np.pi / 1440)
    shapes = []
    for plan in asked:
        size = np.fft.rfft(np.abs(plan_curve(plan, theta)[0]))
        for known in shapes:
            both = [np.fft.irfft(known.conj() * s).max() for s in (size, size.conj())]
            power = [np.fft.irfft(s.conj() * s)[0] for s in (known, size)]
            if power[0] + power[1] - 2 * max(both) < 1e-9 * power[0]:
                break
        else:
            shapes.append(size)
    assert len(folded(asked)) == len(shapes) < len(asked)


def test_a_drawn_part_is_of_the_whole_in_its_order_and_by_the_seed():
    every = folded(asked_plans(SMALL))
    part = drawn(every, 10, seed=1)
    assert len(part) == 10
    places = [every.index(plan) for plan in part]
    assert places == sorted(set(places))
    assert part == drawn(every, 10, seed=1) != drawn(every, 10, seed=2)
    assert drawn(every, 0, seed=1) == every


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    path = tmp_path_factory.mktemp("library") / "rows.npz"
    return print_library(Scene(), replace(SMALL, store_file=str(path)))


def test_every_wall_is_accepted_or_rejected_for_a_reason(library):
    assert len(library.rows) == 3 * 2 * 2 * 3
    assert 0 < len(library.accepted) < len(library.rows)
    figures = {name: figure["value"] for name, figure in library.figures().items()}
    assert figures["candidates"] == figures["accepted"] + figures["rejected"] == 36
    assert sum(library.reasons().values()) == figures["rejected"]
    assert figures["judged_now"] == 36
    assert figures["rate"] > 0


@pytest.mark.parametrize("index", [0, 7, 20, 35])
def test_a_row_says_what_the_gate_says_of_that_wall(library, index):
    row, machine = library.rows[index], load_machine()
    wall = wall_of(plan_of(row, SMALL.radius), SMALL)
    loft = wall_loft(wall)
    path = spiral(loft, wall.thickness, SMALL.spiral, machine)
    verdict = gate(loft, wall.thickness, path, machine, SMALL.spiral.purge)
    reason = verdict.failed[0].name if verdict.failed else ACCEPTED
    assert row["reason"] == reason
    assert row["resolved"] == bool(loft.notes)
    assert row["length"] == pytest.approx(path.arc[-1], rel=1e-3)
    assert row["time"] == pytest.approx(path.seconds, rel=1e-3)
    share = {one.name: one.share for one in verdict.checks}
    assert row["curvature share"] == pytest.approx(share["curvature"], rel=2e-2)
    bend = 1 / np.abs(loft.at(np.arange(4096) / 4096, 0.0).curvature).max()
    assert row["bend"] == pytest.approx(bend, rel=1e-2)


def test_an_outline_without_room_is_a_row_like_any_other(record):
    small = replace(record, radius=0.006, lowest_period=7, amplitude_low=0.3, amplitude_high=0.5)
    found = print_library(Scene(), replace(small, offsets=1, periods=2))
    assert set(found.rows["reason"]) <= {"no_room", "curvature", "turn_time_min"}
    assert "no_room" in found.reasons()
    assert np.isnan(found.rows["bend"][found.rows["reason"] == "no_room"]).all()


def test_rows_are_the_same_for_any_number_of_processes(library, record):
    shared = print_library(Scene(), replace(record, processes=2))
    assert shared.meta["processes"] == 2
    assert shared.rows.tobytes() == library.rows.tobytes()


def stop_after(done):
    def progress(fraction, text):
        if fraction >= done:
            raise Cancelled

    return progress


@pytest.mark.parametrize("processes", [1, 2])
def test_a_run_that_was_stopped_goes_on_where_it_was(library, record, processes, tmp_path):
    record = replace(record, processes=processes)
    with pytest.raises(Cancelled):
        print_library(Scene(), record, progress=stop_after(0.01))
    assert (tmp_path / "rows.npz").exists()
    found = print_library(Scene(), record)
    assert 0 < found.meta["judged"] < 36
    assert found.rows.tobytes() == library.rows.tobytes()
    assert any("by an earlier run" in note for note in found.meta["notes"])
    found.save(tmp_path)
    assert (tmp_path / "rows.npz").exists()  # the result may be elsewhere, or lost
    again = print_library(Scene(), record)
    assert again.meta["judged"] == 0
    assert again.rows.tobytes() == library.rows.tobytes()


def test_a_store_of_something_else_is_refused_and_left_alone(record, tmp_path):
    with pytest.raises(Cancelled):
        print_library(Scene(), record, progress=stop_after(0.01))
    kept = (tmp_path / "rows.npz").read_bytes()
    with pytest.raises(FileError, match="rows of another print library; remove it, or choose"):
        print_library(Scene(), replace(record, thickness=0.009))
    assert (tmp_path / "rows.npz").read_bytes() == kept


def test_the_cache_folder_keeps_a_store_a_week(monkeypatch, tmp_path):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    folder = tmp_path / "heliform"
    folder.mkdir()
    now = time.time()
    for name, days in (("library-old", 8), ("library-new", 6), ("mine", 30)):
        (folder / f"{name}.npz").write_text("rows")
        os.utime(folder / f"{name}.npz", (now - days * 86400,) * 2)
    print_library(Scene(), replace(SMALL, limit=1))
    names = {path.name for path in folder.iterdir()}
    assert "library-old.npz" not in names
    assert {"library-new.npz", "mine.npz"} < names
    assert len(names) == 3


def test_a_named_store_clears_nothing(record, tmp_path):
    old = tmp_path / "library-old.npz"
    old.write_text("rows")
    os.utime(old, (0, 0))
    print_library(Scene(), replace(record, limit=1))
    assert old.exists()


def test_what_a_reader_should_know_is_noted(library, record):
    notes = library.meta["notes"]
    assert any("19 of 22 limits of Glass printer are unconfirmed" in note for note in notes)
    assert not any("drawn by the seed" in note for note in notes)
    part = print_library(Scene(), replace(record, limit=5), seed=3).meta["notes"]
    assert any("The 5 walls are a part of all 36, drawn by the seed 3" in note for note in part)
    tight = replace(record, radius=0.03, amplitude_high=0.3, store_file=record.store_file + "2.npz")
    found = print_library(Scene(), tight)
    count = found.figures()["overlaps_resolved"]["value"]
    assert count > 0
    said = [note for note in found.meta["notes"] if "overlaps_resolved" in note]
    assert said[0].startswith(f"{count} outlines would run into themselves")


def test_what_is_saved_is_loaded_and_opens_as_a_table(library, tmp_path):
    assert library.save(tmp_path) == ["library.csv"]
    found = Library.load(tmp_path)
    assert found.rows.dtype == library.rows.dtype
    for name in library.rows.dtype.names:
        wanted = library.rows[name]
        if wanted.dtype.kind == "f":
            assert found.rows[name] == pytest.approx(wanted, rel=1e-6, nan_ok=True)
        else:
            assert np.array_equal(found.rows[name], wanted)
    assert found.meta == json.loads(json.dumps(library.meta))
    assert found.figures() == library.figures()
    columns, meta = load_csv(tmp_path / "library.csv")
    assert {"offset (m)", "reason", "curvature share"} < set(columns)
    assert meta["machine"] == "Glass printer"


def test_pictures_show_accepted_outlines_and_the_reasons(library, tmp_path):
    names = PRINT_LIBRARY.draw(library, tmp_path, Display())
    assert names == ["accepted.png", "reasons.png"]
    for name in names:
        with Image.open(tmp_path / name) as picture:
            assert picture.width > 500
            assert len(picture.convert("RGB").getcolors(1 << 20)) > 3
    rejected = library.rows[library.rows["reason"] != ACCEPTED]
    assert PRINT_LIBRARY.draw(replace(library, rows=rejected), tmp_path, Display()) == [
        "reasons.png"
    ]


STUDY = """
heliform = 1
analysis = "glass.library"
[parameters]
periods = 2
amplitudes = 2
offsets = 2
height = 0.03
store_file = "kept.npz"
"""


def test_a_study_makes_a_library_with_its_report(tmp_path):
    study, out = tmp_path / "small.toml", tmp_path / "out"
    study.write_text(STUDY, encoding="utf-8")
    files = run_study(study, out)
    assert {"library.csv", "reasons.png", "report.html"} <= set(files)
    figures = json.loads((out / "result.json").read_text(encoding="utf-8"))["figures"]
    assert figures["candidates"]["value"] == 8
    assert (tmp_path / "kept.npz").exists()


def test_the_analysis_is_found_by_its_name():
    assert find_analysis("glass.library", "here").record is PrintLibrary


def test_the_store_is_in_the_cache_folder_unless_it_is_named(monkeypatch, tmp_path):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert store_path("", "library-1") == tmp_path / "heliform" / "library-1.npz"
    assert store_path("here/mine.npz", "library-1").name == "mine.npz"


@pytest.mark.parametrize(
    ("change", "error", "said"),
    [
        ({"amplitude_low": 0.2}, ParameterError, "amplitude_low = 0.2 is above"),
        ({"offset_low": 0.02}, ParameterError, "offset_low = 0.02 is above"),
        ({"periods": 1}, ParameterError, "periods = 1 is out of bounds"),
        ({"machine": "file", "machine_file": "nothing.toml"}, FileError, "no machine profile"),
        ({"machine": "file"}, ParameterError, "no profile is named"),
        ({"machine_file": "my.toml"}, ParameterError, 'set machine = "file"'),
        ({"radius": 0.005, "thickness": 0.02}, ParameterError, "no room for a wall"),
    ],
)
def test_a_library_that_cannot_be_is_refused_in_a_sentence(record, change, error, said):
    with pytest.raises(error, match=said):
        print_library(Scene(), replace(record, **change))


@pytest.mark.parametrize(
    "content", [b"mine", b"", b"PK\x03\x04 cut off", b"PK\x05\x06" + bytes(18)]
)
def test_a_store_that_is_none_is_refused_and_left_alone(record, tmp_path, content):
    (tmp_path / "rows.npz").write_bytes(content)
    with pytest.raises(FileError, match="not a store of a print library"):
        print_library(Scene(), record)
    assert (tmp_path / "rows.npz").read_bytes() == content


def test_a_store_where_nothing_can_be_made_is_refused(record, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match=r"cannot be (made|written)|Cannot write"):
        print_library(Scene(), replace(record, store_file=str(tmp_path / "file" / "rows.npz")))


def test_a_row_gives_back_its_plan(library):
    plans = folded(asked_plans(SMALL))
    assert [plan_of(row, SMALL.radius) for row in library.rows] == plans
    assert isinstance(plan_of(library.rows[0], 0.1), Plan)
