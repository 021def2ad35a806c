"""What a relief is told of a wall: which way is out, which face, how far around."""

import numpy as np
import pytest
import trimesh
from heliform.engines.core.scene import Mesh
from heliform.engines.glass.skin import skin_of

PIPE = trimesh.creation.annulus(0.09, 0.1, 0.2, sections=200)


def from_trimesh(found):
    return Mesh(np.array(found.vertices), np.array(found.faces, np.int32))


def test_both_faces_of_a_pipe():
    mesh = from_trimesh(PIPE)
    skin = skin_of(mesh)
    radius = np.hypot(*mesh.vertices[:, :2].T)
    assert skin.normal == pytest.approx(mesh.vertices[:, :2] / radius[:, None], abs=1e-6)
    assert skin.side == pytest.approx(np.where(radius > 0.095, 1, -1))
    angle = np.arctan2(mesh.vertices[:, 1], mesh.vertices[:, 0])
    assert skin.turn == pytest.approx(angle / (2 * np.pi) % 1)
    assert skin.girth == pytest.approx(2 * np.pi * 0.095)


def test_a_ring_is_outer_outside_and_inner_in_its_hole():
    mesh = from_trimesh(trimesh.creation.torus(0.1, 0.03))
    skin = skin_of(mesh)
    radius = np.hypot(*mesh.vertices[:, :2].T)
    assert (skin.side[radius > 0.101] > 0).all()
    assert (skin.side[radius < 0.099] < 0).all()


def test_relief_fades_where_a_sphere_closes():
    ball = from_trimesh(trimesh.creation.icosphere(5))
    skin = skin_of(ball)
    assert np.isfinite(skin.normal).all()
    steep = np.hypot(*ball.vertices[:, :2].T)
    assert skin.side[steep > 0.26] == pytest.approx(1)
    top = steep < 0.24
    assert skin.side[top] == pytest.approx(4 * steep[top], rel=0.02, abs=1e-3)


@pytest.mark.parametrize("angle", np.linspace(0, 3, 7))
def test_a_panel_through_the_axis_has_one_face(angle):
    """Its normal is square to every radius: rounding must not tear it."""
    u, z = np.meshgrid(np.linspace(-1, 1, 21), np.linspace(0, 1, 5), indexing="ij")
    points = np.stack([u * np.cos(angle), u * np.sin(angle), z], -1).reshape(-1, 3)
    i = np.arange(20)[:, None] * 5 + np.arange(4)
    faces = np.stack([i, i + 5, i + 6, i + 1], -1).reshape(-1, 4).astype(np.int32)
    skin = skin_of(Mesh(points.astype(np.float32).astype(float), faces))
    assert (skin.side == 1).all()
    assert np.ptp(skin.normal, axis=0) == pytest.approx(0, abs=1e-6)


def test_turning_the_object_turns_the_skin():
    mesh = from_trimesh(trimesh.creation.torus(0.1, 0.03))
    turned = mesh.moved(trimesh.transformations.rotation_matrix(0.7, [0, 0, 1]))
    before, after = skin_of(mesh), skin_of(turned)
    assert after.side == pytest.approx(before.side)
    around = (after.turn - before.turn - 0.7 / (2 * np.pi) + 0.5) % 1 - 0.5
    assert around == pytest.approx(0, abs=1e-9)


def test_points_without_faces_look_away_from_the_middle():
    mesh = from_trimesh(PIPE)
    skin = skin_of(Mesh(np.vstack([mesh.vertices, [[3, 4, 0], [0, 0, 0]]]), mesh.faces))
    assert skin.normal[-2] == pytest.approx([0.6, 0.8])
    assert (skin.side[-2:] == [1, 0]).all()
    assert np.isfinite(skin.normal).all()
