"""Splits of global radiation against published correlations, pvlib, gendaylit and Daysim."""

import re
import subprocess

import numpy as np
import pvlib
import pyradiance
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.sun.extraterrestrial import extraterrestrial
from heliform.engines.sun.position import sun_position
from heliform.engines.sun.site import Site
from heliform.engines.sun.split import split_erbs, split_reindl, split_reindl_full

ABOVE = 1367.0
BOSTON = ("-a", "42.36", "-o", "71.06", "-m", "75")


def fraction(split, clearness, altitude, *more):
    """The diffuse share that ``split`` gives at a clearness index, under a sun without distance."""
    total = clearness * ABOVE * np.sin(np.radians(altitude))
    _, diffuse = split(total, np.asarray(altitude, float), np.asarray(ABOVE), *more)
    return diffuse / total


def test_extraterrestrial_irradiance_is_pvlibs():
    times = np.datetime64("2019-01-01T12:00", "s") + np.arange(365) * np.timedelta64(1, "D")
    theirs = pvlib.irradiance.get_extra_radiation(np.arange(1, 366), 1367.0, method="spencer")
    assert np.allclose(extraterrestrial(times), theirs, rtol=1e-6)


def test_erbs_is_pvlibs():
    random = np.random.default_rng(3)
    total = random.uniform(0.0, 1100.0, 2000)
    altitude = random.uniform(-10.0, 90.0, 2000)
    day = random.integers(1, 366, 2000)
    above = pvlib.irradiance.get_extra_radiation(day)
    theirs = pvlib.irradiance.erbs(total, 90.0 - altitude, day)
    direct, diffuse = split_erbs(total, altitude, above)
    possible = theirs["dni"] <= above  # pvlib lets more through than there is
    assert possible.mean() > 0.8
    assert np.allclose(direct[possible], theirs["dni"][possible], atol=1e-9)
    assert np.allclose(diffuse[possible], theirs["dhi"][possible], atol=1e-9)


def test_erbs_is_gendaylits_in_boston_at_noon_of_21_june():
    done = subprocess.run(
        [pyradiance.BINPATH / "gendaylit", "6", "21", "12", *BOSTON, "-E", "900"],
        capture_output=True,
        text=True,
        check=True,
    )
    found = re.search(r"irr_diff: (\S+) \S+ (\S+) (\S+)", done.stdout)
    above, level, sky = map(float, found.groups())
    assert (level, sky) == (706.558, 193.442)
    altitude = 70.9
    direct, diffuse = split_erbs(
        np.array([900.0]), np.array([altitude]), above / np.sin(np.radians([altitude]))
    )
    assert abs(diffuse[0] - sky) < 0.001 * sky
    assert abs(direct[0] * np.sin(np.radians(altitude)) - level) < 0.001 * level


def test_reindl_is_daysims_gen_reindl_in_singapore():
    site = Site(latitude=1.37, longitude=103.98, elevation=0.0, utc_offset=8.0)
    time = np.array(["2019-04-22T00:20:00"], "datetime64[s]")
    altitude = sun_position(time, site, refraction=False).altitude
    direct, diffuse = split_reindl(np.array([107.0]), altitude, extraterrestrial(time), lowest=5.0)
    assert round(direct[0]) == 12
    assert round(diffuse[0]) == 103


@pytest.mark.parametrize(
    ("clearness", "altitude", "expected"),
    [
        (0.2, 30.0, 1.020 - 0.254 * 0.2 + 0.0123 * 0.5),
        (0.05, 80.0, 1.0),  # held at all
        (0.3, 30.0, 1.020 - 0.254 * 0.3 + 0.0123 * 0.5),
        (0.3001, 30.0, 1.400 - 1.749 * 0.3001 + 0.177 * 0.5),
        (0.31, 80.0, 0.97),  # held below all
        (0.5, 30.0, 1.400 - 1.749 * 0.5 + 0.177 * 0.5),
        (0.779, 10.0, 0.1),  # held at a tenth
        (0.7801, 30.0, 0.486 * 0.7801 - 0.182 * 0.5),
        (0.95, 60.0, 0.486 * 0.95 - 0.182 * np.sin(np.pi / 3.0)),
    ],
)
def test_reindls_reduced_correlation_and_its_limits(clearness, altitude, expected):
    # Where the third branch would ask more of the sun than there is, the split holds it.
    held = max(expected, 1.0 - 1.0 / clearness)
    assert fraction(split_reindl, clearness, altitude) == pytest.approx(held, abs=1e-9)


@pytest.mark.parametrize(
    ("clearness", "expected"),
    [
        (0.2, 1.000 - 0.232 * 0.2 + 0.0239 * 0.5 - 0.000682 * 20.0 + 0.0195 * 0.6),
        (0.5, 1.329 - 1.716 * 0.5 + 0.267 * 0.5 - 0.00357 * 20.0 + 0.106 * 0.6),
        (0.8, 0.426 * 0.8 - 0.256 * 0.5 + 0.00349 * 20.0 + 0.0734 * 0.6),
    ],
)
def test_reindls_full_correlation(clearness, expected):
    more = np.array(20.0), np.array(0.6)
    assert fraction(split_reindl_full, clearness, 30.0, *more) == pytest.approx(expected, abs=1e-9)


def test_warmer_and_drier_air_scatters_less_under_mixed_skies():
    def full(warmth, humidity):
        return fraction(split_reindl_full, 0.5, 40.0, np.array(warmth), np.array(humidity))

    assert full(30.0, 0.5) < full(10.0, 0.5) < full(10.0, 0.9)


@pytest.mark.parametrize("split", [split_reindl, split_erbs])
def test_direct_and_diffuse_make_up_the_global_again(split):
    random = np.random.default_rng(5)
    total, altitude = random.uniform(0.0, 1200.0, 4000), random.uniform(-20.0, 90.0, 4000)
    direct, diffuse = split(total, altitude, np.full(4000, ABOVE))
    sine = np.maximum(np.sin(np.radians(altitude)), 0.0)
    assert np.allclose(direct * sine + diffuse, total)
    assert direct.min() == 0.0
    assert direct.max() <= ABOVE
    assert np.all(direct[altitude < 3.0] == 0.0)
    assert np.all(diffuse >= 0.0)


@pytest.mark.parametrize(
    ("split", "low", "high"),
    [(split_erbs, 0.01, 0.79), (split_reindl, 0.01, 0.29), (split_reindl, 0.31, 0.77)],
)
def test_brighter_skies_are_less_diffuse_within_a_branch(split, low, high):
    shares = [float(fraction(split, k, 45.0)) for k in np.linspace(low, high, 60)]
    assert np.all(np.diff(shares) <= 1e-9)


def test_negative_radiation_is_refused():
    with pytest.raises(ParameterError, match="below zero"):
        split_erbs(np.array([-1.0]), np.array([30.0]), np.array([ABOVE]))
