"""Solids as STL, 3MF and OBJ: read back by trimesh and as plain XML, in millimetres."""

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from heliform.engines.core.errors import FileError, SceneError
from heliform.engines.core.meshes import load_mesh
from heliform.engines.core.scene import Mesh
from heliform.engines.glass.export import FORMATS, export_solid
from heliform.engines.glass.loft import Wall
from heliform.engines.glass.printed import wall_mesh

MESH = wall_mesh(Wall(height=0.03, faces=8_000))
SIZE = np.ptp(MESH.vertices, axis=0)
VOLUME = trimesh.Trimesh(MESH.vertices, MESH.triangles().faces).volume


@pytest.mark.parametrize("ending", [*FORMATS, ".STL"])
def test_it_reads_back_as_the_same_solid_in_millimetres(tmp_path, ending):
    file = tmp_path / f"ä wall{ending}"
    export_solid(file, MESH)
    back = trimesh.load_mesh(file)
    assert np.ptp(back.vertices, axis=0) == pytest.approx(SIZE * 1e3, rel=1e-6)
    assert back.volume == pytest.approx(VOLUME * 1e9, rel=1e-5)
    assert back.is_watertight
    assert back.is_winding_consistent
    assert len(back.faces) == len(MESH.triangles().faces)
    ours = load_mesh(file, "mm")
    assert np.ptp(ours.vertices, axis=0) == pytest.approx(SIZE, rel=1e-6)


def test_stl_is_binary_and_3mf_says_millimetres(tmp_path):
    export_solid(tmp_path / "wall.stl", MESH)
    faces = len(MESH.triangles().faces)
    assert (tmp_path / "wall.stl").stat().st_size == 84 + 50 * faces
    export_solid(tmp_path / "wall.3mf", MESH)
    with zipfile.ZipFile(tmp_path / "wall.3mf") as archive:
        model = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    assert model.attrib["unit"] == "millimeter"


def test_an_open_mesh_is_named_and_nothing_is_written(tmp_path):
    opened = Mesh(MESH.vertices, MESH.faces[5:])
    with pytest.raises(SceneError, match="“Vase ä/1” is open"):
        export_solid(tmp_path / "wall.stl", opened, "Vase ä/1")
    assert not list(tmp_path.iterdir())


def test_another_ending_or_a_folder_that_is_not_there_is_told(tmp_path):
    with pytest.raises(FileError, match=r"should be one of \.stl"):
        export_solid(tmp_path / "wall.step", MESH)
    with pytest.raises(FileError, match="Cannot write"):
        export_solid(tmp_path / "none" / "wall.stl", MESH)
