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
