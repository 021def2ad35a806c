"""Glass, lamps and receivers are made in Blender and follow their properties."""

import time

import bpy
import numpy as np
import pytest
from heliform.addon.bridge.meshes import from_blender, to_blender
from heliform.addon.properties import read
from heliform.engines.core import solid
from heliform.engines.core.scene import Lamp, Mesh
from heliform.engines.glass import TABLE_1, GlassObject, glass_object
from heliform.engines.light import ies

FEW = {"preset": "custom", "faces": 12_000}


def add(**options):
    bpy.ops.heliform.add_glass_object(**FEW | options)
    return bpy.context.object


def evaluated(obj):
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get())


def size(obj):
    bpy.context.view_layer.update()
    return list(obj.dimensions)


def corner_normals(block):
    normals = np.empty((len(block.loops), 3), np.float32)
    block.corner_normals.foreach_get("vector", normals.ravel())
    return normals


@pytest.mark.parametrize("preset", TABLE_1)
def test_a_printed_object_has_its_size_its_faces_and_its_normals(preset, record_property):
    started = time.perf_counter()
    bpy.ops.heliform.add_glass_object(preset=preset)
    record_property("seconds", time.perf_counter() - started)
    obj, record = bpy.context.object, TABLE_1[preset]
    assert len(obj.data.polygons) == pytest.approx(record.faces, rel=0.005)
    meant = [record.width, record.depth, record.height]
    assert size(obj) == pytest.approx(meant, rel=1e-3)
    assert read(obj.heliform.glass_object, GlassObject) == record
    meant = glass_object(record)
    assert np.abs(corner_normals(obj.data) - meant.normals.reshape(-1, 3)).max() < 1e-3
    assert solid.inspect(from_blender(evaluated(obj))).problem == ""


def test_a_mesh_comes_back_exactly():
    meant = glass_object(GlassObject(faces=12_000))
    obj = bpy.data.objects.new("Glass", to_blender(meant, "Glass"))
    bpy.context.collection.objects.link(obj)
    back = from_blender(evaluated(obj))
    assert np.array_equal(back.vertices, meant.vertices.astype(np.float32))
    assert np.array_equal(back.faces, meant.faces)
    assert np.array_equal(back.normals, meant.normals)


def test_a_flat_mesh_of_triangles_comes_back_without_normals():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    meant = Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.int32))
    obj = bpy.data.objects.new("Tetrahedron", to_blender(meant, "Tetrahedron"))
    bpy.context.collection.objects.link(obj)
    back = from_blender(evaluated(obj))
    assert np.array_equal(back.faces, meant.faces)
    assert back.normals is None


def test_a_slider_changes_the_mesh():
    obj = add()
    obj.heliform.glass_object.width = 0.3
    assert size(obj)[0] == pytest.approx(0.3, rel=1e-3)
    faces = len(obj.data.polygons)
    obj.heliform.glass_object.faces = 24_000
    assert size(obj)[0] == pytest.approx(0.3, rel=1e-3)
    assert len(obj.data.polygons) == pytest.approx(2 * faces, rel=0.02)
    normals = corner_normals(obj.data).astype(float)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1, abs=1e-3)


def test_what_cannot_be_leaves_the_last_good_mesh_and_says_so():
    obj = add()
    before = size(obj), len(obj.data.polygons)
    obj.heliform.glass_object.bead.sag = 0.004
    assert "more than half its height" in obj.heliform.problem
    assert (size(obj), len(obj.data.polygons)) == before
    obj.heliform.glass_object.bead.sag = 0.002
    assert obj.heliform.problem == ""


def test_an_object_that_is_edited_is_left_alone():
    obj = add()
    bpy.ops.object.mode_set(mode="EDIT")
    obj.heliform.glass_object.width = 0.3
    assert "leave Edit Mode" in obj.heliform.problem
    bpy.ops.object.mode_set(mode="OBJECT")


def test_a_linked_copy_gets_a_mesh_of_its_own():
    obj = add()
    bpy.ops.object.duplicate(linked=True)
    copy = bpy.context.object
    copy.heliform.glass_object.height = 0.1
    assert copy.data is not obj.data
    assert size(obj)[2] == pytest.approx(0.209, rel=1e-3)


def test_a_bad_value_adds_nothing():
    with pytest.raises(RuntimeError, match=r"0\.02 to 2 m"):
        bpy.ops.heliform.add_glass_object(preset="custom", width=9.0)
    assert not bpy.data.objects
    assert not bpy.data.meshes


def test_a_preset_reshapes():
    obj = add()
    bpy.ops.heliform.reshape_glass(preset="four_bulges")
    assert read(obj.heliform.glass_object, GlassObject) == TABLE_1["four_bulges"]
    assert size(obj)[1] == pytest.approx(0.245, rel=1e-3)


def test_it_stands_at_the_cursor(scene):
    scene.cursor.location = 1, 2, 3
    obj = add()
    low = min(corner[2] for corner in obj.bound_box)
    assert (*obj.location, low) == pytest.approx((1, 2, 3, 0))


@pytest.mark.parametrize("source", ["ies", "disk", "point", "beam"])
def test_a_lamp_shows_itself_and_is_not_rendered(source):
    bpy.ops.heliform.add_lamp(source=source)
    obj = bpy.context.object
    assert obj.heliform.problem == ""
    assert obj.location.z == pytest.approx(0.22)
    assert obj.hide_render
    assert len(obj.data.polygons) == 0
    assert len(obj.data.edges) > 50


def test_a_lamp_follows_its_properties(tmp_path):
    bpy.ops.heliform.add_lamp()
    obj = bpy.context.object
    before = len(obj.data.vertices)
    obj.heliform.lamp.file = str(tmp_path / "no.ies")
    assert "There is no photometric file" in obj.heliform.problem
    assert len(obj.data.vertices) == before
    copy = tmp_path / "Spot ä.ies"
    copy.write_bytes(ies.sample_path().read_bytes())
    obj.heliform.lamp.file = str(copy)
    assert obj.heliform.problem == ""
    obj.heliform.lamp.source = "disk"
    assert "no luminous flux" in obj.heliform.problem or "0 lm" in obj.heliform.problem
    obj.heliform.lamp.flux = 500
    assert obj.heliform.problem == ""
    obj.heliform.lamp.width = 0.5
    assert size(obj)[0] > 0.5
    assert read(obj.heliform.lamp, Lamp).width == 0.5


def test_a_receiver_follows_its_size():
    bpy.ops.heliform.add_receiver(width=2.0)
    obj = bpy.context.object
    assert size(obj) == pytest.approx([2, 0.8, 0])
    obj.heliform.plane.length = 3.0
    assert size(obj) == pytest.approx([2, 3, 0])
    assert [tuple(uv.vector) for uv in obj.data.uv_layers.active.uv] == [
        (0, 0), (1, 0), (1, 1), (0, 1)
    ]  # fmt: skip


def test_marking_says_what_cannot_be_a_receiver():
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    bpy.ops.heliform.mark_as(role="BODY", kind="mirror")
    assert (obj.heliform.role, obj.heliform.material.kind) == ("BODY", "mirror")
    obj.data.uv_layers.active.uv.foreach_set("vector", [0, 0, 1, 0, 1, 1, 0, 1] * 6)
    obj.data.update()
    with pytest.raises(RuntimeError, match="Receiver “Cube” has overlapping UVs"):
        bpy.ops.heliform.mark_as(role="RECEIVER")
    assert obj.heliform.role == "BODY"
    bpy.ops.mesh.primitive_plane_add()
    bpy.ops.heliform.mark_as(role="RECEIVER")
    assert bpy.context.object.heliform.role == "RECEIVER"


def test_the_demo_is_experiment_a(seen):
    bpy.ops.heliform.add_demo()
    scene = seen()
    floor = scene.receivers[0].origin[2]
    assert scene.bodies[0].mesh.vertices[:, 2].min() - floor == pytest.approx(1e-3, abs=1e-7)
    assert scene.luminaires[0].pose[2, 3] - floor == pytest.approx(0.22, abs=1e-7)
    assert np.linalg.norm(scene.receivers[0].u) == pytest.approx(0.8)


def test_check_and_repair():
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    assert bpy.ops.heliform.check_glass() == {"FINISHED"}
    block = obj.data
    keep = [list(p.vertices) for p in block.polygons][1:]
    places = [tuple(v.co) for v in block.vertices]
    block.clear_geometry()
    block.from_pydata(places, [], keep)
    with pytest.raises(RuntimeError, match="“Cube” is open: 4 edges"):
        bpy.ops.heliform.check_glass()
    bpy.ops.heliform.repair_glass()
    assert bpy.ops.heliform.check_glass() == {"FINISHED"}


def test_undo_takes_a_change_back():
    bpy.ops.ed.undo_push(message="Before")
    add()
    bpy.ops.ed.undo_push(message="Added")
    bpy.context.object.heliform.glass_object.width = 0.3
    bpy.ops.ed.undo_push(message="Changed")
    bpy.ops.ed.undo()
    obj = bpy.data.objects["Glass"]
    assert obj.heliform.glass_object.width == pytest.approx(0.217)
    assert size(obj)[0] == pytest.approx(0.217, rel=1e-3)
    bpy.ops.ed.undo()
    assert "Glass" not in bpy.data.objects
