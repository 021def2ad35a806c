"""Symmetries of the Fourier plan: one plan for all that describe the same shape."""

import cmath
import math

from .fourier import Plan

_NOTHING = 1e-9  # of the radius; a wave smaller than this is none
_DIGITS, _DEGREES = 9, 6  # kept of amplitudes and of phases


def canonical(plan: Plan) -> Plan:
    """The plan that stands for every plan of the same shape, however that is turned or mirrored.

    Folded are: the order of the waves; waves of one period, which add up; waves of no height,
    whose period and phase mean nothing, and without any the offset; an amplitude below 0, which
    is a phase of 180°; turning about the origin; mirroring. The waves come by rising period with
    amplitudes above 0, the first with phase 0 and the second with the least phase that turning and
    mirroring leave it, 0 to 180° · gcd(k₁, k₂) / k₁. A wave that is not there has period 1 and
    stands last.
    """
    waves: dict[int, complex] = {}
    for period, amplitude, phase in (
        (plan.period_1, plan.amplitude_1, plan.phase_1),
        (plan.period_2, plan.amplitude_2, plan.phase_2),
    ):
        wave = cmath.rect(amplitude, math.radians(phase))
        waves[period] = waves.get(period, 0j) + wave
    there = sorted((k, w) for k, w in waves.items() if abs(w) > _NOTHING)
    first, second = [*there, (1, 0j), (1, 0j)][:2]
    return Plan(
        radius=plan.radius,
        period_1=first[0],
        amplitude_1=round(abs(first[1]), _DIGITS),
        phase_1=0.0,
        period_2=second[0],
        amplitude_2=round(abs(second[1]), _DIGITS),
        phase_2=_least_phase(first, second) if len(there) == 2 else 0.0,
        offset=plan.offset if there else 0.0,
    )


def _least_phase(first: tuple[int, complex], second: tuple[int, complex]) -> float:
    """The second wave's phase in degrees once turning and mirroring have made it smallest.

    Turning by α takes k α off the phase of a wave of period k. The turns that leave the first
    wave's phase at 0 change the second's by multiples of 360° · gcd(k₁, k₂) / k₁; mirroring
    negates it.
    """
    (k1, w1), (k2, w2) = first, second
    step = 360.0 * math.gcd(k1, k2) / k1
    phase = math.degrees(cmath.phase(w2) - k2 / k1 * cmath.phase(w1))
    phase %= step
    return abs(round(min(phase, step - phase), _DEGREES))
