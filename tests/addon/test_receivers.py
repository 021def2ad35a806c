"""Receivers of any mesh: read with their UV map or given one, and values at their vertices."""

import bpy
import numpy as np
import pytest
from heliform.addon.bridge import results, stage
from heliform.addon.bridge.receivers import LAYER, unwrap_receivers
from heliform.engines.core import atlas
from heliform.engines.core.colour import Display
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Receiver, Surface
from heliform.engines.light.irradiance import MAPS, Irradiance, IrradianceMap
from mathutils import Matrix


def without_map(obj):
    while obj.data.uv_layers:
        obj.data.uv_layers.remove(obj.data.uv_layers[0])
    obj.data.update()


def add(kind, marked=True, **options):
    """One of Blender's own meshes without a UV map, as a receiver."""
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**options)
    obj = bpy.context.object
    without_map(obj)
    if marked:
        assert bpy.ops.heliform.mark_as(role="RECEIVER") == {"FINISHED"}
    return obj


def area(surface):
    a, b, c = surface.mesh.vertices[surface.mesh.faces].transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def layer_of(obj):
    """The UVs of each corner (C, 2)."""
    uv = np.empty((len(obj.data.loops), 2), dtype=np.float32)
    obj.data.uv_layers.active.uv.foreach_get("vector", uv.ravel())
    return uv


def test_a_mesh_with_a_uv_map_is_a_surface_of_the_world(scene, seen):
    scene.unit_settings.scale_length = 0.001
    bpy.ops.mesh.primitive_cube_add(size=2000)
    obj = bpy.context.object
    obj.matrix_world = Matrix.LocRotScale((500, 0, 0), Matrix.Rotation(0.3, 3, "X"), (1, 0.5, -1))
    obj.heliform.plane.sides, obj.heliform.plane.reflectance = "both", 0.25
    obj.heliform.plane.resolution = 64
    bpy.ops.heliform.mark_as(role="RECEIVER")
    (found,) = seen().receivers
    assert isinstance(found, Surface)
    assert (found.columns, found.rows, found.sides, found.reflectance) == (64, 64, "both", 0.25)
    assert area(found) == pytest.approx(2 * 4 + 4 * 2, rel=1e-5)
    atlas.require_chart(found)
    # Mirrored, its faces still look outward, and each corner kept its place in the map.
    corners = found.mesh.vertices[found.mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((corners.mean(axis=1) - [0.5, 0, 0]) * normal).sum(axis=1).min() > 0
    loops = [loop.vertex_index for loop in obj.data.loops]
    there = np.array([obj.matrix_world @ obj.data.vertices[v].co for v in loops]) / 1000
    kept = np.concatenate([there, layer_of(obj)], axis=1)
    read = np.concatenate([corners.reshape(-1, 3), found.texture.reshape(-1, 2)], axis=1)
    assert np.abs(read[:, None] - kept).max(axis=-1).min(axis=1).max() < 1e-5


def test_modifiers_count_and_carry_the_map(seen):
    bpy.ops.mesh.primitive_cube_add(size=1)
    bpy.ops.heliform.mark_as(role="RECEIVER")
    bpy.context.object.modifiers.new("Finer", "SUBSURF").subdivision_type = "SIMPLE"
    (found,) = seen().receivers
    assert len(found.mesh.faces) == 48
    assert area(found) == pytest.approx(6)
    atlas.require_chart(found)


@pytest.mark.parametrize("kind", ["uv_sphere", "cylinder", "cone", "torus", "monkey"])
def test_a_mesh_without_a_map_is_unwrapped_and_can_show_its_picture(seen, kind, capfd):
    obj = add(kind)
    assert f"“{obj.name}” had no UV map" in "".join(capfd.readouterr())
    assert obj.data.uv_layers.active.name == LAYER
    (found,) = seen().receivers
    atlas.require_chart(found)
    assert {tuple(uv) for uv in found.texture.reshape(-1, 2)} == {
        tuple(uv.astype(float)) for uv in layer_of(obj)
    }


def test_a_plane_without_a_map_stays_a_rectangle_and_gets_its_whole_picture(seen):
    obj = add("plane")
    assert isinstance(seen().receivers[0], Receiver)
    assert {tuple(uv) for uv in layer_of(obj)} == {(0, 0), (1, 0), (1, 1), (0, 1)}


def test_the_map_is_made_anew_where_the_mesh_or_the_resolution_changed(scene):
    obj = add("cylinder")
    obj.data.uv_layers.active.uv[0].vector = (0.123, 0.456)
    assert unwrap_receivers(bpy.context) == []
    assert layer_of(obj)[0] == pytest.approx([0.123, 0.456])  # by hand, and left alone
    obj.heliform.plane.resolution = 64
    assert len(unwrap_receivers(bpy.context)) == 1
    assert layer_of(obj)[0] != pytest.approx([0.123, 0.456])
    obj.data.vertices[0].co.z += 0.5
    obj.data.update()
    assert len(unwrap_receivers(bpy.context)) == 1
    assert [layer.name for layer in obj.data.uv_layers] == [LAYER]


def test_a_map_of_the_users_own_is_never_touched(scene):
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    before = layer_of(obj)
    bpy.ops.heliform.mark_as(role="RECEIVER")
    obj.heliform.plane.resolution = 32
    assert unwrap_receivers(bpy.context) == []
    np.testing.assert_array_equal(layer_of(obj), before)


def test_linked_copies_of_other_resolutions_each_get_a_map_of_their_own(seen):
    obj = add("cylinder")
    copy = obj.copy()
    bpy.context.collection.objects.link(copy)
    copy.heliform.plane.resolution = 32
    unwrap_receivers(bpy.context)
    assert copy.data != obj.data
    assert [r.columns for r in seen().receivers] == [256, 32]
    assert unwrap_receivers(bpy.context) == []


def test_what_cannot_be_unwrapped_is_said_with_the_remedy(seen):
    obj = add("cylinder", marked=False)
    array = obj.modifiers.new("Array", "ARRAY")
    with pytest.raises(RuntimeError, match="“Cylinder” has no UV map, and its modifiers"):
        bpy.ops.heliform.mark_as(role="RECEIVER")
    assert not obj.data.uv_layers
    obj.modifiers.remove(array)
    obj.modifiers.new("Bend", "SIMPLE_DEFORM").angle = 0.5
    bpy.ops.heliform.mark_as(role="RECEIVER")
    atlas.require_chart(seen().receivers[0])


def test_a_receiver_being_edited_is_said():
    obj = add("cylinder", marked=False)
    obj.heliform.role = "RECEIVER"
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(SceneError, match="“Cylinder” has no UV map; leave Edit Mode"):
        unwrap_receivers(bpy.context)
    bpy.ops.object.mode_set(mode="OBJECT")


def test_a_receiver_without_faces_or_area_is_said(seen):
    obj = add("cylinder", marked=False)
    obj.heliform.role = "RECEIVER"
    obj.data.vertices.foreach_set("co", [0.0] * 3 * len(obj.data.vertices))
    obj.data.update()
    with pytest.raises(SceneError, match="Receiver “Cylinder”: A surface without area"):
        unwrap_receivers(bpy.context)
    obj.data.clear_geometry()
    obj.data.update()
    with pytest.raises(SceneError, match="“Cylinder” has no faces"):
        unwrap_receivers(bpy.context)


def test_faces_without_area_do_not_matter(seen):
    block = bpy.data.meshes.new("Folded")
    points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 1), (0, 1, 1)]
    block.from_pydata(points, [], [(0, 1, 2, 3, 4), (0, 1, 2)])
    obj = bpy.data.objects.new("Folded", block)
    bpy.context.collection.objects.link(obj)
    obj.heliform.role = "RECEIVER"
    unwrap_receivers(bpy.context)
    (found,) = seen().receivers
    atlas.require_chart(found)
    assert area(found) == pytest.approx(2 * 2**0.5)


@pytest.fixture
def traced(scene, seen):
    """An unwrapped sphere with a picture of its height as illuminance."""
    obj = add("uv_sphere", radius=0.5)
    obj.heliform.plane.resolution = 128
    unwrap_receivers(bpy.context)
    (surface,) = seen().receivers
    found = atlas.texels(surface)
    meta = {"receiver": obj.name, "unit": "lx", "error": None, "size": [128.0, 128.0]}
    meta |= {"mean_half_width": 1.0, "traced_half_width": 1.0}
    maps = dict.fromkeys(MAPS, np.zeros(found.area.shape, np.float32))
    height = np.where(found.inside, found.place[..., 2] + 1, 0).astype(np.float32)
    maps |= {"area": found.area.astype(np.float32), "illuminance": height}
    one = IrradianceMap(**maps, meta=meta)
    given = Irradiance((one,), meta)
    (scene.heliform.shown,) = stage.stage_irradiance(scene, {obj.name: obj}, given, Display())
    return obj


def test_values_at_vertices_are_those_of_the_map_there(traced):
    assert bpy.ops.heliform.values_to_vertices() == {"FINISHED"}
    attribute = traced.data.attributes["illuminance"]
    assert (attribute.data_type, attribute.domain) == ("FLOAT", "POINT")
    values = np.array([item.value for item in attribute.data])
    height = np.array([vertex.co.z for vertex in traced.data.vertices]) + 1
    assert values == pytest.approx(height, abs=0.05)


def test_values_at_vertices_are_not_those_of_a_mesh_that_has_changed(traced):
    traced.modifiers.new("Finer", "SUBSURF").subdivision_type = "SIMPLE"
    with pytest.raises(RuntimeError, match="modifiers of “Sphere” make other vertices"):
        bpy.ops.heliform.values_to_vertices()
    traced.modifiers.clear()
    traced.scale.x = 2
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="“Sphere” has changed since"):
        bpy.ops.heliform.values_to_vertices()


def test_a_mesh_has_no_section(traced, scene):
    assert not bpy.ops.heliform.section.poll()
    assert not bpy.ops.heliform.add_section_line.poll()


def test_the_picture_of_a_mesh_is_grey_where_it_is_none_and_goes_on_beyond_its_charts(
    traced, scene
):
    picture = scene.heliform.shown
    pixels = np.empty(len(picture.pixels), dtype=np.float32)
    picture.pixels.foreach_get(pixels)
    colours = np.round(255 * pixels.reshape(128, 128, 4)[..., :3])
    result = results.staged(picture)
    scale = results.legend_of(picture)
    np.testing.assert_array_equal(
        colours[result.inside], scale.colours(result.illuminance[result.inside])
    )
    grey = (colours == 150).all(axis=-1)
    assert not grey[result.inside].any()
    beside = ~result.inside & (
        np.roll(result.inside, 1, axis=0) | np.roll(result.inside, 1, axis=1)
    )
    assert not grey[beside].any()
    assert grey.any()
