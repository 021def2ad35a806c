"""The spiral toolpath: where it runs, its spacing and timing, and the traps of other spirals."""

import numpy as np
import pytest
from glass.paths import LOFTS, THICKNESS, circle, lobed, machine, path_on, polar, roomy
from heliform.engines.core.errors import ParameterError
from heliform.engines.glass.machine import load_machine
from heliform.engines.glass.toolpath import Spiral, inputs_of, spiral

RISE = 5e-3
every_loft = pytest.mark.parametrize("name", LOFTS)


@every_loft
def test_every_point_is_on_the_loft(name):
    """Smoothing would move them off it."""
    loft = LOFTS[name]
    path = path_on(loft)
    there = loft.at(path.turn, path.points[:, 2] - RISE / 2).points[:, :2]
    assert np.abs(path.points[:, :2] - there).max() < 1e-9


@every_loft
def test_it_begins_and_ends_flat_and_rises_by_a_layer_a_turn_between(name):
    path = path_on(LOFTS[name])
    turn, z = path.turn, path.points[:, 2]
    assert path.turns == 11
    assert z[turn <= 1] == pytest.approx(RISE)
    assert z[turn >= 10] == pytest.approx(0.05)
    middle = (turn >= 1) & (turn <= 10)
    assert z[middle] == pytest.approx(RISE * turn[middle])
    assert (np.diff(z) >= 0).all()


@every_loft
def test_it_is_one_line_without_a_travel(name):
    path = path_on(LOFTS[name])
    move = np.sqrt((np.diff(path.points, axis=0) ** 2).sum(axis=1))
    assert 0 < move.min() <= move.max() < 2e-3 * (1 + 1e-3)
    assert path.arc == pytest.approx(np.concatenate([[0], np.cumsum(move)]))
    assert (np.diff(path.turn) > 0).all()


def test_height_follows_the_length_gone_and_not_the_points():
    """Where bends are tight points crowd; counting them the path would climb there."""
    path = path_on(lobed(waves=6, wave=0.2), step=4e-3)
    turn = (path.turn >= 4) & (path.turn <= 5)
    z, arc = path.points[turn, 2], path.arc[turn]
    share = (arc - arc[0]) / (arc[-1] - arc[0])
    assert (z - z[0]) / RISE == pytest.approx(share, abs=2e-4)
    counted = np.linspace(0, 1, len(z))
    assert np.abs(counted - share).max() > 0.005


@every_loft
def test_nothing_jumps_where_one_turn_ends_and_the_next_begins(name):
    """Flat slices that are stretched into a spiral leave a seam."""
    path = path_on(LOFTS[name])
    ends = np.flatnonzero((path.turn % 1 == 0) & (path.turn > 0) & (path.turn < path.turns))
    assert len(ends) == 10
    heading = np.diff(path.points, axis=0) / np.diff(path.arc)[:, None]
    bend = np.sqrt((np.diff(heading[:, :2], axis=0) ** 2).sum(axis=1))
    assert bend[ends - 1].max() <= bend.max() * (1 + 1e-9)
    kink = np.abs(np.diff(heading[:, 2]))
    within = (path.turn[1:-1] > 1) & (path.turn[1:-1] < path.turns - 1)
    slope = np.abs(heading[:, 2]).max()
    assert kink[within].max() < 0.02 * slope


def test_on_a_tube_the_end_of_a_turn_is_as_any_other_place():
    path = path_on(circle())
    second = np.diff(path.points, n=2, axis=0)
    size = np.sqrt((second**2).sum(axis=1))
    at = path.turn[1:-1]
    inside = (at > 1) & (at < path.turns - 1)
    seam = inside & (at % 1 == 0)
    assert seam.sum() == 8
    assert size[seam] == pytest.approx(size[inside & ~seam].mean(), rel=1e-6)


def test_the_first_turn_closes_on_itself_and_the_second_lies_right_above_its_start():
    for loft in LOFTS.values():
        path = path_on(loft)
        closed = np.flatnonzero(path.turn == 1.0)[0]
        assert path.points[closed] == pytest.approx(path.points[0], abs=1e-12)
        assert path.height[closed - 1] == pytest.approx(RISE)
        assert path.height[closed] == 0


@every_loft
def test_the_bed_turns_steadily_once_a_turn(name):
    """The angle of the path goes on; wrapped at ±180° the bed would spin back."""
    loft = LOFTS[name]
    path = path_on(loft)
    assert path.rotary[-1] - path.rotary[0] == pytest.approx(
        2 * np.pi * path.turns + loft.twist * (1 - RISE / loft.height), abs=0.01
    )
    chord = np.diff(path.points[:, :2], axis=0)
    middle = (path.rotary[1:] + path.rotary[:-1]) / 2
    across = chord[:, 0] * np.sin(middle) - chord[:, 1] * np.cos(middle)
    assert np.abs(across).max() < 1e-5
    assert np.abs(np.diff(path.rotary)).max() < 0.1


def test_chords_cut_a_bend_by_no_more_than_is_asked():
    radius, chord = 0.02, 4e-6
    path = path_on(circle(radius), chord=chord)
    middle = (path.points[1:, :2] + path.points[:-1, :2]) / 2
    cut = radius - np.hypot(*middle.T)
    assert 0.5 * chord < cut.max() < 1.01 * chord
    wide = path_on(circle(1.0), chord=1e-3, step=3e-3)
    assert np.diff(wide.arc).max() == pytest.approx(3e-3, rel=2e-3)


@pytest.mark.parametrize("name", ["tube", "lobed"])
def test_width_times_height_along_the_path_is_the_wall(name):
    loft = LOFTS[name]
    path = path_on(loft)
    wall = THICKNESS * loft.length(0.0) * loft.height
    assert path.held().sum() == pytest.approx(wall, rel=2e-5)
    assert path.laid().sum() == pytest.approx(wall, rel=2e-5)


def test_speed_is_flow_over_width_and_height_and_time_is_length_over_speed():
    path = path_on(circle(), roomy(flow=240.0))
    assert path.speed == pytest.approx(6e-3)
    assert path.width == pytest.approx(THICKNESS)
    assert path.flow == pytest.approx(240e-9 * path.height / RISE)
    assert path.seconds == pytest.approx(path.arc[-1] / 6e-3)
    own = path_on(circle(), pace="speed", speed=3e-3)
    assert own.seconds == pytest.approx(path.arc[-1] / 3e-3)


def test_where_the_melt_runs_on_speed_and_width_take_what_flow_leaves():
    printer = roomy(extrusion="none", speed_max=20.0, width_max=16.0)
    path = path_on(circle(), printer, step=2e-4)
    assert path.flow == pytest.approx(200e-9)
    assert path.width[path.full] == pytest.approx(THICKNESS)
    assert path.speed.max() == pytest.approx(20e-3)
    assert path.width.max() == pytest.approx(16e-3)
    slow = path_on(circle(), printer, pace="speed", speed=4e-3)
    assert slow.width[slow.full] == pytest.approx(10e-3)
    # A ramp's height is h x. At four times the speed and twice the width it holds the flow from
    # x = 1/8 on; below, (1/8 − x) of it is too much for a time dx L / v, in both ramps.
    girth = 2 * np.pi * 0.1
    too_much = 2 * (1 / 8) ** 2 / 2 * THICKNESS * RISE * girth * 2
    assert path.laid().sum() - path.held().sum() == pytest.approx(too_much, rel=0.02)


def test_a_tight_bend_slows_the_path_to_what_the_bed_can_turn():
    loft = lobed(waves=5, wave=0.2)
    printer = roomy(rotary_rate_max=10.0)
    path = path_on(loft, printer)
    bend = np.abs(path.curvature)
    assert (path.speed * bend).max() == pytest.approx(np.radians(10.0), rel=1e-6)
    free = bend < np.radians(10.0) / 5e-3 * 0.5
    assert path.speed[free].max() == pytest.approx(5e-3)
    assert path.width == pytest.approx(THICKNESS)


@pytest.mark.parametrize("axes", ["three", "four"])
@pytest.mark.parametrize("wave", [0.05, 0.15])
def test_the_motors_are_never_asked_for_more_than_they_have(axes, wave):
    printer = roomy(
        axes=axes,
        flow=4000.0,
        acceleration_max=200.0,
        rotary_rate_max=90.0,
        rotary_acceleration_max=200.0,
    )
    path = path_on(lobed(waves=4, wave=wave), printer, step=1e-3)
    assert path.speed.max() - path.speed.min() > 5e-3
    heading = np.diff(path.points, axis=0) / np.diff(path.arc)[:, None]
    velocity = heading * (np.diff(path.arc) / np.diff(path.time))[:, None]
    instant = (path.time[1:] + path.time[:-1]) / 2
    force = np.diff(velocity, axis=0) / np.diff(instant)[:, None]
    assert np.sqrt((force**2).sum(axis=1)).max() < 0.2 * 1.02
    if axes == "four":
        rate = np.diff(path.rotary) / np.diff(path.time)
        assert rate.max() < np.radians(90) * 1.01
        assert np.abs(np.diff(rate) / np.diff(instant)).max() < np.radians(200) * 1.05


def test_a_wall_of_one_layer_is_one_flat_turn():
    path = path_on(circle(height=RISE))
    assert path.turns == 1
    assert path.points[:, 2] == pytest.approx(RISE)
    assert path.held().sum() == pytest.approx(THICKNESS * RISE * 0.2 * np.pi, rel=1e-4)


def test_layers_are_stretched_to_reach_the_top():
    path = path_on(circle(height=0.0513))
    assert path.layer_height == pytest.approx(0.0513 / 10)
    assert path.points[-1, 2] == pytest.approx(0.0513)


def test_a_polygon_with_tight_corners_still_has_a_path():
    square = polar(lambda t: 0.1 / np.maximum(np.abs(np.cos(t)), np.abs(np.sin(t))))
    path = path_on(square)
    assert np.isfinite(path.points).all()
    assert np.diff(path.arc).max() < 2.1e-3


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"layer_height": 0.02}, "holds no layer"),
        ({"step": 1e-5, "chord": 1e-7}, "more than 4 million"),
        ({"layer_height": -1.0}, "out of bounds"),
    ],
)
def test_what_cannot_be_laid_is_told_in_one_sentence(changes, said):
    loft = circle(height=8e-3) if "holds" in said else circle(height=0.5)
    with pytest.raises(ParameterError, match=said):
        path_on(loft, **changes)


def test_the_hash_of_the_inputs_follows_each_of_them():
    printer = load_machine()
    one = inputs_of(circle(), THICKNESS, Spiral(), printer)
    assert one == spiral(circle(), THICKNESS, Spiral(), printer).inputs
    others = {
        inputs_of(circle(0.101), THICKNESS, Spiral(), printer),
        inputs_of(circle(twist=0.1), THICKNESS, Spiral(), printer),
        inputs_of(circle(), 7e-3, Spiral(), printer),
        inputs_of(circle(), THICKNESS, Spiral(step=1e-3), printer),
        inputs_of(circle(), THICKNESS, Spiral(), machine(flow=210.0)),
    }
    assert len(others | {one}) == 6
