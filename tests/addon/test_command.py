"""The command line, as in the pip environment."""

import json
import os
import signal
import subprocess
import sys
import time

import bpy
import pytest
from heliform.addon.bridge import results
from heliform.addon.command import find_study, main
from heliform.engines.core import doctor

STUDY = """
heliform = 1
title = "Vase ä/1"
analysis = "light.trace"

[parameters]
until = "landed"
landed = 2000

[bodies."Vase ä/1"]
form = "glass.object"
shape = { height = 0.02, faces = 2000 }
at = [0.0, 0.0, 0.01]

[lamps.Lamp]
source = "disk"
flux = 100.0
opening = "round"
width = 0.02
at = [0.0, 0.0, 0.2]

[receivers.Floor]
resolution = 16
"""


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "Vase ä.toml"
    path.write_text(STUDY, encoding="utf-8")
    return path


def test_run_writes_everything_and_the_scene(study, tmp_path, capfd):
    out = tmp_path / "out"
    assert main(["run", str(study), "--out", str(out), "--seed", "3"]) == 0
    said = capfd.readouterr().out
    assert json.loads((out / "result.json").read_text(encoding="utf-8"))["seed"] == 3
    for name in ("result.json", "irradiance.exr", "report.html", "scene.blend"):
        assert name in said
        assert (out / name).stat().st_size > 0
    bpy.ops.wm.open_mainfile(filepath=str(out / "scene.blend"))
    scene = bpy.context.scene
    assert scene.name == "Vase ä/1"
    assert scene.heliform.seed == 3
    assert scene.heliform.photon_tracing.landed == 2000
    glass = bpy.data.objects["Vase ä/1"]
    assert glass.heliform.glass_object.faces == 2000
    assert scene.heliform.shown.name == "Floor false colour"


def test_a_study_with_cases_has_a_scene_each(study, tmp_path):
    out = tmp_path / "out"
    with study.open("a", encoding="utf-8") as file:
        file.write('\n[cases.bare]\nbodies."Vase ä/1".on = false\n[cases."with/glass"]\n')
    assert main(["run", str(study), "--out", str(out)]) == 0
    bpy.ops.wm.open_mainfile(filepath=str(out / "scene.blend"))
    assert {scene.name for scene in bpy.data.scenes} == {"bare", "with/glass"}
    assert all(scene.heliform.shown for scene in bpy.data.scenes)


def test_set_and_no_blend(study, tmp_path, capsys):
    out = tmp_path / "out"
    arguments = ["run", str(study), "--out", str(out), "--set", "receivers.Floor.resolution=4"]
    assert main([*arguments, "--no-blend"]) == 0
    assert "No scene.blend: not asked for." in capsys.readouterr().out
    assert not (out / "scene.blend").exists()


def test_refine_adds_photons_to_an_earlier_result(study, tmp_path, capsys):
    first, second = tmp_path / 'first "ä"', tmp_path / "second"
    run = ["run", str(study), "--set", "parameters.keep_sums=true"]
    assert main([*run, "--out", str(first), "--no-blend"]) == 0
    more = ["--refine", str(first), "--set", "parameters.landed=8000"]
    assert main([*run, "--out", str(second), *more]) == 0
    kept = [
        json.loads((out / "result.json").read_text(encoding="utf-8"))["figures"]["photons_emitted"]
        for out in (first, second)
    ]
    assert kept[1]["value"] > 2 * kept[0]["value"]
    assert (second / "scene.blend").is_file()


def test_a_study_of_several_receivers_is_staged_on_all_of_them(study, tmp_path):
    with study.open("a", encoding="utf-8") as file:
        file.write('[receivers.Wall]\nmesh = "wall.obj"\nresolution = 32\nsides = "both"\n')
        file.write("at = [0.3, 0.0, 0.0]\nturn = [0.0, -90.0, 0.0]\n")
    (tmp_path / "wall.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0.1\nf 1 2 3\n")
    out = tmp_path / "out"
    assert main(["run", str(study), "--out", str(out)]) == 0
    bpy.ops.wm.open_mainfile(filepath=str(out / "scene.blend"))
    scene = bpy.context.scene
    assert [results.name_of(p) for p in results.results_of(scene)] == [
        "Floor", "Wall (front)", "Wall (back)"
    ]  # fmt: skip
    assert bpy.data.objects["Wall"].heliform.plane.sides == "both"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--refine", "nowhere"], "There is no result"),
        (["--set", "parameters.photns=3"], "has no key “photns”"),
        (["--set", "parameters.landed=many"], "should be a whole number"),
    ],
)
def test_a_users_mistake_is_one_sentence(study, tmp_path, capsys, arguments, said):
    out = tmp_path / "out"
    assert main(["run", str(study), "--out", str(out), *arguments]) == 1
    error = capsys.readouterr().err
    assert said in error
    assert len(error.splitlines()) == 1
    assert not out.exists()


def test_an_unknown_study_names_those_there_are(tmp_path, capsys):
    assert main(["run", "nothing", "--out", str(tmp_path)]) == 1
    assert "demo" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments", [[], ["run"], ["run", "demo", "--out", "x", "--seed", "-1"], ["dance"]]
)
def test_wrong_usage_is_2(arguments, capsys):
    assert main(arguments) == 2


def test_list_names_the_studies_that_come_along(capsys):
    assert main(["list"]) == 0
    assert "demo" in capsys.readouterr().out
    assert find_study("demo").is_file()


def test_doctor_says_what_is_here(capsys):
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    for name in ("Python", "numpy", "mitsuba", "LLVM", "CUDA", "Blender", "Worker"):
        assert f"  {name} " in said


def test_the_doctor_names_what_a_missing_package_is_for(monkeypatch):
    monkeypatch.setitem(doctor.NEEDED_FOR, "no-such-package", "company")
    line = next(line for line in doctor.examine() if line.name == "no-such-package")
    assert not line.ok
    assert "without it there is no company" in line.text


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to another process there")
def test_ctrl_c_leaves_nothing_behind(study, tmp_path):
    out = tmp_path / "out"
    program = "import sys; from heliform.addon.command import main; sys.exit(main())"
    endless = ["--set", 'parameters.until="time"', "--set", "parameters.seconds=600.0"]
    with subprocess.Popen(
        [sys.executable, "-c", program, "run", str(study), "--out", str(out), *endless],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    ) as process:
        process.stdout.readline()
        time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        assert process.wait(20) == 130
        assert b"cancelled" in process.stderr.read()
    assert [path.name for path in tmp_path.iterdir()] == [study.name]
