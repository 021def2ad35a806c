"""Add Work Plane: a receiver over a room's floor."""

import bpy
import numpy as np
import pytest
from heliform.engines.core.scene import Surface


def room(name="Raum ä/1", size=(6, 4, 3)):
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, size[2] / 2))
    obj = bpy.context.object
    obj.name, obj.scale = name, size
    bpy.context.view_layer.update()
    return obj


def area(receiver):
    mesh = receiver.mesh
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a)[:, 2].sum() / 2


def test_it_is_a_receiver_over_the_floor(seen):
    room()
    assert bpy.ops.heliform.add_work_plane() == {"FINISHED"}
    made = bpy.context.object
    assert (made.name, made.heliform.role) == ("Raum ä/1 work plane", "RECEIVER")
    (found,) = seen().receivers
    assert isinstance(found, Surface)
    assert area(found) == pytest.approx(5 * 3, rel=1e-5)
    assert found.mesh.vertices[:, 2] == pytest.approx(0.8, abs=1e-6)
    assert (found.columns, found.rows) == (10, 10)
    texel = 1 / 10 / np.ptp(found.texture[..., 0]) * np.ptp(found.mesh.vertices[:, 0])
    assert texel == pytest.approx(0.5, rel=1e-5)


def test_its_settings_are_in_the_scenes_units(scene, seen):
    scene.unit_settings.scale_length = 0.001
    room(size=(6000, 4000, 3000))
    bpy.ops.heliform.add_work_plane(margin=1000.0)
    assert bpy.context.object.location.z == pytest.approx(800)
    (found,) = seen().receivers
    assert area(found) == pytest.approx(4 * 2, rel=1e-5)
    assert found.columns == 8


def test_rooms_and_columns_that_are_selected_together_are_one(seen):
    column = room("Column", (0.6, 0.4, 3))
    whole = room()
    column.select_set(True)
    bpy.ops.heliform.add_work_plane()
    assert bpy.context.object.name == f"{whole.name} work plane"
    assert area(seen().receivers[0]) == pytest.approx(15 - 1.6 * 1.4, rel=1e-4)


def test_chosen_faces_in_edit_mode(seen):
    obj = room()
    top = max(range(6), key=lambda k: obj.data.polygons[k].center.z)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    with pytest.raises(RuntimeError, match="No face of “Raum ä/1” is selected"):
        bpy.ops.heliform.add_work_plane()
    assert bpy.context.mode == "EDIT_MESH"
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.data.polygons[top].select = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.heliform.add_work_plane(height=0.1)
    assert bpy.context.mode == "OBJECT"
    (found,) = seen().receivers
    assert found.mesh.vertices[:, 2] == pytest.approx(3.1, abs=1e-5)
    assert area(found) == pytest.approx(15, rel=1e-5)


def test_what_cannot_be_adds_nothing():
    room()
    with pytest.raises(RuntimeError, match="leaves nothing of the floor of “Raum ä/1”"):
        bpy.ops.heliform.add_work_plane(margin=3.0)
    bpy.ops.mesh.primitive_plane_add(rotation=(np.pi / 2, 0, 0))
    with pytest.raises(RuntimeError, match="“Plane” has no horizontal floor"):
        bpy.ops.heliform.add_work_plane()
    assert len(bpy.data.objects) == 2
    bpy.ops.heliform.add_receiver()
    assert not bpy.ops.heliform.add_work_plane.poll()


def test_undo_takes_it_back():
    room()
    bpy.ops.ed.undo_push(message="Before")
    bpy.ops.heliform.add_work_plane()
    bpy.ops.ed.undo_push(message="Added")
    assert len(bpy.data.objects) == 2
    bpy.ops.ed.undo()
    assert [obj.name for obj in bpy.data.objects] == ["Raum ä/1"]


def test_a_study_of_daylight_measures_on_it(scene):
    from heliform.addon.bridge.sun import gather
    from heliform.engines.sun import SUN_DAYLIGHT

    room()
    bpy.ops.heliform.add_work_plane()
    given = gather(bpy.context, SUN_DAYLIGHT)
    assert [r.name for r in given.scene.receivers] == ["Raum ä/1 work plane"]
    assert given.notes == ()  # its map is its own: nothing is unwrapped
