"""Index by wavelength, the lamps' whites, the photons' wavelengths and their colour to see."""

import numpy as np
import pytest
from heliform.engines.core import runtime
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.scene import Material
from heliform.engines.light import spectrum
from heliform.engines.light.spectrum import WAVELENGTHS, Bands, ior_at, to_rgb

FLINT = Material(glass="flint")
LAMPS = ["equal-energy", "incandescent", "daylight", "led"]

# Schott's data sheets: wavelength of the line and index to five digits.
CATALOGUE = {
    "crown": {
        706.5188: 1.51289,
        656.2725: 1.51432,
        643.8469: 1.51472,
        632.8: 1.51509,
        589.2938: 1.51673,
        587.5618: 1.51680,
        546.0740: 1.51872,
        486.1327: 1.52238,
        479.9914: 1.52283,
        435.8343: 1.52668,
        404.6561: 1.53024,
    },
    "flint": {
        656.2725: 1.77596,
        587.5618: 1.78472,
        546.0740: 1.79192,
        486.1327: 1.80651,
        435.8343: 1.82533,
        404.6561: 1.84235,
    },
}


def line_and_abbe(material):
    d, f, c = (float(ior_at(material, spectrum.LINES[line])) for line in "dFC")
    return d, (d - 1) / (f - c)


def chromaticity(xyz):
    return xyz[:2] / np.sum(xyz)


def quadrature(bands):
    """∫ c̄ S (n − 1) dλ ÷ ∫ ȳ S dλ for x̄, ȳ and z̄, the products linear between the nodes."""
    fine = np.linspace(380.0, 780.0, 40_001)
    products = bands.power[:, None] * spectrum.MATCHING
    linear = np.stack([np.interp(fine, WAVELENGTHS, product) for product in products.T], 1)
    seen = np.trapezoid(linear * (ior_at(FLINT, fine) - 1)[:, None], fine, axis=0)
    return seen / spectrum.tristimulus(bands.power)[1]


# Glass


@pytest.mark.parametrize(
    ("glass", "index", "abbe"),
    [("crown", 1.51680, 64.17), ("flint", 1.78472, 25.68), ("soda-lime", 1.5234, 63.97)],
)
def test_a_glass_has_its_published_index_and_abbe_number(glass, index, abbe):
    """To the digits published; Rubin's by his formula, worked by hand."""
    found, dispersion = line_and_abbe(Material(glass=glass, ior=1.9, abbe=10.0))
    assert found == pytest.approx(index, abs=1e-4 if glass == "soda-lime" else 5e-6)
    assert dispersion == pytest.approx(abbe, abs=5e-3)


def test_soda_lime_is_close_to_a_measured_one_in_index_but_disperses_less():
    """Schott's B 270: n_C 1.5203, n_d 1.5230, n_F 1.5292, to four digits."""
    line = [spectrum.LINES[name] for name in "CdF"]
    found = ior_at(Material(glass="soda-lime"), line)
    np.testing.assert_allclose(found, [1.5203, 1.5230, 1.5292], atol=8e-4)
    own = ior_at(Material(ior=1.5230, abbe=0.5230 / 0.0089), line)
    np.testing.assert_allclose(own, [1.5203, 1.5230, 1.5292], atol=6e-5)
    assert found[2] - found[0] == pytest.approx(0.0089 * 0.92, abs=1e-4)


def test_water_is_what_two_other_sources_say():
    """Against vacuum 1.3334 and V_d 55.76 by refractiveindex.info; against air n_D 1.33299."""
    water = Material(glass="water")
    d, f, c = (
        float(ior_at(water, spectrum.LINES[line] / spectrum.AIR)) * spectrum.AIR for line in "dFC"
    )
    assert d == pytest.approx(1.3334, abs=5e-5)
    assert (d - 1) / (f - c) == pytest.approx(55.76, abs=0.01)
    assert ior_at(water, 589.2938) == pytest.approx(1.33299, abs=1e-5)


def test_water_agrees_with_the_steam_association():
    """IAPWS R9-97 at 20 °C and 998.207 kg/m³, from violet to red, to 1e-5."""
    wavelength = np.linspace(400.0, 700.0, 31)
    density, temperature, squared = 0.998207, 293.15 / 273.15, (wavelength / 589) ** 2
    refraction = density * (
        0.244257733
        + 9.74634476e-3 * density
        - 3.73234996e-3 * temperature
        + 2.68678472e-4 * squared * temperature
        + 1.58920570e-3 / squared
        + 2.45934259e-3 / (squared - 0.2292020**2)
        + 0.900704920 / (squared - 5.432937**2)
        - 1.66626219e-2 * density**2
    )
    truth = np.sqrt((2 * refraction + 1) / (1 - refraction))
    found = ior_at(Material(glass="water"), wavelength / spectrum.AIR) * spectrum.AIR
    np.testing.assert_allclose(found, truth, atol=1e-5)


@pytest.mark.parametrize("glass", CATALOGUE)
def test_a_prism_bends_each_line_by_the_catalogue(glass):
    """Least deviation of a 60° prism, by Snell's law over all incidences, against the closed form
    2 asin(n sin 30°) − 60° of the catalogue's index; its five digits leave 2e-5 radians."""
    apex, incidence = np.pi / 3, np.linspace(0.6, 1.5, 90_001)
    for wavelength, published in CATALOGUE[glass].items():
        index = ior_at(Material(glass=glass), wavelength)
        leaving = index * np.sin(apex - np.arcsin(np.sin(incidence) / index))
        out = leaving < 1
        least = (incidence[out] + np.arcsin(leaving[out]) - apex).min()
        closed = 2 * np.arcsin(published * np.sin(apex / 2)) - apex
        assert least == pytest.approx(closed, abs=2e-5)


@pytest.mark.parametrize(("index", "abbe"), [(1.5168, 64.17), (1.62, 36.4), (1.9, 15.0)])
def test_own_glass_goes_through_its_index_and_abbe_number(index, abbe):
    found, dispersion = line_and_abbe(Material(ior=index, abbe=abbe))
    assert found == pytest.approx(index, abs=1e-12)
    assert dispersion == pytest.approx(abbe, rel=1e-9)


def test_own_glass_comes_close_to_a_crown_between_the_lines():
    """Two constants stand for six: 1e-3 over the visible, 1e-4 between F and C."""
    own, crown = Material(ior=1.5168, abbe=64.17), Material(glass="crown")
    away = np.abs(ior_at(own, WAVELENGTHS) - ior_at(crown, WAVELENGTHS))
    assert away.max() < 1e-3
    assert away[(WAVELENGTHS > 486) & (WAVELENGTHS < 656)].max() < 1e-4


def test_an_abbe_number_of_0_does_not_disperse_and_a_tiny_one_stays_above_air():
    assert (ior_at(Material(ior=1.7), WAVELENGTHS) == 1.7).all()
    assert ior_at(Material(ior=1.5, abbe=0.1), WAVELENGTHS).min() == 1.0


@pytest.mark.parametrize("glass", ["own", "soda-lime", "crown", "flint", "water"])
def test_the_index_keeps_the_shape_and_falls_with_the_wavelength(glass):
    material = Material(glass=glass, abbe=50.0)
    assert (np.diff(ior_at(material, WAVELENGTHS)) < 0).all()
    assert ior_at(material, WAVELENGTHS[:80].reshape(4, 20)).shape == (4, 20)
    assert ior_at(material, 555.0).shape == ()


# The eye and the lamps


def test_the_matching_functions_are_those_of_mitsuba_and_sum_up_as_cie_says():
    """Mitsuba's table is in float32. The sums are CIE 15's for 380 to 780 nm."""
    mi = runtime.mitsuba()
    theirs = np.stack([np.array(c) for c in mi.cie1931_xyz(mi.Float(WAVELENGTHS))], 1)
    np.testing.assert_allclose(spectrum.MATCHING, theirs, atol=1e-6)
    total = spectrum.MATCHING.sum(0)
    np.testing.assert_allclose(total, [21.371524, 21.371327, 21.371540], atol=2e-6)


def test_daylight_is_the_table_of_d65():
    """CIE's table, as Mitsuba has it, to 2e-4 of the power at 560 nm."""
    mi = runtime.mitsuba()
    theirs = np.array(mi.cie_d65(mi.Float(WAVELENGTHS)))
    at_560 = theirs[WAVELENGTHS == 560]
    np.testing.assert_allclose(spectrum.spectrum("daylight"), theirs / at_560, atol=2e-4)


@pytest.mark.parametrize(
    ("lamp", "x", "y"),
    [
        ("incandescent", 0.4476, 0.4074),
        ("daylight", 0.3127, 0.3290),
        ("equal-energy", 1 / 3, 1 / 3),
    ],
)
def test_a_lamp_has_the_white_of_its_standard(lamp, x, y):
    """To 1e-4, the digits that CIE states."""
    white = Bands(spectrum.spectrum(lamp)).white
    np.testing.assert_allclose(chromaticity(white), [x, y], atol=1e-4)


def test_the_led_has_the_white_of_a_black_body_at_4000_kelvin():
    """To 1e-4 in x and y, some 2 K; two peaks, and less of cyan between them than of either."""
    planck = WAVELENGTHS**-5 / np.expm1(1.4388e7 / WAVELENGTHS / 4000)
    led = spectrum.spectrum("led")
    truth = chromaticity(spectrum.tristimulus(planck))
    np.testing.assert_allclose(chromaticity(Bands(led).white), truth, atol=1e-4)
    blue, cyan, yellow = led[np.searchsorted(WAVELENGTHS, [450, 485, 580])]
    assert blue > 3 * cyan
    assert yellow > 3 * cyan


@pytest.mark.parametrize("lamp", LAMPS)
def test_a_spectrum_is_1_at_560_nm_and_above_0(lamp):
    power = spectrum.spectrum(lamp)
    assert power[WAVELENGTHS == 560] == pytest.approx(1.0)
    assert power.shape == WAVELENGTHS.shape == (81,)
    assert (power > 0).all()


# Photons


@pytest.mark.parametrize("lamp", LAMPS)
def test_the_weights_average_the_lamp_s_white(lamp):
    """To 1e-8 by a million even steps: its Y is 1, so that lumens stay lumens."""
    bands = Bands(spectrum.spectrum(lamp))
    wavelength, weights = bands.draw((np.arange(1_000_000) + 0.5) / 1_000_000)
    assert bands.white[1] == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(weights.mean(0), bands.white, atol=1e-8)
    xyz = spectrum.tristimulus(bands.power)
    np.testing.assert_allclose(bands.white, xyz / xyz[1], rtol=1e-12)
    assert (np.diff(wavelength) > 0).all()
    assert wavelength.min() >= 380
    assert wavelength.max() <= 780


@pytest.mark.parametrize("lamp", LAMPS)
def test_drawn_wavelengths_are_unbiased(lamp):
    """X, Y, Z and the mean index that each sees, of 400,000 photons, to four deviations."""
    bands = Bands(spectrum.spectrum(lamp))
    wavelength, weights = bands.draw(np.random.default_rng(7).random(400_000))
    seen = np.concatenate([weights, weights * (ior_at(FLINT, wavelength) - 1)[:, None]], 1)
    truth = np.concatenate([bands.white, quadrature(bands)])
    deviation = seen.std(0) / np.sqrt(len(seen))
    assert (np.abs(seen.mean(0) - truth) < 4 * deviation).all()


@pytest.mark.parametrize("lamp", LAMPS)
def test_drawn_wavelengths_lie_as_power_times_the_matching_functions(lamp):
    """The share below each node is the quadrature's."""
    bands = Bands(spectrum.spectrum(lamp))
    density = bands.power * spectrum.MATCHING.sum(1)
    share = np.cumsum((density[1:] + density[:-1]) / 2) / np.trapezoid(density)
    wavelength, _ = bands.draw(share[:-1])
    np.testing.assert_allclose(wavelength, WAVELENGTHS[1:-1], atol=1e-6)


def test_a_photon_has_the_colour_of_its_wavelength():
    """At the nodes exactly, whatever the lamp, and the same sum of weights everywhere."""
    bands = Bands(spectrum.spectrum("led"))
    _, weights = bands.draw(np.random.default_rng(1).random((500, 4)))
    assert weights.shape == (500, 4, 3)
    np.testing.assert_allclose(weights.sum(-1), bands.white.sum(), rtol=1e-12)
    density = bands.power * spectrum.MATCHING.sum(1)
    share = np.cumsum((density[1:] + density[:-1]) / 2) / np.trapezoid(density)
    _, weights = bands.draw(share[5:60])
    truth = spectrum.MATCHING[6:61] / spectrum.MATCHING[6:61].sum(1, keepdims=True)
    np.testing.assert_allclose(weights / weights.sum(1, keepdims=True), truth, atol=1e-6)


@pytest.mark.parametrize("lamp", LAMPS)
@pytest.mark.parametrize("size", [16, 256, 1024])
def test_the_table_read_linearly_averages_the_white_exactly(lamp, size):
    """To float32; the index that 256 rows see is the quadrature's to 0.02 % of n − 1."""
    bands = Bands(spectrum.spectrum(lamp))
    table = bands.table(size)
    assert table.shape == (size, 4)
    assert table.dtype == np.float32
    place = np.clip((np.arange(64 * size) + 0.5) / 64 - 0.5, 0, size - 1)
    wavelength, *weights = (np.interp(place, np.arange(size), column) for column in table.T)
    weights = np.stack(weights, 1)
    np.testing.assert_allclose(weights.mean(0), bands.white, atol=1e-6)
    if size >= 256:
        seen = (weights * (ior_at(FLINT, wavelength) - 1)[:, None]).mean(0)
        np.testing.assert_allclose(seen, quadrature(bands), rtol=2e-4)


def test_the_table_follows_what_is_drawn():
    """Wavelengths at the rows' middles; weights near those of the middle, but for the tails."""
    bands = Bands(spectrum.spectrum("daylight"))
    table = bands.table(256)
    wavelength, weights = bands.draw((np.arange(256) + 0.5) / 256)
    np.testing.assert_allclose(table[:, 0], wavelength, rtol=1e-7)
    np.testing.assert_allclose(table[:, 1:], weights, atol=0.02)


def test_a_measured_spectrum_may_have_gaps():
    """A lamp of two lines only: no photon between them, and the weights still average white."""
    power = np.zeros(81)
    power[[20, 50]] = 1.0, 3.0
    bands = Bands(power)
    wavelength, weights = bands.draw((np.arange(200_000) + 0.5) / 200_000)
    near = np.minimum(np.abs(wavelength - 480), np.abs(wavelength - 630))
    assert near.max() <= 5.0
    np.testing.assert_allclose(weights.mean(0), bands.white, atol=1e-5)
    np.testing.assert_allclose(bands.table().mean(0, dtype=float)[1:], bands.white, atol=1e-6)
    assert np.isfinite(bands.draw([0.0, 1.0])[1]).all()


@pytest.mark.parametrize(
    "power", [np.ones(80), np.zeros(81), -np.ones(81), np.full(81, np.nan), np.full(81, np.inf)]
)
def test_what_is_no_spectrum_is_said_to_be_none(power):
    with pytest.raises(ParameterError, match="81 powers"):
        Bands(power)


# Display


@pytest.mark.parametrize("lamp", LAMPS)
def test_light_of_the_lamp_s_colour_stays_neutral(lamp):
    """To 1e-12 for the white itself; for 400,000 photons to four deviations, 1 %."""
    bands = Bands(spectrum.spectrum(lamp))
    lux = np.array([0.0, 1.0, 500.0])
    neutral = to_rgb(lux[:, None] * bands.white, bands.white)
    np.testing.assert_allclose(neutral, np.repeat(lux[:, None], 3, 1), atol=1e-9)
    _, weights = bands.draw(np.random.default_rng(3).random(400_000))
    np.testing.assert_allclose(to_rgb(weights.mean(0), bands.white), 1.0, atol=0.01)


def test_the_primaries_of_rec_709_are_themselves():
    """By IEC 61966-2-1's matrix of four digits."""
    primaries = [[0.4124, 0.2126, 0.0193], [0.3576, 0.7152, 0.1192], [0.1805, 0.0722, 0.9505]]
    np.testing.assert_allclose(to_rgb(primaries, spectrum.D65), np.eye(3), atol=1e-3)


def test_the_eye_adapts_as_css_color_4_says():
    """D50 to D65 by the matrix that W3C gives, whose Bradford constants are rounded too: 1e-4."""
    d50 = np.array([0.3457, 0.3585, 1 - 0.3457 - 0.3585]) / 0.3585
    adapt = np.array(
        [
            [0.9554734527, -0.0230985369, 0.0632593087],
            [-0.0283697070, 1.0099954580, 0.0210413990],
            [0.0123140017, -0.0205076964, 1.3303659366],
        ]
    )
    seen = np.array([0.5, 0.45, 0.3])
    expected = to_rgb(adapt @ seen, spectrum.D65)
    np.testing.assert_allclose(to_rgb(seen, d50), expected, atol=1e-4)


def test_a_pure_spectral_colour_is_clipped_and_keeps_its_hue():
    """Every wavelength is out of Rec. 709; red, green and blue come out where they should."""
    bands = Bands(spectrum.spectrum("equal-energy"))
    rgb = to_rgb(spectrum.MATCHING, bands.white)
    assert (rgb >= 0).all()
    assert (rgb.min(1) < 1e-3).all()
    shown = rgb[np.searchsorted(WAVELENGTHS, [630, 530, 450])]
    assert shown.argmax(1).tolist() == [0, 1, 2]
