"""The Fourier plan: its formula, its offset, and what becomes of overlaps."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.glass.fourier import Plan, plan_curve, plan_outline
from heliform.engines.glass.overlap import is_clear
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

TWO = Plan(amplitude_1=0.12, phase_1=20.0, period_2=7, amplitude_2=-0.03, phase_2=75.0)
THETA = np.linspace(0, 2 * np.pi, 20_001)[:-1]


def radius(plan, theta):
    first = plan.amplitude_1 * np.cos(plan.period_1 * theta + np.radians(plan.phase_1))
    second = plan.amplitude_2 * np.cos(plan.period_2 * theta + np.radians(plan.phase_2))
    return plan.radius * (1 + first + second)


def polar(plan, theta):
    return radius(plan, theta) * np.exp(1j * theta)


def difference(values):
    """Derivative by θ of values on the even grid THETA, to the fourth order."""
    ahead = [np.roll(values, -n) - np.roll(values, n) for n in (1, 2)]
    return (8 * ahead[0] - ahead[1]) / (12 * THETA[1])


def test_without_offset_the_outline_is_the_sum_of_waves():
    found = plan_outline(TWO)
    theta = np.arctan2(*found.points.T[::-1])
    assert np.hypot(*found.points.T) == pytest.approx(radius(TWO, theta), rel=1e-12)
    assert found.points[0] == pytest.approx([radius(TWO, 0.0), 0.0])
    assert found.notes == ()


def test_points_stand_evenly_by_length():
    found = plan_outline(TWO, count=64)
    theta = np.unwrap(np.arctan2(*found.points.T[::-1]))

    def speed(t):
        step = 1e-5
        ahead = polar(TWO, t + step) - polar(TWO, t - step)
        more = polar(TWO, t + 2 * step) - polar(TWO, t - 2 * step)
        return abs(8 * ahead - more) / (12 * step)

    pieces = np.append(theta, 2 * np.pi)
    steps = [quad(speed, a, b)[0] for a, b in pairwise(pieces)]
    assert steps == pytest.approx(np.full(64, np.sum(steps) / 64), abs=1e-9 * np.sum(steps))


@pytest.mark.parametrize("offset", [0.0, 0.006, -0.004])
def test_derivatives_are_those_of_the_position(offset):
    position, speed, change = plan_curve(replace(TWO, offset=offset), THETA)
    assert difference(position) == pytest.approx(speed, abs=1e-8)
    assert difference(speed) == pytest.approx(change, abs=1e-7)


def test_the_offset_moves_along_the_normal_by_the_curvature():
    plan = replace(TWO, offset=0.005)
    base = polar(TWO, THETA)
    speed = difference(base)
    bend = (speed.conj() * difference(speed)).imag / np.abs(speed) ** 3
    mean = np.abs(speed).mean()  # L / 2π
    moved = base - 1j * speed / np.abs(speed) * plan.offset * (bend * mean - 1)
    assert plan_curve(plan, THETA)[0] == pytest.approx(moved, abs=1e-9)


@pytest.mark.parametrize("offset", [0.02, -0.02])
def test_a_circle_stays_itself_whatever_the_offset(offset):
    found = plan_outline(Plan(offset=offset), thickness=0.008)
    assert np.hypot(*found.points.T) == pytest.approx(0.1, rel=1e-12)


def test_offset_outward_sharpens_the_lobes_and_inward_rounds_them():
    plan = Plan(amplitude_1=0.1)
    sharpest = []
    for offset in (-0.005, 0.0, 0.005):
        _, speed, change = plan_curve(replace(plan, offset=offset), THETA)
        sharpest.append(((speed.conj() * change).imag / np.abs(speed) ** 3).max())
    assert sharpest[0] < sharpest[1] < sharpest[2]


def test_a_wall_that_misses_itself_leaves_the_analytic_curve():
    assert np.array_equal(plan_outline(TWO, 0.008).points, plan_outline(TWO).points)


def test_stretching_scales_the_curve_and_keeps_the_steps_even():
    found = plan_outline(TWO, stretch=(1.3, 0.8))
    theta = np.arctan2(found.points[:, 1] / 0.8, found.points[:, 0] / 1.3)
    size = np.hypot(found.points[:, 0] / 1.3, found.points[:, 1] / 0.8)
    assert size == pytest.approx(radius(TWO, theta), rel=1e-12)
    step = np.hypot(*np.diff(found.points, axis=0).T)
    assert np.ptp(step) < 1e-3 * step.mean()


def test_an_overlap_is_clipped_or_hulled_and_said():
    plan = Plan(period_1=8, amplitude_1=0.5)
    clip, hull = (plan_outline(plan, 0.008, how) for how in ("clip", "hull"))
    assert "clipped" in clip.notes[0]
    assert "hull" in hull.notes[0]
    assert "concavity erased" in hull.notes[0]
    lean = np.diff(hull.points[[*range(1024), 0, 1]] @ (1, 1j))
    assert np.angle(lean[1:] / lean[:-1]).min() > -1e-9
    assert hull.points[:, 0].max() == pytest.approx(clip.points[:, 0].max(), rel=1e-2)


waves = st.floats(-0.35, 0.35)
periods = st.integers(1, 13)


@settings(max_examples=25, deadline=None)
@given(periods, periods, waves, waves, st.floats(-180, 180), st.floats(-0.02, 0.02))
def test_whatever_the_waves_a_wall_that_is_made_misses_itself(k1, k2, a1, a2, phase, offset):
    plan = Plan(
        period_1=k1,
        amplitude_1=a1,
        period_2=k2,
        amplitude_2=a2,
        phase_2=phase,
        offset=offset,
    )
    try:
        found = plan_outline(plan, 0.008, count=512)
    except ParameterError:
        assume(False)
    assert is_clear(found.points, 0.004)
    _, speed, change = found.at(np.arange(4096) / 4096)
    assert np.abs((speed.conj() * change).imag / np.abs(speed) ** 3).max() * 0.004 < 1.05
    steps = np.hypot(*(found.points - np.roll(found.points, 1, axis=0)).T)
    assert steps.max() < 1.2 * steps.mean()


def test_waves_that_reach_the_middle_are_refused():
    with pytest.raises(ParameterError, match="together they must stay below 1"):
        plan_outline(Plan(amplitude_1=0.5, amplitude_2=-0.5))
