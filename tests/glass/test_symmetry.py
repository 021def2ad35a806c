"""Symmetries: one canonical plan for one shape, by the shapes themselves."""

from dataclasses import replace

import numpy as np
from heliform.engines.glass.fourier import Plan, plan_curve
from heliform.engines.glass.symmetry import canonical
from hypothesis import assume, given, settings
from hypothesis import strategies as st

SAME = 1e-8
SAMPLES = 128  # enough for waves of every period here
THETA = np.arange(SAMPLES) * (2 * np.pi / SAMPLES)
ORDER = np.arange(SAMPLES // 2 + 1)
ANGLES = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
TURNS = np.exp(1j * ANGLES[:, None] * ORDER)

heights = st.integers(-12, 12).map(lambda n: n / 100)
plans = st.builds(
    Plan,
    period_1=st.integers(1, 12),
    amplitude_1=heights,
    phase_1=st.integers(-360, 360).map(float),
    period_2=st.integers(1, 12),
    amplitude_2=heights,
    phase_2=st.integers(-360, 360).map(float),
    offset=st.integers(-5, 5).map(lambda n: n / 1000),
)


def radii(plan):
    first = plan.amplitude_1 * np.cos(plan.period_1 * THETA + np.radians(plan.phase_1))
    second = plan.amplitude_2 * np.cos(plan.period_2 * THETA + np.radians(plan.phase_2))
    return 1 + first + second


def distance(one, other):
    """Largest difference of two closed functions' waves, turned and mirrored to the least.

    The turn is that of the closest of many, made exact by Newton's method.
    """
    one, other = (np.fft.rfft(values) / SAMPLES for values in (one, other))
    best = np.inf
    for turned in (other, other.conj()):
        both = one * turned.conj()
        angles = ANGLES[np.argsort(-(TURNS @ both).real)[:40]]
        for _ in range(8):
            waves = both * np.exp(1j * angles[:, None] * ORDER)
            slope, bend = (waves * 1j * ORDER).real.sum(1), -(waves * ORDER**2).real.sum(1)
            angles = angles - np.clip(slope / np.where(bend < 0, bend, -np.inf), -0.01, 0.01)
        apart = one * np.exp(1j * angles[:, None] * ORDER) - turned
        best = min(best, np.abs(apart).max(axis=1).min())
    return best


@settings(max_examples=200, deadline=None)
@given(plans)
def test_the_canonical_plan_is_the_same_shape_and_its_own(plan):
    folded = canonical(plan)
    assert distance(radii(plan), radii(folded)) < SAME
    assert canonical(folded) == folded
    assert folded.amplitude_1 >= 0
    assert folded.amplitude_2 >= 0
    assert folded.phase_1 == 0
    assert folded.period_1 < folded.period_2 or folded.amplitude_2 == 0


@settings(max_examples=200, deadline=None)
@given(plans, st.floats(-180, 180))
def test_equal_shapes_have_equal_canonical_plans(plan, angle):
    folded = canonical(plan)
    same = [
        replace(
            plan,
            period_1=plan.period_2,
            amplitude_1=plan.amplitude_2,
            phase_1=plan.phase_2,
            period_2=plan.period_1,
            amplitude_2=plan.amplitude_1,
            phase_2=plan.phase_1,
        ),
        replace(plan, phase_1=-plan.phase_1, phase_2=-plan.phase_2),
        replace(plan, amplitude_1=-plan.amplitude_1, phase_1=plan.phase_1 + 180),
        replace(
            plan,
            phase_1=plan.phase_1 + plan.period_1 * angle,
            phase_2=plan.phase_2 + plan.period_2 * angle,
        ),
    ]
    for other in same:
        close = canonical(other)
        assert abs(close.phase_2 - folded.phase_2) < 1e-4
        assert replace(close, phase_2=folded.phase_2) == folded


@settings(max_examples=200, deadline=None)
@given(plans, plans)
def test_different_shapes_have_different_canonical_plans(one, other):
    assume(distance(radii(one), radii(other)) > 10 * SAME)
    assert canonical(one) != canonical(other)


@settings(max_examples=200, deadline=None)
@given(plans, plans)
def test_different_canonical_plans_are_different_shapes(one, other):
    one, other = canonical(one), canonical(replace(other, offset=one.offset))
    assume(one != other and one.offset == other.offset)
    assert distance(radii(one), radii(other)) > 10 * SAME


def test_waves_of_one_period_add_up():
    both = Plan(period_1=4, amplitude_1=0.03, period_2=4, amplitude_2=0.04, phase_2=90.0)
    folded = canonical(both)
    assert (folded.period_1, folded.amplitude_1, folded.amplitude_2) == (4, 0.05, 0.0)
    gone = replace(both, amplitude_2=-0.03, phase_2=0.0)
    assert canonical(gone) == canonical(Plan(offset=0.005))


def test_a_wave_of_no_height_has_no_period_and_a_circle_no_offset():
    lone = [Plan(amplitude_1=0.1, period_2=k, phase_2=20.0 * k, offset=0.003) for k in (2, 3, 9)]
    assert len({canonical(plan) for plan in lone}) == 1
    assert canonical(lone[0]).offset == 0.003
    assert canonical(Plan(offset=0.003)) == canonical(Plan(period_1=8))


def test_folding_keeps_the_curve_with_its_offset():
    plan = Plan(amplitude_1=-0.1, phase_1=50.0, amplitude_2=0.04, phase_2=-130.0, offset=0.004)
    theta = np.arange(8192) * (2 * np.pi / 8192)
    sizes = [np.sort(np.abs(plan_curve(p, theta)[0])) for p in (plan, canonical(plan))]
    assert np.abs(sizes[0] - sizes[1]).max() < 3e-5
