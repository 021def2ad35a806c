"""Frames and loads that cannot be, refused with what is wrong and where."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure.check_frame import check_frame
from heliform.engines.structure.frame import FIXED
from heliform.engines.structure.linear import solve_frame
from structure.frames import cases_of, chain_of, frame_of, stiff

POINTS = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)], dtype=float)


def beam(**changes):
    return replace(chain_of(POINTS, {0: FIXED}), **changes)


def with_node(point, **changes):
    frame = beam()
    held = np.concatenate([frame.held, np.zeros((1, 6), dtype=bool)])
    more = {"nodes": np.concatenate([frame.nodes, [point]]), "held": held}
    return replace(frame, **(more | changes))


def in_parts():
    nodes = np.concatenate([POINTS, POINTS + np.array((0, 5, 0))])
    members = [(0, 1), (1, 2), (2, 3), (4, 5), (5, 6), (6, 7)]
    return frame_of(nodes, members, {0: FIXED, 4: (True, True, True, False, False, False)})


def changed(array, index, value):
    array = array.copy()
    array[index] = value
    return array


FRAMES = {
    "no members": (
        lambda: beam(members=np.zeros((0, 2), dtype=np.int32), normals=np.zeros((0, 3))),
        "The frame has no members: draw at least one between two nodes.",
    ),
    "wrong shape": (
        lambda: beam(normals=np.ones((2, 3))),
        "The frame's normals have the shape (2, 3); with 4 nodes and 3 members it must be (3, 3).",
    ),
    "index out of range": (
        lambda: beam(members=np.array([(0, 1), (1, 2), (2, 9)], dtype=np.int32)),
        "Member 2 refers to node 9, but there are only nodes 0 to 3; correct its end.",
    ),
    "not a number": (
        lambda: beam(nodes=changed(POINTS, (2, 1), np.nan)),
        "Node 2 has a coordinate that is not a number; correct it.",
    ),
    "infinite spring": (
        lambda: beam(springs=changed(np.zeros((4, 6)), (3, 0), np.inf)),
        "Node 3 has a spring that is not a number; correct it.",
    ),
    "negative spring": (
        lambda: beam(springs=changed(np.zeros((4, 6)), (3, 0), -1.0)),
        "Node 3 has a negative spring; make its stiffness positive.",
    ),
    "no length": (
        lambda: beam(nodes=changed(POINTS, 2, POINTS[1])),
        "Member 1 (nodes 1 and 2) has no length; remove it or merge its nodes.",
    ),
    "same node": (
        lambda: beam(members=np.array([(0, 1), (1, 2), (3, 3)], dtype=np.int32)),
        "Member 2 (nodes 3 and 3) has no length; remove it or merge its nodes.",
    ),
    "twice": (
        lambda: beam(members=np.array([(0, 1), (2, 1), (1, 2)], dtype=np.int32)),
        "Member 2 (nodes 1 and 2) is drawn twice: member 1 joins the same nodes; remove one of "
        "them.",
    ),
    "free node": (
        lambda: with_node((0.0, 1.0, 0.0)),
        "Node 4 has no member; remove it or join a member.",
    ),
    "support on nothing": (
        lambda: with_node(
            (0.0, 1.0, 0.0), held=changed(np.zeros((5, 6), dtype=bool), ([0, 4],), FIXED)
        ),
        "Node 4 is held but has no member: the support holds nothing; remove it or join a member "
        "to it.",
    ),
    "no supports": (
        lambda: beam(held=np.zeros((4, 6), dtype=bool)),
        "The frame has no supports: hold at least one node.",
    ),
    "too few supports": (
        lambda: beam(held=changed(np.zeros((4, 6), dtype=bool), (0, slice(0, 5)), True)),
        "Only 5 freedoms of the frame are held, so that it can move as a whole; hold at least six, "
        "such as all those of one node.",
    ),
    "part without supports": (
        in_parts,
        "The part of the frame with nodes 4, 5, 6 and 7 is apart from the rest and only 3 of its "
        "freedoms are held; join it to the rest, or hold at least six.",
    ),
}


@pytest.mark.parametrize("name", FRAMES)
def test_a_frame_that_cannot_be_is_refused_by_name(name):
    frame, sentence = FRAMES[name]
    with pytest.raises(SceneError) as caught:
        check_frame(frame())
    assert str(caught.value) == sentence


@pytest.mark.parametrize(
    ("field", "value", "sentence"),
    [
        ("axial", 0.0, "has axial rigidity 0; it must be positive."),
        ("bending_y", -1.0, "has bending y rigidity -1; it must be positive."),
        ("torsion", np.nan, "has torsion rigidity nan; it must be positive."),
        ("axial", np.inf, "has axial rigidity inf; it must be positive."),
        ("shear_z", 0.0, "has shear z rigidity 0; it must be positive."),
        ("mass", -2.0, "has mass -2; it must be zero or more."),
    ],
)
def test_a_member_that_does_not_resist_is_refused_by_name(field, value, sentence):
    section = stiff(3, 1e9, 1e7, 1e7, 1e7)
    getattr(section, field)[1] = value
    with pytest.raises(SceneError) as caught:
        check_frame(beam(), section)
    assert str(caught.value) == f"Member 1 (nodes 1 and 2) {sentence}"


def test_rigidities_of_another_frame_are_refused():
    with pytest.raises(SceneError, match=r"There are \(2,\) values of axial for 3 members"):
        check_frame(beam(), stiff(2, 1e9, 1e7, 1e7, 1e7))


def test_two_members_kept_apart_by_offsets_are_not_twice_the_same():
    offsets = np.zeros((2, 2, 3))
    offsets[0, :, 2], offsets[1, :, 2] = 0.2, -0.2
    frame = frame_of(POINTS[:2], [(0, 1), (0, 1)], {0: FIXED}, offsets=offsets)
    section = stiff(2, 1e9, 1e-3, 1e-3, 1e-3)
    loads = cases_of(frame, {1: (0.0, 0.0, 0.0, 0.0, 400.0, 0.0)})
    force = solve_frame(frame, section, loads).forces(np.array([0.5]))[0, :, 0, 0]
    np.testing.assert_allclose(force, [1000.0, -1000.0], rtol=1e-6)  # a couple of chords


def test_loads_that_do_not_fit_are_refused():
    frame, section = beam(), stiff(3, 1e9, 1e7, 1e7, 1e7)
    loads = cases_of(frame)
    with pytest.raises(SceneError, match=r"The nodal loads have the shape \(1, 3, 6\)"):
        solve_frame(frame, section, replace(loads, nodal=loads.nodal[:, :3]))
    loads.line[0, 1, 0, 2] = np.nan
    with pytest.raises(SceneError, match="Load case “case 0” has a line load that is not a number"):
        solve_frame(frame, section, loads)
