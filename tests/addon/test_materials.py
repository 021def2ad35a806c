"""Blender's materials, as light meets them."""

import math
import time

import bpy
import heliform
import numpy as np
import pytest
from heliform.addon.bridge.materials import read_material
from heliform.addon.properties import read
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Material
from heliform.panels.scene import body_used, material_hides

GREY = (0.5, 0.25, 1.0, 1.0)
GREY_LUMINANCE = 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722


@pytest.fixture
def cube(scene):
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    obj.data.materials.append(bpy.data.materials.new("Gold ä/1"))
    return obj


def tree_of(obj):
    return obj.material_slots[0].material.node_tree


def shader(obj, kind, *, socket="Surface", **inputs):
    """Give the object's material that node alone, with those inputs."""
    tree = tree_of(obj)
    if socket == "Surface":
        tree.nodes.clear()
        tree.nodes.new("ShaderNodeOutputMaterial")
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        node.inputs[name.replace("_", " ")].default_value = value
    tree.links.new(node.outputs[0], output.inputs[socket])
    return node


def feed(obj, node, name, kind):
    """Link a new node to an input of another."""
    tree = tree_of(obj)
    source = tree.nodes.new(f"ShaderNode{kind}")
    tree.links.new(source.outputs[0], node.inputs[name])
    return source


CASES = [
    ("BsdfGlass", {"IOR": 1.6, "Roughness": 0.3}, {"ior": 1.6, "roughness": 0.09}),
    ("BsdfRefraction", {"IOR": 1.33}, {"ior": 1.33}),
    (
        "BsdfPrincipled",
        {"Transmission_Weight": 1.0, "IOR": 1.45, "Roughness": 0.1},
        {"ior": 1.45, "roughness": 0.01},
    ),
    (
        "BsdfPrincipled",
        {"Metallic": 1.0, "Base_Color": GREY, "Roughness": 0.5},
        {"kind": "mirror", "reflectance": GREY_LUMINANCE, "roughness": 0.25},
    ),
    (
        "BsdfPrincipled",
        {"Base_Color": GREY, "Roughness": 0.0, "IOR": 1.5},
        {"kind": "plastic", "reflectance": GREY_LUMINANCE, "specularity": 0.04},
    ),
    (
        "BsdfPrincipled",
        {"Base_Color": GREY, "Roughness": 0.0, "Specular_IOR_Level": 1.0},
        {"kind": "plastic", "reflectance": GREY_LUMINANCE, "specularity": 0.08},
    ),
    (
        "BsdfPrincipled",
        {"Base_Color": GREY, "Roughness": 0.3},
        {"kind": "diffuse", "reflectance": GREY_LUMINANCE},
    ),
    (
        "BsdfPrincipled",
        {"Base_Color": GREY, "Roughness": 0.0, "Specular_IOR_Level": 0.0},
        {"kind": "diffuse", "reflectance": GREY_LUMINANCE},
    ),
    ("BsdfDiffuse", {"Color": GREY}, {"kind": "diffuse", "reflectance": GREY_LUMINANCE}),
    (
        "BsdfAnisotropic",
        {"Color": GREY, "Roughness": 0.2},
        {"kind": "mirror", "reflectance": GREY_LUMINANCE, "roughness": 0.04},
    ),
    (
        "BsdfMetallic",
        {"Base_Color": GREY, "Roughness": 0.2},
        {"kind": "mirror", "reflectance": GREY_LUMINANCE, "roughness": 0.04},
    ),
]


@pytest.mark.parametrize(("kind", "inputs", "meant"), CASES)
def test_a_shader_is_read(cube, kind, inputs, meant):
    shader(cube, kind, **inputs)
    found = read_material(cube).material
    meant = Material(**meant)
    assert found.kind == meant.kind
    for name in ("ior", "reflectance", "specularity", "roughness", "absorption"):
        assert getattr(found, name) == pytest.approx(getattr(meant, name), rel=1e-6), name


def test_a_conductor_reflects_what_its_indices_say(cube):
    node = shader(cube, "BsdfMetallic")
    node.fresnel_type = "PHYSICAL_CONDUCTOR"
    node.inputs["IOR"].default_value = (0.2, 0.2, 0.2)
    node.inputs["Extinction"].default_value = (3.0, 3.0, 3.0)
    meant = (0.8**2 + 9) / (1.2**2 + 9)
    assert read_material(cube).material.reflectance == pytest.approx(meant, rel=1e-6)


@pytest.mark.parametrize("scale", [1.0, 0.001])
def test_absorption_is_that_of_the_volume_in_metres(cube, scale):
    shader(cube, "BsdfGlass")
    shader(cube, "VolumeAbsorption", socket="Volume", Color=(0.8, 0.8, 0.8, 1), Density=3.0)
    assert read_material(cube, scale).material.absorption == pytest.approx(0.6 / scale, rel=1e-6)


def test_cycles_agrees_about_absorption_and_the_colour_of_a_surface(scene, cube):
    """Through a slab of index 1 without reflection, what is left is exp(−absorption × path)."""
    shader(cube, "BsdfRefraction", IOR=1.0)
    shader(cube, "VolumeAbsorption", socket="Volume", Color=(0.3, 0.3, 0.3, 1), Density=0.5)
    scene.world = bpy.data.worlds.new("White")
    background = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (1, 1, 1, 1)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location.z, camera.data.type, camera.data.ortho_scale = 5.0, "ORTHO", 0.1
    scene.collection.objects.link(camera)
    scene.camera = camera
    pixel = rendered(scene)
    assert pixel == pytest.approx(math.exp(-2 * read_material(cube).material.absorption), rel=0.01)


def rendered(scene):
    """The mean radiance that Cycles sees."""
    scene.render.engine, scene.cycles.samples = "CYCLES", 32
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = 8
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.filepath = f"{bpy.app.tempdir}heliform.exr"
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    return np.array(image.pixels).reshape(-1, 4)[:, :3].mean()


REFUSED = [
    ("MixShader", {}, r"mixes shaders \(Mix Shader\)"),
    ("AddShader", {}, r"mixes shaders \(Add Shader\)"),
    ("BsdfTransparent", {}, "straight through"),
    ("Emission", {}, "only shines"),
    ("BsdfToon", {}, r"not read \(Toon BSDF\)"),
    ("BsdfGlass", {"IOR": 0.7}, "index of refraction of 0.7, but allowed is 1 to 4"),
    ("BsdfPrincipled", {"Alpha": 0.4}, r"Alpha 0\.4"),
    ("BsdfPrincipled", {"Emission_Strength": 2.0}, "Emission Strength 2"),
    ("BsdfPrincipled", {"Transmission_Weight": 1.0, "Thin_Wall": True}, "Thin Wall"),
]


@pytest.mark.parametrize(("kind", "inputs", "said"), REFUSED)
def test_what_is_not_understood_is_said_with_the_remedy(cube, kind, inputs, said):
    shader(cube, kind, **inputs)
    with pytest.raises(SceneError, match=said) as raised:
        read_material(cube)
    text = str(raised.value)
    assert text.startswith("The Blender material “Gold ä/1” of “Cube” ")
    assert text.endswith("; set the material in Heliform › Object.")


def test_a_texture_and_a_bump_are_said(cube):
    node = shader(cube, "BsdfDiffuse")
    feed(cube, node, "Normal", "Bump")
    with pytest.raises(SceneError, match=r"takes its Normal from another node \(Bump\)"):
        read_material(cube)
    node = shader(cube, "BsdfDiffuse")
    feed(cube, node, "Color", "TexNoise")
    with pytest.raises(SceneError, match=r"takes its Color from another node \(Noise Texture\)"):
        read_material(cube)


def test_a_volume_that_is_no_absorption_is_said(cube):
    shader(cube, "BsdfGlass")
    shader(cube, "VolumeScatter", socket="Volume")
    with pytest.raises(SceneError, match=r"a volume that is not read \(Volume Scatter\)"):
        read_material(cube)
    shader(cube, "BsdfDiffuse")
    shader(cube, "VolumeScatter", socket="Volume")
    assert read_material(cube).notes == ("Left out: volume.",)


def test_a_muted_node_an_empty_slot_and_an_empty_tree_are_said(cube):
    shader(cube, "BsdfGlass").mute = True
    with pytest.raises(SceneError, match=r"muted node \(Glass BSDF\)"):
        read_material(cube)
    tree_of(cube).links.clear()
    with pytest.raises(SceneError, match="has no surface shader"):
        read_material(cube)
    tree_of(cube).nodes.clear()
    with pytest.raises(SceneError, match="has no output node"):
        read_material(cube)
    cube.material_slots[0].material = None
    with pytest.raises(SceneError, match="“Cube” has no Blender material; give it one, or set"):
        read_material(cube)


def test_constants_come_through_value_colour_and_reroute_nodes(cube):
    node = shader(cube, "BsdfGlass")
    tree = tree_of(cube)
    value = feed(cube, node, "IOR", "Value")
    value.outputs[0].default_value = 1.7
    reroute = tree.nodes.new("NodeReroute")
    tree.links.new(value.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], node.inputs["IOR"])
    feed(cube, node, "Color", "RGB").outputs[0].default_value = (1, 1, 1, 1)
    reading = read_material(cube)
    assert (reading.material.ior, reading.notes) == (1.7, ())


def test_the_active_output_counts(cube):
    shader(cube, "BsdfGlass")
    tree = tree_of(cube)
    other = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(tree.nodes.new("ShaderNodeBsdfDiffuse").outputs[0], other.inputs["Surface"])
    other.is_active_output = True
    assert read_material(cube).material.kind == "diffuse"


@pytest.mark.parametrize(
    ("kind", "inputs", "note"),
    [
        ("BsdfGlass", {"Color": GREY}, "surface's colour is left out"),
        ("BsdfRefraction", {}, "It reflects too"),
        ("BsdfRefraction", {"Roughness": 0.2}, "taken as GGX"),
        ("BsdfDiffuse", {"Roughness": 0.2}, "roughness is left out"),
        ("BsdfPrincipled", {"Metallic": 0.5}, "Metallic of 0.5 is taken as 1"),
        ("BsdfPrincipled", {"Metallic": 0.4}, "Metallic of 0.4 is taken as 0"),
        ("BsdfPrincipled", {"Transmission_Weight": 0.7}, "Transmission of 0.7 is taken as 1"),
        ("BsdfPrincipled", {"Roughness": 0.5}, "dull gloss"),
        ("BsdfPrincipled", {"Roughness": 0.2}, "taken as smooth"),
        (
            "BsdfPrincipled",
            {"Coat_Weight": 0.2, "Sheen_Weight": 1.0},
            "Left out: coat, sheen.",
        ),
    ],
)
def test_what_is_left_out_is_noted(cube, kind, inputs, note):
    shader(cube, kind, **inputs)
    assert note in " ".join(read_material(cube).notes)


def test_a_second_material_is_noted(cube):
    shader(cube, "BsdfGlass")
    cube.data.materials.append(bpy.data.materials.new("Second"))
    assert read_material(cube).notes == ("Only the first material is used.",)


def test_a_body_starts_with_the_blender_material_that_is_understood(cube, seen):
    shader(cube, "BsdfGlass", IOR=1.7)
    bpy.ops.heliform.mark_as(role="BODY")
    assert cube.heliform.material_from == "BLENDER"
    cube.heliform.material.priority = 3
    assert seen().bodies[0].material == Material(ior=1.7, priority=3)
    tree_of(cube).nodes["Glass BSDF"].inputs["IOR"].default_value = 1.4
    assert seen().bodies[0].material.ior == 1.4
    cube.heliform.material_from = "OWN"
    assert seen().bodies[0].material.ior == 1.5


@pytest.mark.parametrize("slot", ["none", "empty", "not understood"])
def test_a_body_without_a_material_to_go_by_is_matte(cube, seen, slot):
    """As Blender draws it; glass is what somebody says is glass."""
    if slot == "not understood":
        shader(cube, "MixShader")
    else:
        cube.data.materials.clear()
    if slot == "empty":
        cube.data.materials.append(None)
    bpy.ops.heliform.mark_as(role="BODY")
    assert cube.heliform.material_from == "OWN"
    assert seen().bodies[0].material == Material(kind="diffuse", reflectance=0.8)
    cube.heliform.material.kind = "dielectric"
    bpy.ops.heliform.mark_as(role="NONE")
    bpy.ops.heliform.mark_as(role="BODY")
    assert seen().bodies[0].material.kind == "dielectric"


def test_what_heliform_makes_of_glass_stays_glass(seen):
    bpy.ops.heliform.add_demo()
    bpy.ops.heliform.add_wall()
    for obj in bpy.data.objects:
        if obj.heliform.role == "BODY":
            obj.data.materials.clear()
            obj.select_set(True)
            for role in ("BODY", "NONE", "BODY"):
                with bpy.context.temp_override(selected_objects=[obj]):
                    bpy.ops.heliform.mark_as(role=role)
    assert [body.material.kind for body in seen().bodies] == ["dielectric"] * 2


def test_a_body_keeps_heliforms_settings_otherwise(cube, seen):
    shader(cube, "MixShader")
    bpy.ops.heliform.mark_as(role="BODY")
    assert cube.heliform.material_from == "OWN"
    shader(cube, "BsdfGlass")
    bpy.ops.heliform.mark_as(role="BODY")  # a body already
    assert cube.heliform.material_from == "OWN"
    bpy.ops.heliform.mark_as(role="NONE")
    bpy.ops.heliform.mark_as(role="BODY", kind="mirror")
    assert (cube.heliform.material_from, cube.heliform.material.kind) == ("OWN", "mirror")
    bpy.ops.heliform.mark_as(role="NONE")
    bpy.ops.heliform.mark_as(role="BODY")  # somebody has chosen
    assert (cube.heliform.material_from, cube.heliform.material.kind) == ("OWN", "mirror")
    bpy.ops.heliform.add_glass_object(preset="custom", faces=12_000)
    bpy.ops.heliform.mark_as(role="BODY")
    assert bpy.context.object.heliform.material_from == "OWN"
    assert [body.material.kind for body in seen().bodies] == ["mirror", "dielectric"]


def test_a_trace_says_what_is_not_understood(cube, seen):
    bpy.ops.heliform.mark_as(role="BODY")
    shader(cube, "BsdfTransparent")
    assert cube.heliform.material_from == "BLENDER"
    with pytest.raises(SceneError, match="“Gold ä/1” of “Cube” lets light straight through"):
        seen()


def test_the_panel_says_what_is_used(cube):
    node = shader(cube, "BsdfGlass", IOR=1.52, Roughness=0.3)
    shader(cube, "VolumeAbsorption", socket="Volume", Color=(0, 0, 0, 1), Density=4.0)
    cube.heliform.role, cube.heliform.material_from = "BODY", "BLENDER"
    rows, notes, problem = body_used(cube, 1.0)
    assert dict(rows) == {
        "Source": "Gold ä/1 (Glass BSDF)",
        "Kind": "Clear glass",
        "Index": "1.52",
        "Over 10 mm": "96.1 % passes",
        "Roughness": "GGX α 0.09",
    }
    assert (notes, problem) == ((), "")
    node.inputs["IOR"].default_value = 1.6
    assert ("Index", "1.6") in body_used(cube, 1.0)[0]
    feed(cube, node, "IOR", "TexNoise")
    rows, _, problem = body_used(cube, 1.0)
    assert rows == []
    assert "takes its IOR from another node" in problem
    cube.heliform.material_from = "OWN"
    assert body_used(cube, 1.0)[0][0] == ("Source", "Heliform settings")


def test_reading_is_quick_enough_to_draw(cube, record_property):
    started = time.perf_counter()
    for _ in range(100):
        body_used(cube, 1.0)
        read_material(cube)
    each = (time.perf_counter() - started) / 100
    record_property("seconds", each)
    assert each < 0.005


def test_the_panel_hides_what_says_nothing(cube):
    material = cube.heliform.material
    assert material_hides(material) == {"reflectance", "specularity"}
    material.glass = "soda-lime"
    assert "abbe" in material_hides(material)
    for kind in ("mirror", "diffuse", "plastic", "absorber"):
        material.kind = kind
        assert {"absorption", "glass", "abbe", "priority"} < material_hides(material)
        assert ("roughness" in material_hides(material)) == (kind != "mirror")


def test_the_choice_survives_undo_saving_and_registration(cube, tmp_path):
    shader(cube, "BsdfGlass", IOR=1.7)
    bpy.ops.ed.undo_push(message="Before")
    bpy.ops.heliform.mark_as(role="BODY")
    bpy.ops.ed.undo_push(message="Marked")
    assert bpy.data.objects["Cube"].heliform.material_from == "BLENDER"
    bpy.ops.ed.undo()
    own = bpy.data.objects["Cube"].heliform
    assert (own.role, own.material_from) == ("NONE", "OWN")
    bpy.ops.ed.redo()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    heliform.unregister()
    heliform.register()
    obj = bpy.data.objects["Cube"]
    assert (obj.heliform.role, obj.heliform.material_from) == ("BODY", "BLENDER")
    assert read(obj.heliform.material, Material) == Material()
    assert read_material(obj).material.ior == 1.7


def test_a_preset_sets_the_bodies_that_are_selected(cube, scene, seen):
    bpy.ops.heliform.mark_as(role="BODY", kind="mirror")
    cube.heliform.material.priority = 4
    cube.heliform.material_from = "BLENDER"
    bpy.ops.heliform.add_receiver()
    plane = bpy.context.object
    cube.select_set(True)
    assert bpy.ops.heliform.set_material(preset="double-low-e") == {"FINISHED"}
    (body,) = seen().bodies
    assert body.material == Material(ior=1.52, transmittance=0.745, priority=4)
    assert plane.heliform.role == "RECEIVER"
    rows = dict(body_used(cube, 1.0)[0])
    assert rows["Straight on"] == "74.5 % passes"
    assert {"absorption"} <= material_hides(cube.heliform.material)
    bpy.ops.heliform.set_material(preset="concrete")
    assert seen().bodies[0].material == Material(kind="diffuse", reflectance=0.3, priority=4)


def test_a_preset_can_be_undone_and_needs_a_body(cube):
    assert not bpy.ops.heliform.set_material.poll()
    bpy.ops.heliform.mark_as(role="BODY")
    bpy.ops.ed.undo_push(message="Marked")
    bpy.ops.heliform.set_material(preset="wall")
    bpy.ops.ed.undo_push(message="Wall")
    assert bpy.data.objects["Cube"].heliform.material.reflectance == pytest.approx(0.5)
    bpy.ops.ed.undo()
    assert bpy.data.objects["Cube"].heliform.material.reflectance == pytest.approx(0.8)


def test_the_menu_has_every_preset_with_its_source():
    from heliform.engines.core.material_presets import material_presets

    items = bpy.ops.heliform.set_material.get_rna_type().properties["preset"].enum_items
    assert [item.identifier for item in items] == list(material_presets())
    for item in items:
        assert material_presets()[item.identifier].source in item.description
