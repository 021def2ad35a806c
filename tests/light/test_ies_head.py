"""What the numbers at the head of a photometric file do, and the lamp's own factors."""

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, SceneError
from heliform.engines.core.scene import Lamp, Luminaire
from heliform.engines.light import luminaires
from heliform.engines.light.ies import read_ies, sample_path
from heliform.engines.light.photometry import intensity_at, luminous_flux
from light import scenes
from light.test_photometry import HEADERS, ies_text


@pytest.fixture
def read(tmp_path):
    def write_and_read(**changes):
        path = tmp_path / "Lampe ä 1.ies"
        path.write_text(ies_text(**changes), encoding="utf-8")
        return read_ies(path)

    return write_and_read


def source(**lamp):
    return luminaires.source(Luminaire("Lämp/1", Lamp(**lamp), scenes.at(z=1.0)))


# The factors of the file


@pytest.mark.parametrize("year", HEADERS)
@pytest.mark.parametrize(
    ("change", "light", "stated"),
    [
        ({"multiplier": 2.5}, 2.5, 1000),
        ({"ballast": 0.8}, 0.8, 1000),
        ({"ballast_lamp": 0.5}, None, 1000),
        ({"lamps": 3}, 1, 3000),
        ({"lumens": 1500}, 1, 1500),
        ({"watts": 77}, 1, 1000),
    ],
)
def test_each_number_has_its_own_effect(read, year, change, light, stated):
    """Candela values are those of all lamps together; lumens are each lamp's."""
    if light is None:
        light = 0.5 if year < 1995 else 1
    plain, lamp = read(year=year), read(year=year, **change)
    assert lamp.intensity == pytest.approx(plain.intensity * light)
    assert luminous_flux(lamp) == pytest.approx(luminous_flux(plain) * light)
    assert lamp.flux == stated
    assert lamp.notes == ()


def test_absolute_photometry_has_the_flux_of_its_intensity(read):
    relative, absolute = read(), read(lumens=-1, lamps=4, multiplier=2)
    assert absolute.intensity == pytest.approx(2 * relative.intensity)
    assert absolute.flux == luminous_flux(absolute)
    assert absolute.notes == ()


@pytest.mark.parametrize("lumens", [0, -2])
def test_a_flux_that_is_none_is_read_as_absolute_and_told(read, lumens):
    lamp = read(lumens=lumens)
    assert lamp.flux == luminous_flux(lamp)
    assert lamp.notes == (
        f"“Lampe ä 1.ies” states {lumens} lm a lamp; it was read as −1, absolute photometry.",
    )


def test_the_code_of_2019_is_no_factor(read):
    """Its place held the ballast-lamp factor; 1.10000 says where the data come from."""
    assert read(year=2019, ballast_lamp="1.10000").intensity.max() == 100
    assert read(year=2019, ballast_lamp=0).intensity.max() == 100


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"multiplier": 0}, "Line 3 of .* states a multiplier of 0, with which there is no light"),
        ({"ballast": 0}, "Line 5 of .* states a ballast factor of 0"),
        ({"ballast": -1}, "Line 5 of .* states a ballast factor of -1"),
        ({"year": 1991, "ballast_lamp": 0}, "Line 5 of .* states a ballast-lamp factor of 0"),
        ({"lamps": 0}, "Line 3 of .* states 0 lamps, not a whole number from 1 on"),
        ({"lamps": 1.5}, "Line 3 of .* states 1.5 lamps"),
        ({"kind": 1.5}, "Line 3 of .* photometric type 1.5, which does not exist"),
        ({"label": "[TEST] 1\n[MORE] 2", "kind": 0}, "Line 5 of .* photometric type 0"),
        ({"tilt": "INCLUDE\n1 1\n0\n1", "units": 3}, "Line 6 of .* unit type 3"),
    ],
)
def test_bad_heads_are_told_in_one_sentence(read, change, says):
    with pytest.raises(FileError, match=says) as error:
        read(**change)
    assert "“Lampe ä 1.ies”" in str(error.value)
    assert str(error.value).endswith(".")


# Openings that are solids


@pytest.mark.parametrize(
    ("year", "sizes", "expected", "solid"),
    [
        (2002, (0.2, 0.6, 0.1), ("rectangular", 0.2, 0.6), "a box with luminous sides"),
        (2002, (-0.2, -0.2, 0.5), ("round", 0.2, 0.2), "an upright cylinder"),
        (1995, (-0.2, 0, 0.5), ("round", 0.2, 0.2), "an upright cylinder"),
        (2002, (-0.2, -0.3, 0.5), ("round", 0.2, 0.3), "an upright cylinder"),
        (2019, (-0.2, -0.2, -0.2), ("round", 0.2, 0.2), "a sphere"),
        (1995, (-0.2, 0, -0.2), ("round", 0.2, 0.2), "a sphere"),
        (2002, (-0.1, 1.2, -0.1), ("rectangular", 0.1, 1.2), "a lying cylinder"),
        (2002, (1.2, -0.1, -0.1), ("rectangular", 1.2, 0.1), "a lying cylinder"),
        (1995, (0, 1.2, -0.1), ("rectangular", 0.1, 1.2), "a lying cylinder"),
        (2002, (-0.3, 0, -0.3), ("rectangular", 0.3, 0), "an upright disc"),
        (2002, (-0.3, 0, -0.2), ("rectangular", 0.3, 0), "an upright disc"),
        (2002, (0.6, 0, 0.2), ("rectangular", 0.6, 0), "an upright face"),
        (1991, (0, 0.6, 0.2), ("rectangular", 0, 0.6), "an upright face"),
        (2002, (0, 0, 0.4), ("point", 0, 0), "an upright line"),
    ],
)
def test_a_solid_is_taken_as_its_outline_and_told(read, year, sizes, expected, solid):
    lamp = read(year=year, opening=sizes)
    assert (lamp.opening, lamp.width, lamp.length) == expected
    assert lamp.height == abs(sizes[2])
    assert lamp.notes == (
        f"“Lampe ä 1.ies” has a luminous opening that is {solid}; light leaves from its outline "
        "seen from below, at one height.",
    )


@pytest.mark.parametrize("sizes", [(0, 0, 0), (0.2, 0.6, 0), (-0.2, -0.3, 0), (0, 1.2, 0)])
def test_a_level_opening_needs_no_note(read, sizes):
    assert read(opening=sizes).notes == ()


def test_notes_reach_the_source(tmp_path, read):
    read(opening=(-0.2, -0.2, -0.2))
    file = str(tmp_path / "Lampe ä 1.ies")
    assert "a sphere" in source(file=file).notes[0]
    assert source(source="disk", flux=10.0).notes == ()


# The lamp's multiplier

KINDS = [
    {"source": "ies"},
    {"source": "ies", "flux": 200.0},
    {"source": "disk", "flux": 200.0},
    {"source": "point", "flux": 200.0},
    {"source": "beam", "flux": 200.0},
]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("factor", [0.25, 3.0])
def test_a_multiplier_dims_every_kind_of_source(kind, factor):
    plain, dimmed = source(**kind), source(**kind, multiplier=factor)
    assert dimmed.flux == pytest.approx(factor * plain.flux)
    assert source(**kind, multiplier=1.0).flux == plain.flux
    if plain.distribution is not None and dimmed.distribution is not None:
        gamma = np.arange(0, 90, 7.0)
        before = intensity_at(plain.distribution, gamma, 20)
        assert intensity_at(dimmed.distribution, gamma, 20) == pytest.approx(factor * before)
        assert luminous_flux(dimmed.distribution) == pytest.approx(dimmed.flux)


def test_a_multiplier_leaves_the_shape_and_the_file_alone():
    sample = read_ies(sample_path())
    dimmed = source(multiplier=0.5)
    assert (dimmed.shape, dimmed.width) == ("round", 0.05)
    assert luminous_flux(read_ies(sample_path())) == luminous_flux(sample)


@pytest.mark.parametrize("kind", KINDS)
def test_a_multiplier_of_0_is_told_and_the_lamp_named(kind):
    with pytest.raises(SceneError, match=r"Lamp “Lämp/1” has a multiplier of 0 and sends no light"):
        source(**kind, multiplier=0.0)


@pytest.mark.parametrize("flux", [0.0, 100.0])
def test_a_dark_file_is_told_and_the_lamp_named(tmp_path, read, flux):
    read(candela=((0, 0, 0),))
    with pytest.raises(SceneError, match=r"Lamp “Lämp/1” sends no light: the intensity .* is 0"):
        source(file=str(tmp_path / "Lampe ä 1.ies"), flux=flux)
