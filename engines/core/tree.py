"""Triangles as Mitsuba traces rays into them."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import runtime

_POSITIONS = "group.bodies.vertex_positions"


class Tree:
    """A ray-tracing tree of triangles: ``vertices`` (V, 3) float32 and ``faces`` (T, 3) uint32.

    ``scene`` is the Mitsuba scene that rays are sent into. The mesh is an instance of a group:
    Mitsuba has a group's tree built in Embree's medium quality, a plain mesh's in high, which takes
    four to ten times as long and traces no faster here. Raises RuntimeMissing.
    """

    def __init__(self, vertices: NDArray[np.float32], faces: NDArray[np.uint32]) -> None:
        mi = runtime.mitsuba()
        mesh = mi.Mesh("bodies", len(vertices), len(faces))
        given = mi.traverse(mesh)
        given["vertex_positions"] = vertices.ravel()
        given["faces"] = faces.ravel()
        given.update()
        group = {"type": "shapegroup", "bodies": mesh}
        instance = {"type": "instance", "group": {"type": "ref", "id": "group"}}
        self.scene: Any = mi.load_dict({"type": "scene", "group": group, "instance": instance})
        self._held: Any = None

    def move(self, vertices: NDArray[np.float32]) -> None:
        """Put the vertices (V, 3), as many as there are, elsewhere; the tree is made anew."""
        if self._held is None:
            self._held = runtime.mitsuba().traverse(self.scene)
        self._held[_POSITIONS] = vertices.ravel()
        self._held.update()
