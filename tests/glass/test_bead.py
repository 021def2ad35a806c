"""The bead's profile against its closed form."""

import numpy as np
import pytest
from heliform.engines.glass import Bead
from heliform.engines.glass.bead import arc_radius, relief
from heliform.engines.glass.wall import levels


@pytest.mark.parametrize(("height", "sag"), [(5e-3, 1.2e-3), (5e-3, 2.5e-3), (1e-3, 1e-5)])
def test_a_scalloped_bead_is_an_arc_through_the_layer_boundaries(height, sag):
    bead = Bead(height=height, sag=sag)
    z = np.linspace(0, height, 101)
    offset, tilt = relief(bead, z)
    assert offset[[0, 50, 100]] == pytest.approx([0, sag, 0], abs=1e-12)
    radius = arc_radius(bead)
    assert np.hypot(z - height / 2, offset + radius - sag) == pytest.approx(radius, rel=1e-9)
    slope = np.gradient(offset, z)[5:-5]
    assert np.arctan(slope) == pytest.approx(tilt[5:-5], abs=0.01)


def test_the_thesis_bead_has_a_radius_of_three_millimetres():
    assert arc_radius(Bead()) == pytest.approx((2.5**2 + 1.2**2) / 2.4 * 1e-3)


@pytest.mark.parametrize("bead", [Bead(style="flat"), Bead(sag=0.0)])
def test_a_flat_bead_has_no_relief(bead):
    offset, tilt = relief(bead, np.linspace(0, 5e-3, 7))
    assert not offset.any()
    assert not tilt.any()


def test_the_faintest_bead_is_as_good_as_flat():
    offset, tilt = relief(Bead(sag=5e-324), np.linspace(0, 5e-3, 7))
    assert offset == pytest.approx(0, abs=1e-12)
    assert tilt == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("height", [0.209, 0.2, 0.2000000001, 0.1999999999, 0.20246, 0.005])
def test_levels_hold_every_boundary_and_apex_and_end_at_the_height(height):
    z = levels(height, Bead(), parts=4)
    assert z[0] == 0
    assert z[-1] == height
    assert np.diff(z).min() > 1e-6
    knots = np.arange(0, height - 1e-6, 2.5e-3)
    assert np.abs(z[:, None] - knots).min(axis=0).max() < 1e-12
