"""The frame solver against numbers that are in print."""

import numpy as np
import pytest
from heliform.engines.structure.frame import FIXED
from heliform.engines.structure.linear import solve_frame
from structure.frames import arc, cases_of, chain_of, frame_of, stiff

X, Y, Z = np.eye(3)


def three_legs(length, normals):
    """Three members from held nodes 1, 2 and 3, down each axis, to node 0 at the origin."""
    nodes = np.zeros((4, 3))
    for leg, axis in enumerate((0, 1, 2)):
        nodes[1 + leg, axis] = -length
    members = [(1, 0), (2, 0), (3, 0)]
    return frame_of(nodes, members, {1: FIXED, 2: FIXED, 3: FIXED}, normals)


def test_a_space_frame_moves_as_in_logan_example_5_8():
    # in, kip; A First Course in the Finite Element Method, 4th ed.; Y up
    frame = three_legs(100.0, [Y, X, Y])
    section = stiff(3, 30000 * 10.0, 30000 * 100.0, 30000 * 100.0, 10000 * 50.0)
    loads = cases_of(frame, {0: (0.0, -50.0, 0.0, -1000.0, 0.0, 0.0)})
    moved = solve_frame(frame, section, loads).displacements[0, 0]
    printed = [7.098e-5, -0.014, -2.352e-3, -3.996e-3, 1.78e-5, -1.033e-4]
    np.testing.assert_allclose(moved, printed, rtol=2e-3)


def test_a_bent_frame_moves_as_in_logan_problem_5_58():
    points = np.array([(0, 0, 0), (10, 0, 0), (10, 0, -10), (10, -20, -10)]) * 12.0
    frame = chain_of(points, {0: FIXED, 3: FIXED}, [Y, Y, X])
    section = stiff(3, 30000 * 100.0, 30000 * 1000.0, 30000 * 200.0, 10000 * 100.0)
    loads = cases_of(
        frame, {1: (0.0, -5.0, 0.0, -1200.0, 0.0, 0.0), 2: (0.0, 0.0, 40.0, 0.0, 0.0, 0.0)}
    )
    moved = solve_frame(frame, section, loads).displacements[0]
    assert moved[1, 1] == pytest.approx(-0.063, rel=0.02)
    assert moved[2, 2] == pytest.approx(1.825, rel=0.02)


def test_rolled_members_move_and_hold_as_in_kassimali_example_8_4():
    # in, kip; Matrix Analysis of Structures, 2nd ed.; Y up; the rolls are 0°, 90° and 30°
    roll = np.radians(30.0)
    frame = three_legs(240.0, [Y, Z, (-np.sin(roll), np.cos(roll), 0.0)])
    section = stiff(3, 29000 * 32.9, 29000 * 716.0, 29000 * 236.0, 11500 * 15.1)
    loads = cases_of(frame, {0: (0.0, 0.0, 0.0, -1800.0, 0.0, 1800.0)}, line={0: (0.0, -0.25, 0.0)})
    response = solve_frame(frame, section, loads)
    printed = [-1.3522e-3, -2.7965e-3, -1.812e-3, -3.0021e-3, 1.0569e-3, 6.4986e-3]
    np.testing.assert_allclose(response.displacements[0, 0], printed, rtol=5e-5)
    reactions = [
        [5.3757, 44.106, -0.74272, 2.1722, 58.987, 2330.5],
        [-4.6249, 11.117, -6.4607, -515.55, -0.76472, 369.67],
        [-0.75082, 4.7763, 7.2034, -383.5, -60.166, -4.702],
    ]
    np.testing.assert_allclose(response.reactions[0, 1:], reactions, rtol=1e-4)


def gable(area):
    """The pitched portal of SSLL14: 20 m wide, eaves at 8 m, ridge at 12 m, hinged feet."""
    points = np.array([(0, 0, 0), (0, 0, 8), (10, 0, 12), (20, 0, 8), (20, 0, 0)])
    held = dict.fromkeys(range(5), (False, True, False, True, False, True))
    held[0] = held[4] = (True, True, True, True, False, True)
    frame = chain_of(points, held, Y)
    inertia = np.array([5e-4, 2.5e-4, 2.5e-4, 5e-4])
    return frame, stiff(4, 2.1e11 * area, 2.1e11, 2.1e11 * inertia, 2.1e11)


def test_a_pitched_portal_answers_as_in_ssll14():
    # Guide de validation des progiciels de calcul de structures, AFNOR 1990: without stretching
    frame, section = gable(1e3)
    along = 10.0 / np.hypot(10.0, 4.0)  # the load is per metre of plan
    forces = {
        2: (0.0, 0.0, -20e3, 0.0, 0.0, 0.0),
        1: (-10e3, 0.0, 0.0, 0.0, 100e3, 0.0),  # anticlockwise seen along y is clockwise here
    }
    loads = cases_of(frame, forces, line={1: (0.0, 0.0, -3e3 * along)})
    response = solve_frame(frame, section, loads)
    assert response.reactions[0, 0, 2] == pytest.approx(31500.0, rel=1e-9)
    assert response.reactions[0, 0, 0] == pytest.approx(20239.4, rel=1e-6)
    assert response.displacements[0, 2, 2] == pytest.approx(-0.03072, rel=1e-4)


def test_each_load_on_the_pitched_portal_answers_as_code_aster_prints_it():
    # V3.01.014, four cases: uplift and thrust at A, and how C moves
    frame, section = gable(1.0)
    loads = cases_of(
        frame,
        {2: (0.0, 0.0, -20e3, 0.0, 0.0, 0.0)},
        {1: (-10e3, 0.0, 0.0, 0.0, 0.0, 0.0)},
        {1: (0.0, 0.0, 0.0, 0.0, 100e3, 0.0)},
    )
    response = solve_frame(frame, section, loads)
    np.testing.assert_allclose(
        response.reactions[:, 0, [0, 2]],
        [[4881.487, 10000.0], [5976.297, 4000.0], [4576.394, -5000.0]],
        rtol=2e-5,
    )
    printed = [[0.0, -0.0149733], [-0.03000956, -0.00299466], [0.0273532, -0.001215646]]
    np.testing.assert_allclose(response.displacements[:, 2, [0, 2]], printed, rtol=2e-4, atol=1e-12)


def test_a_space_truss_pulls_and_pushes_as_in_bedford_and_fowler_6_64():
    # Statics, 4th ed.; kN, m
    nodes = [(1.1, -0.4, 0), (1, 0, 0), (0, 0, 0.6), (0, 0, -0.4), (0, 0.8, 0)]
    members = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (1, 4)]
    releases = np.zeros((6, 12), dtype=bool)
    releases[1:, [4, 5, 10, 11]] = True  # AB keeps its ends, so that A and B cannot spin
    frame = frame_of(nodes, members, {2: FIXED, 3: FIXED, 4: FIXED}, Y, releases=releases)
    loads = cases_of(frame, {0: (10.0, 60.0, 20.0, 0.0, 0.0, 0.0)})
    response = solve_frame(frame, stiff(6, 1e9, 1e2, 1e2, 1e2), loads)
    force = response.forces(np.array([0.5]))[0, :, 0, 0]
    np.testing.assert_allclose(force[3:], [32.7, 45.2, -112.1], atol=0.06)


def test_a_twisted_beam_moves_as_in_macneal_and_harder():
    # in, lbf; A proposed standard set of problems, 1985: 90° over 12 in, 12 elements, 1.1 × 0.32
    count, width, depth = 12, 1.1, 0.32
    points = np.linspace((0, 0, 0), (12, 0, 0), count + 1)
    angle = (np.arange(count) + 0.5) / count * np.pi / 2
    normals = np.stack([np.zeros(count), np.cos(angle), np.sin(angle)], axis=1)
    frame = chain_of(points, {0: FIXED}, normals)
    youngs, shear = 29e6, 29e6 / 2.44
    section = stiff(
        count,
        youngs * width * depth,
        youngs * depth * width**3 / 12,  # the wide side is along the normal, at first along y
        youngs * width * depth**3 / 12,
        shear * 0.0098,
        shear * width * depth * 5 / 6,
    )
    loads = cases_of(frame, {count: (0, 0, 1.0, 0, 0, 0)}, {count: (0, 1.0, 0, 0, 0, 0)})
    tip = solve_frame(frame, section, loads).displacements[:, -1]
    printed = sorted([1.754e-3, 5.424e-3])
    np.testing.assert_allclose(sorted([tip[0, 2], tip[1, 1]]), printed, rtol=5e-3)


def test_a_curved_beam_moves_as_in_macneal_and_harder():
    # in, lbf: a quarter circle of mean radius 4.22, 0.2 high in its plane and 0.1 thick
    count, youngs, shear = 24, 1e7, 1e7 / 2.5
    frame = chain_of(arc(4.22, 0.0, np.pi / 2, count), {0: FIXED})
    torsion = 0.2 * 0.1**3 * (1 / 3 - 0.21 * 0.5 * (1 - 0.5**4 / 12))
    section = stiff(
        count,
        youngs * 0.02,
        youngs * 0.2 * 0.1**3 / 12,
        youngs * 0.1 * 0.2**3 / 12,
        shear * torsion,
        shear * 0.02 * 5 / 6,
    )
    loads = cases_of(frame, {count: (0, 1.0, 0, 0, 0, 0)}, {count: (0, 0, 1.0, 0, 0, 0)})
    tip = solve_frame(frame, section, loads).displacements[:, -1]
    assert tip[0, 1] == pytest.approx(0.08734, rel=0.02)
    assert tip[1, 2] == pytest.approx(0.5022, rel=0.02)
