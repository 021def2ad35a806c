"""The patches of the sky: where they are, how large, and which one a direction is in."""

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.sun.patches import BELOW, TREGENZA, patch_at, patches_of
from sun.domes import towards

SUBDIVISIONS = (1, 2, 3, 4)


@pytest.mark.parametrize(("subdivision", "count"), [(1, 145), (2, 577), (3, 1297), (4, 2305)])
def test_a_sky_has_as_many_patches_as_reinhart_says(subdivision, count):
    patches = patches_of(subdivision)
    assert len(patches.directions) == len(patches.solid_angles) == sum(patches.rows) == count
    assert len(patches.rows) == len(TREGENZA) * subdivision + 1


@pytest.mark.parametrize("subdivision", SUBDIVISIONS)
def test_the_patches_make_up_the_hemisphere(subdivision):
    patches = patches_of(subdivision)
    assert patches.solid_angles.sum() == pytest.approx(2 * np.pi, rel=1e-14)
    assert np.linalg.norm(patches.directions, axis=1) == pytest.approx(1, abs=1e-14)
    assert patches.directions.sum(axis=0)[:2] == pytest.approx(0, abs=1e-11)


def test_tregenzas_rows_stand_every_12_degrees_and_start_in_the_north():
    patches = patches_of(1)
    first = np.cumsum((0, *patches.rows[:-1]))
    expected = towards(0.0, np.array([6.0, 18.0, 30.0, 42.0, 54.0, 66.0, 78.0, 90.0]))
    assert patches.directions[first] == pytest.approx(expected, abs=1e-15)
    assert patches.directions[1] == pytest.approx(towards(12.0, 6.0), abs=1e-15)
    assert patches.directions[first[4] + 3] == pytest.approx(towards(60.0, 54.0), abs=1e-15)


@pytest.mark.parametrize("subdivision", SUBDIVISIONS)
def test_the_middle_of_a_patch_is_in_it(subdivision):
    directions = patches_of(subdivision).directions
    assert (patch_at(directions, subdivision) == np.arange(len(directions))).all()


@pytest.mark.parametrize("subdivision", SUBDIVISIONS)
def test_a_patch_catches_its_share_of_even_directions(subdivision):
    drawn = np.random.default_rng(7).normal(size=(1_000_000, 3))
    drawn[:, 2] = np.abs(drawn[:, 2])
    patches = patches_of(subdivision)
    found = patch_at(drawn / np.linalg.norm(drawn, axis=1)[:, None], subdivision)
    share = patches.solid_angles / (2 * np.pi)
    count = np.bincount(found, minlength=len(share))
    deviation = (count - len(drawn) * share) / np.sqrt(len(drawn) * share * (1 - share))
    assert np.abs(deviation).max() < 5
    assert deviation.std() == pytest.approx(1, abs=0.2)


def test_azimuths_on_either_side_of_north_are_in_the_first_patch_of_a_row():
    assert (patch_at(towards(np.array([-5.9, 0.0, 5.9, 354.1, 359.9]), 6.0), 1) == 0).all()
    assert (patch_at(towards(np.array([-6.1, 353.9]), 6.0), 1) == 29).all()
    assert patch_at(towards(6.1, 6.0)[None], 1) == 1


def test_a_direction_under_the_horizon_is_in_no_patch():
    found = patch_at(towards(90.0, np.array([-90.0, -0.01, 0.0, 0.01, 90.0])), 2)
    assert found.tolist() == [BELOW, BELOW, 15, 15, 576]


@pytest.mark.parametrize("subdivision", [0, 5, 8, -1, 1.5])
def test_another_subdivision_is_refused(subdivision):
    for ask in (lambda: patches_of(subdivision), lambda: patch_at(np.eye(3), subdivision)):
        with pytest.raises(ParameterError, match="divided by 1, 2, 3 or 4"):
            ask()
