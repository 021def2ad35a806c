"""Blender's curves as closed loops: true to the curve, and what is no closed curve is said."""

import math

import bpy
import numpy as np
import pytest
from heliform.addon.bridge.curves import closed_loops
from heliform.engines.core.errors import SceneError


def loops(obj):
    return closed_loops(obj, bpy.context.evaluated_depsgraph_get())


@pytest.mark.parametrize("kind", ["bezier", "nurbs"])
def test_a_circle_is_round_where_it_stands(scene, kind):
    add = getattr(bpy.ops.curve, f"primitive_{kind}_circle_add")
    add(radius=0.1, location=(1, 2, 3), rotation=(0, 0, 0.3))
    (loop,) = loops(bpy.context.object)
    away = np.hypot(*(loop[:, :2] - (1, 2)).T)
    assert np.abs(away - 0.1).max() < 3e-5  # a Bézier circle's own error
    np.testing.assert_allclose(loop[:, 2], 3, atol=1e-6)
    steps = np.linalg.norm(np.diff(loop[:, :2], axis=0, append=loop[:1, :2]), axis=1)
    assert steps.sum() == pytest.approx(2 * math.pi * 0.1, rel=1e-3)
    assert steps.max() < 2 * steps.mean()  # in their order around


def test_how_the_curve_is_shown_does_not_matter(scene):
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.1)
    obj = bpy.context.object
    (plain,) = loops(obj)
    obj.data.dimensions, obj.data.fill_mode = "2D", "BOTH"
    obj.data.bevel_depth, obj.data.extrude, obj.data.resolution_u = 0.01, 0.2, 2
    (shown,) = loops(obj)
    np.testing.assert_allclose(shown, plain, atol=1e-6)
    assert not [o for o in bpy.data.objects if o != obj]
    assert len(bpy.data.curves) == 1


def test_a_closed_line_of_edges_is_a_curve_too(scene):
    bpy.ops.mesh.primitive_circle_add(radius=0.1, vertices=32)
    (loop,) = loops(bpy.context.object)
    assert len(loop) == 32


def test_two_splines_are_two_loops(scene):
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.1)
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.2, location=(0, 0, 0.5))
    bpy.context.scene.objects[0].select_set(True)
    bpy.ops.object.join()
    found = sorted(loops(bpy.context.object), key=lambda loop: loop[0, 2])
    assert [round(float(np.hypot(*loop[0, :2])), 4) for loop in found] == [0.1, 0.2]


def test_what_is_no_closed_curve_is_said(scene):
    bpy.ops.curve.primitive_bezier_curve_add()
    bpy.context.object.name = "Linie ä/1"
    with pytest.raises(SceneError, match=r"“Linie ä/1” is open at \(.*\); close it"):
        loops(bpy.context.object)
    bpy.ops.mesh.primitive_plane_add()
    mesh = bpy.context.object.data
    mesh.clear_geometry()
    with pytest.raises(SceneError, match="has no curve in it"):
        loops(bpy.context.object)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -1, 0)], [(0, 1), (0, 2), (0, 3)], [])
    with pytest.raises(SceneError, match="is open at"):
        loops(bpy.context.object)
    mesh.clear_geometry()
    mesh.from_pydata(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
        [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)],
        [],
    )
    with pytest.raises(SceneError, match=r"forks at"):
        loops(bpy.context.object)
