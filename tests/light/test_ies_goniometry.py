"""Types A and B: where their angles point, and what is left of their light as Type C."""

import re

import numpy as np
import pytest
from heliform.engines.core.errors import FileError
from heliform.engines.core.scene import Lamp, Luminaire
from heliform.engines.light import luminaires
from heliform.engines.light.ies import read_ies
from heliform.engines.light.photometry import intensity_at, luminous_flux
from light import scenes
from light.test_photometry import ies_text

TYPE_B, TYPE_A = 2, 3
ROUND = np.arange(-90, 91, 5.0)


@pytest.fixture
def read(tmp_path):
    """Write a file of one type with the table ``candela`` (H, V), and read it."""

    def write_and_read(kind, vertical, horizontal, candela, **changes):
        text = ies_text(
            kind=kind,
            vertical=list(vertical),
            horizontal=list(horizontal),
            candela=[[repr(float(v)) for v in row] for row in candela],
            **{"lumens": -1, **changes},
        )
        path = tmp_path / "lamp.ies"
        path.write_text(text)
        return read_ies(path)

    return write_and_read


def direction(kind, v, h):
    """Where a Type A or B direction points, built by turning the lamp's axes [LM-75-19]."""

    def turned(angle, axis):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        return np.array(
            {
                "y": [[c, 0, -s], [0, 1, 0], [s, 0, c]],
                "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
                "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
            }[axis]
        )

    if kind == TYPE_A:  # lift the forward axis by V, then turn it clockwise about the vertical
        return turned(-h, "z") @ turned(v, "y") @ [1, 0, 0]
    # swing the nadir by H toward −Y in the plane across, then turn that about the level axis
    return turned(v, "y") @ turned(-h, "x") @ [0, 0, -1]


def type_c(d):
    """γ and C in degrees of a direction."""
    gamma = np.degrees(np.arctan2(np.hypot(d[0], d[1]), -d[2]))
    return gamma, np.degrees(np.arctan2(d[1], d[0])) % 360


def beam(v, h, wide=25.0, at=(0.0, 0.0)):
    v, h = np.asarray(v), np.asarray(h)
    return 1000 * np.exp(
        -(((v[None, :] - at[0]) / wide) ** 2) - ((h[:, None] - at[1]) / wide / 0.6) ** 2
    )


def native_flux(kind, v, h, candela):
    """Flux of a bilinear table in its own coordinates, by Gauss's rule cell by cell."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    total = 0.0
    for j in range(len(h) - 1):
        for i in range(len(v) - 1):
            t = (nodes + 1) / 2
            across = (1 - t)[:, None] * candela[j, [i, i + 1]] + t[:, None] * candela[
                j + 1, [i, i + 1]
            ]
            light = across[:, :1] * (1 - t) + across[:, 1:] * t  # (H, V)
            latitude = (
                (h[j] + (h[j + 1] - h[j]) * t)[:, None]
                if kind == TYPE_B
                else v[i] + (v[i + 1] - v[i]) * t
            )
            cell = weights @ (light * np.cos(np.radians(latitude))) @ weights / 4
            total += cell * np.radians(v[i + 1] - v[i]) * np.radians(h[j + 1] - h[j])
    return total


# Which way the angles go


def test_the_named_directions_of_lm_63():
    """Photometric zero is down, the photometric horizontal is C0, clockwise from there is C270."""
    assert direction(TYPE_B, 0, 0) == pytest.approx([0, 0, -1])
    assert direction(TYPE_B, 90, 0) == pytest.approx([1, 0, 0])
    assert direction(TYPE_B, 0, 90) == pytest.approx([0, -1, 0])
    assert direction(TYPE_A, -90, 0) == pytest.approx([0, 0, -1])
    assert direction(TYPE_A, 0, 0) == pytest.approx([1, 0, 0])
    assert direction(TYPE_A, 0, 90) == pytest.approx([0, -1, 0])


@pytest.mark.parametrize("kind", [TYPE_A, TYPE_B])
def test_every_value_of_a_file_is_found_where_it_points(read, kind):
    fine = np.arange(-90, 91, 2.0)
    table = beam(fine, fine, at=(10, -20))
    lamp = read(kind, fine, fine, table)
    for j in range(1, 90, 7):
        for i in range(1, 90, 7):
            gamma, c = type_c(direction(kind, fine[i], fine[j]))
            found = float(intensity_at(lamp, gamma, c))
            abs_error = 1e-9 if kind == TYPE_A else 5.0
            assert found == pytest.approx(table[j, i], abs=abs_error)


def test_type_b_is_the_system_of_cie_121(read):
    """tan B = cos C tan γ and sin β = sin C sin γ, with V = B and H = −β."""
    fine = np.arange(-90, 91, 1.0)
    lamp = read(TYPE_B, fine, fine, beam(fine, fine, at=(15, -10)))
    gamma, c = np.meshgrid(np.arange(2, 80, 6.0), np.arange(5, 360, 15.0))
    g, a = np.radians(gamma), np.radians(c)
    v = np.degrees(np.arctan(np.cos(a) * np.tan(g)))
    h = -np.degrees(np.arcsin(np.sin(a) * np.sin(g)))
    truth = 1000 * np.exp(-(((v - 15) / 25) ** 2) - ((h + 10) / 15) ** 2)
    assert intensity_at(lamp, gamma, c) == pytest.approx(truth, abs=1.5)


# What is kept


TABLES = {
    "smooth": (ROUND, ROUND, beam(ROUND, ROUND)),
    "aside": (ROUND, ROUND, beam(ROUND, ROUND, 12, (23, -41))),
    "rough": (ROUND, ROUND, np.random.default_rng(4).random((37, 37))),
    "even": (ROUND, ROUND, np.ones((37, 37))),
    "cut off": (np.array([-33.3, 0, 17.7]), np.array([-7.1, 0, 21]), np.ones((3, 3))),
    "pencil": (np.array([-1.3, 0, 1.7]), np.array([-0.7, 0, 1.3]), np.ones((3, 3))),
    "uneven": (
        np.array([-60, -5, 0, 1, 2, 50.0]),
        np.array([-80, -1, 2, 90.0]),
        beam([-60, -5, 0, 1, 2, 50], [-80, -1, 2, 90]),
    ),
}


@pytest.mark.parametrize("kind", [TYPE_A, TYPE_B])
@pytest.mark.parametrize("table", TABLES)
def test_flux_and_peak_are_kept(read, kind, table):
    v, h, candela = TABLES[table]
    lamp = read(kind, v, h, candela)
    assert luminous_flux(lamp) == pytest.approx(native_flux(kind, v, h, candela), rel=1e-3)
    assert lamp.flux == luminous_flux(lamp)
    assert lamp.intensity.max() == pytest.approx(candela.max(), rel=1e-9)
    j, i = np.unravel_index(np.argmax(candela), candela.shape)
    at = type_c(direction(kind, v[i], h[j]))
    assert float(intensity_at(lamp, *at)) == pytest.approx(candela.max(), rel=1e-6)
    assert np.all(np.diff(lamp.vertical) > 0)
    assert np.all(np.diff(lamp.horizontal) > 0)
    assert (lamp.horizontal[0], lamp.horizontal[-1]) == (0, 360)
    assert lamp.intensity[0].tolist() == lamp.intensity[-1].tolist()


def test_an_even_hemisphere_has_two_pi_lumens(read):
    """Type B about the nadir: γ to 90°; Type A about C0: the half before the lamp."""
    even = np.ones((37, 37))
    assert luminous_flux(read(TYPE_B, ROUND, ROUND, even)) == pytest.approx(2 * np.pi, rel=1e-5)
    lamp = read(TYPE_A, ROUND, ROUND, even)
    assert luminous_flux(lamp) == pytest.approx(2 * np.pi, rel=1e-5)
    assert intensity_at(lamp, 90, [0, 89, 271, 91, 180, 269]).tolist() == [1, 1, 1, 0, 0, 0]


def test_a_cosine_floodlight_is_lambertian(read):
    """cos γ = cos V cos H, whose flux is π."""
    fine = np.arange(-90, 91, 1.0)
    cosine = np.cos(np.radians(fine))[None, :] * np.cos(np.radians(fine))[:, None]
    lamp = read(TYPE_B, fine, fine, np.clip(cosine, 0, None))
    assert luminous_flux(lamp) == pytest.approx(np.pi, rel=1e-3)
    gamma = np.arange(0, 90, 4.0)
    for c in (0, 33, 90, 200):
        assert intensity_at(lamp, gamma, c) == pytest.approx(np.cos(np.radians(gamma)), abs=5e-4)


@pytest.mark.parametrize("kind", [TYPE_A, TYPE_B])
@pytest.mark.parametrize(("v0", "h0"), [(-90, 0), (0, -90), (0, 0)])
def test_angles_from_0_are_mirrored_there(read, kind, v0, h0):
    table = beam(ROUND, ROUND, 30)
    whole = read(kind, ROUND, ROUND, table)
    i, j = np.searchsorted(ROUND, [v0, h0])
    half = read(kind, ROUND[i:], ROUND[j:], table[j:, i:])
    gamma, c = np.meshgrid(np.arange(0, 181, 7.0), np.arange(0, 360, 11.0))
    assert intensity_at(half, gamma, c) == pytest.approx(intensity_at(whole, gamma, c), abs=1e-9)


def test_a_type_b_table_may_go_all_round(read):
    v = np.arange(-180, 181, 5.0)
    lamp = read(TYPE_B, v, ROUND, np.ones((37, 73)))
    assert luminous_flux(lamp) == pytest.approx(4 * np.pi, rel=1e-4)
    assert lamp.vertical[-1] == 180


def test_a_type_a_table_may_go_all_round_and_skip_0(read):
    h = np.array([-180, -90, -10, 30, 90, 180.0])
    table = np.array([4, 2, 1, 5, 3, 4.0])[:, None] * np.ones((1, 37))
    lamp = read(TYPE_A, ROUND, h, table)
    at = intensity_at(lamp, 90, [180, 90, 10, 330, 270, 0])
    assert at == pytest.approx([4, 2, 1, 5, 3, 2])
    assert luminous_flux(lamp) == pytest.approx(native_flux(TYPE_A, ROUND, h, table), rel=1e-9)


def test_a_headlight_shines_forward_and_a_floodlight_down(tmp_path, read):
    fine = np.arange(-90, 91, 2.0)
    for kind, at, says in (
        (TYPE_A, (90, 0), "along the lamp's own [+]X"),
        (TYPE_B, (0, 0), "Type B and was resampled"),
    ):
        read(kind, fine, fine, beam(fine, fine, 8))
        lamp = Luminaire("Lamp", Lamp(file=str(tmp_path / "lamp.ies")), scenes.at(z=1.0))
        source = luminaires.source(lamp)
        assert source.distribution is not None
        assert float(intensity_at(source.distribution, *at)) == pytest.approx(1000)
        assert re.search(says, source.notes[0])


# Bad ones


@pytest.mark.parametrize("kind", [TYPE_A, TYPE_B])
@pytest.mark.parametrize(
    ("v", "h", "says"),
    [
        ((-90, 0, 90), (0,), "Line 7 .* horizontal angles from 0° to 0°, and Type [AB] goes"),
        ((-90, 0, 90), (10, 90), "Line 7 .* horizontal angles from 10° to 90°"),
        ((-90, 0, 90), (-90, 0), "Line 7 .* horizontal angles from -90° to 0°"),
        ((10, 20, 90), (0, 90), "Line 6 .* vertical angles from 10° to 90°"),
        ((-200, 0, 90), (0, 90), "Line 6 .* vertical angles from -200° to 90°, which do not lie"),
        ((-90, 0, 90), (0, 200), "Line 7 .* horizontal angles from 0° to 200°, which do not lie"),
        ((90, 0, -90), (0, 90), "Line 6 .* vertical angles that do not ascend"),
    ],
)
def test_incomplete_angles_are_told(read, kind, v, h, says):
    with pytest.raises(FileError, match=says) as error:
        read(kind, v, h, np.ones((len(h), len(v))))
    assert "“lamp.ies”" in str(error.value)
    assert str(error.value).endswith(".")
