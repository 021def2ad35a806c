"""The frame solver against what can be worked out with pencil and paper."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.structure.frame import FIXED
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.loads import GRAVITY
from structure.frames import arc, cases_of, chain_of, frame_of, rotation, stiff

BENDING = 2.0e6
SHEAR = 3.0e6
ALONG = np.linspace(0.0, 1.0, 21)


def beam(count=1, length=5.0, shear=np.inf, held=None, normal=(0.0, 0.0, 1.0)):
    """A straight beam along x in so many members, clamped at its start unless ``held`` says."""
    points = np.linspace((0, 0, 0), (length, 0, 0), count + 1)
    frame = chain_of(points, held or {0: FIXED}, normal)
    return frame, stiff(count, 5e8, BENDING, 0.7 * BENDING, 0.4 * BENDING, shear, mass=12.0)


@pytest.mark.parametrize("seed", range(3))
def test_a_skew_cantilever_bends_and_shears_as_timoshenko_says(seed):
    generator = np.random.default_rng(seed)
    axes = rotation(generator)
    length, force = 3.0, 1e4
    frame = chain_of(np.array([[0, 0, 0], length * axes[0]]), {0: FIXED}, axes[2])
    section = stiff(1, 5e8, BENDING, 0.7 * BENDING, 1e6, SHEAR)
    push = np.concatenate([force * axes[2], np.zeros(3)])
    moved = solve_frame(frame, section, cases_of(frame, {1: push})).displacements[0, 1]
    deflection = force * length**3 / (3 * BENDING) + force * length / SHEAR
    np.testing.assert_allclose(moved[:3], deflection * axes[2], rtol=1e-12, atol=1e-14)
    turn = force * length**2 / (2 * BENDING)
    np.testing.assert_allclose(moved[3:], -turn * axes[1], rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("shear", [np.inf, SHEAR])
@pytest.mark.parametrize("ends", [(2000.0, 2000.0), (0.0, 3000.0), (-4000.0, 1000.0)])
def test_a_cantilever_under_a_linear_load_has_the_forces_and_deflections_of_a_fine_one(shear, ends):
    one, section = beam(1, shear=shear)
    load = np.outer(ends, (0.3, -0.4, -1.0))
    coarse = solve_frame(one, section, cases_of(one, line={0: load}))
    fine, sections = beam(20, shear=shear)
    at = np.linspace(load[0], load[1], 21)
    pieces = {k: at[k : k + 2] for k in range(20)}
    many = solve_frame(fine, sections, cases_of(fine, line=pieces))
    np.testing.assert_allclose(
        coarse.deflections(ALONG)[0, 0], many.displacements[0, :, :3], rtol=1e-9, atol=1e-12
    )
    forces = np.concatenate([many.forces(np.array([0.0]))[0, :, 0], many.end_forces[0, -1:, 6:]])
    np.testing.assert_allclose(coarse.forces(ALONG)[0, 0], forces, rtol=1e-9, atol=1e-6)


def test_a_clamped_beam_under_a_uniform_load_has_its_textbook_moments_and_sag():
    length, load = 5.0, 3000.0
    frame, section = beam(1, length, held={0: FIXED, 1: FIXED})
    response = solve_frame(frame, section, cases_of(frame, line={0: (0.0, 0.0, -load)}))
    moments = response.forces(np.array([0.0, 0.5, 1.0]))[0, 0, :, 4]
    ends, middle = load * length**2 / 12, load * length**2 / 24
    np.testing.assert_allclose(moments, [ends, -middle, ends], rtol=1e-12)
    sag = response.deflections(np.array([0.5]))[0, 0, 0, 2]
    assert sag == pytest.approx(-load * length**4 / (384 * BENDING), rel=1e-12)


def test_a_hinged_beam_under_a_triangular_load_has_its_textbook_reactions_and_moment():
    length, load = 5.0, 3000.0
    hinged = (True, True, True, True, False, False)
    frame, section = beam(1, length, held={0: hinged, 1: hinged})
    ramp = {0: np.array([(0.0, 0.0, 0.0), (0.0, 0.0, -load)])}
    response = solve_frame(frame, section, cases_of(frame, line=ramp))
    np.testing.assert_allclose(
        response.reactions[0, :, 2], [load * length / 6, load * length / 3], rtol=1e-12
    )
    most = response.forces(np.array([1 / np.sqrt(3)]))[0, 0, 0]
    assert most[4] == pytest.approx(-load * length**2 / (9 * np.sqrt(3)), rel=1e-12)
    assert most[2] == pytest.approx(0.0, abs=1e-9 * load * length)


def test_a_positive_normal_force_is_tension_and_a_hogging_beam_bends_about_positive_y():
    frame, section = beam(1, 2.0)
    response = solve_frame(frame, section, cases_of(frame, {1: (7.0, 0, -3.0, 0, 0, 0)}))
    root = response.forces(np.array([0.0]))[0, 0, 0]
    np.testing.assert_allclose(root, [7.0, 0.0, -3.0, 0.0, 6.0, 0.0], atol=1e-12)


def test_a_ring_pulled_across_its_diameter_widens_as_the_closed_form_says():
    count, radius, force = 360, 1.5, 1e3
    points = arc(radius, 0.0, 2 * np.pi, count)[:-1]
    members = [(k, (k + 1) % count) for k in range(count)]
    frame = frame_of(points, members, {0: FIXED})
    section = stiff(count, 1e12, 1e6, 1e6, 1e6)
    half = count // 2
    response = solve_frame(frame, section, cases_of(frame, {half: (-force, 0, 0, 0, 0, 0)}))
    widened = -response.displacements[0, half, 0]
    assert widened == pytest.approx((np.pi / 4 - 2 / np.pi) * force * radius**3 / 1e6, rel=2e-4)


def test_a_quarter_ring_loaded_out_of_its_plane_bends_and_twists_as_the_closed_form_says():
    count, radius, force, bending, torsion = 200, 1.5, 1e3, 1e6, 4e5
    frame = chain_of(arc(radius, 0.0, np.pi / 2, count), {0: FIXED})
    section = stiff(count, 1e12, bending, 3e6, torsion)
    response = solve_frame(frame, section, cases_of(frame, {count: (0, 0, force, 0, 0, 0)}))
    expected = force * radius**3 * (np.pi / (4 * bending) + (0.75 * np.pi - 2) / torsion)
    assert response.displacements[0, -1, 2] == pytest.approx(expected, rel=2e-5)


def test_crossed_beams_share_a_load_by_their_stiffness():
    long, short, stiff_long, stiff_short, force = 6.0, 4.0, 3e6, 1e6, 1e4
    nodes = [(0, 0, 0), (-long / 2, 0, 0), (long / 2, 0, 0), (0, -short / 2, 0), (0, short / 2, 0)]
    hinged = (True, True, True, False, False, False)
    held = {1: (True, True, True, False, False, True), 2: hinged, 3: hinged, 4: hinged}
    frame = frame_of(nodes, [(1, 0), (0, 2), (3, 0), (0, 4)], held)
    bending = np.array([stiff_long, stiff_long, stiff_short, stiff_short])
    response = solve_frame(
        frame, stiff(4, 1e9, bending, bending, 1e-3), cases_of(frame, {0: (0, 0, -force, 0, 0, 0)})
    )
    together = 48 * (stiff_long / long**3 + stiff_short / short**3)
    assert response.displacements[0, 0, 2] == pytest.approx(-force / together, rel=1e-8)


def test_a_parabolic_arch_thrusts_without_bending_under_a_load_even_in_plan():
    count, span, rise, load = 64, 20.0, 4.0, 5e3
    x = np.linspace(0.0, span, count + 1)
    points = np.stack([x, 0 * x, 4 * rise * x * (span - x) / span**2], axis=1)
    plane = (False, True, False, True, False, True)
    held = dict.fromkeys(range(count + 1), plane)
    held[0] = held[count] = (True, True, True, True, False, True)
    frame = chain_of(points, held, (0.0, 1.0, 0.0))
    step = span / count
    nodal = dict.fromkeys(range(1, count), (0, 0, -load * step, 0, 0, 0))
    response = solve_frame(frame, stiff(count, 1e13, 1e6, 1e6, 1e6), cases_of(frame, nodal))
    thrust = load * span**2 / (8 * rise)
    assert response.reactions[0, 0, 0] == pytest.approx(thrust, rel=1e-3)
    moments = response.forces(ALONG)[0, :, :, 4:]
    assert np.abs(moments).max() < 1e-4 * load * span**2 / 8


def test_weight_is_mass_times_gravity_and_hangs_as_a_line_load_would():
    frame, section = beam(3)
    heavy = solve_frame(frame, section, cases_of(frame, gravity=(0.0, 0.0, -GRAVITY)))
    same = dict.fromkeys(range(3), (0.0, 0.0, -12.0 * GRAVITY))
    loaded = solve_frame(frame, section, cases_of(frame, line=same))
    np.testing.assert_allclose(heavy.displacements, loaded.displacements, rtol=1e-12)
    assert heavy.reactions[0, 0, 2] == pytest.approx(12.0 * GRAVITY * 5.0, rel=1e-12)


def test_a_propped_cantilever_on_a_spring_shares_the_load_with_it():
    length, force, spring = 5.0, 1e4, 2e5
    frame, section = beam(1, length)
    springs = np.zeros((2, 6))
    springs[1, 2] = spring
    frame = replace(frame, springs=springs)
    response = solve_frame(frame, section, cases_of(frame, {1: (0, 0, -force, 0, 0, 0)}))
    sag = force / (3 * BENDING / length**3 + spring)
    assert response.displacements[0, 1, 2] == pytest.approx(-sag, rel=1e-12)
    assert response.reactions[0, 1, 2] == pytest.approx(spring * sag, rel=1e-12)
    np.testing.assert_allclose(response.reactions[0, :, 2].sum(), force, rtol=1e-12)


def test_a_released_end_carries_no_moment_and_turns_by_itself():
    length, load = 5.0, 2e3
    frame, section = beam(1, length, held={0: FIXED, 1: FIXED})
    releases = np.zeros((1, 12), dtype=bool)
    releases[0, 10] = True
    frame = replace(frame, releases=releases)
    response = solve_frame(frame, section, cases_of(frame, line={0: (0.0, 0.0, -load)}))
    assert response.end_forces[0, 0, 10] == 0.0
    assert response.reactions[0, 1, 2] == pytest.approx(3 / 8 * load * length, rel=1e-12)
    turn = -load * length**3 / (48 * BENDING)
    assert response.end_displacements[0, 0, 10] == pytest.approx(turn, rel=1e-12)
    assert response.displacements[0, 1].tolist() == [0.0] * 6


def test_an_eccentric_member_pulls_its_node_round():
    # A rod along x, joined to its nodes by arms 0.3 m down: force at the node and moment F·e
    length, arm, axial = 4.0, 0.3, 5e8
    frame, section = beam(1, length, held={0: FIXED})
    down = np.tile((0.0, 0.0, -arm), (1, 2, 1))
    frame = replace(frame, offsets=down)
    force = 1e4
    response = solve_frame(frame, section, cases_of(frame, {1: (force, 0, 0, 0, 0, 0)}))
    moment = force * arm
    turn = moment * length / BENDING
    expected = force * length / axial + turn * arm
    assert response.displacements[0, 1, 0] == pytest.approx(expected, rel=1e-12)
    assert response.forces(np.array([0.5]))[0, 0, 0, 4] == pytest.approx(moment, rel=1e-12)
    np.testing.assert_allclose(response.reactions[0, 0, 4], 0.0, atol=1e-9 * moment)


def test_an_offset_member_behaves_as_one_joined_by_very_stiff_stubs():
    arms = np.array([[[0.0, 0.1, 0.2], [0.0, -0.15, 0.3]]])
    frame, section = beam(1, 4.0, shear=SHEAR)
    loads = cases_of(frame, {1: (1e3, 2e3, -3e3, 400, 500, 600)}, line={0: (10.0, 200.0, -300.0)})
    eccentric = solve_frame(replace(frame, offsets=arms), section, loads)
    nodes = np.array([(0, 0, 0), arms[0, 0], (4, 0, 0) + arms[0, 1], (4, 0, 0)])
    stubs = chain_of(nodes, {0: FIXED}, [(1, 0, 0), (0, 0, 1), (1, 0, 0)])
    rigid = stiff(3, 1.0, 1.0, 1.0, 1.0)
    for name in ("axial", "bending_y", "bending_z", "torsion"):
        getattr(rigid, name)[:] = 1e12
        getattr(rigid, name)[1] = getattr(section, name)[0]
    rigid.shear_y[1] = rigid.shear_z[1] = SHEAR
    given = cases_of(stubs, {3: loads.nodal[0, 1]}, line={1: (10.0, 200.0, -300.0)})
    stubbed = solve_frame(stubs, rigid, given)
    np.testing.assert_allclose(
        eccentric.displacements[0, 1], stubbed.displacements[0, 3], rtol=1e-5
    )
    np.testing.assert_allclose(eccentric.end_forces[0, 0], stubbed.end_forces[0, 1], rtol=1e-6)


def test_a_frame_held_everywhere_does_not_move_and_hands_its_loads_to_the_supports():
    frame, section = beam(2, held={0: FIXED, 1: FIXED, 2: FIXED})
    response = solve_frame(frame, section, cases_of(frame, {1: (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)}))
    assert not response.displacements.any()
    np.testing.assert_allclose(response.reactions[0, 1], [-1.0, -2.0, -3.0, -4.0, -5.0, -6.0])
