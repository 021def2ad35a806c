"""Solids: what is found wrong with a mesh, and what repair makes of it."""

import numpy as np
import pytest
import trimesh
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Mesh
from heliform.engines.core.solid import inspect, repair, require_solid


def ball(radius=1.0, at=(0.0, 0.0, 0.0), inward=False):
    sphere = trimesh.creation.icosphere(2, radius)
    faces = sphere.faces[:, ::-1] if inward else sphere.faces
    vertices = sphere.vertices + at
    corners = vertices[faces] - at
    normals = corners / np.linalg.norm(corners, axis=-1, keepdims=True) * (-1 if inward else 1)
    return Mesh(vertices, np.ascontiguousarray(faces, dtype=np.int32), normals.astype(np.float32))


def together(*meshes):
    starts = np.cumsum([0, *(len(m.vertices) for m in meshes[:-1])])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.faces + s for m, s in zip(meshes, starts, strict=True)], dtype=np.int32),
        np.concatenate([m.normals for m in meshes]),
    )


def without(mesh, drop):
    return Mesh(mesh.vertices, np.delete(mesh.faces, drop, 0), np.delete(mesh.normals, drop, 0))


def turned(mesh, which):
    faces, normals = mesh.faces.copy(), mesh.normals.copy()
    faces[which] = faces[which, ::-1]
    normals[which] = -normals[which, ::-1]
    return Mesh(mesh.vertices, faces, normals)


def volume(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume


def cube():
    box = trimesh.creation.box()
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Mesh(np.asarray(box.vertices, dtype=float), np.array(quads, dtype=np.int32))


def test_a_solid_stays_as_it_is():
    for mesh in (ball(), cube(), together(ball(), ball(at=(3, 0, 0)))):
        require_solid("Vase", mesh)
        assert repair(mesh) == (mesh, [])


def test_unmerged_corners_as_in_an_stl_file_count_as_one():
    mesh = ball()
    loose = Mesh(
        mesh.vertices[mesh.faces].reshape(-1, 3),
        np.arange(mesh.faces.size, dtype=np.int32).reshape(-1, 3),
    )
    assert inspect(loose).problem == ""
    assert inspect(loose).parts == 1


def test_points_that_are_all_but_coincident_stay_apart():
    corners = np.array([[1, 0, 0], [1, 1e-20, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]], dtype=np.int32)
    corners = np.concatenate([corners, corners])
    report = inspect(Mesh(corners, faces))
    assert report.faces == 4
    assert report.open_edges == 0


def test_a_missing_face_is_told_and_closed():
    whole = ball()
    mesh = without(whole, [0, 100])
    with pytest.raises(SceneError) as told:
        require_solid("Vase ä/1", mesh)
    assert str(told.value) == (
        "Glass “Vase ä/1” is open: 6 edges have one face. "
        "Repair it in Glass › Check, or tick Repair."
    )
    mended, notes = repair(mesh)
    assert notes == ["Closed 2 holes with flat faces."]
    require_solid("Vase", mended)
    assert volume(mended) == pytest.approx(volume(whole))
    assert (mended.normals[: len(mesh.faces)] == mesh.normals).all()
    assert np.linalg.norm(mended.normals, axis=-1) == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("which", [slice(0, 20), slice(20, None)])
def test_twisted_faces_are_turned_back(which):
    whole = ball()
    mesh = turned(whole, which)
    with pytest.raises(SceneError, match=r"is twisted: [0-9]+ edges lie between"):
        require_solid("Vase", mesh)
    mended, _ = repair(mesh)
    assert (np.sort(mended.faces) == np.sort(whole.faces)).all()
    assert volume(mended) == pytest.approx(volume(whole))


def test_a_solid_inside_out_is_told_and_turned():
    with pytest.raises(
        SceneError, match=r"“Vase” is inside out: its faces look inward\. Repair it"
    ):
        require_solid("Vase", ball(inward=True))
    mended, notes = repair(ball(inward=True))
    assert notes == ["Turned 1 part that faced the wrong way."]
    assert volume(mended) == pytest.approx(volume(ball()))
    outward = np.einsum("fci,fci->fc", mended.normals, mended.vertices[mended.faces])
    assert (outward > 0).all()


def test_a_void_faces_inward_and_a_kernel_in_it_outward():
    nest = together(ball(3), ball(2, inward=True), ball(1), ball(1, at=(9, 0, 0)))
    assert inspect(nest).problem == ""
    assert inspect(nest).parts == 4
    wrong = together(ball(3), ball(2), ball(1, inward=True), ball(1, at=(9, 0, 0)))
    assert inspect(wrong).problem == "is inside out in 2 of its 4 parts"
    assert volume(repair(wrong)[0]) == pytest.approx(volume(nest))


def test_faces_without_area_or_listed_twice_are_dropped():
    whole = ball()
    faces = np.concatenate([whole.faces, [[0, 0, 1]], whole.faces[:3]], dtype=np.int32)
    mesh = Mesh(whole.vertices, faces)
    report = inspect(mesh)
    assert report.degenerate == 1
    assert report.crowded_edges > 0
    mended, notes = repair(mesh)
    assert notes == ["Dropped 4 faces without area or listed twice."]
    assert volume(mended) == pytest.approx(volume(whole))


def test_a_fin_on_an_edge_is_dropped():
    whole = ball()
    tip = whole.vertices[whole.faces[0, :2]].mean(axis=0, keepdims=True) * 1.01
    fin = np.array([[*whole.faces[0, :2], len(whole.vertices)]], dtype=np.int32)
    mesh = Mesh(np.concatenate([whole.vertices, tip]), np.concatenate([whole.faces, fin]))
    assert inspect(mesh).crowded_edges == 1
    mended, notes = repair(mesh)
    assert notes == ["Dropped 1 face at edges with more than two."]
    assert volume(mended) == pytest.approx(volume(whole))


def test_a_corner_that_is_not_a_number_makes_a_hole_that_is_closed():
    mesh = ball()
    mesh.vertices[7] = np.nan
    assert inspect(mesh).open_edges > 0
    mended, _ = repair(mesh)
    require_solid("Vase", mended)
    assert np.isfinite(mended.vertices).all()


def test_a_moebius_band_cannot_be_repaired_and_the_last_note_says_so():
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    edge = np.array([-0.2, 0.2])[:, None]
    reach = 1 + edge * np.cos(turn / 2)
    band = np.stack(
        [reach * np.cos(turn), reach * np.sin(turn), edge * np.sin(turn / 2)], axis=-1
    ).transpose(1, 0, 2)
    here, there = np.arange(0, 80, 2), np.roll(np.arange(0, 80, 2), -1)
    quads = np.column_stack([here, there, there + 1, here + 1])
    quads[-1] = [78, 1, 0, 79]
    _, notes = repair(Mesh(band.reshape(-1, 3), quads.astype(np.int32)))
    assert notes[-1].startswith("Could not repair everything: it still ")


def test_a_mesh_without_faces_is_told():
    empty = Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32))
    with pytest.raises(SceneError, match="Glass “Vase” has no faces"):
        require_solid("Vase", empty)
    assert repair(empty)[1] == ["Could not repair everything: it still has no faces."]


@pytest.mark.parametrize("missing", [1, 2, 3, 5, 14])
def test_holes_that_touch_in_a_point_are_closed_too(missing):
    ball = trimesh.creation.icosphere(3, 0.03)
    faces = np.asarray(ball.faces, np.int32)[missing:]
    mended, notes = repair(Mesh(np.asarray(ball.vertices), faces))
    assert not inspect(mended).problem
    assert notes
