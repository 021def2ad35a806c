"""A grid shell between two walls: open at two opposite sides, held along the other two."""

import functools
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.parameters import nested, param
from ..core.scene import Vector
from .folds import check_sheet
from .frame import FIXED, HINGED, Frame
from .grid import Grid, Opening, Pattern, count_for, grid_of
from .model import Model
from .surface import Net, evaluate_at, flat_points, positions_at, shifts_of

GROUPS = ("ribs", "diagonals")


@dataclass(frozen=True, slots=True, kw_only=True)
class Shell:
    """A barrel-like grid shell about the Z axis: between walls along X, free arches at its ends."""

    length: float = param(24.0, "m", 1.0, 500.0, "Size along X, from free arch to free arch")
    span: float = param(15.0, "m", 1.0, 500.0, "Size along Y, from wall to wall")
    height: float = param(6.0, "m", 0.0, 200.0, "Top of the walls above the ground")
    rise: float = param(3.0, "m", -50.0, 100.0, "Middle of the shell above the walls")
    rise_ends: float = param(3.0, "m", -50.0, 100.0, "Free arches above the walls")
    pattern: Pattern = param(  # noqa: RUF009
        "waffle", help="Ribs along and across, diagonal both ways, or both with one diagonal"
    )
    spacing: float = param(1.5, "m", 0.05, 50.0, "Greatest distance between parallel ribs, in plan")
    cells_along: int = param(0, "", 0, 400, "Cells along the length; 0 follows the spacing")
    cells_across: int = param(0, "", 0, 400, "Cells across the span; 0 follows the spacing")
    supports: Literal["hinged", "fixed"] = param("hinged", help="How the ribs stand on the walls")
    opening_1: Opening = nested(Opening, "First opening")  # noqa: RUF009
    opening_2: Opening = nested(Opening, "Second opening")  # noqa: RUF009


def shell_model(shell: Shell, net: Net | None = None) -> Model:
    """The shell with its control points moved by ``net``; u runs along X, v from wall to wall.

    Groups: ribs and, where triangulated, diagonals. Raises SceneError when the surface folds or
    openings cut it apart.
    """
    grid, groups, held = _topology(*topology_key(shell)[1:])
    points = control_points(shell) + shifts_of(net or Net())
    nodes = positions_at(points, grid.uv)
    check_sheet(nodes, grid.cells, grid.uv)
    normals = evaluate_at(points, grid.middles)[1]
    return Model(
        Frame(nodes, grid.members, normals, held), grid.cells, grid.middles, groups, GROUPS
    )


def control_points(shell: Shell) -> Vector:
    """The control points (4, 4, 3) in m before they are moved.

    Across it is a parabola, the funicular of an even load in plan; along, its rise runs from that
    of the ends to that of the middle and back as a parabola too.
    """
    points = flat_points(shell.length, shell.span, shell.height)
    inner = (4 * shell.rise - shell.rise_ends) / 3
    along = [shell.rise_ends, inner, inner, shell.rise_ends]
    points[..., 2] += np.outer(along, [0, 4 / 3, 4 / 3, 0])
    return points


def topology_key(shell: Shell) -> tuple[Hashable, ...]:
    """What the members' order and joints depend on; equal keys share a frame's pattern."""
    spacing = shell.spacing * (np.sqrt(2) if shell.pattern == "diagonal" else 1.0)
    return (
        *("shell", shell.pattern),
        shell.cells_along or count_for(shell.length, spacing),
        shell.cells_across or count_for(shell.span, spacing),
        tuple(o for o in (shell.opening_1, shell.opening_2) if o.size_u > 0 and o.size_v > 0),
        shell.supports,
    )


@functools.lru_cache(maxsize=16)
def _topology(
    pattern: Pattern, along: int, across: int, openings: tuple[Opening, ...], supports: str
) -> tuple[Grid, NDArray[np.int32], NDArray[np.bool_]]:
    """The grid, the members' groups (M,) and what is held (N, 6)."""
    grid = grid_of(pattern, along, across, openings)
    slanting = (np.diff(grid.uv[grid.members], axis=1)[:, 0] != 0).all(axis=1)
    groups = (slanting & (pattern == "triangulated")).astype(np.int32)
    held = np.zeros((len(grid.uv), 6), dtype=bool)
    held[np.isin(grid.uv[:, 1], (0.0, 1.0))] = FIXED if supports == "fixed" else HINGED
    for array in (groups, held):
        array.setflags(write=False)
    return grid, groups, held
