"""How a frame is assembled and factorised does not show in its answer."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.structure.assembly import pattern_of
from heliform.engines.structure.frame import FIXED
from heliform.engines.structure.linear import factorise, solve_frame, solve_system
from heliform.engines.structure.loads import joined
from heliform.engines.structure.stiffness import members_of
from structure.frames import frame_of, grid, random_frame, random_loads, random_rigidities


def case(seed, cases=3):
    """A random frame with loads on it."""
    generator = np.random.default_rng(seed)
    frame = random_frame(generator)
    rigidities = random_rigidities(generator, len(frame.members), True)
    return frame, rigidities, random_loads(generator, frame, cases)


def close(one, other, within):
    """Whether two arrays differ by no more than a share of the greatest number in either."""
    return np.abs(one - other).max() <= within * max(np.abs(one).max(), np.abs(other).max())


def test_cases_solved_together_are_those_solved_one_by_one_over_one_pattern():
    frame, rigidities, loads = case(4)
    other = random_loads(np.random.default_rng(9), frame, 2)
    both = solve_frame(frame, rigidities, joined(loads, other), pattern_of(frame))
    system = factorise(frame, rigidities, pattern_of(replace(frame, nodes=frame.nodes + 1.0)))
    alone = solve_system(system, other)
    assert close(both.displacements[3:], alone.displacements, 1e-12)
    assert both.displacements.shape == (5, len(frame.nodes), 6)


def star(arms, count):
    """Straight arms from one node, each of so many members and clamped at its end."""
    angle = 2 * np.pi * np.arange(arms)[:, None] / arms
    out = np.arange(1.0, count + 1)
    points = np.stack([out * np.cos(angle), out * np.sin(angle), 0 * out * angle], axis=2)
    index = 1 + np.arange(arms * count).reshape(arms, count)
    inner = np.concatenate([np.zeros((arms, 1), dtype=int), index[:, :-1]], axis=1)
    members = np.stack([inner.ravel(), index.ravel()], axis=1)
    nodes = np.concatenate([np.zeros((1, 3)), points.reshape(-1, 3)])
    return frame_of(nodes, members, dict.fromkeys(index[:, -1].tolist(), FIXED))


def test_a_frame_is_factorised_as_a_band_or_sparse_whichever_is_less_work():
    assert pattern_of(grid(12)).band > 0
    assert pattern_of(star(50, 20)).band == 0


@pytest.mark.parametrize("frame", [grid(6), star(7, 5)], ids=["grid", "star"])
def test_band_and_sparse_factors_agree(frame, monkeypatch):
    generator = np.random.default_rng(0)
    frame = replace(frame, springs=generator.uniform(0.0, 1e6, (len(frame.nodes), 6)))
    rigidities = random_rigidities(generator, len(frame.members), True)
    loads = random_loads(generator, frame, 2)
    answers = []
    for speed, banded in ((1e9, True), (0.0, False)):
        monkeypatch.setattr("heliform.engines.structure.assembly._BAND_SPEED", speed)
        monkeypatch.setattr("heliform.engines.structure.assembly._SPARSE_START", 0.0)
        pattern = pattern_of(frame)
        assert (pattern.band > 0) == banded
        matrix = pattern.matrix(members_of(frame, rigidities).world, frame.springs)
        pushed = pattern.gathered(loads.nodal)
        system = factorise(frame, rigidities, pattern)
        assert close(matrix @ system.factor.solve(pushed), pushed, 1e-9)
        answers.append(solve_frame(frame, rigidities, loads, pattern).displacements)
    assert close(*answers, 1e-9)


def test_no_load_case_gives_no_answer_and_no_load_moves_nothing():
    frame, rigidities, loads = case(0)
    none = replace(
        loads,
        names=(),
        actions=(),
        gravity=loads.gravity[:0],
        nodal=loads.nodal[:0],
        line=loads.line[:0],
    )
    assert solve_frame(frame, rigidities, none).displacements.shape == (0, len(frame.nodes), 6)
    idle = replace(loads, gravity=0 * loads.gravity, nodal=0 * loads.nodal, line=0 * loads.line)
    response = solve_frame(frame, rigidities, idle)
    assert not response.displacements.any()
    assert response.imbalance.tolist() == [0.0, 0.0, 0.0]


def test_a_pattern_of_another_frame_is_refused():
    frame, rigidities, loads = case(1)
    held = frame.held.copy()
    held[1] = True
    for other in (replace(frame, held=held), replace(frame, members=frame.members[:, ::-1].copy())):
        with pytest.raises(ValueError, match="pattern"):
            solve_frame(frame, rigidities, loads, pattern_of(other))
