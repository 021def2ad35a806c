"""A structure from any network of edges, such as those of a mesh drawn in Blender."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.errors import SceneError
from ..core.parameters import param
from ..core.scene import Vector
from .frame import FIXED, HINGED, Frame
from .grid import Indices, cell_edges
from .mesh_repair import Repaired, repaired
from .model import NO_NODE, Model

GROUPS = ("members",)
_LEAST, _MOST = 0.01, 200.0  # m, of the middle one of the members' lengths


@dataclass(frozen=True, slots=True, kw_only=True)
class Network:
    """How the edges of a mesh become a structure."""

    supports: Literal["lowest", "boundary", "given"] = param(
        "lowest", help="Held are the lowest vertices, those around the edge, or chosen ones"
    )
    within: float = param(
        1e-3, "m", 0.0, 100.0, "How far above the lowest vertex the lowest ones may be"
    )
    chosen: str = param("", help="Indices of the chosen vertices, such as “0, 4, 7”")
    base: Literal["hinged", "fixed"] = param("hinged", help="How the held nodes are held")
    merge: float = param(1e-4, "m", 0.0, 1.0, "Vertices nearer to one another become one node")


def model_from_edges(
    nodes: ArrayLike,
    edges: ArrayLike,
    faces: Sequence[Sequence[int]] = (),
    network: Network | None = None,
) -> Model:
    """The structure whose members are the ``edges`` (M, 2) between ``nodes`` (N, 3) in m.

    ``faces`` are node indices around each cell, counter-clockwise seen from outside. Members take
    their normals from the faces beside them, by area, and point up where there are none. Around the
    edge are the ends of edges with a single face, or of a single member where there are no faces.
    u and v run through the two longest sides of the box around the nodes, in the order X, Y, Z.
    What is drawn twice or left over is `repaired`, and notes say so. One group: members.

    Raises SceneError as `repaired` does, where nothing is held, where neighbouring faces face
    opposite ways, and where the mesh cannot have been drawn in metres.
    """
    network = network or Network()
    points = np.asarray(nodes, dtype=np.float64).reshape(-1, 3)
    pairs = np.asarray(edges, dtype=np.int64).reshape(-1, 2)
    mesh = repaired(points, pairs, faces, network.merge)
    _check_size(mesh)
    held = np.zeros((len(mesh.nodes), 6), dtype=bool)
    held[_supports(mesh, network)] = FIXED if network.base == "fixed" else HINGED
    notes = mesh.notes
    if held.any(axis=1).all():
        notes += (
            f"All {len(held)} nodes are held, so that only members between them bend; hold "
            "chosen vertices if that is not what is meant.",
        )
    frame = Frame(mesh.nodes, mesh.members, _normals(mesh), held)
    groups = np.zeros(len(mesh.members), dtype=np.int32)
    return Model(frame, mesh.cells, _places(mesh), groups, GROUPS, notes)


def _check_size(mesh: Repaired) -> None:
    """Raise SceneError where half of the members are too long or too short to be in metres."""
    start, end = mesh.nodes[mesh.members].transpose(1, 0, 2)
    lengths = np.linalg.norm(end - start, axis=1)
    middle = float(np.median(lengths))
    if _LEAST <= middle <= _MOST:
        return
    member = int(np.argmin(np.abs(lengths - middle)))
    first, last = mesh.members[member]
    unit, factor = ("millimetres", 0.001) if middle > _MOST else ("kilometres or to scale", 1000)
    raise SceneError(
        f"Half of the members are {'longer' if middle > _MOST else 'shorter'} than {middle:.4g} m, "
        f"as member {member} (nodes {first} and {last}) is: the mesh seems to be drawn in {unit}; "
        f"scale it, by {factor:g} for one, and apply the scale."
    )


def _supports(mesh: Repaired, network: Network) -> NDArray[np.integer]:
    """The held nodes, or SceneError where there are none."""
    if network.supports == "lowest":
        height = mesh.nodes[:, 2]
        return np.flatnonzero(height <= height.min() + network.within)
    if network.supports == "given":
        return _chosen(mesh, network.chosen)
    if len(mesh.cells):
        ends = np.sort(cell_edges(mesh.cells)[0], axis=1)
        rim, times = np.unique(ends, axis=0, return_counts=True)
        around = np.unique(rim[times == 1])
    else:
        meeting = np.bincount(mesh.members.ravel(), minlength=len(mesh.nodes))
        around = np.flatnonzero(meeting == 1)
    if not len(around):
        raise SceneError("The mesh is closed and has no edge to hold; hold its lowest vertices.")
    return around


def _chosen(mesh: Repaired, text: str) -> NDArray[np.integer]:
    words = text.replace(",", " ").split()
    if not words:
        raise SceneError(
            "No nodes are chosen to be held; write their indices, such as “0, 4, 7”, or hold the "
            "lowest."
        )
    for word in words:
        if not word.isdecimal():
            raise SceneError(f"“{word}” is no index of a vertex to hold; write “0, 4, 7” for one.")
        node = int(word)
        if node >= len(mesh.index) or mesh.index[node] == NO_NODE:
            raise SceneError(
                f"Node {node} is to be held, but no edge ends there; choose vertices of the mesh."
            )
    return mesh.index[np.array(words, dtype=np.int64)]


def _normals(mesh: Repaired) -> Vector:
    """Unit normals (M, 3) of the faces beside each member, by area; up where there are none."""
    normals = np.zeros((len(mesh.members), 3))
    if len(mesh.cells):
        ends, owner = cell_edges(mesh.cells)
        _check_sides(ends, owner)
        at, of = _matched(np.sort(ends, axis=1), np.sort(mesh.members, axis=1))
        np.add.at(normals, of, _areas(mesh.nodes, mesh.cells)[owner[at]])
    size = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(size > 0, normals / np.maximum(size, 1e-300), (0.0, 0.0, 1.0))


def _areas(nodes: Vector, cells: Indices) -> Vector:
    """The cells' area vectors (F, 3) in m², by their diagonals; a triangle's last corner twice."""
    a, b, c, d = np.moveaxis(nodes[np.where(cells == NO_NODE, cells[:, [2]], cells)], 1, 0)
    return np.cross(c - a, d - b) / 2


def _matched(ends: Indices, members: Indices) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The rows of ``ends`` that are members, and which: both sorted, each member once."""
    names, wanted = (pairs.astype(np.int64) @ (1 << 31, 1) for pairs in (members, ends))
    order = np.argsort(names)
    found = order[np.minimum(np.searchsorted(names, wanted, sorter=order), len(names) - 1)]
    at = np.flatnonzero(names[found] == wanted)
    return at, found[at]


def _check_sides(ends: Indices, owner: Indices) -> None:
    """Raise SceneError where two faces run the same way along an edge: they face opposite ways."""
    names = ends.astype(np.int64) @ (1 << 31, 1)
    _, first, which = np.unique(names, return_index=True, return_inverse=True)
    again = first[which] != np.arange(len(ends))
    if again.any():
        edge = int(np.argmax(again))
        start, end = ends[edge]
        raise SceneError(
            f"Cells {owner[first[which[edge]]]} and {owner[edge]} face opposite ways at the edge "
            f"between nodes {start} and {end}; recalculate the mesh's normals to the outside."
        )


def _places(mesh: Repaired) -> Vector:
    """u and v (M, 2) of the members' middles in the box around the nodes."""
    size = np.ptp(mesh.nodes, axis=0)
    axes = np.sort(np.argsort(-size, kind="stable")[:2])
    span = np.where(size[axes] > 0, size[axes], 1.0)
    middles = mesh.nodes[mesh.members].mean(axis=1)
    return (middles - mesh.nodes.min(axis=0))[:, axes] / span
