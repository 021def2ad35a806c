"""What fills the space between surfaces: air, glasses, liquids, one inside or beside another.

A photon carries the set of transparent bodies that it is in; where several overlap, the one of the
highest priority is there, and at equal priority the smaller one [Schmidt & Budge 2002]. A surface
between two places of the same body is no surface.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ..core.clipping import coverage
from ..core.errors import SceneError
from ..core.scene import Body, Luminaire, Mesh, Vector
from ..core.solid import encloses
from . import spectrum
from .targets import MM

MOST = 31
"""Transparent bodies in a scene: one bit each."""
BESIDE = 1e-6
"""m between the faces of two bodies that count as touching."""
LEVEL = 1e-2
"""m from which faces that lean by BESIDE have one plane: 0.1 mrad."""
PLANES, CELLS = 64, 256
"""Planes that are looked at, the largest, and cells a side on each, to find touching faces."""


@dataclass(frozen=True, slots=True)
class Media:
    """The media of a scene by rank, 0 the air: the higher rank is there where bodies overlap.

    ``rank`` (B,) int of each body, 0 for opaque ones. ``ior`` (M, K) float64 by medium and
    wavelength, ``absorption`` (M,) in 1/mm.
    """

    rank: NDArray[np.int64]
    ior: NDArray[np.float64]
    absorption: NDArray[np.float64]


def media_of(bodies: tuple[Body, ...], wavelengths: NDArray[np.floating] | None) -> Media:
    """Rank the transparent bodies and look up their indices of refraction.

    ``wavelengths`` (K,) in nm, or None for the one index that each material names. Raises
    SceneError for more than MOST bodies, for one that is hidden wholly inside another of higher
    priority, and for two that touch face to face.
    """
    clear = [i for i, b in enumerate(bodies) if b.material.kind == "dielectric"]
    if len(clear) > MOST:
        raise SceneError(f"There are {len(clear)} transparent bodies; join some, {MOST} can be.")
    boxes = {i: _box(bodies[i].mesh) for i in clear}
    size = {i: float(np.prod(boxes[i][1] - boxes[i][0])) for i in clear}
    clear.sort(key=lambda i: (bodies[i].material.priority, -size[i], i))
    rank = np.zeros(len(bodies), int)
    rank[clear] = np.arange(1, len(clear) + 1)
    for low, i in enumerate(clear):
        for j in clear[low + 1 :]:
            if (boxes[i][0] <= boxes[j][1] + BESIDE).all() and (
                boxes[j][0] <= boxes[i][1] + BESIDE
            ).all():
                _require_apart(bodies[i], bodies[j], boxes[i], boxes[j])
    materials = [bodies[i].material for i in clear]
    if wavelengths is None:
        ior = np.array([[1.0], *([m.ior] for m in materials)])
    else:
        ior = np.array(
            [np.ones(len(wavelengths)), *(spectrum.ior_at(m, wavelengths) for m in materials)]
        )
    absorption = np.array([0.0, *(m.absorption / MM for m in materials)])
    return Media(rank, ior, absorption)


def require_outside(luminaires: tuple[Luminaire, ...], bodies: tuple[Body, ...]) -> None:
    """Raise SceneError where a lamp hangs inside a transparent body."""
    for body in bodies:
        if body.material.kind != "dielectric":
            continue
        low, high = _box(body.mesh)
        for lamp in luminaires:
            place = lamp.pose[:3, 3]
            if ((low < place) & (place < high)).all() and encloses(body.mesh, place):
                raise SceneError(
                    f"Lamp “{lamp.name}” lies inside the glass of “{body.name}”; move it out."
                )


def _box(mesh: Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)


def _require_apart(under: Body, over: Body, below: Any, above: Any) -> None:
    """Two bodies with common space: neither hidden in the other, nor face to face."""
    within = (above[0] <= below[0]).all() and (below[1] <= above[1]).all()
    if within and encloses(over.mesh, under.mesh.vertices[under.mesh.faces[0, 0]]):
        # A liquid may have all its corners in the wall of its glass; that does not hide it.
        buried = all(encloses(over.mesh, place) for place in _sample(under.mesh))
        if buried and not any(encloses(under.mesh, place) for place in _sample(over.mesh)):
            raise SceneError(
                f"“{under.name}” lies wholly inside “{over.name}”, which has the higher priority "
                "and hides it; give the inner one the higher priority."
            )
    if _touching(under.mesh, over.mesh):
        raise SceneError(
            f"“{under.name}” touches “{over.name}” face to face; let one reach 0.1 mm into the "
            "other, and give the harder one the higher priority."
        )


def _sample(mesh: Mesh, count: int = 16) -> Vector:
    """Places on a mesh: of vertices and face centres each ``count`` throughout, and the centres of
    the largest faces."""
    corners = mesh.triangles()
    corners = corners.vertices[corners.faces]
    largest = np.argsort(-np.linalg.norm(_cross(corners), axis=1), kind="stable")[:count]
    even = np.linspace(0, len(corners) - 1, min(count, len(corners))).astype(int)
    chosen = np.concatenate([largest, even])
    return np.concatenate([corners[even, 0], corners[chosen].mean(axis=1)])


def _touching(one: Mesh, other: Mesh) -> bool:
    """Whether faces of both lie on each other: on one plane, with a common part of it."""
    corners = [m.vertices[m.faces] for m in (one.triangles(), other.triangles())]
    low = np.max([c.min(axis=(0, 1)) for c in corners], axis=0) - BESIDE
    high = np.min([c.max(axis=(0, 1)) for c in corners], axis=0) + BESIDE
    near = [c[((c.max(axis=1) >= low) & (c.min(axis=1) <= high)).all(axis=1)] for c in corners]
    if not all(map(len, near)):
        return False
    near = [c - (low + high) / 2 for c in near]
    planes = [_planes(c) for c in near]
    # Faces of the one that lie on a plane of the other, the largest first.
    left = np.isfinite(KDTree(planes[1]).query(planes[0], distance_upper_bound=BESIDE)[0])
    size = np.linalg.norm(_cross(near[0]), axis=1)
    for _ in range(PLANES):
        if not left.any():
            return False
        plane = planes[0][np.where(left, size, 0.0).argmax()]
        these, those = (np.abs(p - plane).max(axis=1) <= 2 * BESIDE for p in planes)
        if _sharing(near[0][these], near[1][those], plane[:3]):
            return True
        left &= ~these
    return False


def _cross(corners: Vector) -> Vector:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _planes(corners: Vector) -> Vector:
    """The planes of triangles (T, 4): unit normal × LEVEL, and the distance from the origin in m.

    Of the two normals the one whose largest component is positive.
    """
    normal = _cross(corners)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    largest = np.take_along_axis(normal, np.abs(normal).argmax(axis=1)[:, None], axis=1)
    normal *= np.sign(largest)
    away = np.einsum("tj,tj->t", normal, corners.mean(axis=1))
    return np.column_stack([normal * LEVEL, away])


def _sharing(one: Vector, other: Vector, normal: Vector) -> bool:
    """Whether triangles of the one cover some of the others', all in the plane across ``normal``.

    Found where they claim more of a cell of a fine grid than there is.
    """
    if not len(other):
        return False
    axes = np.linalg.svd(normal[None, :])[2][1:]
    flat = [c @ axes.T for c in (one, other)]
    low = np.min([f.min(axis=(0, 1)) for f in flat], axis=0)
    size = np.max([f.max(axis=(0, 1)) for f in flat], axis=0) - low
    covered = [np.minimum(coverage((f - low) / size, CELLS, CELLS), 1.0) for f in flat]
    return bool((covered[0] + covered[1] > 1.001).any())
