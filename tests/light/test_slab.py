"""Transmittance of a clear slab against Fresnel's closed forms, many reflections included."""

import numpy as np
import pytest
from heliform.engines.light import PhotonTracing
from light import scenes

IOR = 1.5


def reflectances(angle):
    """R_s, R_p of one air–glass surface at ``angle`` in degrees."""
    cos_i = np.cos(np.radians(angle))
    cos_t = np.sqrt(1 - (np.sin(np.radians(angle)) / IOR) ** 2)
    r_s = (cos_i - IOR * cos_t) / (cos_i + IOR * cos_t)
    r_p = (IOR * cos_i - cos_t) / (IOR * cos_i + cos_t)
    return r_s**2, r_p**2


def through(reflectance):
    """All orders of reflection between two equal surfaces."""
    return (1 - reflectance) / (1 + reflectance)


@pytest.mark.parametrize("angle", [0, 30, 60, 75, 80])
@pytest.mark.parametrize("fresnel", ["averaged", "polarised"])
def test_transmittance_of_a_slab(angle, fresnel):
    r_s, r_p = reflectances(angle)
    truth = {
        "averaged": through((r_s + r_p) / 2),
        "polarised": (through(r_s) + through(r_p)) / 2,
    }[fresnel]
    tilt = np.radians(angle)
    axis = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    lamp = scenes.beam(1000.0, 0.02, scenes.at(*(-0.3 * axis), axis=axis))
    receiver = scenes.floor(3.0, 64, scenes.at(z=-0.1), length=1.0)
    scene = scenes.scene(scenes.glass(scenes.box(4.0, 2.0, 0.01)), lamp=lamp, receiver=receiver)
    tracing = PhotonTracing(until="landed", landed=1_000_000, fresnel=fresnel)
    result = scenes.traced(scene, tracing, seed=5)
    flux, count = result.meta["flux"], result.meta["photons"]["emitted"]
    sigma = np.sqrt(truth * (1 - truth) / count)
    assert flux["landed"] / flux["emitted"] == pytest.approx(truth, abs=4 * sigma + 1e-4)


def test_the_published_values_are_what_the_closed_forms_give():
    assert through(sum(reflectances(60)) / 2) == pytest.approx(0.8362, abs=1e-4)
    assert sum(map(through, reflectances(60))) / 2 == pytest.approx(0.8481, abs=1e-4)
    assert sum(map(through, reflectances(80))) / 2 == pytest.approx(0.4585, abs=1e-4)


def test_polarised_light_keeps_its_account_through_total_reflections():
    """A prism where light turns by total reflection: exact and averaged Fresnel agree on the flux
    that two tilted total reflections rotate, and none is lost."""
    axis = np.array([0.35, 0.2, -1.0])
    lamp = scenes.sheet(1000.0, 0.01, 0.01, scenes.at(*(-0.3 * axis), axis=axis))
    scene = scenes.scene(
        scenes.glass(scenes.box(0.03, 0.03, 0.2)),
        lamp=lamp,
        receiver=scenes.floor(2.0, 32, scenes.at(z=-0.3)),
    )
    for fresnel in ("averaged", "polarised"):
        tracing = PhotonTracing(until="landed", landed=300_000, fresnel=fresnel, direct="traced")
        flux = scenes.traced(scene, tracing, seed=6).meta["flux"]
        parts = [flux[k] for k in ("landed", "absorbed", "escaped", "cut_off")]
        assert sum(parts) == pytest.approx(flux["emitted"], rel=1e-5)
        assert all(np.isfinite(parts))
        assert flux["absorbed"] == 0.0
