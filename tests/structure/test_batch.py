"""Batches of designs answer what single designs do."""

from dataclasses import fields

import numpy as np
import pytest
from heliform.engines.structure.assembly import pattern_of
from heliform.engines.structure.batch import STATIONS, Summary, solve_batch
from heliform.engines.structure.frame import Rigidities
from heliform.engines.structure.linear import solve_frame
from structure.shells import shell

FRAME, RIGIDITIES, LOADS = shell()


def designs(count):
    rng = np.random.default_rng(5)
    found = []
    for _ in range(count):
        scale = rng.uniform(0.5, 2, len(FRAME.members))
        stiff = Rigidities(
            *(getattr(RIGIDITIES, field.name) * scale for field in fields(Rigidities))
        )
        found.append((FRAME.nodes + 0.05 * rng.normal(size=FRAME.nodes.shape), stiff))
    return found


def test_each_summary_is_that_of_the_design_alone():
    some = designs(3)
    for found, (nodes, stiff) in zip(
        solve_batch(FRAME, some, LOADS, pattern_of(FRAME)), some, strict=True
    ):
        frame = type(FRAME)(
            nodes, *(getattr(FRAME, field.name) for field in fields(FRAME) if field.name != "nodes")
        )
        alone = solve_frame(frame, stiff, LOADS)
        moved = np.linalg.norm(alone.displacements[..., :3], axis=-1)
        forces = alone.forces(STATIONS)
        assert found.failure == ""
        assert found.mass == pytest.approx((stiff.mass * frame.lengths()).sum())
        assert found.deflection == pytest.approx(moved.max(axis=1), rel=1e-12)
        assert (moved[np.arange(2), found.node] == moved.max(axis=1)).all()
        assert found.least == pytest.approx(forces.min(axis=(0, 2)), rel=1e-12)
        assert found.greatest == pytest.approx(forces.max(axis=(0, 2)), rel=1e-12)
        assert (found.imbalance < 1e-9).all()


def test_a_design_that_cannot_be_solved_says_so_and_the_others_are_solved():
    good = designs(2)
    flat = good[0][0].copy()
    flat[FRAME.members[3, 1]] = flat[FRAME.members[3, 0]]
    offsets_off = (
        FRAME
        if FRAME.offsets is None
        else type(FRAME)(FRAME.nodes, FRAME.members, FRAME.normals, FRAME.held)
    )
    found = solve_batch(offsets_off, [good[0], (flat, RIGIDITIES), good[1]], LOADS)
    assert [bool(each.failure) for each in found] == [False, True, False]
    assert "Member 3" in found[1].failure
    assert np.isnan(found[1].mass)
    assert np.isnan(found[1].greatest).all()


def test_several_processes_answer_the_same():
    some = designs(5)
    some[2] = (np.zeros_like(FRAME.nodes), RIGIDITIES)
    alone = solve_batch(FRAME, some, LOADS)
    shared = solve_batch(FRAME, some, LOADS, processes=2)
    assert len(shared) == 5
    for one, other in zip(alone, shared, strict=True):
        for field in fields(Summary):
            np.testing.assert_array_equal(getattr(one, field.name), getattr(other, field.name))


def test_no_designs_have_no_summaries():
    assert solve_batch(FRAME, [], LOADS) == []
    assert solve_batch(FRAME, [], LOADS, processes=2) == []
