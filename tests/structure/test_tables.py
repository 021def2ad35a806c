"""The lists of a sized structure."""

import numpy as np
import pytest
from heliform.engines.core.scene import Scene
from heliform.engines.core.table import load_csv
from heliform.engines.structure.structure import size_structure
from heliform.engines.structure.tables import save_tables

from .sized_roofs import TIMBER, roof


@pytest.fixture(scope="module")
def result():
    return size_structure(Scene(), roof(TIMBER, per="group"))


@pytest.fixture(scope="module")
def tables(result, tmp_path_factory):
    folder = tmp_path_factory.mktemp("tables")
    return {name: load_csv(folder / name)[0] for name in save_tables(folder, result)}


def test_the_member_list_has_every_member(result, tables):
    members = tables["members.csv"]
    assert members["Member"].tolist() == list(range(len(result.rows)))
    assert np.array_equal(members["Start node"], result.model.frame.members[:, 0])
    assert members["Mass (kg)"].sum() == pytest.approx(result.figures()["mass"]["value"], rel=1e-6)
    assert members["Utilisation"] == pytest.approx(result.rows["utilisation"], rel=1e-6)
    assert set(members["Group"]) == {"ribs", "columns"}
    assert (members["Place along it (m)"] <= members["Length (m)"] * (1 + 1e-6)).all()


def test_the_cutting_list_adds_up_to_the_structure(result, tables):
    pieces = tables["cutting-list.csv"]
    assert pieces["Pieces"].sum() == len(result.rows)
    assert pieces["Total length (m)"].sum() == pytest.approx(result.rows["length"].sum(), rel=1e-6)
    assert pieces["Total mass (kg)"].sum() == pytest.approx(result.rows["mass"].sum(), rel=1e-6)
    cut = pieces["Length (m)"] * pieces["Pieces"]
    assert np.abs(cut - pieces["Total length (m)"]).max() < 0.5e-3 * pieces["Pieces"].max() + 1e-6
    names = list(zip(pieces["Section"], pieces["Length (m)"], strict=True))
    assert len(names) == len(set(names))


def test_reactions_are_listed_for_each_support_and_combination(result, tables):
    reactions = tables["reactions.csv"]
    names = [one["name"] for one in result.meta["combinations"]]
    assert len(reactions["Node"]) == 4 * len(names)
    for number, name in enumerate(names):
        listed = reactions["Fz (N)"][reactions["Combination"] == name]
        counted = sum(other == name for other in names)
        total = result.reactions[number, :, 2].sum()
        assert listed.sum() == pytest.approx(counted * total, rel=1e-5)


def test_combinations_are_printed(result, tables):
    assert set(tables["combinations.csv"]["Limit state"]) == {"ultimate", "service"}
    assert "self-weight" in tables["combinations.csv"]["Combination"][0]
