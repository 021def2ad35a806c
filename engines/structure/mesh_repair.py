"""Makes nodes, members and cells of a drawn mesh that has doubles and leftovers in it."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ..core.errors import SceneError
from ..core.scene import Vector
from .check_frame import listed
from .grid import Indices
from .model import NO_NODE

_Rows = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Repaired:
    """A mesh without doubles: nodes (N, 3), members (M, 2), cells (F, 4) as in `Model`.

    ``index``: for each node of the mesh the one it became, NO_NODE where it is gone. ``notes``
    say what was changed.
    """

    nodes: Vector
    members: Indices
    cells: Indices
    index: _Rows
    notes: tuple[str, ...]


def repaired(
    points: Vector, edges: _Rows, faces: Sequence[Sequence[int]], merge: float
) -> Repaired:
    """The mesh of ``points`` (N, 3), ``edges`` (M, 2) and ``faces``, fit for a structure.

    Points nearer than ``merge`` in m become one, the first of them; edges without length, edges
    drawn twice, points without an edge and faces at such points go; faces of more than four
    corners are cut into triangles from their first.

    Raises SceneError for an index that is not there, a place that is no number, a face of fewer
    than three corners, or where no edges are left.
    """
    cells, cut = _cells(faces)
    _check_numbers(points, {"Edge": edges, "Face": cells})
    notes = []
    if len(cut):
        notes.append(f"{_listed('face', cut)} of more than four corners: cut into triangles.")

    first = _merged(points, merge)
    doubles = np.flatnonzero(first != np.arange(len(points)))
    if len(doubles):
        notes.append(f"{_listed('node', doubles)} merged into others nearer than {merge:g} m.")
    edges = _single(edges, first, notes)
    cells = _tidied(np.where(cells == NO_NODE, NO_NODE, first[cells]))
    beside = ~np.isin(cells, np.append(edges, NO_NODE)).all(axis=1)
    if beside.any():
        count = int(beside.sum())
        notes.append(
            f"Left out {count} {'face' if count == 1 else 'faces'} with a corner that no edge ends "
            "at."
        )
    kept = np.unique(edges)
    loose = np.setdiff1d(first, kept)
    if len(loose):
        notes.append(f"{_listed('node', loose)} without an edge: left out.")
    if len(kept) < len(points):
        notes.append("Nodes are counted anew, so their indices are not those of the mesh.")

    index = np.full(len(points) + 1, NO_NODE, dtype=np.int64)  # the last for NO_NODE itself
    index[kept] = np.arange(len(kept))
    members, cells = index[edges].astype(np.int32), index[cells[~beside]].astype(np.int32)
    return Repaired(points[kept], members, cells, index[:-1][first], tuple(notes))


def _listed(what: str, which: Sequence[int] | np.ndarray) -> str:
    """“Node 3”, “Nodes 3 and 5”, as notes begin."""
    name = what.capitalize()
    return f"{name if len(which) == 1 else name + 's'} {listed(np.asarray(which))}"


def _cells(faces: Sequence[Sequence[int]]) -> tuple[_Rows, list[int]]:
    """Cells (F, 4) of faces, and which faces had to be cut."""
    rows, cut = [], []
    for number, face in enumerate(faces):
        first, *rest = corners = [int(node) for node in face if node != NO_NODE]
        if len(corners) < 3:
            raise SceneError(f"Face {number} has {len(corners)} corners; delete it or mend it.")
        if len(corners) <= 4:
            rows.append([*corners, NO_NODE][:4])
        else:
            cut.append(number)
            rows += [[first, a, b, NO_NODE] for a, b in itertools.pairwise(rest)]
    return np.array(rows, dtype=np.int64).reshape(-1, 4), cut


def _check_numbers(points: Vector, used: dict[str, _Rows]) -> None:
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        raise SceneError(f"Node {np.argmax(bad)} has no place; give it finite coordinates.")
    for name, rows in used.items():
        out = (rows >= len(points)) | (rows < 0)
        if name == "Face":
            out[:, 3] &= rows[:, 3] != NO_NODE
        if out.any():
            row, column = np.argwhere(out)[0]
            raise SceneError(
                f"{name} {row} names node {rows[row, column]}, but there are nodes 0 to "
                f"{len(points) - 1}; take the indices from the same mesh."
            )


def _merged(points: Vector, merge: float) -> _Rows:
    """For each point the lowest index of those that it is one with (N,)."""
    first = np.arange(len(points))
    if merge > 0 and len(points):
        close = np.sort(KDTree(points).query_pairs(merge, output_type="ndarray"), axis=1)
        for a, b in close[np.lexsort(close.T)].tolist():
            first[b] = min(first[b], first[a])
    return first


def _single(drawn: _Rows, first: _Rows, notes: list[str]) -> _Rows:
    """The edges ``drawn`` that have a length, each once, between the nodes that are ``first``."""
    edges, names = first[drawn], np.array([f"{start}–{end}" for start, end in drawn])
    real = edges[:, 0] != edges[:, 1]
    if not real.all():
        notes.append(f"{_listed('edge', names[~real])} without length: left out.")
    number = np.flatnonzero(real)
    _, once = np.unique(np.sort(edges[real], axis=1), axis=0, return_index=True)
    twice = np.delete(number, once)
    if len(twice):
        notes.append(f"{_listed('edge', names[twice])} there already: left out.")
    if not len(once):
        raise SceneError("The mesh has no edges to make members of; draw some, or choose another.")
    return edges[number[np.sort(once)]]


def _tidied(cells: _Rows) -> _Rows:
    """Cells without the corners that became one with the next; those left with two go."""
    following = np.roll(cells, -1, axis=1)
    three = cells[:, 3] == NO_NODE
    following[three, 2] = cells[three, 0]
    same = (cells == following) & (cells != NO_NODE)
    bad = same.any(axis=1)
    rows = []
    for cell, double in zip(cells[bad], same[bad], strict=True):
        rest = cell[~double & (cell != NO_NODE)].tolist()
        if len(set(rest)) == 3:
            rows.append([*rest, NO_NODE])
    return np.concatenate([cells[~bad], np.array(rows, dtype=np.int64).reshape(-1, 4)])
