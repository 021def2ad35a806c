"""The scene as Mitsuba and the photon loop see it: one triangle soup in millimetres.

Mitsuba offsets rays by an amount that grows with the coordinates; in a metre-scaled scene it would
skip thin printed walls. Therefore all is brought to millimetres about the bodies' common centre.
"""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.errors import SceneError
from ..core.glazing import by_absorption
from ..core.scene import Body, Mesh, Receiver, Scene, Surface
from ..core.solid import require_solid
from ..core.tree import Tree
from . import aim
from .media import Media, media_of
from .targets import MM, Plane, Side, first_texels, sides_of

OFFSET_MM = 1e-3
OFFSET_SHARE = 2e-6
"""A photon is set off a surface by the one and this share of its largest coordinate."""
BEHIND = 3.0
"""Such steps that a receiver's mesh stands back, so that glass on it is met, and left, first."""
KINDS = ("dielectric", "mirror", "diffuse", "plastic", "absorber", "surface")
"""What a triangle can belong to: a body of one of the material's kinds, or a receiver."""
RECORD = 16
"""Floats a triangle: 9 corner normals (a surface: 6 texture coordinates), 3 face normal, owner."""
OWNER = 8
"""Numbers an owner. A body: kind, rank of its medium, reflectance, specularity, roughness α; a
surface: kind, 0, reflectance, and with their bits columns, rows, first texels in front and behind.
"""


@dataclass(frozen=True, slots=True)
class Stage:
    """``centre`` (3,) m is the origin of stage space; ``scene`` is None without triangles.

    ``triangles`` holds RECORD floats for each triangle, ``owners`` OWNER numbers for each body and
    surface, ``ior`` and ``absorption`` what `Media` has by medium, ``bands`` wavelengths each.
    ``planes`` are the flat receivers. ``reach`` is the largest
    coordinate in mm, ``kinds`` which of KINDS occur, ``features`` whether anything is rough, tinted
    or a reflecting receiver. ``cover`` are balls in m around all that sends light on (`aim.cover`).
    """

    centre: NDArray[np.float64]
    scene: Any
    triangles: Any
    owners: Any
    ior: Any
    absorption: Any
    bands: int
    planes: tuple[Plane, ...]
    reach: float
    kinds: frozenset[str]
    features: frozenset[str]
    cover: tuple[NDArray[np.float64], float]

    def place(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """World points (…, 3) in m to stage space in mm."""
        return (points - self.centre) * MM


def build(scene: Scene, wavelengths: NDArray[np.floating] | None = None) -> Stage:
    """The stage for a scene, with the indices of its glass at ``wavelengths`` (K,) in nm if any.

    Raises SceneError for an open or inside-out dielectric, for a body without faces, and for glass
    that touches or hides other glass.
    """
    mi = runtime.mitsuba()
    for body in scene.bodies:
        _check(body)
    scene = replace(scene, bodies=tuple(map(by_absorption, scene.bodies)))
    bodies = [_extent(b.mesh) for b in scene.bodies]
    receivers = [
        _corners(r) if isinstance(r, Receiver) else _extent(r.mesh) for r in scene.receivers
    ]
    around = np.concatenate(bodies or receivers)
    centre = (around.min(axis=0) + around.max(axis=0)) / 2
    reach = float(np.abs(np.concatenate([around, *receivers]) - centre).max() * MM)
    # The checks and the ray-tracing tree take longest; NumPy and Embree let each other compute.
    with ThreadPoolExecutor(1) as aside:
        checked = aside.submit(_require_solids, scene.bodies)
        soup = _soup(scene, centre)
        covered = aside.submit(_cover, scene, soup, centre)
        loaded = Tree(soup.vertices, soup.faces).scene if len(soup.faces) else None
        checked.result()
        cover = covered.result()
    media = media_of(scene.bodies, wavelengths)
    sides = sides_of(scene)
    planes = tuple(
        Plane(number, r, (r.origin - centre) * MM, first_texels(sides, r))
        for number, r in enumerate(r for r in scene.receivers if isinstance(r, Receiver))
    )
    return Stage(
        centre=centre,
        scene=loaded,
        triangles=mi.Float(soup.records.ravel()) if loaded else None,
        owners=mi.Float(_owners(scene, media, sides).ravel()) if loaded else None,
        ior=mi.Float(media.ior.astype(np.float32).ravel()),
        absorption=mi.Float(media.absorption.astype(np.float32)),
        bands=media.ior.shape[1],
        planes=planes,
        reach=reach,
        kinds=frozenset(_kinds(scene)),
        features=frozenset(_features(scene)),
        cover=cover,
    )


def _kinds(scene: Scene) -> Iterator[str]:
    yield from (body.material.kind for body in scene.bodies)
    yield from ("surface" for r in scene.receivers if isinstance(r, Surface))


def _features(scene: Scene) -> Iterator[str]:
    for body in scene.bodies:
        material = body.material
        if material.kind in ("dielectric", "mirror") and material.roughness > 0:
            yield "rough"
        if material.kind == "dielectric" and material.absorption > 0:
            yield "tinted"
    if any(r.reflectance > 0 for r in scene.receivers):
        yield "reflecting"


def _cover(
    scene: Scene, soup: "_Soup", centre: NDArray[np.float64]
) -> tuple[NDArray[np.float64], float]:
    """Balls around the bodies and the receivers that reflect."""
    vertices, faces = [soup.vertices], [soup.faces[: soup.sending]]
    count = len(soup.vertices)
    for receiver in scene.receivers:
        if isinstance(receiver, Receiver) and receiver.reflectance > 0:
            vertices.append(((_corners(receiver) - centre) * MM).astype(np.float32))
            faces.append(np.array([[0, 1, 3], [0, 3, 2]], np.uint32) + np.uint32(count))
            count += 4
    if not sum(map(len, faces)):
        return np.zeros((0, 3)), 0.0
    if len(vertices) == 1:
        middle, radius = aim.cover(vertices[0], faces[0])
    else:
        middle, radius = aim.cover(np.concatenate(vertices), np.concatenate(faces))
    return middle / MM + centre, radius / MM


def _extent(mesh: Mesh) -> NDArray[np.float64]:
    """The box (2, 3) about the vertices that have a face; loose ones may lie anywhere."""
    used = np.zeros(len(mesh.vertices), bool)
    used[mesh.faces] = True
    vertices = mesh.vertices if used.all() else mesh.vertices[used]
    return np.array([vertices.min(axis=0), vertices.max(axis=0)])


def _check(body: Body) -> None:
    if len(body.mesh.faces) == 0:
        raise SceneError(f"“{body.name}” has no faces; delete it or give it a mesh.")
    if not np.isfinite(body.mesh.vertices).all():
        raise SceneError(
            f"“{body.name}” has vertices that are not finite numbers; rebuild its mesh."
        )


def _require_solids(bodies: tuple[Body, ...]) -> None:
    for body in bodies:
        if body.material.kind == "dielectric":
            require_solid(body.name, body.mesh)


@dataclass(frozen=True, slots=True)
class _Soup:
    """All triangles, those of the bodies and of reflecting surfaces first: ``sending`` of them."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    records: NDArray[np.float32]
    sending: int


def _soup(scene: Scene, centre: NDArray[np.float64]) -> _Soup:
    vertices, faces, records, count, sending = [], [], [], 0, 0
    for owner, (name, mesh, texture, sends) in enumerate(_meshes(scene)):
        places = ((mesh.vertices - centre) * MM).astype(np.float32)
        # About a vertex of its own, so that a small face far from the centre keeps its direction.
        own = (mesh.vertices - mesh.vertices[mesh.faces[0, 0]]).astype(np.float32)
        normal, area = _face_normals(own, mesh.faces)
        if texture is not None:
            places = _set_back(places, mesh.faces, normal * area[:, None])
        keep = area > 0
        if not keep.any():
            raise SceneError(f"“{name}” has no face with an area; rebuild its mesh.")
        corners = mesh.normals if texture is None else texture
        faces_kept = mesh.faces
        if not keep.all():
            faces_kept, normal = mesh.faces[keep], normal[keep]
            corners = None if corners is None else corners[keep]
        record = np.zeros((len(normal), RECORD), np.float32)
        if corners is None:
            record[:, :9] = np.tile(normal, 3)
        else:
            record[:, : corners[0].size] = corners.reshape(len(normal), -1)
        record[:, 9:12] = normal
        record[:, 12] = owner
        vertices.append(places)
        faces.append(faces_kept.astype(np.uint32) + np.uint32(count))
        records.append(record)
        count += len(places)
        sending += len(normal) if sends else 0
    if not faces:
        nothing = np.zeros((0, 3), np.float32)
        return _Soup(nothing, nothing.astype(np.uint32), nothing, 0)
    return _Soup(np.concatenate(vertices), np.concatenate(faces), np.concatenate(records), sending)


def _set_back(
    places: NDArray[np.float32], faces: NDArray[np.int32], areas: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Vertices in mm moved a few steps against their normals, the sum of their faces' ``areas``."""
    sums = [np.bincount(faces.ravel(), np.repeat(a, 3), len(places)) for a in areas.T]
    outward = np.stack(sums, axis=1)
    length = np.linalg.norm(outward, axis=1, keepdims=True)
    outward = np.divide(outward, length, out=outward, where=length > 0)
    step = OFFSET_MM + OFFSET_SHARE * np.abs(places).max(axis=1, keepdims=True)
    return (places - BEHIND * step * outward).astype(np.float32)


def _meshes(scene: Scene) -> Iterator[tuple[str, Mesh, NDArray[np.float64] | None, bool]]:
    """Owners in order: name, triangles, a surface's texture, and whether it sends light on."""
    for body in scene.bodies:
        yield body.name, body.mesh.triangles(), None, True
    for surface in _surfaces(scene):
        yield surface.name, surface.mesh, surface.texture, surface.reflectance > 0


def _surfaces(scene: Scene) -> list[Surface]:
    """The receivers that are meshes, those that reflect first."""
    surfaces = [r for r in scene.receivers if isinstance(r, Surface)]
    return sorted(surfaces, key=lambda s: s.reflectance == 0)


def _owners(scene: Scene, media: Media, sides: tuple[Side, ...]) -> NDArray[np.float32]:
    rows = np.zeros((len(scene.bodies) + len(_surfaces(scene)), OWNER), np.float32)
    for row, body, rank in zip(rows, scene.bodies, media.rank, strict=False):
        material = body.material
        row[:5] = (
            KINDS.index(material.kind),
            rank,
            material.reflectance,
            material.specularity,
            material.roughness,
        )
    for row, surface in zip(rows[len(scene.bodies) :], _surfaces(scene), strict=True):
        row[:3] = KINDS.index("surface"), 0, surface.reflectance
        whole = (surface.columns, surface.rows, *first_texels(sides, surface))
        row[3:7] = np.array(whole, np.uint32).view(np.float32)
    return rows


def _face_normals(
    vertices: NDArray[np.float32], faces: NDArray[np.int32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Unit normals (T, 3) of triangles and twice their areas (T,)."""
    rows = np.ascontiguousarray(vertices.T)
    a, b, c = (rows[:, corner] for corner in faces.T)
    u, v = b - a, c - a
    normal = np.empty((len(faces), 3), np.float32)
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        normal[:, i] = u[j] * v[k] - u[k] * v[j]
    area = np.sqrt(np.einsum("ij,ij->i", normal, normal))
    normal /= np.maximum(area, np.finfo(np.float32).tiny)[:, None]
    return normal, area


def _corners(receiver: Receiver) -> NDArray[np.float64]:
    o, u, v = receiver.origin, receiver.u, receiver.v
    return np.array([o, o + u, o + v, o + u + v], dtype=np.float64)
