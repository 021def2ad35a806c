"""Beer–Lambert in tinted glass, with Fresnel's reflections to the sum of their series."""

import numpy as np
import pytest
from heliform.engines.core.scene import Body, Material, Scene
from heliform.engines.light import PhotonTracing
from light import scenes
from light.test_slab import IOR, reflectances

TINTS = (5.0, 40.0, 200.0)  # 1/m
THICK = 0.01


def tinted(mesh, absorption):
    return Body("Glass", mesh, Material(ior=IOR, absorption=absorption))


def through(reflectance, left):
    """Transmittance of a slab of which a crossing leaves the share ``left``."""
    return (1 - reflectance) ** 2 * left / (1 - (reflectance * left) ** 2)


def returned(reflectance, left):
    """What comes back from it."""
    return reflectance * (1 + left * through(reflectance, left))


@pytest.mark.parametrize("absorption", TINTS)
@pytest.mark.parametrize("angle", [0, 60])
@pytest.mark.parametrize("fresnel", ["averaged", "polarised"])
def test_a_tinted_slab(absorption, angle, fresnel):
    tilt = np.radians(angle)
    inside = np.arcsin(np.sin(tilt) / IOR)
    left = np.exp(-absorption * THICK / np.cos(inside))
    r_s, r_p = reflectances(angle)
    waves = [(r_s + r_p) / 2] if fresnel == "averaged" else [r_s, r_p]
    truth = np.mean([through(r, left) for r in waves])
    back = np.mean([returned(r, left) for r in waves])

    axis = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    lamp = scenes.beam(1000.0, 0.02, scenes.at(*(-0.3 * axis), axis=axis))
    receiver = scenes.floor(3.0, 64, scenes.at(z=-0.1), length=1.0)
    slab = tinted(scenes.box(4.0, 2.0, THICK), absorption)
    tracing = PhotonTracing(until="landed", landed=300_000, fresnel=fresnel)
    result = scenes.traced(Scene((slab,), (lamp,), (receiver,)), tracing, seed=5)
    flux, count = result.meta["flux"], result.meta["photons"]["emitted"]
    for name, share in (("landed", truth), ("escaped", back), ("absorbed", 1 - truth - back)):
        sigma = np.sqrt(share * (1 - share) / count)
        assert flux[name] / flux["emitted"] == pytest.approx(share, abs=4 * sigma + 1e-4)
    assert result.meta["traced_half_width"] / result.mean < 0.01


@pytest.mark.parametrize("absorption", TINTS)
def test_the_chord_of_a_tinted_ball(absorption):
    """A thin beam at the height h of a ball of radius R: chord 2 √(R² − (h/n)²)."""
    radius, height, width = 0.02, 0.008, 1e-4
    sine = height / radius
    chord = 2 * radius * np.sqrt(1 - (sine / IOR) ** 2)
    r_s, r_p = reflectances(np.degrees(np.arcsin(sine)))
    reflectance, left = (r_s + r_p) / 2, np.exp(-absorption * chord)
    # Straight through; what is reflected inside leaves elsewhere.
    turn_in, turn_out = np.arcsin(sine), np.arcsin(sine / IOR)
    straight = (1 - reflectance) ** 2 * left
    ball = tinted(scenes.sphere(radius, 7), absorption)
    axis = np.array([0.0, 0.0, -1.0])
    lamp = scenes.beam(1000.0, width, scenes.at(height, 0.0, 0.1, axis))
    bent = 2 * (turn_in - turn_out)
    place = radius * np.sin(turn_in - bent) - (0.025 - radius * np.cos(turn_in - bent)) * np.tan(
        bent
    )
    receiver = scenes.floor(0.002, 4, scenes.at(place, 0.0, -0.025))
    tracing = PhotonTracing(until="landed", landed=int(400_000 * straight))
    result = scenes.traced(Scene((ball,), (lamp,), (receiver,)), tracing, seed=2)
    share = result.meta["flux"]["landed"] / result.meta["flux"]["emitted"]
    sigma = np.sqrt(straight * (1 - straight) / result.meta["photons"]["emitted"])
    assert share == pytest.approx(straight, abs=4 * sigma + 5e-4 * straight)


def test_tint_only_counts_inside():
    """What a tint takes does not depend on how far the lamp and the receiver are."""
    shares = []
    for far in (0.1, 5.0):
        lamp = scenes.beam(1000.0, 0.02, scenes.at(z=far))
        scene = Scene(
            (tinted(scenes.box(0.1, 0.1, THICK), 40.0),),
            (lamp,),
            (scenes.floor(0.5, 16, scenes.at(z=-far)),),
        )
        flux = scenes.traced(scene, PhotonTracing(until="landed", landed=200_000)).meta["flux"]
        shares.append(flux["landed"] / flux["emitted"])
    assert shares[0] == pytest.approx(shares[1], abs=4e-3)


def test_glass_on_a_tinted_one_keeps_each_its_own():
    """Two slabs, only the lower one tinted."""
    upper = Body("Clear", scenes.box(0.1, 0.1, 0.01, (0, 0, 0.01)), Material(ior=1.0))
    lower = Body(
        "Tinted", scenes.box(0.1, 0.1, 0.01, (0, 0, -0.01)), Material(ior=1.0, absorption=70)
    )
    lamp = scenes.beam(1000.0, 0.02, scenes.at(z=0.1))
    scene = Scene((upper, lower), (lamp,), (scenes.floor(0.2, 8, scenes.at(z=-0.1)),))
    flux = scenes.traced(scene, PhotonTracing(until="landed", landed=200_000), seed=1).meta["flux"]
    assert flux["landed"] / flux["emitted"] == pytest.approx(np.exp(-0.7), abs=4e-3)
