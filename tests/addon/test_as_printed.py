"""A scan of a finished piece in Blender: the deviation on the design, and its figures."""

import bpy
import numpy as np
import pytest
import trimesh
from heliform.addon import jobs
from heliform.addon.bridge import as_printed, layers
from heliform.addon.bridge.meshes import from_blender


@pytest.fixture(scope="module", autouse=True)
def _end_the_worker():
    yield
    if jobs._worker:
        jobs._worker.stop()
        jobs._worker = None


@pytest.fixture
def wall(scene, tmp_path, monkeypatch):
    monkeypatch.setattr(jobs, "results_folder", lambda: tmp_path / "results")
    bpy.ops.heliform.add_wall(preset="rosette")
    obj = bpy.context.object
    obj.name = "Wand ä/1"
    obj.heliform.wall.faces, obj.heliform.wall.height = 40_000, 0.08
    return obj


def scanned(obj, file, bulge=0.0):
    """The wall as a scan in mm, turned and moved, 1 mm further out on one side."""
    mesh = from_blender(obj.evaluated_get(bpy.context.evaluated_depsgraph_get())).triangles()
    points = mesh.vertices.copy()
    away = np.hypot(*points[:, :2].T)
    hump = bulge * np.exp(-((points[:, 0] - away.max()) ** 2 + points[:, 1] ** 2) / 0.02**2)
    points[:, :2] *= (1 + hump / away)[:, None]
    points += np.random.default_rng(2).normal(0, 2e-5, points.shape)
    turn = trimesh.transformations.rotation_matrix(0.4, [1, 2, 3])
    points = points @ turn[:3, :3].T + (0.3, -0.2, 0.1)
    trimesh.Trimesh(1e3 * points, mesh.faces, process=False).export(file)
    return str(file)


def test_the_design_is_coloured_by_what_became_of_it(wall, scene, tmp_path):
    scene.heliform.comparison.file = scanned(wall, tmp_path / "Scan ä.ply", bulge=1e-3)
    scene.heliform.comparison.tolerance = 2e-4
    assert bpy.ops.heliform.compare_print() == {"FINISHED"}
    layer = layers.layer_of(wall)
    assert layer.quantity == "Deviation, outward"
    values = np.empty(len(wall.data.vertices), dtype=np.float32)
    wall.data.attributes[layers.VALUES].data.foreach_get("value", values)
    places = np.array([v.co for v in wall.data.vertices])
    near = (np.hypot(places[:, 0] - places[:, 0].max(), places[:, 1]) < 5e-3) & (
        np.abs(places[:, 2] - 0.04) < 0.02
    )
    assert np.nanmedian(values[near]) == pytest.approx(0.95, abs=0.1)
    far = places[:, 0] < -0.05
    assert abs(np.nanmedian(values[far])) < 0.05
    (mark,) = layer.marks
    assert mark.place[0] > 0.08
    figures = as_printed.facts_of(wall)["figures"]
    assert 0.5 < figures["within_tolerance"]["value"] < 0.99


def test_objects_of_the_users_are_left_alone(wall, scene, tmp_path):
    wall.modifiers.new("", "SUBSURF").subdivision_type = "SIMPLE"
    wall.heliform.wall.faces = 20_000
    mine = bpy.data.objects.new(f"{wall.name} as printed", bpy.data.meshes.new("Mine"))
    scene.collection.objects.link(mine)
    scene.heliform.comparison.file = scanned(wall, tmp_path / "a.ply")
    assert bpy.ops.heliform.compare_print() == {"FINISHED"}
    made = [o for o in scene.objects if layers.layer_of(o)]
    assert len(made) == 1
    assert mine.data.name == "Mine"
    assert not mine.data.vertices
    made[0].name = "Renamed"
    meshes = len(bpy.data.meshes)
    assert bpy.ops.heliform.compare_print() == {"FINISHED"}
    assert [o.name for o in scene.objects if layers.layer_of(o)] == ["Renamed"]
    assert len(bpy.data.meshes) == meshes


def test_without_a_scan_or_a_design_it_cannot_be_asked_for(wall, scene, tmp_path):
    assert not bpy.ops.heliform.compare_print.poll()
    scene.heliform.comparison.file = str(tmp_path / "fehlt.ply")
    assert bpy.ops.heliform.compare_print.poll()
    with pytest.raises(RuntimeError, match="fehlt"):
        bpy.ops.heliform.compare_print()
    assert layers.layer_of(wall) is None


def test_a_scan_of_something_else_is_said(wall, scene, tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=5, radius=100)
    ball.export(tmp_path / "Kugel.stl")
    scene.heliform.comparison.file = str(tmp_path / "Kugel.stl")
    with pytest.raises(RuntimeError, match=r"touches the design nowhere|% of the scan"):
        bpy.ops.heliform.compare_print()
