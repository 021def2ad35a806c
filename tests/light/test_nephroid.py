"""The caustic in a cup: parallel light in a mirror cylinder gathers on a nephroid."""

import numpy as np
from heliform.engines.core.scene import Body, Material, Mesh
from heliform.engines.light import PhotonTracing
from light import scenes

RADIUS = 0.05


def cup(count=1440, height=0.06) -> Mesh:
    """An open band that mirrors on its inside, with exact normals."""
    turn = np.arange(count + 1) * 2 * np.pi / count
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    low = np.column_stack([ring * RADIUS, np.zeros(count + 1)])
    vertices = np.concatenate([low, low + np.array([0.0, 0.0, height])])
    k = np.arange(count, dtype=np.int32)
    faces = np.column_stack([k, k + count + 1, k + count + 2, k + 1]).astype(np.int32)
    inward = np.column_stack([-ring, np.zeros(count + 1)])
    normals = np.concatenate([inward, inward])[faces].astype(np.float32)
    return Mesh(vertices, faces, normals)


def nephroid(y):
    """x of the caustic at height ``y`` in units of R, light travelling along +x [Cayley 1857]."""
    t = np.linspace(0.0, np.pi / 2, 20_001)
    x, across = np.cos(t) * (1.5 - np.cos(t) ** 2), np.sin(t) ** 3
    return np.interp(y, across, x)


def test_light_in_a_mirror_cylinder_gathers_on_the_nephroid():
    """Every photon travels 1.4 R in plan, so the floor shows the caustic of one reflection."""
    travel = 1.4 * RADIUS
    axis = np.array([travel, 0.0, -0.06])
    wide = scenes.at(*(np.array([0.0, 0.0, 0.06]) - 3 * axis), axis=axis)
    receiver = scenes.floor(0.1, 200, scenes.at(z=1e-4, axis=(0, 0, -1)))
    result = scenes.traced(
        scenes.scene(
            Body("Cup", cup(), Material(kind="mirror", reflectance=1.0)),
            lamp=scenes.beam(1000.0, 0.3, wide),
            receiver=receiver,
        ),
        PhotonTracing(until="landed", landed=6_000_000),
        seed=9,
    )
    place = scenes.texel_centres(receiver)
    texel = receiver.u[0] / receiver.columns
    x, y = place[0, :, 0], place[:, 0, 1]
    inside = np.abs(x) < 0.9 * RADIUS
    for height in (-0.4, -0.2, 0.2, 0.4):
        row = np.argmin(np.abs(y - height * RADIUS))
        edge = nephroid(abs(y[row]) / RADIUS) * RADIUS
        brightest = x[inside][np.argmax(np.where(x > 0, result.caustic[row], 0)[inside])]
        assert abs(brightest - edge) < 2.5 * texel
    # The cusp: at half the radius on the axis.
    row = np.argmin(np.abs(y))
    assert abs(x[np.argmax(result.caustic[row])] - RADIUS / 2) < 4 * texel
