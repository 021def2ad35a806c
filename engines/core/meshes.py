"""Meshes from and to files: PLY, OBJ, STL and the like through trimesh, NPZ for exact copies."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .errors import FileError, ParameterError
from .files import written
from .scene import Mesh, Vector

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}


@dataclass(frozen=True, slots=True)
class Textured:
    """A mesh with the texture coordinates of its face corners.

    ``texture`` (F, 3, 2) or (F, 4, 2) float64, as many corners as the faces have; None without.
    """

    mesh: Mesh
    texture: Vector | None = None

    def triangles(self) -> "Textured":
        """The same in triangles, split as the mesh is."""
        texture = self.texture
        if texture is not None and texture.shape[1] == 4:
            texture = texture[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 2)
        return Textured(self.mesh.triangles(), texture)

    def moved(self, matrix: NDArray[np.float64]) -> "Textured":
        """The same under a 4×4 affine ``matrix``; each corner keeps its place in the picture."""
        texture = self.texture
        if texture is not None and np.linalg.det(matrix[:3, :3]) < 0:
            texture = np.ascontiguousarray(texture[:, ::-1])
        return Textured(self.mesh.moved(matrix), texture)


def load_mesh(path: Path, unit: str = "m") -> Mesh:
    """The mesh in a file whose lengths are in ``unit``.

    Raises FileError for a missing or damaged file, ParameterError for an unknown unit.
    """
    return load_textured(path, unit).mesh


def load_textured(path: Path, unit: str = "m") -> Textured:
    """As `load_mesh`, with the UV map where the file has one."""
    if unit not in UNITS:
        raise ParameterError(f"“{unit}” is no unit of a mesh; take one of {', '.join(UNITS)}.")
    if not path.is_file():
        raise FileError(f"There is no mesh “{path}”; check its name and folder.")
    try:
        found = _load_npz(path) if path.suffix == ".npz" else _load_other(path)
    except Exception as failed:
        raise FileError(f"The mesh “{path}” cannot be read: {failed}.") from failed
    mesh = found.mesh
    return Textured(Mesh(mesh.vertices * UNITS[unit], mesh.faces, mesh.normals), found.texture)


def _load_npz(path: Path) -> Textured:
    with np.load(path, allow_pickle=False) as arrays:
        mesh = Mesh(arrays["vertices"], arrays["faces"], arrays.get("normals"))
        texture = arrays.get("texture")
    if mesh.faces.ndim != 2 or mesh.faces.shape[1] not in (3, 4) or mesh.vertices.shape[1:] != (3,):
        raise ValueError("its arrays are not those of a mesh")
    if mesh.faces.size and not 0 <= mesh.faces.min() <= mesh.faces.max() < len(mesh.vertices):
        raise ValueError("a face names a vertex that is not there")
    if texture is not None and texture.shape != (*mesh.faces.shape, 2):
        raise ValueError("its texture has not two coordinates for each corner of its faces")
    return Textured(mesh, None if texture is None else texture.astype(np.float64))


def _load_other(path: Path) -> Textured:
    import trimesh

    loaded = trimesh.load_mesh(path, process=False)
    faces = np.asarray(loaded.faces, dtype=np.int32)
    # STL repeats the face's normal; only a file that lists vertex normals means smooth ones.
    smooth = "vertex_normals" in loaded._cache.cache and path.suffix.lower() != ".stl"
    normals = np.asarray(loaded.vertex_normals, np.float32)[faces] if smooth else None
    mesh = Mesh(np.asarray(loaded.vertices, np.float64), faces, normals)
    uv = getattr(loaded.visual, "uv", None)
    full = uv is not None and len(uv) == len(mesh.vertices)
    return Textured(mesh, np.asarray(uv, np.float64)[faces] if full else None)


def save_mesh(path: Path, mesh: Mesh, texture: Vector | None = None) -> None:
    """Write a mesh, with texture coordinates where it has them, as NPZ, read back equal.

    Raises FileError where it cannot.
    """
    arrays = {"vertices": mesh.vertices, "faces": mesh.faces}
    if mesh.normals is not None:
        arrays["normals"] = mesh.normals
    if texture is not None:
        arrays["texture"] = texture
    with written(path) as draft, draft.open("wb") as stream:
        np.savez(stream, allow_pickle=False, **arrays)
