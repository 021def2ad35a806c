"""One mesh at many places, and many meshes as one."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .scene import Mesh

_FLAT = 1e-12
"""The least volume of a copy, of its longest axis cubed: a flatter one has no inside."""


def copied(mesh: Mesh, matrices: NDArray[np.float64]) -> Mesh:
    """All copies of ``mesh`` under the 4×4 affine ``matrices`` (K, 4, 4) as one mesh.

    A mirroring matrix turns the faces of its copy about, so that they look outward as before. One
    that flattens leaves no copy, for flattened normals say nothing.
    """
    linear, shift = matrices[:, :3, :3], matrices[:, :3, 3]
    volume = np.linalg.det(linear)
    longest = np.linalg.norm(linear, axis=1).max(axis=1, initial=0.0)
    kept = np.abs(volume) > _FLAT * longest**3
    linear, shift, mirrored = linear[kept], shift[kept], volume[kept] < 0
    count, points = len(linear), len(mesh.vertices)
    vertices = np.einsum("pj,kij->kpi", mesh.vertices, linear) + shift[:, None]
    faces = mesh.faces[None] + (np.arange(count, dtype=np.int32) * points)[:, None, None]
    faces[mirrored] = faces[mirrored][:, :, ::-1]
    normals = None
    if mesh.normals is not None:
        turned = np.einsum("fcj,kji->kfci", mesh.normals, np.linalg.inv(linear))
        turned /= np.linalg.norm(turned, axis=-1, keepdims=True)
        turned[mirrored] = turned[mirrored][:, :, ::-1]
        normals = turned.reshape(-1, *mesh.normals.shape[1:]).astype(np.float32)
    sides = mesh.faces.shape[1]
    return Mesh(vertices.reshape(-1, 3), faces.reshape(-1, sides).astype(np.int32), normals)


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """At least one mesh as one: of quadrilaterals where all are, of triangles otherwise.

    Where some have normals, flat ones are made for the others.
    """
    if len(meshes) == 1:
        return meshes[0]
    if len({mesh.faces.shape[1] for mesh in meshes}) > 1:
        meshes = [mesh.triangles() for mesh in meshes]
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]
    normals = None
    if any(mesh.normals is not None for mesh in meshes):
        normals = np.concatenate([_normals(mesh) for mesh in meshes])
    vertices = np.concatenate([mesh.vertices for mesh in meshes])
    return Mesh(vertices, np.concatenate(faces).astype(np.int32), normals)


def _normals(mesh: Mesh) -> NDArray[np.float32]:
    """Its normals, or those of its flat faces at each corner; zero without an area."""
    if mesh.normals is not None:
        return mesh.normals
    corners = mesh.vertices[mesh.faces]
    across = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    if mesh.faces.shape[1] == 3:
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    flat = np.divide(across, length, out=np.zeros_like(across), where=length > 0)
    return np.repeat(flat[:, None], mesh.faces.shape[1], axis=1).astype(np.float32)
