"""Smooth normals: closed forms, trimesh's own, and creases."""

import numpy as np
import pytest
import trimesh
from heliform.engines.core.normals import corner_normals, face_normals, vertex_normals
from heliform.engines.core.scene import Mesh

CUBE = trimesh.creation.box((2, 2, 2))
QUADS = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]], np.int32
)
CORNERS = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
EIGHT = Mesh(CORNERS, QUADS)


def from_trimesh(found):
    return Mesh(np.array(found.vertices), np.array(found.faces, np.int32))


def degrees_between(a, b):
    return np.degrees(2 * np.arcsin(np.minimum(np.linalg.norm(a - b, axis=-1) / 2, 1)))


def test_a_cube_is_flat_below_its_angle_and_round_above():
    flat = corner_normals(EIGHT, np.radians(60))
    assert flat == pytest.approx(np.repeat(face_normals(EIGHT)[:, None], 4, axis=1))
    smooth = corner_normals(EIGHT, np.radians(91))
    assert smooth == pytest.approx(CORNERS[QUADS] / np.sqrt(3), abs=1e-6)


def test_how_faces_are_split_does_not_sway_a_cubes_corners():
    """The weights are angles: two triangles of 45° count as much as the square's 90°."""
    split = corner_normals(EIGHT.triangles(), np.pi)
    assert split == pytest.approx(CORNERS[EIGHT.triangles().faces] / np.sqrt(3), abs=1e-6)


@pytest.mark.parametrize(
    "shape",
    [
        trimesh.creation.icosphere(3),
        trimesh.creation.torus(1.0, 0.3),
        trimesh.creation.annulus(1.0, 1.2, 2.0),
        trimesh.creation.cone(1.0, 2.0),
    ],
)
def test_vertices_are_as_trimesh_has_them(shape):
    given = trimesh.geometry.weighted_vertex_normals(
        len(shape.vertices), shape.faces, shape.face_normals, shape.face_angles
    )
    mesh = from_trimesh(shape)
    assert vertex_normals(mesh) == pytest.approx(given, abs=1e-9)
    assert corner_normals(mesh, np.pi) == pytest.approx(given[shape.faces], abs=1e-6)


def test_a_spheres_are_its_radii():
    ball = from_trimesh(trimesh.creation.icosphere(5))
    assert degrees_between(vertex_normals(ball), ball.vertices).max() < 0.1


def test_a_cylinder_is_round_beside_its_rims():
    can = trimesh.creation.cylinder(1.0, 2.0, sections=64)
    mesh = from_trimesh(can)
    normals = corner_normals(mesh, np.radians(60))
    side = np.abs(can.face_normals[:, 2]) < 0.5
    assert normals[~side] == pytest.approx(np.repeat(can.face_normals[~side, None], 3, axis=1))
    round_part = mesh.vertices[mesh.faces[side]] * [1, 1, 0]
    assert degrees_between(normals[side], round_part).max() < 1.5


def test_a_crease_parts_only_the_faces_that_it_separates():
    """A ridge along half of a line: its end joins both sides again."""
    x, y = np.meshgrid(np.arange(5.0), np.arange(3.0), indexing="ij")
    z = np.where((y == 1) & (x < 2), 2.0, 0.0)
    i = np.arange(4)[:, None] * 3 + np.arange(2)
    faces = np.stack([i, i + 3, i + 4, i + 1], -1).reshape(-1, 4).astype(np.int32)
    mesh = Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces)
    normals = corner_normals(mesh, np.radians(60)).reshape(4, 2, 4, 3)
    assert degrees_between(normals[0, 0, 3], normals[0, 1, 0]) > 100
    assert normals[3, 0, 3] == pytest.approx(normals[3, 1, 0])


def test_edges_that_are_crowded_or_twisted_are_creases():
    corners = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0.2], [0.2, 0, 1]], float)
    fan = Mesh(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 4, 1]], np.int32))
    twisted = Mesh(corners, np.array([[0, 2, 1], [0, 3, 1]], np.int32))
    for mesh in (fan, twisted):
        flat = np.repeat(face_normals(mesh)[:, None], 3, axis=1)
        assert corner_normals(mesh, np.pi) == pytest.approx(flat)


def test_what_has_no_area_or_no_faces_harms_nothing():
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], float)
    mesh = Mesh(corners, np.array([[0, 1, 2], [0, 3, 1]], np.int32))
    assert corner_normals(mesh, np.radians(60))[0] == pytest.approx(np.tile([0, 0, 1], (3, 1)))
    assert np.isfinite(corner_normals(mesh, np.radians(60))).all()
    empty = Mesh(corners, np.zeros((0, 4), np.int32))
    assert corner_normals(empty, 1.0).shape == (0, 4, 3)
    assert vertex_normals(empty)[1:] == pytest.approx(
        corners[1:] / corners[1:].max(axis=1)[:, None]
    )
