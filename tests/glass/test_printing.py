"""Printing a wall as an analysis: result, files, pictures, and what is noted."""

import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from heliform.engines.core.colour import Display
from heliform.engines.core.errors import Cancelled, FileError, ParameterError
from heliform.engines.core.scene import Scene
from heliform.engines.glass.bead import Bead
from heliform.engines.glass.fourier import Plan
from heliform.engines.glass.gcode import read_gcode
from heliform.engines.glass.loft import Wall
from heliform.engines.glass.machine import load_machine
from heliform.engines.glass.presets import PRESETS
from heliform.engines.glass.printing import Print, Printed, gcode_notes, print_wall
from heliform.engines.glass.toolpath import Spiral
from heliform.engines.glass.unrolled import draw, marked, plan, unroll
from PIL import Image

SMALL = Wall(height=0.03, faces=6_000)
TIGHT = Wall(plan=Plan(radius=0.09, period_1=9, amplitude_1=0.12), height=0.03, faces=6_000)


def printed(**changes):
    return print_wall(Scene(), Print(**({"wall": SMALL} | changes)))


@pytest.mark.parametrize("name", PRESETS)
def test_the_shipped_walls_can_be_printed(name):
    wall = PRESETS[name]
    result = printed(wall=wall)
    assert result.verdict.passed, [one.sentence for one in result.verdict.failed]
    height = result.path.points[-1, 2]
    assert height == pytest.approx(wall.height)


def test_a_result_is_saved_and_loads_back_equal(tmp_path):
    result = printed(wall=TIGHT)
    files = result.save(tmp_path)
    assert sorted(files) == sorted(file.name for file in tmp_path.iterdir())
    back = Printed.load(tmp_path)
    for name in ("points", "turn", "arc", "rotary", "width", "height", "speed", "time", "flow"):
        assert np.array_equal(getattr(back.path, name), getattr(result.path, name))
    assert back.path.layer_height == result.path.layer_height
    assert back.verdict.as_table() == result.verdict.as_table()
    assert np.array_equal(back.verdict.utilisation(), result.verdict.utilisation())
    assert back.meta == json.loads(json.dumps(result.meta))
    assert back.figures() == result.figures()
    motion = read_gcode((tmp_path / "wall.gcode").read_text())
    assert np.abs(motion.points(load_machine()) - result.path.points).max() < 1e-6
    solid = trimesh.load_mesh(tmp_path / "wall.3mf")
    assert solid.is_watertight
    assert np.ptp(solid.vertices[:, 2]) == pytest.approx(30.0)


def test_a_wall_that_does_not_pass_says_so_everywhere(tmp_path):
    result = printed(wall=TIGHT)
    failed = result.verdict.failed
    assert failed
    assert result.meta["notes"][: len(failed)] == [one.sentence for one in failed]
    assert result.figures()["passed"]["value"] == 0
    result.save(tmp_path)
    head = (tmp_path / "wall.gcode").read_text().splitlines()[:10]
    assert any("DOES NOT PASS" in line for line in head)
    told = json.loads((tmp_path / "gate.json").read_text())
    assert told["passed"] is False
    assert told["seed"] == 0
    assert told["parameters"]["wall"]["height"] == 0.03


def test_what_a_reader_should_know_is_noted():
    wall = replace(SMALL, bead=Bead(height=4.3e-3))
    notes = printed(wall=wall).meta["notes"]
    assert any("Unconfirmed limits of Glass printer" in note for note in notes)
    assert any("melt runs on" in note for note in notes)
    apart = next(note for note in notes if "4.286 mm high and not 4.3 mm" in note)
    assert "make the wall 30.1 mm high" in apart
    mended = printed(wall=replace(wall, height=30.1e-3)).meta["notes"]
    assert not any("layers" in note for note in mended)


def test_the_layers_are_the_walls():
    result = printed(spiral=Spiral(layer_height=3e-3))
    assert result.path.layer_height == pytest.approx(5e-3)
    assert result.meta["parameters"]["spiral"]["layer_height"] == 5e-3
    assert result.path.inputs == printed().path.inputs


def test_the_gate_of_a_print_looks_at_its_purge():
    wall = replace(SMALL, plan=Plan(radius=0.15))
    assert "reach" not in {
        one.name for one in printed(wall=wall, spiral=Spiral(purge=0.0)).verdict.failed
    }
    assert "reach" in {one.name for one in printed(wall=wall).verdict.failed}


def test_gcode_says_what_the_outline_lost_and_what_does_not_pass(tmp_path):
    wall = replace(TIGHT, plan=Plan(radius=0.05, period_1=9, amplitude_1=0.25))
    result = printed(wall=wall)
    assert result.loft_notes
    assert result.verdict.failed
    notes = gcode_notes(result.loft_notes, result.verdict)
    assert notes[: len(result.loft_notes)] == list(result.loft_notes)
    assert notes[-1] == f"DOES NOT PASS: {result.verdict.failed[-1].sentence}"
    result.save(tmp_path)
    head = (tmp_path / "wall.gcode").read_text().splitlines()[3 : 3 + len(notes)]
    for note, line in zip(notes, head, strict=True):
        assert line.startswith(f"; {note[:20]}")


@pytest.mark.parametrize("thickness", [3e-3, 3.5e-3, 4e-3])
def test_a_wall_thinner_than_its_ramps_has_pictures(thickness, tmp_path):
    result = printed(wall=replace(SMALL, thickness=thickness))
    assert "plan.png" in draw(result, tmp_path, Display())


def test_pictures_are_drawn_with_a_mark(tmp_path):
    result = printed(wall=TIGHT)
    files = draw(result, tmp_path, Display())
    assert files[:2] == ["gate.png", "plan.png"]
    assert "gate curvature.png" in files
    for file in files:
        with Image.open(tmp_path / file) as image:
            assert min(image.size) > 100


def test_the_unrolled_picture_has_each_place_where_it_is():
    path = printed().path
    around = unroll(path, path.turn % 1)
    assert around[3, :950] == pytest.approx((np.arange(950) + 0.5) / 960, abs=0.01)
    upward = unroll(path, np.floor(path.turn))
    assert (np.diff(upward[:, 480]) >= 0).all()
    assert upward[0, 480] == 0
    assert upward[-1, 480] == 6


def test_the_plan_shows_the_wall_at_its_width():
    path = printed().path
    picture, corner, pixel = plan(path, np.ones(len(path.turn)))
    rows, columns = np.nonzero(np.isfinite(picture))
    away = np.hypot(*(corner[:, None] + (np.stack([columns, rows]) + 0.5) * pixel))
    assert away.min() == pytest.approx(0.095, abs=2 * pixel)  # a ramp's bead is 10 mm wide
    assert away.max() == pytest.approx(0.105, abs=2 * pixel)
    assert np.isnan(marked(picture, 400, 400)[400, 386])


def test_another_machine_is_a_name_or_a_file(tmp_path):
    small = Wall(
        plan=Plan(radius=0.02),
        height=0.01,
        thickness=1e-3,
        faces=40_000,
        bead=Bead(style="flat", height=5e-4),
    )
    result = printed(wall=small, spiral=Spiral(step=1e-3), machine="desktop-printer")
    assert result.verdict.machine == "Desktop printer"
    with pytest.raises(FileError, match="no machine profile"):
        printed(machine=str(tmp_path / "none.toml"))


def test_bad_values_and_cancelling_end_it():
    with pytest.raises(ParameterError, match="out of bounds"):
        printed(spiral=Spiral(step=1.0))

    def stop(fraction, text):
        raise Cancelled

    with pytest.raises(Cancelled):
        print_wall(Scene(), Print(wall=SMALL), seed=0, progress=stop)


def test_a_folder_without_a_result_is_told(tmp_path):
    with pytest.raises(FileError, match="holds no printed wall"):
        Printed.load(tmp_path)
    printed().save(tmp_path)
    table = (tmp_path / "gate.json").read_text()
    whole = (tmp_path / "toolpath.npz").read_bytes()
    for content in (b"no archive", b"", b"PK\x03\x04 cut", whole[:-200]):
        (tmp_path / "toolpath.npz").write_bytes(content)
        with pytest.raises(FileError, match="holds no printed wall"):
            Printed.load(tmp_path)
    (tmp_path / "toolpath.npz").write_bytes(whole)
    for content in ("{}", table[:100]):
        (tmp_path / "gate.json").write_text(content)
        with pytest.raises(FileError, match="holds no printed wall"):
            Printed.load(tmp_path)
