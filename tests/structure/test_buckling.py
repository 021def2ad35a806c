"""Linear buckling against Euler, Greenhill, Engesser and Wagner, and second-order theory."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError, SceneError
from heliform.engines.structure import modes as modes_module
from heliform.engines.structure.assembly import pattern_of
from heliform.engines.structure.buckling import buckles_below, buckling_factors, buckling_modes
from heliform.engines.structure.frame import Frame
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.second_order import solve_second_order
from scipy.optimize import brentq
from structure.lines import LENGTH, STIFF, line_of, loads_of, portal, rigid

EULER = np.pi**2 * STIFF / LENGTH**2
WEDGE = brentq(lambda x: np.tan(x) - x, 4.4, 4.6)
ALL = (0, 1, 3, 4, 5)
"""All freedoms but the way down."""
ENDS = {
    "free above": (range(6), (), 0.25),
    "hinged": ((0, 1, 2, 5), (0, 1), 1.0),
    "clamped below, hinged above": (range(6), (0, 1), (WEDGE / np.pi) ** 2),
    "clamped": (range(6), ALL, 4.0),
    "clamped, free to sway": (range(6), (3, 4, 5), 1.0),
}


def column(ends, count=1, **how):
    frame = line_of(count, *ENDS[ends][:2])
    stiff = rigid(count, **how)
    return frame, stiff, solve_frame(frame, stiff, loads_of(frame, {count: (0, 0, -1, 0, 0, 0)}))


@pytest.mark.parametrize("ends", ENDS)
def test_a_column_buckles_above_its_least_factor_and_not_below(ends):
    frame, stiff, response = column(ends, 4)
    factor = buckling_factors(frame, stiff, response, 1, pieces=1)[0][0]
    twice = response.combined(np.array([[0.5], [1.0], [2.0], [-1.0]]))

    def below(times):
        return buckles_below(frame, stiff, twice, times, pattern_of(frame)).tolist()

    assert below(0.999 * factor) == [False, False, True, False]
    assert below(1.001 * factor) == [False, True, True, False]
    assert below(2.001 * factor) == [True, True, True, False]  # what pulls never buckles


@pytest.mark.parametrize("ends", ENDS)
def test_a_divided_column_comes_to_eulers_load_with_the_fourth_power(ends):
    frame, stiff, response = column(ends)
    truth = EULER * ENDS[ends][2]
    away = [
        buckling_factors(frame, stiff, response, 1, pieces=n)[0][0] / truth - 1 for n in (4, 8, 16)
    ]
    assert 0 < away[2] < 4e-5
    assert away[0] / away[1] == pytest.approx(16, rel=0.2)
    assert away[1] / away[2] == pytest.approx(16, rel=0.1)


def test_four_pieces_are_as_good_as_promised():
    for ends, promised in (("hinged", 1e-3), ("clamped", 8e-3)):
        frame, stiff, response = column(ends)
        assert (
            buckling_factors(frame, stiff, response, 1)[0][0]
            < (1 + promised) * EULER * ENDS[ends][2]
        )


def test_a_member_released_at_its_ends_buckles_as_one_with_hinges():
    frame = line_of(1, range(6), ALL)
    releases = np.zeros((1, 12), dtype=bool)
    releases[0, [4, 5, 10, 11]] = True
    frame, stiff = replace(frame, releases=releases), rigid(1)
    response = solve_frame(frame, stiff, loads_of(frame, {1: (0, 0, -1, 0, 0, 0)}))
    away = [
        buckling_factors(frame, stiff, response, 1, pieces=n)[0][0] / EULER - 1 for n in (4, 8, 16)
    ]
    assert 0 < away[2] < 1e-4
    assert away[0] > away[1] > away[2]


def test_members_drawn_in_pieces_buckle_like_members_divided():
    whole = buckling_factors(*column("hinged"), 2, pieces=6)[0]
    assert buckling_factors(*column("hinged", 6), 2, pieces=1)[0] == pytest.approx(whole, rel=1e-10)


@pytest.mark.parametrize(("fixed", "truth"), [(True, 7.3792), (False, 1.8213)])
def test_a_portal_of_equal_members_buckles_sideways_at_the_known_load(fixed, truth):
    frame = portal(fixed)
    stiff = rigid(3, stiff=0.5, axial=1e9)  # 1 N·m² in its plane, which is about local z
    response = solve_frame(
        frame, stiff, loads_of(frame, {1: (0, 0, -1, 0, 0, 0), 2: (0, 0, -1, 0, 0, 0)})
    )
    modes = buckling_modes(frame, stiff, response, 1, pieces=8)
    assert modes.values[0] == pytest.approx(truth, rel=2e-5)
    sway = modes.nodes[0, :, 0]
    assert sway[1] == pytest.approx(sway[2], rel=1e-6)
    assert abs(sway[1]) == pytest.approx(np.abs(modes.along).max(), rel=1e-9)


def test_a_column_under_its_own_weight_is_greenhills():
    frame = line_of(1)
    stiff = rigid(1, mass=1.0)
    response = solve_frame(frame, stiff, loads_of(frame, gravity=(0, 0, -1.0)))
    found = buckling_factors(frame, stiff, response, 1, pieces=8)[0][0]
    assert found == pytest.approx(7.83735 * STIFF / LENGTH**3, rel=2e-5)


def test_shear_lowers_the_load_as_engesser_has_it():
    shear = 3 * EULER
    found = buckling_factors(*column("hinged", shear=shear), 1, pieces=64)[0][0]
    assert found == pytest.approx(EULER / (1 + EULER / shear), rel=2e-4)


def test_a_cross_of_thin_plates_twists_at_wagners_load():
    thin = {"torsion": 0.1 * STIFF, "mass": 1.0, "rotary": 0.8}
    frame, stiff, response = column("clamped", **thin)
    modes = buckling_modes(frame, stiff, response, 1, pieces=16)
    twist = 0.1 * STIFF / 0.8
    assert twist < EULER
    assert modes.values[0] == pytest.approx(twist, rel=1e-9)


def test_modes_are_half_waves_of_a_hinged_column():
    frame, stiff, response = column("hinged")
    modes = buckling_modes(frame, stiff, response, 3, pieces=8)
    # Along z first and third: 1² and 2² times EI; along y 1² times 2 EI is second
    assert modes.values / EULER == pytest.approx([1, 2, 4], rel=3e-3)
    wave = np.sin(np.pi * np.linspace(0, 1, 9))
    along = modes.along[0, 0, :, 0]
    assert along * np.sign(along[4]) == pytest.approx(wave, abs=1e-4)
    assert np.abs(modes.along).max(axis=(1, 2, 3)) == pytest.approx(1)
    assert modes.nodes.shape == (3, 2, 6)


def test_nothing_buckles_in_tension():
    frame, stiff, _ = column("hinged")
    pulled = solve_frame(frame, stiff, loads_of(frame, {1: (0, 0, 1, 0, 0, 0)}))
    factors, shapes = buckling_factors(frame, stiff, pulled, 3)
    assert factors.shape == (0,)
    assert shapes.shape == (0, 2, 6)
    modes = buckling_modes(frame, stiff, solve_frame(frame, stiff, loads_of(frame)), 3)
    assert len(modes.values) == 0


def test_a_node_that_cannot_move_does_not_buckle_undivided():
    frame, stiff, response = column("clamped")
    assert len(buckling_factors(frame, stiff, response, 1, pieces=1)[0]) == 0
    assert len(buckling_factors(frame, stiff, response, 1, pieces=2)[0]) == 1


def test_tension_beside_compression_does_not_hide_the_lowest_factor():
    """A column under a hanger a million times as stiff, pulled a thousand times as hard."""
    nodes = np.array([(0, 0, 0), (0, 0, 5.0), (0, 0, 10.0)])
    held = np.zeros((3, 6), dtype=bool)
    held[0] = held[2] = True
    held[1, [0, 1, 3, 4, 5]] = True
    members = np.array([(0, 1), (1, 2)], dtype=np.int32)
    frame = Frame(nodes, members, np.tile((1.0, 0, 0), (2, 1)), held)
    stiff = rigid(2)
    stiff = replace(stiff, axial=np.array([1e6, 1e9]))
    response = solve_frame(frame, stiff, loads_of(frame, {1: (0, 0, -1001, 0, 0, 0)}))
    found = buckling_factors(frame, stiff, response, 1, pieces=8)[0][0]
    assert found == pytest.approx(4 * EULER, rel=1e-3)


def tower(storeys=6):
    """Four columns with rings of beams, loaded unevenly: 40 to 50 nodes in space."""
    corners = np.array([(0, 0), (3, 0), (3, 3.3), (0, 3.3)])
    nodes = [(x, y, 3.0 * k) for k in range(storeys + 1) for x, y in corners]
    columns = [(4 * k + c, 4 * k + c + 4) for k in range(storeys) for c in range(4)]
    beams = [(4 * k + c, 4 * k + (c + 1) % 4) for k in range(1, storeys + 1) for c in range(4)]
    members = np.array(columns + beams, dtype=np.int32)
    upright = np.arange(len(members)) < len(columns)
    normals = np.where(upright[:, None], (1.0, 0, 0), (0, 0, 1.0))
    held = np.zeros((len(nodes), 6), dtype=bool)
    held[:4] = True
    frame = Frame(np.array(nodes), members, normals, held)
    push = {4 * storeys + c: (0, 0, -1e3 * (1 + c), 0, 0, 0) for c in range(4)}
    return frame, rigid(len(members), shear=1e8), loads_of(frame, push)


def test_second_order_theory_ends_where_the_frame_buckles():
    frame, stiff, loads = tower(2)
    response = solve_frame(frame, stiff, loads)
    factor = buckling_factors(frame, stiff, response, 1, pieces=8)[0][0]
    solve_second_order(frame, stiff, loads, [[0.98 * factor]])
    with pytest.raises(SceneError, match="Combination 0"):
        solve_second_order(frame, stiff, loads, [[1.02 * factor]])


def test_lanczos_finds_what_the_whole_matrix_has(monkeypatch):
    frame, stiff, loads = tower()
    response = solve_frame(frame, stiff, loads)
    few = buckling_modes(frame, stiff, response, 6, pieces=3)
    assert (np.diff(few.values) >= 0).all()
    monkeypatch.setattr(modes_module, "_DENSE", 10_000)
    whole = buckling_modes(frame, stiff, response, 6, pieces=3)
    assert few.values == pytest.approx(whole.values, rel=1e-8)
    for one, other in zip(few.along, whole.along, strict=True):
        agree = np.sum(one * other) ** 2 / np.sum(one**2) / np.sum(other**2)
        assert agree == pytest.approx(1, abs=1e-6)


def test_several_combinations_are_refused():
    frame, stiff, response = column("hinged")
    with pytest.raises(ParameterError, match="2 were given"):
        buckling_factors(frame, stiff, response.combined([[1.0], [2.0]]), 1)
