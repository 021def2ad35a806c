"""Sunlight that paths find: where a surface scatters one, a ray goes to a sun chosen at random.

What the sun, at its own place, gives to that surface is then known without waiting for a path that
happens to escape towards it [next-event estimation: Veach 1997]. One sun is chosen for each ray, by
chances that its light is divided by, so that the mean is that of all suns [Bourgeois et al. 2008
have daylight coefficients of the sun's positions apart, too].
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.scene import Vector
from .meeting import LONGEST, meet
from .surroundings import Surroundings

_CHANCES = 1 << 14  # equal chances that suns have shares of, at least
_FINEST = 16  # and at least so many to a sun
_UNIT = 1 << 36
"""Light is summed up in whole numbers of this part, whose order does not matter."""
_LATTICE = 3242174889, 2447445414
"""2³² over the plastic number and its square: steps by which any few neighbours differ well."""


@dataclass(frozen=True, slots=True)
class Aims:
    """S suns that shadow rays are aimed at.

    ``directions`` (S, 3): unit vectors in the model's axes. ``table`` (M,) uint32: the sun of each
    of M equal chances, M a power of 2; ``chances`` (S,): how probable each thus is, 0 where there
    is nothing to be found.
    """

    directions: Vector
    table: NDArray[np.uint32]
    chances: Vector


def aims_at(directions: Vector, light: Vector, asked: NDArray[np.bool_]) -> Aims | None:
    """Aims at those suns of ``directions`` (S, 3), in the model's axes, that are ``asked`` (S,).

    One half by their ``light`` (S,), in any unit, the other evenly, so that none is left to chance.
    None where none is asked.
    """
    count = int(asked.sum())
    if not count:
        return None
    share = np.where(asked, light, 0.0)
    even = asked / count
    wanted = (share / share.sum() + even) / 2 if share.any() else even
    chances = 1 << max(int(_CHANCES - 1).bit_length(), int(_FINEST * count - 1).bit_length())
    numbers = _whole(wanted, chances)
    table = np.repeat(np.arange(len(numbers), dtype=np.uint32), numbers)
    return Aims(directions, table, numbers / chances)


def _whole(wanted: Vector, total: int) -> NDArray[np.int64]:
    """Whole numbers that are ``wanted`` × total as nearly as may be, and ``total`` together."""
    exact = wanted * total
    numbers = np.floor(exact).astype(np.int64)
    missing = total - numbers.sum()
    numbers[np.argsort(numbers - exact, kind="stable")[:missing]] += 1
    return numbers


class Shadows:
    """Shadow rays to ``aims`` from the paths of n sensors, and what they find.

    ``row`` is each lane's sensor, ``across`` and ``along`` its cell over the hemisphere: from
    neighbouring cells rays go to suns that are far apart in the table, which is turned by chance
    for each sensor, each reflection and each ``key``.
    """

    def __init__(self, aims: Aims, count: int, row: Any, across: Any, along: Any, key: int) -> None:
        mi = runtime.mitsuba()
        import drjit as dr

        self._aims = aims
        self._shape = count, len(aims.directions)
        self._row = row
        self._place = across * mi.UInt32(_LATTICE[0]) + along * mi.UInt32(_LATTICE[1])
        self._key = dr.opaque(mi.UInt32, ~key & 0xFFFFFFFF)
        self._shift = dr.opaque(mi.UInt32, 33 - len(aims.table).bit_length())
        self._suns = dr.opaque(mi.UInt32, len(aims.directions))
        self._table = mi.UInt32(aims.table)
        self._directions = mi.Float(aims.directions.astype(np.float32).ravel())
        self._found = dr.zeros(mi.UInt64, count * len(aims.directions))
        dr.eval(self._found)

    def send(self, around: Surroundings, scattered: "Scattered", event: Any, active: Any) -> None:
        """Add what the sun gives by light ``scattered``; the ``event`` tells those of a path."""
        mi = runtime.mitsuba()
        import drjit as dr

        turn = mi.sample_tea_32(self._key + event, self._row)[0]
        sun = dr.gather(mi.UInt32, self._table, (self._place + turn) >> self._shift, active)
        towards = dr.gather(mi.Vector3f, self._directions, sun, active)
        cosine = dr.dot(scattered.normal, towards)
        active = active & (cosine > 0)
        if around.glazed:
            seen = _through(around, scattered, towards, active)
        else:
            ray = mi.Ray3f(scattered.origin, towards)
            seen = dr.select(around.soup.scene.ray_test(ray, active=active), 0, mi.Float(1))
        light = scattered.weight * cosine * seen
        dr.scatter_reduce(
            dr.ReduceOp.Add,
            self._found,
            mi.UInt64(mi.Float64(light) * _UNIT + 0.5),
            self._row * self._suns + sun,
            active & (light > 0),
            mode=dr.ReduceMode.Direct,
        )

    def found(self, paths: int) -> Vector:
        """Light (n, S) by reflection in lx for 1 lx normal to each sun, of so many paths each."""
        chances = self._aims.chances
        share = np.divide(1.0, chances, out=np.zeros_like(chances), where=chances > 0)
        return np.asarray(self._found).reshape(self._shape) * (share / (paths * _UNIT))


@dataclass(frozen=True, slots=True)
class Scattered:
    """Where paths are scattered by the cosine law about a ``normal``, on the device.

    ``weight``: what is left of a path after that. ``step`` in m off the surface is the ``origin``;
    ``veiled``: whether it is a screen before panes that did so, with ``veil`` of light let through.
    """

    origin: Any
    normal: Any
    weight: Any
    step: Any
    veiled: Any
    veil: Any


def _through(around: Surroundings, scattered: Scattered, towards: Any, active: Any) -> Any:
    """What panes let through to the sun, 0..1; ground ones and screens nothing."""
    mi = runtime.mitsuba()
    import drjit as dr

    lanes = dr.width(active)
    screened = ~scattered.veiled & (scattered.veil > 0)

    def cross(
        active: Any, origin: Any, behind: Any, s: Any, p: Any, crossed: Any
    ) -> tuple[Any, ...]:
        on = meet(around, origin, towards, behind, active)
        blocked = on.opaque | on.diffuses | (on.leaves & screened)
        return (
            on.met & ~blocked,
            dr.select(on.met, origin + (on.distance + on.step) * towards, origin),
            dr.select(on.met, on.step, behind),
            dr.select(blocked, 0, s * on.s),
            dr.select(blocked, 0, p * on.p),
            crossed + dr.select(on.met, mi.UInt32(1), 0),
        )

    state = (
        mi.Bool(active),
        mi.Point3f(scattered.origin),
        dr.zeros(mi.Float, lanes) + scattered.step,
        dr.ones(mi.Float, lanes),
        dr.ones(mi.Float, lanes),
        dr.zeros(mi.UInt32, lanes),
    )
    lost, _, _, s, p, _ = dr.while_loop(
        state, lambda active, *rest: active & (rest[-1] < LONGEST), cross, label="shadow"
    )
    return dr.select(active & ~lost, (s + p) / 2, 0)
