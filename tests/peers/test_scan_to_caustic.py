"""A wall rebuilt from the scan of a sample throws the caustic of the wall it was cut from.

The truth and the scan are the independent generator's; `bench/scan_caustic.py` prints the figures.
"""

import numpy as np
import pytest
from heliform.engines.core.solid import inspect
from peers import rebuilt
from peers.rebuilt import ROSETTE, TUBE

pytestmark = pytest.mark.slow

POINTS, FACES, LANDED, BLOCK = 60_000, 1_600_000, 500_000, 8


@pytest.fixture(scope="module")
def scanned():
    return rebuilt.scan_it(rebuilt.print_of(1, POINTS))


@pytest.fixture(scope="module")
def style(scanned):
    return rebuilt.style_of(scanned[0])


def found(base, style):
    return rebuilt.caustic(rebuilt.rebuilt_wall(base, style, FACES), LANDED, seed=13)


@pytest.fixture(scope="module", params=[ROSETTE, TUBE], ids=lambda base: base.name)
def against(request, scanned, style):
    """The base curve, its true caustic, and that of the wall rebuilt from the scan."""
    mesh = rebuilt.true_wall(request.param, scanned[1])
    assert not inspect(mesh).problem
    return request.param, rebuilt.Comparison(mesh, LANDED), found(request.param, style)


def test_the_sample_is_cut_from_the_wall(scanned):
    """The scan's points without their noise lie on the true wall of the tube."""
    _, truth = scanned
    rng = np.random.default_rng(1)
    turn, z = rng.uniform(size=500), rng.uniform(1, 199, 500)
    arc, height = turn * rebuilt.TURN, z - rebuilt.cut_at(truth)
    x, y, up = truth.surface(arc, height).T
    wall = rebuilt.true_wall(TUBE, truth).vertices * 1e3
    near = np.hypot(x + truth.piece.radius, y)
    row = np.rint(z / rebuilt.LAYER * rebuilt.ROWS).astype(int)
    column = np.rint(turn * rebuilt.COLUMNS).astype(int) % rebuilt.COLUMNS
    place = wall[row * rebuilt.COLUMNS + column]
    assert up == pytest.approx(height)
    assert np.abs(np.hypot(*place[:, :2].T) - near).max() < 0.15  # the nearest vertex, 0.1 mm up


def test_the_caustic_is_that_of_the_truth(against):
    _, truth, ours = against
    assert truth.flux(ours) == pytest.approx(1, abs=0.01)
    assert truth.chance(BLOCK) < 0.05
    assert truth.beyond(ours, BLOCK) < 0.06


def test_a_smoothed_scan_and_no_relief_do_worse(against, scanned):
    base, truth, ours = against
    smooth = rebuilt.style_of(rebuilt.smoothed(scanned[0], "Laplacian × 10"), repair=False)
    assert truth.beyond(found(base, smooth), BLOCK) > 2 * truth.beyond(ours, BLOCK)
    assert truth.beyond(found(base, None), BLOCK) > 5 * truth.beyond(ours, BLOCK)
