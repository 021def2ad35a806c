"""The result: what it says agrees with itself, and comes back as it was saved."""

import json
from dataclasses import fields, replace

import numpy as np
import pytest
from heliform.engines.core.colour import Display
from heliform.engines.core.errors import FileError
from heliform.engines.core.scene import Scene
from heliform.engines.structure.combinations import CombinationRules
from heliform.engines.structure.drawing import draw, projected
from heliform.engines.structure.loading import Loading
from heliform.engines.structure.loads import GRAVITY
from heliform.engines.structure.roof import Roof
from heliform.engines.structure.rules import Rules
from heliform.engines.structure.shell import Shell
from heliform.engines.structure.sized import Sized
from heliform.engines.structure.structure import Structure, size_structure
from PIL import Image

from .sized_roofs import TIMBER, roof


@pytest.fixture(scope="module")
def timber() -> Sized:
    return size_structure(Scene(), roof(TIMBER, modes=2))


def value(result: Sized, name: str) -> float:
    return result.figures()[name]["value"]


def test_figures_are_sums_of_the_members(timber):
    rows = timber.rows
    assert value(timber, "mass") == pytest.approx(rows["mass"].sum())
    parts = value(timber, "mass_steel") + value(timber, "mass_timber")
    assert parts == pytest.approx(value(timber, "mass"))
    groups = value(timber, "mass_ribs") + value(timber, "mass_columns")
    assert groups == pytest.approx(value(timber, "mass"))
    # 530 kg/m³ and 7.4 MJ/kg of timber, 7850 and 24.4 of steel: Table 4 of the thesis.
    steel = rows["material"] == "steel"
    volume = rows["area"] * rows["length"]
    mass = 530.0 * volume[~steel].sum() + 7850.0 * volume[steel].sum()
    assert value(timber, "mass") == pytest.approx(mass)
    energy = 7.4e6 * 530.0 * volume[~steel].sum() + 24.4e6 * 7850.0 * volume[steel].sum()
    assert value(timber, "embodied_energy") == pytest.approx(energy / 1e9)


def test_columns_are_of_steel_and_ribs_of_timber(timber):
    columns = timber.rows["group"] == timber.model.group_names.index("columns")
    assert (timber.rows["material"][columns] == "steel").all()
    assert (timber.rows["material"][~columns] == "timber").all()


def test_failing_members_are_those_above_one_and_are_named(timber):
    failing = timber.rows["failing"]
    assert np.array_equal(failing, timber.rows["utilisation"] > 1)
    assert value(timber, "failing") == failing.sum() > 0
    worst = int(timber.rows["utilisation"].argmax())
    start, end = timber.model.frame.members[worst]
    said = f"member {worst} (nodes {start} and {end}"
    assert any("fail even with the largest" in n and said in n for n in timber.meta["notes"])


def test_reactions_carry_the_weight_and_the_load(timber):
    lift = timber.reactions[..., 2].sum(axis=1)
    names = [one["name"] for one in timber.meta["combinations"]]
    weight = value(timber, "mass") * GRAVITY
    for name, force in zip(names, lift.tolist(), strict=True):
        load = 5000.0 * 30 * 20 if "area" in name else 0.0
        assert force == pytest.approx(weight + load, rel=1e-6)
    assert len(set(names)) > 1
    assert np.abs(timber.reactions[..., :2].sum(axis=1)).max() < 1e-6 * lift.max()


def test_the_row_says_the_worst_of_all_checks(timber):
    checked, rows = timber.checked, timber.rows
    assert np.array_equal(rows["utilisation"], checked.worst())
    members = np.arange(len(rows))
    for name in ("combination", "station"):
        assert np.array_equal(rows[name], getattr(checked, name)[rows["check"], members])
    limits = np.array([one["limit"] for one in timber.meta["combinations"]])
    assert (limits[rows["combination"]] == "ultimate").all()
    assert (limits[timber.served.combination] == "service").all()


def test_stress_is_that_of_the_corners(timber):
    low, high = timber.stress
    assert (low <= high).all()
    least, greatest = timber.forces
    axial = np.maximum(np.abs(least[..., 0]), np.abs(greatest[..., 0]))
    bound = axial / timber.rows["area"][:, None]
    rows = timber.rows
    boards = rows["material"] == "timber"
    modulus = rows["width"] * rows["height"] ** 2 / 6, rows["height"] * rows["width"] ** 2 / 6
    for component, part in ((4, modulus[0]), (5, modulus[1])):
        moment = np.maximum(np.abs(least[..., component]), np.abs(greatest[..., component]))
        bound = bound + moment / part[:, None]
    peak = np.maximum(np.abs(low), np.abs(high))
    assert (peak[boards] <= bound[boards] * (1 + 1e-9)).all()
    assert peak[boards].max() > 0.5 * bound[boards].max()


def test_frequencies_and_buckling_factors_are_there_when_asked(timber):
    assert 0 < timber.frequencies[0] <= timber.frequencies[1]
    assert 0 < timber.buckling[0] <= timber.buckling[1]
    assert value(timber, "first_frequency") == timber.frequencies[0]
    assert not len(size_structure(Scene(), roof(per="all")).frequencies)


def test_a_heavier_cladding_swings_slower():
    record = replace(roof(per="all", modes=1), loading=Loading(cladding=0.0))
    light = size_structure(Scene(), record)
    clad = Loading(area_load=3000.0, cladding=2000.0)
    heavy = size_structure(Scene(), replace(record, loading=clad))
    assert set(heavy.rows["name"]) == set(light.rows["name"])
    # Rayleigh: the mass of the glass lies as the members' own nearly does.
    own = value(light, "mass")
    expected = (own / (own + 2000.0 * 600.0 / GRAVITY)) ** 0.5
    found = heavy.frequencies[0] / light.frequencies[0]
    assert found == pytest.approx(expected, rel=0.2)


def said(record, part) -> bool:
    return any(part in note for note in size_structure(Scene(), record).meta["notes"])


def test_eurocode_without_partial_factors_says_that_it_is_unsafe():
    plain = roof(mode="eurocode", timber="timber", per="all")
    factored = replace(plain.rules, combinations=CombinationRules(rule="eurocode"))
    assert said(plain, "without partial factors, which is unsafe")
    assert not said(replace(plain, rules=factored), "unsafe")


def test_a_shell_that_buckles_as_a_whole_says_so():
    flat = Shell(spacing=4.0, length=24.0, span=24.0, rise=4.0, rise_ends=4.0)
    shell = Structure(form="shell", shell=flat, rules=Rules(modes=1), material=TIMBER)
    result = size_structure(Scene(), shell)
    factor = result.buckling[0]
    assert factor < 1
    assert value(result, "failing") == 0
    assert value(result, "buckling_combinations") == 1
    part = f"before all of “self-weight + area load” acts (the least factor is {factor:.3g})"
    assert any(part in note for note in result.meta["notes"])
    assert said(roof(), "would buckle at less than 10 times its loads, so")
    # A two-hinged arch buckles over half of its length of 25.7 m; its members are 4.3 m long.
    braced = replace(flat, pattern="triangulated")
    again = Structure(form="shell", shell=braced, rules=Rules(buckling_y=3.0))
    assert value(size_structure(Scene(), again), "buckling_combinations") == 0


def test_what_bends_too_far_is_named():
    record = Structure(roof=Roof(spacing=4.0))
    result = size_structure(Scene(), record)
    member = int(result.served.utilisation[0].argmax())
    start, end = result.model.frame.members[member]
    assert result.served.utilisation[0, member] > 1
    assert said(record, f"allowed at member {member} (nodes {start} and {end}).")


def test_a_result_comes_back_as_it_was_saved(timber, tmp_path):
    files = timber.save(tmp_path)
    assert sorted(files) == sorted(path.name for path in tmp_path.iterdir())
    back = Sized.load(tmp_path)
    assert back.meta == json.loads(json.dumps(timber.meta))
    assert back.figures() == timber.figures()
    for one, other in (
        (timber, back),
        (timber.model, back.model),
        (timber.checked, back.checked),
        (timber.model.frame, back.model.frame),
        (timber.served, back.served),
    ):
        for field in fields(one):
            first, second = getattr(one, field.name), getattr(other, field.name)
            if isinstance(first, np.ndarray):
                assert np.array_equal(first, second, equal_nan=first.dtype.kind == "f")
                assert first.dtype == second.dtype
    assert back.model.group_names == timber.model.group_names
    assert back.checked.names == timber.checked.names


def test_a_damaged_result_is_said_to_be_none(tmp_path):
    (tmp_path / "structure.npz").write_bytes(b"nothing")
    with pytest.raises(FileError, match="holds no sized structure"):
        Sized.load(tmp_path)
    with pytest.raises(FileError, match="holds no sized structure"):
        Sized.load(tmp_path / "nowhere")


def test_pictures_show_failing_members_in_red(timber, tmp_path):
    names = draw(timber, tmp_path, Display())
    assert sorted(names) == sorted(path.name for path in tmp_path.iterdir())
    assert "plan.png" in names
    for name in ("utilisation.png", "material.png"):
        with Image.open(tmp_path / name) as page:
            pixels = np.asarray(page).reshape(-1, 3)
        assert (pixels == (214, 39, 40)).all(axis=1).sum() > 200


def test_a_picture_of_a_tower_is_an_elevation(tmp_path):
    from heliform.engines.structure.facade import Facade
    from heliform.engines.structure.loading import FACADE_LOADING

    facade = Facade(modules=8, height=80.0, width=20.0, depth=20.0)
    tower = Structure(form="facade", facade=facade, loading=FACADE_LOADING)
    assert "elevation.png" in draw(size_structure(Scene(), tower), tmp_path, Display())


def test_a_view_keeps_lengths_across_and_the_nearer_is_nearer():
    points = np.random.default_rng(1).normal(size=(20, 3))
    for toward in ([0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [-0.5, -1.0, 0.6]):
        seen = projected(points, np.array(toward))
        apart = np.linalg.norm(points[:, None] - points[None], axis=2)
        assert np.linalg.norm(seen[:, None] - seen[None], axis=2) == pytest.approx(apart)
        near = projected(np.array(toward) * 5.0, np.array(toward))
        assert near[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
        assert near[2] > 0
    plan = projected(np.array([2.0, 3.0, 5.0]), np.array([0.0, 0.0, 1.0]))
    assert plan.tolist() == [2.0, 3.0, 5.0]
