"""Profiles, textures and styles: their shapes, their files, and lines drawn by hand."""

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, ParameterError
from heliform.engines.glass.profile import (
    STYLES,
    Profile,
    Style,
    flat_bead,
    normalised,
    profile_of,
    scalloped,
    texture_of,
)

RANDOM = np.random.default_rng(5)


def scanned():
    texture, rms = texture_of(RANDOM.normal(0, 3e-5, (6, 10)), (0.05, 0.03))
    profile, depth = normalised(RANDOM.uniform(size=64))
    inner, _ = normalised(RANDOM.uniform(size=64))
    return Style("Probe ä/1", profile, inner, texture, 4.8e-3, depth * 1e-3, rms)


def test_a_profile_is_straight_between_its_samples_and_repeats():
    profile = Profile(np.array([0.0, 1.0, 0.5, 0.25]))
    phase = np.array([0, 0.125, 0.25, 0.875, 1.0, 7.25, -0.25, -0.125])
    assert profile.at(phase) == pytest.approx([0, 0.5, 1, 0.125, 0, 1, 0.25, 0.125])


def test_a_scallop_is_part_of_a_circle():
    height, depth = 5e-3, 1.2e-3
    style = scalloped(height, depth)
    phase = np.linspace(0, 1, 501)
    across = (phase - 0.5) * height
    out = style.profile.at(phase) * depth
    radius = (height**2 / 4 + depth**2) / (2 * depth)
    assert np.hypot(across, out - depth + radius) == pytest.approx(radius, abs=5e-9)


def test_a_flat_bead_is_flat_and_meets_the_next_in_a_groove():
    flat, round_bead = (make(5e-3, 1e-3).profile for make in (flat_bead, scalloped))
    middle = np.linspace(0.3, 0.7, 50)
    assert np.ptp(flat.at(middle)) < 0.03 < np.ptp(round_bead.at(middle))
    assert flat.at(0) == 0
    assert flat.at(0.5) == 1
    assert flat.at(middle) == pytest.approx(flat.at(1 - middle))


def test_a_built_in_style_is_between_0_and_1():
    for make in STYLES.values():
        offsets = make(5e-3, 1.2e-3).profile.offsets
        assert (offsets.min(), offsets.max()) == (0, pytest.approx(1))


def test_a_texture_repeats_both_ways_and_has_its_rms():
    given = RANDOM.normal(2.0, 3.0, (5, 7))
    texture, rms = texture_of(given, (0.07, 0.05))
    assert rms == pytest.approx(given.std())
    assert (texture.heights**2).mean() == pytest.approx(1)
    row, column = np.mgrid[:5, :7]
    assert texture.at(column / 7, row / 5) == pytest.approx(texture.heights)
    x, y = RANDOM.uniform(-3, 3, (2, 100))
    assert texture.at(x, y) == pytest.approx(texture.at(x + 2, y - 5))
    middle = texture.heights[[4, 4, 0, 0], [6, 0, 6, 0]].mean()
    assert texture.at(6.5 / 7, 4.5 / 5) == pytest.approx(middle)


def test_a_style_outlives_its_file(tmp_path):
    style = scanned()
    path = tmp_path / "Probe ä.npz"
    style.save(path)
    found = Style.load(path)
    assert found.digest == style.digest
    assert found.name == style.name
    assert np.array_equal(found.texture.heights, style.texture.heights)
    assert np.array_equal(found.inner.offsets, style.inner.offsets)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_a_style_without_texture_outlives_its_file(tmp_path):
    scalloped(4e-3, 1e-3).save(tmp_path / "a.npz")
    found = Style.load(tmp_path / "a.npz")
    assert found.texture is None
    assert (found.height, found.depth) == (4e-3, 1e-3)


def test_another_shape_has_another_digest():
    digests = {make(5e-3, d).digest for make in STYLES.values() for d in (1e-3, 1.1e-3)}
    assert len(digests) == 4


def test_a_missing_style_is_said(tmp_path):
    with pytest.raises(FileError, match=r"There is no relief style “.*gone\.npz”"):
        Style.load(tmp_path / "gone.npz")


def damaged():
    held = {"name": "a", "profile": np.zeros(64), "inner": np.zeros(64)}
    held |= {"height": 5e-3, "depth": 1e-3, "roughness": 0.0}
    yield "it has no depth", {"vertices": np.zeros(3)}
    yield "between 0 and 1", held | {"profile": np.full(64, np.nan)}
    yield "between 0 and 1", held | {"profile": np.linspace(0, 9, 64)}
    yield "8 to 65536 samples", held | {"profile": np.zeros(2)}
    yield "differ in their number", held | {"inner": np.zeros(65)}
    yield "sizes are not positive", held | {"height": 0.0}
    yield "sizes are not positive", held | {"depth": -1.0}
    yield "size along and up", held | {"texture": np.zeros((4, 4)), "size": np.zeros(2)}
    yield "not a number", held | {"texture": np.full((4, 4), np.inf), "size": np.ones(2)}
    yield "at most 2048", held | {"texture": np.zeros((1, 4000)), "size": np.ones(2)}


@pytest.mark.parametrize(("reason", "held"), list(damaged()))
def test_what_is_no_style_is_said(tmp_path, reason, held):
    path = tmp_path / "probe.npz"
    np.savez(path, **held)
    with pytest.raises(FileError, match=f"“probe.npz” is no relief style .*({reason})"):
        Style.load(path)


def test_a_file_that_is_no_archive_or_brings_code_is_refused(tmp_path):
    path = tmp_path / "probe.npz"
    path.write_text("v 0 0 0")
    with pytest.raises(FileError, match="is no relief style"):
        Style.load(path)
    np.savez(path, name=np.array([print], dtype=object))
    with pytest.raises(FileError, match="is no relief style"):
        Style.load(path)


def test_another_ending_is_refused(tmp_path):
    with pytest.raises(FileError, match=r"call it “probe.npz”"):
        scanned().save(tmp_path / "probe.ply")
    assert not list(tmp_path.iterdir())


def drawn(count=65):
    along = np.linspace(0, 4e-3, count)
    return np.column_stack([1e-3 * np.sin(np.pi * along / 4e-3) ** 2, along])


def test_a_drawn_line_is_a_profile_in_either_direction():
    for line in (drawn(), drawn()[::-1], drawn() + np.array([5.0, -2.0])):
        profile, height, depth = profile_of(line)
        assert (height, depth) == (pytest.approx(4e-3), pytest.approx(1e-3))
        phase = np.linspace(0, 1, 65)
        assert profile.at(phase) == pytest.approx(np.sin(np.pi * phase) ** 2, abs=1e-9)


def test_ends_that_nearly_meet_are_made_to():
    line = drawn()
    line[:, 0] += np.linspace(0, 1e-5, len(line))
    profile, _, _ = profile_of(line)
    assert np.abs(np.diff(np.append(profile.offsets, profile.offsets[0]))).max() < 0.01


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ([[0, 0], [1, 2], [2, 1], [0, 3]], "“Bézier ä” doubles back"),
        ([[0, 0], [1, 1], [0, 1], [0, 3]], "“Bézier ä” doubles back"),
        ([[1, 0], [1, 1]], "“Bézier ä” is a straight line"),
        ([[0, 0], [1, 1], [0.5, 2]], "“Bézier ä” ends 500 mm from where it starts"),
        ([[0, 0]], "“Bézier ä” has no line"),
        ([[0, 0], [np.nan, 1], [0, 2]], "“Bézier ä” has no line"),
    ],
)
def test_a_line_that_cannot_be_a_layer_is_said(line, reason):
    with pytest.raises(ParameterError, match=reason):
        profile_of(line, "“Bézier ä”")


def test_a_path_may_be_text(tmp_path):
    style = scalloped(5e-3, 1e-3)
    style.save(str(tmp_path / "bead.npz"))
    assert Style.load(str(tmp_path / "bead.npz")).digest == style.digest
