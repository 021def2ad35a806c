"""Photometric files read back as they were written; fluxes and angles against closed forms."""

import runpy
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, ParameterError
from heliform.engines.light.ies import read_ies, sample_path
from heliform.engines.light.photometry import (
    Photometry,
    beam_angle,
    field_angle,
    intensity_at,
    isotropic,
    lambertian,
    luminous_flux,
    scaled_to,
)
from hypothesis import given, settings
from hypothesis import strategies as st

HEADERS = {
    1986: "A lamp of 1986",
    1991: "IESNA91",
    1995: "IESNA:LM-63-1995",
    2002: "IESNA:LM-63-2002",
    2019: "IES:LM-63-2019",
}


def ies_text(
    *,
    year=2002,
    label="",
    tilt="NONE",
    lamps=1,
    lumens=1000.0,
    multiplier=1,
    vertical=(0, 45, 90),
    horizontal=(0,),
    candela=((100, 50, 0),),
    kind=1,
    units=2,
    opening=(0, 0, 0),
    ballast=1,
    ballast_lamp=1,
    watts=10,
):
    """A small LM-63 file, one row of candela a line."""

    def words(values):
        return " ".join(str(v) for v in values)

    return "\n".join(
        [
            HEADERS[year] + ("\n" + label if label else ""),
            f"TILT={tilt}",
            words([lamps, lumens, multiplier, len(vertical), len(horizontal), kind, units]),
            words(opening),
            words([ballast, ballast_lamp, watts]),
            words(vertical),
            words(horizontal),
            *(words(row) for row in candela),
        ]
    )


@pytest.fixture
def read(tmp_path):
    """Write an LM-63 file, and read it."""

    def write_and_read(text=None, **changes):
        path = tmp_path / "Lampe ä 1.ies"
        path.write_text(text if text is not None else ies_text(**changes), encoding="utf-8")
        return read_ies(path)

    return write_and_read


def cosine_power(n, step=0.25):
    gamma = np.arange(0.0, 90.0 + step / 2, step)
    plane = 1000 * np.sin(np.radians(90 - gamma)) ** n
    return Photometry(gamma, np.array([0.0, 360.0]), np.stack([plane, plane]), flux=1.0)


# What a distribution says


def test_isotropic_light_has_the_same_intensity_everywhere():
    lamp = isotropic(4 * np.pi)
    assert luminous_flux(lamp) == pytest.approx(4 * np.pi, rel=1e-12)
    assert intensity_at(lamp, [0, 33.3, 180], [0, 77, 359.9]) == pytest.approx(1.0)
    assert beam_angle(lamp) == 360


def test_lambertian_light_follows_the_cosine():
    lamp = lambertian(np.pi)
    gamma = np.array([0, 30, 60, 89.75])
    assert intensity_at(lamp, gamma, 12) == pytest.approx(np.cos(np.radians(gamma)))
    assert intensity_at(lamp, [90, 90.001, 180], 0).tolist() == [0, 0, 0]
    assert luminous_flux(lamp) == pytest.approx(np.pi, rel=2e-6)
    assert beam_angle(lamp) == pytest.approx(120, abs=1e-3)
    assert field_angle(lamp) == pytest.approx(2 * np.degrees(np.arccos(0.1)), abs=1e-3)


@pytest.mark.parametrize("n", [1, 2, 5, 20, 80])
def test_flux_of_a_cosine_power(n):
    assert luminous_flux(cosine_power(n)) == pytest.approx(2 * np.pi * 1000 / (n + 1), rel=2e-4)


def test_flux_is_the_integral_of_the_bilinear_intensity_itself():
    random = np.random.default_rng(3)
    vertical, horizontal = np.array([5.0, 20, 21, 90, 170]), np.array([0.0, 40, 200, 360])
    table = random.random((4, 5))
    table[-1] = table[0]
    lamp = Photometry(vertical, horizontal, table, flux=1.0)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    total = 0.0
    for a, b in pairwise(vertical):
        for p, q in pairwise(horizontal):
            gamma, c = (a + b + (b - a) * nodes) / 2, (p + q + (q - p) * nodes) / 2
            light = intensity_at(lamp, gamma[:, None], c) * np.sin(np.radians(gamma))[:, None]
            total += weights @ light @ weights * np.radians(b - a) * np.radians(q - p) / 4
    assert luminous_flux(lamp) == pytest.approx(total, rel=1e-12)


def test_intensity_is_bilinear_and_goes_round():
    lamp = Photometry(
        np.array([0.0, 90.0]),
        np.array([0.0, 90.0, 360.0]),
        np.array([[0.0, 100.0], [0.0, 200.0], [0.0, 100.0]]),
        flux=1.0,
    )
    assert intensity_at(lamp, 45, 45) == pytest.approx(75)
    assert intensity_at(lamp, [[45], [90]], [0, 90, 225]) == pytest.approx(
        np.array([[50, 100, 75], [100, 200, 150]])
    )
    assert intensity_at(lamp, 90, [-270, 450, 360]) == pytest.approx([200, 200, 100])
    assert intensity_at(lamp, 90.1, 0) == 0


def test_beam_angle_of_each_plane_of_a_lopsided_lamp():
    lamp = Photometry(
        np.array([0.0, 10, 20, 40]),
        np.array([0.0, 90, 180, 270, 360]),
        np.array([[100.0, 100, 0, 0], *[[100, 0, 0, 0]] * 3, [100, 100, 0, 0]]),
        flux=1.0,
    )
    assert beam_angle(lamp) == pytest.approx(15 + 5)
    assert beam_angle(lamp, 90) == pytest.approx(5 + 5)
    assert field_angle(lamp) == pytest.approx(19 + 9)


def test_scaling_keeps_the_shape_and_makes_the_flux():
    lamp = cosine_power(3)
    scaled = scaled_to(lamp, 250.0)
    assert scaled.flux == 250
    assert luminous_flux(scaled) == pytest.approx(250, rel=1e-12)
    assert beam_angle(scaled) == pytest.approx(beam_angle(lamp))


@pytest.mark.parametrize("flux", [0.0, -5.0, np.inf, np.nan])
def test_a_flux_must_be_positive(flux):
    for make in (isotropic, lambertian, lambda f: scaled_to(cosine_power(1), f)):
        with pytest.raises(ParameterError, match="above 0 lm"):
            make(flux)


def test_a_dark_distribution_cannot_be_scaled():
    dark = replace(cosine_power(1), intensity=np.zeros((2, 361)), name="Nacht")
    with pytest.raises(ParameterError, match="“Nacht” is dark"):
        scaled_to(dark, 100)


# Reading


@pytest.mark.parametrize("year", HEADERS)
def test_every_edition(read, year):
    lamp = read(year=year, lamps=2, multiplier=3, ballast=0.5, ballast_lamp=0.8, watts=10.8)
    factor = 3 * 0.5 * (0.8 if year < 1995 else 1)
    assert lamp.intensity == pytest.approx(np.array([[100, 50, 0]] * 2) * factor)
    assert lamp.flux == 2000
    assert lamp.watts == 10.8
    assert lamp.intensity.dtype == lamp.vertical.dtype == lamp.horizontal.dtype == np.float64
    assert lamp.name == ("A lamp of 1986" if year == 1986 else "Lampe ä 1")


def test_absolute_photometry_takes_the_integral_for_its_flux(read):
    lamp = read(lumens=-1)
    assert lamp.flux == luminous_flux(lamp) > 0


def test_keywords_and_their_further_lines(read):
    lamp = read(
        label="[TEST] 7\n[LUMINAIRE] Spot ö\n[MORE] with lens\n[other]a\n[OTHER] b\n[_OWN]\nstray"
    )
    assert lamp.keywords == {
        "TEST": "7",
        "LUMINAIRE": "Spot ö\nwith lens",
        "OTHER": "a\nb",
        "_OWN": "",
    }
    assert lamp.name == "Spot ö with lens"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1"])
def test_encodings_and_line_ends(tmp_path, encoding):
    path = tmp_path / "a.ies"
    text = ies_text(label="[LUMINAIRE] Größe").replace("\n", "\r\n") + "\r\n\x1a"
    path.write_bytes(text.encode(encoding))
    lamp = read_ies(str(path))
    assert lamp.name == "Größe"
    assert lamp.intensity[0].tolist() == [100, 50, 0]


def test_numbers_may_be_anywhere_between_commas_and_line_ends(read):
    numbers = "1,-1 1\n3 1\n1 2 0, 0,0 1 1\n1E1 0 .5e2\n90.\n+0 1e2\n\n5,0"
    lamp = read("IESNA91\n tilt = none \n" + numbers)
    assert lamp.vertical.tolist() == [0, 50, 90]
    assert lamp.intensity[1].tolist() == [100, 5, 0]
    assert lamp.watts == 10


def planes_read(read, horizontal, values, at):
    """Intensity at the angles ``at`` of a file whose planes have the constant ``values``."""
    lamp = read(horizontal=horizontal, candela=[(v, v, v) for v in values])
    assert lamp.horizontal[0] == 0
    assert lamp.horizontal[-1] == 360
    assert np.all(np.diff(lamp.horizontal) > 0)
    assert lamp.intensity[0].tolist() == lamp.intensity[-1].tolist()
    return intensity_at(lamp, 30, at)


def test_axial_symmetry(read):
    assert planes_read(read, [0], [7], [0, 100, 359]) == pytest.approx(7)
    assert read().horizontal.tolist() == [0, 360]


def test_quadrant_symmetry(read):
    at = [0, 30, 90, 150, 180, 210, 270, 330, 360]
    light = planes_read(read, [0, 30, 90], [1, 2, 3], at)
    assert light == pytest.approx([1, 2, 3, 2, 1, 2, 3, 2, 1])


def test_half_symmetry(read):
    light = planes_read(read, [0, 60, 180], [1, 2, 3], [0, 60, 180, 300, 240])
    assert light == pytest.approx([1, 2, 3, 2, 2.5])


def test_half_symmetry_about_the_plane_across(read):
    at = [90, 180, 200, 270, 340, 0, 45]
    light = planes_read(read, [90, 180, 200, 270], [1, 2, 5, 7], at)
    assert light == pytest.approx([1, 2, 5, 7, 5, 2, 1.5])
    light = planes_read(read, [90, 170, 200, 270], [1, 2, 5, 7], [0, 10, 180, 340, 360])
    assert light == pytest.approx([3, 2, 3, 5, 3])


def test_no_symmetry_with_or_without_the_last_plane(read):
    for planes in ([0, 90, 180, 270], [0, 90, 180, 270, 360]):
        light = planes_read(read, planes, [1, 2, 3, 4, 1][: len(planes)], [0, 180, 270, 315])
        assert light == pytest.approx([1, 3, 4, 2.5])


def test_a_symmetric_file_has_the_flux_of_its_full_form(read):
    quadrant = read(horizontal=(0, 45, 90), candela=[(9, 5, 1), (9, 7, 2), (9, 4, 3)], lumens=-1)
    full = read(
        horizontal=range(0, 361, 45),
        candela=[(9, 5, 1), (9, 7, 2), (9, 4, 3), (9, 7, 2)] * 2 + [(9, 5, 1)],
        lumens=-1,
    )
    assert quadrant.flux == pytest.approx(full.flux, rel=1e-12)


@pytest.mark.parametrize(
    ("year", "sizes", "expected"),
    [
        (2002, (0, 0, 0), ("point", 0, 0, 0)),
        (2002, (0.2, 0.6, 0), ("rectangular", 0.2, 0.6, 0)),
        (2002, (0.2, 0.6, 0.1), ("rectangular", 0.2, 0.6, 0.1)),
        (1991, (0, 1.2, 0), ("rectangular", 0, 1.2, 0)),
        (2002, (-0.2, -0.2, 0), ("round", 0.2, 0.2, 0)),
        (1991, (-0.2, 0, 0), ("round", 0.2, 0.2, 0)),
        (2002, (-0.2, -0.3, 0), ("round", 0.2, 0.3, 0)),
        (1995, (-0.2, 0.3, 0), ("round", 0.2, 0.3, 0)),
        (1995, (0.2, -0.3, -0.1), ("round", 0.2, 0.3, 0.1)),
        (2002, (-0.2, -0.2, 0.5), ("round", 0.2, 0.2, 0.5)),
        (2019, (-0.2, -0.2, -0.2), ("round", 0.2, 0.2, 0.2)),
        (1995, (-0.2, 0, -0.2), ("round", 0.2, 0.2, 0.2)),
        (1995, (0, 1.2, -0.1), ("rectangular", 0.1, 1.2, 0.1)),
        (1995, (1.2, 0, -0.1), ("rectangular", 1.2, 0.1, 0.1)),
        (2002, (-0.1, 1.2, -0.1), ("rectangular", 0.1, 1.2, 0.1)),
        (2002, (1.2, -0.1, -0.1), ("rectangular", 1.2, 0.1, 0.1)),
    ],
)
def test_openings_in_metres_and_feet(read, year, sizes, expected):
    for units, metre in ((2, 1.0), (1, 0.3048)):
        lamp = read(year=year, opening=sizes, units=units)
        assert lamp.opening == expected[0]
        sizes_read = (lamp.width, lamp.length, lamp.height)
        assert sizes_read == pytest.approx([size * metre for size in expected[1:]])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is not an IES LM-63 file"),
        ("solid teapot\nfacet normal 0 0 1\n", "is not an IES LM-63 file"),
        ("IESNA91\nTILT=NONE\n1 2 3", "ends in line 3 after 3 of 13"),
        (ies_text()[:-9], "Line 3 of .* asks for 7 values .* and 4 follow line 5"),
        (ies_text() + " 5", "Line 3 of .* asks for 7 values .* and 8 follow line 5"),
        (ies_text(candela=[(1, "1O0", 2)]), "Line 8 of .* has “1O0” where a number belongs"),
        (ies_text(candela=[(1, "nan", 2)]), "Line 8 of .* has “nan”"),
        (ies_text(candela=[(1, "1e999", 2)]), "Line 8 of .* has “1e999”"),
        (
            ies_text(candela=[(1, -4, 2)]),
            "Line 8 of .* has -4 cd at the vertical angle 45°, horizontal 0°",
        ),
        (ies_text(multiplier=-1), "Line 3 of .* states a multiplier of -1"),
        (ies_text(multiplier="1e300", ballast="1e300"), "Line 8 of .* has inf cd"),
        (ies_text(vertical=(0, 95, 90)), "vertical angles that do not ascend .95° is followed by"),
        (ies_text(vertical=(0, 90, 190)), "vertical angles from 0° to 190°"),
        (ies_text(vertical=(-90, 0, 90)), "vertical angles from -90° to 90°"),
        (ies_text(horizontal=(0, 0), candela=[(1, 2, 3)] * 2), "horizontal angles that do not"),
        (ies_text(horizontal=(0, 45), candela=[(1, 2, 3)] * 2), "horizontal angles from 0° to 45°"),
        (ies_text(horizontal=(30,)), "horizontal angles from 30° to 30°"),
        (ies_text(vertical=(0,), candela=[(1,)]), "states 1 vertical angles"),
        (ies_text().replace(" 3 1 1 2", " 3.5 1 1 2"), "states 3.5 vertical angles"),
        (ies_text().replace(" 3 1 1 2", " -3 1 1 2"), "states -3 vertical angles"),
        (ies_text().replace(" 3 1 1 2", " 3 0 1 2"), "states 0 horizontal angles"),
        (ies_text(kind=4), "Line 3 of .* type 4, which does not exist"),
        (ies_text(units=0), "Line 3 of .* unit type 0, which does not exist"),
    ],
)
def test_bad_files_are_told_in_one_sentence(read, text, says):
    with pytest.raises(FileError, match=says) as error:
        read(text)
    assert "“Lampe ä 1.ies”" in str(error.value)
    assert str(error.value).endswith(".")
    assert "\n" not in str(error.value)


def test_missing_and_unreadable_files(tmp_path):
    with pytest.raises(FileError, match=r"no photometric file .*nowhere.ies”; check its path"):
        read_ies(tmp_path / "nowhere.ies")
    with pytest.raises(FileError, match="cannot be read"):
        read_ies(tmp_path)


@st.composite
def files(draw):
    """The text of a random Type C file with its angles and candela values."""
    angle = st.floats(0, 90).map(lambda a: round(a, 3))
    vertical = sorted(draw(st.sets(angle, min_size=2, max_size=8)))
    last = draw(st.sampled_from([0, 90, 180, 360]))
    inner = draw(st.sets(st.integers(1, max(last - 1, 1)), max_size=4)) if last else set()
    horizontal = sorted({0, last} | inner)
    value = st.floats(0, 1e6)
    row = st.lists(value, min_size=len(vertical), max_size=len(vertical))
    candela = [draw(row) for _ in horizontal]
    if last == 360:
        candela[-1] = candela[0]
    text = ies_text(
        year=draw(st.sampled_from(list(HEADERS))),
        vertical=vertical,
        horizontal=horizontal,
        candela=candela,
    )
    header, body = text.split("TILT=NONE\n")
    words = body.split()
    gaps = draw(st.lists(st.sampled_from([" ", ",", ", ", "\n", "\r\n", "  "]), min_size=1))
    mixed = "".join(word + gaps[k % len(gaps)] for k, word in enumerate(words))
    return header + "TILT=NONE\n" + mixed, vertical, horizontal, candela


@given(files())
@settings(max_examples=80, deadline=None)
def test_what_is_written_is_read_back(tmp_path_factory, file):
    text, vertical, horizontal, candela = file
    path = tmp_path_factory.mktemp("ies") / "random.ies"
    path.write_bytes(text.encode())
    lamp = read_ies(path)
    assert lamp.vertical.tolist() == vertical
    planes = np.searchsorted(lamp.horizontal, horizontal)
    assert lamp.horizontal[planes].tolist() == horizontal
    assert lamp.intensity[planes].tolist() == candela


# The shipped sample


def test_the_sample_is_what_its_formula_says():
    tool = Path(__file__).parents[2] / "tools" / "make_par20.py"
    formula = runpy.run_path(str(tool))
    assert sample_path().read_text(encoding="ascii") == formula["par20_text"]()
    lamp = read_ies(sample_path())
    shape = formula["relative_intensity"](lamp.vertical)
    assert lamp.intensity[0] == pytest.approx(lamp.intensity[0, 0] * shape, abs=0.01)


def test_the_sample_keeps_what_it_states():
    lamp = read_ies(sample_path())
    assert lamp.flux == 500
    assert luminous_flux(lamp) == pytest.approx(500, rel=1e-4)
    assert beam_angle(lamp) == pytest.approx(25, abs=0.01)
    assert 35 < field_angle(lamp) < 50
    assert (lamp.opening, lamp.width, lamp.length, lamp.watts) == ("round", 0.05, 0.05, 10.8)
    assert "assumptions of Heliform's, not a manufacturer's" in lamp.keywords["OTHER"].replace(
        "\n", " "
    )
    assert np.all(np.diff(lamp.intensity[0]) <= 0)
    assert np.all(intensity_at(lamp, [30, 45, 60, 80], 0) > 1)
    assert intensity_at(lamp, [90, 91, 180], 0).tolist() == [0, 0, 0]
