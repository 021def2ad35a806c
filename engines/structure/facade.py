"""A structural façade: a diagrid around a tower, held by its core at the floors."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.parameters import param
from ..core.scene import Vector
from .diagrid import Diagrid, diagrid_of
from .folds import check_sheet
from .frame import HINGED, Frame
from .model import Model
from .plan import Plan, read_plan, superellipse
from .surface import Net, positions_at, shifts_of

GROUPS = ("diagonals", "rings")
_STEP = 1e-4  # in u and v, of the differences that normals are taken from
_CORE = (
    "The core is taken as rigid: at the floors it holds the façade's nodes against moving "
    "sideways, and carries none of their weight."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Facade:
    """A diagrid of diagonals and floor rings on a closed plan, about the Z axis."""

    height: float = param(96.0, "m", 2.0, 1000.0, "From the ground to the top ring")
    storey: float = param(4.0, "m", 1.0, 20.0, "Floor to floor, adjusted to a whole number")
    width: float = param(30.0, "m", 1.0, 500.0, "Size of the plan along X")
    depth: float = param(30.0, "m", 1.0, 500.0, "Size of the plan along Y")
    exponent: float = param(
        4.0, "", 1.0, 20.0, "Of the superellipse: 2 is an ellipse, large ones near a rectangle"
    )
    plan_file: str = param(
        "", help="CSV of x, y in m, an outline of your own in place of the superellipse"
    )
    twist: float = param(0.0, "deg", -360.0, 360.0, "How far the top is turned about the axis")
    modules: int = param(24, "", 4, 400, "Diamonds around")
    storeys_per_row: int = param(
        2, "", 1, 24, "Storeys from one row of joints to the next, half the height of a diamond"
    )
    core: Literal["tied", "none"] = param(
        "tied", help="Whether the floors hold the façade sideways against a rigid core"
    )


def facade_model(facade: Facade, net: Net | None = None) -> Model:
    """The façade with its control points moved by ``net``, hinged on the ground.

    u runs around by the plan's length from +X (or the first point of the file), v up. The net is
    closed in u; a shift's x is outward, y along the outline, z upward. Diagonals follow the surface
    from floor to floor, rings run at every floor above the ground. Groups: diagonals, rings.

    Raises SceneError where the surface folds, FileError where the plan file cannot be taken.
    """
    plan = _plan(facade)
    grid, shifts = diagrid_of(*topology_key(facade)[1:4]), shifts_of(net or Net())
    nodes = _positions(facade, plan, shifts, grid.uv)
    check_sheet(nodes, grid.cells, grid.uv, _flattened(nodes, grid, facade))
    held = np.zeros((len(nodes), 6), dtype=bool)
    held[grid.levels > 0, :2] = facade.core == "tied"
    held[grid.levels == 0] = HINGED
    frame = Frame(nodes, grid.members, _normals(facade, plan, shifts, grid.middles), held)
    notes = _notes(facade, shifts)
    return Model(frame, grid.cells, grid.middles, grid.groups, GROUPS, notes)


def facade_surface(facade: Facade, net: Net, uv: Vector) -> tuple[Vector, Vector]:
    """Positions and outward unit normals (M, 3) at ``uv`` (M, 2). Raises FileError for the plan."""
    plan, shifts = _plan(facade), shifts_of(net)
    return _positions(facade, plan, shifts, uv), _normals(facade, plan, shifts, uv)


def topology_key(facade: Facade) -> tuple[Hashable, ...]:
    """What the members' order and joints depend on; equal keys share a frame's pattern."""
    return (
        "facade",
        facade.modules,
        _storeys(facade),
        facade.storeys_per_row,
        facade.core,
    )


def _storeys(facade: Facade) -> int:
    return max(1, round(facade.height / facade.storey))


def _plan(facade: Facade) -> Plan:
    if facade.plan_file:
        return read_plan(facade.plan_file)
    return superellipse(facade.width, facade.depth, facade.exponent)


def _positions(facade: Facade, plan: Plan, shifts: Vector, uv: Vector) -> Vector:
    """The surface (M, 3) at ``uv`` (M, 2)."""
    base, outward = plan.at(uv[:, 0])
    out, along, up = positions_at(shifts, uv, closed=True).T
    around = np.column_stack([-outward[:, 1], outward[:, 0]])
    x, y = (base + out[:, None] * outward + along[:, None] * around).T
    turn = np.radians(facade.twist) * uv[:, 1]
    c, s = np.cos(turn), np.sin(turn)
    return np.column_stack([c * x - s * y, s * x + c * y, facade.height * uv[:, 1] + up])


def _normals(facade: Facade, plan: Plan, shifts: Vector, uv: Vector) -> Vector:
    """Outward unit normals (M, 3) by central differences, one-sided at top and bottom."""
    ends = []
    for step in np.eye(2) * _STEP:
        ahead, back = (uv + step, uv - step)
        ends += [np.minimum(ahead, (np.inf, 1.0)), np.maximum(back, (-np.inf, 0.0))]
    places = np.concatenate(ends)
    a, b, c, d = _positions(facade, plan, shifts, places).reshape(4, -1, 3)
    normals = np.cross(a - b, c - d)
    size = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, size, out=np.zeros_like(normals), where=size > 0)


def _flattened(nodes: Vector, grid: Diagrid, facade: Facade) -> Vector:
    """The nodes (N, 2) of a tower as a ring: their angle stays, their height becomes a radius.

    The angle is that about the middle of their floor. The radius falls so steeply from the ground
    to the top that no side of a cell cuts through the floor above.
    """
    x, y, z = nodes.T
    counts = np.bincount(grid.levels)
    x = x - (np.bincount(grid.levels, x) / counts)[grid.levels]
    y = y - (np.bincount(grid.levels, y) / counts)[grid.levels]
    fall = -2 * (len(counts) - 1) * np.log(np.cos(min(2 * np.pi / facade.modules, 1.2)))
    radius = np.exp(-fall * z / facade.height)
    return np.column_stack([x, y]) * (radius / np.maximum(np.hypot(x, y), 1e-300))[:, None]


def _notes(facade: Facade, shifts: Vector) -> tuple[str, ...]:
    notes = [_CORE] if facade.core == "tied" else []
    storey = facade.height / _storeys(facade)
    if not np.isclose(storey, facade.storey, rtol=1e-6):
        notes.append(f"Storeys are {storey:.4g} m tall: {_storeys(facade)} fill the height.")
    if shifts[..., 2].any():
        notes.append("Control points moved upward lift the floors' rings from their level.")
    return tuple(notes)
