"""The print of a wall in Blender: gate, path and files, kept up to date with the wall."""

import json

import bpy
import numpy as np
import pytest
import trimesh
from heliform.addon import printing
from heliform.addon.bridge import layers
from heliform.addon.bridge.paths import path_of
from heliform.addon.bridge.studies import stage_study
from heliform.engines.core.colour import ColourScale
from heliform.engines.core.run import run_study
from heliform.engines.core.study import load_study
from heliform.engines.glass.gcode import read_gcode
from heliform.engines.glass.machine import DATA, FILE, load_machine


@pytest.fixture
def wall(scene):
    bpy.ops.heliform.add_wall(preset="rosette")
    obj = bpy.context.object
    obj.name = "Wand ä/1"
    obj.heliform.wall.faces, obj.heliform.wall.height = 20_000, 0.1
    return obj


def positions(curve):
    found = np.empty(3 * len(curve.data.points), dtype=np.float32)
    curve.data.position_data.foreach_get("vector", found)
    return found.reshape(-1, 3)


def test_a_printable_wall_passes_and_is_coloured(wall):
    assert bpy.ops.heliform.check_print() == {"FINISHED"}
    assert printing.verdict_of(wall)["passed"]
    layer = layers.layer_of(wall)
    assert layer.footing == ["Glass printer", "passed"]
    values = np.empty(len(wall.data.vertices), dtype=np.float32)
    wall.data.attributes[layers.VALUES].data.foreach_get("value", values)
    assert np.isfinite(values).all()
    assert values.max() <= 1 + 1e-6


def test_the_gate_follows_the_sliders_and_says_what_is_wrong(wall):
    wall.heliform.gate = True
    wall.heliform.wall.height = 0.6
    verdict = printing.verdict_of(wall)
    failed = {check["name"]: check for check in verdict["checks"] if not check["passed"]}
    assert failed["reach"]["sentence"].endswith("make the piece lower.")
    assert "not printable" in layers.layer_of(wall).footing


def test_one_check_is_shown_alone_and_all_again(wall):
    wall.heliform.gate = True
    bpy.ops.heliform.show_check(name="curvature")
    assert layers.layer_of(wall).quantity == "Turning radius"
    bpy.ops.heliform.show_check(name="curvature")
    assert layers.layer_of(wall).quantity == "Print limits"


def test_the_worst_place_of_a_wall_is_marked_on_it(wall):
    wall.heliform.gate = True
    wall.heliform.gate_check = "curvature"
    (mark,) = layers.layer_of(wall).marks
    away = np.linalg.norm(np.array([v.co for v in wall.data.vertices]) - mark.place, axis=1)
    assert away.min() < 0.006


def test_each_vertex_has_the_value_of_the_bead_that_it_is_in(wall):
    wall.heliform.gate = True
    shown = printing.print_of(wall, bpy.context)
    rng = np.random.default_rng(1)
    at = rng.integers(0, len(shown.path.turn), 500)
    solid = shown.path.height[at] > 1e-4
    at = at[solid]
    inside = shown.path.points[at, 2] - rng.uniform(0.1, 0.9, len(at)) * shown.path.height[at]
    found = printing.turn_at(shown.path, shown.path.turn[at] % 1, inside)
    np.testing.assert_allclose(found, shown.path.turn[at], atol=1e-6)


def test_the_path_is_a_curve_with_data_that_follows_the_wall(wall):
    wall.heliform.path = True
    curve = path_of(wall)
    shown = printing.print_of(wall, bpy.context).path
    np.testing.assert_allclose(positions(curve), shown.points, atol=1e-6)
    speed = np.empty(len(shown.points), dtype=np.float32)
    curve.data.attributes["speed"].data.foreach_get("value", speed)
    np.testing.assert_allclose(speed, shown.speed, rtol=1e-6)
    wall.heliform.wall.height = 0.05
    assert path_of(wall) == curve
    assert positions(curve)[:, 2].max() == pytest.approx(0.05, abs=1e-6)
    wall.heliform.path = False
    assert path_of(wall) is None


def test_another_machine_says_something_else(wall, scene):
    wall.heliform.gate = True
    scene.heliform.machine = "desktop-printer"
    assert printing.verdict_of(wall)["machine"] != "Glass printer"


def test_a_profile_of_ones_own_is_used_and_its_faults_are_said(wall, scene, tmp_path):
    wall.heliform.gate = True
    file = tmp_path / "Drucker ä.toml"
    assert bpy.ops.heliform.edit_machine(filepath=str(file)) == {"FINISHED"}
    assert scene.heliform.machine == FILE
    assert printing.verdict_of(wall)["passed"]
    text = (DATA / "glass-printer.toml").read_text(encoding="utf-8")
    file.write_text(text.replace("[figures.charge]", "[figures.carge]"), encoding="utf-8")
    scene.heliform.machine_file = str(file)
    assert "did you mean “charge”" in wall.heliform.problem
    assert printing.verdict_of(wall) is None


def test_the_gcode_is_the_path(wall, tmp_path):
    file = tmp_path / "Wand ä.gcode"
    assert bpy.ops.heliform.export_gcode(filepath=str(file)) == {"FINISHED"}
    shown = printing.print_of(wall, bpy.context).path
    read = read_gcode(file.read_text(encoding="utf-8"))
    np.testing.assert_allclose(read.points(load_machine()), shown.points, atol=1e-6)
    assert json.loads(file.with_suffix(".gate.json").read_text(encoding="utf-8"))["passed"]
    assert bpy.ops.heliform.export_gcode(filepath=str(tmp_path / "w.csv")) == {"FINISHED"}
    rows = (tmp_path / "w.csv").read_text(encoding="utf-8").splitlines()
    head, *rows = [row for row in rows if not row.startswith("#")]
    assert head.startswith("Turn,X (m)")
    assert len(rows) == len(shown.points)


@pytest.mark.parametrize("ending", ["stl", "3mf", "obj"])
def test_the_solid_is_written_in_millimetres_with_its_relief(wall, scene, tmp_path, ending):
    scene.unit_settings.scale_length = 1.0
    file = tmp_path / f"Wand ä.{ending}"
    assert bpy.ops.heliform.export_solid(filepath=str(file)) == {"FINISHED"}
    solid = trimesh.load(file, force="mesh")
    assert solid.is_watertight
    assert solid.extents[2] == pytest.approx(100.0, abs=1e-3)


def test_clearing_shows_materials_again(wall):
    wall.heliform.gate = True
    assert bpy.ops.heliform.clear_layer() == {"FINISHED"}
    assert layers.layer_of(wall) is None
    assert not wall.heliform.gate
    with pytest.raises(RuntimeError, match="None of the selected objects has a layer"):
        bpy.ops.heliform.clear_layer()


def test_it_survives_saving(wall, tmp_path):
    wall.heliform.gate = wall.heliform.path = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "w.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "w.blend"))
    found = bpy.data.objects["Wand ä/1"]
    assert printing.verdict_of(found)["passed"]
    assert path_of(found) is not None
    assert layers.layer_of(found).marks


def test_a_coupon_for_the_flow_is_written(scene, tmp_path):
    assert bpy.ops.heliform.export_coupon(directory=str(tmp_path)) == {"FINISHED"}
    assert {file.name for file in tmp_path.iterdir()} == {"coupon.gcode", "coupon.csv"}


def test_a_study_of_a_print_becomes_a_wall_with_gate_and_path(scene, tmp_path):
    study = tmp_path / "Wand ä.toml"
    study.write_text(
        'heliform = 1\nanalysis = "glass.print"\n'
        "[parameters.wall]\nheight = 0.05\nfaces = 5000\n"
        "[parameters.wall.plan]\nradius = 0.08\n",
        encoding="utf-8",
    )
    out = tmp_path / "out"
    files = run_study(study, out)
    assert {"wall.gcode", "gate.json", "wall.3mf", "gate.png", "result.json"} <= set(files)
    assert stage_study(study, out, out / "scene.blend")
    bpy.ops.wm.open_mainfile(filepath=str(out / "scene.blend"))
    wall = bpy.data.objects["Wall"]
    assert wall.heliform.wall.plan.radius == pytest.approx(0.08)
    assert path_of(wall) is not None
    assert printing.verdict_of(wall)


def test_in_a_scene_of_millimetres_gate_path_and_files_are_the_same(scene, tmp_path):
    scene.unit_settings.scale_length = 0.001
    bpy.ops.heliform.add_wall(preset="rosette")
    obj = bpy.context.object
    obj.heliform.wall.faces, obj.heliform.wall.height = 20_000, 100.0
    obj.heliform.gate = obj.heliform.path = True
    assert not obj.heliform.problem
    assert printing.verdict_of(obj)["passed"]
    shown = printing.print_of(obj, bpy.context).path
    np.testing.assert_allclose(positions(path_of(obj)) * 1e-3, shown.points, atol=1e-6)
    assert shown.points[:, 2].max() == pytest.approx(0.1)
    scene.heliform.spiral.step = 4.0
    assert len(printing.print_of(obj, bpy.context).path.points) < len(shown.points)


def test_panels_show_lengths_in_the_files_own_units(scene, tmp_path):
    scene.unit_settings.scale_length = 0.001
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "mm.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "mm.blend"))
    settings = bpy.context.scene.heliform
    assert settings.spiral.step == pytest.approx(2.0)
    assert settings.scan_reading.longest == pytest.approx(20.0)
    assert settings.comparison.tolerance == pytest.approx(1.0)


def test_a_preset_renews_gate_and_path(wall):
    wall.heliform.gate = wall.heliform.path = True
    before = printing.verdict_of(wall)["inputs"]
    bpy.ops.heliform.reshape_wall(preset="sharpened")
    assert printing.verdict_of(wall)["inputs"] != before
    assert positions(path_of(wall))[:, 2].max() == pytest.approx(0.2, abs=1e-6)


def test_a_scaled_wall_is_not_printed(wall):
    wall.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="“Wand ä/1” is scaled, which its print would not be"):
        bpy.ops.heliform.check_print()


def test_a_problem_of_the_print_goes_with_its_cause(wall, scene):
    scene.heliform.machine_file = "//none.toml"
    scene.heliform.machine = FILE
    wall.heliform.gate = True
    assert "no machine profile" in wall.heliform.problem
    scene.heliform.machine = "glass-printer"
    assert not wall.heliform.problem


def test_the_path_leaves_another_layer_alone(wall):
    wall.heliform.gate = True
    wall.heliform.gate = False
    scale = ColourScale(0.0, 1.0, False, "viridis", "Deviation", "mm")
    layers.paint(wall, np.zeros(len(wall.data.vertices)), layers.Layer("Deviation", scale))
    wall.heliform.path = True
    assert layers.layer_of(wall).quantity == "Deviation"


def test_a_print_is_exported_as_a_study_that_says_the_same(wall, tmp_path):
    where = {"directory": str(tmp_path), "analysis": "glass.print"}
    assert bpy.ops.heliform.export_study(**where) == {"FINISHED"}
    (folder,) = tmp_path.iterdir()
    (case,) = load_study(folder / "study.toml").cases
    result = case.analysis.run(case.scene, case.parameters, seed=0, progress=lambda *_: None)
    shown = printing.print_of(wall, bpy.context)
    assert result.verdict.inputs == shown.verdict.inputs
    np.testing.assert_allclose(result.path.points, shown.path.points, atol=1e-9)
