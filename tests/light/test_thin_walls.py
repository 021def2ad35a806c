"""Thin glass far from the middle of the scene, where float32 has few steps left."""

import numpy as np
import pytest
from heliform.engines.core.scene import Scene
from heliform.engines.light import PhotonTracing
from light import scenes
from light.test_slab import reflectances, through


@pytest.mark.parametrize("distance", [5.0, 50.0])
@pytest.mark.parametrize("wall", [1e-3, 2e-4])
@pytest.mark.parametrize("angle", [0.0, 60.0])
def test_a_thin_wall_far_from_other_glass(distance, wall, angle):
    """A pane hung askew, another body ``distance`` m away: it passes what a pane passes."""
    lean = np.array([0.3, 0.5, -1.0]) / np.linalg.norm([0.3, 0.5, -1.0])
    pane = scenes.box(0.2, 0.2, wall).moved(scenes.at(0.0, 0.0, 0.0, axis=lean))
    other = scenes.box(0.05, 0.05, 0.05, (distance, 0.0, 0.0))
    side = np.cross(lean, [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    turn = np.radians(angle)
    axis = np.cos(turn) * lean + np.sin(turn) * side
    lamp = scenes.beam(1000.0, 0.01, scenes.at(*(-0.3 * axis), axis=axis))
    receiver = scenes.floor(0.5, 16, scenes.at(*(0.3 * axis), axis=axis))
    scene = Scene((scenes.glass(pane), scenes.glass(other)), (lamp,), (receiver,))
    meta = scenes.traced(scene, PhotonTracing(until="landed", landed=300_000), seed=2).meta
    truth = through(sum(reflectances(angle)) / 2)
    share = meta["flux"]["landed"] / meta["flux"]["emitted"]
    sigma = np.sqrt(truth * (1 - truth) / meta["photons"]["emitted"])
    assert share == pytest.approx(truth, abs=4 * sigma + 1e-4)
    if angle == 0:
        # What the pane sends back and forth also lands, what it returns leaves.
        assert meta["flux"]["absorbed"] == 0.0
