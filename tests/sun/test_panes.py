"""Sun through panes against Fresnel's closed forms."""

import numpy as np
import pytest
from heliform.engines.core.scene import Body, Material, Mesh
from heliform.engines.sun import panes
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.remembered import Remembered
from heliform.engines.sun.sensors import at_points, on_plane
from heliform.engines.sun.visibility import visible, weighted
from sun.shades import box, dome, level, unit

GLASS = Material(kind="dielectric", ior=1.5)
TINTED = Material(kind="dielectric", ior=1.5, absorption=40.0)
SENSOR = at_points([[0, 0, 0]], [[0, 0, 1]])


def slab(angle, ior=1.5, depth=0.0, times=1):
    """Plane-parallel panes, all reflections within each; ``depth`` is across one of them."""
    cos_i = np.cos(np.radians(angle))
    cos_t = np.sqrt(1 - (np.sin(np.radians(angle)) / ior) ** 2)
    r_s = ((cos_i - ior * cos_t) / (cos_i + ior * cos_t)) ** 2
    r_p = ((cos_t - ior * cos_i) / (cos_t + ior * cos_i)) ** 2
    kept = np.exp(-depth / cos_t)
    through = [kept * (1 - r) ** 2 / (1 - (kept * r) ** 2) for r in (r_s, r_p)]
    return sum(t**times for t in through) / 2


def at_angles(angles):
    tilt = np.radians(angles)
    return np.stack([np.sin(tilt), 0 * tilt, np.cos(tilt)], axis=1)


def through(bodies, angles):
    return visible(Occluders(bodies), SENSOR, at_angles(angles)).values()[0]


ANGLES = np.array([0.0, 20, 45, 60, 75, 80])


def test_the_closed_form_gives_the_published_values():
    assert slab(0, ior=1.52) == pytest.approx(0.9183, abs=1e-4)
    assert slab(60) == pytest.approx(0.8481, abs=1e-4)
    assert slab(80) == pytest.approx(0.4585, abs=1e-4)


def test_clear_glass():
    pane = box("Pane", (200, 200, 0.006), (0, 0, 1), GLASS)
    assert through([pane], ANGLES) == pytest.approx(slab(ANGLES), abs=3e-5)


@pytest.mark.parametrize("far", [1e3, 1e5])
def test_a_pane_over_wide_ground_is_a_pane(far):
    pane = box("Pane", (200, 200, 0.003), (0, 0, 1), GLASS)
    bodies = [pane, level("Ground", far, far, -5)]
    assert through(bodies, ANGLES) == pytest.approx(slab(ANGLES), abs=3e-5)


def test_a_sheet_is_a_pane():
    assert through([level("Pane", 200, 200, 1, GLASS)], ANGLES) == pytest.approx(
        slab(ANGLES), abs=3e-5
    )


@pytest.mark.parametrize("inside_out", [False, True])
def test_tinted_glass(inside_out):
    pane = box("Pane", (200, 200, 0.01), (0, 0, 1), TINTED)
    if inside_out:
        turned = Mesh(pane.mesh.vertices, pane.mesh.faces[:, ::-1].copy())
        pane = Body("Pane", turned, TINTED)
    assert through([pane], ANGLES) == pytest.approx(slab(ANGLES, depth=0.4), abs=1e-4)


def test_double_glazing_carries_both_polarisations():
    both = [box("Pane", (200, 200, 0.004), (0, 0, z), GLASS) for z in (1, 1.02)]
    assert through(both, ANGLES) == pytest.approx(slab(ANGLES, times=2), abs=3e-5)


def test_two_panes_beside_each_other_stay_apart():
    """A ray crosses only those that are in its way."""
    bodies = [
        box("Clear", (10, 10, 0.01), (-5.5, 0, 1), GLASS),
        box("Dark", (10, 10, 0.01), (5.5, 0, 1), TINTED),
    ]
    sensors = at_points([[-5, 0, 0], [0, 0, 0], [5, 0, 0]], np.tile([0, 0, 1.0], (3, 1)))
    seen = visible(Occluders(bodies), sensors, at_angles(np.array([0.0]))).values()[:, 0]
    assert seen == pytest.approx([slab(0), 1, slab(0, depth=0.4)], abs=1e-4)


def test_opaque_bodies_block_before_and_behind_the_pane():
    pane = box("Pane", (20, 20, 0.01), (0, 0, 1), GLASS)
    for z in (0.5, 1.5):
        assert not through([pane, level("Roof", 20, 20, z)], ANGLES[:4]).any()


def test_glass_that_refracts_as_air_does_only_absorbs():
    pane = box("Pane", (200, 200, 0.01), (0, 0, 1), Material(kind="dielectric", ior=1.0))
    assert through([pane], ANGLES) == pytest.approx(1, abs=3e-5)
    dark = Material(kind="dielectric", ior=1.0, absorption=40.0)
    pane = box("Pane", (200, 200, 0.01), (0, 0, 1), dark)
    truth = np.exp(-0.4 / np.cos(np.radians(ANGLES)))
    assert through([pane], ANGLES) == pytest.approx(truth, abs=1e-4)


def test_ground_glass_blocks():
    ground = Material(kind="dielectric", roughness=0.1)
    assert not through([box("Pane", (20, 20, 0.01), (0, 0, 1), ground)], ANGLES[:4]).any()


def test_behind_too_many_surfaces_it_is_dark(monkeypatch):
    monkeypatch.setattr(panes, "MOST", 5)
    stack = [box("Pane", (9, 9, 0.01), (0, 0, z), GLASS) for z in (1, 1.1, 1.2)]
    assert through(stack[:2], ANGLES[:1]) == pytest.approx(slab(0, times=2), abs=3e-5)
    assert through(stack, ANGLES[:1]) == 0


def test_it_is_told_that_rays_stay_straight():
    pane = level("Pane", 20, 20, 1, TINTED)
    notes = visible(Occluders([pane]), SENSOR, at_angles(ANGLES)).notes
    assert "photon tracing" in notes[0]
    assert "“Pane” is not closed" in notes[1]


def test_sums_weigh_by_what_is_let_through():
    sky = dome(1003)
    rng = np.random.default_rng(1)
    normals = unit(rng.normal(scale=0.5, size=(20, 3)) + np.array([0, 0, 1]))
    sensors = at_points(rng.uniform(-3, 3, (20, 3)) * [1, 1, 0], normals)
    bodies = [box("Pane", (4, 4, 0.01), (0, 0, 1), TINTED), level("Roof", 1, 1, 2)]
    seen = visible(Occluders(bodies), sensors, sky)
    weights = rng.random((len(sky), 2))
    truth = (seen.values() * np.maximum(normals @ sky.T, 0)) @ weights
    assert 0.05 < (seen.values() % 1 > 0).mean() < 0.95
    assert seen.dot(weights) == pytest.approx(truth, rel=1e-4)
    assert weighted(Occluders(bodies), sensors, sky, weights)[0] == pytest.approx(truth, rel=1e-4)


def test_panes_are_crossed_anew_when_they_change_and_only_then(monkeypatch):
    calls = []
    crossing = panes.transmittances
    monkeypatch.setattr(panes, "transmittances", lambda *a: calls.append(1) or crossing(*a))
    sky, sensors, remembered = dome(300), on_plane(np.eye(4), 2, 2, 0.5), Remembered()
    pane = box("Pane", (9, 9, 0.01), (0, 0, 1), GLASS)
    fins = [level("Fin", 1, 1, z) for z in (2, 3)]
    occluders = Occluders([pane, fins[0]], moving=["Fin"])
    remembered.visible(occluders, sensors, sky)
    occluders.update([pane, fins[1]])
    moved = remembered.visible(occluders, sensors, sky)
    assert len(calls) == 1
    assert (moved.values() == visible(Occluders([pane, fins[1]]), sensors, sky).values()).all()
    darker = Body("Pane", pane.mesh, TINTED)
    occluders.update([darker, fins[1]])
    dark = remembered.visible(occluders, sensors, sky)
    fresh = visible(Occluders([darker, fins[1]]), sensors, sky).values()
    assert dark.values() == pytest.approx(fresh, abs=2 / 65535)  # about another centre
    behind = (moved.values() > 0) & (moved.values() < 1)
    assert behind.any()
    assert (dark.values() < moved.values())[behind].all()
