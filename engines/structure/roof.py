"""A freestanding roof: ribs on an undulating surface over columns."""

import functools
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.parameters import nested, param
from ..core.scene import Vector
from .folds import check_sheet
from .frame import FIXED, HINGED, Frame
from .grid import Grid, Opening, count_for, grid_of, neighbours
from .model import Model
from .surface import Net, evaluate_at, flat_points, positions_at, shifts_of

GROUPS = ("ribs", "columns", "branches")
_SHORTEST = 0.1  # m of column
_OUTWARD = 1 + 1e-9  # breaks ties between nodes toward the edge, alike on all sides

_DOME = np.outer([0, 1, 1, 0], [0, 1, 1, 0]) * (16 / 9)
"""Control heights of a surface that is 1 high in its middle and 0 along its edges."""
_WAVE = np.outer([3, -5, -5, 3], [3, -5, -5, 3]) / 9
"""Those of T₂(u) T₂(v) with Chebyshev's T₂: 1 in the middle and the corners, −1 amid the edges."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Columns:
    """The columns below a roof, in pairs along its length."""

    pairs: int = param(2, "", 2, 20, "Pairs of columns along the length; 2 are four columns")
    inset_along: float = param(
        0.2,
        "",
        0.0,
        0.45,
        "Outer pairs from the ends, as a share of the length; 0: corners",
    )
    inset_across: float = param(
        0.2, "", 0.0, 0.45, "Rows from the long sides, as a share of the width; 0: corners"
    )
    base: Literal["hinged", "fixed"] = param("hinged", help="How the columns stand on the ground")
    branching: float = param(
        0.0, "m", 0.0, 20.0, "How far below the roof a column branches to the nodes around; 0: not"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Roof:
    """A waffle or diagonal grid of ribs over length × width, about the Z axis, on columns."""

    length: float = param(30.0, "m", 1.0, 500.0, "Size along X, between overhangs")
    width: float = param(20.0, "m", 1.0, 500.0, "Size along Y, between overhangs")
    overhang: float = param(0.0, "m", 0.0, 50.0, "How far the roof goes on beyond that, all around")
    height: float = param(5.0, "m", 0.2, 100.0, "Edge of the roof above the ground")
    rise: float = param(1.0, "m", -50.0, 50.0, "Middle of the dome above its edge")
    undulation: float = param(
        0.5, "m", -20.0, 20.0, "Crests in the middle and corners, troughs amid the edges"
    )
    pattern: Literal["waffle", "diagonal"] = param(
        "waffle", help="Ribs along and across, or diagonal both ways"
    )
    spacing: float = param(1.5, "m", 0.05, 50.0, "Greatest distance between parallel ribs, in plan")
    cells_along: int = param(0, "", 0, 400, "Cells along the length; 0 follows the spacing")
    cells_across: int = param(0, "", 0, 400, "Cells across the width; 0 follows the spacing")
    columns: Columns = nested(Columns, "Columns")  # noqa: RUF009
    opening_1: Opening = nested(Opening, "First opening")  # noqa: RUF009
    opening_2: Opening = nested(Opening, "Second opening")  # noqa: RUF009


def roof_model(roof: Roof, net: Net | None = None) -> Model:
    """The roof with its control points moved by ``net``.

    Columns stand upright below the grid node that is nearest to their place in the plan before
    control points are moved, so that members stay the same ones while the surface changes.
    Nodes: those of the grid, the columns' feet, then, where columns branch, their heads. Groups:
    ribs, columns, branches.

    Raises SceneError when the surface folds, openings cut it apart, two columns meet at one
    node, or a column has no height left.
    """
    topology = _topology(*topology_key(roof)[1:])
    grid, heads = topology.grid, topology.heads
    points = control_points(roof) + shifts_of(net or Net())
    sheet = positions_at(points, grid.uv)
    check_sheet(sheet, grid.cells, grid.uv)

    feet = sheet[heads] * (1.0, 1.0, 0.0)
    depth = roof.columns.branching
    tops = sheet[heads] - (0.0, 0.0, depth)
    _check_columns(tops[:, 2], heads)
    nodes = np.concatenate([sheet, feet, tops] if depth else [sheet, feet])

    normals = np.zeros((len(topology.members), 3))
    normals[topology.groups == 0] = evaluate_at(points, grid.middles)[1]
    normals[topology.groups == 1] = (1.0, 0.0, 0.0)
    normals[topology.groups == 2] = (0.0, 0.0, 1.0)
    frame = Frame(nodes, topology.members, normals, topology.held)
    return Model(frame, grid.cells, topology.surface, topology.groups, GROUPS)


def control_points(roof: Roof) -> Vector:
    """The control points (4, 4, 3) in m before they are moved."""
    points = flat_points(*_plan(roof), roof.height)
    points[..., 2] += roof.rise * _DOME + roof.undulation * _WAVE
    return points


def topology_key(roof: Roof) -> tuple[Hashable, ...]:
    """What the members' order and joints depend on; equal keys share a frame's pattern."""
    length, width = _plan(roof)
    spacing = roof.spacing * (np.sqrt(2) if roof.pattern == "diagonal" else 1.0)
    grid = (
        roof.pattern,
        roof.cells_along or count_for(length, spacing),
        roof.cells_across or count_for(width, spacing),
        tuple(o for o in (roof.opening_1, roof.opening_2) if o.size_u > 0 and o.size_v > 0),
    )
    columns = roof.columns
    inset_u = (roof.overhang + columns.inset_along * roof.length) / length
    inset_v = (roof.overhang + columns.inset_across * roof.width) / width
    heads = _heads(grid_of(*grid), columns.pairs, inset_u, inset_v, length / width)
    return ("roof", *grid, heads, columns.base, columns.branching > 0)


@dataclass(frozen=True, slots=True, eq=False)
class _Topology:
    """A grid on columns: what does not change while the surface moves. ``heads``: their nodes."""

    grid: Grid
    heads: NDArray[np.int32]
    members: NDArray[np.int32]
    surface: Vector
    groups: NDArray[np.int32]
    held: NDArray[np.bool_]


@functools.lru_cache(maxsize=16)
def _topology(
    pattern: Literal["waffle", "diagonal"],
    along: int,
    across: int,
    openings: tuple[Opening, ...],
    under: tuple[int, ...],
    base: str,
    branching: bool,
) -> _Topology:
    grid = grid_of(pattern, along, across, openings)
    heads = np.array(under, dtype=np.int32)
    count, feet = len(grid.uv), len(grid.uv) + np.arange(len(heads), dtype=np.int32)
    tops = feet + len(heads) if branching else heads
    columns, branches = np.column_stack([feet, tops]), np.zeros((0, 2), dtype=np.int32)
    if branching:
        ends = [neighbours(grid, head) for head in heads]
        starts = np.repeat(tops, [len(around) for around in ends])
        branches = np.column_stack([starts, np.concatenate(ends)])
        count += len(heads)

    members = np.concatenate([grid.members, columns, branches]).astype(np.int32)
    held = np.zeros((count + len(heads), 6), dtype=bool)
    held[feet] = FIXED if base == "fixed" else HINGED
    beside = np.full((len(columns) + len(branches), 2), np.nan)
    sizes = (len(grid.members), len(columns), len(branches))
    groups = np.repeat(np.arange(3, dtype=np.int32), sizes)
    surface = np.concatenate([grid.middles, beside])
    for array in (heads, members, held, groups, surface):
        array.setflags(write=False)
    return _Topology(grid, heads, members, surface, groups, held)


def _heads(
    grid: Grid, pairs: int, inset_u: float, inset_v: float, aspect: float
) -> tuple[int, ...]:
    """The node nearest to each column's place, row by row along the length."""
    u, v = np.linspace(inset_u, 1 - inset_u, pairs), np.array([inset_v, 1 - inset_v])
    places = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    places = 0.5 + (places - 0.5) * _OUTWARD
    away = (places[:, None] - grid.uv) * (aspect, 1.0)
    heads = np.argmin((away**2).sum(axis=-1), axis=1)
    met, times = np.unique(heads, return_counts=True)
    if (times > 1).any():
        raise SceneError(
            f"{times.max()} columns stand under node {met[np.argmax(times)]}; take more cells, "
            "fewer pairs of columns, or insets that keep them apart."
        )
    return tuple(heads.tolist())


def _plan(roof: Roof) -> tuple[float, float]:
    """Length and width in m, overhangs included."""
    return roof.length + 2 * roof.overhang, roof.width + 2 * roof.overhang


def _check_columns(tops: Vector, heads: NDArray[np.int32]) -> None:
    lowest = int(np.argmin(tops))
    if tops[lowest] < _SHORTEST:
        raise SceneError(
            f"Column {lowest} under node {heads[lowest]} ends {tops[lowest]:.3g} m above the "
            "ground; raise the roof or its control points there, or let it branch less far down."
        )
