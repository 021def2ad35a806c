"""The panes of a room, and the points on their inner faces on which EN 17037 counts sunlight."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from ..core.scene import Body, Mesh, Vector
from .occlusion import Occluders, is_pane
from .patches import patches_of
from .probing import UP, distances, floor_below
from .sensors import Sensors, at_points
from .visibility import visible

LEAST_HEIGHT = 1.2
"""m over the floor at which a reference point is at least [EN 17037, exposure to sunlight]."""
_CLEAR = 2e-3  # m that a point keeps off its pane
_SEEN_FROM = 64  # sensors of a room that are asked whether they see a pane
_WELDED = 1e-6  # m within which corners are one


@dataclass(frozen=True, slots=True)
class Pane:
    """One connected piece of glass: its ``middle`` (3,) in m, the unit ``normal`` (3,) of its large
    faces, of either side, half its ``thickness`` in m along it, and its ``top`` above the middle in
    m within its plane."""

    middle: Vector
    normal: Vector
    thickness: float
    top: float


def panes_of(bodies: tuple[Body, ...]) -> tuple[Pane, ...]:
    """The connected pieces of all bodies of clear glass."""
    return tuple(pane for b in bodies if is_pane(b.material) for pane in _pieces(b.mesh))


def reference_points(
    bodies: tuple[Body, ...], occluders: Occluders, sensors: Sensors
) -> Sensors | None:
    """A point on the inner face of each pane that gives on to the sensors, looking out.

    It is in the pane's middle, or higher where that is less than LEAST_HEIGHT over the floor below
    the sensors. A pane's outer side is that from which more of sky and ground is seen; it gives on
    to the sensors where one of them is seen from its inner side, be it through other panes. None
    where no pane does. ``occluders``: of the same bodies. Raises RuntimeMissing.
    """
    panes = panes_of(bodies)
    if not panes or not len(sensors):
        return None
    middle = np.array([p.middle for p in panes])
    normal = np.array([p.normal for p in panes])
    off = (np.array([p.thickness for p in panes]) + _CLEAR)[:, None]
    free = _openness(occluders, middle + off * normal, normal)
    back = _openness(occluders, middle - off * normal, -normal)
    outward = np.where((free >= back)[:, None], normal, -normal)
    depth = floor_below(occluders, sensors)
    floors = (sensors.origins[:, 2] - depth)[np.isfinite(depth)]
    if len(floors):
        middle = middle + _raised(panes, middle, float(np.median(floors)))
    inner = middle - off * outward
    facing = _sees(occluders, inner, sensors)
    return at_points(inner[facing], outward[facing]) if facing.any() else None


def _pieces(mesh: Mesh) -> Iterator[Pane]:
    triangles = mesh.triangles()
    _, welded = np.unique(np.round(triangles.vertices / _WELDED), axis=0, return_inverse=True)
    faces = welded.reshape(-1)[triangles.faces]
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    count = int(welded.max(initial=-1)) + 1
    links = coo_array((np.ones(len(ends)), ends.T), shape=(count, count))
    pieces = connected_components(links, directed=False)[1][faces[:, 0]]
    order = np.argsort(pieces, kind="stable")
    corners = triangles.vertices[triangles.faces[order]]
    for piece in np.split(corners, np.flatnonzero(np.diff(pieces[order])) + 1):
        yield from _pane(piece)


def _pane(corners: Vector) -> Iterator[Pane]:
    """The pane of triangles (T, 3, 3), none where they have no area."""
    vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(vectors, axis=1)
    if not areas.sum() > 0:
        return
    units = vectors / np.where(areas > 0, areas, 1.0)[:, None]
    normal = np.linalg.eigh((areas[:, None] * units).T @ units)[1][:, -1]
    middle = np.average(corners.mean(axis=1), axis=0, weights=areas)
    about = corners.reshape(-1, 3) - middle
    rise = UP - normal[2] * normal
    steep = np.linalg.norm(rise)
    top = float((about @ rise).max() / steep) if steep > 0 else 0.0
    yield Pane(middle, normal, float(np.abs(about @ normal).max()), top)


def _raised(panes: tuple[Pane, ...], middle: Vector, floor: float) -> Vector:
    """What to add to the middles (N, 3) that they be LEAST_HEIGHT over the floor, within steep
    panes, a tenth of their half height off the top."""
    out = np.zeros_like(middle)
    for row, pane in zip(out, panes, strict=True):
        rise = UP - pane.normal[2] * pane.normal
        steep = float(np.linalg.norm(rise))
        lacking = floor + LEAST_HEIGHT - pane.middle[2]
        if lacking > 0 and steep > np.sqrt(0.5):
            row[:] = rise / steep * min(lacking / steep, 0.9 * pane.top)
    return out


def _openness(occluders: Occluders, points: Vector, normals: Vector) -> Vector:
    """How much of sky and ground points (N, 3) see in front of them, weighted by the cosine."""
    half = patches_of(1)
    directions = np.concatenate([half.directions, half.directions * [1, 1, -1]])
    seen = visible(occluders, at_points(points, normals, offset=0.0), directions)
    return replace(seen, through=None).dot(np.tile(half.solid_angles, 2))


def _sees(occluders: Occluders, points: Vector, sensors: Sensors) -> NDArray[np.bool_]:
    """Which points (N,) see one of the sensors, or of some spread evenly over them."""
    some = np.unique(np.linspace(0, len(sensors) - 1, _SEEN_FROM).round().astype(np.int64))
    towards = sensors.some(some).origins[None] - points[:, None]
    length = np.linalg.norm(towards, axis=2).ravel()
    directions = towards.reshape(-1, 3) / np.maximum(length, 1e-12)[:, None]
    origins = np.repeat(points - occluders.centre, len(some), axis=0)
    free = distances((occluders.still, occluders.moving), origins, directions) >= length - 1e-3
    return free.reshape(len(points), -1).any(axis=1)
