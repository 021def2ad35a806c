"""Instances are bodies, wherever Blender shows them."""

import time

import bpy
import numpy as np
import pytest
from heliform.addon.bridge.instances import left_out
from heliform.addon.bridge.read import read_bodies
from heliform.engines.core.errors import SceneError
from heliform.engines.core.solid import inspect


def volume(mesh):
    corners = mesh.triangles()
    a, b, c = (corners.vertices[corners.faces[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def bodies():
    bpy.context.view_layer.update()
    found = read_bodies(bpy.context.evaluated_depsgraph_get())
    return {body.name: body for body in found}


def add(kind, name, role="BODY", at=(0, 0, 0), **options):
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(location=at, **options)
    obj = bpy.context.object
    obj.name, obj.heliform.role, obj.heliform.material.kind = name, role, "diffuse"
    return obj


def collected(scene, name, *objects):
    """A collection of these that is itself excluded, as one that is only instanced."""
    drawer = bpy.data.collections.new(name)
    scene.collection.children.link(drawer)
    for obj in objects:
        for collection in obj.users_collection:
            collection.objects.unlink(obj)
        drawer.objects.link(obj)
    bpy.context.view_layer.layer_collection.children[name].exclude = True
    return drawer


def instance(scene, name, collection, role="NONE", **place):
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    scene.collection.objects.link(empty)
    empty.heliform.role = role
    for key, value in place.items():
        setattr(empty, key, value)
    return empty


def on_grid(obj, side=5, join=True, of=None, realized=False):
    """Geometry Nodes that put an object, or ``of``, on a grid of points 3 m apart."""
    tree = bpy.data.node_groups.new("Grid", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    new, link = tree.nodes.new, tree.links.new
    given, made = new("NodeGroupInput"), new("NodeGroupOutput")
    grid, put = new("GeometryNodeMeshGrid"), new("GeometryNodeInstanceOnPoints")
    for key, value in enumerate((3 * (side - 1), 3 * (side - 1), side, side)):
        grid.inputs[key].default_value = value
    source = given.outputs[0]
    if of:
        info = new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = of
        info.inputs["As Instance"].default_value = True
        source = info.outputs["Geometry"]
    link(grid.outputs[0], put.inputs[0])
    link(source, put.inputs["Instance"])
    out = put
    if join:
        out = new("GeometryNodeJoinGeometry")
        link(put.outputs[0], out.inputs[0])
        link(given.outputs[0], out.inputs[0])
    if realized:
        real = new("GeometryNodeRealizeInstances")
        link(out.outputs[0], real.inputs[0])
        out = real
    link(out.outputs[0], made.inputs[0])
    obj.modifiers.new("Grid", "NODES").node_group = tree


def test_a_collections_instances_are_where_they_are_shown(scene):
    roof = add("cube", "Roof", at=(0, 0, 3))
    drawer = collected(scene, "Drawer", roof)
    assert bodies() == {}
    instance(scene, "East", drawer, location=(10, 0, 0))
    instance(scene, "West ä/1", drawer, location=(-10, 0, 0), scale=(1, 1, -2))
    found = bodies()
    assert list(found) == ["Roof (East)", "Roof (West ä/1)"]
    east, west = found["Roof (East)"].mesh, found["Roof (West ä/1)"].mesh
    assert east.vertices.min(axis=0) == pytest.approx([9, -1, 2])
    assert west.vertices.min(axis=0) == pytest.approx([-11, -1, -8])
    assert (volume(east), volume(west)) == pytest.approx((8, 16))  # outward, though mirrored
    assert found["Roof (East)"].material.kind == "diffuse"


def test_roles_of_what_is_shown_come_before_those_of_what_shows_it(scene):
    plain, glass = add("cube", "Plain", "NONE"), add("cube", "Glass")
    glass.heliform.material.kind = "mirror"
    empty = instance(scene, "House", collected(scene, "Drawer", plain, glass), "BODY")
    empty.heliform.material.kind = "plastic"
    kinds = {name: body.material.kind for name, body in bodies().items()}
    assert kinds == {"House": "plastic", "Glass (House)": "mirror"}
    empty.heliform.role = "NONE"
    assert list(bodies()) == ["Glass (House)"]
    glass.heliform.on = False
    assert bodies() == {}


def test_an_instance_of_a_collection_can_be_marked(scene):
    plain = add("cube", "Plain", "NONE")
    empty = instance(scene, "House", collected(scene, "Drawer", plain))
    with bpy.context.temp_override(selected_objects=[empty]):
        bpy.ops.heliform.mark_as(role="BODY")
    assert bodies()["House"].material.kind == "diffuse"


def test_instancers_that_are_hidden_or_off_show_nothing(scene):
    drawer = collected(scene, "Drawer", add("cube", "Roof"))
    hidden, off = (instance(scene, name, drawer) for name in ("Hidden", "Off"))
    hidden.hide_set(True)
    off.heliform.on = False
    assert bodies() == {}


def test_names_stay_apart(scene):
    drawer = collected(scene, "Drawer", add("cube", "Roof"))
    instance(scene, "East", drawer)
    add("cube", "Roof (East)")
    assert list(bodies()) == ["Roof (East)", "Roof (East) 2"]


@pytest.mark.parametrize("join", [True, False])
def test_geometry_nodes_are_the_same_realized_or_not(join):
    obj = add("cube", "Fins", at=(1, 2, 3))
    obj.scale = (0.5, 1, -0.3)
    on_grid(obj, join=join)
    shown = bodies()["Fins"].mesh
    obj.modifiers.clear()
    on_grid(obj, join=join, realized=True)
    real = bodies()["Fins"].mesh
    assert len(shown.faces) == len(real.faces) == 6 * (25 + join)
    assert volume(shown) == pytest.approx(volume(real))
    assert volume(shown) > 0
    order = [np.lexsort(m.vertices.round(4).T) for m in (shown, real)]
    assert shown.vertices[order[0]] == pytest.approx(real.vertices[order[1]], abs=1e-5)
    assert inspect(shown).open_edges == 0


def test_geometry_nodes_show_other_objects_with_their_own_modifiers():
    fin = add("cube", "Fin")
    fin.modifiers.new("Twice", "ARRAY").relative_offset_displace = (2, 0, 0)
    field = add("plane", "Field", "NONE", at=(0, 0, 5))
    on_grid(field, side=3, of=fin)
    found = bodies()
    assert list(found) == ["Fin", "Fin (Field)"]
    assert volume(found["Fin (Field)"].mesh) == pytest.approx(9 * 16)
    field.heliform.role, fin.heliform.role = "BODY", "NONE"
    fin.hide_set(True)
    (only,) = bodies().values()
    assert (only.name, len(only.mesh.faces)) == ("Field", 1 + 9 * 12)


def test_copies_on_vertices_take_the_place_of_their_pattern():
    """As Blender renders them: the child that is copied is only a pattern."""
    grid = add("grid", "Grid", "NONE", x_subdivisions=2, y_subdivisions=2, size=9)
    child = add("cube", "Child", size=1)
    child.parent, grid.instance_type = grid, "VERTS"
    found = bodies()
    assert list(found) == ["Child (Grid)"]
    assert volume(found["Child (Grid)"].mesh) == pytest.approx(9)
    grid.heliform.role = "BODY"
    assert list(bodies()) == ["Child (Grid)", "Grid"]
    grid.show_instancer_for_viewport = False
    assert list(bodies()) == ["Child (Grid)"]


def test_text_in_a_collection(scene):
    bpy.ops.object.text_add()
    text = bpy.context.object
    text.data.extrude, text.heliform.role = 0.1, "BODY"
    alone = volume(bodies()["Text"].mesh)
    instance(scene, "Sign", collected(scene, "Drawer", text), scale=(2, 2, 2))
    found = bodies()
    assert list(found) == ["Text (Sign)"]
    assert volume(found["Text (Sign)"].mesh) == pytest.approx(8 * alone, rel=1e-4)


def test_instances_without_a_face_are_no_bodies(scene):
    flat = add("cube", "Flat")
    empty = instance(scene, "None", collected(scene, "Drawer", flat), scale=(1, 0, 1))
    assert bodies() == {}
    empty.instance_collection = None
    empty.heliform.role, flat.heliform.role = "BODY", "NONE"
    with pytest.raises(SceneError, match="“None” has no faces"):
        bodies()


def test_units_and_normals_follow(scene, seen):
    scene.unit_settings.scale_length = 0.001
    ball = add("uv_sphere", "Ball", radius=50)
    bpy.ops.object.shade_smooth()
    instance(scene, "E", collected(scene, "D", ball), location=(1000, 0, 0), scale=(-1, 2, 1))
    (body,) = seen().bodies
    low, high = body.mesh.vertices.min(axis=0), body.mesh.vertices.max(axis=0)
    assert (low + high) / 2 == pytest.approx([1, 0, 0], abs=1e-6)
    assert high - low == pytest.approx([0.1, 0.2, 0.1], rel=0.01)
    middles = body.mesh.vertices[body.mesh.faces].mean(axis=1) - [1, 0, 0]
    assert (np.einsum("fci,fi->fc", body.mesh.normals, middles) > 0).all()
    assert np.linalg.norm(body.mesh.normals, axis=-1) == pytest.approx(1, abs=1e-5)


def test_receivers_and_lamps_cannot_be_instances(scene):
    bpy.ops.heliform.add_receiver()
    plane = bpy.context.object
    roof = add("cube", "Roof")
    instance(scene, "Storey", collected(scene, "Drawer", plane, roof))
    bpy.context.view_layer.update()
    (said,) = left_out(bpy.context.evaluated_depsgraph_get())
    assert said.startswith("Receiver “Receiver” is shown as an instance by “Storey”")
    assert "only bodies may be instances" in said
    assert list(bodies()) == ["Roof (Storey)"]


def test_a_study_of_sun_sees_them_and_says_so(scene):
    from heliform.addon.bridge.sun import gather
    from heliform.engines.sun import SUN_RADIATION

    bpy.ops.heliform.add_receiver()
    drawer = collected(scene, "Drawer", add("cube", "Roof"), add("plane", "Floor", "RECEIVER"))
    instance(scene, "Storey", drawer)
    given = gather(bpy.context, SUN_RADIATION)
    assert [body.name for body in given.scene.bodies] == ["Roof (Storey)"]
    assert any("only bodies may be instances" in note for note in given.notes)


def least_time():
    """Seconds that reading the bodies takes, and how many they are."""
    taken = []
    for _ in range(4):
        started = time.perf_counter()
        found = bodies()
        taken.append(time.perf_counter() - started)
    return min(taken), len(found)


def test_many_are_read_in_a_moment(scene, record_property):
    """500 instances cost less than 500 objects."""
    block = add("cube", "One").data
    for k in range(500):
        obj = bpy.data.objects.new(f"Plain {k:03}", block)
        obj.heliform.role = "BODY"
        scene.collection.objects.link(obj)
    plain, count = least_time()
    assert count == 501
    drawer = collected(scene, "Drawer", *scene.collection.objects)
    for obj in list(drawer.objects)[1:]:
        bpy.data.objects.remove(obj)
    for k in range(500):
        instance(scene, f"Copy {k:03}", drawer)
    copies, count = least_time()
    assert count == 500
    record_property("seconds", (plain, copies))
    assert copies < 2 * plain
