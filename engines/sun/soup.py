"""Bodies as Mitsuba sees them: the triangles of several as one mesh that rays can be sent into.

Sensors' rays start where they are told to, without Mitsuba's own offset, so metres will do; but
Mitsuba traces in single precision, hence all is moved about a common centre first.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.errors import SceneError
from ..core.scene import Body, Vector

CLOSE = 1e-6
"""Of the largest coordinate: what single precision can tell apart, with room for rounding."""


class Soup:
    """The triangles of some bodies about ``centre`` (3,) m, and the tree that rays meet them by.

    ``owner`` (T,) int32 is each triangle's place among ``bodies``, ``reach`` the largest coordinate
    in m. Raises SceneError for a body without faces or with vertices that are not finite.
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
        self.put(bodies)

    def put(self, bodies: tuple[Body, ...]) -> None:
        """Put other bodies in place of these; where the faces stay, only their tree is made anew."""
        vertices, faces, owner = _triangles(bodies, self.centre)
        same = np.array_equal(faces, self.faces) and len(vertices) == len(self.vertices)
        self.bodies, self.vertices, self.faces, self.owner = bodies, vertices, faces, owner
        self.reach = float(np.abs(vertices).max(initial=0.0))
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


def _triangles(
    bodies: tuple[Body, ...], centre: Vector
) -> tuple[NDArray[np.float32], NDArray[np.uint32], NDArray[np.int32]]:
    vertices, faces, owner, count = [np.zeros((0, 3), np.float32)], [np.zeros((0, 3))], [], 0
    for body in bodies:
        mesh = body.mesh
        if not len(mesh.faces):
            raise SceneError(f"“{body.name}” has no faces; delete it or give it a mesh.")
        places = mesh.vertices - centre
        # A sum is finite only where all of them are, and needs no array of its own.
        if not np.isfinite(places.sum()):
            raise SceneError(
                f"“{body.name}” has vertices that are not finite numbers; rebuild its mesh."
            )
        triangles = mesh.triangles().faces
        vertices.append(places.astype(np.float32))
        faces.append(triangles + count)
        owner.append(len(triangles))
        count += len(places)
    return (
        np.concatenate(vertices),
        np.concatenate(faces).astype(np.uint32),
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
