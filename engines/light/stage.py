"""The scene as Mitsuba and the photon loop see it: one triangle soup in millimetres.

Mitsuba offsets rays by an amount that grows with the coordinates; in a metre-scaled scene it would
skip thin printed walls. Therefore all bodies are brought to millimetres about their common centre.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.errors import SceneError
from ..core.scene import Body, Mesh, Receiver, Scene
from ..core.solid import require_solid
from . import aim

MM = 1000.0
KINDS = ("dielectric", "mirror", "diffuse", "plastic", "absorber")
RECORD = 16
"""Floats a triangle: 9 corner normals, 3 face normal, kind, ior, reflectance, specularity."""


@dataclass(frozen=True, slots=True)
class Stage:
    """``centre`` (3,) m is the origin of stage space; ``scene`` is None without bodies.

    ``triangles`` holds RECORD floats for each triangle, ``reach`` is the largest coordinate in mm,
    ``kinds`` which of KINDS occur, ``cover`` balls in m that contain all bodies (see `aim.cover`).
    """

    centre: NDArray[np.float64]
    scene: Any
    triangles: Any
    reach: float
    kinds: frozenset[str]
    cover: tuple[NDArray[np.float64], float]

    def place(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """World points (…, 3) in m to stage space in mm."""
        return (points - self.centre) * MM


def build(scene: Scene) -> Stage:
    """The stage for a scene's bodies.

    Raises SceneError for an open or inside-out dielectric and for a body without faces.
    """
    mi = runtime.mitsuba()
    for body in scene.bodies:
        _check(body)
    bodies = [_extent(b.mesh) for b in scene.bodies]
    receivers = [_corners(r) for r in scene.receivers]
    around = np.concatenate(bodies or receivers)
    centre = (around.min(axis=0) + around.max(axis=0)) / 2
    reach = float(np.abs(np.concatenate([around, *receivers]) - centre).max() * MM)
    if not scene.bodies:
        return Stage(centre, None, None, reach, frozenset(), (np.zeros((0, 3)), 0.0))
    # The checks and the ray-tracing tree take longest; NumPy and Embree let each other compute.
    with ThreadPoolExecutor(1) as aside:
        checked = aside.submit(_require_solids, scene.bodies)
        vertices, faces, records = _soup(scene.bodies, centre)
        covered = aside.submit(aim.cover, vertices, faces)
        loaded = _tree(vertices, faces)
        checked.result()
        middle, radius = covered.result()
    kinds = frozenset(body.material.kind for body in scene.bodies)
    balls = middle / MM + centre, radius / MM
    return Stage(centre, loaded, mi.Float(records.ravel()), reach, kinds, balls)


def _tree(vertices: NDArray[np.float32], faces: NDArray[np.uint32]) -> Any:
    """The soup as a Mitsuba scene that rays can be sent into.

    As an instance of a group: Mitsuba has a group's tree built in Embree's medium quality, a plain
    mesh's in high, which takes four times as long and traces no faster here.
    """
    mi = runtime.mitsuba()
    mesh = mi.Mesh("bodies", len(vertices), len(faces))
    handle = mi.traverse(mesh)
    handle["vertex_positions"] = vertices.ravel()
    handle["faces"] = faces.ravel()
    handle.update()
    group = {"type": "shapegroup", "bodies": mesh}
    instance = {"type": "instance", "group": {"type": "ref", "id": "group"}}
    return mi.load_dict({"type": "scene", "group": group, "instance": instance})


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


def _soup(
    bodies: tuple[Body, ...], centre: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.uint32], NDArray[np.float32]]:
    vertices, faces, records, count = [], [], [], 0
    for body in bodies:
        mesh = body.mesh.triangles()
        places = ((mesh.vertices - centre) * MM).astype(np.float32)
        # About a vertex of its own, so that a small face far from the centre keeps its direction.
        own = (mesh.vertices - mesh.vertices[mesh.faces[0, 0]]).astype(np.float32)
        normal, area = _face_normals(own, mesh.faces)
        keep = area > 0
        if not keep.any():
            raise SceneError(f"“{body.name}” has no face with an area; rebuild its mesh.")
        normals = mesh.normals
        if not keep.all():
            mesh = Mesh(mesh.vertices, mesh.faces[keep], None)
            normal, normals = normal[keep], None if normals is None else normals[keep]
        material = body.material
        record = np.empty((len(normal), RECORD), np.float32)
        record[:, :9] = np.tile(normal, 3) if normals is None else normals.reshape(-1, 9)
        record[:, 9:12] = normal
        record[:, 12:] = (
            KINDS.index(material.kind),
            material.ior,
            material.reflectance,
            material.specularity,
        )
        vertices.append(places)
        faces.append(mesh.faces.astype(np.uint32) + np.uint32(count))
        records.append(record)
        count += len(places)
    return np.concatenate(vertices), np.concatenate(faces), np.concatenate(records)


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
