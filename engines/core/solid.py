"""Solids: whether a mesh encloses a volume, and making it do so.

Vertices at the very same place count as one here, because STL files list each corner anew.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .errors import SceneError
from .meshlab import closes_holes, lacking, mesh_set
from .scene import Mesh, Vector

Faces = NDArray[np.int32]

_REMEDY = "Repair it in Glass › Check, or tick Repair."


@dataclass(frozen=True, slots=True)
class Report:
    """What keeps a mesh from being a solid, counted over its triangles.

    ``faces`` is how many there are. ``open_edges`` have one face, ``crowded_edges`` more than two,
    ``twisted_edges`` two that are wound opposite ways. ``parts`` are the connected pieces and
    ``inside_out`` those that face the wrong way (a void inside a part should face inward); both
    are counted once no edge is amiss and are 0 before. ``degenerate`` faces have no area or a
    corner that is not a number; by themselves they do no harm.
    """

    faces: int
    open_edges: int
    crowded_edges: int
    twisted_edges: int
    parts: int
    inside_out: int
    degenerate: int

    @property
    def problem(self) -> str:
        """The first thing that is wrong, as in “is open: 14 edges have one face”, or nothing."""
        if self.faces == 0:
            return "has no faces"
        if self.open_edges:
            return f"is open: {_count(self.open_edges, 'edge has', 'edges have')} one face"
        if self.crowded_edges:
            have = _count(self.crowded_edges, "edge has", "edges have")
            return f"touches itself: {have} more than two faces"
        if self.twisted_edges:
            lie = _count(self.twisted_edges, "edge lies", "edges lie")
            return f"is twisted: {lie} between faces that are wound opposite ways"
        if self.inside_out:
            if self.parts == 1:
                return "is inside out: its faces look inward"
            return f"is inside out in {self.inside_out} of its {self.parts} parts"
        return ""


def inspect(mesh: Mesh) -> Report:
    """Whether ``mesh`` is a solid, and if not, what is wrong with it.

    Takes any mesh, of triangles or quadrilaterals, open or broken as it may be; raises nothing.
    """
    return _report(mesh, slivers=True)


def require_solid(name: str, mesh: Mesh) -> None:
    """Raise SceneError, naming the glass, unless ``mesh`` is a solid."""
    if _is_sound(mesh):
        return
    report = _report(mesh, slivers=False)
    if report.faces == 0:
        raise SceneError(f"Glass “{name}” has no faces; give it a closed mesh or remove it.")
    if report.problem:
        raise SceneError(f"Glass “{name}” {report.problem}. {_REMEDY}")


def _is_sound(mesh: Mesh) -> bool:
    """Whether the polygons as they are listed make one solid that faces outward: the usual case, in
    a third of the time. Anything else, vertices listed twice for one, is left to `_report`."""
    vertices, faces = mesh.vertices, mesh.faces
    if not len(faces) or not np.isfinite(vertices).all():
        return False
    if not _edges(faces, len(vertices)).sound:
        return False
    first, *others = faces.T
    ends = np.concatenate([first] * len(others)), np.concatenate(others)
    graph = coo_array((np.ones(len(ends[0]), np.int8), ends), shape=(len(vertices),) * 2)
    _, labels = connected_components(graph, directed=False)
    if (labels[first] != labels[first[0]]).any():
        return False
    rows = np.ascontiguousarray((vertices - vertices[first[0]]).T)
    a, b, *rest = (rows[:, corner] for corner in faces.T)
    volume = 0.0
    for c in rest:
        volume += float(_dot(a, _cross(b, c)).sum())
        b = c
    return volume > 0


def _report(mesh: Mesh, *, slivers: bool) -> Report:
    """`inspect`; without ``slivers``, only faces that lost a corner count as degenerate."""
    vertices, faces = _merged(mesh)
    usable = _usable(vertices, faces)
    whole = usable & _has_area(vertices, faces) if slivers else usable
    degenerate = np.count_nonzero(~whole)
    if not usable.all():
        faces = faces[usable]
    edges = _edges(faces, len(vertices))
    parts, wrong = 0, np.zeros(0, dtype=bool)
    if len(faces) and edges.sound:
        labels, wrong = _parts(vertices, faces)
        parts = int(labels.max()) + 1
    return Report(
        faces=len(faces),
        open_edges=int(np.count_nonzero(edges.open)),
        crowded_edges=int(np.count_nonzero(edges.crowded)),
        twisted_edges=int(np.count_nonzero(edges.twisted)),
        parts=parts,
        inside_out=int(np.count_nonzero(wrong)),
        degenerate=int(degenerate),
    )


def encloses(mesh: Mesh, place: Vector) -> bool:
    """Whether ``place`` (3,) lies inside a closed mesh, by its winding number."""
    faces = mesh.triangles().faces
    return abs(_winding(mesh.vertices - place, faces)) > 0.5


def repair(mesh: Mesh) -> tuple[Mesh, list[str]]:
    """The solid that ``mesh`` was meant to be, and a note on each thing done to it.

    A mesh that is one already comes back as it is, without notes. Otherwise the result is in
    triangles: coincident vertices are joined; faces without area, listed twice, or beyond the two
    largest at an edge are dropped; faces are wound like their neighbours; holes are closed with
    flat faces (pymeshlab); parts that are inside out are turned. What could not be repaired is
    told in the last note. Corner normals are kept where their faces are.
    """
    if not inspect(mesh).problem:
        return mesh, []
    notes = []
    mesh, joined = _joined(mesh)
    _note(notes, joined, "Joined {} with another at the same place.", "vertex", "vertices")
    mesh, dropped = _without_spares(mesh)
    _note(notes, dropped, "Dropped {} without area or listed twice.", "face", "faces")
    mesh, dropped = _uncrowded(mesh)
    _note(notes, dropped, "Dropped {} at edges with more than two.", "face", "faces")
    mesh, turned = _agreed(mesh)
    _note(notes, turned, "Turned {} to agree with the neighbours.", "face", "faces")
    filled, holes = _closed(mesh)
    if not _edges(filled.faces, len(filled.vertices)).sound:
        mesh, dropped = _unpinched(mesh)
        _note(notes, dropped, "Dropped {} where holes touch in a point.", "face", "faces")
        filled, holes = _closed(mesh)
    mesh = filled
    _note(notes, holes, "Closed {} with flat faces.", "hole", "holes")
    mesh, turned = _outward(mesh)
    _note(notes, turned, "Turned {} that faced the wrong way.", "part", "parts")
    left = inspect(mesh).problem
    if left:
        notes.append(f"Could not repair everything: it still {left}.")
        notes += [lacking()] * bool(lacking())
    return mesh, notes


def _note(notes: list[str], number: int, text: str, one: str, many: str) -> None:
    if number:
        notes.append(text.format(_count(number, one, many)))


def _count(number: int, one: str, many: str) -> str:
    return f"{number:,} {one if number == 1 else many}"


@dataclass(frozen=True, slots=True)
class _Edges:
    """The E distinct edges of a triangle mesh.

    ``sides`` (3F,) lists the triangles' sides (side s belongs to face s // 3) edge by edge; the
    sides of edge e start at ``first[e]``. ``open``, ``crowded`` and ``twisted`` (E,) are flags.
    """

    sides: NDArray[np.intp]
    first: NDArray[np.intp]
    open: NDArray[np.bool_]
    crowded: NDArray[np.bool_]
    twisted: NDArray[np.bool_]

    @property
    def sound(self) -> bool:
        """Whether every edge has two faces wound alike."""
        return not (self.open | self.crowded | self.twisted).any()


def _edges(faces: Faces, vertices: int) -> _Edges:
    start = faces.astype(np.int64)
    end = np.roll(start, -1, axis=1)
    forward = start < end
    key = ((np.minimum(start, end) * vertices + np.maximum(start, end)) * 2 + forward).ravel()
    sides = np.argsort(key, kind="stable")
    key = key[sides]
    edge = key >> 1
    first = np.flatnonzero(np.append(True, edge[1:] != edge[:-1])[: len(edge)])
    size = np.diff(first, append=len(key))
    pair = size == 2
    twisted = np.zeros(len(first), dtype=bool)
    twisted[pair] = key[first[pair]] == key[first[pair] + 1]
    return _Edges(sides, first, size == 1, size > 2, twisted)


def _merged(mesh: Mesh) -> tuple[Vector, Faces]:
    """Vertices without coincident ones, and the triangles between them."""
    vertices, faces = mesh.vertices, mesh.triangles().faces
    # Coincident points share their shadow on an odd direction; a shadow shared by chance is
    # noticed below.
    shadow = vertices[:, 0] + 0.7390851332 * vertices[:, 1] + 0.5671432904 * vertices[:, 2]
    _, kept, inverse = np.unique(shadow, return_index=True, return_inverse=True)
    if len(kept) == len(vertices):
        return vertices, faces
    if not np.array_equal(vertices[kept][inverse], vertices, equal_nan=True):
        _, kept, inverse = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    return vertices[kept], inverse[faces].astype(np.int32)


def _usable(vertices: Vector, faces: Faces) -> NDArray[np.bool_]:
    """Which faces have three corners at different places, all of them numbers."""
    a, b, c = faces.T
    finite = np.isfinite(vertices).all(axis=1)
    return (a != b) & (b != c) & (c != a) & finite[faces].all(axis=1)


def _has_area(vertices: Vector, faces: Faces) -> NDArray[np.bool_]:
    """Which faces are not slivers, whose height is lost beside their length."""
    a, b, c = _corners(vertices, faces)
    u, v = b - a, c - a
    longest = np.maximum(_dot(u, u), _dot(v, v))
    across = _cross(u, v)
    return _dot(across, across) > (1e-12 * longest) ** 2


def _corners(vertices: Vector, faces: Faces) -> tuple[Vector, Vector, Vector]:
    """The faces' corners, (3, F) each: whole rows of x, y and z are quicker to work on."""
    rows = np.ascontiguousarray(vertices.T)
    a, b, c = (rows[:, corner] for corner in faces.T)
    return a, b, c


def _cross(a: Vector, b: Vector) -> Vector:
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def _dot(a: Vector, b: Vector) -> Vector:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _parts(vertices: Vector, faces: Faces) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
    """Each face's part, and which parts face the wrong way; the mesh must be closed.

    A part should face outward, inside another inward, inside two outward again.
    """
    labels = _labels(faces, len(vertices))
    count = int(labels.max()) + 1
    a, b, c = _corners(vertices - vertices[faces[0, 0]], faces)
    volume = np.bincount(labels, _dot(a, _cross(b, c)), count)
    if count == 1:
        return labels, volume < 0

    order = np.argsort(labels, kind="stable")
    pieces = np.split(faces[order], np.cumsum(np.bincount(labels, minlength=count))[:-1])
    low = np.array([vertices[piece].min(axis=(0, 1)) for piece in pieces])
    high = np.array([vertices[piece].max(axis=(0, 1)) for piece in pieces])
    for part, piece in enumerate(pieces):
        around = (low < low[part]).all(axis=1) & (high > high[part]).all(axis=1)
        point = vertices[piece[0, 0]]
        for other in np.flatnonzero(around):
            if abs(_winding(vertices - point, pieces[other])) > 0.5:
                volume[part] = -volume[part]
    return labels, volume < 0


def _labels(faces: Faces, vertices: int) -> NDArray[np.int32]:
    """The number of the connected part that each face belongs to."""
    a, b, c = faces.T
    ends = (np.concatenate([a, a]), np.concatenate([b, c]))
    graph = coo_array((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(vertices, vertices))
    _, labels = connected_components(graph, directed=False)
    return np.unique(labels[a], return_inverse=True)[1].astype(np.int32)


def _winding(vertices: Vector, faces: Faces) -> float:
    """How often the faces wind around the origin [van Oosterom & Strackee 1983]."""
    a, b, c = _corners(vertices, faces)
    la, lb, lc = (np.sqrt(_dot(v, v)) for v in (a, b, c))
    apart = la * lb * lc + _dot(a, b) * lc + _dot(b, c) * la + _dot(c, a) * lb
    return float(np.arctan2(_dot(a, _cross(b, c)), apart).sum() / (2 * np.pi))


def _joined(mesh: Mesh) -> tuple[Mesh, int]:
    vertices, faces = _merged(mesh)
    joined = len(mesh.vertices) - len(vertices)
    return Mesh(vertices, faces, mesh.triangles().normals), joined


def _without_spares(mesh: Mesh) -> tuple[Mesh, int]:
    """The mesh without faces that have lost a corner, and with each face only once."""
    keep = _usable(mesh.vertices, mesh.faces)
    _, first = np.unique(np.sort(mesh.faces, axis=1), axis=0, return_index=True)
    only = np.zeros(len(keep), dtype=bool)
    only[first] = True
    return _picked(mesh, keep & only)


def _uncrowded(mesh: Mesh) -> tuple[Mesh, int]:
    """The mesh with only the two largest faces at each edge."""
    edges = _edges(mesh.faces, len(mesh.vertices))
    a, b, c = _corners(mesh.vertices, mesh.faces)
    across = _cross(b - a, c - a)
    area = _dot(across, across)
    keep = np.ones(len(area), dtype=bool)
    last = np.append(edges.first[1:], len(edges.sides))
    for edge in np.flatnonzero(edges.crowded):
        around = edges.sides[edges.first[edge] : last[edge]] // 3
        keep[around[np.argsort(area[around])[:-2]]] = False
    return _picked(mesh, keep)


def _unpinched(mesh: Mesh) -> tuple[Mesh, int]:
    """The mesh less the faces about vertices where holes meet, so that each hole is one loop."""
    before = len(mesh.faces)
    while True:
        edges = _edges(mesh.faces, len(mesh.vertices))
        side = edges.sides[edges.first[edges.open]]
        face, corner = side // 3, side % 3
        ends = mesh.faces[face, corner], mesh.faces[face, (corner + 1) % 3]
        pinched = np.bincount(np.concatenate(ends), minlength=len(mesh.vertices)) > 2
        if not pinched.any():
            return mesh, before - len(mesh.faces)
        mesh, _ = _picked(mesh, ~pinched[mesh.faces].any(axis=1))


def _picked(mesh: Mesh, keep: NDArray[np.bool_]) -> tuple[Mesh, int]:
    """The mesh with the faces to ``keep`` and the vertices that they use, and how many went."""
    used, faces = np.unique(mesh.faces[keep], return_inverse=True)
    normals = None if mesh.normals is None else mesh.normals[keep]
    kept = Mesh(mesh.vertices[used], faces.reshape(-1, 3).astype(np.int32), normals)
    return kept, int(np.count_nonzero(~keep))


def _agreed(mesh: Mesh) -> tuple[Mesh, int]:
    """The mesh with every face wound like its neighbours, turning the fewer of a part's faces."""
    count = len(mesh.faces)
    edges = _edges(mesh.faces, len(mesh.vertices))
    if not edges.twisted.any():
        return mesh, 0
    # Each face stands twice, as it is and turned; neighbours that agree are joined alike, others
    # crosswise. A part then falls into two mirror images, one of which is taken.
    paired = ~(edges.open | edges.crowded)
    here, there = (edges.sides[edges.first[paired] + side] // 3 for side in (0, 1))
    cross = np.where(edges.twisted[paired], count, 0)
    ends = (
        np.concatenate([here, here + count]),
        np.concatenate([there + cross, there + count - cross]),
    )
    graph = coo_array((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(2 * count, 2 * count))
    _, labels = connected_components(graph, directed=False)
    as_is, turned = labels[:count], labels[count:]
    turn = as_is > turned
    part = np.minimum(as_is, turned)
    share = np.bincount(part, turn) / np.maximum(np.bincount(part), 1)
    turn ^= (share[part] > 0.5) & (as_is != turned)
    return _turned(mesh, turn), int(np.count_nonzero(turn))


def _closed(mesh: Mesh) -> tuple[Mesh, int]:
    """The mesh with its holes filled, and how many there were."""
    edges = _edges(mesh.faces, len(mesh.vertices))
    gaps = int(np.count_nonzero(edges.open))
    if gaps == 0:
        return mesh, 0
    work = mesh_set(mesh.vertices, mesh.faces)
    if not closes_holes(work):
        return mesh, 0
    holes = work.meshing_close_holes(maxholesize=gaps + 1)["closed_holes"]
    # Filling appends: the faces that were there stay as they were.
    faces = work.current_mesh().face_matrix().astype(np.int32)
    normals = mesh.normals
    if normals is not None:
        a, b, c = _corners(mesh.vertices, faces[len(mesh.faces) :])
        flat = _cross(b - a, c - a)
        flat /= np.maximum(np.sqrt(_dot(flat, flat)), np.finfo(float).tiny)
        patch = np.repeat(flat.T[:, None], 3, axis=1)
        normals = np.concatenate([normals, patch], dtype=np.float32)
    return Mesh(mesh.vertices, faces, normals), holes


def _outward(mesh: Mesh) -> tuple[Mesh, int]:
    """The mesh with its parts facing the right way; as it is where it is not closed."""
    edges = _edges(mesh.faces, len(mesh.vertices))
    if len(mesh.faces) == 0 or not edges.sound:
        return mesh, 0
    labels, wrong = _parts(mesh.vertices, mesh.faces)
    return _turned(mesh, wrong[labels]), int(np.count_nonzero(wrong))


def _turned(mesh: Mesh, turn: NDArray[np.bool_]) -> Mesh:
    """The mesh with the faces to ``turn`` wound the other way, their normals with them."""
    faces = mesh.faces.copy()
    faces[turn] = faces[turn, ::-1]
    if mesh.normals is None:
        return replace(mesh, faces=faces)
    normals = mesh.normals.copy()
    normals[turn] = -normals[turn, ::-1]
    return replace(mesh, faces=faces, normals=normals)
