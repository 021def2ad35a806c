"""Blender's curves as polylines for the engines."""

import bpy
import numpy as np

from ...engines.core.errors import SceneError
from ...engines.core.scene import Vector
from .meshes import edges_from_blender

_STEPS = 64
"""Points between two control points: a Bézier curve of a wall is then true to micrometres."""


def closed_loops(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[Vector]:
    """The closed loops of a curve, or of a mesh of edges alone, (M, 3) in world coordinates.

    Raises SceneError, naming the object, where a loop is open, edges fork or there is none.
    """
    points, edges = _polyline(obj, depsgraph)
    if not len(edges):
        raise SceneError(f"“{obj.name}” has no curve in it; draw a closed one, or choose another.")
    degree = np.bincount(edges.ravel(), minlength=len(points))
    if (degree == 1).any():
        place = _said(points[np.argmax(degree == 1)])
        raise SceneError(
            f"“{obj.name}” is open at {place}; close it with Toggle Cyclic (Alt C) in Edit Mode."
        )
    if (degree > 2).any():
        place = _said(points[np.argmax(degree > 2)])
        raise SceneError(f"“{obj.name}” forks at {place}; leave one closed line there.")
    return [points[loop] for loop in _loops(edges)]


def _polyline(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> tuple[Vector, np.ndarray]:
    """Points (N, 3) in the world and edges (E, 2)."""
    if obj.type == "CURVE" and not obj.modifiers:
        points, edges = _finely(obj)
    else:
        evaluated = obj.evaluated_get(depsgraph)
        points, edges = edges_from_blender(evaluated.to_mesh())
        evaluated.to_mesh_clear()
    matrix = np.array(obj.evaluated_get(depsgraph).matrix_world, dtype=np.float64)
    return points @ matrix[:3, :3].T + matrix[:3, 3], edges


def _finely(obj: bpy.types.Object) -> tuple[Vector, np.ndarray]:
    """A curve object's bare line, finer than it is shown."""
    data = obj.data.copy()
    data.dimensions = "3D"
    data.bevel_depth = data.extrude = data.offset = 0.0
    data.bevel_object = data.taper_object = None
    for spline in data.splines:
        spline.resolution_u = max(spline.resolution_u, _STEPS)
    bare = bpy.data.objects.new("", data)
    try:
        return edges_from_blender(bare.to_mesh())
    finally:
        bare.to_mesh_clear()
        bpy.data.objects.remove(bare)
        bpy.data.curves.remove(data)


def _loops(edges: np.ndarray) -> list[np.ndarray]:
    """The vertices of each closed loop in their order, given that every vertex has two edges."""
    beside: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    loops = []
    while beside:
        loop = [next(iter(beside))]
        while following := beside.pop(loop[-1], None):
            loop.append(next((v for v in following if v in beside), loop[0]))
        loops.append(np.array(loop[:-1]))
    return loops


def _said(place: Vector) -> str:
    return f"({', '.join(f'{c:.3g}' for c in place)})"
