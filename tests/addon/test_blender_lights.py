"""Blender's own lights, as luminaires."""

import math

import bpy
import numpy as np
import pytest
from heliform.addon.bridge.lights import read_light
from heliform.engines.core.errors import SceneError
from heliform.panels.scene import light_used
from mathutils import Matrix

WHITE = 179.0
"""lm in a watt of white light, as Radiance has it."""


@pytest.fixture
def light(scene):
    """Adds a light of a kind, as a lamp."""

    def added(kind, **settings):
        block = bpy.data.lights.new(kind.capitalize(), kind)
        block.shadow_soft_size = 0.0
        for name, value in settings.items():
            setattr(block, name, value)
        obj = bpy.data.objects.new(block.name, block)
        scene.collection.objects.link(obj)
        obj.heliform.role = "LAMP"
        return obj

    return added


def emission(obj):
    return next(n for n in obj.data.node_tree.nodes if n.type == "EMISSION")


def add_receiver(**settings):
    bpy.ops.heliform.add_receiver(**settings)
    bpy.context.object.location.z = 0
    return bpy.context.object


# What a light is


def test_a_light_without_the_role_is_not_seen(light, seen):
    light("POINT").heliform.role = "NONE"
    light("SPOT").heliform.role = "NONE"
    assert seen().luminaires == ()


def test_a_point(light, seen):
    obj = light("POINT", energy=10.0)
    obj.location = 1, 2, 3
    found = seen().luminaires[0]
    assert (found.name, found.lamp.source, found.lamp.flux) == ("Point", "point", 10 * WHITE)
    assert found.pose[:3, 3] == pytest.approx([1, 2, 3])
    assert read_light(obj).notes == ()
    obj.data.shadow_soft_size = 0.1
    assert read_light(obj).notes == ("Its ball of 100 mm radius is taken as a point.",)


@pytest.mark.parametrize(
    ("shape", "opening", "width", "length"),
    [
        ("DISK", "round", 0.2, 0.2),
        ("SQUARE", "rectangular", 0.2, 0.2),
        ("RECTANGLE", "rectangular", 0.5, 0.2),
    ],
)
def test_an_area(light, seen, shape, opening, width, length):
    light("AREA", energy=2.0, shape=shape, size=0.2, size_y=0.5)
    lamp = seen().luminaires[0].lamp
    assert (lamp.source, lamp.opening, lamp.flux) == ("disk", opening, 2 * WHITE)
    assert (lamp.width, lamp.length) == (width, length)


def test_an_area_is_scaled_and_in_metres(scene, light, seen):
    scene.unit_settings.scale_length = 0.001
    obj = light("AREA", shape="RECTANGLE", size=200, size_y=500)
    obj.matrix_world = Matrix.LocRotScale((0, 0, 1000), Matrix.Rotation(0.3, 3, "Y"), (2, 3, 4))
    found = seen().luminaires[0]
    assert (found.lamp.length, found.lamp.width) == pytest.approx((0.4, 1.5))
    assert found.pose[:3, 3] == pytest.approx([0, 0, 1])
    assert -found.pose[:3, 2] == pytest.approx([-math.sin(0.3), 0, -math.cos(0.3)], abs=1e-6)
    assert ("Opening", "400 × 1500 mm") in light_used(obj, 0.001)[0]
    obj.data.shape = "DISK"
    with pytest.raises(SceneError, match="“Area” is round and scaled"):
        seen()
    assert "is round and scaled" in light_used(obj, 0.001)[2]


def test_colour_temperature_exposure_and_nodes_count(light):
    obj = light("POINT", energy=10.0, color=(1.0, 0.5, 0.0), exposure=1.0)
    meant = 2 * 10 * WHITE * (0.2126 + 0.7152 * 0.5)
    assert read_light(obj).lamp.flux == pytest.approx(meant, rel=1e-6)
    emission(obj).inputs["Strength"].default_value = 3.0
    assert read_light(obj).lamp.flux == pytest.approx(3 * meant, rel=1e-6)
    warm = light("POINT", energy=10.0, use_temperature=True, temperature=2700.0)
    assert read_light(warm).lamp.flux == pytest.approx(10 * WHITE, rel=1e-3)


def test_the_efficacy_is_a_setting(light, seen):
    obj = light("POINT", energy=10.0)
    obj.heliform.blender_light.efficacy = 683.0
    assert seen().luminaires[0].lamp.flux == 6830


# The sun


def test_a_sun_is_a_beam_over_all_that_it_lights(light, seen):
    obj = light("SUN", energy=5.0, angle=0.0)
    obj.matrix_world = Matrix.LocRotScale((9, 9, -9), Matrix.Rotation(0.6, 3, "X"), (2, 3, 4))
    add_receiver(width=2.0, length=1.0)
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=(0.3, 0.2, 0.5))
    bpy.ops.heliform.mark_as(role="BODY")
    scene = seen()
    beam = scene.luminaires[0]
    lamp, axes = beam.lamp, beam.pose[:3, :3]
    assert (lamp.source, lamp.opening) == ("beam", "rectangular")
    assert lamp.flux / (lamp.width * lamp.length) == pytest.approx(5 * WHITE, rel=1e-6)
    assert axes == pytest.approx(np.array(Matrix.Rotation(0.6, 3, "X")), abs=1e-6)
    corners = [scene.receivers[0].origin + s * scene.receivers[0].u for s in (0, 1)]
    corners += [corner + scene.receivers[0].v for corner in corners]
    local = (np.vstack([corners, scene.bodies[0].mesh.vertices]) - beam.pose[:3, 3]) @ axes
    assert local[:, 2].max() < 0
    assert np.all(np.abs(local[:, :2]).max(axis=0) < [lamp.length / 2, lamp.width / 2])
    assert np.all(np.abs(local[:, :2]).max(axis=0) > 0.45 * np.array([lamp.length, lamp.width]))


def test_a_sun_without_anything_to_shine_on_is_said(light, seen):
    light("SUN")
    with pytest.raises(SceneError, match="“Sun” has nothing to shine on; add a body or a receiv"):
        seen()


def test_a_sun_gives_its_lux(light, seen):
    """Traced on a tilted plane: E = E₀ cos θ, and as much on every texel."""
    from heliform.engines.light import PhotonTracing, trace

    light("SUN", energy=1.0, angle=0.0)
    add_receiver(width=0.4, length=0.4, resolution=8).rotation_euler.x = 0.5
    result = trace(seen(), PhotonTracing(until="landed", landed=1000), seed=1)
    assert result.maps[0].illuminance == pytest.approx(WHITE * math.cos(0.5), rel=1e-3)


# What is not understood


@pytest.mark.parametrize(
    ("kind", "settings", "said"),
    [
        ("SPOT", {}, "is a Spot, .* add a Heliform lamp with an IES file instead"),
        ("AREA", {"shape": "ELLIPSE"}, "is an Ellipse, .*; make it a Disk or a Rectangle"),
        ("AREA", {"spread": 1.0}, "has a Spread of 57°, .*; set it to 180°"),
        ("AREA", {"normalize": False}, ".* tick Normalize"),
        ("POINT", {"energy": 0.0}, "gives no light; raise its Power"),
        ("SUN", {"color": (0, 0, 0)}, "gives no light"),
    ],
)
def test_what_is_no_lamp_is_said(light, seen, kind, settings, said):
    obj = light(kind, **settings)
    with pytest.raises(SceneError, match=f"Light “{kind.capitalize()}” {said}"):
        seen()
    assert light_used(obj, 1.0)[0] == []


def test_a_portal_and_nodes_are_said(light):
    obj = light("AREA")
    obj.data.cycles.is_portal = True
    with pytest.raises(SceneError, match="is a portal"):
        read_light(obj)
    obj = light("POINT")
    tree = obj.data.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeBlackbody").outputs[0], emission(obj).inputs["Color"])
    with pytest.raises(SceneError, match=r"takes its Color .*Blackbody.*; use a Heliform lamp"):
        read_light(obj)
    tree.links.clear()
    with pytest.raises(SceneError, match="nodes other than a plain Emission"):
        read_light(obj)


# The panel's buttons


def test_lights_are_marked_and_follow_live(light, seen):
    obj = light("POINT", energy=10.0)
    obj.heliform.role = "NONE"
    obj.select_set(True)
    bpy.ops.heliform.mark_light(role="LAMP")
    assert dict(light_used(obj, 1.0)[0]) == {
        "Source": "Blender Point light",
        "Flux": "1\u2009790 lm",
        "Opening": "A point",
        "Shines": "Alike in all directions",
    }
    obj.data.energy = 20.0
    assert ("Flux", "3\u2009580 lm") in light_used(obj, 1.0)[0]
    assert seen().luminaires[0].lamp.flux == 20 * WHITE
    obj.data.type = "SUN"
    obj.data.angle = 0.01
    rows, notes, _ = light_used(obj, 1.0)
    assert ("Illuminance", "3\u2009580 lx across its rays") in rows
    assert notes == ("Its angle of 0.57° is left out: all rays are parallel.",)
    bpy.ops.heliform.mark_light(role="NONE")
    assert seen().luminaires == ()


def test_meshes_are_left_alone(scene):
    bpy.ops.mesh.primitive_cube_add()
    assert not bpy.ops.heliform.mark_light.poll()


def test_a_role_is_undone(light):
    light("POINT").heliform.role = "NONE"
    bpy.data.objects["Point"].select_set(True)
    bpy.ops.ed.undo_push(message="Before")
    bpy.ops.heliform.mark_light(role="LAMP")
    bpy.ops.ed.undo_push(message="Marked")
    bpy.ops.ed.undo()
    assert bpy.data.objects["Point"].heliform.role == "NONE"


# What Blender's watts are


@pytest.mark.parametrize(
    ("kind", "settings"),
    [
        ("POINT", {"energy": 100.0}),
        ("POINT", {"energy": 100.0, "shadow_soft_size": 0.05, "exposure": -1.0}),
        ("POINT", {"energy": 100.0, "use_temperature": True, "temperature": 3000.0}),
        ("POINT", {"energy": 100.0, "color": (0.2, 0.9, 0.4)}),
        ("AREA", {"energy": 100.0, "shape": "DISK", "size": 0.05}),
        ("AREA", {"energy": 100.0, "shape": "RECTANGLE", "size": 0.05, "size_y": 0.1}),
        ("SUN", {"energy": 2.0, "angle": 0.001}),
    ],
)
def test_cycles_has_the_same_irradiance_under_it(scene, light, kind, settings):
    """A white wall 3 m below: Cycles' radiance × π is the illuminance ÷ efficacy."""
    obj = light(kind, **settings)
    obj.location.z = 3.0
    lamp = read_light(obj).lamp
    meant = {
        "point": lamp.flux / (4 * math.pi * 9),
        "disk": lamp.flux / (math.pi * 9),
        "beam": lamp.flux,
    }[lamp.source]
    assert WHITE * irradiance(scene) == pytest.approx(meant, rel=2e-3)


def irradiance(scene):
    """That of white light in W/m² which Cycles finds at the origin."""
    bpy.ops.mesh.primitive_plane_add(size=10)
    white = bpy.data.materials.new("White")
    tree = white.node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(diffuse.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    bpy.context.object.data.materials.append(white)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location.z, camera.data.type, camera.data.ortho_scale = 5.0, "ORTHO", 0.02
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.max_bounces = "CYCLES", 64, 0
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = f"{bpy.app.tempdir}heliform.exr"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    seen = np.array(image.pixels).reshape(-1, 4)[:, :3].mean(axis=0)
    return math.pi * float(seen @ [0.2126, 0.7152, 0.0722])
