"""Where the machine's axes go: along the path, beside it to purge, and clear of the piece."""

from collections.abc import Iterator

import numpy as np

from ..core.scene import Vector
from .checks import Check, along
from .figures import Figure
from .machine import Machine
from .toolpath import Toolpath

_CLEAR = 10e-3  # m above the piece


def axes_of(path: Toolpath, machine: Machine) -> Vector:
    """Where the machine's X and Y axes are at each point (N, 2), in m from the piece's axis.

    With four axes the bed turns against the path's direction, which so stays along +X.
    """
    if machine.axes == "three":
        return path.points[:, :2]
    x, y = path.points[:, 0], path.points[:, 1]
    c, s = np.cos(path.rotary), np.sin(path.rotary)
    return np.column_stack([c * x + s * y, c * y - s * x])


def beside(path: Toolpath, machine: Machine, purge: float) -> tuple[Vector, float]:
    """Where the axes are when it purges (2,), and at which height they are clear of the piece.

    Both in m from the piece's axis and foot; ``purge`` in m is how far outside the start.
    """
    heading = 0.0 if machine.axes == "four" else float(path.rotary[0])
    out = np.array([np.sin(heading), -np.cos(heading)])
    return axes_of(path, machine)[0] + purge * out, float(path.points[:, 2].max()) + _CLEAR


def places(path: Toolpath, machine: Machine, purge: float, repeated: int = 0) -> Iterator[Check]:
    """Whether the machine's axes reach every point, and the piece stands on the bed.

    Where the machine's lines go to the purge, ``purge`` in m outside the start, its first point
    counts as that far out; where they go clear of the piece, its last counts as that high. The path
    is as if its one but last turn were done ``repeated`` times more.
    """
    ways = np.column_stack([np.abs(axes_of(path, machine)), path.points[:, 2]])
    lifted = np.where(path.turn >= path.turns - 1, repeated * path.layer_height, 0.0)
    ways[:, 2] += lifted
    place, clear = beside(path, machine, purge)
    lines = machine.dialect
    if purge and any("{purge_" in line for line in lines.purge):
        ways[0, :2] = np.maximum(ways[0, :2], np.abs(place))
    used = (*lines.start, *(lines.purge if purge else ()), *lines.end)
    if any("{clearance}" in line for line in used):
        ways[-1, 2] = clear + lifted[-1]
    reach = [machine.figures[f"reach_{axis}"] for axis in "xyz"]
    yield _furthest("reach", path, ways, [reach[0].si / 2, reach[1].si / 2, reach[2].si], reach)

    out = path.sides * np.where(path.full, path.width, 0.0)[:, None] / 2
    side = np.abs(path.points[:, :2]) + np.abs(out)
    bed = [machine.figures[f"bed_{axis}"] for axis in "xy"]
    yield _furthest("bed", path, side, [b.si / 2 for b in bed], bed)


def _furthest(
    name: str, path: Toolpath, ways: Vector, limits: list[float], figures: list[Figure]
) -> Check:
    """A check of ``ways`` (N, A) along A axes, that of each point which takes most of its limit."""
    share = ways / limits
    axis = share.argmax(axis=1)
    here = np.arange(len(axis)), axis
    figure = figures[int(axis[share[here].argmax()])]
    return along(name, path, ways[here], np.asarray(limits)[axis], figure, share[here])
