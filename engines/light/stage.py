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
    corners = [_used(b.mesh) for b in scene.bodies] or [_corners(r) for r in scene.receivers]
    low, high = (f(np.concatenate(corners), axis=0) for f in (np.min, np.max))
    centre = (low + high) / 2
    receivers = [_corners(r) for r in scene.receivers]
    reach = float(np.abs(np.concatenate(corners + receivers) - centre).max() * MM)
    if not scene.bodies:
        return Stage(centre, None, None, reach, frozenset(), (np.zeros((0, 3)), 0.0))
    vertices, faces, records = _soup(scene.bodies, centre)
    mesh = mi.Mesh("bodies", len(vertices), len(faces))
    handle = mi.traverse(mesh)
    handle["vertex_positions"] = vertices.astype(np.float32).ravel()
    handle["faces"] = faces.ravel()
    handle.update()
    kinds = frozenset(body.material.kind for body in scene.bodies)
    # The ray-tracing tree takes longest and lets others compute meanwhile.
    with ThreadPoolExecutor(1) as aside:
        checked = aside.submit(_require_solids, scene.bodies)
        covered = aside.submit(aim.cover, vertices, faces)
        loaded = mi.load_dict({"type": "scene", "bodies": mesh})
        checked.result()
        middle, radius = covered.result()
    balls = middle / MM + centre, radius / MM
    return Stage(centre, loaded, mi.Float(records.ravel()), reach, kinds, balls)


def _used(mesh: Mesh) -> NDArray[np.float64]:
    """The vertices that have a face; loose ones may lie anywhere."""
    used = np.zeros(len(mesh.vertices), bool)
    used[mesh.faces] = True
    return mesh.vertices[used]


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
) -> tuple[NDArray[np.float64], NDArray[np.uint32], NDArray[np.float32]]:
    vertices, faces, records, count = [], [], [], 0
    for body in bodies:
        mesh = body.mesh.triangles()
        corners = mesh.vertices[mesh.faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(normal, axis=1)
        keep = area > 0
        if not keep.any():
            raise SceneError(f"“{body.name}” has no face with an area; rebuild its mesh.")
        normal = normal[keep] / area[keep, None]
        record = np.empty((len(normal), RECORD), np.float32)
        smooth = mesh.normals[keep] if mesh.normals is not None else normal[:, None].repeat(3, 1)
        record[:, :9] = smooth.reshape(-1, 9)
        record[:, 9:12] = normal
        material = body.material
        record[:, 12:] = (
            KINDS.index(material.kind),
            material.ior,
            material.reflectance,
            material.specularity,
        )
        vertices.append((mesh.vertices - centre) * MM)
        faces.append(mesh.faces[keep].astype(np.uint32) + np.uint32(count))
        records.append(record)
        count += len(mesh.vertices)
    return np.concatenate(vertices), np.concatenate(faces), np.concatenate(records)


def _corners(receiver: Receiver) -> NDArray[np.float64]:
    o, u, v = receiver.origin, receiver.u, receiver.v
    return np.array([o, o + u, o + v, o + u + v], dtype=np.float64)
