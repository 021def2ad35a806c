"""Meshes far larger than printed glass needs."""

import numpy as np
import pytest
from heliform.engines.core.scene import Mesh
from heliform.engines.light import PhotonTracing
from light import scenes

pytestmark = pytest.mark.slow


def globe(rows: int, radius: float) -> Mesh:
    """A ball of about 4 ``rows``² triangles with smooth normals."""
    columns = 2 * rows
    tilt, turn = np.meshgrid(
        np.linspace(0, np.pi, rows + 1)[1:-1],
        np.arange(columns) * 2 * np.pi / columns,
        indexing="ij",
    )
    round_ = np.stack(
        [np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=-1
    )
    points = np.concatenate([round_.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    index = np.arange((rows - 1) * columns, dtype=np.int32).reshape(rows - 1, columns)
    beside = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1], index[1:], beside[1:], beside[:-1]
    top, bottom = np.int32(len(points) - 2), np.int32(len(points) - 1)
    faces = [np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)]
    caps = [
        np.stack([np.full(columns, top), index[0], beside[0]], axis=-1),
        np.stack([np.full(columns, bottom), beside[-1], index[-1]], axis=-1),
    ]
    joined = np.concatenate([f.reshape(-1, 3) for f in (*faces, *caps)])
    return Mesh(points * radius, joined, points[joined].astype(np.float32))


def test_ten_million_faces_focus_as_a_ball_does():
    """1.5 R from the centre for n = 1.5: most of a narrow beam in one spot there."""
    ball = globe(1582, 0.02)
    assert len(ball.faces) > 10_000_000
    scene = scenes.scene(
        scenes.glass(ball),
        lamp=scenes.beam(1000.0, 0.006, scenes.at(z=0.05)),
        receiver=scenes.floor(0.02, 65, scenes.at(z=-0.03)),
    )
    result = scenes.traced(scene, PhotonTracing(until="landed", landed=100_000), seed=1)
    middle = result.caustic[30:35, 30:35].sum() / result.caustic.sum()
    assert middle > 0.9
