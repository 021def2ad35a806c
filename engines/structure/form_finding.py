"""Form finding by force densities: the shape in which a net carries its load by axial force alone.

Schek, H.-J.: The force density method for form finding and computation of general networks.
Computer Methods in Applied Mechanics and Engineering 3 (1974), 115–134.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ..core.errors import SceneError
from ..core.parameters import param
from ..core.scene import Vector
from .frame import Frame
from .joints import node_normals
from .model import NO_NODE, Model
from .tributary import tributary_of

_CLOSE, _MOST = 1e-12, 200


@dataclass(frozen=True, slots=True, kw_only=True)
class FormFinding:
    """A shape that force densities find, between the places where the drawn one is held.

    It is funicular for what holds it here: held by supports alone, a net draws in to the columns
    that it hangs from, overhangs too; held along its edges, it asks for edges that hold.
    """

    shape: Literal["drawn", "standing", "hanging"] = param(
        "drawn", help="As drawn, or found: in compression like an arch, or in tension like a net"
    )
    rise: float = param(3.0, "m", 1e-3, 200.0, "How far the load bends the net, at the most")
    along: float = param(1.0, "", 1e-3, 1e3, "Force density of the ribs along, relative")
    across: float = param(1.0, "", 1e-3, 1e3, "Force density of the ribs across, relative")
    edge: float = param(1.0, "", 1e-3, 1e3, "Force density of the edges, times that of the ribs")
    held: Literal["edges", "supports"] = param(
        "edges", help="Edges stay as drawn too, or only what supports and columns hold"
    )
    load: Literal["plan", "surface", "members"] = param(
        "plan", help="The load counts per area in plan, per area of the surface, or per m of rib"
    )


@dataclass(frozen=True, slots=True)
class Form:
    """A net in equilibrium under a load of 1 N/m², or 1 N per m of member.

    ``nodes`` (N, 3) in m; ``branches`` (B,) int: the members that are the net's; ``densities`` (B,)
    in N/m, axial force over length, negative in compression; ``fixed`` (N,) bool; ``forces``
    (N, 3) in N: the load on each node. At every free node of the net Σ density · (neighbour − node)
    + force = 0.
    """

    nodes: Vector
    branches: NDArray[np.intp]
    densities: Vector
    fixed: NDArray[np.bool_]
    forces: Vector


def solve_net(
    nodes: Vector,
    members: NDArray[np.integer],
    densities: Vector,
    fixed: NDArray[np.bool_],
    forces: Vector,
) -> Vector:
    """Node positions (N, 3) in m of the net in equilibrium: (CᵀQC) x = p − CᵀQC_f x_f.

    ``members`` (B, 2), their force ``densities`` (B,) in N/m, all of one sign; ``fixed`` (N,) bool;
    ``forces`` (N, 3) in N. Nodes without a member stay. Raises SceneError where no node of a part
    of the net is fixed.
    """
    solve, free, pull = _factor(nodes, members, densities, fixed)
    found = nodes.copy()
    found[free] = solve(forces[free] - pull)
    return found


def found_form(model: Model, record: FormFinding) -> Form:
    """The net of the members on the surface of ``model``, bent by ``record.rise`` in m.

    The load is vertical, so it bends the net by a height that is in inverse proportion to the force
    densities: their scale is what the rise asks for. Loads that grow with the surface or the
    members are taken anew from each shape until it stays.

    Raises SceneError where nothing is free to move, a part of the net is held nowhere, a load on
    areas meets no cells, or the shape does not settle.
    """
    frame = model.frame
    branches = np.flatnonzero(_on_surface(model))
    members = frame.members[branches]
    relative, edge_nodes = _relative_densities(model, branches, record)
    fixed = _held(model, branches)
    if record.held == "edges":
        fixed[edge_nodes] = True
    used = np.zeros(len(frame.nodes), dtype=bool)
    used[members] = True
    if not (used & ~fixed).any():
        raise SceneError(
            "Every node of the net is held, so its form cannot be found; hold supports only, or "
            "take more cells."
        )
    if record.load != "members" and not len(model.cells):
        raise SceneError("The net has no cells for its load to act on; load its members instead.")
    solve, free, pull = _factor(frame.nodes, members, relative, fixed)
    slack = frame.nodes.copy()
    slack[free] = solve(-pull)
    sign = 1.0 if record.shape == "standing" else -1.0

    nodes, last = slack, np.inf
    for _ in range(_MOST):
        weight = _weights(replace(frame, nodes=nodes), model.cells, branches, record.load)
        bend = solve(np.column_stack([np.zeros((len(free), 2)), weight[free]]))[:, 2]
        if bend.max() < _CLOSE * max(np.ptp(slack), 1.0):
            raise SceneError(
                "The load does not bend the net, for its surface stands upright; load the area of "
                "the surface, or keep the form as drawn."
            )
        scale = bend.max() / record.rise
        previous, nodes = nodes, slack.copy()
        nodes[free, 2] += sign * bend / scale
        last = np.abs(nodes - previous).max()
        if last <= _CLOSE * record.rise:
            break
    else:
        raise SceneError(
            f"The form does not settle: after {_MOST} rounds it still moves by {last:.2g} m; ask "
            "for less rise, or load the area in plan."
        )
    forces = np.zeros_like(nodes)
    forces[:, 2] = -weight
    return Form(nodes, branches, -sign * scale * relative, fixed, forces)


def formed(model: Model, record: FormFinding) -> Model:
    """``model`` in the form that is found, its members turned with the surface.

    Each keeps its angle to the normal of the surface. Drawn forms stay as they are. Raises
    SceneError as `found_form` does.
    """
    if record.shape == "drawn":
        return model
    form = found_form(model, record)
    frame = replace(model.frame, nodes=form.nodes)
    if len(model.cells):
        frame = replace(frame, normals=_normals_on(model, frame, form.branches))
    return replace(model, frame=frame)


def _factor(
    nodes: Vector, members: NDArray[np.integer], densities: Vector, fixed: NDArray[np.bool_]
) -> tuple[Callable[[Vector], Vector], NDArray[np.intp], Vector]:
    """A solver by CᵀQC of the free nodes, those nodes, and CᵀQC_f x_f."""
    count, start, end = len(nodes), members[:, 0], members[:, 1]
    used = np.zeros(count, dtype=bool)
    used[members] = True
    free = np.flatnonzero(used & ~fixed)
    parts, label = connected_components(
        coo_array((np.ones(len(members)), (start, end)), shape=(count, count)), directed=False
    )
    anchored = np.zeros(parts, dtype=bool)
    anchored[label[fixed]] = True
    loose = free[~anchored[label[free]]]
    if len(loose):
        raise SceneError(
            f"The part of the net with node {loose[0]} is held nowhere; support one of its nodes."
        )
    row = np.arange(len(members))
    ones = np.ones(len(members))
    ends = (np.concatenate([row, row]), np.concatenate([start, end]))
    branch = csr_array((np.concatenate([ones, -ones]), ends), shape=(len(members), count))
    stiffness = csc_array(branch.T @ (densities[:, None] * branch))
    factor = splu(
        stiffness[free][:, free].tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True},
    )
    pull = stiffness[free][:, np.flatnonzero(fixed)] @ nodes[fixed]
    return factor.solve, free, pull


def _on_surface(model: Model) -> NDArray[np.bool_]:
    """Which members are on the surface; all of them where it is not said."""
    on = ~np.isnan(model.surface[:, 0])
    return on if on.any() else np.ones_like(on)


def _held(model: Model, branches: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Nodes (N,) that a support holds in place, or a member beside the surface."""
    fixed = model.frame.held[:, :3].any(axis=1)
    beside = np.ones(len(model.frame.members), dtype=bool)
    beside[branches] = False
    fixed[model.frame.members[beside]] = True
    return fixed


def _relative_densities(
    model: Model, branches: NDArray[np.intp], record: FormFinding
) -> tuple[Vector, NDArray[np.intp]]:
    """Densities (B,) before they are scaled, and the nodes along the edges of the surface.

    The first and third side of a quadrilateral cell run along, the others across; a member of one
    cell alone is an edge.
    """
    cells = np.where(model.cells == NO_NODE, model.cells[:, [0, 1, 2, 2]], model.cells)
    count = np.int64(len(model.frame.nodes))
    sides = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=-1), axis=-1)
    keys = (sides[..., 0].astype(np.int64) * count + sides[..., 1]).ravel()
    which = np.tile(np.arange(4) % 2, len(cells))
    known, first, times = np.unique(keys, return_index=True, return_counts=True)
    ends = np.sort(model.frame.members[branches], axis=1).astype(np.int64)
    wanted = ends[:, 0] * count + ends[:, 1]
    if not len(known):
        return np.full(len(branches), record.along), np.zeros(0, dtype=np.intp)
    place = np.minimum(np.searchsorted(known, wanted), len(known) - 1)
    met = known[place] == wanted
    across = met & (which[first[place]] == 1)
    is_edge = met & (times[place] == 1)
    relative = np.where(across, record.across, record.along) * np.where(is_edge, record.edge, 1.0)
    return relative, np.unique(ends[is_edge])


def _weights(
    frame: Frame, cells: NDArray[np.int32], branches: NDArray[np.intp], load: str
) -> Vector:
    """Weight (N,) in N that comes to each node from its members, by the lever rule."""
    if load == "members":
        line = np.zeros((len(frame.members), 2))
        line[branches] = 1.0
    else:
        tributary = tributary_of(frame, cells)
        share = tributary.slopes if load == "plan" else np.ones(len(cells))
        line = (tributary.weights @ share).reshape(-1, 2)
    linear = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    at_ends = frame.lengths()[:, None] * (line @ linear)
    return np.bincount(frame.members.ravel(), at_ends.ravel(), len(frame.nodes))


def _normals_on(model: Model, frame: Frame, branches: NDArray[np.intp]) -> Vector:
    """Normals (M, 3) at the angle to the new surface that they had to the old one."""
    members = frame.members[branches]

    def across(of: Frame) -> tuple[Vector, Vector]:
        """Directions in the members' cross-sections: up from the surface, and beside that."""
        up = node_normals(of, model.cells)[members].sum(axis=1)
        local = replace(of, members=members, normals=up, offsets=None).axes()
        return local[:, 2], local[:, 1]

    up, beside = across(model.frame)
    z = model.frame.axes()[branches, 2]
    cosine = np.einsum("mi,mi->m", z, up)[:, None]
    sine = np.einsum("mi,mi->m", z, beside)[:, None]
    up, beside = across(frame)
    normals = frame.normals.copy()
    normals[branches] = cosine * up + sine * beside
    return normals
