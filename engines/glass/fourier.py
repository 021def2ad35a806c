"""The Fourier plan: two harmonics over a radius, and an offset weighted by curvature."""

import math
from dataclasses import dataclass

import numpy as np

from ..core.errors import ParameterError
from ..core.parameters import param
from ..core.scene import Vector
from .outline import COUNT, Outline, Plane, evened, pairs
from .overlap import Overlap, clear_outline, is_clear

_NODES = 2048


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """A base curve: r(θ) = radius · (1 + a₁ cos(k₁θ + φ₁) + a₂ cos(k₂θ + φ₂)), then offset."""

    radius: float = param(0.1, "m", 5e-3, 2.0, "Mean radius, midway in the wall")
    period_1: int = param(3, "", 1, 24, "How often the first wave goes around")
    amplitude_1: float = param(0.0, "", -0.6, 0.6, "Height of the first wave over the radius")
    phase_1: float = param(0.0, "deg", -360.0, 360.0, "Where the first wave starts")
    period_2: int = param(5, "", 1, 24, "How often the second wave goes around")
    amplitude_2: float = param(0.0, "", -0.6, 0.6, "Height of the second wave over the radius")
    phase_2: float = param(0.0, "deg", -360.0, 360.0, "Where the second wave starts")
    offset: float = param(
        0.0, "m", -0.05, 0.05, "Pushes tight bends out and slack ones in, by their curvature"
    )


def plan_curve(plan: Plan, theta: Vector) -> tuple[Plane, Plane, Plane]:
    """The plan at polar angles ``theta`` in rad: position x + iy in m, and two derivatives by θ.

    Analytic. The offset moves the polar curve by offset · (κ L / 2π − 1) along its outward
    normal, with κ its curvature and L its length, so that a circle stays itself.
    """
    return _curve(plan, theta, _mean_radius(plan) if plan.offset else 0.0)


def plan_outline(
    plan: Plan,
    thickness: float = 0.0,
    overlap: Overlap = "clip",
    stretch: tuple[float, float] = (1.0, 1.0),
    count: int = COUNT,
    where: str = "glass.wall",
) -> Outline:
    """The outline of a plan, ``count`` points evenly spaced from θ = 0.

    ``stretch`` scales it along X and Y. Where a wall of ``thickness`` in m around it misses itself
    the outline is the analytic curve, else `resolved` as ``overlap`` says, with a note.

    Raises ParameterError, naming ``where``, when the waves reach the middle or no room for the
    wall is left.
    """
    if abs(plan.amplitude_1) + abs(plan.amplitude_2) >= 1.0:
        raise ParameterError(
            f"[{where}] Amplitudes of {plan.amplitude_1:g} and {plan.amplitude_2:g} reach the "
            "middle of the plan; together they must stay below 1."
        )

    mean = _mean_radius(plan) if plan.offset else 0.0

    def curve(theta: Vector) -> tuple[Plane, Plane, Plane]:
        x, y = stretch
        position, speed, change = _curve(plan, theta, mean)
        if stretch == (1.0, 1.0):
            return position, speed, change
        position, speed, change = (x * p.real + 1j * y * p.imag for p in (position, speed, change))
        return position, speed, change

    nodes = np.linspace(0.0, 2 * np.pi, _NODES + 1)
    position, velocity, change = curve(nodes[:-1])
    speed = np.abs(velocity)
    bend = (velocity.conj() * change).imag / speed**3
    points = pairs(position)
    if np.abs(bend).max() * thickness / 2 < 1 and is_clear(points, thickness / 2):
        theta = evened(nodes, _arc(speed), np.append(speed, speed[0]), count)
        return Outline(pairs(curve(theta)[0]))
    return clear_outline(points, thickness / 2, overlap, count, where)


def _mean_radius(plan: Plan) -> float:
    """Length of the polar curve before its offset over 2π, in m."""
    theta = np.linspace(0.0, 2 * np.pi, _NODES, endpoint=False)
    return float(np.abs(_polar(plan, theta, 1)[1]).mean())


def _curve(plan: Plan, theta: Vector, mean: float) -> tuple[Plane, Plane, Plane]:
    """`plan_curve`, where the ``mean`` radius is known."""
    if plan.offset == 0.0:
        z0, z1, z2 = _polar(plan, theta, 2)
        return z0, z1, z2
    return _offset(plan.offset * mean, plan.offset, _polar(plan, theta, 4))


def _arc(speed: Vector) -> Vector:
    """Length up to each of N even angles and the whole turn (N + 1,): its Fourier series summed."""
    count = len(speed)
    series = np.fft.rfft(speed)
    order = np.arange(1, len(series))
    series[1:] /= 1j * order
    mean, series[0] = series[0].real / count, 0.0
    wave = np.fft.irfft(series, count)
    arc = mean * np.arange(count + 1) * (2 * np.pi / count)
    return arc + np.append(wave - wave[0], 0.0)


def _polar(plan: Plan, theta: Vector, order: int) -> list[Plane]:
    """The polar curve before its offset, x + iy, and its derivatives by θ up to ``order``."""
    radius = np.zeros((order + 1, *theta.shape))
    radius[0] = 1.0
    for k, amplitude, phase in (
        (plan.period_1, plan.amplitude_1, plan.phase_1),
        (plan.period_2, plan.amplitude_2, plan.phase_2),
    ):
        if amplitude:
            wave = amplitude * np.exp(1j * (k * theta + np.radians(phase)))
            for n in range(order + 1):
                radius[n] += ((1j * k) ** n * wave).real
    turn = plan.radius * np.exp(1j * theta)
    derivatives = []
    for n in range(order + 1):
        weights = [math.comb(n, j) * 1j ** (n - j) for j in range(n + 1)]
        derivatives.append(turn * np.einsum("j,j...", weights, radius[: n + 1]))
    return derivatives


def _offset(weight: float, shift: float, derivatives: list[Plane]) -> tuple[Plane, Plane, Plane]:
    """The curve moved by ``weight`` κ − ``shift`` along its outward normal, and two derivatives.

    From the curve's position and first four derivatives by its parameter.
    """
    z0, z1, z2, z3, z4 = derivatives
    q = (z1.conj() * z1).real  # speed², and its derivatives
    q1 = 2 * (z1.conj() * z2).real
    q2 = 2 * ((z2.conj() * z2).real + (z1.conj() * z3).real)
    c = (z1.conj() * z2).imag  # κ speed³, and its derivatives
    c1 = (z1.conj() * z3).imag
    c2 = (z2.conj() * z3 + z1.conj() * z4).imag
    bend = c * q**-1.5
    bend1 = c1 * q**-1.5 - 1.5 * c * q1 * q**-2.5
    bend2 = c2 * q**-1.5 - 3 * c1 * q1 * q**-2.5
    bend2 += c * (3.75 * q1**2 * q**-3.5 - 1.5 * q2 * q**-2.5)

    speed, tangent = np.sqrt(q), z1 / np.sqrt(q)
    out = -1j * tangent
    move, move1, move2 = weight * bend - shift, weight * bend1, weight * bend2
    ahead = speed * (1 + move * bend)
    ahead1 = q1 / (2 * speed) * (1 + move * bend) + speed * (move1 * bend + move * bend1)
    position = z0 + move * out
    slope = ahead * tangent + move1 * out
    change = (ahead1 + move1 * bend * speed) * tangent + (move2 - ahead * bend * speed) * out
    return position, slope, change
