"""Where members are cut at their nodes so that their solids meet."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .frame import Frame
from .model import NO_NODE

Joint = Literal["mitred", "overlapped"]

_STEEP = np.cos(np.radians(45.0))  # a member nearer to its node's normal runs in from below
_TURNED = np.sin(np.radians(20.0))  # of a section against its node's normal, about its member
_SHARPEST = 4.0  # length of a cut over the half width it cuts: 28° between two equal members
_LONGEST = 0.45  # of a member, so that its two ends do not meet


def node_normals(frame: Frame, cells: NDArray[np.int32] | None = None) -> Vector:
    """Unit normals (N, 3) of the surface at the nodes: the mean over the ``cells`` around each.

    Cells count by their area. A node without one takes the mean of its members' normals, those of
    members that run along that mean left out.
    """
    axes = frame.axes()
    count = len(frame.nodes)
    ends = frame.members.T.ravel()
    z = np.tile(axes[:, 2], (2, 1))
    along = np.tile(axes[:, 0], (2, 1))
    first = _unit(_sums(ends, z, count))
    level = np.abs(np.einsum("ei,ei->e", along, first[ends])) < _STEEP
    kept = _sums(ends[level], z[level], count)
    normals = np.where(np.linalg.norm(kept, axis=1, keepdims=True) > 1e-6, kept, first)
    if cells is not None and len(cells):
        nodes = np.where(cells == NO_NODE, cells[:, [0, 1, 2, 2]], cells)
        corners = frame.nodes[nodes]
        vectors = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        true = cells != NO_NODE
        around = _sums(cells[true], np.repeat(vectors, 4, axis=0)[true.ravel()], count)
        normals = np.where(np.linalg.norm(around, axis=1, keepdims=True) > 0, around, normals)
    return _unit(normals)


def mitre_planes(frame: Frame, widths: Vector, normals: Vector) -> Vector:
    """Normals (M, 2, 2, 3) of the planes that cut each member at its start and its end.

    At every node the members are ordered about its normal; between two neighbours they are cut by
    the plane that holds the normal and the line where their facing sides meet (the bisecting plane
    for equal widths). The last but one axis is the side: to the left of the member seen from its
    node, then to the right. n · d > 0, with d the direction away from the node.

    Members nearer than 45° to the node's normal, those whose sections are turned against it by more
    than 20°, which have no common mitre, and those with no neighbour end square at the node. On a
    twisted surface straight members meet in the plane, but not with all of their edges.
    """
    count = len(frame.members)
    axes = frame.axes()
    node = frame.members.T.ravel()
    away = np.concatenate([axes[:, 0], -axes[:, 0]])
    up = normals[node]
    rise = np.einsum("ei,ei->e", away, up)
    aside = np.abs(np.einsum("ei,ei->e", np.tile(axes[:, 1], (2, 1)), up))
    level = np.flatnonzero(
        (np.abs(rise) < _STEEP) & (aside < _TURNED) & (np.linalg.norm(up, axis=1) > 0.5)
    )
    planes = square_planes(frame)
    if not len(level):
        return planes

    up, node = up[level], node[level]
    forward = _unit(away[level] - rise[level, None] * up)
    left = np.cross(up, forward)
    member, end = level % count, level // count
    angle = _angles(forward, up)
    following, preceding, alone = _around(node, angle)
    turn = np.mod(angle[following] - angle, 2 * np.pi)
    turn = np.where(turn < 1e-9, 2 * np.pi, turn)

    width = widths[member]
    ahead = np.where(alone, 0.0, _cut(turn, width, width[following]))
    behind = np.where(alone, 0.0, _cut(turn[preceding], width, width[preceding]))
    planes[member, end, 0] = forward - ahead[:, None] * left
    planes[member, end, 1] = forward + behind[:, None] * left
    return planes


def square_planes(frame: Frame) -> Vector:
    """The planes of `mitre_planes` (M, 2, 2, 3) for ends cut square at the nodes."""
    along = frame.axes()[:, 0]
    return np.repeat(np.stack([along, -along], axis=1)[:, :, None], 2, axis=2)


def cut_lengths(
    planes: Vector, away: Vector, normals: Vector, arms: Vector, lengths: Vector
) -> Vector:
    """How far from their node, along ``away`` (E, 3), points at ``arms`` (E, P, 3) are cut, (E, P).

    ``planes`` (E, 2, 3) as of `mitre_planes`, ``normals`` (E, 3) of the nodes, ``lengths`` (E,) of
    the members in m. A cut that is too sharp stops short, and the solids overlap.
    """
    reach = -(planes @ arms.swapaxes(1, 2)) / np.einsum("esi,ei->es", planes, away)[..., None]
    left = np.cross(normals, away)
    size = np.linalg.norm(left, axis=1, keepdims=True)
    side = (arms @ (left / np.maximum(size, 1e-9))[..., None])[..., 0]
    slack = 1e-9 * np.abs(arms).max(axis=(1, 2))[:, None]
    middle = (reach[:, 0] + reach[:, 1]) / 2
    found = np.where(side > slack, reach[:, 0], np.where(side < -slack, reach[:, 1], middle))
    longest = _LONGEST * lengths[:, None]
    return np.clip(found, -longest, longest)


def _around(
    node: NDArray[np.integer], angle: Vector
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
    """The next member end about each one's node, the one before, and whether there is no other."""
    order = np.lexsort((angle, node))
    starts = np.flatnonzero(np.r_[True, np.diff(node[order]) != 0])
    sizes = np.diff(np.r_[starts, len(order)])
    begin, size = np.repeat(starts, sizes), np.repeat(sizes, sizes)
    place = np.arange(len(order)) - begin
    following, preceding = np.empty_like(order), np.empty_like(order)
    following[order] = order[begin + (place + 1) % size]
    preceding[order] = order[begin + (place - 1) % size]
    return following, preceding, following == np.arange(len(order))


def _cut(turn: Vector, own: Vector, other: Vector) -> Vector:
    """Length of a cut over the half width, between members ``turn`` apart of widths own and other.

    The facing sides meet at ((b + a cos θ) / 2 sin θ, a / 2) along and beside a member of width a,
    next to one of width b. Where they meet too far out, the plane bisects the angle.
    """
    sine, cosine = np.sin(turn), np.cos(turn)
    safe = np.where(np.abs(sine) > 1e-9, sine, 1.0)
    own, other = np.maximum(own, 1e-9), np.maximum(other, 1e-9)
    here, there = (other / own + cosine) / safe, (own / other + cosine) / safe
    meet = (np.abs(sine) > 1e-9) & (np.maximum(np.abs(here), np.abs(there)) < _SHARPEST)
    bisector = 1 / np.tan(turn / 2)
    return np.clip(np.where(meet, here, bisector), -_SHARPEST, _SHARPEST)


def _angles(forward: Vector, up: Vector) -> Vector:
    """Angle of each direction about its ``up``, from an axis that depends on ``up`` alone."""
    other = np.eye(3)[np.argmin(np.abs(up), axis=1)]
    first = _unit(np.cross(up, other))
    second = np.cross(up, first)
    return np.arctan2(np.einsum("ei,ei->e", forward, second), np.einsum("ei,ei->e", forward, first))


def _sums(index: NDArray, values: Vector, count: int) -> Vector:
    return np.stack([np.bincount(index, values[:, k], count) for k in range(3)], axis=1)


def _unit(vectors: Vector) -> Vector:
    size = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(size > 0, size, 1.0)
