"""Glazing of a given transmittance lets that through, as a sheet and as a pane of any thickness."""

import numpy as np
import pytest
from heliform.engines.core.glazing import (
    by_absorption,
    highest_transmittance,
    normal_depth,
    thickness,
)
from heliform.engines.core.material_presets import material_presets
from heliform.engines.core.scene import Material, Mesh, Scene
from heliform.engines.light.stage import build
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.visibility import visible
from sun.rooms import traced
from sun.shades import box, level
from sun.test_panes import at_angles, slab

GLAZINGS = {n: p.material for n, p in material_presets().items() if p.group == "Glazing"}
SENSOR = at_points([[0, 0, 0]], [[0, 0, 1]])
ANGLES = np.array([0.0, 30, 60, 80])


def sheet(material):
    return level("Pane", 200, 200, 1, material)


def pane(material, thick=0.006):
    return box("Pane", (200, 200, thick), (0, 0, 1), material)


def through(body, angles=ANGLES):
    return visible(Occluders([body]), SENSOR, at_angles(angles)).values()[0]


def depth(material):
    """By the closed form of the whole slab, found by halving."""
    low, high = 0.0, 20.0
    for _ in range(60):
        middle = (low + high) / 2
        if slab(0, material.ior, middle) > material.transmittance:
            low = middle
        else:
            high = middle
    return low


@pytest.mark.parametrize("name", GLAZINGS)
@pytest.mark.parametrize("made", [sheet, pane])
def test_each_glazing_lets_its_figure_through(name, made):
    material = GLAZINGS[name]
    kept = through(made(material))
    assert kept[0] == pytest.approx(material.transmittance, rel=5e-3)
    assert kept == pytest.approx(slab(ANGLES, material.ior, depth(material)), abs=1e-4)


@pytest.mark.parametrize("name", GLAZINGS)
def test_diffuse_light_loses_more_than_straight_light(name):
    """The mean over the hemisphere, weighted by the cosine, against the same of the closed form."""
    material = GLAZINGS[name]
    angles = np.degrees(np.arcsin(np.sqrt((np.arange(400) + 0.5) / 400)))
    mean = through(sheet(material), angles).mean()
    assert mean < 0.97 * material.transmittance
    assert mean == pytest.approx(slab(angles, material.ior, depth(material)).mean(), rel=1e-3)


def test_paths_through_glazing_lose_as_much():
    material = GLAZINGS["double-low-e"]
    point, up = [[0.0, 0, 0]], [[0.0, 0, 1]]
    for thick in (0.006, 0.03):
        lit = traced([pane(material, thick)], point, up, bounces=1)
        angles = np.degrees(np.arcsin(np.sqrt((np.arange(400) + 0.5) / 400)))
        mean = slab(angles, material.ior, depth(material)).mean()
        assert lit.straight.sum() / np.pi == pytest.approx(mean, rel=0.02)


@pytest.mark.parametrize("name", GLAZINGS)
def test_the_tint_is_that_of_radiances_glass(name):
    """Its manual's formula for the transmissivity that gives a transmittance, of index 1.52."""
    wanted = GLAZINGS[name].transmittance
    root = np.sqrt(0.8402528435 + 0.0072522239 * wanted**2)
    theirs = (root - 0.9166530661) / 0.0036261119 / wanted
    assert np.exp(-normal_depth(GLAZINGS[name])) == pytest.approx(theirs, rel=1e-5)


@pytest.mark.parametrize("thick", [0.002, 0.006, 0.03])
def test_thickness_does_not_count(thick):
    material = Material(ior=1.52, transmittance=0.5)
    assert through(pane(material, thick)) == pytest.approx(through(sheet(material)), abs=1e-4)


def test_nothing_and_all_are_let_through():
    assert through(sheet(Material(transmittance=0.0))).max() == 0
    assert through(sheet(Material(ior=1.0, transmittance=0.7)))[0] == pytest.approx(0.7, abs=1e-4)


def test_more_than_the_index_allows_is_said():
    clear = Material(ior=1.52, transmittance=0.97)
    seen = visible(Occluders([sheet(clear)]), SENSOR, at_angles(ANGLES))
    assert highest_transmittance(1.52) == pytest.approx(0.9183, abs=1e-4)
    assert seen.values()[0, 0] == pytest.approx(0.9183, abs=1e-4)
    assert any("lets 91.8 % through at normal incidence, the most" in n for n in seen.notes)


def test_a_tinted_sheet_is_told_of_the_remedy():
    tinted = visible(Occluders([sheet(Material(absorption=40.0))]), SENSOR, at_angles(ANGLES))
    assert any("give it a thickness or a transmittance" in note for note in tinted.notes)
    known = visible(Occluders([sheet(GLAZINGS["double-low-e"])]), SENSOR, at_angles(ANGLES))
    assert not any("not closed" in note for note in known.notes)


def turned(mesh):
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    return Mesh(mesh.vertices @ turn.T + [5, 6, 7], mesh.faces)


@pytest.mark.parametrize("size", [(1, 2, 0.006), (0.1, 0.1, 0.02)])
def test_the_thickness_of_a_plate(size):
    mesh = box("Plate", size, (0, 0, 0)).mesh
    assert thickness(mesh) == pytest.approx(size[2])
    assert thickness(turned(mesh)) == pytest.approx(size[2])


def test_the_thickness_of_a_bent_pane_is_its_mean():
    """A tube of 5 mm between radii of 0.1 m and 0.105 m, without its ends."""
    turn = 2 * np.pi * np.arange(256) / 256
    rings = [(0.1, 0.0), (0.105, 0.0), (0.105, 9.0), (0.1, 9.0)]
    vertices = np.array([[r * np.cos(t), r * np.sin(t), z] for r, z in rings for t in turn])
    k = np.arange(256)
    faces = [
        np.stack([a * 256 + k, a * 256 + (k + 1) % 256, b * 256 + (k + 1) % 256, b * 256 + k], 1)
        for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))
    ]
    mesh = Mesh(vertices, np.concatenate(faces)[:, ::-1].astype(np.int32))
    assert thickness(mesh) == pytest.approx(0.005, rel=2e-3)


def test_photons_find_the_same_tint():
    """Light traces glass by its absorption, so a pane of any thickness gets the one it needs."""
    material = GLAZINGS["single-grey-6"]
    for thick in (0.006, 0.03):
        made = by_absorption(box("Pane", (0.3, 0.4, thick), (0, 0, 1), material)).material
        assert made.transmittance == 1
        assert slab(0, 1.52, made.absorption * thick) == pytest.approx(0.431, rel=1e-5)
        seen = np.array(
            build(Scene((box("Pane", (0.3, 0.4, thick), (0, 0, 1), material),))).absorption
        )
        assert seen[1] * 1000 * thick == pytest.approx(depth(material), rel=1e-4)
    plain = box("Pane", (1, 1, 0.006), (0, 0, 1), Material(absorption=3.0))
    assert by_absorption(plain) is plain
