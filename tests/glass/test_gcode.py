"""G-code: read back by our own reader and by another's, the path to 1 µm and the volume to 1 %."""

import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from gcodeparser import parse_gcode_lines
from glass.paths import LOFTS, THICKNESS, circle, lobed, machine, path_on, roomy, table
from heliform.engines.core.errors import FileError
from heliform.engines.core.table import load_csv
from heliform.engines.glass.bead import Bead
from heliform.engines.glass.gcode import (
    BEGIN,
    END,
    gcode,
    read_gcode,
    write_gcode,
    write_path,
)
from heliform.engines.glass.loft import Wall, wall_loft
from heliform.engines.glass.machine import load_machine, machine_of
from heliform.engines.glass.printed import wall_mesh
from heliform.engines.glass.toolpath import Spiral, spiral

MICROMETRE = 1e-6
PRINTERS = {
    "glass": load_machine(),
    "extruding glass": machine(extrusion="volumetric"),
    "three axes": machine(axes="three", feed="mm/min", comment="()"),
    "desktop": machine("desktop-printer"),
}


def other_reading(text, printer):
    """The marked path on the piece in m, and what E sums to along it, by gcodeparser."""
    now = {"X": 0.0, "Y": 0.0, "Z": 0.0, "C": 0.0}
    rows, extruded, inside = [], 0.0, False
    for line in parse_gcode_lines(text, include_comments=True):
        if line.command == (";", None):
            if line.comment == BEGIN:
                rows, inside = rows[-1:], True
            elif line.comment == END:
                break
        elif line.command in (("G", 0), ("G", 1)):
            now |= {a: float(v) for a, v in line.params.items() if a in now}
            rows.append(list(now.values()))
            extruded += float(line.params.get("E", 0.0)) * inside
    x, y, z, c = np.array(rows).T
    plane = (x - 1e3 * printer.value("origin_x")) + 1j * (y - 1e3 * printer.value("origin_y"))
    plane *= np.exp(-1j * np.radians(c))
    return np.column_stack([plane.real, plane.imag, z]) * 1e-3, extruded


@pytest.mark.parametrize("name", LOFTS)
@pytest.mark.parametrize("printer", PRINTERS)
def test_reading_back_gives_the_path(name, printer):
    path = path_on(LOFTS[name], PRINTERS[printer])
    text = gcode(path, PRINTERS[printer], 0.03, name)
    motion = read_gcode(text)
    points = motion.points(PRINTERS[printer])
    assert points.shape == path.points.shape
    assert np.abs(points - path.points).max() < MICROMETRE / 5
    seconds = motion.seconds[motion.path[0] + 1 : motion.path[1] + 1]
    if PRINTERS[printer].dialect.feed == "inverse-time" or PRINTERS[printer].axes == "three":
        assert seconds == pytest.approx(np.diff(path.time), rel=1e-3, abs=1e-4)
    if PRINTERS[printer].axes == "four":
        angle = np.radians(motion.axes[motion.path[0] : motion.path[1] + 1, 3])
        assert -angle == pytest.approx(path.rotary, abs=1e-6)


@pytest.mark.parametrize("name", LOFTS)
@pytest.mark.parametrize("printer", ["glass", "extruding glass", "desktop"])
def test_another_parser_reads_the_same_path(name, printer):
    path = path_on(LOFTS[name], PRINTERS[printer])
    points, _ = other_reading(gcode(path, PRINTERS[printer], 0.03, name), PRINTERS[printer])
    assert points.shape == path.points.shape
    assert np.abs(points - path.points).max() < MICROMETRE


def test_what_is_extruded_is_the_wall_and_the_solid():
    """By another's parser, against a mesh's volume by another's sum."""
    wall = Wall(height=0.05, faces=60_000, bead=Bead(style="flat"), thickness=THICKNESS)
    loft = wall_loft(wall)
    mesh = wall_mesh(wall)
    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles().faces).volume
    printer = roomy(width_max=20.0)
    path = spiral(loft, THICKNESS, Spiral(), printer)
    text = gcode(path, printer)
    _, extruded = other_reading(text, printer)
    assert extruded * 1e-9 == pytest.approx(solid, rel=1e-2)
    assert extruded * 1e-9 == pytest.approx(THICKNESS * 0.05 * loft.length(0.0), rel=1e-4)
    assert read_gcode(text).volume(printer) == pytest.approx(extruded * 1e-9, rel=1e-9)


def test_filament_holds_the_volume():
    printer = machine("desktop-printer")
    path = spiral(circle(0.02, 0.02), 0.8e-3, Spiral(layer_height=4e-4, step=1e-3), printer)
    _, filament = other_reading(gcode(path, printer), printer)
    volume = filament * np.pi / 4 * 1.75**2 * 1e-9
    assert volume == pytest.approx(0.8e-3 * 0.02 * 2 * np.pi * 0.02, rel=1e-3)
    assert read_gcode(gcode(path, printer)).volume(printer) == pytest.approx(volume, rel=1e-9)


@pytest.mark.parametrize("printer", PRINTERS)
def test_the_path_is_one_run_of_straight_moves_that_never_goes_down_or_back(printer):
    path = path_on(lobed(waves=5, wave=0.15), PRINTERS[printer])
    lines = gcode(path, PRINTERS[printer], 0.03, "x").splitlines()
    begin = next(i for i, line in enumerate(lines) if BEGIN in line)
    end = next(i for i, line in enumerate(lines) if END in line)
    inside = lines[begin + 1 : end]
    assert len(inside) == len(path.turn) - 1
    assert all(line.startswith("G1 X") for line in inside)
    z = [float(re.search(r"Z(\S+)", line)[1]) for line in inside]
    assert (np.diff(z) >= 0).all()
    given = [re.search(r"E(\S+)", line) for line in inside]
    if PRINTERS[printer].extrusion == "none":
        assert not any(given)
    else:
        assert all(float(e[1]) >= 0 for e in given)
        assert "M83" in lines[:begin]


def test_units_and_mode_are_said_before_anything_moves():
    lines = gcode(path_on(circle()), load_machine()).splitlines()
    code = [line for line in lines if not line.startswith(";")]
    assert code[:3] == ["G21", "G90", "G94"]
    assert lines[0].startswith("; Heliform")


def test_a_bed_that_turns_is_told_how_long_each_move_takes():
    """On a tube its linear axes hardly move: a feed in mm/min would mean nothing."""
    path = path_on(circle(), load_machine())
    text = gcode(path, load_machine())
    marked = text.index(BEGIN)
    assert text.index("G93") < marked < text.index(END) < text.rindex("G94")
    motion = read_gcode(text)
    axes = motion.axes[motion.path[0] : motion.path[1] + 1]
    assert np.ptp(axes[:, 0]) < 0.01
    assert np.ptp(axes[:, 1]) < 0.01
    assert motion.seconds[motion.path[0] + 1 : motion.path[1] + 1].sum() == pytest.approx(
        path.seconds, rel=1e-5
    )


@pytest.mark.parametrize("slower", [1e-6, 1.0, 1e7])
def test_no_number_has_an_exponent(slower):
    path = path_on(circle(), roomy())
    path = replace(path, time=path.time * slower)
    text = gcode(path, roomy())
    assert not re.search(r"\de[-+]\d", text)
    motion = read_gcode(text)
    seconds = motion.seconds[motion.path[0] + 1 : motion.path[1] + 1]
    assert seconds == pytest.approx(np.diff(path.time), rel=1e-6)


def test_the_purge_lies_outside_the_start():
    path = path_on(lobed(), machine("desktop-printer"))
    motion = read_gcode(gcode(path, machine("desktop-printer"), 0.03))
    out = motion.axes[: motion.path[0]]
    away = out[np.abs(out[:, 0] - 1e3 * path.points[0, 0] - 110 - 30).argmin()]
    assert away[:2] == pytest.approx([1e3 * path.points[0, 0] + 110 + 30, 110], abs=0.5)
    without = gcode(path, machine("desktop-printer"))
    assert "E10 F120" not in without
    assert "E10 F120" in gcode(path, machine("desktop-printer"), 0.03)


@pytest.mark.parametrize("style", [";", "()"])
def test_names_and_notes_cannot_break_out_of_their_comment(style):
    printer = machine(comment=style, start=["M117 {name}"])
    name = "Väse (1); G28\nG0 X999"
    text = gcode(path_on(circle(), printer), printer, 0.0, name, ["so (so)\nG0 X999"])
    assert text.isascii()
    motion = read_gcode(text)
    assert motion.axes[:, 0].max() < 900
    assert "\nM117 Vse 1 G28G0 X999\n" in text


def test_the_reader_takes_what_others_write_and_says_what_it_does_not():
    text = f"""
        g21 (millimetres)
        N10 G90
        G0 X1Y2 Z+.5
        ; {BEGIN}
        G1 X3 F120 ; on
        G1 Y-4.
        ; {END}
    """
    motion = read_gcode(text.replace("N10 ", ""))
    assert motion.path == (0, 2)
    assert motion.axes.tolist() == [[1, 2, 0.5, 0], [3, 2, 0.5, 0], [3, -4, 0.5, 0]]
    assert motion.seconds[1:] == pytest.approx([1.0, 3.0])


MARKED = f"G1 X1\n; {BEGIN}\nG1 X2\n; {END}\n"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (MARKED + "G2 X1 Y1 I1", "Line 5 asks for G2"),
        ("G20\n" + MARKED, "Line 1 asks for G20"),
        ("G91\n" + MARKED, "Line 1 asks for G91"),
        (MARKED + "G1 X1..2", "Line 5"),
        (MARKED + "G1 Xabc", "is no G-code"),
        (MARKED + "%PDF-1.7", "is no G-code"),
        (MARKED + "G1 A3", "Line 5 moves A"),
        ("G1 X1\nG1 X2\n", "marks no path"),
        (f"; {END}\nG1 X1\n; {BEGIN}\n", "marks no path"),
        ("", "marks no path"),
    ],
)
def test_what_cannot_be_read_is_told_by_its_line(text, said):
    with pytest.raises(FileError, match=said):
        read_gcode(text)


def test_files_are_whole_or_not_there(tmp_path):
    path = path_on(circle())
    write_gcode(tmp_path / "ä wall.gcode", path, load_machine())
    text = (tmp_path / "ä wall.gcode").read_text(encoding="utf-8")
    assert text == gcode(path, load_machine())
    with pytest.raises(FileError, match="Cannot write"):
        write_gcode(tmp_path / "none" / "wall.gcode", path, load_machine())
    assert [file.name for file in tmp_path.iterdir()] == ["ä wall.gcode"]


def test_the_table_has_a_row_a_point_with_units(tmp_path):
    path = path_on(LOFTS["lobed"])
    write_path(tmp_path / "path.csv", path)
    columns, meta = load_csv(tmp_path / "path.csv")
    assert meta["inputs"] == path.inputs
    assert list(columns)[:4] == ["Turn", "X (m)", "Y (m)", "Z (m)"]
    assert columns["X (m)"] == pytest.approx(path.points[:, 0], abs=1e-7)
    assert columns["Flow (m³/s)"] == pytest.approx(path.flow, rel=1e-6)
    assert all(re.search(r"\((m|m/s|m³/s|s|rad)\)$", name) for name in list(columns)[1:])


def test_start_lines_know_where_the_path_starts():
    given = table()
    given["gcode"]["start"] = ["({x} {y} {z} {c} {clearance} {turns} {minutes} {grams} {inputs})"]
    printer = machine_of(given, "test")
    path = path_on(circle(), printer)
    said = next(line for line in gcode(path, printer).splitlines() if line.startswith("(0.0"))
    values = said.strip("()").split()
    assert [float(v) for v in values[:6]] == pytest.approx([0, -100, 5, -90, 60, 11], abs=1e-3)
    assert float(values[6]) == pytest.approx(path.seconds / 60, abs=0.5)
    assert float(values[7]) == pytest.approx(path.laid().sum() * 2.5e6, abs=0.5)
    assert values[8] == path.inputs
