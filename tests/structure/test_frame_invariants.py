"""What must hold of every frame, whatever it looks like."""

from dataclasses import fields, replace

import numpy as np
import pytest
from heliform.engines.structure.frame import Frame, Rigidities
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.loads import Loads
from heliform.engines.structure.stiffness import (
    coefficients,
    elastic_forces,
    local_stiffness,
    members_of,
    transform,
)
from structure.frames import (
    random_frame,
    random_loads,
    random_rigidities,
    rotation,
    turned,
)

SEEDS = range(12)


def case(seed, cases=3, shear=True, springs=True):
    """A random frame, half of them with releases, offsets and springs, and loads on it."""
    generator = np.random.default_rng(seed)
    frame = random_frame(generator)
    rigidities = random_rigidities(generator, len(frame.members), shear)
    if seed % 2:
        releases = np.zeros((len(frame.members), 12), dtype=bool)
        releases[:, 10] = generator.random(len(frame.members)) < 0.3
        offsets = generator.standard_normal((len(frame.members), 2, 3)) * 0.1
        frame = replace(frame, releases=releases, offsets=offsets)
    if seed % 3 == 0 and springs:
        some = generator.random((len(frame.nodes), 6)) < 0.2
        frame = replace(frame, springs=np.where(some, 1e6, 0.0))
    return frame, rigidities, random_loads(generator, frame, cases)


def close(one, other, within):
    """Whether two arrays differ by no more than a share of the greatest number in either."""
    return np.abs(one - other).max() <= within * max(np.abs(one).max(), np.abs(other).max())


@pytest.mark.parametrize("shear", [False, True])
def test_a_member_resists_six_ways_of_deforming_and_none_of_moving(shear):
    generator = np.random.default_rng(1)
    rigidities = random_rigidities(generator, 20, shear)
    lengths = generator.uniform(0.5, 8.0, 20)
    local = local_stiffness(rigidities, lengths)
    np.testing.assert_array_equal(local, local.transpose(0, 2, 1))
    for one, length in zip(local, lengths, strict=True):
        size = np.sqrt(np.diagonal(one))
        values = np.linalg.eigvalsh(one / np.outer(size, size))
        assert np.abs(values[:6]).max() < 1e-14
        assert values[6] > 1e-4
        rigid = np.zeros((12, 6))
        rigid[:6] = rigid[6:] = np.eye(6)
        rigid[7, 5], rigid[8, 4] = length, -length
        assert np.abs(one @ rigid).max() < 1e-12 * np.abs(one).max()


def test_the_stiffness_in_world_axes_is_the_local_one_turned():
    generator = np.random.default_rng(2)
    frame = random_frame(generator)
    rigidities = random_rigidities(generator, len(frame.members), True)
    members = members_of(frame, rigidities)
    turn = transform(frame.axes())
    local = local_stiffness(rigidities, frame.lengths())
    assert close(members.world, turn.transpose(0, 2, 1) @ local @ turn, 1e-15)


def test_forces_at_given_ends_are_the_stiffness_times_them():
    generator = np.random.default_rng(3)
    rigidities, lengths = random_rigidities(generator, 5, True), generator.uniform(1, 5, 5)
    ends = generator.standard_normal((2, 5, 12))
    whole = np.einsum("mij,cmj->cmi", local_stiffness(rigidities, lengths), ends)
    assert close(elastic_forces(coefficients(rigidities, lengths), ends), whole, 1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_supports_carry_every_load_in_force_and_moment(seed):
    frame, rigidities, loads = case(seed)
    response = solve_frame(frame, rigidities, loads, tolerance=1e-13)
    assert response.imbalance.max() <= 1e-12
    ends, lengths = frame.ends(), frame.lengths()[:, None]
    line = loads.line + loads.gravity[:, None, None] * rigidities.mass[:, None, None]
    first, last = line[:, :, 0], line[:, :, 1]
    forces = 0.5 * lengths * (first + last)
    levers = lengths / 6.0 * (2 * first + last), lengths / 6.0 * (first + 2 * last)
    at_nodes = loads.nodal + response.reactions
    force = at_nodes[..., :3].sum(axis=1) + forces.sum(axis=1)
    moment = at_nodes[..., 3:].sum(axis=1) + np.cross(frame.nodes, at_nodes[..., :3]).sum(axis=1)
    moment += np.cross(ends[:, 0], levers[0]).sum(axis=1)
    moment += np.cross(ends[:, 1], levers[1]).sum(axis=1)
    size = np.abs(at_nodes[..., :3]).max() + np.abs(forces).max()
    assert np.abs(force).max() <= 1e-12 * size
    assert np.abs(moment).max() <= 1e-12 * size * 10.0


@pytest.mark.parametrize("seed", SEEDS[1::2])
def test_released_ends_carry_nothing(seed):
    frame, rigidities, loads = case(seed)
    assert frame.releases is not None
    assert not solve_frame(frame, rigidities, loads).end_forces[:, frame.releases].any()


@pytest.mark.parametrize("seed", SEEDS)
def test_turning_the_whole_frame_turns_its_answer_and_nothing_else(seed):
    frame, rigidities, loads = case(seed, springs=False)
    held = np.repeat(frame.held.reshape(-1, 2, 3).all(axis=2), 3, axis=1)  # all axes or none
    frame = replace(frame, held=held)
    matrix = rotation(np.random.default_rng(100 + seed))
    moved = Frame(
        turned(frame.nodes, matrix),
        frame.members,
        turned(frame.normals, matrix),
        held,
        frame.releases,
        None if frame.offsets is None else turned(frame.offsets, matrix),
    )
    pushed = replace(
        loads,
        gravity=turned(loads.gravity, matrix),
        nodal=turned(loads.nodal, matrix),
        line=turned(loads.line, matrix),
    )
    here = solve_frame(frame, rigidities, loads, tolerance=1e-14)
    there = solve_frame(moved, rigidities, pushed, tolerance=1e-14)
    assert close(turned(here.displacements, matrix), there.displacements, 1e-12)
    assert close(turned(here.reactions, matrix), there.reactions, 1e-12)
    assert close(here.end_forces, there.end_forces, 1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_cutting_members_into_pieces_changes_nothing(seed):
    frame, rigidities, loads = case(seed, cases=2)
    frame = replace(frame, releases=None, offsets=None)
    cut = 3
    start, end = frame.ends().transpose(1, 0, 2)
    inner = [start + k / cut * (end - start) for k in range(1, cut)]
    many, count = len(frame.members), len(frame.nodes)
    path = [frame.members[:, 0]]
    path += [count + k * many + np.arange(many) for k in range(cut - 1)]
    path += [frame.members[:, 1]]
    pieces = np.concatenate([np.stack(path[k : k + 2], axis=1) for k in range(cut)])
    zeros = np.zeros(((cut - 1) * many, 6))
    fine = Frame(
        np.concatenate([frame.nodes, *inner]),
        pieces.astype(np.int32),
        np.tile(frame.normals, (cut, 1)),
        np.concatenate([frame.held, zeros.astype(bool)]),
        springs=None if frame.springs is None else np.concatenate([frame.springs, zeros]),
    )
    sections = Rigidities(*(np.tile(getattr(rigidities, f.name), cut) for f in fields(Rigidities)))
    first, change = loads.line[:, :, 0], loads.line[:, :, 1] - loads.line[:, :, 0]
    at = [first + k / cut * change for k in range(cut + 1)]
    line = np.concatenate([np.stack(at[k : k + 2], axis=2) for k in range(cut)], axis=1)
    nodal = np.concatenate([loads.nodal, np.zeros((2, *zeros.shape))], axis=1)
    whole = solve_frame(frame, rigidities, loads)
    divided = solve_frame(fine, sections, replace(loads, nodal=nodal, line=line))
    assert close(whole.displacements, divided.displacements[:, :count], 1e-9)
    stations = np.arange(1, cut) / cut
    cuts = divided.displacements[:, count:, :3].reshape(2, cut - 1, many, 3).swapaxes(1, 2)
    assert close(whole.deflections(stations), cuts, 1e-9)
    ends = divided.end_forces[:, : (cut - 1) * many, 6:].reshape(2, cut - 1, many, 6).swapaxes(1, 2)
    assert close(whole.forces(stations), ends, 1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_order_of_nodes_and_members_and_their_direction_do_not_matter(seed):
    frame, rigidities, loads = case(seed)
    generator = np.random.default_rng(200 + seed)
    nodes = generator.permutation(len(frame.nodes))
    members = generator.permutation(len(frame.members))
    number = np.argsort(nodes)
    shuffled = Frame(
        frame.nodes[nodes],
        number[frame.members[members]].astype(np.int32),
        frame.normals[members],
        frame.held[nodes],
        None if frame.releases is None else frame.releases[members],
        None if frame.offsets is None else frame.offsets[members],
        None if frame.springs is None else frame.springs[nodes],
    )
    sections = Rigidities(*(getattr(rigidities, f.name)[members] for f in fields(Rigidities)))
    pushed = replace(loads, nodal=loads.nodal[:, nodes], line=loads.line[:, members])
    here = solve_frame(frame, rigidities, loads)
    there = solve_frame(shuffled, sections, pushed)
    assert close(here.displacements[:, nodes], there.displacements, 1e-9)
    assert close(here.end_forces[:, members], there.end_forces, 1e-9)

    back = replace(
        frame,
        members=frame.members[:, ::-1].copy(),
        releases=None if frame.releases is None else np.roll(frame.releases, 6, axis=1),
        offsets=None if frame.offsets is None else frame.offsets[:, ::-1].copy(),
    )
    reversed_ = solve_frame(back, rigidities, replace(loads, line=loads.line[:, :, ::-1]))
    assert close(here.displacements, reversed_.displacements, 1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_mirrored_frame_gives_a_mirrored_answer(seed):
    frame, rigidities, loads = case(seed)
    flip = np.array([-1.0, 1.0, 1.0])
    both = np.concatenate([flip, -flip])  # rotations are axial vectors
    mirrored = replace(
        frame,
        nodes=frame.nodes * flip,
        normals=frame.normals * flip,
        offsets=None if frame.offsets is None else frame.offsets * flip,
    )
    pushed = replace(
        loads, gravity=loads.gravity * flip, nodal=loads.nodal * both, line=loads.line * flip
    )
    here = solve_frame(frame, rigidities, loads).displacements
    assert close(here * both, solve_frame(mirrored, rigidities, pushed).displacements, 1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_quarter_roll_is_the_same_as_exchanging_strong_and_weak(seed):
    frame, rigidities, loads = case(seed, springs=False)
    frame = replace(frame, releases=None)
    exchanged = replace(
        rigidities,
        bending_y=rigidities.bending_z,
        bending_z=rigidities.bending_y,
        shear_y=rigidities.shear_z,
        shear_z=rigidities.shear_y,
    )
    rolled = replace(frame, normals=frame.axes()[:, 1].copy())
    here = solve_frame(frame, rigidities, loads).displacements
    assert close(here, solve_frame(rolled, exchanged, loads).displacements, 1e-10)


@pytest.mark.parametrize("seed", SEEDS)
def test_combinations_of_answers_are_the_answers_to_combinations(seed):
    frame, rigidities, loads = case(seed)
    factors = np.random.default_rng(300 + seed).standard_normal((4, 3))
    together = Loads(
        tuple("abcd"),
        ("imposed",) * 4,
        *(np.tensordot(factors, v, 1) for v in (loads.gravity, loads.nodal, loads.line)),
    )
    mixed = solve_frame(frame, rigidities, loads).combined(factors)
    at_once = solve_frame(frame, rigidities, together)
    stations = np.linspace(0, 1, 5)
    for name in ("displacements", "reactions", "end_forces", "end_displacements", "line"):
        assert close(getattr(mixed, name), getattr(at_once, name), 1e-9)
    assert close(mixed.forces(stations), at_once.forces(stations), 1e-9)
    assert close(mixed.deflections(stations), at_once.deflections(stations), 1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_two_loads_do_the_same_work_on_each_other_as_betti_says(seed):
    frame, rigidities, loads = case(seed, cases=2)
    loads = replace(loads, gravity=0 * loads.gravity, line=0 * loads.line)
    moved = solve_frame(frame, rigidities, loads).displacements
    work = np.einsum("cni,dni->cd", loads.nodal, moved)
    assert work[0, 1] == pytest.approx(work[1, 0], rel=1e-9, abs=1e-9 * work[0, 0])
