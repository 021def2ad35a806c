"""The record of loads: its cases, and what they add up to."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError, SceneError
from heliform.engines.structure.frame import Rigidities
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.loading import FACADE_LOADING, Loading, loads_of, resultants
from heliform.engines.structure.loads import GRAVITY
from structure.waffles import model, prism, waffle

DOME = waffle(8, 6, height=lambda x, y: 0.004 * x * (30 - x) * y * (20 - y) / 100)


def test_a_roof_has_its_weight_and_the_load_of_the_plan_by_default():
    loads = loads_of(DOME, Loading())
    assert loads.names == ("self-weight", "area load")
    assert loads.actions == ("permanent", "imposed")
    assert loads.gravity == pytest.approx(np.array([[0, 0, -GRAVITY], [0, 0, 0]]))
    force, moment = np.split(resultants(DOME.frame, loads)[1], 2)
    assert force == pytest.approx([0, 0, -5000.0 * 600.0], rel=1e-12, abs=1e-6)
    assert moment == pytest.approx([-3e6 * 10, 3e6 * 15, 0], rel=1e-9, abs=1e-3)


def test_a_load_on_the_surface_counts_the_slope_of_a_fold_exactly():
    fold = waffle(2, 1, height=lambda x, y: 8.0 * (1 - abs(x - 15) / 15))  # slopes of 17 m
    loads = loads_of(fold, Loading(area_load=1000.0, area_from="surface", cladding=250.0))
    found = dict(zip(loads.names, resultants(fold.frame, loads)[:, 2], strict=True))
    assert found["area load"] == pytest.approx(-1000.0 * 2 * 17 * 20)
    assert found["cladding"] == pytest.approx(-250.0 * 2 * 17 * 20)


def test_self_weight_is_the_members_mass_with_its_moment():
    loads = loads_of(DOME, Loading(area_load=0.0))
    mass = np.linspace(10, 60, len(DOME.frame.members))
    weights = GRAVITY * mass * DOME.frame.lengths()
    middles = DOME.frame.ends().mean(axis=1)
    found = resultants(DOME.frame, loads, mass)[0]
    assert found[2] == pytest.approx(-weights.sum())
    assert found[3:5] == pytest.approx([-weights @ middles[:, 1], weights @ middles[:, 0]])


def test_a_facade_takes_the_thesis_wind_from_four_sides():
    tower = prism(16)
    loads = loads_of(tower, FACADE_LOADING)
    assert loads.names == ("self-weight", "wind +x", "wind -x", "wind +y", "wind -y")
    assert set(loads.actions[1:]) == {"wind"}
    across = np.ptp(tower.frame.nodes[:, 1])
    found = resultants(tower.frame, loads)
    assert found[1, :3] == pytest.approx([2500.0 * across * 12, 0, 0], abs=1e-6)
    # A uniform wind acts at half the height.
    assert found[1, 4] == pytest.approx(2500.0 * across * 12 * 6, rel=1e-9)
    assert loads_of(tower, replace(FACADE_LOADING, wind_from="y")).names[1:] == (
        "wind +y",
        "wind -y",
    )


def test_rings_carry_a_strip_of_floor():
    tower = prism(16)
    loads = loads_of(
        tower, Loading(self_weight=False, area_load=0.0, floor_load=3000.0, floor_depth=2.5)
    )
    around = tower.frame.lengths()[tower.groups == 1].sum()
    assert loads.names == ("floor load",)
    assert resultants(tower.frame, loads)[0, 2] == pytest.approx(-3000.0 * 2.5 * around)
    assert not loads.line[0, tower.groups == 0].any()


def test_floors_without_rings_are_refused():
    with pytest.raises(SceneError, match="no rings to carry the floors"):
        loads_of(DOME, Loading(floor_load=1.0))


@pytest.mark.parametrize("name", ["area_load", "cladding", "wind", "floor_load", "floor_depth"])
def test_negative_loads_are_refused(name):
    with pytest.raises(ParameterError, match=f"{name} = -1 N?"):
        loads_of(DOME, Loading(**{name: -1.0}))


def test_no_load_at_all_is_refused():
    with pytest.raises(ParameterError, match="loads nothing"):
        loads_of(DOME, Loading(self_weight=False, area_load=0.0))


def test_a_load_on_a_surface_without_cells_is_refused():
    bare = model([[0, 0, 0], [1, 0, 0.0]], [(0, 1)], [])
    with pytest.raises(SceneError, match="no cells for a load"):
        loads_of(bare, Loading())
    assert loads_of(bare, Loading(area_load=0.0)).names == ("self-weight",)


def test_the_action_of_the_area_load_is_the_users():
    assert loads_of(DOME, Loading(area_action="snow")).actions[1] == "snow"


@pytest.mark.parametrize("made", [DOME, prism(8)], ids=["dome", "tower"])
def test_supports_react_to_every_newton_and_its_moment(made):
    record = Loading(wind=900.0, cladding=300.0, area_from="surface", wind_method="normal")
    loads = loads_of(made, record)
    ones = np.ones(len(made.frame.members))
    frame = made.frame
    rigidities = Rigidities(
        1e9 * ones, 1e8 * ones, 1e7 * ones, 1e7 * ones, 1e9 * ones, 1e9 * ones, 40 * ones, ones
    )
    reactions = solve_frame(frame, rigidities, loads).reactions
    moment = np.cross(frame.nodes, reactions[..., :3]) + reactions[..., 3:]
    found = np.concatenate([reactions[..., :3], moment], axis=-1).sum(axis=1)
    expected = -resultants(frame, loads, rigidities.mass)
    assert found == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())
