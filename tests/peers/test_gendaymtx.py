"""The sky matrix as Radiance's gendaymtx has it, element by element."""

import io
import subprocess
from dataclasses import replace

import numpy as np
import pyradiance
import pytest
from heliform.engines.sun import hourly
from heliform.engines.sun.patches import patch_at, patches_of
from heliform.engines.sun.sky_matrix import cumulative, ground_radiance, sky_matrix
from numpy.testing import assert_allclose
from peers.skies import (
    EFFICACY,
    gendaymtx,
    part,
    radiance_position,
    radiance_sun,
    typical_year,
)

pytestmark = pytest.mark.peer
FEW_DAYS = np.isin(np.arange(8760) // 24, (10, 79, 100, 171, 172, 265, 350))


@pytest.fixture
def year(monkeypatch):
    """A typical year without dew points, under the sun that Radiance takes."""
    monkeypatch.setattr(hourly, "sun_position", lambda *_, **__: radiance_position(current[0]))
    whole = typical_year()
    current = [replace(whole, dew_point=np.full(len(whole.times), np.nan))]

    def chosen(mask=None):
        if mask is not None:
            current[0] = part(current[0], mask)
        return current[0]

    return chosen


def agree(weather, subdivision, quantity):
    """Compare the two matrices and the ground where the sun is up, and the skies alone always."""
    kind, unit = ("-O1", 1.0) if quantity == "radiation" else ("-O0", EFFICACY)
    theirs = gendaymtx(weather, subdivision, kind) * unit
    ours = sky_matrix(weather, weather.site, subdivision, quantity=quantity)
    up = radiance_sun(weather)[1] > 0
    assert up.any()
    assert_allclose(ours[:, up], theirs[1:, up], rtol=1e-5)
    sky = sky_matrix(weather, weather.site, subdivision, quantity=quantity, direct="none")
    alone = gendaymtx(weather, subdivision, kind, "-s")[1:] * unit
    assert_allclose(sky, alone, rtol=1e-5)
    ground = ground_radiance(hourly.hourly_skies(weather, weather.site, quantity))
    assert_allclose(ground[up], theirs[0, up], rtol=1e-5)


@pytest.mark.parametrize("subdivision", [1, 2, 3, 4])
@pytest.mark.parametrize("quantity", ["radiation", "light"])
def test_the_matrix_is_gendaymtxs(year, subdivision, quantity):
    """To single precision, as long as the sun is up."""
    agree(year(FEW_DAYS), subdivision, quantity)


def test_gendaymtx_adds_the_beam_of_a_sun_that_is_down(year):
    weather = year(FEW_DAYS)
    twilight = (radiance_sun(weather)[1] <= 0) & (weather.direct_normal > 0)
    assert twilight.any()
    more = gendaymtx(weather, 1, "-O1")[1:] - sky_matrix(weather, weather.site, 1)
    added = patches_of(1).solid_angles @ more[:, twilight]
    assert_allclose(added, weather.direct_normal[twilight], rtol=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("subdivision", [1, 2, 4])
@pytest.mark.parametrize("quantity", ["radiation", "light"])
def test_the_matrix_of_a_whole_year_is_gendaymtxs(year, subdivision, quantity):
    agree(year(), subdivision, quantity)


def test_the_cumulative_sky_is_gendaymtxs_average(year):
    weather = year(FEW_DAYS)
    weather = replace(
        weather, direct_normal=np.where(radiance_sun(weather)[1] > 0, weather.direct_normal, 0.0)
    )
    average = gendaymtx(weather, 2, "-O1", "-A")[1:, 0]
    ours = cumulative(weather, weather.site, 2)
    assert_allclose(ours * 1000 / len(weather.times), average, rtol=1e-5)


def test_the_suns_exact_place_changes_the_year_little_but_its_patches_much():
    """Radiance's sun is up to 1° off: the sky as a whole stays, its brightest patches move."""
    weather = typical_year()
    theirs = gendaymtx(weather, 2, "-O1")[1:]
    ours = sky_matrix(weather, weather.site, 2)
    patches = patches_of(2)
    projected = patches.solid_angles * patches.directions[:, 2]
    horizontal = projected @ ours.sum(axis=1), projected @ theirs.sum(axis=1)
    assert horizontal[0] == pytest.approx(horizontal[1], rel=5e-3)
    assert_allclose(ours.sum(axis=1), theirs.sum(axis=1), rtol=0.2)


@pytest.mark.parametrize("subdivision", [1, 2, 3, 4])
def test_directions_fall_into_the_patches_of_reinhart_cal(subdivision):
    drawn = np.random.default_rng(11).normal(size=(4000, 3))
    drawn /= np.linalg.norm(drawn, axis=1)[:, None]
    text = io.StringIO()
    np.savetxt(text, drawn, "%.15g")
    library = pyradiance.BINPATH.parent / "lib"
    done = subprocess.run(
        [
            *(str(pyradiance.BINPATH / "rcalc"), "-e", f"MF:{subdivision}"),
            *("-e", "Dx=$1;Dy=$2;Dz=$3", "-f", "reinhart.cal", "-e", "$1=rbin"),
        ],
        input=text.getvalue(),
        capture_output=True,
        text=True,
        cwd=library,
        check=True,
    )
    theirs = np.array(done.stdout.split(), float).astype(int) - 1
    assert (patch_at(drawn, subdivision) == theirs).all()
