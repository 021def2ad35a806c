"""What can move is found and named; what cannot is solved."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure.frame import FIXED, HINGED
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.stiffness import local_stiffness, transform
from structure.frames import (
    cases_of,
    chain_of,
    frame_of,
    grid,
    random_frame,
    random_loads,
    random_rigidities,
    stiff,
)

SKEW = np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)


def released(count, *ends):
    """Releases (count, 12) of (member, freedom)."""
    releases = np.zeros((count, 12), dtype=bool)
    for member, freedom in ends:
        releases[member, freedom] = True
    return releases


def said(frame, count=None):
    """What is said of a frame that cannot be solved."""
    section = stiff(count or len(frame.members), 2e9, 2e7, 6e6, 5e6)
    with pytest.raises(SceneError) as caught:
        solve_frame(frame, section, cases_of(frame, gravity=(0.0, 0.0, -9.81)))
    return str(caught.value)


def straight(count, held, direction=(1.0, 0.0, 0.0), **more):
    """A straight chain of members of 1 m."""
    points = np.arange(count + 1.0)[:, None] * np.asarray(direction)
    return chain_of(points, held, **more)


def test_a_member_released_in_torsion_at_both_ends_spins():
    frame = straight(3, {0: FIXED, 3: FIXED}, releases=released(3, (1, 3), (1, 9)))
    assert said(frame) == (
        "Member 1 (nodes 1 and 2) can spin about its own axis: its torsion is released at both "
        "ends; release fewer."
    )


def test_a_member_released_along_itself_at_both_ends_slides():
    frame = straight(3, {0: FIXED, 3: FIXED}, releases=released(3, (2, 0), (2, 6)))
    assert "Member 2 (nodes 2 and 3) can slide along its own axis" in said(frame)


def test_a_member_with_shear_and_both_moments_released_swings():
    ends = released(3, (0, 2), (0, 4), (0, 10))
    frame = straight(3, {0: FIXED, 3: FIXED}, releases=ends)
    assert "Member 0 (nodes 0 and 1) can swing along its local z" in said(frame)


def test_a_chain_between_hinges_spins_about_its_axis():
    for direction, axis in (((1, 0, 0), "x"), (SKEW, "the axis of member")):
        text = said(straight(4, {0: HINGED, 4: HINGED}, direction))
        assert text.startswith("The whole frame")
        assert f"can turn about {axis}" in text


def test_a_hinged_chain_sags_where_its_hinge_is():
    hinge = released(4, (1, 10), (0, 4), (3, 10))
    text = said(straight(4, {0: FIXED, 4: FIXED}, releases=hinge))
    assert text == (
        "Node 2 and 2 others (1 and 3) can move along z: nothing resists it; hold one of them, "
        "or remove a release of members 0, 1 and 3."
    )


def test_a_hinge_at_the_foot_of_a_cantilever_lets_everything_beyond_fall():
    text = said(straight(4, {0: FIXED}, releases=released(4, (2, 4))))
    assert text == (
        "Node 4 and node 3 can move along z: nothing resists it; hold one of them, or remove a "
        "release of member 2."
    )


@pytest.mark.parametrize("place", [0.7, 1.3, 2.1])
def test_a_node_between_two_bars_hinged_at_both_ends_falls(place):
    # What condensation leaves of their bending along z is rounding, and must not pass for stiffness
    hinges = released(2, (0, 4), (0, 10), (1, 4), (1, 10))
    points = np.array([(0, 0, 0), (place, 0, 0), (3, 0, 0)])
    turns = (False, False, False, False, True, False)
    text = said(chain_of(points, {0: FIXED, 1: turns, 2: FIXED}, releases=hinges))
    assert text == (
        "Node 1 can move along z: nothing resists it; hold it, or remove a release of members 0 "
        "and 1."
    )


def test_a_node_whose_members_are_all_hinged_turns():
    nodes = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, 1, 1.5)]
    members = [(k, 4) for k in range(4)]
    held = dict.fromkeys(range(4), FIXED)
    ends = [(member, freedom) for member in range(4) for freedom in (9, 10, 11)]
    frame = frame_of(nodes, members, held, (0.0, 1.0, 0.0), releases=released(4, *ends))
    text = said(frame)
    assert text.startswith("Node 4 can turn about ")
    assert text.endswith(
        "nothing resists it; hold it, or remove a release of members 0, 1, 2 and 3."
    )


def test_a_frame_on_rollers_slides_away():
    upright = (False, False, True, False, False, False)
    frame = grid(4)
    held = np.zeros_like(frame.held)
    held[frame.held.any(axis=1)] = upright
    held[0] = (True, False, True, True, True, True)
    text = said(replace(frame, held=held))
    assert text.startswith("The whole frame")
    assert "can move along y" in text


def test_a_spring_stops_what_would_slide():
    frame = straight(2, {0: (False, True, True, True, True, True), 2: HINGED})
    frame = replace(frame, held=frame.held & ~np.eye(3, 6, dtype=bool)[[0, 1, 0]])
    assert "can move along x" in said(frame)
    springs = np.zeros((3, 6))
    springs[1, 0] = 1e3
    held = replace(frame, springs=springs)
    section = stiff(2, 2e9, 2e7, 6e6, 5e6)
    response = solve_frame(held, section, cases_of(held, {2: (10.0, 0, 0, 0, 0, 0)}))
    assert response.displacements[0, 1, 0] == pytest.approx(1e-2, rel=1e-9)


@pytest.mark.parametrize("count", [10, 100, 1000])
def test_a_long_slender_cantilever_is_no_mechanism_and_a_pinned_one_is(count):
    # EI/L³ of the whole is 1e-15 of EA/L of a piece for the longest
    section = stiff(count, 1e6, 1e4, 1e4, 1e4)
    frame = straight(count, {0: FIXED}, SKEW)
    push = np.concatenate([frame.axes()[0, 2], np.zeros(3)])
    moved = solve_frame(frame, section, cases_of(frame, {count: push})).displacements[0, -1, :3]
    np.testing.assert_allclose(
        moved, count**3 / 3e4 * push[:3], rtol=1e-8, atol=1e-8 * count**3 / 3e4
    )
    pinned = straight(count, {0: FIXED & ~np.eye(1, 6, 4, dtype=bool)[0], count // 2: FIXED}, SKEW)
    pinned = replace(pinned, releases=released(count, (count // 2, 4)))
    with pytest.raises(SceneError, match="can move along"):
        solve_frame(pinned, section, cases_of(pinned))


@pytest.mark.parametrize("stub", [1e-1, 1e-2, 1e-3])
def test_short_members_between_long_ones_are_solved_to_the_last_digits(stub):
    section = stiff(3, 2e9, 2e7, 2e7, 5e6)
    points = np.array([0.0, 5.0, 5.0 + stub, 10.0])[:, None] * SKEW
    frame = chain_of(points, {0: FIXED})
    push = np.concatenate([1e3 * frame.axes()[0, 2], np.zeros(3)])
    moved = solve_frame(frame, section, cases_of(frame, {3: push})).displacements[0, 3, :3]
    np.testing.assert_allclose(moved, push[:3] * 1000.0 / 6e7, rtol=1e-9)


def test_what_rounding_would_spoil_is_refused_with_the_members_that_do_not_go_together():
    points = np.array([0.0, 5.0, 5.0 + 1e-5, 10.0])[:, None] * SKEW
    text = said(chain_of(points, {0: FIXED}))
    assert text == (
        "Member 0 (nodes 0 and 1) gives way so easily beside member 1 (nodes 1 and 2) that "
        "rounding leaves no digit of the answer; bring their lengths and stiffness closer together."
    )


def freedoms_left(frame, rigidities):
    """How many ways a frame moves freely, found without condensing: released ends are unknowns."""
    count = 6 * len(frame.nodes)
    many = len(frame.members)
    place = 6 * frame.members[:, :, None] + np.arange(6)
    place = place.reshape(many, 12)
    local = local_stiffness(rigidities, frame.lengths())
    turn = transform(frame.axes(), frame.offsets)
    joint = np.zeros((many, 12, count + 12 * many))  # local ends from nodes and own ends
    for member in range(many):
        joint[member][:, place[member]] = turn[member]
        joint[member][frame.releases[member]] = 0.0
        own = count + 12 * member + np.flatnonzero(frame.releases[member])
        joint[member, np.flatnonzero(frame.releases[member]), own] = 1.0
    matrix = np.einsum("mia,mij,mjb->ab", joint, local, joint, optimize=True)
    used = np.concatenate([~frame.held.ravel(), frame.releases.ravel()])
    matrix = matrix[np.ix_(used, used)]
    size = np.sqrt(np.diagonal(matrix))
    size[size == 0.0] = 1.0
    return int((np.linalg.eigvalsh(matrix / np.outer(size, size)) < 1e-12).sum())


def test_random_frames_with_many_hinges_are_refused_exactly_when_they_can_move():
    generator = np.random.default_rng(0)
    loose = 0
    for _ in range(150):
        frame = random_frame(generator, releases=float(generator.uniform(0.1, 0.7)))
        rigidities = random_rigidities(generator, len(frame.members))
        loads = random_loads(generator, frame)
        if freedoms_left(frame, rigidities):
            loose += 1
            with pytest.raises(SceneError, match=r"nothing resists it|released"):
                solve_frame(frame, rigidities, loads)
        else:
            assert solve_frame(frame, rigidities, loads).imbalance.max() < 1e-9
    assert 40 < loose < 110
