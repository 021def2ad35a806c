"""Cleaning a scanned mesh: what is doubled, empty, torn or astray goes, and each step is told."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..core.meshlab import closes_holes, lacking, mesh_set
from ..core.progress import SILENT, Progress
from ..core.scene import Vector
from .boxes import boxed
from .load import Scan, kept

_SMALL = 2e-3  # share of all faces below which a loose part is not the piece
_LEAST = 1e-6  # m, the edge of a box
_HOLE = 60  # edges around the largest hole that is closed


def clean(scan: Scan, *, close: bool = True, progress: Progress = SILENT) -> Scan:
    """The scan without its faults, a note for every step that found one.

    Vertices at the same place are joined; faces listed twice or without area, and those beyond
    two at an edge, go; then loose parts below 0.2 % of the faces, and all vertices that no face
    uses. With ``close``, holes of up to 60 edges are closed with faces between the vertices that
    are there: no point is made or moved. All of it by pymeshlab. A cloud without faces loses only
    doubled and lonely points.

    Raises Cancelled when ``progress`` is asked to stop.
    """
    if not len(scan.faces):
        progress(0.0, "Removing lonely points")
        return _clean_cloud(scan)
    progress(0.0, "Taking the mesh over")
    work = mesh_set(scan.points, scan.faces)
    notes: list[str] = []
    steps = (
        ("meshing_remove_duplicate_vertices", {}, "vertices", "Joined {} listed twice."),
        ("meshing_remove_duplicate_faces", {}, "faces", "Dropped {} listed twice."),
        ("meshing_remove_null_faces", {}, "faces", "Dropped {} without area."),
        (
            "meshing_repair_non_manifold_edges",
            {"method": "Remove Faces"},
            "faces",
            "Dropped {} at edges with more than two.",
        ),
        (
            "meshing_remove_connected_component_by_face_number",
            {"mincomponentsize": max(20, int(_SMALL * len(scan.faces)))},
            "faces",
            "Dropped {} in small loose parts.",
        ),
        ("meshing_remove_unreferenced_vertices", {}, "vertices", "Dropped {} without a face."),
    )
    for index, (step, settings, thing, text) in enumerate(steps):
        progress((1 + index) / 9, "Cleaning")
        before = _count(work, thing)
        getattr(work, step)(**settings)
        gone = before - _count(work, thing)
        if gone:
            notes.append(text.format(_said(gone, thing)))
    if close:
        progress(7 / 9, "Closing small holes")
        _close(work, notes)
    progress(8 / 9, "Handing the mesh back")
    mesh = work.current_mesh()
    points = np.ascontiguousarray(mesh.vertex_matrix())
    faces = mesh.face_matrix().astype(np.int32)
    return replace(scan, points=points, faces=faces, notes=(*scan.notes, *notes))


def _count(work: Any, thing: str) -> int:
    mesh = work.current_mesh()
    return mesh.vertex_number() if thing == "vertices" else mesh.face_number()


def _said(count: int, thing: str) -> str:
    one = {"vertices": "vertex", "faces": "face", "holes": "hole", "points": "point"}
    return f"{count:,} {thing if count != 1 else one[thing]}"


def _close(work: Any, notes: list[str]) -> None:
    if not closes_holes(work):
        notes.append(f"Holes stay open. {lacking()}")
        return
    done = work.meshing_close_holes(maxholesize=_HOLE)
    if done["closed_holes"]:
        notes.append(f"Closed {_said(done['closed_holes'], 'holes')} of at most {_HOLE} edges.")


def _clean_cloud(scan: Scan) -> Scan:
    notes = []
    _, first = np.unique(scan.points.astype(np.float32), axis=0, return_index=True)
    points = scan.points[np.sort(first)]
    if len(points) < len(scan.points):
        doubled = _said(len(scan.points) - len(points), "points")
        notes.append(f"Dropped {doubled} listed twice.")
    lonely = ~_together(points)
    if 0 < np.count_nonzero(lonely) < len(points) / 2:
        notes.append(f"Dropped {_said(int(lonely.sum()), 'points')} far from the others.")
        points, _ = kept(points, scan.faces, ~lonely)
    return replace(scan, points=points, notes=(*scan.notes, *notes))


def _together(points: Vector) -> NDArray[np.bool_]:
    """Which points lie in a large cluster of neighbouring boxes, of about eight points each."""
    low, high = np.percentile(points[:: max(1, len(points) // 100_000)], [1, 99], axis=0)
    sides = np.sort(high - low)
    edge = max(float(np.sqrt(2 * sides[1] * sides[2] * 8 / len(points))), _LEAST)
    boxes = boxed(points, low, edge)
    links = []
    for dx, dy, dz in np.ndindex(2, 3, 3):
        step = (dx * boxes.span[1] + dy - 1) * boxes.span[2] + dz - 1
        if step > 0:
            place = np.searchsorted(boxes.key, boxes.key + step)
            place = np.minimum(place, len(boxes.key) - 1)
            here = np.flatnonzero(boxes.key[place] == boxes.key + step)
            links.append(np.column_stack([here, place[here]]))
    pairs = np.concatenate(links)
    graph = coo_array((np.ones(len(pairs), np.int8), pairs.T), shape=(len(boxes.key),) * 2)
    _, part = connected_components(graph, directed=False)
    size = np.bincount(part, weights=boxes.count)
    return (size >= _SMALL * len(points))[part][boxes.which]
