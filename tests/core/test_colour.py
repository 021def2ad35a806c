"""Palettes that are even, ranges that suit the data, ticks that are round."""

import time

import numpy as np
import pytest
from heliform.engines.core.colour import (
    Axis,
    ColourScale,
    Display,
    from_oklab,
    scale_for,
    to_oklab,
)
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.parameters import from_table, to_table


def scale(low=0.0, high=1000.0, log=False, palette="viridis") -> ColourScale:
    return ColourScale(low, high, log, palette, "Illuminance", "lx")


def automatic(values, log=False) -> ColourScale:
    return ColourScale.automatic(np.array(values, dtype=float), log, "viridis", "Illuminance", "lx")


def test_oklab_agrees_with_its_published_values():
    # White, red and blue [Ottosson 2020].
    lab = to_oklab([[1, 1, 1], [1, 0, 0], [0, 0, 1]])
    truth = [[1, 0, 0], [0.62796, 0.22486, 0.12585], [0.45201, -0.03246, -0.31153]]
    np.testing.assert_allclose(lab, truth, atol=1e-4)


def test_oklab_and_back_is_the_same_colour():
    srgb = np.random.default_rng(0).random((50, 3))
    np.testing.assert_allclose(from_oklab(to_oklab(srgb)), srgb, atol=1e-9)


def test_viridis_is_even():
    lab = to_oklab(scale().table()[::5] / 255)
    steps = np.linalg.norm(np.diff(lab, axis=0), axis=1)
    assert (np.diff(lab[:, 0]) > 0).all()
    assert steps.std() / steps.mean() < 0.15


def test_viridis_is_even_in_lightness_alone():
    # Whoever sees no hue at all still reads the order: lightness rises at a steady pace.
    lightness = to_oklab(scale().table() / 255)[:, 0]
    straight = np.linspace(lightness[0], lightness[-1], 256)
    np.testing.assert_allclose(lightness, straight, atol=0.03)


def test_viridis_is_that_of_its_authors():
    # Colours between the anchors, from the published table.
    published = {8: (71, 13, 96), 60: (61, 78, 138), 128: (33, 145, 140), 200: (112, 207, 87)}
    for index, colour in published.items():
        np.testing.assert_allclose(scale().table()[index].astype(int), colour, atol=3)


def test_radiance_palette_follows_its_formula():
    table = scale(palette="radiance").table()
    assert table[0].tolist() == [0, 0, 255]
    assert table[-1].tolist() == [255, 0, 0]
    linear = ((table[175] / 255 + 0.055) / 1.055) ** 2.4
    v = 175 / 255
    np.testing.assert_allclose(linear[:2], [1.6 * v - 0.6, 1.6 - 1.6 * v], atol=0.01)
    assert linear[2] < 0.002


@pytest.mark.parametrize("log", [False, True])
def test_colours_follow_the_table_and_clamp(log):
    it = scale(1.0, 1000.0, log)
    table = it.table()
    colours = it.colours(np.array([-5.0, 0.0, 1.0, 1000.0, 5000.0, np.inf, -np.inf]))
    assert colours.dtype == np.uint8
    np.testing.assert_array_equal(colours, table[[0, 0, 0, -1, -1, -1, 0]])


def test_no_value_is_neutral_grey_and_in_no_palette():
    for palette in ("viridis", "radiance"):
        grey = scale(palette=palette).colours(np.array([np.nan], dtype=np.float32))[0]
        assert len(set(grey.tolist())) == 1
        assert np.abs(scale(palette=palette).table().astype(int) - grey).max(axis=1).min() > 20


def test_position_keeps_shape_and_precision():
    values = np.full((2, 3, 4), 250.0, dtype=np.float32)
    assert scale().position(values).dtype == np.float32
    np.testing.assert_allclose(scale().position(values), 0.25)
    assert scale().position(np.array([500])) == 0.5
    assert scale(1, 100, True).position(10.0) == pytest.approx(0.5)
    assert np.isnan(scale().position(np.nan))


def test_a_map_of_512_by_512_is_coloured_at_once():
    values = np.random.default_rng(0).random((512, 512), dtype=np.float32) * 1200
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        scale(1.0, 1000.0, True).colours(values)
        seconds.append(time.perf_counter() - start)
    assert min(seconds) < 0.015


def labels(low, high, log=False, most=8) -> list[str]:
    return [text.replace("\u2009", " ") for _, text in Axis(low, high, log).ticks(most)]


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0, 1000, "0|200|400|600|800|1000"),
        (0, 1300, "0|200|400|600|800|1000|1200"),
        (0, 1.3, "0|0.2|0.4|0.6|0.8|1.0|1.2"),
        (-3, 7, "−2|0|2|4|6"),
        (0, 45000, "0|10 000|20 000|30 000|40 000"),
        (0, 4e8, "0|1e8|2e8|3e8|4e8"),
        (0, 7e-7, "0|1e-7|2e-7|3e-7|4e-7|5e-7|6e-7|7e-7"),
        (50, 52, "50.0|50.5|51.0|51.5|52.0"),
    ],
)
def test_even_ticks_are_round(low, high, expected):
    assert "|".join(labels(low, high)) == expected


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (1, 1000, "1|3|10|30|100|300|1000"),
        (1.3, 1300, "3|10|30|100|300|1000"),
        (120, 1200, "200|300|500|1000"),
        (0.003, 3, "0.003|0.01|0.03|0.1|0.3|1|3"),
        (1, 1e9, "1|100|10 000|1 000 000|1e8"),
        (200, 300, "200|220|240|260|280|300"),
    ],
)
def test_decade_ticks_are_round(low, high, expected):
    assert "|".join(labels(low, high, log=True)) == expected


@pytest.mark.parametrize("log", [False, True])
def test_ticks_lie_where_their_values_do(log):
    axis = Axis(2.0, 700.0, log)
    for position, text in axis.ticks():
        assert 0 <= position <= 1
        assert position == pytest.approx(axis.position(float(text)))


@pytest.mark.parametrize("most", [2, 3, 5, 8, 12])
@pytest.mark.parametrize("log", [False, True])
def test_there_are_never_more_ticks_than_asked_for(most, log):
    for exponent in np.linspace(-4, 6, 61):
        low = 10**exponent
        for ratio in (1.01, 1.7, 9, 110, 3000, 1e7):
            ticks = Axis(low, low * ratio, log).ticks(most)
            assert 1 <= len(ticks) <= most
            assert len({text for _, text in ticks}) == len(ticks)


def test_the_automatic_range_ignores_a_few_hot_texels():
    values = np.full(10_000, 480.0)
    values[:10] = 1e6
    assert (automatic(values).low, automatic(values).high) == (0.0, 480.0)


def test_a_small_bright_spot_in_the_dark_counts():
    values = np.zeros(10_000)
    values[:5] = 83.0
    assert automatic(values).high == 83.0


def test_the_automatic_range_reaches_below_zero_for_differences():
    values = np.linspace(-50, 120, 1001)
    assert automatic(values).low == -50.0
    assert automatic(values).high == 120.0
    assert automatic(-np.ones(3)).high == 0.0


def test_an_automatic_logarithmic_range_spans_one_to_three_decades():
    wide = automatic(np.geomspace(1e-6, 1e6, 1001), log=True)
    assert wide.high / wide.low == pytest.approx(1000)
    narrow = automatic(np.linspace(90, 100, 1001), log=True)
    assert (narrow.low, narrow.high) == (10.0, 100.0)
    between = automatic(np.linspace(20, 1000, 1001), log=True)
    assert 20 <= between.low <= 30


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize(
    "values", [[0, 0], [np.nan, np.nan], [np.inf], [5, 5], [], [1e-30], [1e30], [np.nan, 3, np.inf]]
)
def test_every_map_gets_a_scale(values, log):
    it = automatic(values, log)
    assert np.isfinite([it.low, it.high]).all()
    assert it.ticks()
    assert it.colours(np.array(values, dtype=np.float32)).shape == (len(values), 3)


def test_a_constant_map_is_on_its_scale():
    assert (automatic([5, 5]).low, automatic([5, 5]).high) == (0.0, 5.0)
    assert automatic([0, 0]).high == 1.0


def test_the_display_decides():
    values = np.array([0.0, 730.0])
    assert scale_for(values, Display(), "Illuminance", "lx").high == 730.0
    by_hand = Display(automatic=False, low=10.0, high=200.0, palette="radiance", log=True)
    expected = ColourScale(10.0, 200.0, True, "radiance", "Illuminance", "lx")
    assert scale_for(values, by_hand, "Illuminance", "lx") == expected
    from_zero = Display(automatic=False, low=0.0, high=2000.0, log=True)
    assert scale_for(values, from_zero, "Illuminance", "lx").low == 2.0
    assert from_table(Display, to_table(by_hand), "display") == by_hand


@pytest.mark.parametrize(
    ("display", "said"),
    [
        (Display(automatic=False, low=5.0, high=5.0), "below its high end"),
        (Display(automatic=False, low=-1.0, high=5.0, log=True), "above zero"),
    ],
)
def test_an_empty_range_is_told(display, said):
    with pytest.raises(ParameterError, match=said):
        scale_for(np.zeros(3), display, "Illuminance", "lx")
