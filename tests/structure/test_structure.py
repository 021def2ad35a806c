"""The record of a structure, and sizing it again and again."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.analysis import find_analysis
from heliform.engines.core.errors import ParameterError, SceneError
from heliform.engines.core.parameters import from_table, to_table
from heliform.engines.core.scene import Body, Material, Mesh, Scene
from heliform.engines.structure.facade import Facade
from heliform.engines.structure.level_set import Nine
from heliform.engines.structure.live import Live
from heliform.engines.structure.loading import FACADE_LOADING
from heliform.engines.structure.ranges import Ranges, RangeSweep, sweep_ranges
from heliform.engines.structure.roof import Roof
from heliform.engines.structure.rules import Rules
from heliform.engines.structure.shell import Shell
from heliform.engines.structure.structure import Structure, design, model_of, size_structure
from heliform.engines.structure.surface import Net, Shift

from .sized_roofs import SMALL, TIMBER, roof

SHELL = Shell(spacing=3.0)
TOWER = Facade(height=24.0, modules=8)


def value(result, name):
    return result.figures()[name]["value"]


def test_a_record_comes_back_from_its_table():
    record = Structure(
        form="facade", turn_limit=30.0, rules=Rules(per="group", steel="rhs"), material=TIMBER
    )
    assert from_table(Structure, to_table(record), "parameters") == record


def test_the_analyses_are_found_by_name():
    assert find_analysis("structure.size", "here").record is Structure
    assert find_analysis("structure.ranges", "here").shows is RangeSweep


@pytest.mark.parametrize(
    "record",
    [
        Structure(form="shell", shell=SHELL),
        Structure(form="facade", facade=TOWER, loading=FACADE_LOADING),
        Structure(form="roof", roof=SMALL, material=Nine(c11=-1.0, c10=-1.0, c12=-1.0)),
    ],
    ids=["shell", "facade", "roof"],
)
@pytest.mark.parametrize("mode", ["thesis", "eurocode"])
def test_every_form_is_sized_in_either_mode(record, mode):
    rules = Rules(mode=mode, timber="glulam") if mode == "eurocode" else Rules()
    result = size_structure(Scene(), replace(record, rules=rules))
    assert value(result, "converged") == 1
    assert 0 < value(result, "mean_utilisation") <= 1
    assert np.isfinite(result.displacements).all()


def test_a_mesh_is_sized_by_its_edges():
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    z = 1.0 - 0.1 * ((x - 2) ** 2 + (y - 1.5) ** 2)
    at = np.arange(20).reshape(5, 4)
    faces = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], -1).reshape(-1, 4)
    mesh = Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.astype(np.int32))
    scene = Scene(bodies=(Body("Net", mesh, Material()),))
    result = size_structure(scene, Structure(form="mesh"))
    assert len(result.rows) == 4 * 4 + 5 * 3
    assert value(result, "failing") == 0
    assert result.model.frame.held[:, 2].sum() == 4  # its lowest vertices, the corners


def test_a_mesh_structure_without_a_body_is_refused():
    with pytest.raises(SceneError, match="no body whose edges"):
        size_structure(Scene(), Structure(form="mesh"))


def test_turned_members_have_turned_normals():
    straight = Structure(form="facade", facade=TOWER)
    model, turned = (model_of(r, Scene()) for r in (straight, replace(straight, turn_limit=45.0)))
    before, after = model.frame.axes()[:, 2], turned.frame.axes()[:, 2]
    cosines = np.einsum("mi,mi->m", before, after)
    assert cosines == pytest.approx(np.full(len(cosines), np.sqrt(0.5)))
    assert np.array_equal(model.frame.nodes, turned.frame.nodes)


def test_turning_members_by_a_right_angle_exchanges_their_axes_and_nothing_else():
    """Square sections do not mind; the frame is the same one."""
    fixed = {"height_low": 0.1, "height_high": 0.1, "width_low": 0.1, "width_high": 0.1}
    rules = Rules(steel_range=replace(Rules().steel_range, **fixed))
    straight = Structure(form="facade", facade=TOWER, loading=FACADE_LOADING, rules=rules)
    first, second = (
        size_structure(Scene(), replace(straight, turn_limit=angle)) for angle in (0.0, 90.0)
    )
    assert second.displacements == pytest.approx(first.displacements, abs=1e-12)


def test_a_live_structure_goes_on_from_the_last():
    live = Live()
    record = roof()
    cold = live.size(record, Scene())
    moved = replace(record, net=Net(p11=Shift(z=0.05)))
    warm = live.size(moved, Scene())
    fresh = size_structure(Scene(), moved)
    assert value(warm, "rounds") < value(cold, "rounds")
    assert value(warm, "converged") == 1
    assert value(warm, "failing") == 0
    assert value(warm, "mass") == pytest.approx(value(fresh, "mass"), rel=0.1)


def test_a_live_structure_starts_afresh_where_members_differ():
    live = Live()
    live.size(roof(), Scene())
    coarse = replace(roof(), roof=replace(SMALL, spacing=3.0))
    again = live.size(coarse, Scene())
    fresh = size_structure(Scene(), coarse)
    assert np.array_equal(again.rows, fresh.rows)


def test_a_start_of_other_families_is_passed_over():
    first = size_structure(Scene(), roof())
    other = roof(steel="rhs")
    warm = design(other, Scene(), start=first)
    assert np.array_equal(warm.rows, size_structure(Scene(), other).rows)


def test_wider_ranges_take_less_material():
    sweep = sweep_ranges(Scene(), Ranges(structure=roof(), steps=3))
    masses = [row["mass"] for row in sweep.rows]
    assert masses == sorted(set(masses), reverse=True)
    assert sweep.rows[0]["sections"] == 1
    assert value(sweep, "share") == pytest.approx(masses[-1] / masses[0])
    # Figure 29 of the thesis: a quarter, on a finer waffle.
    assert 0.2 < value(sweep, "share") < 0.45
    cold = size_structure(Scene(), roof())
    assert masses[-1] == pytest.approx(value(cold, "mass"))


def test_a_sweep_comes_back_as_it_was_saved(tmp_path):
    sweep = sweep_ranges(Scene(), Ranges(structure=roof(), steps=1))
    sweep.save(tmp_path)
    back = RangeSweep.load(tmp_path)
    assert back.rows == sweep.rows
    assert back.figures() == sweep.figures()


def test_ranges_of_other_families_are_refused():
    with pytest.raises(ParameterError, match="“thesis”"):
        sweep_ranges(Scene(), Ranges(structure=roof(steel="rhs")))


def test_a_roof_on_columns_too_short_says_so():
    with pytest.raises(SceneError):
        size_structure(Scene(), Structure(roof=Roof(height=0.2, rise=-3.0)))
