"""The live modifier against the same relief as arrays, and what befalls it in a file."""

import itertools
import math

import bpy
import numpy as np
import pytest
from heliform.addon.bridge import print_layers as layers
from heliform.addon.bridge.meshes import from_blender, places_of, to_blender
from heliform.addon.bridge.print_nodes import VERSION, node_group, sockets_of
from heliform.engines.core import solid
from heliform.engines.core.errors import ParameterError, SceneError
from heliform.engines.core.normals import corner_normals, vertex_normals
from heliform.engines.core.scene import Mesh
from heliform.engines.glass import GlassObject, glass_object
from heliform.engines.glass.profile import Style, flat_bead, normalised, scalloped, texture_of
from heliform.engines.glass.relief import CREASE, Relief, relieve, relieved
from heliform.engines.glass.skin import Skin, skin_of
from mathutils import Matrix

MICROMETRE = 1e-6


def scan_style():
    """Uneven profiles and a texture whose sides are no powers of two."""
    random = np.random.default_rng(8)
    waves = np.hypot(*np.meshgrid(np.fft.fftfreq(90) * 90, np.fft.fftfreq(50) * 50))
    noise = np.fft.fft2(random.normal(size=(50, 90))) * np.exp(-((waves / 9) ** 2))
    texture, _ = texture_of(np.fft.ifft2(noise).real, (0.047, 0.021))
    phase = np.arange(700) / 700
    outer, _ = normalised(np.sin(np.pi * phase) ** 1.5 + 0.1 * np.sin(4 * np.pi * phase))
    inner, _ = normalised(np.abs(np.sin(np.pi * phase)) + 0.05 * np.cos(6 * np.pi * phase))
    return Style("Probe ä/1", outer, inner, texture, 4.7e-3, 0.9e-3, 6e-5)


STYLES = {
    "scalloped": scalloped(5e-3, 1.2e-3),
    "flat": flat_bead(5e-3, 1.2e-3),
    "scan": scan_style(),
}


def lobed_wall(around=90, rows=40):
    """A closed wall of bulges that stands 0.2 m high, and its own skin: turns by arc length."""
    theta = np.arange(around) * (2 * np.pi / around)
    r = 0.08 * (1 + 0.15 * np.cos(3 * theta))
    plan = np.column_stack([r * np.cos(theta), r * np.sin(theta)])
    along = np.roll(plan, -1, axis=0) - np.roll(plan, 1, axis=0)
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
    step = np.hypot(*(np.roll(plan, -1, axis=0) - plan).T)
    share = np.append(0, np.cumsum(step)) / step.sum()
    z = np.linspace(0, 0.2, rows)
    depth = np.repeat([0.0, -8e-3], rows)
    points = np.empty((2 * rows, around, 3))
    points[..., :2] = plan + depth[:, None, None] * normal
    points[..., 2] = np.concatenate([z, z[::-1]])[:, None]
    here = np.arange(2 * rows)[:, None] * around + np.arange(around)
    above = np.roll(here, -1, axis=0)
    corners = [here, np.roll(here, -1, axis=1), np.roll(above, -1, axis=1), above]
    side = np.repeat(np.where(depth == 0, 1.0, -1.0), around)
    side[: 2 * around] = np.linspace(0.2, 1, 2 * around)
    skin = Skin(np.tile(normal, (2 * rows, 1)), side, np.tile(share[:-1], 2 * rows), step.sum())
    return Mesh(points.reshape(-1, 3), np.stack(corners, -1).reshape(-1, 4).astype(np.int32)), skin


def wall():
    mesh, skin = lobed_wall()
    obj = put("Wall ä/1", to_blender(mesh, "Wall"))
    layers.skin_to_blender(skin, obj.data)
    return obj


def torus():
    bpy.ops.mesh.primitive_torus_add(
        major_radius=0.08, minor_radius=0.04, major_segments=90, minor_segments=60
    )
    return bpy.context.object


def bulged():
    """A sphere with n-gons for caps, stretched and bulged."""
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.1, segments=60, ring_count=40)
    block = bpy.context.object.data
    points = places_of(block) * [1.3, 0.8, 1.0]
    points[:, 0] += 0.01 * np.sin(40 * points[:, 2])
    block.attributes["position"].data.foreach_set("vector", points.astype(np.float32).ravel())
    block.update()
    return bpy.context.object


def panel():
    """An open curved surface beside the axis, leaning."""
    u, z = np.meshgrid(np.linspace(-0.6, 0.6, 40), np.linspace(-0.05, 0.15, 50), indexing="ij")
    r = 0.3 + 0.2 * z
    points = np.stack([r * np.cos(u), r * np.sin(u), z], -1).reshape(-1, 3)
    i = np.arange(39)[:, None] * 50 + np.arange(49)
    faces = np.stack([i, i + 50, i + 51, i + 1], -1).reshape(-1, 4).astype(np.int32)
    return put("Panel", to_blender(Mesh(points, faces), "Panel"))


def flat_glass():
    """A glass object as Heliform makes it: free corner normals, no skin."""
    return put("Glass", to_blender(glass_object(GlassObject(faces=9_000, lobes=4)), "Glass"))


SURFACES = {f.__name__: f for f in (wall, torus, bulged, panel, flat_glass)}


def put(name, block):
    obj = bpy.data.objects.new(name, block)
    bpy.context.collection.objects.link(obj)
    return obj


def seen(obj):
    """The evaluated mesh as the engines get it."""
    return from_blender(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))


def as_arrays(obj, relief, style, mask=None):
    places = places_of(obj.data)
    return relieve(places, layers.skin_from_blender(obj.data), relief, style, mask)


def masked(obj):
    """A vertex group over half of the object, and what it weighs at each vertex."""
    count = len(obj.data.vertices)
    weights = np.clip(np.arange(count) / count * 2 - 0.5, 0, 1)
    group = obj.vertex_groups.new(name="Half ä")
    for index, weight in enumerate(weights):
        group.add([index], float(weight), "REPLACE")
    return "Half ä", weights


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize("style", STYLES)
def test_the_modifier_is_the_arrays(surface, style):
    obj, style = SURFACES[surface](), STYLES[style]
    mask, weights = masked(obj)
    modifier = layers.add_modifier(obj, Relief(), style)
    ways = itertools.product((True, False), ("outer", "inner", "both"), (0.0, 8e-5), (False, True))
    for seed, (spiral, sides, roughness, partly) in enumerate(ways):
        relief = Relief(
            height=4.3e-3,
            amplitude=1.1e-3,
            crest=0.7,
            spiral=spiral,
            sides=sides,
            roughness=roughness,
            seed=41 * seed,
            base=1.3e-3,
        )
        layers.write_modifier(modifier, relief, style, mask=mask if partly else "")
        truth = as_arrays(obj, *layers.read_modifier(modifier), weights if partly else None)
        found = seen(obj).vertices
        assert np.abs(found - truth).max() < MICROMETRE, relief
        assert sides != "both" or np.abs(found - places_of(obj.data)).max() > 3e-4


@pytest.mark.parametrize("style", STYLES)
def test_a_style_as_it_was_given_is_the_same_relief(style):
    """What Blender rounds to float32 makes no difference."""
    obj, style = wall(), STYLES[style]
    relief = Relief(roughness=5e-5, seed=1000)
    layers.add_modifier(obj, relief, style)
    mesh, skin = lobed_wall()
    truth = relieve(mesh.vertices, skin, relief, style)
    assert np.abs(seen(obj).vertices - truth).max() < MICROMETRE


@pytest.mark.parametrize("scale", [1e-3, 0.3048])
def test_other_units(scale):
    relief = Relief(roughness=8e-5, seed=5, base=-2e-3)
    mesh, skin = lobed_wall()
    obj = put("Wall", to_blender(Mesh(mesh.vertices / scale, mesh.faces), "Wall"))
    layers.skin_to_blender(skin, obj.data, scale)
    modifier = layers.add_modifier(obj, relief, STYLES["scan"], scale)
    found, style = layers.read_modifier(modifier, scale)
    assert found == Relief(style="scan", roughness=8e-5, seed=5, base=-2e-3)
    assert style.texture.size == pytest.approx([0.047, 0.021])
    truth = relieve(mesh.vertices, skin, relief, STYLES["scan"])
    assert np.abs(seen(obj).vertices * scale - truth).max() < MICROMETRE
    back = layers.skin_from_blender(obj.data, scale)
    assert back.girth == pytest.approx(skin.girth, rel=1e-5)
    assert back.turn == pytest.approx(skin.turn, abs=1e-6)


@pytest.mark.parametrize("surface", ["torus", "bulged", "panel"])
def test_the_skin_of_a_mesh_is_blenders(surface):
    obj = SURFACES[surface]()
    mesh, blenders = from_blender(obj), layers.skin_from_blender(obj.data)
    own = skin_of(mesh)
    assert own.side == pytest.approx(blenders.side, abs=2e-3)
    shown = np.abs(own.side) > 0.1
    assert own.normal[shown] == pytest.approx(blenders.normal[shown], abs=2e-3)
    assert (own.turn == blenders.turn).all()


def angles(a, b):
    return np.degrees(2 * np.arcsin(np.linalg.norm(a.astype(float) - b, axis=-1) / 2))


@pytest.mark.parametrize("surface", ["wall", "torus", "panel", "flat_glass"])
@pytest.mark.parametrize("spiral", [True, False])
def test_normals_are_smooth_with_the_same_creases(surface, spiral):
    obj = SURFACES[surface]()
    layers.add_modifier(
        obj, Relief(spiral=spiral, height=8e-3, amplitude=2e-3), STYLES["scalloped"]
    )
    mesh = seen(obj)
    assert angles(corner_normals(mesh, CREASE), mesh.normals).max() < 0.05
    bare = Mesh(mesh.vertices, mesh.faces)
    if surface in ("wall", "flat_glass"):
        assert angles(vertex_normals(bare)[mesh.faces], mesh.normals).max() > 20  # some are creased


def test_vertex_normals_are_blenders():
    obj = torus()
    normals = np.empty((len(obj.data.vertices), 3), np.float32)
    obj.data.vertex_normals.foreach_get("vector", normals.ravel())
    assert angles(vertex_normals(from_blender(obj)), normals).max() < 0.05


def test_relieved_is_what_is_seen():
    obj, relief = wall(), Relief(spiral=False, height=8e-3, amplitude=2e-3)
    layers.add_modifier(obj, relief, STYLES["flat"])
    mesh, skin = lobed_wall()
    made, found = relieved(mesh, skin, relief, STYLES["flat"]), seen(obj)
    assert np.array_equal(made.faces, found.faces)
    assert np.percentile(angles(made.normals, found.normals), 99.9) < 0.05
    assert solid.inspect(found).problem == ""


def test_another_style_is_seen_at_once_though_it_was_there_before():
    obj = wall()
    relief, first = Relief(amplitude=1e-3), flat_bead(5e-3, 1e-3)
    modifier = layers.add_modifier(obj, relief, first)
    seen(obj)
    second = scalloped(5e-3, 1e-3)
    layers.style_object(second)
    bpy.context.view_layer.update()
    layers.write_modifier(modifier, relief, second)
    np.testing.assert_allclose(seen(obj).vertices, as_arrays(obj, relief, second), atol=1e-6)


def test_an_applied_modifier_leaves_what_was_seen():
    obj = wall()
    modifier = layers.add_modifier(obj, Relief(roughness=5e-5), STYLES["scan"])
    before = seen(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    after = seen(obj)
    assert not obj.modifiers
    assert np.array_equal(before.vertices, after.vertices)
    assert np.array_equal(before.faces, after.faces)
    assert angles(before.normals, after.normals).max() < 0.05


def test_a_copy_shares_the_style_and_keeps_its_own_settings():
    obj = wall()
    modifier = layers.add_modifier(obj, Relief(amplitude=1e-3), STYLES["scan"])
    copy = obj.copy()
    bpy.context.collection.objects.link(copy)
    other = copy.modifiers[0]
    assert layers.is_print_layers(other)
    layers.write_modifier(other, Relief(amplitude=5e-4), STYLES["scan"])
    assert layers.read_modifier(modifier)[0].amplitude == 1e-3
    assert layers.read_modifier(other)[0].amplitude == 5e-4
    assert sockets_of(other)["Style"].value == sockets_of(modifier)["Style"].value
    assert not np.array_equal(seen(obj).vertices, seen(copy).vertices)


def test_others_take_it_over():
    obj, mesh, lamp = wall(), torus(), put("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    relief = Relief(style="flat", seed=9, sides="inner", spiral=False)
    modifier = layers.add_modifier(obj, relief, STYLES["flat"], mask="weight")
    made = layers.copy_to(modifier, [obj, mesh, lamp])
    again = layers.copy_to(modifier, [mesh])
    assert [m.id_data for m in made] == [m.id_data for m in again] == [mesh]
    assert len(mesh.modifiers) == 1
    assert layers.read_modifier(made[0])[0] == relief
    assert sockets_of(made[0])["Mask"].attribute_name == "weight"


def test_blenders_own_link_to_others_works():
    obj, other = wall(), torus()
    layers.add_modifier(obj, Relief(amplitude=7e-4), STYLES["scalloped"])
    obj.select_set(True)
    other.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.make_links_data(type="MODIFIERS")
    relief, style = layers.read_modifier(other.modifiers[0])
    truth = as_arrays(other, relief, style)
    assert relief.amplitude == 7e-4
    assert np.abs(seen(other).vertices - truth).max() < MICROMETRE


def test_it_outlives_saving(tmp_path):
    obj = wall()
    relief = Relief(style="scan", roughness=5e-5, seed=77, sides="outer", crest=0.25)
    layers.add_modifier(obj, relief, STYLES["scan"])
    before = seen(obj).vertices
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "wall ä.blend"))
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "wall ä.blend"))
    obj = bpy.data.objects["Wall ä/1"]
    assert np.array_equal(seen(obj).vertices, before)
    found, style = layers.read_modifier(obj.modifiers[0])
    assert (found, style.digest) == (relief, STYLES["scan"].digest)
    assert node_group() == obj.modifiers[0].node_group
    assert layers.style_object(STYLES["scan"]) == sockets_of(obj.modifiers[0])["Style"].value


def test_undo_brings_back_what_was():
    obj = wall()
    modifier = layers.add_modifier(obj, Relief(amplitude=1e-3), STYLES["scan"])
    bpy.ops.ed.undo_push(message="Added")
    layers.write_modifier(modifier, Relief(amplitude=2e-3), STYLES["flat"])
    bpy.ops.ed.undo_push(message="Changed")
    bpy.ops.ed.undo()
    obj = bpy.data.objects["Wall ä/1"]
    relief, style = layers.read_modifier(obj.modifiers[0])
    assert (relief.amplitude, style.digest) == (1e-3, STYLES["scan"].digest)
    truth = as_arrays(obj, relief, style)
    assert np.abs(seen(obj).vertices - truth).max() < MICROMETRE
    bpy.ops.ed.redo()
    obj = bpy.data.objects["Wall ä/1"]
    assert layers.read_modifier(obj.modifiers[0])[0].amplitude == 2e-3


def test_there_is_one_group_and_one_object_for_a_style():
    first, second = wall(), torus()
    for obj, name in ((first, "scan"), (second, "scan"), (first, "flat")):
        layers.add_modifier(obj, Relief(), STYLES[name])
    assert len([t for t in bpy.data.node_groups if t.name.startswith("Print Layers")]) == 1
    assert len([o for o in bpy.data.objects if o.name.startswith("Relief Probe")]) == 1
    assert not any(o.users_scene for o in bpy.data.objects if o.name.startswith("Relief"))
    assert node_group().asset_data is not None


def test_an_older_group_is_renewed_with_its_values_kept():
    obj = wall()
    relief = Relief(style="scan", roughness=5e-5, seed=3, sides="inner", spiral=False)
    modifier = layers.add_modifier(obj, relief, STYLES["scan"], mask="weight")
    tree = modifier.node_group
    tree["heliform_print_layers"] = 0
    tree.nodes.remove(next(n for n in tree.nodes if n.type == "SET_POSITION"))
    tree.interface.remove(next(i for i in tree.interface.items_tree if i.name == "Crest"))
    obj.data.attributes.new("weight", "FLOAT", "POINT").data.foreach_set(
        "value", np.ones(len(obj.data.vertices), np.float32)
    )
    assert node_group() == tree
    assert tree["heliform_print_layers"] == VERSION
    assert layers.read_modifier(modifier)[0] == relief
    assert sockets_of(modifier)["Mask"].attribute_name == "weight"
    truth = as_arrays(obj, *layers.read_modifier(modifier))
    assert np.abs(seen(obj).vertices - truth).max() < MICROMETRE


def test_a_style_reads_back_as_it_was():
    for style in STYLES.values():
        found = layers.style_of(layers.style_object(style, scale=1e-3))
        assert found.digest == style.digest
        assert found.name == style.name


def test_without_a_style_nothing_moves():
    obj = wall()
    modifier = layers.add_modifier(obj, Relief(roughness=1e-4), STYLES["scan"])
    for stand_in in (None, torus()):
        sockets_of(modifier)["Style"].value = stand_in
        obj.update_tag()
        assert np.array_equal(seen(obj).vertices, places_of(obj.data))
        with pytest.raises(SceneError, match="holds no relief style"):
            layers.read_modifier(modifier)


@pytest.mark.parametrize("points", [[], [(0.1, 0, 0), (0, 0.2, 0.1)]])
def test_a_mesh_without_faces_or_vertices_harms_nothing(points):
    block = bpy.data.meshes.new("Few")
    block.from_pydata(points, [], [])
    obj = put("Few", block)
    layers.add_modifier(obj, Relief(roughness=1e-4), STYLES["scan"])
    shown = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert len(shown.vertices) == len(points)
    if points:
        truth = as_arrays(obj, Relief(roughness=1e-4), STYLES["scan"])
        assert places_of(shown) == pytest.approx(truth, abs=MICROMETRE)


def test_a_light_takes_no_relief():
    lamp = put("Lamp ä", bpy.data.lights.new("Lamp", "POINT"))
    with pytest.raises(SceneError, match="“Lamp ä” is no mesh"):
        layers.add_modifier(lamp, Relief(), STYLES["flat"])


def test_subdividing_a_wall_first_leaves_no_tear_at_the_seam():
    obj = wall()
    finer = obj.modifiers.new("Finer", "SUBSURF")
    finer.subdivision_type, finer.levels = "SIMPLE", 1
    layers.add_modifier(obj, Relief(height=0.05), STYLES["scalloped"])
    mesh = seen(obj)
    assert solid.inspect(mesh).problem == ""
    outside = np.hypot(*mesh.vertices[:, :2].T)
    ends = mesh.vertices[mesh.faces]
    at_seam = (np.abs(ends[..., 1]) < 4e-3).all(axis=1) & (ends[..., 0] > 0).all(axis=1)
    assert outside.min() > 0.05
    steps = np.ptp(ends[at_seam][..., 0], axis=1)
    assert steps[np.ptp(ends[at_seam][..., 2], axis=1) > 1e-3].max() < 2e-3


def test_relief_turns_and_scales_with_its_object():
    obj = wall()
    layers.add_modifier(obj, Relief(), STYLES["scalloped"])
    upright = seen(obj).vertices
    obj.matrix_world = Matrix.LocRotScale((1, 2, 3), Matrix.Rotation(0.7, 3, "X"), (2, 2, 2))
    assert np.array_equal(seen(obj).vertices, upright)


def curve(points, name="Bézier ä"):
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = "3D"
    spline = data.splines.new("POLY")
    spline.points.add(len(points) - 1)
    spline.points.foreach_set("co", np.pad(points, ((0, 0), (0, 1))).astype(np.float32).ravel())
    return put(name, data)


def arch(along=2, count=33):
    points = np.zeros((count, 3))
    points[:, along] = np.linspace(0, 6e-3, count)
    points[:, 0] = 1.5e-3 * np.sin(np.linspace(0, np.pi, count)) ** 2
    return points


@pytest.mark.parametrize("along", [1, 2])
def test_a_drawn_curve_is_a_style(along):
    style = layers.style_from_curve(curve(arch(along)))
    assert (style.height, style.depth) == (pytest.approx(6e-3), pytest.approx(1.5e-3))
    phase = np.linspace(0, 1, 33)
    assert style.profile.at(phase) == pytest.approx(np.sin(np.pi * phase) ** 2, abs=1e-5)
    assert style.name == "Bézier ä"


def test_a_line_of_edges_in_any_order_and_size_is_a_style():
    points = arch()
    shuffled = np.random.default_rng(1).permutation(len(points))
    where = np.argsort(shuffled)
    block = bpy.data.meshes.new("Line")
    block.from_pydata(points[shuffled].tolist(), np.stack([where[:-1], where[1:]], 1).tolist(), [])
    obj = put("Line", block)
    obj.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    style = layers.style_from_curve(obj, scale=0.5)
    assert style.height == pytest.approx(6e-3)
    assert style.profile.at(0.5) == pytest.approx(1, abs=1e-3)


def test_a_smooth_curve_is_followed():
    bpy.ops.curve.primitive_bezier_curve_add()
    obj = bpy.context.object
    a, b = obj.data.splines[0].bezier_points
    for point in (a, b):
        point.handle_left_type = point.handle_right_type = "FREE"
    a.co, a.handle_left, a.handle_right = (0, 0, 0), (0, 0, -1), (0.6, 0, 0.1)
    b.co, b.handle_left, b.handle_right = (0, 0, 1), (0.6, 0, 0.9), (0, 0, 2)
    style = layers.style_from_curve(obj)
    assert style.profile.at(0.3) == pytest.approx(style.profile.at(0.7), abs=1e-3)
    assert style.depth == pytest.approx(0.45, rel=0.01)


def test_what_is_no_profile_is_said():
    with pytest.raises(ParameterError, match="“Bézier ä” doubles back"):
        layers.style_from_curve(curve(np.array([[0, 0, 0], [1, 0, 2], [1, 0, 1], [0, 0, 3.0]])))
    for make in (bpy.ops.mesh.primitive_circle_add, bpy.ops.mesh.primitive_cube_add):
        make()
        with pytest.raises(SceneError, match="is not one open line"):
            layers.style_from_curve(bpy.context.object)
    with pytest.raises(SceneError, match="is not one open line"):
        layers.style_from_curve(put("Lamp", bpy.data.lights.new("Lamp", "POINT")))


def test_the_modifier_says_what_its_inputs_are():
    obj = wall()
    modifier = layers.add_modifier(obj, Relief(), STYLES["flat"])
    items = modifier.node_group.interface.items_tree
    inputs = [i for i in items if i.item_type == "SOCKET" and i.in_out == "INPUT"][1:]
    assert all(item.description for item in inputs)
    lengths = [i.name for i in inputs if getattr(i, "subtype", "") == "DISTANCE"]
    assert lengths == ["Layer Height", "Amplitude", "Base", "Roughness"]
    names = ["Layers", "Roughness", "Where"]
    assert [i.name for i in items if i.item_type == "PANEL"] == names
    assert math.isclose(sockets_of(modifier)["Layer Height"].value, 5e-3, rel_tol=1e-6)
