"""Bodies as Mitsuba sees them: the triangles of several as one mesh that rays can be sent into.

Sensors' rays start where they are told to, without Mitsuba's own offset, so metres will do; but
Mitsuba traces in single precision, hence all is moved about a common centre first.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Body, Vector
from ..core.solid import Report, inspect
from ..core.tree import Tree

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
        self._tree: Tree | None = None
        self._orientation: Vector | None = None
        self._reports: dict[int, Report] = {}
        self.put(bodies)

    def put(self, bodies: tuple[Body, ...]) -> None:
        """Put other bodies in place of these; with the same faces, only their tree is made anew."""
        vertices, faces, owner = _triangles(bodies, self.centre)
        same = np.array_equal(faces, self.faces) and len(vertices) == len(self.vertices)
        self.bodies, self.vertices, self.faces, self.owner = bodies, vertices, faces, owner
        self.reach = float(np.abs(vertices).max(initial=0.0))
        self._orientation, self._reports = None, {}
        if not len(faces):
            self._tree = None
        elif same and self._tree is not None:
            self._tree.move(vertices)
        else:
            self._tree = Tree(vertices, faces)

    @property
    def scene(self) -> Any:
        """What rays are sent into, None where there is no triangle."""
        return self._tree.scene if self._tree else None

    def normals(self, triangles: NDArray[np.integer[Any]] | slice = slice(None)) -> Vector:
        """Unit normals (…, 3) of these triangles, 0 where there is no area."""
        a, b, c = (
            self.vertices[self.faces[triangles, corner]].astype(np.float64) for corner in range(3)
        )
        cross = np.cross(b - a, c - a)
        length = np.linalg.norm(cross, axis=-1, keepdims=True)
        return np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)

    def steps(self) -> NDArray[np.float32]:
        """How far in m (T,) a ray that goes on from each triangle must start off it."""
        farthest = np.abs(self.vertices).max(axis=1, initial=0.0)
        return 2 * np.float32(CLOSE) * farthest[self.faces].max(axis=1, initial=0.0)

    def step_near(self, low: Vector, high: Vector, least: float) -> float:
        """The longest of the ``steps`` off triangles whose boxes meet that between two corners (3,)
        about the centre, and no less than ``least``."""
        if 2 * CLOSE * self.reach <= least:
            return least
        corners = self.vertices[self.faces]
        meets = (corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)
        return float(self.steps()[meets.all(axis=1)].max(initial=least))

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
        return self._report(body).open_edges == 0

    def solid(self, body: int) -> bool:
        """Whether they do, and all look outward or all inward."""
        return self.closed(body) and self._report(body).twisted_edges == 0

    def _report(self, body: int) -> Report:
        if body not in self._reports:
            self._reports[body] = inspect(self.bodies[body].mesh)
        return self._reports[body]


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
