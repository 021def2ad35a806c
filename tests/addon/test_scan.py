"""Scans in Blender: from a file to the relief on a wall, and what is said where that cannot be."""

import bpy
import numpy as np
import pytest
import trimesh
from heliform.addon import jobs
from heliform.addon.bridge import print_layers, scan
from heliform.addon.bridge.print_styles import style_of
from heliform.engines.core import export
from heliform.operators.relief import relief_of

PERIOD, DEPTH, RADIUS = 5.0, 0.9, 100.0  # mm


@pytest.fixture(scope="module", autouse=True)
def _end_the_worker():
    yield
    if jobs._worker:
        jobs._worker.stop()
        jobs._worker = None


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.setattr(jobs, "results_folder", lambda: tmp_path / "results")


def sample(file, layers=True):
    """A piece of a tube in mm, 60° wide and 70 mm high, with cosine layers."""
    angle, z = np.meshgrid(np.radians(np.linspace(-30, 30, 260)), np.linspace(0, 70, 350))
    relief = DEPTH / 2 * np.cos(2 * np.pi * z / PERIOD) if layers else 0.0
    radius = RADIUS + relief + np.random.default_rng(1).normal(0, 0.02, z.shape)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)
    index = np.arange(z.size).reshape(z.shape)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)
    quads = quads.reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    trimesh.Trimesh(points.reshape(-1, 3), faces, process=False).export(file)
    return str(file)


def test_from_a_scan_to_the_relief_of_a_wall(scene, tmp_path):
    scene.heliform.scan_reading.file = sample(tmp_path / "Probe ä.ply")
    assert bpy.ops.heliform.read_scan() == {"FINISHED"}
    style = style_of(scene.heliform.relief)
    assert style.name == "Probe ä"
    assert style.height == pytest.approx(PERIOD / 1e3, rel=0.002)
    assert style.depth == pytest.approx(DEPTH / 1e3, abs=2e-5)
    facts = scan.facts_of(scene.heliform.relief)
    assert any("guess" in note or "taken" in note for note in facts["notes"])

    bpy.ops.heliform.add_wall(preset="tube")
    wall = bpy.context.object
    wall.heliform.wall.faces = 20_000
    assert bpy.ops.heliform.use_scan() == {"FINISHED"}
    relief, on_it = print_layers.read_modifier(relief_of(wall))
    assert relief.height == pytest.approx(style.height, rel=1e-6)
    np.testing.assert_allclose(on_it.profile.offsets, style.profile.offsets, atol=1e-6)
    assert wall.heliform.wall.bead.height == pytest.approx(style.height, rel=1e-6)


def test_it_survives_saving_though_nothing_uses_it(scene, tmp_path):
    scene.heliform.scan_reading.file = sample(tmp_path / "a.ply")
    bpy.ops.heliform.read_scan()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    relief = bpy.context.scene.heliform.relief
    assert scan.facts_of(relief)["figures"]["layer_height"]["unit"] == "m"
    assert style_of(relief).height == pytest.approx(PERIOD / 1e3, rel=0.002)
    picture = bpy.data.images["a outer height"]
    assert picture.packed_file
    assert picture.is_float


def test_reading_again_replaces_the_patch(scene, tmp_path):
    scene.heliform.scan_reading.file = sample(tmp_path / "a.ply")
    bpy.ops.heliform.read_scan()
    before = {o.name for o in scene.objects}
    bpy.ops.heliform.read_scan()
    assert {o.name for o in scene.objects} == before


def test_what_has_the_names_already_is_the_users(scene, tmp_path):
    mine = bpy.data.objects.new("a outer", bpy.data.meshes.new("a outer"))
    scene.collection.objects.link(mine)
    picture = bpy.data.images.new("a outer height", 4, 3)
    scene.heliform.scan_reading.file = sample(tmp_path / "a.ply")
    assert bpy.ops.heliform.read_scan() == {"FINISHED"}
    assert not mine.data.vertices
    assert tuple(picture.size) == (4, 3)
    facts = scan.facts_of(scene.heliform.relief)
    assert facts["images"] == ["a outer height.001"]
    patch = scene.objects["a outer.001"]
    patch.name = "Renamed"
    counts = [len(c) for c in (bpy.data.objects, bpy.data.meshes, bpy.data.images)]
    assert bpy.ops.heliform.read_scan() == {"FINISHED"}
    assert [len(c) for c in (bpy.data.objects, bpy.data.meshes, bpy.data.images)] == counts
    assert len(patch.data.vertices)


def test_choosing_a_scan_reads_it(scene, tmp_path):
    file = sample(tmp_path / "a.ply")
    assert bpy.ops.heliform.choose_scan(filepath=file) == {"FINISHED"}
    assert scene.heliform.scan_reading.file == file
    assert scan.facts_of(scene.heliform.relief)


def test_choosing_what_cannot_be_read_is_one_sentence(scene, tmp_path):
    (tmp_path / "leer.ply").write_bytes(b"nothing")
    with pytest.raises(RuntimeError) as said:
        bpy.ops.heliform.choose_scan(filepath=str(tmp_path / "leer.ply"))
    assert "Traceback" not in str(said.value)
    assert len(str(said.value).strip().splitlines()) == 1
    assert not jobs.state.running


def test_a_job_reads_the_scan_where_it_lies(scene, tmp_path, monkeypatch):
    copied = []
    monkeypatch.setattr(export, "_copy", lambda *given: copied.append(given))
    scene.heliform.scan_reading.file = sample(tmp_path / "a.ply")
    assert bpy.ops.heliform.read_scan() == {"FINISHED"}
    assert not copied


def test_a_relief_that_one_wall_cannot_take_changes_none(scene, tmp_path):
    scene.heliform.scan_reading.file = sample(tmp_path / "a.ply")
    bpy.ops.heliform.read_scan()
    walls = []
    for _ in range(2):
        bpy.ops.heliform.add_wall(preset="tube")
        walls.append(bpy.context.object)
        walls[-1].heliform.wall.faces, walls[-1].heliform.wall.bead.height = 10_000, 0.004
    walls[1].data.vertices[0].co.x += 0.01
    for wall in walls:
        wall.select_set(True)
    bpy.context.view_layer.objects.active = walls[0]
    before = [state_of(wall) for wall in walls]
    with pytest.raises(RuntimeError, match="changed by hand"):
        bpy.ops.heliform.use_scan()
    assert [state_of(wall) for wall in walls] == before


def state_of(wall):
    """What a relief would change: the modifier, the layers of the wall and its mesh."""
    modifier = print_layers.read_modifier(relief_of(wall))
    places = np.array([v.co for v in wall.data.vertices])
    height = wall.heliform.wall.bead.height
    return modifier[0], modifier[1].digest, height, places.tobytes(), wall.heliform.problem


def test_a_scan_without_layers_is_said_and_leaves_nothing(scene, tmp_path):
    scene.heliform.scan_reading.file = sample(tmp_path / "glatt.ply", layers=False)
    before = (len(bpy.data.objects), len(bpy.data.images))
    with pytest.raises(RuntimeError, match="confidence"):
        bpy.ops.heliform.read_scan()
    assert (len(bpy.data.objects), len(bpy.data.images)) == before
    assert scene.heliform.relief is None


def test_without_a_scan_there_is_nothing_to_put_on(scene):
    bpy.ops.heliform.add_wall(preset="tube")
    assert not bpy.ops.heliform.use_scan.poll()


@pytest.mark.parametrize(("name", "content"), [("fehlt.ply", None), ("leer.stl", b"")])
def test_a_file_that_cannot_be_read_is_said(scene, tmp_path, name, content):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    scene.heliform.scan_reading.file = str(tmp_path / name)
    with pytest.raises(RuntimeError, match=name.partition(".")[0]):
        bpy.ops.heliform.read_scan()
