"""The caustic of a wall whose relief is a live modifier: that of the mesh once it is applied, and
that of the wall whose relief and normals are written down."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from heliform.addon.bridge import print_layers
from heliform.engines.core.scene import Mesh
from heliform.engines.glass.presets import TABLE_1_WALLS
from heliform.engines.glass.printed import wall_mesh
from heliform.engines.glass.profile import Style, flat_bead, texture_of
from heliform.engines.glass.relief import Relief
from heliform.engines.light import PhotonTracing, trace
from heliform.operators.relief import relief_of

FEW, LANDED, TEXELS = 60_000, 60_000, 24
LAMP, GAP = 0.22, 1e-3
MAPS = ("illuminance", "caustic", "direct", "half_width", "lower", "upper")
Z = 1.959964


def stage(preset, faces=None):
    """A wall a hair above a plane, below the sample lamp; the wall."""
    bpy.ops.heliform.add_wall(preset=preset)
    wall = bpy.context.object
    if faces:
        wall.heliform.wall.faces = faces
    bpy.ops.heliform.add_lamp()
    bpy.context.object.location = 0, 0, LAMP
    bpy.ops.heliform.add_receiver()
    bpy.context.object.location = 0, 0, -GAP
    bpy.context.object.heliform.plane.resolution = TEXELS
    bpy.context.view_layer.objects.active = wall
    return wall


def rough_spiral(wall):
    """A flat bead, wound and rough, on the outer face alone."""
    texture, _ = texture_of(np.random.default_rng(3).normal(size=(32, 64)), (0.03, 0.015))
    bead = flat_bead(5e-3, 1e-3)
    style = Style("Rough", bead.profile, bead.inner, texture, bead.height, bead.depth, 4e-5)
    relief = Relief(amplitude=1e-3, roughness=4e-5, sides="outer", seed=5)
    print_layers.write_modifier(relief_of(wall), relief, style)


def traced(scene, seed=7):
    tracing = PhotonTracing(until="landed", landed=LANDED, kernel="none")
    (found,) = trace(scene, tracing, seed=seed).maps
    return found


def deviations(one, other):
    """(one − other) ÷ its standard deviation, by their intervals, over texels above 5 % of the
    mean."""
    spread = np.hypot(one.half_width, other.half_width) / Z
    bright = np.minimum(one.caustic, other.caustic) > 0.05 * other.caustic.mean()
    return ((one.caustic - other.caustic) / spread)[bright].astype(np.float64)


def of_mesh(scene, mesh: Mesh):
    """The scene with another mesh as its glass."""
    (body,) = scene.bodies
    return replace(scene, bodies=(replace(body, mesh=mesh),))


@pytest.mark.parametrize("preset", [*TABLE_1_WALLS, "rough spiral"])
def test_applying_the_modifier_changes_not_one_bit(scene, seen, preset):
    rough = preset == "rough spiral"
    wall = stage("tube" if rough else preset, FEW)
    if rough:
        rough_spiral(wall)
    live = seen()
    lit = traced(live)
    assert bpy.ops.object.modifier_apply(modifier=relief_of(wall).name) == {"FINISHED"}
    assert relief_of(wall) is None
    applied = seen()
    for name in ("vertices", "faces", "normals"):
        before, after = (getattr(s.bodies[0].mesh, name) for s in (live, applied))
        np.testing.assert_array_equal(before, after)
    still = traced(applied)
    assert lit.caustic.max() > 0
    for name in MAPS:
        np.testing.assert_array_equal(getattr(lit, name), getattr(still, name))


@pytest.mark.parametrize("preset", TABLE_1_WALLS)
def test_the_caustic_of_table_1_is_that_of_the_exact_beads(scene, seen, preset):
    """The live wall is shaded by the faces around, the other as the arc of the bead: the two differ
    by 3° RMS at these counts, most of it in the row beside a crease."""
    stage(preset)
    live, exact = seen(), wall_mesh(TABLE_1_WALLS[preset])
    np.testing.assert_allclose(live.bodies[0].mesh.vertices, exact.vertices, atol=1e-6)
    np.testing.assert_array_equal(live.bodies[0].mesh.faces, exact.faces)
    ours, theirs = traced(live), traced(of_mesh(live, exact), seed=8)
    away = deviations(ours, theirs)
    assert len(away) > 400
    assert np.mean(away**2) < 1.4  # 1 by chance; 3.5 and more for glass of n = 1.45
    assert np.mean(np.abs(away) < Z) > 0.91  # 0.95 by chance
    photons = min(ours.meta["photons"]["landed"], theirs.meta["photons"]["landed"])
    ratio = ours.mean_of("caustic") / theirs.mean_of("caustic")
    assert ratio == pytest.approx(1, abs=5 / np.sqrt(photons))


def test_a_wall_without_relief_has_another_caustic(scene, seen):
    """The comparison above tells them apart."""
    wall = stage("tube", FEW)
    live = seen()
    relief_of(wall).show_viewport = False
    assert np.mean(deviations(traced(live), traced(seen(), seed=8)) ** 2) > 10
