"""A reading as a result: what is saved loads back, what is drawn is there, and a study runs it."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from heliform.engines.core.colour import Display
from heliform.engines.core.errors import FileError
from heliform.engines.core.run import run_study
from heliform.engines.core.scene import Scene
from heliform.engines.glass.profile import Style
from heliform.engines.scan import READ_SCAN, Reading, ScanReading, read_scan
from heliform.engines.scan.drawing import summary
from heliform.engines.scan.sample import sample_scan
from PIL import Image


@pytest.fixture(scope="module")
def sample() -> Reading:
    return read_scan(Scene(), ScanReading(repair=False), seed=3)


def test_the_built_in_sample_is_a_piece_of_a_spiral_tube(sample):
    figures = {name: figure["value"] for name, figure in sample.figures().items()}
    assert figures["layer_height"] == pytest.approx(5e-3, rel=1e-3)
    assert figures["depth"] == pytest.approx(1e-3, rel=0.03)
    assert figures["rise_of_a_turn"] == pytest.approx(1.0, abs=0.15)
    assert figures["noise"] == pytest.approx(0.04e-3, rel=0.1)
    notes = " ".join(sample.meta["notes"])
    assert "made up" in notes
    assert "a spiral" in notes
    low, high = np.percentile(sample_scan().points, [0.1, 99.9], axis=0)
    assert high - low == pytest.approx([16e-3, 73e-3, 49e-3], abs=2e-3)


def test_what_is_saved_loads_back_equal(sample, tmp_path):
    files = sample.save(tmp_path)
    assert all((tmp_path / name).is_file() for name in files)
    again = Reading.load(tmp_path)
    assert again.meta == json.loads(json.dumps(sample.meta))
    assert again.style.digest == sample.style.digest == Style.load(tmp_path / "relief.npz").digest
    assert again.figures() == sample.figures()
    for one, two in zip(sample.faces, again.faces, strict=True):
        assert (one.name, one.edge) == (two.name, two.edge)
        for name in ("height", "roughness", "smooth", "density"):
            np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
        for name, values in one.folded.items():
            np.testing.assert_allclose(two.folded[name], values, rtol=1e-6)
        for name, values in one.octaves.items():
            np.testing.assert_allclose(two.octaves[name], values, rtol=1e-6)
        np.testing.assert_array_equal(one.patch.vertices, two.patch.vertices)


def test_a_folder_without_a_reading_is_named(tmp_path):
    with pytest.raises(FileError, match="holds no reading"):
        Reading.load(tmp_path)


def test_every_picture_is_drawn(sample, tmp_path):
    files = READ_SCAN.draw(sample, tmp_path, Display())
    assert len(files) == 2 * 5
    for name in files:
        with Image.open(tmp_path / name) as picture:
            assert min(picture.size) > 200


def test_turning_the_piece_over_turns_the_profile_round(sample):
    over = read_scan(Scene(), ScanReading(repair=False, upside_down=True), seed=3)
    one, two = sample.style.profile.offsets, over.style.profile.offsets
    assert np.sqrt(np.mean((one - np.roll(two[::-1], 1)) ** 2)) < 0.01
    assert np.dot(sample.meta["frame"]["up"], over.meta["frame"]["up"]) == pytest.approx(-1)


def test_the_shipped_study_runs_and_reports(tmp_path):
    study = Path(__file__).resolve().parents[2] / "studies" / "scan-sample.toml"
    files = run_study(study, tmp_path / "out", quick=True)
    result = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert result["figures"]["layer_height"]["value"] == pytest.approx(5e-3, rel=1e-3)
    assert "relief.npz" in files
    assert result["notes"]


def test_each_faces_caption_has_its_own_figures(sample):
    figures = {name: figure["value"] for name, figure in sample.figures().items()}
    inner = summary(sample, "inner")
    assert f"{1e3 * figures['depth_inner']:.3g} mm deep" in inner
    assert f"roughness {1e6 * figures['roughness_inner']:.0f} µm RMS" in inner
    assert f"{1e3 * figures['depth']:.3g} mm deep" in summary(sample)


def test_no_figure_is_a_negative_nothing(sample):
    figures = sample.figures() | {"tilt": {"value": -1e-4, "unit": "deg"}}
    level = replace(sample, meta=sample.meta | {"figures": figures})
    assert "tilted 0.00°" in summary(level)


def test_the_distance_to_the_patch_needs_no_meshlab(monkeypatch, sample):
    monkeypatch.setitem(sys.modules, "pymeshlab", None)
    again = read_scan(Scene(), ScanReading(repair=False), seed=3)
    assert again.figures()["scan_to_patch"] == sample.figures()["scan_to_patch"]
