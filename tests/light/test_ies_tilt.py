"""What tilting a luminaire does to a lamp that minds how it burns."""

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, SceneError
from heliform.engines.core.scene import Lamp, Luminaire
from heliform.engines.light import luminaires
from heliform.engines.light.ies import read_ies
from heliform.engines.light.photometry import intensity_at, luminous_flux
from heliform.engines.light.tilt import Tilt, lamp_tilt, tilt_factor
from light.test_photometry import ies_text

BLOCK = "{geometry}\n7\n0 15 30 45 60 75 90\n1.0 .95 .94 .90 .88 .87 .94"


def rotation(axis, degrees):
    """Turns about the world's ``axis``, counter-clockwise against it."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    turned = np.eye(3)
    turned[[i, j, i, j], [i, j, j, i]] = c, c, -s, s
    return turned


def hung(tmp_path, text, axes, **lamp):
    """The source of a lamp with the photometric file ``text`` that hangs as ``axes`` say."""
    path = tmp_path / "lamp.ies"
    path.write_text(text)
    pose = np.eye(4)
    pose[:3, :3] = axes
    return luminaires.source(Luminaire("Lämp/1", Lamp(file=str(path), **lamp), pose))


@pytest.fixture
def read(tmp_path):
    def write_and_read(text):
        path = tmp_path / "Lampe ä 1.ies"
        path.write_text(text, encoding="utf-8")
        return read_ies(path)

    return write_and_read


# The factor


def test_factors_are_linear_between_angles_and_fold_at_90():
    tilt = Tilt(1, np.array([0.0, 60, 90]), np.array([1.0, 0.7, 0.8]))
    assert tilt_factor(tilt, [0, 30, 60, 75, 90]) == pytest.approx([1, 0.85, 0.7, 0.75, 0.8])
    assert tilt_factor(tilt, [120, 150, 180]) == pytest.approx([0.7, 0.85, 1])
    assert float(tilt_factor(None, 40)) == 1


def test_factors_to_180_are_taken_as_they_are():
    tilt = Tilt(1, np.array([10.0, 90, 170]), np.array([1.0, 0.6, 0.4]))
    assert tilt_factor(tilt, [0, 50, 130, 180]) == pytest.approx([1, 0.8, 0.5, 0.4])


@pytest.mark.parametrize(
    ("geometry", "axis", "tilts"),
    [
        (1, "x", {0: 0, 30: 30, 90: 90, 140: 140, 180: 180}),
        (1, "y", {0: 0, -30: 30, 90: 90, 140: 140}),
        (1, "z", {0: 0, 77: 0}),
        (2, "x", {0: 0, 30: 0, 90: 0, 140: 0}),
        (2, "y", {0: 0, 30: 30, -30: 30, 90: 90, 140: 40}),
        (3, "x", {0: 0, 30: 30, -30: 30, 90: 90, 140: 40}),
        (3, "y", {0: 0, 30: 0, 90: 0, 140: 0}),
    ],
)
def test_how_far_a_lamp_is_tipped(geometry, axis, tilts):
    """2 stays level when turned about C0, which is X; 3 when turned about C90, which is Y."""
    tilt = Tilt(geometry, np.array([0.0]), np.array([1.0]))
    for turn, tipped in tilts.items():
        for spin in (0, 50):  # turning the whole room changes nothing
            axes = rotation("z", spin) @ rotation(axis, turn)
            assert lamp_tilt(tilt, axes) == pytest.approx(tipped, abs=1e-6)
    assert lamp_tilt(None, rotation("x", 40)) == 0


# Reading


@pytest.mark.parametrize("geometry", [1, 2, 3])
def test_factors_in_the_file_are_kept_beside_the_intensity(read, geometry):
    lamp = read(ies_text(tilt="INCLUDE\n" + BLOCK.format(geometry=geometry)))
    assert lamp.tilt is not None
    assert lamp.tilt.geometry == geometry
    assert lamp.tilt.angles.tolist() == [0, 15, 30, 45, 60, 75, 90]
    assert lamp.tilt.factors.tolist() == [1.0, 0.95, 0.94, 0.90, 0.88, 0.87, 0.94]
    assert lamp.intensity.tolist() == read(ies_text()).intensity.tolist()
    assert read(ies_text()).tilt is None


@pytest.mark.parametrize("named", ["hal.tlt", "HAL.TLT", r"C:\TILT\Hal.tlt", "tables/hal.tlt"])
def test_factors_in_a_file_beside_it(read, tmp_path, named):
    (tmp_path / "hal.tlt").write_text("\n".join(BLOCK.format(geometry=1).split("\n")) + "\r\n\x1a")
    lamp = read(ies_text(tilt=named))
    assert lamp.tilt is not None
    assert float(tilt_factor(lamp.tilt, 60)) == 0.88


# What a luminaire sends


@pytest.mark.parametrize(("geometry", "factor"), [(1, 0.94), (2, 1.0), (3, 0.94)])
def test_a_luminaire_sends_what_its_tilt_leaves(tmp_path, geometry, factor):
    text = ies_text(tilt="INCLUDE\n" + BLOCK.format(geometry=geometry))
    upright = hung(tmp_path, text, np.eye(3))
    tilted = hung(tmp_path, text, rotation("x", 30))
    assert upright.flux == pytest.approx(luminous_flux(read_ies(tmp_path / "lamp.ies")))
    assert tilted.flux == pytest.approx(factor * upright.flux)
    assert tilted.distribution is not None
    assert float(intensity_at(tilted.distribution, 0, 0)) == pytest.approx(100 * factor)


def test_a_factor_for_the_upright_lamp_counts_too(tmp_path):
    text = ies_text(tilt="INCLUDE\n1 2\n0 90\n.9 .5")
    assert hung(tmp_path, text, np.eye(3)).distribution.intensity.max() == pytest.approx(90)


def test_a_stated_flux_is_sent_at_any_tilt(tmp_path):
    text = ies_text(tilt="INCLUDE\n1 2\n0 90\n1 .5")
    assert hung(tmp_path, text, rotation("y", 90), flux=300.0).flux == pytest.approx(300)


def test_a_lamp_that_goes_out_when_tilted_is_named(tmp_path):
    text = ies_text(tilt="INCLUDE\n1 2\n0 90\n1 0")
    with pytest.raises(SceneError, match=r"“Lämp/1” .* tilt factor 0 for 90°; turn the lamp"):
        hung(tmp_path, text, rotation("y", 90))


# Bad ones


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a\nTILT=\n1 2", "Line 2 of .* has nothing after TILT=; write TILT=NONE"),
        ("a\nTILT=INCLUDE\n4 2\n0 90\n1 1", "Line 3 of .* geometry 4, which does not exist"),
        ("a\nTILT=INCLUDE\n1\n0\n", "Line 4 of .* states 0 pairs of tilt angles"),
        ("a\nTILT=INCLUDE\n1 1.5\n", "Line 3 of .* states 1.5 pairs of tilt angles"),
        ("a\nTILT=INCLUDE\n1 2\n90 0\n1 1", "Line 4 of .* tilt angles that do not ascend"),
        ("a\nTILT=INCLUDE\n1 2\n0 190\n1 1", "Line 4 of .* tilt angles from 0° to 190°"),
        ("a\nTILT=INCLUDE\n1 2\n0 90\n1\n-1", "Line 6 of .* tilt factor of -1"),
        ("a\nTILT=INCLUDE\n1 9\n0 5", "ends in line 4 after 2 of 9 tilt angles"),
        ("a\nTILT=INCLUDE\n1 2\n0 5\n1", "ends in line 5 after 1 of 2 tilt factors"),
        ("a\nTILT=INCLUDE", "ends in line 3 after 0 of 2 values that begin the tilt factors"),
        ("a\nTILT=gone.tlt\n1", "Line 2 of .* takes its tilt factors from “gone.tlt”"),
        ("a\nTILT=/etc/gone.tlt\n1", "which is not beside it; put that file into the same folder"),
    ],
)
def test_bad_factors_are_told_in_one_sentence(read, text, says):
    with pytest.raises(FileError, match=says) as error:
        read(text)
    assert "“Lampe ä 1.ies”" in str(error.value)
    assert str(error.value).endswith(".")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("block", "says"),
    [
        ("1 2\n0 90\n1 1\n1 2", "Line 4 of “hal.tlt” goes on after the tilt factors"),
        ("1 2\n0 x\n1 1", "Line 2 of “hal.tlt” has “x” where a number belongs"),
        ("", "“hal.tlt” ends in line 1 after 0 of 2"),
        (None, "The tilt file .*hal.tlt” cannot be read"),
    ],
)
def test_bad_tilt_files_are_told_in_one_sentence(read, tmp_path, block, says):
    if block is None:
        (tmp_path / "hal.tlt").mkdir()
    else:
        (tmp_path / "hal.tlt").write_text(block)
    with pytest.raises(FileError, match=says):
        read(ies_text(tilt="hal.tlt"))
