"""pymeshlab, loaded when it is needed, and what of it this system lacks."""

import ctypes.util
import sys
from typing import Any

from numpy.typing import NDArray

from .scene import Vector

HOLES = "meshing_close_holes"
"""The filter that closes holes; it is in a part of MeshLab that needs OpenGL to load."""


def mesh_set(vertices: Vector, faces: NDArray[Any] | None = None) -> Any:
    """A pymeshlab.MeshSet with one mesh of ``vertices`` (V, 3) and triangles (F, 3), or points.

    Takes half a second the first time. Where Blender's bpy is used, it must be imported before.
    """
    import pymeshlab

    work = pymeshlab.MeshSet()  # pyright: ignore[reportAttributeAccessIssue]
    given = (vertices,) if faces is None else (vertices, faces)
    work.add_mesh(pymeshlab.Mesh(*given))  # pyright: ignore[reportAttributeAccessIssue]
    return work


def closes_holes(work: Any) -> bool:
    """Whether MeshLab's filter that closes holes could be loaded here."""
    return hasattr(work, HOLES)


def lacking() -> str:
    """What of MeshLab cannot be loaded on this system, and the remedy, in a sentence; or ""."""
    if sys.platform != "linux" or ctypes.util.find_library("OpenGL"):
        return ""
    return (
        "MeshLab closes no holes here, since this system has no libOpenGL.so.0; install libopengl0 "
        "(Debian, Ubuntu) or libglvnd-opengl (Fedora)."
    )
