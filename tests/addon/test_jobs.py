"""Jobs end to end in background: a small real scene, the worker, the result on the receiver."""

import json
import os
import signal
import threading
import time

import bpy
import numpy as np
import pytest
from heliform.addon import jobs
from heliform.addon.bridge import results
from heliform.addon.bridge.read import read_scene
from heliform.engines import light
from heliform.engines.core.client import Ended
from heliform.engines.light import Irradiance


@pytest.fixture(scope="module", autouse=True)
def _end_the_worker():
    yield
    if jobs._worker:
        jobs._worker.stop()
        jobs._worker = None


@pytest.fixture
def ball(scene, tmp_path, monkeypatch):
    """A glass ball over a receiver of 32² texels, under a disk lamp; results go to tmp_path."""
    monkeypatch.setattr(jobs, "results_folder", lambda: tmp_path)
    bpy.ops.heliform.add_receiver(width=0.4, length=0.4, resolution=32)
    bpy.context.object.name = "Vase ä/1"
    receiver = bpy.context.object
    bpy.ops.heliform.add_lamp(source="disk", flux=100.0, opening="round", width=0.02)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.05, location=(0, 0, 0.06))
    bpy.ops.heliform.mark_as(role="BODY", kind="dielectric")
    tracing = scene.heliform.photon_tracing
    tracing.until, tracing.landed = "landed", 20_000
    return receiver


def values(image):
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], 4)[..., :3]


def test_the_result_comes_back_as_packed_images_that_survive_saving(ball, scene, tmp_path):
    assert bpy.ops.heliform.trace_photons() == {"FINISHED"}
    picture = scene.heliform.shown
    (folder,) = tmp_path.iterdir()
    (result,) = Irradiance.load(folder).maps
    assert picture.name == "Vase ä/1 false colour"
    assert picture.colorspace_settings.name == "sRGB"
    assert json.loads((folder / "result.json").read_text(encoding="utf-8"))["figures"]

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved ä.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "saved ä.blend"))
    image = bpy.data.images["Vase ä/1 illuminance"]
    assert image.packed_file
    assert image.is_float
    assert image.colorspace_settings.name == "Non-Color"
    np.testing.assert_array_equal(values(image)[..., 1], result.illuminance)
    kept = results.staged(bpy.context.scene.heliform.shown)
    for name in ("caustic", "lower", "upper", "half_width"):
        np.testing.assert_array_equal(getattr(kept, name), getattr(result, name))
    assert kept.meta["receiver"] == "Vase ä/1"
    nodes = bpy.data.objects["Vase ä/1"].material_slots[0].material.node_tree.nodes
    assert nodes.active.image == bpy.context.scene.heliform.shown


def test_another_run_replaces_the_images_in_place(ball, scene, tmp_path):
    bpy.ops.heliform.trace_photons()
    before = {image.name: image.session_uid for image in bpy.data.images}
    ball.heliform.plane.resolution = 16
    bpy.ops.heliform.trace_photons()
    assert {image.name: image.session_uid for image in bpy.data.images} == before
    assert tuple(scene.heliform.shown.size) == (16, 16)
    assert len(list(tmp_path.iterdir())) == 2


def test_the_users_own_material_stays_with_the_mesh(ball):
    mine = bpy.data.materials.new("Mine")
    ball.data.materials.append(mine)
    bpy.ops.heliform.trace_photons()
    assert ball.data.materials[0] == mine
    assert ball.material_slots[0].material != mine


def test_the_engines_sentence_is_the_operators(ball):
    bpy.data.objects.remove(bpy.data.objects["Lamp"])
    with pytest.raises(RuntimeError, match="There is no lamp to trace from"):
        bpy.ops.heliform.trace_photons()
    assert not jobs.state.running


def test_without_a_receiver_there_is_a_sentence(scene):
    with pytest.raises(RuntimeError, match="no receiver"):
        bpy.ops.heliform.trace_photons()


def test_a_folder_that_cannot_be_written_is_named(ball, tmp_path, monkeypatch):
    blocked = tmp_path / "a file"
    blocked.touch()
    monkeypatch.setattr(jobs, "results_folder", lambda: blocked)
    with pytest.raises(RuntimeError, match=r"a file.*cannot be written"):
        bpy.ops.heliform.trace_photons()


def test_two_in_the_same_second_have_a_folder_each(tmp_path, monkeypatch):
    monkeypatch.setattr(jobs, "results_folder", lambda: tmp_path / "new")
    monkeypatch.setattr(jobs.time, "strftime", lambda _: "noon")
    found = [jobs._new_folder("Vase").name for _ in range(3)]
    assert found == ["Vase noon", "Vase noon 2", "Vase noon 3"]


def test_without_a_result_there_is_no_folder(ball, tmp_path):
    before = set(tmp_path.iterdir())
    bpy.data.objects.remove(bpy.data.objects["Lamp"])
    with pytest.raises(RuntimeError, match="lamp"):
        bpy.ops.heliform.trace_photons()
    assert set(tmp_path.iterdir()) == before


def follow(until, seconds=20.0):
    """What Blender's timer does in a window, until the condition holds."""
    latest = time.monotonic() + seconds
    while not until():
        assert time.monotonic() < latest
        jobs._follow()
        time.sleep(0.02)


@pytest.fixture
def endless(ball, scene, monkeypatch):
    """A job of the window that runs until something ends it; its events are kept."""
    ended = []

    def keep(task, event):
        ended.append((task, event))
        jobs.state.running = False

    monkeypatch.setattr(jobs, "_finish", keep)
    scene.heliform.photon_tracing.until = "time"
    scene.heliform.photon_tracing.seconds = 600.0
    jobs.begin(bpy.context, light.TRACE_PHOTONS, "Trace Photons")
    follow(lambda: jobs.state.fraction > 0)
    return ended


def test_cancel(endless, tmp_path):
    bpy.ops.heliform.cancel_job()
    follow(lambda: endless)
    assert endless[0][1].outcome == "cancelled"
    assert not list(tmp_path.iterdir())


def test_one_job_at_a_time(endless):
    assert not bpy.ops.heliform.trace_photons.poll()
    jobs.cancel()
    follow(lambda: endless)
    assert bpy.ops.heliform.trace_photons.poll()


def test_a_killed_worker_is_a_sentence_and_the_next_job_runs(endless, scene):
    os.kill(jobs.worker().pid, signal.SIGKILL)
    follow(lambda: endless)
    task, event = endless[0]
    with pytest.raises(jobs.WorkerDied, match="ended with signal 9") as caught:
        jobs.result_of(event)
    assert "“Trace Photons” was done" in jobs._told(task, caught.value)
    scene.heliform.photon_tracing.until = "landed"
    assert bpy.ops.heliform.trace_photons() == {"FINISHED"}


def test_another_file_ends_the_job_and_its_result_goes_nowhere(endless, monkeypatch):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert not jobs.state.running
    follow(lambda: endless)
    assert endless[0][0].forgotten


def finished(ball, tmp_path):
    """A task whose result lies in a folder but is not staged yet."""
    bpy.ops.heliform.trace_photons()
    (folder,) = (path for path in tmp_path.iterdir() if path.is_dir())
    task = jobs._prepare(bpy.context, light.TRACE_PHOTONS, "Trace Photons")
    return task, Ended(task.job, "done", out=folder)


def test_a_receiver_renamed_meanwhile_gets_the_result(ball, scene, tmp_path):
    task, ended = finished(ball, tmp_path)
    ball.name = "Renamed"
    jobs._conclude(task, ended)
    assert scene.heliform.shown.name == "Renamed false colour"


@pytest.mark.parametrize("held", [False, True])
def test_a_receiver_deleted_meanwhile_is_said(ball, tmp_path, held):
    task, ended = finished(ball, tmp_path)
    if held:  # something else still uses it, but it is in no scene
        ball.use_fake_user = True
        for collection in ball.users_collection:
            collection.objects.unlink(ball)
    else:
        bpy.data.objects.remove(ball)
    with pytest.raises(jobs.SceneError, match="“Vase ä/1” was deleted"):
        jobs._conclude(task, ended)


@pytest.fixture
def vessel(ball):
    """An open cylinder without a UV map around the ball, gathering on both sides."""
    bpy.ops.mesh.primitive_cylinder_add(
        radius=0.15, depth=0.2, location=(0, 0, 0.11), end_fill_type="NOTHING"
    )
    obj = bpy.context.object
    obj.name = "Cylinder"
    obj.data.uv_layers.remove(obj.data.uv_layers[0])
    obj.data.update()
    obj.heliform.role = "RECEIVER"
    obj.heliform.plane.sides, obj.heliform.plane.resolution = "both", 32
    obj.heliform.plane.reflectance = 0.5
    return obj


def test_each_receiver_and_side_gets_its_picture(vessel, ball, scene, tmp_path):
    assert bpy.ops.heliform.trace_photons() == {"FINISHED"}
    pictures = results.results_of(scene)
    assert [results.name_of(p) for p in pictures] == [
        "Cylinder (front)", "Cylinder (back)", "Vase ä/1"
    ]  # fmt: skip
    assert scene.heliform.shown == pictures[1]  # the lit side of the active receiver
    notes = results.meta_of(pictures[2])["notes"]
    assert any("“Cylinder” had no UV map" in note for note in notes)
    (folder,) = tmp_path.iterdir()
    loaded = Irradiance.load(folder)
    for picture, one in zip(pictures, loaded.maps, strict=True):
        np.testing.assert_array_equal(results.staged(picture).illuminance, one.illuminance)
    bpy.context.view_layer.objects.active = ball
    bpy.ops.heliform.trace_photons()
    assert scene.heliform.shown == pictures[2]
    bpy.context.view_layer.objects.active = None
    bpy.ops.heliform.trace_photons()
    assert scene.heliform.shown == pictures[2]  # as it was


def test_the_rest_is_staged_where_one_receiver_was_deleted(vessel, ball, scene, tmp_path):
    task, ended = finished(ball, tmp_path)
    bpy.data.objects.remove(vessel)
    jobs._conclude(task, ended)
    (picture,) = results.results_of(scene)
    assert any("“Cylinder” was deleted" in n for n in results.meta_of(picture)["notes"])


def photons(scene):
    return results.meta_of(scene.heliform.shown)["photons"]["emitted"]


def test_photons_are_added_to_what_there_is(ball, scene, tmp_path):
    bpy.data.objects["Lamp"].heliform.lamp.source = "ies"
    bpy.ops.heliform.trace_photons()
    before = photons(scene)
    first = results.staged(scene.heliform.shown).half_width.mean()
    scene.heliform.photon_tracing.landed = 100_000
    assert bpy.ops.heliform.refine_photons() == {"FINISHED"}
    assert photons(scene) > 2 * before
    assert results.staged(scene.heliform.shown).half_width.mean() < first
    assert len(list(tmp_path.iterdir())) == 2
    whole = results.staged(scene.heliform.shown).caustic
    bpy.ops.heliform.trace_photons()
    again = results.staged(scene.heliform.shown).caustic
    assert again.sum() == pytest.approx(whole.sum(), rel=0.05)


def test_what_has_changed_cannot_be_refined_and_stays_as_it_was(ball, scene):
    bpy.ops.heliform.trace_photons()
    before = values(scene.heliform.shown)
    bpy.data.objects["Lamp"].location.x += 0.01
    with pytest.raises(RuntimeError, match="has changed since it was traced; trace it anew"):
        bpy.ops.heliform.refine_photons()
    np.testing.assert_array_equal(values(scene.heliform.shown), before)


def test_a_cancelled_refine_leaves_the_earlier_result_alone(ball, scene, tmp_path):
    bpy.ops.heliform.trace_photons()
    (folder,) = tmp_path.iterdir()
    kept = {p.name: p.read_bytes() for p in folder.iterdir()}
    before = values(scene.heliform.shown)
    scene.heliform.photon_tracing.until = "time"
    scene.heliform.photon_tracing.seconds = 20.0
    presser = threading.Thread(target=interrupt_once_running, args=(time.monotonic() + 15,))
    presser.start()
    assert bpy.ops.heliform.refine_photons() == {"CANCELLED"}
    presser.join()
    assert {p.name: p.read_bytes() for p in folder.iterdir()} == kept
    assert list(tmp_path.iterdir()) == [folder]
    np.testing.assert_array_equal(values(scene.heliform.shown), before)
    scene.heliform.photon_tracing.until = "landed"
    scene.heliform.photon_tracing.landed = 40_000
    assert bpy.ops.heliform.refine_photons() == {"FINISHED"}


def test_without_sums_nothing_can_be_added(ball, scene, tmp_path):
    bpy.ops.heliform.trace_photons()
    (folder,) = tmp_path.iterdir()
    (folder / "sums.npz").unlink()
    assert not bpy.ops.heliform.refine_photons.poll()


def test_export_and_load_bring_a_mesh_back(vessel, ball, scene, tmp_path, seen):
    bpy.ops.heliform.export_study(directory=str(tmp_path))
    before = seen().receivers[0]
    (study,) = tmp_path.glob("*/study.toml")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert bpy.ops.heliform.load_study(filepath=str(study)) == {"FINISHED"}
    scene = bpy.context.scene
    after = read_scene(scene, bpy.context.evaluated_depsgraph_get()).receivers[0]
    assert (after.name, after.columns, after.rows) == ("Cylinder", 32, 32)
    assert (after.sides, after.reflectance) == ("both", 0.5)
    assert after.mesh.vertices == pytest.approx(before.mesh.vertices, abs=1e-6)
    np.testing.assert_array_equal(after.texture, before.texture)


def test_export_and_load_bring_the_scene_back(ball, scene, tmp_path):
    bpy.ops.heliform.export_study(directory=str(tmp_path))
    with pytest.raises(RuntimeError, match="is there already"):
        bpy.ops.heliform.export_study(directory=str(tmp_path))
    (study,) = tmp_path.glob("*/study.toml")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert bpy.ops.heliform.load_study(filepath=str(study)) == {"FINISHED"}
    roles = {obj.name: obj.heliform.role for obj in bpy.context.scene.objects}
    assert roles == {"Vase ä/1": "RECEIVER", "Lamp": "LAMP", "Icosphere": "BODY"}
    assert bpy.context.scene.heliform.photon_tracing.landed == 20_000


def interrupt_once_running(latest):
    """Press Ctrl-C while the job runs, and not at all if it never does."""
    while time.monotonic() < latest:
        if jobs.state.running and jobs.state.fraction > 0:
            signal.raise_signal(signal.SIGINT)
            return
        time.sleep(0.05)


def test_ctrl_c_in_a_script_cancels(ball, scene, tmp_path):
    scene.heliform.photon_tracing.until = "time"
    scene.heliform.photon_tracing.seconds = 20.0
    presser = threading.Thread(target=interrupt_once_running, args=(time.monotonic() + 15,))
    presser.start()
    assert bpy.ops.heliform.trace_photons() == {"CANCELLED"}
    presser.join()
    assert not list(tmp_path.iterdir())
