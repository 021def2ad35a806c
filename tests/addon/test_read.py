"""The Blender scene, as the engines get it."""

import math

import bpy
import numpy as np
import pytest
from heliform.engines.core import solid
from heliform.engines.core.errors import SceneError
from mathutils import Matrix

FEW = {"preset": "custom", "faces": 12_000}


def add_glass(**options):
    bpy.ops.heliform.add_glass_object(**FEW | options)
    return bpy.context.object


def volume(mesh):
    corners = mesh.triangles()
    a, b, c = (corners.vertices[corners.faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def agreement(mesh):
    """The least cosine between a face's own normal and those of its corners."""
    flat = mesh.triangles()
    a, b, c = (flat.vertices[flat.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    return np.einsum("ij,ikj->ik", normal, flat.normals).min()


def test_an_empty_scene_is_empty(seen):
    bpy.ops.mesh.primitive_cube_add()
    assert seen() == type(seen())()


def test_names_are_kept_and_sorted(seen):
    for name in ("Vase ä/1", "Base", "瓶"):
        add_glass().name = name
    assert [body.name for body in seen().bodies] == ["Base", "Vase ä/1", "瓶"]


def test_a_moved_glass_is_a_solid_of_the_right_size(seen):
    obj = add_glass()
    upright = seen().bodies[0].mesh
    obj.matrix_world = Matrix.LocRotScale((1, 2, 3), Matrix.Rotation(0.7, 3, "X"), (2, 0.5, -3))
    mesh = seen().bodies[0].mesh
    assert solid.inspect(mesh).problem == ""
    assert volume(mesh) == pytest.approx(3 * volume(upright), rel=1e-4)
    assert mesh.faces.shape[1] == 4
    assert agreement(mesh) > 0.5
    assert np.linalg.norm(mesh.normals, axis=-1) == pytest.approx(1, abs=1e-5)


def test_millimetres_are_read_as_metres(scene, seen):
    scene.unit_settings.scale_length = 0.001
    bpy.ops.heliform.add_demo()
    tube = bpy.data.objects["Tube"]
    assert tube.dimensions.x == pytest.approx(217, rel=1e-3)
    tube.heliform.glass_object.faces = 12_000
    tube.heliform.glass_object.width = 300
    assert tube.heliform.problem == ""
    found = seen()
    assert np.ptp(found.bodies[0].mesh.vertices[:, 0]) == pytest.approx(0.3, rel=1e-3)
    assert np.linalg.norm(found.receivers[0].u) == pytest.approx(0.8)
    assert found.luminaires[0].pose[:3, 3] == pytest.approx([0, 0, 0.219])
    assert found.luminaires[0].pose[:3, :3] == pytest.approx(np.eye(3))


def test_a_lamps_own_size_in_millimetres(scene, seen):
    scene.unit_settings.scale_length = 0.001
    bpy.ops.heliform.add_lamp(source="disk", width=40.0)
    lamp = seen().luminaires[0].lamp
    assert (lamp.width, lamp.flux) == (0.04, 500.0)


def test_modifiers_count(seen):
    obj = add_glass()
    one = seen().bodies[0].mesh
    array = obj.modifiers.new("Array", "ARRAY")
    array.relative_offset_displace = (2, 0, 0)
    two = seen().bodies[0].mesh
    assert len(two.faces) == 2 * len(one.faces)
    assert volume(two) == pytest.approx(2 * volume(one), rel=1e-4)


@pytest.mark.parametrize("kind", ["SIMPLE_DEFORM", "MIRROR"])
def test_normals_follow_a_modifier(seen, kind):
    obj = add_glass()
    modifier = obj.modifiers.new("Changed", kind)
    if kind == "SIMPLE_DEFORM":
        modifier.deform_method, modifier.angle, modifier.deform_axis = "TWIST", 1.0, "Z"
    assert agreement(seen().bodies[0].mesh) > 0.5
    modifier.show_viewport = False
    assert agreement(seen().bodies[0].mesh) > 0.5
    assert "custom_normal" in obj.data.attributes


def test_what_is_hidden_off_or_excluded_is_left_out(scene, seen):
    shown, hidden, off, put_away = (add_glass() for _ in range(4))
    hidden.hide_set(True)
    off.heliform.on = False
    drawer = bpy.data.collections.new("Drawer")
    scene.collection.children.link(drawer)
    drawer.objects.link(put_away)
    scene.collection.objects.unlink(put_away)
    bpy.context.view_layer.layer_collection.children["Drawer"].exclude = True
    assert [body.name for body in seen().bodies] == [shown.name]


def test_a_body_without_faces_is_said(seen):
    obj = bpy.data.objects.new("Empty mesh", bpy.data.meshes.new("Empty mesh"))
    bpy.context.collection.objects.link(obj)
    obj.heliform.role = "BODY"
    with pytest.raises(SceneError, match="“Empty mesh” has no faces"):
        seen()


def test_a_concave_quadrilateral_and_a_pentagon_are_cut_as_blender_cuts_them(seen):
    block = bpy.data.meshes.new("Arrow")
    block.from_pydata([(0, 0, 0), (2, -1, 0), (0.5, 0, 0), (2, 1, 0)], [], [(1, 2, 3, 0)])
    obj = bpy.data.objects.new("Arrow", block)
    bpy.context.collection.objects.link(obj)
    obj.heliform.role = "BODY"
    mesh = seen().bodies[0].mesh
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)[:, 2] / 2
    assert np.all(areas < 0) or np.all(areas > 0)
    assert abs(areas.sum()) == pytest.approx(0.5)


def test_a_lamps_pose_and_opening(seen):
    bpy.ops.heliform.add_lamp(source="disk", opening="rectangular", width=0.1, length=0.2)
    obj = bpy.context.object
    obj.matrix_world = Matrix.LocRotScale(
        (1, 2, 3), Matrix.Rotation(math.pi / 2, 3, "Y"), (2, 3, 4)
    )
    found = seen().luminaires[0]
    assert found.pose[:3, 3] == pytest.approx([1, 2, 3])
    assert -found.pose[:3, 2] == pytest.approx([-1, 0, 0], abs=1e-6)
    assert (found.lamp.width, found.lamp.length) == pytest.approx((0.3, 0.4), rel=1e-6)


def test_a_lamps_file_beside_the_blend(seen, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.heliform.add_lamp(source="ies", file="//lamp.ies")
    assert "lamp.ies" in bpy.context.object.heliform.problem
    assert seen().luminaires[0].lamp.file == str(tmp_path / "lamp.ies")


def world_corners(obj):
    return [tuple(obj.matrix_world @ v.co) for v in obj.data.vertices]


def rectangle_corners(found):
    o, u, v = found.origin, found.u, found.v
    return [tuple(corner) for corner in (o, o + u, o + u + v, o + v)]


@pytest.mark.parametrize("own", [True, False])
@pytest.mark.parametrize("scale", [(1, 1, 1), (2, 0.5, 3), (-1, -2, 1)])
def test_a_receivers_corners_are_the_meshs(seen, own, scale):
    if own:
        bpy.ops.mesh.primitive_plane_add(size=2)
        bpy.ops.heliform.mark_as(role="RECEIVER")
    else:
        bpy.ops.heliform.add_receiver(width=2.0, length=1.0)
    obj = bpy.context.object
    turn = Matrix.Rotation(0.5, 3, "X") @ Matrix.Rotation(0.3, 3, "Z")
    obj.matrix_world = Matrix.LocRotScale((1, 2, 3), turn, scale)
    found = seen().receivers[0]
    mesh, read = world_corners(obj), rectangle_corners(found)
    assert np.array(sorted(read)) == pytest.approx(np.array(sorted(mesh)), abs=1e-5)
    up = np.array(obj.matrix_world.to_3x3().inverted().transposed() @ obj.data.polygons[0].normal)
    assert found.normal @ up > 0
    index = [loop.vertex_index for loop in obj.data.loops]
    for corner, uv in zip(index, obj.data.uv_layers.active.uv, strict=True):
        s, t = uv.vector
        assert found.origin + s * found.u + t * found.v == pytest.approx(
            np.array(mesh[corner]), abs=1e-5
        )


def test_a_subdivided_plane_is_a_receiver(seen):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=5, y_subdivisions=3, size=1)
    bpy.ops.heliform.mark_as(role="RECEIVER")
    assert np.linalg.norm(seen().receivers[0].u) == pytest.approx(1)


def test_a_mirrored_receiver_is_said(seen):
    bpy.ops.heliform.add_receiver()
    bpy.context.object.scale.x = -1
    bpy.context.object.name = "Wand ä/2"
    with pytest.raises(SceneError, match="“Wand ä/2” is mirrored"):
        seen()
