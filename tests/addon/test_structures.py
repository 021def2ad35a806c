"""Structures in Blender: added, dragged, coloured, picked, animated, saved and run as a study."""

from dataclasses import replace

import bpy
import numpy as np
import pytest
from heliform.addon import structures
from heliform.addon.bridge import layers, members, results
from heliform.addon.bridge.handles import handles_of
from heliform.addon.bridge.meshes import from_blender, places_of
from heliform.engines.core.scene import Scene
from heliform.engines.structure.drawn import drawn_sections, exaggeration, values_along
from heliform.engines.structure.fins import member_solids
from heliform.engines.structure.joints import node_normals
from heliform.engines.structure.level_set import Nine
from heliform.engines.structure.presets import PRESETS
from heliform.engines.structure.roof import Roof
from heliform.engines.structure.structure import Structure, design

SMALL = Structure(form="roof", roof=Roof(length=12, width=8, spacing=2))


def add(context, record=SMALL):
    return structures.add_structure(context, record, "Roof")


def follow(obj):
    bpy.context.view_layer.update()
    structures.follow_handles(obj, bpy.context.scene)


@pytest.fixture
def roof(scene):
    return add(bpy.context)


@pytest.mark.parametrize("preset", PRESETS)
def test_each_preset_is_added_sized_and_coloured(scene, preset):
    assert bpy.ops.heliform.add_structure(preset=preset) == {"FINISHED"}
    obj = bpy.context.object
    facts = members.facts_of(obj)
    assert not obj.heliform.problem
    assert facts["figures"]["failing"]["value"] == 0
    assert facts["figures"]["converged"]["value"] == 1
    assert len(obj.data.polygons) >= 6 * facts["figures"]["members"]["value"]
    assert layers.layer_of(obj).quantity == "Utilisation"


def test_its_solids_are_those_of_the_engine(roof):
    sized = design(SMALL, Scene())
    model = sized.model
    normals = node_normals(model.frame, model.cells)
    fins = member_solids(
        model.frame, drawn_sections(sized), "mitred", members.CROSSES, normals=normals
    )
    np.testing.assert_allclose(places_of(roof.data), fins.mesh.vertices, atol=1e-5)


def test_light_meets_it_as_a_matte_body(roof, seen):
    roof.heliform.role = "BODY"
    (body,) = seen().bodies
    assert body.material.kind == "diffuse"
    assert len(body.mesh.faces) == len(from_blender(roof).faces)


def test_sliders_change_it_and_a_wrong_one_is_said(roof):
    before = members.facts_of(roof)["figures"]["members"]["value"]
    roof.heliform.structure.roof.spacing = 1.0
    assert members.facts_of(roof)["figures"]["members"]["value"] > before
    roof.heliform.structure.loading.area_load = 0
    roof.heliform.structure.loading.self_weight = False
    assert "loads nothing" in roof.heliform.problem
    roof.heliform.structure.loading.self_weight = True
    assert not roof.heliform.problem


def test_a_control_point_is_dragged_and_the_structure_follows(roof):
    roof.heliform.controls = True
    handles = handles_of(roof)
    assert len(handles) == 16
    before, mass = places_of(roof.data), members.facts_of(roof)["figures"]["mass"]["value"]
    handles["net.p11"].location.z += 1.5
    follow(roof)
    assert roof.heliform.structure.net.p11.z == pytest.approx(1.5, abs=1e-5)
    lifted = 1.5 * (4 / 9) ** 2  # what a Bernstein polynomial of degree 3 has at its most
    assert (places_of(roof.data) - before)[:, 2].max() == pytest.approx(lifted, abs=0.15)
    assert members.facts_of(roof)["figures"]["mass"]["value"] != mass
    built = roof["heliform_built"]
    follow(roof)
    assert roof["heliform_built"] == built
    roof.heliform.controls = False
    assert not handles_of(roof)


def test_control_points_can_be_animated(roof):
    roof.heliform.controls = True
    handle = handles_of(roof)["net.p22"]
    handle.keyframe_insert("location", frame=1)
    handle.location.z += 2
    handle.keyframe_insert("location", frame=10)
    bpy.context.scene.frame_set(1)
    low = places_of(roof.data)
    bpy.context.scene.frame_set(10)
    high = places_of(roof.data)
    assert high[:, 2].max() > low[:, 2].max() + 0.2
    bpy.context.scene.frame_set(1)
    np.testing.assert_allclose(places_of(roof.data)[:, 2].max(), low[:, 2].max(), atol=0.05)


def test_handles_of_the_facade_move_its_surface_outward(scene):
    obj = add(
        bpy.context, replace(PRESETS["facade"], facade=replace(PRESETS["facade"].facade, modules=8))
    )
    obj.heliform.controls = True
    handle = handles_of(obj)["net.p12"]
    out = np.array(handle.location)
    out[2] = 0
    handle.location = np.array(handle.location) + 3 * out / np.linalg.norm(out)
    follow(obj)
    shift = obj.heliform.structure.net.p12
    assert shift.x == pytest.approx(3, abs=0.2)
    assert abs(shift.z) < 1e-4


def test_material_follows_its_handles(roof):
    roof.heliform.levels = True
    handles = handles_of(roof)
    assert len(handles) == 9
    for name, handle in handles.items():
        if name.startswith("material.c0"):
            handle.location.z -= 10
    follow(roof)
    assert roof.heliform.structure.material.c01 == pytest.approx(-1)
    assert roof.heliform.structure.material.c21 == pytest.approx(1, abs=1e-4)
    figures = members.facts_of(roof)["figures"]
    assert figures["mass_timber"]["value"] > 0
    assert figures["mass_steel"]["value"] > 0


@pytest.mark.parametrize("name", members.MAPS)
def test_every_map_is_an_image_of_its_values(roof, name):
    roof.heliform.member_map = name
    layer = layers.layer_of(roof)
    assert layer.quantity == members.MAPS[name][0]
    kind = next(kind for kind, names in members.CHANNELS.items() if name in names)
    stored = results.pixels_of(results.find(roof, kind, ""))[
        ..., members.CHANNELS[kind].index(name)
    ]
    truth = values_along(design(SMALL, Scene()), members.STATIONS)[name]
    np.testing.assert_allclose(stored, np.broadcast_to(truth, stored.shape), rtol=1e-4, atol=1e-4)
    picture = results.pixels_of(results.find(roof, results.PICTURE, ""))
    if layer.scale:
        colours = layer.scale.colours(stored) / 255
        fine = stored <= 1 if name == "utilisation" else np.ones(stored.shape, bool)
        np.testing.assert_allclose(picture[fine], colours[fine], atol=0.01)


def test_members_that_fail_are_red(scene):
    weak = replace(SMALL, material=Nine(**{f"c{i}{j}": -1.0 for i in range(3) for j in range(3)}))
    weak = replace(weak, loading=replace(weak.loading, area_load=200e3))
    obj = add(bpy.context, weak)
    facts = members.facts_of(obj)
    assert facts["figures"]["failing"]["value"] > 0
    picture = results.pixels_of(results.find(obj, results.PICTURE, ""))
    values = results.pixels_of(results.find(obj, "use", ""))[..., 0]
    red = np.abs(picture - np.array((214, 39, 40)) / 255).max(axis=-1) < 0.01
    np.testing.assert_array_equal(red, values > 1 + 1e-6)
    assert any("fail" in label for label, _ in layers.layer_of(obj).swatches)


def test_the_worst_member_is_picked_and_its_checks_are_told(roof):
    bpy.ops.heliform.worst_member()
    known = members.member_facts(roof, roof.heliform.member)
    rows = design(SMALL, Scene()).rows
    assert known["utilisation"] == pytest.approx(rows["utilisation"].max(), rel=1e-5)
    assert known["checks"][0][1] == pytest.approx(known["utilisation"], rel=1e-5)
    assert known["section"] in rows["name"]
    (mark,) = layers.layer_of(roof).marks
    assert f"Member {roof.heliform.member}" in mark.label
    face = next(
        i
        for i in range(len(roof.data.polygons))
        if members.member_of_face(roof, i) == roof.heliform.member
    )
    centre = np.array(roof.data.polygons[face].center)
    assert np.linalg.norm(centre - mark.place) < known["length"]


def test_the_displaced_shape_is_a_shape_key_that_can_swing(roof):
    key = members.displaced_key(roof)
    places = np.empty(3 * len(roof.data.vertices), dtype=np.float32)
    key.points.foreach_get("co", places)
    moved = np.linalg.norm(places.reshape(-1, 3) - places_of(roof.data), axis=1).max()
    sized = design(SMALL, Scene())
    most = np.linalg.norm(sized.deflections, axis=-1).max()
    assert moved == pytest.approx(exaggeration(sized) * most, rel=0.15)
    bpy.ops.heliform.animate_displacement()
    seen = []
    for frame in (1, 25, 49):
        bpy.context.scene.frame_set(frame)
        seen.append(key.value)
    np.testing.assert_allclose(seen, (0, 1, 0), atol=1e-6)
    bpy.ops.heliform.animate_displacement()
    assert not roof.data.shape_keys.animation_data


def test_the_edges_of_a_mesh_become_a_structure(scene):
    bpy.ops.mesh.primitive_cube_add(size=4)
    cube = bpy.context.object
    bpy.ops.heliform.structure_from_mesh()
    obj = bpy.context.object
    assert members.facts_of(obj)["figures"]["members"]["value"] == 12
    cube.data.vertices[7].co.z += 1
    structures.rebuild(obj, scene)
    assert places_of(obj.data)[:, 2].max() > 2.9
    bpy.data.objects.remove(cube)
    structures.rebuild(obj, scene)
    assert obj.heliform.problem


def test_a_structure_in_centimetres_is_the_same_structure(scene):
    scene.unit_settings.scale_length = 0.01
    obj = add(bpy.context)
    sized = design(SMALL, Scene())
    assert members.facts_of(obj)["figures"]["mass"]["value"] == pytest.approx(
        sized.figures()["mass"]["value"]
    )
    assert np.ptp(places_of(obj.data)[:, 0]) == pytest.approx(1200, rel=0.02)


def test_members_are_written_as_tables_and_lines(roof, tmp_path):
    roof.name = "Dach ä/1"
    assert bpy.ops.heliform.export_members(directory=str(tmp_path)) == {"FINISHED"}
    (folder,) = tmp_path.iterdir()
    names = {path.name for path in folder.iterdir()}
    assert {"members.csv", "members.dxf"} <= names
    with pytest.raises(RuntimeError, match="is there already"):
        bpy.ops.heliform.export_members(directory=str(tmp_path))


def test_the_job_gives_what_live_sizing_gives(roof):
    before = members.facts_of(roof)
    assert bpy.ops.heliform.size_structure() == {"FINISHED"}
    after = members.facts_of(roof)
    assert after["figures"]["mass"]["value"] == pytest.approx(before["figures"]["mass"]["value"])
    assert after["folder"]


def test_what_is_not_live_waits(roof):
    roof.heliform.live = False
    before = places_of(roof.data)
    roof.heliform.structure.roof.rise = 2
    np.testing.assert_array_equal(places_of(roof.data), before)
    assert bpy.ops.heliform.rebuild_structure() == {"FINISHED"}
    assert places_of(roof.data)[:, 2].max() > before[:, 2].max() + 0.3


def test_a_saved_structure_opens_with_all_that_was_said_of_it(roof, tmp_path):
    bpy.ops.heliform.worst_member()
    known = members.member_facts(roof, roof.heliform.member)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "Dach ä.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "Dach ä.blend"))
    obj = bpy.data.objects["Roof"]
    assert members.member_facts(obj, obj.heliform.member) == known
    obj.heliform.member_map = "stress"
    assert layers.layer_of(obj).quantity == "Stress"


def test_the_colours_can_be_taken_off(roof):
    bpy.ops.heliform.clear_layer()
    assert layers.layer_of(roof) is None
    assert results.find(roof, results.PICTURE, "") is None


def test_without_a_structure_operators_say_so(scene):
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.heliform.worst_member()
    with pytest.raises(RuntimeError, match="Select a structure"):
        bpy.ops.heliform.size_structure()


def test_edges_without_faces_become_a_structure_too(scene):
    block = bpy.data.meshes.new("Wires")
    corners = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (2, 2, 3), (2, 2, 4)]
    block.from_pydata(corners, [(0, 3), (1, 3), (2, 3), (3, 4)], [])
    obj = bpy.data.objects.new("Wires", block)
    scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.heliform.structure_from_mesh()
    made = bpy.context.object
    assert not made.heliform.problem
    assert members.facts_of(made)["figures"]["members"]["value"] == 4


def test_faces_of_a_mesh_carry_a_load_and_its_diagonals_are_no_members(scene):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=4, size=8)
    bpy.ops.heliform.structure_from_mesh()
    made = bpy.context.object
    made.heliform.structure.network.supports = "boundary"
    made.heliform.structure.loading.area_load = 1000
    facts = members.facts_of(made)
    assert not made.heliform.problem
    assert facts["figures"]["members"]["value"] == 2 * 4 * 5
    assert any("area load" in str(line) for line in facts["combinations"])


def test_the_structure_stays_at_hand_while_one_of_its_handles_is_active(roof):
    roof.heliform.controls = True
    bpy.context.view_layer.objects.active = handles_of(roof)["net.p11"]
    assert structures.active_structure(bpy.context) == roof
    assert bpy.ops.heliform.worst_member() == {"FINISHED"}
    assert roof.heliform.member >= 0
    assert bpy.ops.heliform.size_structure() == {"FINISHED"}
    assert members.facts_of(roof)["folder"]


def test_the_legend_of_section_classes_names_those_that_are_there(roof):
    roof.heliform.member_map = "class"
    assert [label for label, _ in layers.layer_of(roof).swatches] == ["Not classed"]
    roof.heliform.structure.rules.mode = "eurocode"
    labels = [label for label, _ in layers.layer_of(roof).swatches]
    assert labels
    assert all(label in ("Class 1", "Class 2", "Class 3", "Class 4") for label in labels)
