"""Pictures open, stand upright, and carry the colours of the scale."""

import numpy as np
import pytest
from heliform.engines.core import picture
from heliform.engines.core.colour import ColourScale
from heliform.engines.core.errors import FileError
from PIL import Image

SCALE = ColourScale(0.0, 1000.0, False, "viridis", "Illuminance", "lx")


def pixels(path) -> np.ndarray:
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"))


def places(image, colour) -> np.ndarray:
    """Rows and columns of the pixels of that colour."""
    return np.argwhere((image == colour).all(axis=-1))


def test_row_zero_is_at_the_bottom_and_small_maps_are_enlarged(tmp_path):
    values = np.full((16, 16), 500.0)
    values[0, 0] = np.nan  # lower left
    picture.false_colour_png(tmp_path / "a.png", values, SCALE, "Vase ä/1", "± 3 %")
    image = pixels(tmp_path / "a.png")
    grey = places(image, (150, 150, 150))
    map_texels = places(image[:, :540], SCALE.colours(np.array(500.0)))
    assert np.ptp(grey, axis=0).tolist() == [31, 31]
    assert grey[:, 0].max() == map_texels[:, 0].max()
    assert grey[:, 1].min() == map_texels[:, 1].min()


@pytest.mark.parametrize("shape", [(1, 1), (700, 3), (3, 700), (600, 500)])
@pytest.mark.parametrize("words", ["", "a long sentence of many words " * 12, "x" * 300])
def test_every_shape_and_length_of_words_fits_the_page(tmp_path, shape, words):
    picture.false_colour_png(tmp_path / "a.png", np.ones(shape), SCALE, words, words)
    image = pixels(tmp_path / "a.png")
    edges = np.concatenate([image[:4].ravel(), image[-4:].ravel(), image[:, -4:].ravel()])
    assert (edges == 255).all()


@pytest.mark.parametrize("height", [120, 300, 1000])
def test_the_legend_runs_through_the_palette_upward(height):
    legend = picture.legend_image(SCALE, height)
    assert legend.dtype == np.uint8
    assert legend.shape[0] == height
    bar = legend[:, 2]
    table = SCALE.table()
    low, high = places(bar, table[0]), places(bar, table[-1])
    assert low.min() > high.max()


def test_maps_are_drawn_without_any_font_on_the_machine(tmp_path, monkeypatch):
    monkeypatch.setattr(picture, "_FACES", ())
    picture.font_of.cache_clear()
    picture.false_colour_png(
        tmp_path / "a.png", np.ones((8, 8)), SCALE, "Väschen 花 “1”", "± 3 lx/m²"
    )
    assert picture.drawable("Väschen 花: −3 ± 1 lx/m²") == "Vaschen ?: -3 ± 1 lx/m2"
    picture.font_of.cache_clear()


def profile(log=False, **changes) -> dict:
    distance = np.linspace(0, 2, 101)
    values = 100 + 900 * np.exp(-(((distance - 1) / 0.1) ** 2))
    curves = [("Traced", values, values * 0.9, values * 1.1), ("Closed form", values, None, None)]
    return {"distance": distance, "curves": curves, "quantity": "Illuminance", "unit": "lx"} | {
        "log": log,
        **changes,
    }


@pytest.mark.parametrize("log", [False, True])
def test_a_section_is_drawn_with_its_curves(tmp_path, log):
    picture.section_png(tmp_path / "a.png", **profile(log))
    image = pixels(tmp_path / "a.png")
    assert image.shape == (640, 1200, 3)
    for colour in picture._CURVES[:2]:
        assert len(places(image, colour)) > 30


def test_the_peak_of_a_section_is_in_the_middle_and_high(tmp_path):
    section = profile()
    section["curves"] = section["curves"][1:]
    picture.section_png(tmp_path / "a.png", **section)
    rows, columns = places(pixels(tmp_path / "a.png")[100:], picture._CURVES[0]).T
    across = (columns[rows.argmin()] - columns.min()) / np.ptp(columns)
    assert across == pytest.approx(0.5, abs=0.01)
    assert np.ptp(rows) > 300


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("value", [0.0, np.nan, -np.inf, -4.0, 1e-20, 1e20])
def test_odd_sections_are_drawn(tmp_path, log, value):
    values = np.full(101, value)
    values[::2] = np.nan
    curves = [("Odd", values, values, values)]
    picture.section_png(tmp_path / "a.png", **profile(log, curves=curves))
    assert pixels(tmp_path / "a.png").shape == (640, 1200, 3)


def test_a_folder_that_is_not_there_is_told(tmp_path):
    with pytest.raises(FileError, match="nowhere"):
        picture.section_png(tmp_path / "nowhere" / "a.png", **profile())
