"""Members between displaced nodes are where beam theory has them."""

import numpy as np
from heliform.engines.structure.bent import bent_members
from heliform.engines.structure.frame import FIXED, Frame, Rigidities
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.loads import Loads

STATIONS = np.linspace(0, 1, 7)


def frame_of(nodes, members):
    held = np.zeros((len(nodes), 6), dtype=bool)
    held[0] = FIXED
    up = np.tile((0.0, 0.3, 1.0), (len(members), 1))
    return Frame(np.array(nodes, dtype=float), np.array(members, dtype=np.int32), up, held)


def test_loads_at_nodes_bend_members_as_the_analysis_has_it():
    frame = frame_of([(0, 0, 0), (3, 1, 0), (5, 1, 2)], [(0, 1), (1, 2)])
    ones = np.ones(2)
    stiff = Rigidities(
        1e8 * ones, 3e6 * ones, 1e6 * ones, 5e5 * ones, *[np.inf * ones] * 2, ones, ones
    )
    nodal = np.zeros((1, 3, 6))
    nodal[0, 2] = (2e3, -1e3, -4e3, 500, 200, -300)
    response = solve_frame(
        frame, stiff, Loads(("tip",), ("imposed",), np.zeros((1, 3)), nodal, np.zeros((1, 2, 2, 3)))
    )
    deflections, turns = bent_members(frame, response.displacements[0], STATIONS)
    truth = response.deflections(STATIONS)[0]
    np.testing.assert_allclose(deflections, truth, atol=1e-12 * np.abs(truth).max() + 1e-15)
    np.testing.assert_array_equal(turns, response.displacements[0, frame.members, 3:])


def test_a_rigid_motion_leaves_members_straight_and_whole():
    frame = frame_of([(0, 0, 0), (3, 1, 0), (5, 1, 2)], [(0, 1), (1, 2)])
    shift, turn = np.array((0.1, -0.2, 0.3)), np.array((1e-3, 2e-3, -3e-3))
    moved = np.concatenate([shift + np.cross(turn, frame.nodes), np.tile(turn, (3, 1))], axis=1)
    deflections, _ = bent_members(frame, moved, STATIONS)
    ends = frame.ends()
    along = ends[:, :1] + STATIONS[:, None] * (ends[:, 1:] - ends[:, :1])
    np.testing.assert_allclose(deflections, shift + np.cross(turn, along), atol=1e-14)
