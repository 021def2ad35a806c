"""Bodies as Mitsuba sees them: the triangles of several as one mesh that rays can be sent into.

Sensors' rays start where they are told to, without Mitsuba's own offset, so metres will do; but
Mitsuba traces in single precision, hence all is moved about a common centre first.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.scene import Body, Vector
from ..core.solid import inspect

CLOSE = 1e-6
"""Of the largest coordinate: what single precision can tell apart, with room for rounding."""


class Soup:
    """The triangles of some bodies about ``centre`` (3,) m, and the tree that rays meet them by.

    ``owner`` (T,) int32 is each triangle's place among ``bodies``, ``reach`` the largest coordinate
    in m.
    """

    def __init__(self, bodies: tuple[Body, ...], centre: Vector) -> None:
        self.centre = centre
        self.bodies: tuple[Body, ...] = ()
        self.vertices = np.zeros((0, 3), np.float32)
        self.faces = np.zeros((0, 3), np.uint32)
        self.owner = np.zeros(0, np.int32)
        self.reach = 0.0
        self.scene: Any = None
        self._handle: Any = None
        self._orientation: Vector | None = None
        self._closed: dict[int, bool] = {}
        self.put(bodies)

    def put(self, bodies: tuple[Body, ...]) -> None:
        """Put other bodies in place of these; with the same faces, only their tree is made anew."""
        vertices, faces, owner = _triangles(bodies, self.centre)
        same = np.array_equal(faces, self.faces) and len(vertices) == len(self.vertices)
        self.bodies, self.vertices, self.faces, self.owner = bodies, vertices, faces, owner
        self.reach = float(np.abs(vertices).max(initial=0.0))
        self._orientation, self._closed = None, {}
        if not len(faces):
            self.scene = self._handle = None
        elif same and self._handle is not None:
            self._handle["group.bodies.vertex_positions"] = vertices.ravel()
            self._handle.update()
        else:
            self.scene, self._handle = _tree(vertices, faces)

    def normals(self, triangles: NDArray[np.integer[Any]] | slice = slice(None)) -> Vector:
        """Unit normals (…, 3) of these triangles, 0 where there is no area."""
        a, b, c = (
            self.vertices[self.faces[triangles, corner]].astype(np.float64) for corner in range(3)
        )
        cross = np.cross(b - a, c - a)
        length = np.linalg.norm(cross, axis=-1, keepdims=True)
        return np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)

    @property
    def orientation(self) -> Vector:
        """1 for each body whose faces look outward, −1 where they look inward, by its volume."""
        if self._orientation is None:
            a, b, c = (self.vertices[self.faces[:, i]].astype(np.float64) for i in range(3))
            parts = np.einsum("ij,ij->i", a, np.cross(b, c))
            volumes = np.bincount(self.owner, parts, minlength=len(self.bodies))
            self._orientation = np.where(volumes < 0, -1.0, 1.0)
        return self._orientation

    def closed(self, body: int) -> bool:
        """Whether that body's faces enclose something."""
        if body not in self._closed:
            self._closed[body] = inspect(self.bodies[body].mesh).open_edges == 0
        return self._closed[body]


def _triangles(
    bodies: tuple[Body, ...], centre: Vector
) -> tuple[NDArray[np.float32], NDArray[np.uint32], NDArray[np.int32]]:
    vertices = [np.zeros((0, 3), np.float32)]
    faces = [np.zeros((0, 3), np.uint32)]
    owner, count = [], 0
    for body in bodies:
        mesh = body.mesh
        triangles = mesh.triangles().faces
        vertices.append((mesh.vertices - centre).astype(np.float32))
        faces.append(triangles.astype(np.uint32) + np.uint32(count))
        owner.append(len(triangles))
        count += len(mesh.vertices)
    return (
        np.concatenate(vertices),
        np.concatenate(faces),
        np.repeat(np.arange(len(bodies), dtype=np.int32), owner),
    )


def _tree(vertices: NDArray[np.float32], faces: NDArray[np.uint32]) -> tuple[Any, Any]:
    """The scene and the handle by which its vertices can be moved.

    As an instance of a group: Mitsuba has a group's tree built in Embree's medium quality, a plain
    mesh's in high, which takes ten times as long and traces no faster here.
    """
    mi = runtime.mitsuba()
    mesh = mi.Mesh("bodies", len(vertices), len(faces))
    handle = mi.traverse(mesh)
    handle["vertex_positions"] = vertices.ravel()
    handle["faces"] = faces.ravel()
    handle.update()
    group = {"type": "shapegroup", "bodies": mesh}
    instance = {"type": "instance", "group": {"type": "ref", "id": "group"}}
    scene = mi.load_dict({"type": "scene", "group": group, "instance": instance})
    return scene, mi.traverse(scene)
