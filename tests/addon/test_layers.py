"""Layers: values on vertices, their colours, and what the legend and the marks say."""

import bpy
import numpy as np
import pytest
from heliform.addon.bridge import layers
from heliform.addon.bridge.layers import Layer, Mark
from heliform.engines.core.colour import ColourScale


@pytest.fixture
def cube(scene):
    bpy.ops.mesh.primitive_cube_add()
    return bpy.context.object


def layer(**more):
    scale = ColourScale(0.0, 7.0, log=False, palette="viridis", quantity="Speed", unit="mm/s")
    return Layer("Speed", scale, **more)


def read(block, name, key, width):
    found = np.empty((len(block.vertices), width), dtype=np.float32)
    block.attributes[name].data.foreach_get(key, found.ravel())
    return found


def test_a_layer_colours_each_vertex_as_its_legend_says(cube):
    values = np.arange(8.0)
    values[3] = np.nan
    layers.paint(cube, values, layer())
    evaluated = cube.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    np.testing.assert_array_equal(read(evaluated, layers.VALUES, "value", 1)[:, 0], values)
    colours = read(evaluated, layers.COLOURS, "color_srgb", 4)
    np.testing.assert_allclose(colours[:, :3], layer().scale.colours(values) / 255, atol=1e-6)
    assert evaluated.color_attributes.active_color.name == layers.COLOURS


def test_what_the_legend_says_survives_saving(cube, tmp_path):
    kept = layer(footing=["40 turns"], marks=[Mark((1.0, 2.0, 3.0), "worst: 1.2 ×")])
    layers.paint(cube, np.arange(8.0), kept)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "ä.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "ä.blend"))
    assert layers.layer_of(bpy.data.objects["Cube"]) == kept


def test_a_layer_survives_modifiers_and_another_one_replaces_it(cube):
    layers.paint(cube, np.zeros(8), layer())
    cube.modifiers.new("", "SUBSURF")
    evaluated = cube.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert layers.COLOURS in evaluated.attributes
    layers.paint(cube, np.ones(8), layer(footing=["new"]))
    assert layers.layer_of(cube).footing == ["new"]
    assert sum(a.name.startswith("Heliform") for a in cube.data.attributes) == 2


def test_clearing_leaves_nothing(cube):
    before = set(cube.data.attributes.keys())
    layers.paint(cube, np.zeros(8), layer())
    layers.clear([cube])
    assert layers.layer_of(cube) is None
    assert set(cube.data.attributes.keys()) == before


def test_a_mesh_that_others_share_becomes_its_own(cube, scene):
    twin = bpy.data.objects.new("Twin", cube.data)
    scene.collection.objects.link(twin)
    layers.paint(cube, np.zeros(8), layer())
    assert layers.layer_of(cube)
    assert layers.layer_of(twin) is None
    assert layers.COLOURS not in twin.data.attributes


@pytest.fixture
def shading(cube):
    """The shading of a 3D view that a person has set to a MatCap in random colours."""
    screen = bpy.context.window_manager.windows[0].screen
    (area,) = (a for a in screen.areas if a.type == "VIEW_3D")
    found = area.spaces.active.shading
    found.type, found.light, found.color_type = "SOLID", "MATCAP", "RANDOM"
    return found


def test_views_show_again_what_they_did_before(cube, shading, scene):
    other = bpy.data.objects.new("Other", bpy.data.meshes.new("Other"))
    scene.collection.objects.link(other)
    for obj in (cube, other):
        layers.paint(obj, np.zeros(len(obj.data.vertices)), layer())
        layers.show_in_views(bpy.context)
    assert (shading.light, shading.color_type) == ("STUDIO", "VERTEX")
    layers.clear([cube])
    layers.restore_views(bpy.context)
    assert shading.color_type == "VERTEX"
    layers.clear([other])
    layers.restore_views(bpy.context)
    assert (shading.light, shading.color_type) == ("MATCAP", "RANDOM")


def test_what_a_person_chose_since_stays(cube, shading):
    layers.paint(cube, np.zeros(8), layer())
    layers.show_in_views(bpy.context)
    shading.color_type = "SINGLE"
    layers.clear([cube])
    layers.restore_views(bpy.context)
    assert (shading.light, shading.color_type) == ("STUDIO", "SINGLE")
