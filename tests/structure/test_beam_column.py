"""Members under axial force: Stumpff's functions, exact stiffness, and its limits."""

from math import factorial

import numpy as np
import pytest
from heliform.engines.structure.beam_column import BeamColumns, stumpff
from heliform.engines.structure.beam_shapes import local_geometric
from heliform.engines.structure.frame import Rigidities
from heliform.engines.structure.stiffness import coefficients, equivalent_loads, local_stiffness
from scipy.integrate import solve_bvp

MEMBERS = 5


def members(seed=0):
    rng = np.random.default_rng(seed)
    rigidities = Rigidities(*rng.uniform(1, 2, (8, MEMBERS)))
    return rigidities, rng.uniform(1, 2, MEMBERS), rng.normal(size=(1, MEMBERS, 2, 3))


@pytest.mark.parametrize("z", [-30.0, -1.01, -0.99, 0.0, 0.3, 1.01, 30.0])
def test_stumpffs_functions_are_their_series(z):
    truth = [sum((-z) ** j / factorial(2 * j + n) for j in range(60)) for n in range(6)]
    assert stumpff(np.array(z)) == pytest.approx(truth, rel=1e-13)


def test_without_axial_force_it_is_the_beam_of_first_order():
    rigidities, lengths, line = members()
    columns = BeamColumns(rigidities, lengths, np.zeros(MEMBERS))
    truth = local_stiffness(rigidities, lengths)
    assert columns.stiffness() == pytest.approx(truth, rel=1e-13, abs=1e-13)
    loads = equivalent_loads(coefficients(rigidities, lengths), line)
    assert columns.equivalent_loads(line) == pytest.approx(loads, rel=1e-12, abs=1e-14)


def test_a_little_axial_force_adds_the_geometric_stiffness():
    rigidities, lengths, _ = members()
    step = 1e-4

    def stiffness(force):
        return BeamColumns(rigidities, lengths, np.full(MEMBERS, force)).stiffness()

    slope = (stiffness(step) - stiffness(-step)) / (2 * step)
    truth = local_geometric(np.ones((MEMBERS, 2)), rigidities, lengths)
    assert slope == pytest.approx(truth, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("force", [-0.7, 0.5, 40.0])
def test_members_move_as_the_differential_equations_say(force):
    rigidities, lengths, line = members(1)
    ends = np.random.default_rng(2).normal(size=(1, MEMBERS, 12))
    columns = BeamColumns(rigidities, lengths, np.full(MEMBERS, force))
    along, sign, motion = next(iter(columns.motions(ends, line)))
    length, stiff, shear = lengths[0], rigidities.bending_z[0], rigidities.shear_y[0]
    first, last = line[0, 0, :, along]
    start, start_turn, end, end_turn = ends[0, 0, [1, 5, 7, 11]]

    def change(x, y):  # w, ψ, M, R
        _, turn, moment, across = y
        slope = (across + shear * turn) / (shear + force)
        return [
            slope,
            moment / stiff,
            -shear * (slope - turn),
            -first - (last - first) * x / length,
        ]

    def apart(a, b):
        return [a[0] - start, a[1] - start_turn, b[0] - end, b[1] - end_turn]

    x = np.linspace(0, length, 400)
    found = solve_bvp(change, apart, x, np.zeros((4, len(x))), tol=1e-9, max_nodes=100_000)
    assert found.success
    at = np.array([0.0, 0.2, 0.5, 0.9, 1.0])
    truth = found.sol(at * length)
    middle = (at - 0.5)[:, None, None] * lengths
    assert motion.deflection(middle)[:, 0, 0] == pytest.approx(truth[0], abs=1e-7)
    assert motion.moment(middle)[:, 0, 0] == pytest.approx(truth[2], abs=1e-6)
    assert motion.across(middle)[:, 0, 0] == pytest.approx(truth[3], abs=1e-6)
    assert sign == 1.0


@pytest.mark.parametrize("force", [1e3, 1e5])
def test_a_taut_member_hangs_like_a_rope(force):
    rigidities, lengths, _ = members()
    line = np.zeros((1, MEMBERS, 2, 3))
    line[..., 2] = 1.0
    columns = BeamColumns(rigidities, lengths, np.full(MEMBERS, force))
    *_, (_, _, motion) = columns.motions(np.zeros((1, MEMBERS, 12)), line)
    sag = motion.deflection(np.zeros(MEMBERS))[0]
    # A rope's sag less what its clamped ends take off, to the first order in 1 ÷ kL
    k = np.sqrt(force / rigidities.bending_y * motion.flexure.eta)
    rope = lengths**2 / (8 * force)
    assert (sag < rope).all()
    assert sag == pytest.approx(rope * (1 - 4 / (k * lengths)), rel=10 / (k * lengths).min() ** 2)


def test_the_stiffness_is_symmetric_and_runs_smoothly_into_taut_members():
    rigidities, lengths, line = members()
    for force in (-1.0, 10.0, 30.0, 100.0, 300.0, 1e4, 1e6):
        columns = BeamColumns(rigidities, lengths, np.full(MEMBERS, force))
        matrix = columns.stiffness()
        assert matrix == pytest.approx(
            matrix.transpose(0, 2, 1), rel=1e-12, abs=1e-12 * matrix.max()
        )
    edge = 4 * 25 * (rigidities.bending_y / lengths**2)[0]
    sides = [
        BeamColumns(rigidities, lengths, np.full(MEMBERS, edge * f)) for f in (0.999999, 1.000001)
    ]
    below, above = (side.stiffness() for side in sides)
    assert below == pytest.approx(above, rel=2e-6)
    below, above = (side.equivalent_loads(line) for side in sides)
    assert below == pytest.approx(above, rel=2e-6)


def test_a_member_buckles_between_clamped_ends_at_four_times_eulers_load():
    lengths, one = np.array([2.0]), np.ones(1)
    stiff = Rigidities(one, one, 3 * one, 1e9 * one, np.inf * one, np.inf * one, one, 0 * one)
    critical = 4 * np.pi**2 / 4
    assert not BeamColumns(stiff, lengths, np.array([-0.9999 * critical])).buckled().any()
    assert BeamColumns(stiff, lengths, np.array([-1.0001 * critical])).buckled().all()


def test_a_member_twists_away_at_its_torsional_stiffness_over_its_polar_radius():
    lengths, one = np.array([2.0]), np.ones(1)
    thin = Rigidities(
        one, 1e6 * one, 1e6 * one, 3 * one, np.inf * one, np.inf * one, 2 * one, 0.5 * one
    )
    assert not BeamColumns(thin, lengths, np.array([-11.99])).buckled().any()
    assert BeamColumns(thin, lengths, np.array([-12.01])).buckled().all()
