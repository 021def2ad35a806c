"""The catalogue: what is shipped, what members of it resist with and weigh, and a user's own."""

import json
from pathlib import Path

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, ParameterError
from heliform.engines.core.parameters import fields_of, from_table, to_table
from heliform.engines.structure.catalogue import (
    FAMILIES,
    load_family,
    read_catalogue,
    rigidities_of,
    sections_of,
    thesis_family,
    weights_of,
    write_catalogue,
    write_template,
)
from heliform.engines.structure.family import Family
from heliform.engines.structure.grade import grade_of, grades, table_of
from heliform.engines.structure.section_range import BoardRange, SectionRange, family_of_range
from heliform.engines.structure.sections import rectangle

# kg/m, EN 10365
MASSES = {
    "IPE": "6.0 8.1 10.4 12.9 15.8 18.8 22.4 26.2 30.7 36.1 42.2 49.1 57.1 66.3 77.6 90.7 105.5 "
    "122.4",
    "HEA": "16.7 19.9 24.7 30.4 35.5 42.3 50.5 60.3 68.2 76.4 88.3 97.6 104.8 112.1 124.8 139.8 "
    "155.1 166.2 177.8 189.7 204.5 224.4 251.6 272.3",
    "HEB": "20.4 26.7 33.7 42.6 51.2 61.3 71.5 83.2 93.0 103.1 117.0 126.7 134.2 141.8 155.3 171.1 "
    "187.3 199.4 211.9 224.8 240.5 262.3 291.5 314.0",
}

BOXES = """
[family.boxes]
grade = "S235"
shape = "rhs"
rows = [{ height = 200, width = [100, 120], thickness = [8, 10] }]
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "my sections ä.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", FAMILIES)
def test_a_shipped_family_is_ordered_by_area_and_named_throughout(name):
    family = load_family(name)
    assert family.name == name
    assert family.about
    assert (np.diff(family.sections.area) > -1e-12).all()
    assert len(set(family.sections.name)) == len(family.sections)
    assert (family.sections.plastic_y >= family.sections.elastic_y).all()
    assert (family.sections.shear_z <= family.sections.area).all()


def test_every_shipped_grade_says_where_its_figures_are_from():
    for grade in grades().values():
        assert grade.source
        assert "ICE" in grade.climate
        if grade.kind == "timber" and not grade.yield_strength:
            assert grade.youngs_low < grade.youngs
            assert grade.shear_low < grade.shear
            assert grade.tension < grade.bending
            assert grade.glued == grade.name.startswith("GL")


def test_the_thesis_materials_are_those_of_table_4():
    steel, timber = grades()["thesis-steel"], grades()["thesis-timber"]
    assert [steel.youngs, steel.shear, steel.density] == pytest.approx([2.1e11, 8.076e10, 7850])
    assert [timber.youngs, timber.shear, timber.density] == pytest.approx([1.05e10, 3.6e9, 530])
    assert [steel.energy, timber.energy] == pytest.approx([24.4e6, 7.4e6])
    assert [steel.yield_strength, timber.yield_strength] == pytest.approx([235e6, 13e6])


def test_strength_classes_are_those_of_their_standards():
    c24, gl28c = grades()["C24"], grades()["GL28c"]
    names = ("bending", "tension", "compression", "shear_strength", "youngs", "youngs_low", "shear")
    found = [getattr(c24, name) / 1e6 for name in names]
    assert found == pytest.approx([24, 14.5, 21, 4, 11000, 7400, 690])
    found = [getattr(gl28c, name) / 1e6 for name in names]
    assert found == pytest.approx([28, 19.5, 24, 3.5, 12500, 10400, 650])
    assert [grades()[f"S{f}"].yield_strength for f in (235, 275, 355, 420, 460)] == [
        f * 1e6 for f in (235, 275, 355, 420, 460)
    ]


@pytest.mark.parametrize("label", MASSES)
def test_rolled_sections_have_the_published_masses(label):
    family = load_family(label.lower())
    mass = 7850 * family.sections.area
    assert mass == pytest.approx(np.array(MASSES[label].split(), dtype=float), abs=0.06)


@pytest.mark.peer
@pytest.mark.parametrize(
    ("name", "file"), [("ipe", "i"), ("hea", "i"), ("heb", "i"), ("chs", "chs")]
)
def test_eurocodepy_has_the_same_figures_for_every_section_in_both(name, file):
    eurocodepy = pytest.importorskip("eurocodepy")
    path = Path(eurocodepy.__file__).parent / "data" / f"{file}_profiles_euro.json"
    peers = {
        row["Section"].replace("_", ".").replace("x", "×"): row
        for row in json.loads(path.read_text(encoding="utf-8"))
    }
    sections = load_family(name).sections
    common = [i for i, n in enumerate(sections.name) if n.replace(" ", "") in peers]
    assert len(common) >= 18
    for i in common:
        row = peers[sections.name[i].replace(" ", "")]
        for key, ours, power in (
            ("A", "area", 2),
            ("Iy", "inertia_y", 4),
            ("Iz", "inertia_z", 4),
            ("Wel_y", "elastic_y", 3),
            ("Wpl_y", "plastic_y", 3),
            ("Wpl_z", "plastic_z", 3),
        ):
            value = getattr(sections, ours)[i] * 100**power
            assert value == pytest.approx(row[key], rel=5e-3), (sections.name[i], key)


def test_the_thesis_ranges_hold_every_size_up_to_their_bounds():
    steel = thesis_family("steel", 0.05, 2.0, 0.05, 0.2, 0.01, 0.01)
    assert len(steel.sections) == 196 * 16
    assert [steel.sections.height.min(), steel.sections.height.max()] == [0.05, 2.0]
    assert [steel.sections.width.min(), steel.sections.width.max()] == [0.05, 0.2]
    assert (steel.sections.radius == 0).all()
    a, h, b = steel.sections.area, steel.sections.height, steel.sections.width
    assert a == pytest.approx(2 * 0.01 * (h + b - 0.02))
    timber = thesis_family("timber", 0.1, 2.0, 0.02, 0.1, 0.02, 0.01)
    assert len(timber.sections) == 96 * 5
    assert timber.sections.area == pytest.approx(timber.sections.height * timber.sections.width)
    assert timber.grade.name == "thesis-timber"


def test_of_boxes_as_heavy_the_stiffest_comes_first():
    sections = thesis_family("steel", 0.1, 0.3, 0.05, 0.2, 0.05, 0.01).sections
    area = np.round(sections.area, 9)
    equal = np.diff(area) == 0
    assert equal.any()
    assert (np.diff(sections.inertia_y)[equal] < 0).all()


def test_a_step_that_does_not_reach_the_bound_stays_below_it():
    sections = thesis_family("timber", 0.1, 0.35, 0.05, 0.05, 0.1, 0.0).sections
    assert sections.height == pytest.approx([0.1, 0.2, 0.3])


@pytest.mark.parametrize("record", [SectionRange, BoardRange])
def test_the_range_records_are_parameters_with_the_thesis_as_default(record):
    assert from_table(record, to_table(record()), "range") == record()
    for field in fields_of(record):
        assert field.unit == "m"
        assert field.low <= field.default <= field.high
    kind = "steel" if record is SectionRange else "timber"
    assert family_of_range(kind, record()).name == f"thesis-{kind}"


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"height_low": 2.0, "height_high": 1.0}, "height range from 2 to 1 m"),
        ({"thickness": 0.025}, "SHS 50×50×25"),
        ({"step": 0.0}, "step of 0 m"),
        ({"step": 0.001, "height_high": 5.0}, "larger step"),
    ],
)
def test_a_range_that_cannot_be_is_refused(changed, said):
    with pytest.raises(ParameterError, match=said):
        family_of_range("steel", SectionRange(**changed))


def test_members_get_the_rigidities_of_their_family_and_section():
    ipe, timber = load_family("ipe"), load_family("timber")
    families = [ipe, timber]
    at = [ipe.index("IPE 300"), timber.index("200×100"), ipe.index("IPE 80")]
    found = rigidities_of(families, np.array([0, 1, 0]), np.array(at))
    assert found.axial == pytest.approx([2.1e11 * 53.81e-4, 1.1e10 * 0.02, 2.1e11 * 7.643e-4], 1e-4)
    assert found.bending_y[0] == pytest.approx(2.1e11 * 8356e-8, 1e-4)
    assert found.bending_z[1] == pytest.approx(1.1e10 * 0.2 * 0.1**3 / 12)
    assert found.torsion[1] == pytest.approx(6.9e8 * 0.229 * 0.2 * 0.1**3, 2e-3)
    assert found.shear_y[1] == pytest.approx(6.9e8 * 0.02 * 5 / 6)
    assert found.mass[:2] == pytest.approx([42.24, 420 * 0.02], 1e-4)
    assert found.rotary[1] == pytest.approx(420 * 0.2 * 0.1 * (0.2**2 + 0.1**2) / 12)
    assert list(sections_of(families, np.array([0, 1, 0]), np.array(at)).name) == [
        *("IPE 300", "200×100", "IPE 80")
    ]


def test_weights_are_mass_times_what_a_kilogram_costs():
    families = [load_family("thesis-steel"), load_family("thesis-timber")]
    at = np.array([families[0].index("RHS 200×100×10"), families[1].index("500×100")])
    found = weights_of(families, np.array([0, 1]), at)
    area = np.array([0.2 * 0.1 - 0.18 * 0.08, 0.05])
    assert found.mass == pytest.approx(area * [7850, 530])
    assert found.energy == pytest.approx(area * [7850 * 24.4e6, 530 * 7.4e6])
    assert found.carbon == pytest.approx(area * [7850 * 1.77, 530 * 0.45])


@pytest.mark.parametrize(("family", "section"), [(1, 0), (-1, 0), (0, 18), (0, -1)])
def test_a_member_outside_the_catalogue_is_named(family, section):
    with pytest.raises(ParameterError, match="Member 1 has section"):
        rigidities_of([load_family("ipe")], np.array([0, family]), np.array([0, section]))


def test_a_family_can_be_had_in_another_grade_of_its_kind():
    assert load_family("rhs", "S460").grade.yield_strength == 460e6
    assert load_family("glulam", "C24").grade.name == "C24"
    with pytest.raises(ParameterError, match="is of steel and cannot be of C24"):
        load_family("rhs", "C24")


def test_unknown_names_are_answered_with_the_nearest():
    with pytest.raises(ParameterError, match=r"no family “IPEE”; did you mean “ipe”\?"):
        load_family("IPEE")
    with pytest.raises(ParameterError, match=r"did you mean “IPE 300”\?"):
        load_family("ipe").index("IPE300")
    with pytest.raises(ParameterError, match=r"no grade “S356”; did you mean “S355”\?"):
        load_family("ipe", "S356")


def test_shipped_families_copied_to_a_file_are_read_back_the_same(tmp_path):
    path = tmp_path / "mine.toml"
    write_template(path, ("thesis-timber", "rhs", "chs", "heb", "glulam"))
    for name, family in read_catalogue(path).items():
        shipped = load_family(name)
        assert family.grade == shipped.grade
        assert family.about == shipped.about
        assert list(family.sections.name) == list(shipped.sections.name)
        for column in ("area", "inertia_y", "torsion", "plastic_z", "shear_z", "radius"):
            found = getattr(family.sections, column)
            assert found == pytest.approx(getattr(shipped.sections, column), rel=1e-7), column


def test_a_grade_of_ones_own_is_written_and_read_back(tmp_path):
    path = tmp_path / "mine.toml"
    table = table_of(grades()["GL24h"]) | {"density": 500, "source": "measured"}
    own = Family("beams", grade_of("my glulam", table), rectangle([0.2, 0.4], 0.1))
    write_catalogue(path, {"beams": own})
    read = read_catalogue(path)["beams"]
    assert read.grade == own.grade
    assert read.grade.density == 500
    assert read.grade.glued


def test_the_template_explains_itself_and_can_be_read(tmp_path):
    path = tmp_path / "template.toml"
    write_template(path)
    text = path.read_text(encoding="utf-8")
    assert text.startswith("# Sections to choose from")
    assert max(len(line) for line in text.splitlines() if line.startswith("#")) <= 100
    assert set(read_catalogue(path)) == {"shs", "chs", "ipe", "timber"}


def test_a_row_of_lists_is_every_combination(tmp_path):
    family = read_catalogue(written(tmp_path, BOXES))["boxes"]
    assert sorted(family.sections.name) == [
        *("RHS 200×100×10", "RHS 200×100×8", "RHS 200×120×10", "RHS 200×120×8")
    ]
    assert family.sections.radius == pytest.approx(1.5 * family.sections.web)


def test_ones_own_family_comes_before_a_shipped_one_of_that_name(tmp_path):
    own = read_catalogue(written(tmp_path, BOXES.replace("boxes", "rhs")))
    assert len(load_family("rhs", own=own).sections) == 4
    with pytest.raises(ParameterError, match="did you mean “boxes”"):
        load_family("boxs", own=read_catalogue(written(tmp_path, BOXES)))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("thickness", "thicknes", "family “boxes”, row 1 .*“thicknes”; did you mean “thickness”"),
        ("height = 200, ", "", "family “boxes”, row 1 has no “height”"),
        ("height = 200", "height = -200", "row 1: height = -200.* should be a length in mm"),
        ("height = 200", "height = 0.2", "row 1: height = 0.2 .* lengths in m are to be mult"),
        ("[8, 10]", "[0.01]", "row 1: thickness = 0.01 should be a length in mm, from 0.1"),
        ("height = 200", 'height = "200"', "row 1: height = '200'"),
        ("height = 200", "height = true", "row 1: height = True"),
        ("height = 200", "height = nan", "row 1: height = nan"),
        ("[8, 10]", "[8, 60]", "row 1: Section RHS 200×100×60 .* walls that fill it"),
        ("[8, 10]", "[]", "thickness is an empty list"),
        ("[8, 10]", "[8, 8]", "“RHS 200×100×8” more than once"),
        ("height", 'name = "a", height', "is 4 sections and cannot have one name"),
        ('"S235"', "[1]", "unknown grade “\\[1\\]”"),
        ("S235", "S234", "unknown grade “S234”; did you mean “S235”"),
        ('"rhs"', '"rsh"', "unknown shape “rsh”; did you mean “rhs”"),
        ("rows = [", "rows = 3 #[", "no rows"),
        ("grade =", "gread =", "unknown key “gread”; did you mean “grade”"),
        ("[family.boxes]", "[famly.boxes]", "“famly” is not known"),
        (BOXES, "", "no \\[family"),
        (BOXES, "family = 3", "should be tables"),
        (BOXES, "[family]\na = 1", "should be a table, \\[family.a\\]"),
        (BOXES, "x = = 1", "is no TOML"),
        (BOXES, '[grade.x]\nkind = "stone"\n' + BOXES, "grade “x” needs kind"),
        (BOXES, '[grade.x]\nkind = "steel"\nyoungs = 210000\n' + BOXES, "grade “x” has no “shear”"),
    ],
)
def test_a_bad_catalogue_is_told_with_file_family_and_row(tmp_path, old, new, said):
    assert old in BOXES
    path = written(tmp_path, BOXES.replace(old, new))
    with pytest.raises(FileError, match=said) as caught:
        read_catalogue(path)
    assert "my sections ä.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_catalogue_that_is_not_there_is_said_so(tmp_path):
    with pytest.raises(FileError, match="cannot be read"):
        read_catalogue(tmp_path / "none.toml")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"youngs": -1}, "youngs = -1 should be a number of N/mm²"),
        ({"youngs": 1.1e10}, "youngs = 11000000000.0 should be a number of N/mm², from 500"),
        ({"youngs": 11.0}, "youngs = 11.0 should be a number of N/mm²"),
        ({"density": 0.42}, "density = 0.42 should be a number of kg/m³, from 50"),
        ({"density": "heavy"}, "density = 'heavy'"),
        ({"glued": 1}, "glued should be true or false"),
        ({"yeild": 235}, "unknown key “yeild”"),
        ({"kind": "steel"}, "steel and cannot have “bending”"),
        ({"source": 3}, "source should be text"),
        ({"carbon": float("nan")}, "carbon = nan"),
    ],
)
def test_a_bad_grade_is_refused_by_name(changes, said):
    with pytest.raises(ParameterError, match=said) as caught:
        grade_of("mine", table_of(grades()["C24"]) | changes)
    assert "grade “mine”" in str(caught.value)
