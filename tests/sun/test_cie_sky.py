"""The CIE's standard skies against closed forms and published figures."""

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.sun.cie_sky import NAMES, OVERCAST, cie_sky, zenith_ratio
from heliform.engines.sun.luminance import horizontal_integral, luminance, relative_luminance
from sun.domes import fine_dome, towards

KINDS = tuple(range(1, OVERCAST + 1))
ZENITH = np.array([(0.0, 0.0, 1.0)])


def ratio(kind, altitudes, azimuth=0.0, sun=(180.0, 40.0)):
    """The luminance at altitudes in degrees over the zenith's."""
    return zenith_ratio(cie_sky(kind, *sun), towards(azimuth, np.asarray(altitudes)))[:, 0]


def test_the_uniform_sky_is_uniform():
    assert ratio(5, [0.0, 10.0, 45.0, 90.0]) == pytest.approx(1, abs=1e-14)
    assert horizontal_integral(cie_sky(5))[0] == pytest.approx(np.pi, rel=1e-7)


def test_the_traditional_overcast_sky_is_moon_and_spencers():
    altitudes = np.linspace(0, 90, 19)
    expected = (1 + 2 * np.sin(np.radians(altitudes))) / 3
    assert ratio(16, altitudes) == pytest.approx(expected, rel=1e-12)
    assert horizontal_integral(cie_sky(16))[0] / 3 == pytest.approx(7 * np.pi / 9, rel=1e-6)


def test_type_1_follows_the_traditional_overcast_sky_closely():
    altitudes = np.linspace(0, 90, 91)
    assert ratio(1, altitudes) == pytest.approx(ratio(16, altitudes), abs=0.1)
    whole = [horizontal_integral(cie_sky(kind))[0] for kind in (1, 16)]
    assert whole[0] / (1 + 4 * np.exp(-0.7)) == pytest.approx(whole[1] / 3, rel=0.02)


def test_a_wall_gets_396_thousandths_of_what_the_roof_gets_under_an_overcast_sky():
    """(π/6 + 4/9) / (7π/9), as the textbooks have it; half under a uniform sky."""
    step = (np.arange(180) + 0.5) / 180
    directions = towards(180 * step[:, None] - 90, 90 * step).reshape(-1, 3)
    pieces = np.hypot(directions[:, 0], directions[:, 1]) * np.pi**2 / 2 / 180**2
    for kind, share in ((16, (np.pi / 6 + 4 / 9) / (7 * np.pi / 9)), (5, 0.5)):
        sky = cie_sky(kind)
        wall = pieces * directions[:, 1] @ relative_luminance(sky, directions)[:, 0]
        assert wall / horizontal_integral(sky)[0] == pytest.approx(share, rel=1e-4)


@pytest.mark.parametrize(
    ("kinds", "expected"),
    [
        ((1, 2), 1 / (1 + 4 * np.exp(-0.7))),
        ((3, 4), 1 / (1 + 1.1 * np.exp(-0.8))),
        ((5, 6, 7, 8), 1.0),
        ((9, 10, 11), 1 / (1 - np.exp(-0.55))),
        ((12, 13), 1 / (1 - np.exp(-0.32))),
        ((14, 15), 1 / (1 - np.exp(-0.15))),
    ],
)
def test_the_gradation_from_zenith_to_horizon_is_that_of_its_group(kinds, expected):
    """At points as far from the sun as the zenith is, where the indicatrix falls out."""
    for kind in kinds:
        found = ratio(kind, [0.0], azimuth=90.0, sun=(0.0, 0.0))
        assert found[0] == pytest.approx(expected, rel=1e-6)


def test_type_12_is_the_cies_clear_sky():
    """(0.91 + 10 e^(−3γ) + 0.45 cos² γ) (1 − e^(−0.32/sin)) [CIE 22, Kittler 1967]."""
    sun = towards(180.0, 40.0)
    directions = towards(np.arange(0.0, 360.0, 15.0)[:, None], np.arange(1.0, 90.0, 4.0))
    directions = directions.reshape(-1, 3)

    def clear(direction):
        cosine = direction @ sun
        around = 0.91 + 10 * np.exp(-3 * np.arccos(cosine)) + 0.45 * cosine**2
        return around * (1 - np.exp(-0.32 / direction[..., 2]))

    expected = clear(directions) / clear(ZENITH[0])
    assert zenith_ratio(cie_sky(12, 180.0, 40.0), directions)[:, 0] == pytest.approx(
        expected, rel=3e-4
    )


@pytest.mark.parametrize("kind", KINDS)
def test_every_sky_gives_the_light_that_was_asked_for(kind):
    directions, weights = fine_dome()
    for altitude in (0.0, 30.0, 90.0):
        found = luminance(cie_sky(kind, 200.0, altitude), directions, 10_000.0)
        assert weights @ found == pytest.approx(10_000, rel=5e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_only_the_even_skies_do_not_care_where_the_sun_is(kind):
    directions = towards(np.arange(0.0, 360.0, 40.0), 35.0)
    skies = cie_sky(kind, [90.0, 180.0], [20.0, 60.0])
    assert zenith_ratio(skies, ZENITH) == pytest.approx(1, abs=1e-14)
    one, other = zenith_ratio(skies, directions).T
    assert np.allclose(one, other, rtol=1e-9) == (kind in (1, 3, 5, 16))


def test_a_roof_opening_gives_cie_171s_daylight_factor():
    """Case 5.9, 1 m × 1 m in the ceiling of 4 m × 4 m × 3 m, point G, sky 1: 2.33 %."""
    step = (np.arange(100) + 0.5) / 100 - 0.5
    x, y = np.meshgrid(step - 1.75, step)
    away = np.stack([x, y, np.full_like(x, 3.0)], axis=-1).reshape(-1, 3)
    distance = np.linalg.norm(away, axis=1)
    directions = away / distance[:, None]
    sky = cie_sky(1)
    bright = relative_luminance(sky, directions)[:, 0] / horizontal_integral(sky)[0]
    factor = (bright * directions[:, 2] ** 2 / distance**2).sum() / step.size**2
    assert 100 * factor == pytest.approx(2.33, abs=0.01)


def test_every_kind_has_a_name():
    assert len(NAMES) == len(set(NAMES)) == len(KINDS)


@pytest.mark.parametrize("kind", [0, 17, -1, 1.5])
def test_a_kind_that_the_cie_has_not_is_refused(kind):
    with pytest.raises(ParameterError, match="numbers 1 to 16"):
        cie_sky(kind)


@pytest.mark.parametrize("altitude", [-0.1, 90.1, np.nan])
def test_a_sun_off_the_sky_is_refused(altitude):
    with pytest.raises(ParameterError, match="altitude of 0° to 90°"):
        cie_sky(12, 180.0, altitude)
