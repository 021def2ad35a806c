"""What a lamp and a receiver look like, and how they are read off what is drawn."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import FileError, SceneError
from heliform.engines.core.scene import Lamp, Luminaire, Plane, plane_receiver
from heliform.engines.light import ies, photometry
from heliform.engines.light.luminaires import source
from heliform.engines.light.shape import (
    AROUND,
    lamp_outline,
    placed_lamp,
    plane_mesh,
    rectangle_receiver,
)


def outline(**lamp):
    return lamp_outline(Luminaire("Lamp", Lamp(**lamp)))


def test_the_sample_lamp_shows_its_opening_and_its_half_maximum():
    points, edges = outline()
    sample = ies.read_ies(ies.sample_path())
    rim, far = points[:AROUND], points[AROUND + 5 : 2 * AROUND + 5]
    assert np.hypot(*rim[:, :2].T) == pytest.approx(sample.width / 2)
    away = far - rim
    angle = np.degrees(np.arctan2(np.hypot(*away[:, :2].T), -away[:, 2]))
    assert angle == pytest.approx(photometry.beam_angle(sample) / 2)
    assert edges.min() == 0
    assert edges.max() == len(points) - 1
    assert points[:, 2].max() == pytest.approx(0)


def test_a_parallel_beam_is_a_tube():
    points, _ = outline(source="beam", opening="rectangular", width=0.2, length=0.1)
    assert np.ptp(points[:, :2], axis=0) == pytest.approx([0.1, 0.2])
    assert points[:, 2].min() == pytest.approx(-0.3)


def test_a_point_shines_all_around():
    points, _ = outline(source="point")
    assert np.ptp(points, axis=0) == pytest.approx(0.2)


def test_a_disk_shows_the_cosine_law():
    points, _ = outline(source="disk", width=0.04)
    far = points[AROUND + 5]
    assert far == pytest.approx([0.02 + 0.1 * np.sin(np.pi / 3), 0, -0.05], abs=1e-6)


def test_what_cannot_be_drawn_is_said(tmp_path):
    with pytest.raises(SceneError, match="without an opening"):
        outline(source="beam", width=0.0)
    with pytest.raises(FileError, match="check its path"):
        outline(file=str(tmp_path / "no.ies"))


def test_a_scale_is_that_of_the_opening():
    matrix = np.diag([2.0, 3.0, 5.0, 1.0])
    matrix[:3, 3] = 1, 2, 3
    lamp = Lamp(source="disk", flux=1.0, opening="rectangular", width=0.1, length=0.2)
    placed = placed_lamp("Lamp", lamp, matrix)
    assert placed.lamp == replace(lamp, width=pytest.approx(0.3), length=pytest.approx(0.4))
    assert placed.pose[:3, :3] == pytest.approx(np.eye(3))
    assert placed.pose[:3, 3] == pytest.approx([1, 2, 3])


def test_a_scaled_ies_lamp_keeps_its_light():
    placed = placed_lamp("Lamp", Lamp(), np.diag([2.0, 2.0, 2.0, 1.0]))
    before, after = source(Luminaire("Lamp", Lamp())), source(placed)
    assert after.width == pytest.approx(2 * before.width)
    assert after.flux == pytest.approx(before.flux)


def test_a_round_opening_does_not_become_an_ellipse():
    with pytest.raises(SceneError, match="“Lamp” is round"):
        placed_lamp("Lamp", Lamp(source="disk"), np.diag([2.0, 1.0, 1.0, 1.0]))


def rectangle(matrix=None, plane=None, texture=None):
    mesh, square = plane_mesh(plane or Plane(width=2.0, length=1.0))
    matrix = np.eye(4) if matrix is None else matrix
    corners = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    normal = np.array([0, 0, 1]) @ np.linalg.inv(matrix[:3, :3])
    texture = square if texture is None else np.array(texture, float)
    return rectangle_receiver("Wall", corners, texture, normal, 100)


def test_a_plane_is_read_as_it_was_made():
    plane = Plane(width=2.0, length=1.0, resolution=100)
    read, meant = rectangle(plane=plane), plane_receiver("Wall", plane, np.eye(4))
    for name in ("origin", "u", "v"):
        assert getattr(read, name) == pytest.approx(getattr(meant, name))
    assert (read.columns, read.rows) == (meant.columns, meant.rows) == (100, 50)


def test_the_texture_says_which_way_the_rows_go():
    turned = rectangle(texture=[[1, 0], [1, 1], [0, 1], [0, 0]])
    assert turned.origin == pytest.approx([-1, 0.5, 0])
    assert turned.u == pytest.approx([0, -1, 0])
    assert turned.v == pytest.approx([2, 0, 0])
    assert turned.normal == pytest.approx([0, 0, 1])


@pytest.mark.parametrize(
    ("texture", "message"),
    [
        ([[0, 0], [0.5, 0], [0.5, 1], [0, 1]], "whole picture"),
        ([[0, 0], [0, 0], [0, 0], [0, 0]], "whole picture"),
        ([[1, 0], [0, 0], [0, 1], [1, 1]], "mirrored"),
        ([[0, 0], [1, 0], [0.3, 1], [0, 1]], "not one flat rectangle"),
    ],
)
def test_a_texture_that_cannot_be_the_receivers_is_said(texture, message):
    with pytest.raises(SceneError, match=message):
        rectangle(texture=texture)


def test_a_sheared_or_flat_plane_is_no_rectangle():
    shear = np.eye(4)
    shear[0, 1] = 0.2
    with pytest.raises(SceneError, match="“Wall” is not one flat rectangle"):
        rectangle(shear)
