"""Scenes at the edge of what float32, quadrature and aiming can do, against what must come out."""

import time
import tracemalloc

import numpy as np
import pytest
import trimesh
from heliform.engines.core.scene import Body, Lamp, Luminaire, Material, Mesh, Scene
from heliform.engines.light import PhotonTracing, aim, emission, ies, luminaires
from light import scenes

LANDED = PhotonTracing(until="landed", landed=200_000)


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-7, 0.0])
def test_glass_may_stand_on_the_receiver(gap):
    """A slab 20 mm thick on the plane: the light that a slab lets through lands."""
    axis = np.array([0.5, 0.0, -0.866])
    slab = scenes.glass(scenes.box(0.4, 0.4, 0.02, (0.0, 0.0, 0.01 + gap)))
    lamp = scenes.beam(1000.0, 0.02, scenes.at(*(-0.3 * axis), axis=axis))
    scene = scenes.scene(slab, lamp=lamp, receiver=scenes.floor(1.0, 64))
    flux = scenes.traced(scene, LANDED, seed=1).meta["flux"]
    # R(30°) of n = 1.5, averaged, is .0416.
    assert flux["landed"] / flux["emitted"] == pytest.approx((1 - 0.0416) / (1 + 0.0416), abs=4e-3)


@pytest.mark.parametrize("distance", [1.0, 30.0, 100.0])
def test_a_far_lamp_gives_the_same_caustic(distance):
    axis = np.array([0.0, np.sin(np.radians(50)), -np.cos(np.radians(50))])
    slab = scenes.glass(scenes.box(0.4, 0.4, 0.02, (0.0, 0.0, 0.05)))
    lamp = scenes.beam(1000.0, 0.01, scenes.at(*(-distance * axis), axis=axis))
    receiver = scenes.floor(0.6, 120)
    result = scenes.traced(scenes.scene(slab, lamp=lamp, receiver=receiver), LANDED, seed=1)
    place = scenes.texel_centres(receiver)
    mean = (place[..., 1] * result.caustic).sum() / result.caustic.sum()
    assert mean == pytest.approx(expected_shift(), abs=1.5e-3)


def expected_shift():
    """Where the beam lands: straight on but for the slab, with the orders of inner reflection."""
    outside, inside = np.radians(50), np.arcsin(np.sin(np.radians(50)) / 1.5)
    r_s = (np.sin(outside - inside) / np.sin(outside + inside)) ** 2
    r_p = (np.tan(outside - inside) / np.tan(outside + inside)) ** 2
    reflectance = (r_s + r_p) / 2
    first = -0.02 * np.tan(outside) + 0.02 * np.tan(inside)
    step, share = 2 * 0.02 * np.tan(inside), reflectance**2
    return first + step * share / (1 - share)


def test_a_thin_beam_is_never_lost():
    """A beam of 0.5 mm on texels of 3 mm: its flux within what the interval says."""
    for seed in range(6):
        lamp = Luminaire("Thin", Lamp(source="beam", flux=10.0, width=5e-4), scenes.at(z=0.3))
        result = scenes.traced(
            Scene((), (lamp,), (scenes.floor(0.8, 256),)), PhotonTracing(), seed=seed
        )
        assert result.meta["flux"]["landed"] == pytest.approx(10.0, rel=0.6)
        assert result.half_width.max() > 0


@pytest.mark.parametrize("resolution", [1, 2, 4, 8, 64])
def test_coarse_texels_hold_the_same_light(resolution):
    lamp = Luminaire("Spot", Lamp(), scenes.at(z=0.22))
    result = scenes.traced(Scene((), (lamp,), (scenes.floor(0.8, resolution),)), PhotonTracing())
    fine = scenes.traced(Scene((), (lamp,), (scenes.floor(0.8, 512),)), PhotonTracing())
    assert result.mean == pytest.approx(fine.mean, rel=1e-3)


@pytest.mark.parametrize("height", [0.6, 0.15, 0.06])
def test_a_close_panel_has_its_form_factor(height):
    """A Lambertian square over the middle of its own size, in closed form."""
    side = 0.6
    lamp = Lamp(source="disk", flux=np.pi * side**2, opening="rectangular", width=side, length=side)
    scene = Scene((), (Luminaire("Panel", lamp, scenes.at(z=height)),), (scenes.floor(0.02, 2),))
    x = side / 2 / height
    lean = x / np.sqrt(1 + x * x)
    factor = 4 / np.pi * lean * np.arctan(lean)
    assert scenes.traced(scene, PhotonTracing()).mean == pytest.approx(np.pi * factor, rel=2e-3)


def test_a_line_source_is_a_line():
    line = Lamp(source="ies", opening="rectangular", width=0.0, length=1.2)
    settled = luminaires.source(Luminaire("Line", line, scenes.at(z=0.5)))
    assert (settled.shape, settled.length) == ("rectangular", 1.2)
    scene = Scene((), (Luminaire("Line", line, scenes.at(z=0.5)),), (scenes.floor(2.0, 40),))
    computed = scenes.traced(scene, PhotonTracing())
    traced = scenes.traced(scene, PhotonTracing(until="landed", landed=500_000, direct="traced"))
    both = np.hypot(traced.meta["mean_half_width"], 1e-3 * computed.mean)
    assert computed.mean == pytest.approx(traced.mean, abs=2.5 * both)


def test_a_cut_off_between_two_steps_keeps_the_flux(tmp_path):
    file = tmp_path / "cut.ies"
    file.write_text(
        "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 10\n0 5.05 5.1\n0\n100 100 0\n"
    )
    lamp = Luminaire("Cut", Lamp(file=str(file)), scenes.at(z=1.0))
    flux = scenes.traced(Scene((), (lamp,), (scenes.floor(1.0, 512),)), PhotonTracing()).meta[
        "flux"
    ]
    assert flux["landed"] == pytest.approx(flux["emitted"], rel=3e-3)
    grid = emission.intensity_grid(ies.read_ies(file))
    assert grid.min() >= 0


def test_a_fan_of_slivers_is_covered_in_little_memory():
    """A cylinder whose caps are 256 long triangles."""
    mesh = trimesh.creation.cylinder(0.1, 0.2, sections=256)
    tracemalloc.start()
    began = time.perf_counter()
    centres, radius = aim.cover(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    assert tracemalloc.get_traced_memory()[1] < 200e6
    tracemalloc.stop()
    assert time.perf_counter() - began < 30
    points = mesh.sample(2000, seed=1)
    nearest = np.linalg.norm(points[:, None] - centres[None], axis=2).min(axis=1)
    assert nearest.max() <= radius


def test_nothing_that_lands_is_no_certainty():
    """Black glass: no photon lands, the map has an upper bound and no error figure."""
    cover = Body("Lid", scenes.box(3.0, 3.0, 0.01, (0, 0, 0.1)), Material(kind="absorber"))
    lamp = Luminaire("Disk", Lamp(source="disk", flux=100.0, width=0.05), scenes.at(z=0.2))
    scene = Scene((cover,), (lamp,), (scenes.floor(0.5, 16),))
    result = scenes.traced(scene, PhotonTracing(), seed=1)
    assert result.meta["error"] is None
    assert "error" not in result.figures()
    assert (result.upper > 0).all()
    assert "None of" in result.meta["notes"][0]


def test_a_run_ends_at_its_latest():
    ball = scenes.glass(scenes.sphere(0.03, 4).moved(scenes.at(z=0.06)))
    lamp = Luminaire("Disk", Lamp(source="disk", flux=100.0, width=0.05), scenes.at(z=0.2))
    tracing = PhotonTracing(until="error", error=0.005, at_most=1.0)
    result = scenes.traced(Scene((ball,), (lamp,), (scenes.floor(0.5, 256),)), tracing, seed=1)
    assert "Stopped after" in result.meta["notes"][0]
    assert result.meta["error"] > 0.005


def test_a_sheared_lamp_is_named():
    pose = scenes.at(z=0.2)
    pose[0, 2] = 0.5
    lamp = Luminaire("Lämp/1", Lamp(source="disk", flux=1.0), pose)
    with pytest.raises(luminaires.SceneError, match="Lämp/1"):
        scenes.traced(Scene((), (lamp,), (scenes.floor(0.5, 16),)), PhotonTracing())


def test_a_mesh_far_from_its_loose_vertices_still_traces():
    ball = scenes.sphere(0.03, 4).moved(scenes.at(z=0.06))
    far = Mesh(np.vstack([ball.vertices, [[50.0, 0.0, 0.0]]]), ball.faces, ball.normals)
    lamp = scenes.beam(1000.0, 0.04, scenes.at(z=0.3))
    near, loose = (
        scenes.traced(
            scenes.scene(scenes.glass(m), lamp=lamp, receiver=scenes.floor(0.2, 32)), LANDED
        )
        for m in (ball, far)
    )
    assert loose.mean == pytest.approx(near.mean, rel=0.02)
