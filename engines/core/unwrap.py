"""A map for a surface that has none: charts by direction, laid flat and packed.

Our own rather than xatlas 0.0.11, which laid the two halves of a fine open cylinder over each
other, does not keep to the resolution asked for, takes 25 times as long for 250,000 faces, and has
no wheel for Python 3.14.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse

from .clipping import Indices, coverage, pieces
from .errors import SceneError
from .scene import Mesh, Vector

_SMOOTHING = 4  # rounds over which noise in the normals does not make charts of its own
_STEEPEST = 0.35  # cosine between a face and the plane its chart is laid on
_CORNER = 0.01  # cosine between two faces of a box: no chart goes around it
_THIN = 1e-10  # area over the square of the longest edge: a face of less looks nowhere
_ROUNDS = 24  # of parting charts that fold over themselves
_FEW = 300  # charts: so many are packed tightly, more in shelves


@dataclass(frozen=True, slots=True)
class _Flat:
    """Charts laid flat: ``corners`` (F, 3, 2) in m from the lower left of the face's own chart,
    ``sizes`` (C, 2) in m.
    """

    corners: Vector
    sizes: Vector


def unwrap(mesh: Mesh, resolution: int, padding: int = 2, polygon: Indices | None = None) -> Vector:
    """Texture coordinates (F, 3, 2) in 0..1 for a mesh of triangles (F, 3), no place used twice.

    Faces that look along the same axis and meet are a chart, laid flat along its mean normal and
    scaled so that all charts have as many texels a square metre; within one, as faces lean, at
    most three times as many or as few. Charts stand on whole texels of a map of ``resolution`` a
    side, ``padding`` texels apart, also across the map's border; where so many do not fit, they
    stand closer. Faces without area lie at a point of the chart they touch.

    Triangles of one ``polygon`` (F,) stay together, unless they are bent too far apart for that.

    Raises SceneError when the mesh has no area, vertices that are not numbers, or more charts than
    the map has texels.
    """
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    longest = np.max([((q - p) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    area = np.sqrt((cross * cross).sum(axis=1))
    if not np.isfinite(area).all():
        raise SceneError("A surface with vertices that are not numbers cannot be unwrapped.")
    solid = np.flatnonzero(area > _THIN * longest)
    if not len(solid):
        raise SceneError("A surface without area cannot be unwrapped; give it faces.")
    points = _welded(mesh.vertices)[mesh.faces]
    if polygon is None:
        polygon = np.arange(len(mesh.faces))
    whole = np.unique(polygon[solid], return_inverse=True)[1]
    placed = _charted(mesh.vertices[mesh.faces[solid]], points[solid], whole, resolution, padding)
    texture = np.zeros((len(mesh.faces), 3, 2))
    texture[solid] = placed
    thin = np.setdiff1d(np.arange(len(mesh.faces)), solid)
    if len(thin):
        known = np.full((points.max() + 1, 2), -1.0)
        known[points[solid]] = placed
        own = known[points[thin]]
        touching = (own[..., 0] >= 0).argmax(axis=1)
        texture[thin] = np.maximum(own[np.arange(len(thin)), touching], 0.0)[:, None]
    return texture


# Charts


def _charted(
    corners: Vector, points: Indices, polygon: Indices, resolution: int, padding: int
) -> Vector:
    """Texture coordinates of faces that all have area; ``points`` (F, 3) say where they meet."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    edges = _shared_edges(points)
    unit = cross / np.sqrt((cross * cross).sum(axis=1))[:, None]
    bent = (unit[edges[:, 0] // 3] * unit[edges[:, 1] // 3]).sum(axis=1) < _CORNER
    edges = edges[~bent | (polygon[edges[:, 0] // 3] == polygon[edges[:, 1] // 3])]
    axis = _axes(cross, edges, polygon)
    chart = _parts(axis, edges)
    depth = corners.mean(axis=1)[np.arange(len(axis)), axis % 3]
    placed = _packed(_laid_flat(corners, cross, axis, chart, edges), chart, resolution, padding)
    for _ in range(_ROUNDS):
        upper = _upper(placed, depth, resolution)
        if not upper.any():
            break
        upper = (np.bincount(polygon, upper) > 0)[polygon]
        chart = _parts(2 * chart + upper, edges)
        placed = _packed(_laid_flat(corners, cross, axis, chart, edges), chart, resolution, padding)
    return placed


def _welded(vertices: Vector) -> Indices:
    """The same number (V,) for vertices at the same place."""
    order = np.lexsort(vertices.T)
    new = (np.diff(vertices[order], axis=0) != 0).any(axis=1)
    number = np.empty(len(vertices), dtype=np.intp)
    number[order] = np.concatenate([[0], np.cumsum(new)])
    return number


def _shared_edges(faces: Indices) -> Indices:
    """Where just two faces meet (N, 2): the edge's number in each, 3 · face + corner it leaves."""
    ends = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    key = ends[:, 0] * (faces.max() + 1) + ends[:, 1]
    order = np.argsort(key, kind="stable")
    _, start, count = np.unique(key[order], return_index=True, return_counts=True)
    start = start[count == 2]
    return np.stack([order[start], order[start + 1]], axis=1)


def _axes(cross: Vector, edges: Indices, polygon: Indices) -> Indices:
    """Which of X, Y, Z, −X, −Y, −Z (0 to 5) each face looks along, neighbours alike.

    The triangles of a polygon look along the same, where there is one that none looks away from.
    """
    count = len(cross)
    joins = sparse.coo_array((np.ones(len(edges)), tuple(edges.T // 3)), shape=(count, count))
    spread = (joins + joins.T + sparse.eye_array(count)).tocsr()
    smooth = cross
    for _ in range(_SMOOTHING):
        smooth = spread @ smooth
    # A hair's preference, or else the two halves of a square at 45° may look different ways.
    along = np.concatenate([smooth, -smooth], axis=1) * (1.0 + 1e-6 * np.arange(6)[::-1])
    own = np.concatenate([cross, -cross], axis=1)
    length = np.sqrt((cross * cross).sum(axis=1))[:, None]
    chosen = np.where(own < _STEEPEST * length, -np.inf, along)
    if polygon.max() + 1 == count:
        return chosen.argmax(axis=1)
    for steepest in (_CORNER, _STEEPEST):
        shared = np.where(own < steepest * length, -np.inf, along)
        shared = np.stack([np.bincount(polygon, part) for part in shared.T], axis=1)[polygon]
        possible = np.isfinite(shared).any(axis=1)
        chosen = np.where(possible[:, None], shared, chosen)
    return chosen.argmax(axis=1)


def _parts(label: Indices, edges: Indices) -> Indices:
    """Chart (F,) of each face: those of one label that hang together."""
    a, b = edges[label[edges[:, 0] // 3] == label[edges[:, 1] // 3]].T // 3
    graph = sparse.coo_array((np.ones(len(a), dtype=bool), (a, b)), shape=2 * (len(label),))
    return sparse.csgraph.connected_components(graph, directed=False)[1]


def _laid_flat(
    corners: Vector, cross: Vector, axis: Indices, chart: Indices, edges: Indices
) -> _Flat:
    """Every chart seen along its mean normal, or its axis where a face would be too steep."""
    count = chart.max() + 1
    lengths = np.sqrt((cross * cross).sum(axis=1))
    main = np.zeros((count, 3))
    main[chart, axis % 3] = np.where(axis < 3, 1.0, -1.0)
    mean = np.stack([np.bincount(chart, part, count) for part in cross.T], axis=1)
    mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
    steepest = np.ones(count)
    np.minimum.at(steepest, chart, (cross * mean[chart]).sum(axis=1) / lengths)
    normal = np.where((steepest > _STEEPEST)[:, None], mean, main)
    upright = np.where(main[:, [2]] == 0, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0])
    v = upright - normal * (normal * upright).sum(axis=1)[:, None]
    v /= np.linalg.norm(v, axis=1)[:, None]
    frame = np.stack([np.cross(v, normal), v], axis=1)
    flat = np.einsum("fkj,fij->fki", corners, frame[chart])
    seen = np.bincount(chart, (cross * normal[chart]).sum(axis=1), count)
    flat *= np.sqrt(np.bincount(chart, lengths, count) / seen)[chart, None, None]
    turn = _turns(flat, chart, edges)[chart]
    turned = np.einsum("fkj,fij->fki", flat, turn)
    low, size = _bounds(flat, chart)
    low_turned, size_turned = _bounds(turned, chart)
    better = size_turned.prod(axis=1) < 0.99 * size.prod(axis=1)
    flat[better[chart]] = turned[better[chart]]
    low, size = np.where(better[:, None], [low_turned, size_turned], [low, size])
    return _Flat(flat - low[chart, None], size)


def _turns(flat: Vector, chart: Indices, edges: Indices) -> Vector:
    """Rotations (C, 2, 2) that take the longest edge of each chart's border along u."""
    border = np.ones(3 * len(flat), dtype=bool)
    border[edges[chart[edges[:, 0] // 3] == chart[edges[:, 1] // 3]]] = False
    edge = np.flatnonzero(border)
    run = (np.roll(flat, -1, axis=1) - flat).reshape(-1, 2)[edge]
    length = np.hypot(*run.T)
    order = np.lexsort((length, chart[edge // 3]))
    u = np.tile([1.0, 0.0], (int(chart.max()) + 1, 1))
    u[chart[edge[order] // 3]] = run[order] / np.maximum(length[order], 1e-300)[:, None]
    return np.stack([u, u[:, ::-1] * [-1, 1]], axis=1)


def _bounds(flat: Vector, chart: Indices) -> tuple[Vector, Vector]:
    """Lower left and size (C, 2) of each chart."""
    low = np.full((2, chart.max() + 1), np.inf)
    high = -low
    for axis in (0, 1):
        np.minimum.at(low[axis], chart, flat[..., axis].min(axis=1))
        np.maximum.at(high[axis], chart, flat[..., axis].max(axis=1))
    return low.T, (high - low).T


def _upper(placed: Vector, depth: Vector, resolution: int) -> NDArray[np.bool_]:
    """Faces (F,) of a chart that lies over itself that are the farther ones where it does."""
    upper = np.zeros(len(depth), dtype=bool)
    twice = coverage(placed, resolution, resolution).ravel() > 1 + 1e-6
    if twice.any():
        nearest = np.full(len(twice), np.inf)
        farthest, lean = -nearest, np.zeros(len(depth))
        for some in pieces(placed, resolution, resolution):
            np.minimum.at(nearest, some.texel, depth[some.face])
            np.maximum.at(farthest, some.texel, depth[some.face])
        for some in pieces(placed, resolution, resolution):
            near, far = nearest[some.texel], farthest[some.texel]
            bound = 0.4 * near + 0.6 * far  # beyond the middle, where of three one may well be
            above = some.covered * (depth[some.face] - bound) * twice[some.texel]
            np.add.at(lean, some.face, above)
        upper = lean > 1e-9 * np.ptp(depth)
    return upper


# Packing


def _packed(flat: _Flat, chart: Indices, resolution: int, padding: int) -> Vector:
    """Texture coordinates of charts side by side, as large as the map lets them be."""
    sizes = flat.sizes
    pack = _tightly if len(sizes) <= _FEW else _in_shelves
    for gap in range(padding, -1, -1):
        largest = min(
            resolution / np.sqrt(sizes.prod(axis=1).sum()), (resolution - gap) / sizes.max()
        )
        low, high, best = 0.0, 2 * largest, None
        while high - low > 1e-3 * largest:
            density = (low + high) / 2  # texels a metre; the first is the largest that there can be
            cells = np.maximum(np.ceil(sizes * density - 1e-9), 1).astype(np.intp) + gap
            found = pack(cells, resolution)
            if found is None:
                high = density
            else:
                low, best = density, (density, *found)
                high = min(high, largest)
        if best:
            density, place, turned = best
            x, y = np.moveaxis(flat.corners, -1, 0)
            across = sizes[chart, None, 1] - y
            turn = turned[chart, None]
            laid = np.stack([np.where(turn, across, x), np.where(turn, x, y)], axis=-1)
            return np.clip((place[chart, None] + laid * density) / resolution, 0.0, 1.0)
    raise SceneError(
        f"A surface of {len(sizes)} separate pieces does not fit a map of {resolution} texels "
        "a side; raise its resolution."
    )


Packing = tuple[Indices, NDArray[np.bool_]]
"""Lower left (C, 2) in texels, and which charts were turned by 90° (C,)."""


def _tightly(cells: Indices, side: int) -> Packing | None:
    """Largest first, each where and turned as its top comes lowest; None if they do not fit."""
    skyline = np.zeros(side, dtype=np.intp)
    place, turned = np.zeros_like(cells), np.zeros(len(cells), dtype=bool)
    for item in np.argsort(-cells.max(axis=1), kind="stable"):
        options = []
        for turn, (width, height) in enumerate((cells[item], cells[item, ::-1])):
            if width > side:
                continue
            under = ndimage.maximum_filter1d(skyline, width, origin=-(width // 2))
            x = int(under[: side - width + 1].argmin())
            options.append((int(under[x] + height), x, int(width), turn))
        if not options or min(options)[0] > side:
            return None
        top, x, width, turn = min(options)
        skyline[x : x + width] = top
        place[item] = x, top - cells[item, 1 - turn]
        turned[item] = bool(turn)
    return place, turned


def _in_shelves(cells: Indices, side: int) -> Packing | None:
    """Lying, in rows from the highest to the lowest; None if they do not fit."""
    height, width = np.sort(cells, axis=1).T
    order = np.argsort(-height, kind="stable")
    total = np.concatenate([[0], np.cumsum(width[order])])
    place = np.zeros_like(cells)
    start, top = 0, 0
    while start < len(cells):
        stop = int(np.searchsorted(total, total[start] + side, "right")) - 1
        if stop == start or top + height[order[start]] > side:
            return None
        place[order[start:stop], 0] = total[start:stop] - total[start]
        place[order[start:stop], 1] = top
        top += height[order[start]]
        start = stop
    return place, cells[:, 1] > cells[:, 0]
