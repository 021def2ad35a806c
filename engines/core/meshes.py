"""Meshes from and to files: PLY, OBJ, STL and the like through trimesh, NPZ for exact copies."""

from pathlib import Path

import numpy as np

from .errors import FileError, ParameterError
from .files import written
from .scene import Mesh

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}


def load_mesh(path: Path, unit: str = "m") -> Mesh:
    """The mesh in a file whose lengths are in ``unit``.

    Raises FileError for a missing or damaged file, ParameterError for an unknown unit.
    """
    if unit not in UNITS:
        raise ParameterError(f"“{unit}” is no unit of a mesh; take one of {', '.join(UNITS)}.")
    if not path.is_file():
        raise FileError(f"There is no mesh “{path}”; check its name and folder.")
    try:
        mesh = _load_npz(path) if path.suffix == ".npz" else _load_other(path)
    except Exception as failed:
        raise FileError(f"The mesh “{path}” cannot be read: {failed}.") from failed
    return Mesh(mesh.vertices * UNITS[unit], mesh.faces, mesh.normals)


def _load_npz(path: Path) -> Mesh:
    with np.load(path, allow_pickle=False) as arrays:
        mesh = Mesh(arrays["vertices"], arrays["faces"], arrays.get("normals"))
    if mesh.faces.ndim != 2 or mesh.faces.shape[1] not in (3, 4) or mesh.vertices.shape[1:] != (3,):
        raise ValueError("its arrays are not those of a mesh")
    if mesh.faces.size and not 0 <= mesh.faces.min() <= mesh.faces.max() < len(mesh.vertices):
        raise ValueError("a face names a vertex that is not there")
    return mesh


def _load_other(path: Path) -> Mesh:
    import trimesh

    loaded = trimesh.load_mesh(path, process=False)
    faces = np.asarray(loaded.faces, dtype=np.int32)
    # STL repeats the face's normal; only a file that lists vertex normals means smooth ones.
    smooth = "vertex_normals" in loaded._cache.cache and path.suffix.lower() != ".stl"
    normals = np.asarray(loaded.vertex_normals, np.float32)[faces] if smooth else None
    return Mesh(np.asarray(loaded.vertices, np.float64), faces, normals)


def save_mesh(path: Path, mesh: Mesh) -> None:
    """Write ``mesh`` as NPZ, read back equal by `load_mesh`. Raises FileError where it cannot."""
    arrays = {"vertices": mesh.vertices, "faces": mesh.faces}
    if mesh.normals is not None:
        arrays["normals"] = mesh.normals
    with written(path) as draft, draft.open("wb") as stream:
        np.savez(stream, allow_pickle=False, **arrays)
