"""Typical materials: each has a source, and a study can name it."""

import re

import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.material_presets import material_of, material_presets
from heliform.engines.core.scene import Material
from heliform.engines.core.study import load_study

STUDY = """
heliform = 1
analysis = "sun.radiation"

[bodies.Wand]
mesh = "wand.stl"
material = {{ {material} }}
"""


def test_each_says_its_figure_and_where_that_is_from():
    for name, preset in material_presets().items():
        assert re.fullmatch(r"[a-z0-9-]+", name)
        assert len(preset.source) > 5
        assert preset.told.startswith(f"{preset.label}: typically ")
        assert preset.source in preset.told
        assert ("not confirmed" in preset.told) == (not preset.confirmed)


def test_names_and_labels_are_not_used_twice():
    labels = [preset.label for preset in material_presets().values()]
    assert len(set(labels)) == len(labels)


def test_an_office_is_as_the_standards_have_it():
    """Within the ranges that EN 12464-1 recommends."""
    ranges = {"ceiling": (0.7, 0.9), "wall": (0.5, 0.8), "floor": (0.2, 0.4)}
    for name, (low, high) in ranges.items():
        material = material_presets()[name].material
        assert material.kind == "diffuse"
        assert low <= material.reflectance <= high


def test_ground_is_as_in_pvlib():
    albedo = pytest.importorskip("pvlib").albedo.SURFACE_ALBEDOS
    theirs = {"grass": "grass", "soil": "soil", "sand": "sand", "asphalt": "asphalt"}
    theirs |= {"concrete": "concrete", "snow": "snow", "snow-fresh": "fresh snow"}
    theirs |= {"aluminium": "aluminum", "copper": "copper"}
    theirs |= {"steel-galvanised": "fresh steel", "steel-dirty": "dirty steel"}
    for ours, name in theirs.items():
        assert material_presets()[ours].material.reflectance == albedo[name]


def test_a_preset_is_overlaid():
    given = material_of({"preset": "concrete", "reflectance": 0.55}, "x")
    assert given == Material(kind="diffuse", reflectance=0.55)
    assert material_of({"kind": "mirror"}, "x") == Material(kind="mirror")
    assert material_of({}, "x") == Material()


@pytest.mark.parametrize(
    ("material", "said"),
    [
        ('preset = "beton"', "preset = 'beton' is not a choice; take one of ceiling, "),
        ("preset = 3", "preset = 3 is not a choice"),
        ('preset = "wall", colour = 1', "has no key “colour”"),
        ('preset = "wall", reflectance = 2.0', "reflectance = 2.0 is out of bounds"),
        ("transmittance = -0.1", "transmittance = -0.1 is out of bounds; allowed is 0 to 1"),
    ],
)
def test_what_cannot_be_is_said(tmp_path, material, said):
    import trimesh

    trimesh.creation.box().export(tmp_path / "wand.stl")
    path = tmp_path / "study.toml"
    path.write_text(STUDY.format(material=material), encoding="utf-8")
    with pytest.raises(ParameterError, match=re.escape(said)) as failed:
        load_study(path)
    assert "[bodies.Wand.material" in str(failed.value)


def test_a_study_names_one(tmp_path):
    import trimesh

    trimesh.creation.box().export(tmp_path / "wand.stl")
    path = tmp_path / "study.toml"
    path.write_text(STUDY.format(material='preset = "double-low-e"'), encoding="utf-8")
    (body,) = load_study(path).cases[0].scene.bodies
    assert body.material == Material(ior=1.52, transmittance=0.745)
