"""Walls in Blender: added, reshaped, following curves, with live relief, and undone."""

import bpy
import numpy as np
import pytest
from heliform.addon.bridge import print_layers
from heliform.addon.bridge.meshes import from_blender, places_of
from heliform.engines.core.scene import Mesh
from heliform.engines.core.solid import inspect
from heliform.engines.glass.loft import Wall
from heliform.engines.glass.presets import PRESETS, TABLE_1_WALLS
from heliform.engines.glass.printed import wall_mesh
from heliform.engines.glass.profile import scalloped
from heliform.operators.relief import relief_of

TABLE_1 = {"tube": (217, 217, 209), "three_bulges": (262, 283, 201), "four_bulges": (231, 245, 201)}
FACES = {"tube": 263_783, "three_bulges": 244_668, "four_bulges": 237_827}


def evaluated(obj) -> Mesh:
    return from_blender(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))


def add(preset="tube", faces=20_000):
    bpy.ops.heliform.add_wall(preset=preset)
    obj = bpy.context.object
    obj.heliform.wall.faces = faces
    return obj


@pytest.mark.parametrize("preset", TABLE_1)
def test_a_wall_with_the_modifier_is_the_printed_object_of_table_1(scene, preset):
    bpy.ops.heliform.add_wall(preset=preset)
    mesh = evaluated(bpy.context.object)
    np.testing.assert_allclose(1e3 * np.ptp(mesh.vertices, axis=0), TABLE_1[preset], atol=0.1)
    assert len(mesh.faces) == pytest.approx(FACES[preset], rel=0.02)
    assert not inspect(mesh).problem


def test_the_modifier_gives_the_wall_that_the_engine_makes(scene):
    obj = add()
    ours = wall_mesh(Wall(**{**_fields(TABLE_1_WALLS["tube"]), "faces": 20_000}))
    np.testing.assert_allclose(evaluated(obj).vertices, ours.vertices, atol=1e-6)


def _fields(record):
    return {name: getattr(record, name) for name in record.__slots__}


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_is_a_solid(scene, preset):
    obj = add(preset)
    assert not obj.heliform.problem
    assert not inspect(evaluated(obj)).problem


def test_sliders_reshape_it_and_the_layers_stay_on_its_rows(scene):
    obj = add()
    obj.heliform.wall.height = 0.1
    obj.heliform.wall.bead.height = 0.004
    bpy.context.view_layer.update()
    assert obj.dimensions.z == pytest.approx(0.1, abs=1e-6)
    relief, _ = print_layers.read_modifier(relief_of(obj))
    assert relief.height == 0.004


def test_what_cannot_be_leaves_the_last_good_shape_and_says_why(scene):
    obj = add()
    before = places_of(obj.data)
    obj.heliform.wall.thickness = 0.25
    assert obj.heliform.problem
    np.testing.assert_array_equal(places_of(obj.data), before)
    obj.heliform.wall.thickness = 0.008
    assert not obj.heliform.problem


def test_a_preset_keeps_the_relief(scene):
    obj = add()
    bpy.ops.heliform.add_relief(style="flat")
    bpy.ops.heliform.reshape_wall(preset="twisted")
    assert print_layers.read_modifier(relief_of(obj))[0].style == "flat"
    assert obj.heliform.wall.twist > 0


def test_a_wall_follows_a_curve_and_follows_it_again(scene):
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.1, location=(1, 2, 0.5))
    curve = bpy.context.object
    assert bpy.ops.heliform.wall_from_curves(height=0.05) == {"FINISHED"}
    obj = bpy.context.object
    np.testing.assert_allclose(obj.location, (1, 2, 0.5), atol=1e-6)
    bpy.context.view_layer.update()
    # Half a thickness stands outside the curve, which is the middle of the wall.
    np.testing.assert_allclose(obj.dimensions, (0.208, 0.208, 0.05), atol=1e-4)
    curve.scale = (0.5, 0.5, 1)
    bpy.context.view_layer.update()
    bpy.ops.heliform.rebuild_wall()
    bpy.context.view_layer.update()
    np.testing.assert_allclose(obj.dimensions, (0.108, 0.108, 0.05), atol=1e-4)


def test_a_stack_of_curves_is_lofted_to_their_heights(scene):
    for z, radius in ((0.0, 0.1), (0.1, 0.08), (0.25, 0.12)):
        bpy.ops.curve.primitive_bezier_circle_add(radius=radius, location=(0, 0, z))
    for obj in bpy.data.objects:
        obj.select_set(True)
    bpy.ops.heliform.wall_from_curves()
    bpy.context.object.modifiers.clear()
    wall = evaluated(bpy.context.object).vertices
    assert np.ptp(wall[:, 2]) == pytest.approx(0.25, abs=1e-6)
    for z, radius in ((0.1, 0.08), (0.25, 0.12)):
        near = np.abs(wall[:, 2] - z) < 5e-4
        assert np.hypot(*wall[near, :2].T).max() == pytest.approx(radius + 0.004, abs=5e-4)


def test_an_open_curve_is_refused_and_nothing_is_added(scene):
    bpy.ops.curve.primitive_bezier_curve_add()
    bpy.context.object.name = "Linie ä/1"
    before = list(bpy.data.objects)
    with pytest.raises(RuntimeError, match="“Linie ä/1” is open"):
        bpy.ops.heliform.wall_from_curves()
    assert list(bpy.data.objects) == before


def test_a_curve_that_is_deleted_is_said(scene):
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.1)
    curve = bpy.context.object
    bpy.ops.heliform.wall_from_curves()
    obj = bpy.context.object
    bpy.data.objects.remove(curve)
    obj.heliform.wall.thickness = 0.009
    assert "was deleted" in obj.heliform.problem


def test_sizes_are_blender_units(scene):
    scene.unit_settings.scale_length = 0.001
    obj = add("rosette")
    assert obj.heliform.wall.height == pytest.approx(200.0)
    assert obj.dimensions.z == pytest.approx(200.0, abs=1e-3)
    relief, _ = print_layers.read_modifier(relief_of(obj), 0.001)
    assert relief.height == 0.005
    assert evaluated(obj).vertices[:, 2].max() == pytest.approx(200.0, abs=1e-3)


def test_relief_on_other_meshes_and_copies(scene):
    obj = add()
    bpy.ops.mesh.primitive_cylinder_add(vertices=64, radius=0.1, depth=0.2)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.subdivide(number_cuts=20)
    bpy.ops.object.mode_set(mode="OBJECT")
    other = bpy.context.object
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    assert bpy.ops.heliform.copy_relief() == {"FINISHED"}
    assert relief_of(other).node_group == relief_of(obj).node_group
    assert np.hypot(*evaluated(other).vertices[:, :2].T).min() < 0.1 - 1e-3


def test_relief_saved_and_loaded(scene, tmp_path):
    obj = add()
    file = tmp_path / "Profil ä.npz"
    assert bpy.ops.heliform.save_relief(filepath=str(file)) == {"FINISHED"}
    before = evaluated(obj).vertices
    obj.modifiers.clear()
    assert bpy.ops.heliform.load_relief(filepath=str(file)) == {"FINISHED"}
    relief, style = print_layers.read_modifier(relief_of(obj))
    assert (relief.height, relief.amplitude) == (0.005, pytest.approx(0.0012))
    relief_of(obj).show_viewport = True
    print_layers.write_modifier(relief_of(obj), relief.__class__(spiral=False), style)
    np.testing.assert_allclose(evaluated(obj).vertices, before, atol=1e-6)


def test_a_relief_that_does_not_fit_is_refused(scene):
    obj = add()
    obj.modifiers.clear()
    obj.heliform.wall.thickness = 0.002
    assert not obj.heliform.problem
    with pytest.raises(RuntimeError, match="nothing is left"):
        bpy.ops.heliform.add_relief(style="flat")
    assert not obj.modifiers


def test_a_file_that_is_no_relief_is_refused(scene, tmp_path):
    add()
    (tmp_path / "x.npz").write_bytes(b"no zip")
    with pytest.raises(RuntimeError, match="no relief style"):
        bpy.ops.heliform.load_relief(filepath=str(tmp_path / "x.npz"))


def test_a_drawn_curve_becomes_the_cross_section(scene):
    obj = add()
    curve = bpy.data.curves.new("Bead", "CURVE")
    line = curve.splines.new("POLY")
    line.points.add(8)
    for index, point in enumerate(line.points):
        share = index / 8
        point.co = (0.001 * np.sin(np.pi * share), 0.0, 0.005 * share, 1)
    drawn = bpy.data.objects.new("Bead", curve)
    scene.collection.objects.link(drawn)
    drawn.select_set(True)
    obj.select_set(True)
    assert bpy.ops.heliform.draw_relief() == {"FINISHED"}
    relief, style = print_layers.read_modifier(relief_of(obj))
    assert relief.amplitude == pytest.approx(0.001, rel=0.02)
    assert relief.height == pytest.approx(0.005, rel=1e-3)
    assert style.profile.at(0.5) == pytest.approx(1.0, abs=1e-3)


def test_a_mesh_that_was_changed_by_hand_is_left_alone(scene):
    obj = add()
    bpy.ops.object.modifier_apply(modifier=relief_of(obj).name)
    applied = places_of(obj.data)
    obj.heliform.wall.height = 0.1
    assert "was changed by hand" in obj.heliform.problem
    np.testing.assert_array_equal(places_of(obj.data), applied)


def test_thin_layers_are_no_dead_end(scene):
    obj = add()
    modifier = relief_of(obj)
    relief, style = print_layers.read_modifier(modifier)
    print_layers.write_modifier(modifier, relief.__class__(amplitude=8e-4, spiral=False), style)
    obj.heliform.wall.bead.height = 0.002
    assert not obj.heliform.problem
    relief, style = print_layers.read_modifier(modifier)
    assert relief.height == 0.002
    exact = scalloped(0.002, relief.amplitude)
    np.testing.assert_allclose(style.profile.offsets, exact.profile.offsets, atol=1e-6)


def test_a_relief_too_deep_for_new_layers_is_said_and_nothing_changes(scene):
    obj = add()
    before = places_of(obj.data)
    obj.heliform.wall.bead.height = 0.002
    assert "more than half its layer" in obj.heliform.problem
    np.testing.assert_array_equal(places_of(obj.data), before)


def test_a_wall_goes_where_its_curve_goes(scene):
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.1)
    curve = bpy.context.object
    bpy.ops.heliform.wall_from_curves(height=0.05)
    obj = bpy.context.object
    obj.location.x += 1.0
    curve.location.y += 0.3
    bpy.context.view_layer.update()
    bpy.ops.heliform.rebuild_wall()
    np.testing.assert_allclose(obj.location, (1.0, 0.3, 0.0), atol=1e-6)
