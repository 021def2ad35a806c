"""Properties say and keep what the records do."""

import bpy
import heliform
import pytest
from heliform.addon.properties import enum_items, group_for, label_of, read, write
from heliform.engines.core.colour import Display
from heliform.engines.core.parameters import fields_of
from heliform.engines.core.scene import Lamp, Material, Plane
from heliform.engines.glass import TABLE_1, Bead, GlassObject
from heliform.engines.light import PhotonTracing
from heliform.engines.structure.catalogue import FAMILIES
from heliform.engines.structure.rules import Rules


@pytest.fixture
def holder():
    """An object, for its property groups."""
    return bpy.data.objects.new("Holder", bpy.data.meshes.new("Holder")).heliform


RECORDS = {
    "glass_object": [
        *TABLE_1.values(),
        GlassObject(width=0.1234567, bead=Bead(height=0.00123, sag=0.0, style="flat")),
    ],
    "material": [Material(kind="mirror", reflectance=0.04), Material(ior=1.516)],
    "lamp": [Lamp(source="disk", flux=1234.5, width=0.3), Lamp(file="//ä b/c.ies")],
    "plane": [Plane(width=12.34567, length=0.001, resolution=4096)],
    "photon_tracing": [
        PhotonTracing(until="landed", landed=200_000_000, seconds=0.1, repair=True),
        PhotonTracing(fresnel="polarised", error=0.005),
    ],
    "display": [Display(palette="radiance", log=True, low=0.3, high=12_000.0)],
}


@pytest.mark.parametrize("scale", [1.0, 0.001, 0.3048])
@pytest.mark.parametrize(
    ("name", "record"), [(name, record) for name, several in RECORDS.items() for record in several]
)
def test_a_record_comes_back_as_it_went_in(holder, scene, name, record, scale):
    group = getattr(holder, name, None) or getattr(scene.heliform, name)
    write(group, record, scale)
    assert read(group, type(record), scale) == record


@pytest.mark.parametrize("name", RECORDS)
def test_defaults_are_the_records(holder, scene, name):
    group = getattr(holder, name, None) or getattr(scene.heliform, name)
    record = type(RECORDS[name][0])
    assert read(group, record) == record()


@pytest.mark.parametrize("name", RECORDS)
def test_every_property_is_described(holder, scene, name):
    group = getattr(holder, name, None) or getattr(scene.heliform, name)
    for field in fields_of(type(RECORDS[name][0])):
        assert field.help
        assert group.bl_rna.properties[field.name].description.startswith(field.help)
        assert group.bl_rna.properties[field.name].name.startswith(label_of(field))


def test_lengths_are_lengths_and_bounds_are_told(holder):
    width = holder.glass_object.bl_rna.properties["width"]
    assert (width.subtype, width.unit) == ("DISTANCE", "LENGTH")
    assert width.soft_min == pytest.approx(0.02)
    assert "0.02 to 2 m" in width.description
    assert holder.lamp.bl_rna.properties["flux"].name == "Flux (lm)"
    assert holder.lamp.bl_rna.properties["file"].subtype == "FILE_PATH"
    assert holder.material.bl_rna.properties["ior"].hard_min == 1.0


def test_a_degree_is_kept_in_radians():
    from heliform.addon import properties
    from heliform.engines.core.parameters import Field

    field = Field("tilt", "float", 30.0, "deg", -90.0, 90.0, "Lean")
    options = properties._number(field)
    assert options["subtype"] == "ANGLE"
    assert options["max"] == pytest.approx(1.5707963)
    assert properties._read(field, 0.5235988, 1.0) == 30.0


def test_the_number_of_a_choice_does_not_depend_on_its_place():
    before = {item[0]: item[3] for item in enum_items(["ies", "disk", "beam"])}
    after = {item[0]: item[3] for item in enum_items(["point", "beam", "ies", "disk"])}
    assert before.items() <= after.items()


def test_a_group_is_made_once():
    assert group_for(Bead) is group_for(Bead, None)


def test_settings_survive_saving(holder, scene, tmp_path):
    owner = bpy.data.objects["Holder"]
    scene.collection.objects.link(owner)
    owner.heliform.role = "BODY"
    write(owner.heliform.glass_object, TABLE_1["three_bulges"])
    scene.heliform.seed = 7
    scene.heliform.photon_tracing.until = "time"
    path = str(tmp_path / "Ä b.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    own = bpy.data.objects["Holder"].heliform
    assert own.role == "BODY"
    assert read(own.glass_object, GlassObject) == TABLE_1["three_bulges"]
    assert bpy.context.scene.heliform.seed == 7
    assert bpy.context.scene.heliform.photon_tracing.until == "time"


def test_writing_does_not_update_but_setting_does(holder, scene, monkeypatch):
    from heliform.addon import model

    calls = []
    monkeypatch.setattr(model, "rebuild", lambda obj, scene: calls.append(obj.name))
    write(holder.glass_object, TABLE_1["tube"])
    assert calls == []
    holder.glass_object.bead.sag = 0.001
    assert calls == ["Holder"]


def test_registering_again_leaves_nothing_behind():
    def traces():
        types = [n for n in dir(bpy.types) if n.startswith("HELIFORM_")]
        return types, dir(bpy.ops.heliform), hasattr(bpy.types.Object, "heliform")

    before = traces()
    heliform.unregister()
    assert traces() == ([], [], False)
    assert not hasattr(bpy.types.Scene, "heliform")
    heliform.register()
    assert traces() == before


def test_a_failed_registration_is_taken_back(monkeypatch):
    from heliform.panels import glass

    def fail():
        raise RuntimeError("no")

    heliform.unregister()
    with monkeypatch.context() as patch:
        patch.setattr(glass, "register", fail)
        with pytest.raises(RuntimeError, match="no"):
            heliform.register()
    assert not hasattr(bpy.types.Object, "heliform")
    heliform.register()


def test_every_panel_is_in_the_one_place():
    panels = [getattr(bpy.types, n) for n in dir(bpy.types) if n.startswith("HELIFORM_PT_")]
    assert all(panel.bl_category == "Heliform" for panel in panels)
    roots = [panel for panel in panels if not getattr(panel, "bl_parent_id", "")]
    assert [root.bl_idname for root in roots] == ["HELIFORM_PT_heliform"]


def test_texts_with_suggestions_take_any_other_text_too(holder):
    held = type(holder.structure.rules).__annotations__["steel"].keywords
    offered = held["search"](None, None, "HE")
    holder.structure.rules.steel = "my own"
    assert holder.structure.rules.steel == "my own"
    assert set(offered) == {"thesis", "hea", "heb"}
    assert set(next(f for f in fields_of(Rules) if f.name == "steel").suggestions) <= {
        "thesis",
        *FAMILIES,
    }
