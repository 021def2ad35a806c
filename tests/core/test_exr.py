"""Data images come back bit for bit, and stand upright in other programs."""

import numpy as np
import OpenEXR
import pytest
from heliform.engines.core import exr
from heliform.engines.core.errors import FileError

META = {
    "quantity": "Illuminance",
    "unit": "lx",
    "seed": 2**60,
    "seconds": 1.25,
    "type": "a name that EXR keeps for itself",
    "repaired": True,
    "empty": "",
    "nothing": None,
    "place": "Zürich, 東京",
    "parameters": {"landed": 2_000_000, "bands": [1.5, 2.0]},
}


def channels() -> dict:
    rng = np.random.default_rng(1)
    plain = rng.random((5, 7), dtype=np.float32)
    odd = plain.copy()
    odd[0, :4] = [np.nan, np.inf, -np.inf, -0.0]
    odd[1, 0] = np.float32(1e-42)
    return {"Y": plain, "caustic.Y": odd, "Vase ä/1.half_width": plain * 1e30}


def test_channels_and_meta_come_back_equal(tmp_path):
    saved = channels()
    exr.save(tmp_path / "Vase ä 1.exr", saved, META)
    loaded, meta = exr.load(tmp_path / "Vase ä 1.exr")
    assert meta == META
    assert loaded.keys() == saved.keys()
    for name, values in saved.items():
        assert loaded[name].dtype == np.float32
        np.testing.assert_array_equal(loaded[name].view(np.uint32), values.view(np.uint32))


def test_the_bottom_row_is_the_last_scanline(tmp_path):
    values = np.zeros((4, 3), dtype=np.float32)
    values[0] = 1
    exr.save(tmp_path / "a.exr", {"Y": values}, {})
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        np.testing.assert_array_equal(file.channels()["Y"].pixels[:, 0], [0, 0, 0, 1])


def test_scalars_stand_in_the_header_for_other_programs(tmp_path):
    exr.save(tmp_path / "a.exr", channels(), META)
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        header = dict(file.header())
    assert header["heliform.unit"] == "lx"
    assert header["heliform.seconds"] == 1.25
    assert header["heliform.seed"] == str(2**60)
    assert "heliform.parameters" not in header


def test_an_image_of_another_program_loads_with_empty_meta(tmp_path):
    half = np.arange(12, dtype=np.float16).reshape(3, 4)
    with OpenEXR.File({}, {"R": half, "G": half, "B": half}) as file:
        file.write(str(tmp_path / "a.exr"))
    loaded, meta = exr.load(tmp_path / "a.exr")
    assert meta == {}
    assert loaded.keys() == {"R", "G", "B"}
    assert loaded["G"].dtype == np.float32
    np.testing.assert_array_equal(loaded["G"][0], [8, 9, 10, 11])


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(FileError, match=r"no image “a\.exr” in the folder"):
        exr.load(tmp_path / "a.exr")


@pytest.mark.parametrize("share", [0.0, 0.01, 0.3, 0.6, 0.99])
def test_a_file_cut_short_is_told(tmp_path, share):
    path = tmp_path / "a.exr"
    exr.save(path, {"Y": np.random.default_rng(0).random((64, 64), dtype=np.float32)}, META)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(FileError, match="damaged"):
        exr.load(path)


def test_something_else_is_told(tmp_path):
    (tmp_path / "a.exr").write_text("not an image")
    with pytest.raises(FileError, match="damaged or not an OpenEXR image"):
        exr.load(tmp_path / "a.exr")


def test_a_folder_that_is_not_there_is_told(tmp_path):
    with pytest.raises(FileError, match="nowhere"):
        exr.save(tmp_path / "nowhere" / "a.exr", channels(), {})
