"""Overlaps: closed forms of what is kept, and what is said of it."""

import numpy as np
import pytest
import shapely
from heliform.engines.core.errors import ParameterError
from heliform.engines.glass.overlap import is_clear, resolved

THETA = np.linspace(0, 2 * np.pi, 2001)[:-1]


def polar(r):
    return np.column_stack([r * np.cos(THETA), r * np.sin(THETA)])


def dense(corners, step=5e-4):
    ring = shapely.segmentize(shapely.linearrings(corners), step)
    return np.asarray(ring.coords)[:-1]


SLOT = dense([[-5, -5], [5, -5], [5, 5], [0.2, 5], [0.2, -2], [-0.2, -2], [-0.2, 5], [-5, 5]], 0.05)
SLOT = SLOT * 0.01  # a square of 100 mm with a slot 4 mm wide from above


def area(points):
    return shapely.Polygon(points).area


@pytest.mark.parametrize("how", ["clip", "hull"])
def test_a_clear_curve_is_returned_as_it_is(how):
    points = polar(0.1 + 0.01 * np.cos(3 * THETA))
    done = resolved(points, 0.004, how)
    assert done.points is points
    assert done.note == ""
    assert not done.erased


@pytest.mark.parametrize(("gap", "clear"), [(9e-3, True), (7e-3, False)])
def test_two_sides_closer_than_the_wall_are_seen(gap, clear):
    bow = np.linspace(-0.1, 0.1, 400)
    waist = gap / 2 + 0.005 * (1 - np.cos(np.pi * bow / 0.1))
    points = np.vstack([np.column_stack([bow, -waist]), np.column_stack([bow[::-1], waist[::-1]])])
    cap = np.linspace(-np.pi / 2, np.pi / 2, 60)[1:-1]
    right = np.column_stack([0.1 + np.cos(cap) * waist[-1], np.sin(cap) * waist[-1]])
    points = np.vstack([points[:400], right, points[400:], -right])
    assert is_clear(points, 0.004) == clear


def test_a_bend_tighter_than_half_the_wall_is_not_clear():
    assert is_clear(polar(0.0041), 0.004)
    assert not is_clear(polar(0.0039), 0.004)


def test_clipping_closes_a_slot_too_narrow_for_the_wall():
    done = resolved(SLOT, 0.004, "clip")
    corners = (4 - np.pi) * (1.2 * 0.004) ** 2
    assert area(done.points) == pytest.approx(0.01 - corners, rel=1e-3)
    assert is_clear(done.points, 0.0039)
    assert "clipped" in done.note
    assert not done.erased


def test_clipping_keeps_a_slot_wide_enough_for_the_wall():
    wide = SLOT * (6.0, 1.0)
    done = resolved(wide, 0.004, "clip")
    assert area(done.points) == pytest.approx(area(wide), rel=1e-3)


def test_the_hull_erases_concavities_and_says_so():
    done = resolved(SLOT * (6.0, 1.0), 0.004, "hull")
    assert done.erased
    assert "concavity" in done.note
    hull = shapely.Polygon(done.points)
    assert hull.convex_hull.area == pytest.approx(hull.area, rel=1e-9)


def test_the_hull_of_a_convex_curve_erases_nothing():
    done = resolved(dense([[0, 0], [0.1, 0], [0.05, 0.08]]), 0.004, "hull")
    assert done.note
    assert not done.erased


def test_of_a_curve_that_loops_twice_its_outer_side_is_kept():
    a, b = 0.1, 0.06  # limaçon r = b + a cos θ with an inner loop
    inner = (b**2 + a**2 / 2) * np.arccos(b / a) - 1.5 * b * np.sqrt(a**2 - b**2)
    outer = np.pi * (b**2 + a**2 / 2) - inner
    done = resolved(polar(b + a * np.cos(THETA)), 0.002, "clip")
    assert area(done.points) == pytest.approx(outer, rel=3e-3)
    assert shapely.linearrings(done.points).is_simple


def test_what_runs_clockwise_is_left_out():
    x = 0.05 + 0.1 * np.cos(THETA)
    eight = np.column_stack([np.where(x > 0, x, 0.3 * x), 0.05 * np.sin(2 * THETA)])
    if shapely.Polygon(eight[eight[:, 0] > 0]).exterior.is_ccw:
        eight = eight[::-1]
    done = resolved(eight, 0.002, "clip")
    assert shapely.Polygon(done.points).exterior.is_ccw
    assert shapely.linearrings(done.points).is_simple


def test_the_start_stays_where_it_was():
    done = resolved(SLOT, 0.004, "clip")
    assert np.hypot(*(done.points[0] - SLOT[0])) < 0.003


def test_a_curve_too_small_for_the_wall_is_refused():
    with pytest.raises(ParameterError, match="no room for a wall of 8 mm"):
        resolved(polar(0.003), 0.004, "clip")
