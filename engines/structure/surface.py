"""The surface that a structure lies on: a tensor cubic B-spline over 4 × 4 control points."""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline

from ..core.parameters import nested, param
from ..core.scene import Vector

COUNT = 4  # control points each way
_DEGREE = 3
_CLAMPED = np.repeat([0.0, 1.0], COUNT)
_CLOSED = np.arange(-_DEGREE, COUNT + _DEGREE + 1) / COUNT


@dataclass(frozen=True, slots=True, kw_only=True)
class Shift:
    """How far a control point is moved from where its structure puts it."""

    x: float = param(0.0, "m", -50.0, 50.0, "Along X; outward on a façade")
    y: float = param(0.0, "m", -50.0, 50.0, "Along Y; along the outline on a façade")
    z: float = param(0.0, "m", -50.0, 50.0, "Upward")


@dataclass(frozen=True, slots=True, kw_only=True)
class Net:
    """Shifts of the 4 × 4 control points, p<row u><column v>."""

    p00: Shift = nested(Shift, "Control point at u 0, v 0")  # noqa: RUF009
    p01: Shift = nested(Shift, "Control point at u 0, v 1")  # noqa: RUF009
    p02: Shift = nested(Shift, "Control point at u 0, v 2")  # noqa: RUF009
    p03: Shift = nested(Shift, "Control point at u 0, v 3")  # noqa: RUF009
    p10: Shift = nested(Shift, "Control point at u 1, v 0")  # noqa: RUF009
    p11: Shift = nested(Shift, "Control point at u 1, v 1")  # noqa: RUF009
    p12: Shift = nested(Shift, "Control point at u 1, v 2")  # noqa: RUF009
    p13: Shift = nested(Shift, "Control point at u 1, v 3")  # noqa: RUF009
    p20: Shift = nested(Shift, "Control point at u 2, v 0")  # noqa: RUF009
    p21: Shift = nested(Shift, "Control point at u 2, v 1")  # noqa: RUF009
    p22: Shift = nested(Shift, "Control point at u 2, v 2")  # noqa: RUF009
    p23: Shift = nested(Shift, "Control point at u 2, v 3")  # noqa: RUF009
    p30: Shift = nested(Shift, "Control point at u 3, v 0")  # noqa: RUF009
    p31: Shift = nested(Shift, "Control point at u 3, v 1")  # noqa: RUF009
    p32: Shift = nested(Shift, "Control point at u 3, v 2")  # noqa: RUF009
    p33: Shift = nested(Shift, "Control point at u 3, v 3")  # noqa: RUF009


_NAMES = [f"p{row}{column}" for row in range(COUNT) for column in range(COUNT)]


def shifts_of(net: Net) -> Vector:
    """The shifts (4, 4, 3) in m: row along u, column along v, then x, y, z."""
    shifts = [getattr(net, name) for name in _NAMES]
    return np.array([(s.x, s.y, s.z) for s in shifts], dtype=np.float64).reshape(COUNT, COUNT, 3)


def net_of(shifts: ArrayLike) -> Net:
    """The record with ``shifts`` (4, 4, 3) in m; `shifts_of` reads them back equal."""
    rows = np.asarray(shifts, dtype=np.float64).reshape(COUNT * COUNT, 3).tolist()
    return Net(**{name: Shift(x=x, y=y, z=z) for name, (x, y, z) in zip(_NAMES, rows, strict=True)})


def flat_points(length: float, width: float, height: float) -> Vector:
    """Control points (4, 4, 3) of a level rectangle about the Z axis, u along X and v along Y."""
    even = np.linspace(-0.5, 0.5, COUNT)
    x, y = np.meshgrid(even * length, even * width, indexing="ij")
    return np.stack([x, y, np.full_like(x, height)], axis=-1)


def basis(t: ArrayLike, *, closed: bool = False, derivative: int = 0) -> Vector:
    """What each of the 4 control points counts for at ``t`` (T,) in 0..1, or its derivative (T, 4).

    Clamped, so that the ends are interpolated (Bernstein polynomials, for 4 points are one span),
    or, where ``closed``, uniform and of period 1 [Piegl and Tiller, The NURBS Book, ch. 2].
    """
    return _basis(np.asarray(t, dtype=np.float64).tobytes(), closed, derivative)


@functools.lru_cache(maxsize=64)
def _basis(places: bytes, closed: bool, derivative: int) -> Vector:
    t = np.frombuffer(places)
    knots = _CLOSED if closed else _CLAMPED
    t = t % 1.0 if closed else t
    if derivative:
        count = len(knots) - _DEGREE - 1
        found = BSpline(knots, np.eye(count), _DEGREE)(t, nu=derivative)
    else:
        found = BSpline.design_matrix(t, knots, _DEGREE).toarray()
    if closed:
        found[:, :_DEGREE] += found[:, COUNT:]
    found = np.ascontiguousarray(found[:, :COUNT])
    found.setflags(write=False)
    return found


def evaluate(
    points: Vector, u: ArrayLike, v: ArrayLike, *, closed: bool = False
) -> tuple[Vector, Vector]:
    """Positions and unit normals (…, U, V, 3) at every ``u`` (U,) with every ``v`` (V,) in 0..1.

    ``points`` (…, 4, 4, 3) in m, so many surfaces as it has leading axes. ``closed`` in u. The
    normal is Su × Sv, zero where the surface has none.
    """

    def mixed(order_u: int, order_v: int) -> Vector:
        n = basis(u, closed=closed, derivative=order_u)
        m = basis(v, derivative=order_v)
        return np.einsum("ai,bj,...ijc->...abc", n, m, points, optimize=True)

    return mixed(0, 0), _normals(mixed)


def evaluate_at(points: Vector, uv: Vector, *, closed: bool = False) -> tuple[Vector, Vector]:
    """Positions and unit normals (…, M, 3) at the places ``uv`` (M, 2), else as `evaluate`."""

    def mixed(order_u: int, order_v: int) -> Vector:
        return positions_at(points, uv, closed=closed, orders=(order_u, order_v))

    return mixed(0, 0), _normals(mixed)


def positions_at(
    points: Vector, uv: Vector, *, closed: bool = False, orders: tuple[int, int] = (0, 0)
) -> Vector:
    """Positions (…, M, 3) at the places ``uv`` (M, 2), or their derivatives of ``orders``."""
    weights = _weights(np.ascontiguousarray(uv).tobytes(), closed, orders)
    return weights @ points.reshape(*points.shape[:-3], COUNT * COUNT, 3)


@functools.lru_cache(maxsize=32)
def _weights(places: bytes, closed: bool, orders: tuple[int, int]) -> Vector:
    """What each control point counts for at M places (M, 16)."""
    u, v = np.frombuffer(places).reshape(-1, 2).T
    n = basis(u, closed=closed, derivative=orders[0])
    m = basis(v, derivative=orders[1])
    found = (n[:, :, None] * m[:, None, :]).reshape(len(u), COUNT * COUNT)
    found.setflags(write=False)
    return found


def _normals(mixed: Callable[[int, int], Vector]) -> Vector:
    normals = np.cross(mixed(1, 0), mixed(0, 1))
    size = np.linalg.norm(normals, axis=-1, keepdims=True)
    return np.divide(normals, size, out=np.zeros_like(normals), where=size > 0)
