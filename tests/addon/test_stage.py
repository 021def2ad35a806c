"""Results as images: colours, maps, sections, and the legend over the view."""

from types import SimpleNamespace

import bpy
import gpu
import numpy as np
import pytest
from heliform.addon import overlays
from heliform.addon.bridge import results, sections, showing, stage
from heliform.engines.core.colour import Display
from heliform.engines.core.picture import toned, white_of
from heliform.engines.light.irradiance import MAPS, Irradiance, IrradianceMap
from mathutils import Matrix


@pytest.fixture
def result(tmp_path):
    """A ramp of 8 × 6 texels with everything that a tracing says of itself."""
    ramp = np.add.outer(100.0 * np.arange(6), np.arange(8)).astype(np.float32) + 1
    meta = {
        "quantity": "Illuminance",
        "unit": "lx",
        "receiver": "Vase ä/1",
        "size": [0.8, 0.6],
        "error": 0.24,
        "mean_half_width": 1.5,
        "traced_half_width": 1.5,
        "photons": {"emitted": 22_000_000, "landed": 7_000_000},
        "flux": dict.fromkeys(("emitted", "landed", "absorbed", "escaped", "cut_off"), 1.0),
        "seconds": 1.0,
        "notes": [],
        "folder": str(tmp_path),
    }
    maps = {name: ramp * (1 + i) for i, name in enumerate(MAPS)}
    return IrradianceMap(**maps | {"area": np.full_like(ramp, 0.01)}, meta=meta)


@pytest.fixture
def picture(scene, result):
    bpy.ops.heliform.add_receiver(width=0.8, length=0.6)
    bpy.context.object.name = "Vase ä/1"
    (scene.heliform.shown,) = staged(scene, bpy.context.object, result)
    return scene.heliform.shown


def staged(scene, receiver, *maps):
    receivers = {maps[0].meta["receiver"]: receiver}
    return stage.stage_irradiance(scene, receivers, Irradiance(maps, maps[0].meta), Display())


def colours(image):
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    return np.round(pixels.reshape(image.size[1], image.size[0], 4)[..., :3] * 255)


def test_the_picture_has_the_colours_of_its_legend(picture, result):
    scale = results.legend_of(picture)
    np.testing.assert_array_equal(colours(picture), scale.colours(result.illuminance))
    assert scale.unit == "lx"
    assert picture.packed_file


def test_recolour_follows_the_display_and_the_map(picture, result, scene):
    display = scene.heliform.display
    display.palette, display.log = "radiance", True
    bpy.ops.heliform.recolour()
    picture.heliform_map = "caustic"
    scale = results.legend_of(picture)
    assert (scale.palette, scale.log, scale.quantity) == ("radiance", True, "Caustic light")
    np.testing.assert_array_equal(colours(picture), scale.colours(result.caustic))


def test_a_range_that_is_none_is_a_sentence_and_keeps_the_picture(picture, scene):
    before = colours(picture)
    display = scene.heliform.display
    display.automatic, display.low, display.high = False, 10.0, 5.0
    with pytest.raises(RuntimeError, match="low end below its high end"):
        bpy.ops.heliform.recolour()
    picture.heliform_map = "direct"
    assert "low end below its high end" in showing.problem_of(picture)
    np.testing.assert_array_equal(colours(picture), before)


def test_a_copied_receiver_is_another_one(picture, result, scene):
    receiver = results.owner_of(picture)
    copy = receiver.copy()
    bpy.context.collection.objects.link(copy)
    (other,) = staged(scene, copy, result)
    assert other != picture
    assert receiver.material_slots[0].material != copy.material_slots[0].material


def test_the_section_crosses_the_middle(picture, result, tmp_path):
    bpy.ops.heliform.section()
    kept = sections.section_of(picture)
    assert kept["illuminance"] == result.illuminance[3].tolist()
    assert (tmp_path / "section.csv").read_text(encoding="utf-8") in (
        bpy.data.texts["Vase ä/1 section.csv"].as_string(),
        bpy.data.texts["Vase ä/1 section.csv"].as_string() + "\n",
    )
    bpy.ops.heliform.clear_section()
    assert sections.section_of(picture) is None


def test_the_section_follows_a_moved_line(picture, result):
    bpy.ops.heliform.add_section_line()
    line = bpy.context.object
    line.rotation_euler.z = np.pi / 2
    line.location.x += 0.21
    bpy.context.view_layer.update()
    bpy.ops.heliform.section()
    kept = sections.section_of(picture)
    along = [value for value in kept["illuminance"] if value is not None]
    assert along[0] == result.illuminance[0, 6]
    assert along[-1] == result.illuminance[5, 6]


def test_values_that_were_deleted_are_missed_in_a_sentence(picture):
    bpy.data.images.remove(bpy.data.images["Vase ä/1 illuminance"])
    with pytest.raises(RuntimeError, match="are gone; trace photons again"):
        bpy.ops.heliform.recolour()


def pair(result, **changes):
    """Front and back of a receiver, the back half as bright."""
    maps = {name: getattr(result, name) for name in MAPS}
    half = {name: values / 2 for name, values in maps.items() if name != "area"}
    front = IrradianceMap(**maps | changes, meta=result.meta | {"side": "front"})
    back = IrradianceMap(**maps | half | changes, meta=result.meta | {"side": "back"})
    return front, back


def test_both_sides_have_a_picture_each_on_one_scale(picture, result, scene):
    receiver = results.owner_of(picture)
    front, back = staged(scene, receiver, *pair(result))
    assert [p.name for p in (front, back)] == [
        f"Vase ä/1 {side} false colour" for side in ("front", "back")
    ]
    assert results.legend_of(front) == results.legend_of(back)
    np.testing.assert_array_equal(
        colours(back), results.legend_of(back).colours(result.illuminance / 2)
    )
    assert results.results_of(scene) == [front, back]  # what was on no side is gone
    (material,) = {slot.material for slot in receiver.material_slots}
    nodes = material.node_tree.nodes
    assert {n.image for n in nodes if n.type == "TEX_IMAGE"} >= {front, back}
    assert any(n.type == "NEW_GEOMETRY" and n.outputs["Backfacing"].is_linked for n in nodes)
    scene.heliform.shown = front
    bpy.ops.heliform.show_result(name=back.name)
    assert scene.heliform.shown == back
    assert nodes.active.image == back
    (alone,) = staged(scene, receiver, result)
    assert results.results_of(scene) == [alone]
    assert not any(n.type == "NEW_GEOMETRY" for n in material.node_tree.nodes)


def test_the_chosen_map_is_that_of_all_receivers(picture, result, scene):
    bpy.ops.heliform.add_receiver()
    other = bpy.context.object
    (second,) = staged(scene, other, result)
    picture.heliform_map = "indirect"
    assert second.heliform_map == "indirect"
    assert results.legend_of(second).quantity == "Scattered light"
    (second,) = staged(scene, other, result)
    assert second.heliform_map == "indirect"


def test_only_what_is_there_is_offered(picture, result, scene):
    receiver = results.owner_of(picture)
    picture.heliform_map = "colour"
    none = {name: np.zeros_like(result.red) for name in ("red", "green", "blue", "smooth_bias")}
    bare = IrradianceMap(**{name: getattr(result, name) for name in MAPS} | none, meta=result.meta)
    (picture,) = staged(scene, receiver, bare)
    assert picture.heliform_map == "illuminance"
    for name in ("colour", "smooth", "smooth_bias"):
        with pytest.raises(TypeError, match="not found"):
            picture.heliform_map = name
    assert "Vase ä/1 colour" not in bpy.data.images
    assert not results.staged(picture).red.any()


def test_the_colour_is_shown_as_in_the_report(picture, result, scene):
    picture.heliform_map = "colour"
    light = np.stack([result.red, result.green, result.blue], axis=-1)
    np.testing.assert_array_equal(colours(picture), toned(light, white_of(light)))
    assert results.legend_of(picture) is None
    bpy.ops.heliform.section()
    assert len(np.unique(drawn(scene).reshape(-1, 3), axis=0)) > 1


class Region:
    width, height, x, y = 1000, 700, 0, 0


PIXELS = Matrix.Translation((-1, -1, 0)) @ Matrix.Diagonal(
    (2 / Region.width, 2 / Region.height, 1, 1)
)


class Context:
    """A view without sidebar or headers."""

    area = space_data = object = None
    region = Region
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))  # 0 without a window

    def __init__(self, scene):
        self.scene = scene


def drawn(scene):
    """The overlay on grey, (700, 1000, 3) from the bottom up."""
    gpu.init()
    screen = gpu.types.GPUOffScreen(Region.width, Region.height, format="RGBA16F")
    try:
        with screen.bind(), gpu.matrix.push_pop():
            gpu.matrix.load_matrix(Matrix.Identity(4))
            gpu.matrix.load_projection_matrix(PIXELS)
            framebuffer = gpu.state.active_framebuffer_get()
            framebuffer.clear(color=(0.5, 0.5, 0.5, 1.0))
            overlays.draw(Context(scene))
            read = framebuffer.read_color(0, 0, Region.width, Region.height, 4, 0, "FLOAT")
    finally:
        screen.free()
    return np.round(255 * np.array(read.to_list())[..., :3])


def test_the_legend_and_the_section_are_drawn(picture, scene):
    bpy.ops.heliform.section()
    view = drawn(scene)
    table = results.legend_of(picture).table().astype(int)
    for colour in (table[5], table[128], table[250]):
        assert (np.abs(view - colour).max(axis=-1) <= 2).any()
    band = (44, 69, 82)  # a quarter of it over the card over grey
    assert (np.abs(view - band).max(axis=-1) <= 2).sum() > 1000
    assert len(np.unique(view[300:, :800].reshape(-1, 3), axis=0)) == 1  # the rest is left alone


def test_without_the_legend_nothing_is_drawn(picture, scene):
    scene.heliform.legend = False
    assert len(np.unique(drawn(scene).reshape(-1, 3), axis=0)) == 1
