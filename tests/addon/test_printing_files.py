"""Files of a print from the window: their names, what is refused, and paths whose wall is gone."""

import json

import bpy
import pytest
from heliform.addon.bridge import print_layers
from heliform.addon.bridge.paths import path_of
from heliform.engines.core.errors import FileError
from heliform.engines.glass.machine import FILE
from heliform.engines.glass.relief import Relief
from heliform.operators import named_file
from heliform.operators.relief import relief_of

WRITERS = ("export_gcode", "export_solid", "edit_machine", "save_relief")


@pytest.fixture
def wall(scene):
    return add()


def add(preset="rosette"):
    bpy.ops.heliform.add_wall(preset=preset)
    obj = bpy.context.object
    obj.heliform.wall.faces, obj.heliform.wall.height = 10_000, 0.05
    return obj


def names(folder):
    return {file.name for file in folder.iterdir()}


@pytest.mark.parametrize(
    ("typed", "there"),
    [
        ("vase 2.5mm", "vase 2.5mm.npz"),
        ("vase", "vase.npz"),
        ("vase.NPZ", "vase.NPZ"),
        ("vase.v2.txt", "vase.v2.txt"),
        ("ä.", "ä..npz"),
    ],
)
def test_an_ending_is_put_to_a_name_unless_it_is_there(tmp_path, typed, there):
    assert named_file(str(tmp_path / typed), ".npz", (".txt",)) == tmp_path / there


@pytest.mark.parametrize("operator", WRITERS)
def test_no_name_and_a_folder_are_said(wall, tmp_path, operator):
    write = getattr(bpy.ops.heliform, operator)
    (tmp_path / "Ordner").mkdir()
    for typed in ("", f"{tmp_path}/"):
        with pytest.raises(RuntimeError, match="has no name; give it one"):
            write(filepath=typed)
    with pytest.raises(RuntimeError, match="is a folder; give the file a name"):
        write(filepath=str(tmp_path / "Ordner"))
    assert names(tmp_path) == {"Ordner"}


@pytest.mark.parametrize("operator", ["export_study", "export_coupon"])
def test_no_folder_is_said(wall, operator):
    with pytest.raises(RuntimeError, match="no folder to write into"):
        getattr(bpy.ops.heliform, operator)(directory="")


def test_an_ending_alone_is_no_name(tmp_path):
    with pytest.raises(FileError, match="no name"):
        named_file(str(tmp_path / ".npz"), ".npz")


@pytest.mark.parametrize("operator", WRITERS)
def test_blender_is_asked_to_warn_of_what_is_there(operator):
    kind = getattr(bpy.ops.heliform, operator).get_rna_type().properties["check_existing"]
    assert kind.default
    assert kind.is_hidden


def test_points_in_a_name_are_no_ending(wall, tmp_path):
    for operator in WRITERS:
        getattr(bpy.ops.heliform, operator)(filepath=str(tmp_path / "vase 2.5mm"))
    endings = (".3mf", ".gate.json", ".gcode", ".npz", ".toml")
    assert names(tmp_path) == {f"vase 2.5mm{ending}" for ending in endings}


def test_gcode_says_what_does_not_pass(wall, tmp_path):
    wall.heliform.wall.height = 0.6
    bpy.ops.heliform.export_gcode(filepath=str(tmp_path / "w.gcode"))
    verdict = json.loads((tmp_path / "w.gate.json").read_text(encoding="utf-8"))
    failed = [c["sentence"] for c in verdict["checks"] if not c["passed"]]
    lines = (tmp_path / "w.gcode").read_text(encoding="utf-8").splitlines()
    assert failed
    assert sum("DOES NOT PASS: " in line for line in lines) == len(failed)


def test_a_profile_of_ones_own_is_not_replaced(wall, scene, tmp_path):
    bpy.ops.heliform.edit_machine(filepath=str(tmp_path / "p.toml"))
    assert scene.heliform.machine == FILE
    (tmp_path / "p.toml").write_text("mine", encoding="utf-8")
    with pytest.raises(RuntimeError, match="there already"):
        bpy.ops.heliform.edit_machine(filepath=str(tmp_path / "p.toml"))
    with pytest.raises(RuntimeError, match="make the folder first"):
        bpy.ops.heliform.edit_machine(filepath=str(tmp_path / "none" / "p.toml"))
    assert (tmp_path / "p.toml").read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("by", ["script", "person"])
def test_the_path_of_a_wall_that_was_deleted_goes(wall, by):
    wall.heliform.path = True
    if by == "script":
        bpy.data.objects.remove(wall)
    else:
        bpy.ops.object.delete()
    other = add("tube")
    other.heliform.path = True
    assert [o for o in bpy.data.objects if o.type == "CURVES"] == [path_of(other)]


def test_a_path_that_was_converted_is_the_users(wall):
    wall.heliform.path = True
    curve = path_of(wall)
    mesh = bpy.data.objects.new("Mine", bpy.data.meshes.new("Mine"))
    mesh["heliform_path_of"] = wall
    mesh.parent = wall
    bpy.data.objects.remove(curve)
    wall.heliform.path = True
    assert mesh.type == "MESH"
    assert path_of(wall).type == "CURVES"


def test_the_relief_of_a_wall_is_that_of_its_beads(wall):
    relief, _ = print_layers.read_modifier(relief_of(wall))
    bead = wall.heliform.wall.bead
    assert (relief.height, relief.amplitude) == pytest.approx((bead.height, bead.sag))
    assert not relief.spiral
    wall.modifiers.clear()
    bpy.ops.heliform.add_relief(style="flat")
    again, _ = print_layers.read_modifier(relief_of(wall))
    assert (again.height, again.amplitude, again.spiral) == (relief.height, relief.amplitude, False)


def test_a_relief_is_copied_to_all_walls_or_to_none(wall):
    thin = add("tube")
    thin.heliform.wall.thickness = 0.002
    wall.select_set(True)
    bpy.context.view_layer.objects.active = wall
    modifier = relief_of(wall)
    _, style = print_layers.read_modifier(modifier)
    print_layers.write_modifier(modifier, Relief(height=0.008, amplitude=0.003), style)
    before = print_layers.read_modifier(relief_of(thin))[0]
    with pytest.raises(RuntimeError, match="of a wall"):
        bpy.ops.heliform.copy_relief()
    assert print_layers.read_modifier(relief_of(thin))[0] == before
    thin.heliform.wall.thickness = 0.02
    assert bpy.ops.heliform.copy_relief() == {"FINISHED"}
    assert print_layers.read_modifier(relief_of(thin))[0].amplitude == pytest.approx(0.003)
    assert thin.heliform.wall.bead.height == pytest.approx(0.008)
