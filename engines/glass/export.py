"""Solids to files that slicers and other programs read, in millimetres."""

from pathlib import Path
from typing import cast

from ..core.errors import FileError
from ..core.files import written
from ..core.scene import Mesh
from ..core.solid import require_solid

FORMATS = (".stl", ".3mf", ".obj")


def export_solid(file: Path | str, mesh: Mesh, name: str = "wall") -> None:
    """Write a solid as binary STL, 3MF or OBJ, as the file's ending says, in millimetres.

    3MF says the unit; STL and OBJ cannot, and their readers take millimetres. Quadrilaterals are
    split along their first diagonal.

    Raises SceneError, naming the solid, unless the mesh is one, and FileError for another ending
    or where the file cannot be written.
    """
    file = Path(file)
    ending = file.suffix.lower()
    if ending not in FORMATS:
        raise FileError(
            f"“{file.name}” cannot be written: its ending should be one of {', '.join(FORMATS)}."
        )
    require_solid(name, mesh)
    import trimesh  # slow to load

    solid = trimesh.Trimesh(mesh.vertices * 1e3, mesh.triangles().faces, process=False)
    solid.units = "millimeter"
    if ending == ".obj":
        content = solid.export(file_type="obj", include_normals=False, digits=6)
    else:
        content = solid.export(file_type=ending[1:])
    data = content.encode("utf-8") if isinstance(content, str) else bytes(cast(bytes, content))
    with written(file) as temporary:
        temporary.write_bytes(data)
