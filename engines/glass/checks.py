"""The checks of the print gate: what is asked, how far a path goes, and where it is worst."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .figures import UNITS, Figure
from .machine import Machine
from .toolpath import Toolpath

GEOMETRY = "geometry of a single continuous bead"
_TOLERANCE = 1e-6

_SAID = {
    "closure": ("Gap of the first turn", "mm", "close the base curve"),
    "rising": ("Step down", "mm", "let the path rise from turn to turn"),
    "travel": ("Move without a point between", "mm", "let the path go on from point to point"),
    "curvature": ("Turning radius", "mm", "take a larger radius, smaller or fewer waves"),
    "rotary_rate": ("Turning of the bed", "deg/s", "take wider bends or a slower pace"),
    "rotary_acceleration": ("Speeding up of the bed", "deg/s²", "let the bends begin more gently"),
    "acceleration": ("Acceleration", "mm/s²", "take wider bends or a slower pace"),
    "speed": ("Speed", "mm/s", "change the layer height, the wall's thickness or the pace"),
    "turn_time_min": ("Time for a turn", "s", "take a longer base curve or a slower pace"),
    "turn_time_max": ("Time for a turn", "s", "take a shorter base curve or a faster pace"),
    "overhang": ("Overhang", "deg", "lean the wall less from turn to turn"),
    "overlap": ("Overlap with the turn below", "%", "lean the wall less, or thicken it"),
    "room": ("Room beside the wall's middle", "mm", "widen the bend, or thin the wall"),
    "room_between": ("Room above the turn below", "mm", "lean the wall less, or thin it"),
    "reach": (
        "Way of the nozzle from the middle",
        "mm",
        "make the piece smaller, or purge closer to it",
    ),
    "reach_z": ("Height of the nozzle", "mm", "make the piece lower"),
    "bed": ("Outer side from the middle of the bed", "mm", "make the piece smaller"),
    "layer_height": ("Layer height", "mm", "change the wall's layer height"),
    "width": ("Width of the bead", "mm", "change the wall's thickness or the pace"),
    "flow": ("Flow", "mm³/s", "change the pace, the layer height or the thickness"),
    "mass": ("Mass", "kg", "make the piece smaller, lower or thinner"),
    "time": ("Printing time", "h", "make the piece smaller or lower, or print faster"),
}
"""What each check measures, in which unit it is told, and the remedy."""

_LABELS = {
    "closure": "Closed start",
    "rising": "Never down",
    "travel": "No idle move",
    "curvature": "Turning radius",
    "rotary_rate": "Bed turning",
    "rotary_acceleration": "Bed speed-up",
    "turn_time_min": "Quickest turn",
    "turn_time_max": "Slowest turn",
    "overlap": "Bead overlap",
    "room": "Room in a turn",
    "room_between": "Room to turns",
    "reach": "Reach",
    "bed": "Bed space",
    "width": "Bead width",
}
"""Names where a check's own word says too little."""

_PASSED = {
    "closure": "The first turn closes.",
    "rising": "The path never goes down.",
    "travel": "The path is one line without a move from place to place.",
    "room": "The wall has room for its width in every turn.",
    "room_between": "The wall has room for its width from turn to turn.",
}
"""What is said where geometry is as it should be, and a figure would say nothing."""

_SCALES = {unit: factor for kind in UNITS.values() for unit, factor in kind.items()}
_UPRIGHT = {"curvature", "overlap", "turn_time_min", "room", "room_between"}  # more is better


@dataclass(frozen=True, slots=True)
class Check:
    """One line of the gate.

    ``worst`` and ``limit`` are in ``unit``, where the path comes closest to the limit or goes
    beyond it, ``least`` where it must not fall short of that: at ``point`` (3,) in m and ``turn``,
    None for what has no place. ``share`` is what it takes of the limit there, above 1 beyond it:
    for an upper limit the value over the limit; for a lower one, as of turning radius, of time for
    a turn and of room, the limit over the value; in a range the way from its middle over half of
    it, so that 0 is the middle and 1 either end; of the overlap with the turn below what is missing
    to all of it, over what may be missing; of a move without a point between what it is longer
    than a step, over the half step that it may be.
    ``source`` says where the limit is from, ``confirmed`` whether that is confirmed. ``sentence``
    tells it all. ``utilisation`` (N,) is the share at each point of the path; None where it is one
    number, or was not asked for.
    """

    name: str
    passed: bool
    share: float
    worst: float
    limit: float
    least: bool
    unit: str
    turn: float | None
    point: tuple[float, float, float] | None
    source: str
    confirmed: bool
    sentence: str
    utilisation: Vector | None = None

    @property
    def label(self) -> str:
        """The name as a person reads it."""
        return _LABELS.get(self.name) or self.name.replace("_", " ").capitalize()

    def as_table(self) -> dict[str, Any]:
        """The check in plain values, without its map."""
        return {
            "name": self.name,
            "label": self.label,
            "passed": self.passed,
            "share": self.share,
            "worst": self.worst,
            "limit": self.limit,
            "least": self.least,
            "unit": self.unit,
            "turn": self.turn,
            "point": None if self.point is None else list(self.point),
            "source": self.source,
            "confirmed": self.confirmed,
            "sentence": self.sentence,
        }


@dataclass(frozen=True, slots=True)
class Spot:
    """A place on a path: its turn and the point (3,) in m."""

    turn: float
    point: Vector


def check(
    name: str,
    share: float,
    worst: float,
    limit: float,
    figure: Figure | None = None,
    spot: Spot | None = None,
    utilisation: Vector | None = None,
    tolerance: float = _TOLERANCE,
    below: bool | None = None,
) -> Check:
    """A check of that name from the ``share`` of its limit, ``worst`` and ``limit`` in SI.

    ``figure`` is where the limit is from, None for what geometry asks. ``below`` says whether the
    limit is one that must not be fallen short of; None where the name says it.
    """
    said = figure.name if figure and figure.name in _SAID else name
    quantity, unit, remedy = _SAID[said]
    passed = bool(share <= 1 + tolerance)
    below = name in _UPRIGHT if below is None else below
    worst, limit = (float(v) / _SCALES[unit] for v in (worst, limit))
    source, confirmed = (GEOMETRY, True)
    if figure is not None:
        source, confirmed = f"{_label(figure)}: {figure.said}", figure.confirmed
    place = ""
    if spot is not None:
        place = f" at turn {spot.turn:.1f}, z {spot.point[2] * 1e3:.0f} mm"
    bound = f"{_number(limit)} {unit}"
    reached = f"{quantity} {_number(worst)} {unit}{place}"
    kept = f"at least {bound} is needed" if below else f"within the {bound} that is allowed"
    broken = f"below the {bound} that is needed" if below else f"above the {bound} that is allowed"
    if passed and name in _PASSED:
        sentence = _PASSED[name]
    elif passed:
        sentence = f"{reached}, {kept}."
    else:
        sentence = f"{reached}, is {broken}; {remedy}."
    return Check(
        name=name,
        passed=passed,
        share=float(share),
        worst=worst,
        limit=limit,
        least=below,
        unit=unit,
        turn=None if spot is None else float(spot.turn),
        point=None if spot is None else (*(float(v) for v in spot.point),),  # type: ignore[arg-type]
        source=source,
        confirmed=confirmed,
        sentence=sentence,
        utilisation=utilisation,
    )


def along(
    name: str,
    path: Toolpath,
    values: Vector,
    limits: Vector | float,
    figure: Figure | None = None,
    share: Vector | None = None,
    below: bool = False,
) -> Check:
    """A check at every point: ``values`` (N,) against ``limits``, in SI.

    Its share is the one over the other, upside down with ``below``, unless it is given.
    """
    limits = np.broadcast_to(limits, values.shape)
    if share is None:
        over, under = (limits, values) if below else (values, limits)
        share = over / np.maximum(under, np.finfo(float).tiny)
    worst = _worst(share, -values if below else values)
    spot = Spot(path.turn[worst], path.points[worst])
    at = float(share[worst]), float(values[worst]), float(limits[worst])
    return check(name, *at, figure, spot, share, below=below or None)


def within(name: str, path: Toolpath, values: Vector, machine: Machine) -> Check:
    """A check of ``values`` (N,) in SI against the machine's range of that name; NaN passes.

    Its share is the way from the middle of the range over half of it.
    """
    low, high = machine.figures[f"{name}_min"], machine.figures[f"{name}_max"]
    middle, half = (high.si + low.si) / 2, max((high.si - low.si) / 2, 1e-9 * high.si)
    share = np.nan_to_num(np.abs(values - middle) / half)
    worst = _worst(share, share)
    below = bool(values[worst] < middle)
    spot = Spot(path.turn[worst], path.points[worst])
    figure = low if below else high
    at = float(share[worst]), float(values[worst]), figure.si
    return check(name, *at, figure, spot, share, below=below)


def _worst(share: Vector, values: Vector) -> int:
    """Where the share is largest, to a millionth; of such places the first of the largest value."""
    among = np.where(_top(share), values, -np.inf)
    return int(np.argmax(_top(among)))


def _top(values: Vector) -> NDArray[np.bool_]:
    """Which values are the largest, to a millionth: what repeats each turn is equal."""
    top = float(values.max())
    return values >= top - 1e-6 * abs(top)


def _label(figure: Figure) -> str:
    return f"{figure.name.replace('_', ' ')} {figure.value:g} {figure.unit}".rstrip()


def _number(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
