"""The base curve: the outline of a printed object in plan."""

from dataclasses import dataclass

import numpy as np

from ..core.scene import Vector

_DENSE = 8192


@dataclass(frozen=True, slots=True)
class Curve:
    """A closed curve in plan, counter-clockwise, at points evenly spaced along it.

    ``points`` (N, 2) in m; ``normals`` (N, 2) outward unit vectors; ``curvature`` (N,) in 1/m,
    positive where the curve is convex. All float64. Of the curve itself, between the points too:
    its ``length`` in m and ``bend``, the smallest radius in m that it has where it is convex.
    """

    points: Vector
    normals: Vector
    curvature: Vector
    length: float
    bend: float


def base_curve(width: float, depth: float, lobes: int, lobe: float, count: int) -> Curve:
    """The curve r(θ) = 1 + ``lobe`` cos(``lobes`` θ), stretched to ``width`` × ``depth``.

    The pole of the polar form stays at the origin and the first point on the +X axis, where the
    first lobe is. ``width`` along X and ``depth`` along Y, in m, are the curve's own extent; its
    ``count`` points lie on it, so theirs can be smaller by a second-order amount. Normals and
    curvature are analytic. With no lobes the curve is an ellipse. ``lobe`` must be below 1.
    """
    amplitude = lobe if lobes else 0.0
    dense = np.linspace(0.0, 2 * np.pi, _DENSE + 1)
    position, speed, change = _derivatives(dense, lobes, amplitude)
    scale = np.array([width, depth]) / np.ptp(position, axis=0)
    bend = 1 / _curvature(speed * scale, change * scale).max()

    step = np.hypot(*(speed * scale).T)
    along = np.concatenate([[0.0], np.cumsum((step[1:] + step[:-1]) / 2)]) * dense[1]
    theta = np.interp(np.arange(count) * (along[-1] / count), along, dense)

    position, speed, change = (v * scale for v in _derivatives(theta, lobes, amplitude))
    normals = np.column_stack([speed[:, 1], -speed[:, 0]]) / np.hypot(*speed.T)[:, None]
    return Curve(position, normals, _curvature(speed, change), float(along[-1]), float(bend))


def _curvature(speed: Vector, change: Vector) -> Vector:
    turn = speed[:, 0] * change[:, 1] - speed[:, 1] * change[:, 0]
    return turn / np.hypot(*speed.T) ** 3


def _derivatives(theta: Vector, lobes: int, amplitude: float) -> tuple[Vector, Vector, Vector]:
    """The unscaled curve at ``theta`` and its first two derivatives, (N, 2) each."""
    r = 1 + amplitude * np.cos(lobes * theta)
    r1 = -amplitude * lobes * np.sin(lobes * theta)
    r2 = -amplitude * lobes**2 * np.cos(lobes * theta)
    turn = np.exp(1j * theta)
    plane = (r * turn, (r1 + 1j * r) * turn, (r2 - r + 2j * r1) * turn)
    position, speed, change = (np.column_stack([p.real, p.imag]) for p in plane)
    return position, speed, change
