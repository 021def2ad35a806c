"""One printed bead as a cylinder lens: its fan against exact rays, over three meshes."""

import numpy as np
from heliform.engines.core.scene import Mesh
from heliform.engines.light import PhotonTracing
from light import scenes

HEIGHT, SAG, IOR, DEPTH = 0.005, 0.0012, 1.5, 0.004
ARC = (HEIGHT**2 / 4 + SAG**2) / (2 * SAG)
DROP = 0.05
WIDE = 0.8 * HEIGHT


def bead(rows) -> Mesh:
    """A bar along y, flat above and an arc of ``rows`` strips below, with exact normals."""
    x = np.linspace(-HEIGHT / 2, HEIGHT / 2, rows + 1)
    z = -(np.sqrt(ARC**2 - x**2) - (ARC - SAG)) - DEPTH
    down = np.column_stack([x, 0 * x, -np.sqrt(ARC**2 - x**2)]) / ARC
    ring = np.concatenate([np.column_stack([x, z]), [[HEIGHT / 2, 0.0], [-HEIGHT / 2, 0.0]]])
    long = 0.1
    vertices = np.concatenate([np.insert(ring, 1, y, axis=1) for y in (-long / 2, long / 2)])
    count = len(ring)
    k = np.arange(count)
    following = (k + 1) % count
    sides = np.column_stack([k, following, following + count, k + count])
    corners = vertices[sides]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    outward = np.sign((flat * (corners.mean(axis=1) - vertices.mean(axis=0))).sum(axis=1))
    assert (outward == outward[0]).all()
    if outward[0] < 0:
        sides, flat = sides[:, ::-1], -flat
    normals = np.repeat(flat[:, None], 4, axis=1)
    smooth = np.concatenate([down, down])
    index = {
        **{i: i for i in range(rows + 1)},
        **{i + count: i + rows + 1 for i in range(rows + 1)},
    }
    for face in range(rows):
        normals[face] = smooth[[index[v] for v in sides[face]]]
    caps = [(0, i, i + 1) for i in range(1, count - 1)]
    if outward[0] > 0:
        caps = [c[::-1] for c in caps]
    cap = np.array([*caps, *[(a + count, c + count, b + count) for a, b, c in caps]])
    triangles = np.concatenate([sides[:, [0, 1, 2]], sides[:, [0, 2, 3]], cap]).astype(np.int32)
    ends = np.zeros((len(cap), 3, 3))
    ends[..., 1] = np.where(np.arange(len(cap)) < len(caps), -1.0, 1.0)[:, None]
    smooth_corners = np.concatenate([normals[:, [0, 1, 2]], normals[:, [0, 2, 3]], ends])
    return Mesh(vertices, triangles, smooth_corners.astype(np.float32))


def exact_profile(edges):
    """Share of the light in each bin of x: vertical rays, straight in, refracted at the arc."""
    x = np.linspace(-WIDE / 2, WIDE / 2, 2_000_001)
    inside = np.arcsin(x / ARC)
    outside = np.arcsin(IOR * np.sin(inside))
    z = -(np.sqrt(ARC**2 - x**2) - (ARC - SAG)) - DEPTH
    landing = x - np.tan(outside - inside) * (z + DROP)
    r_s = np.square(np.cos(inside) * IOR - np.cos(outside)) / np.square(
        np.cos(inside) * IOR + np.cos(outside)
    )
    r_p = np.square(np.cos(inside) - IOR * np.cos(outside)) / np.square(
        np.cos(inside) + IOR * np.cos(outside)
    )
    share, _ = np.histogram(landing, edges, weights=1 - (r_s + r_p) / 2)
    return share / share.sum()


def profile(rows, facets=False):
    mesh = bead(rows)
    if facets:
        mesh = Mesh(mesh.vertices, mesh.faces)
    columns = 100
    receiver = scenes.floor(0.1, columns, scenes.at(z=-DROP))
    sheet = scenes.sheet(1e4, WIDE, 0.01, scenes.at(z=0.02))
    result = scenes.traced(
        scenes.scene(scenes.glass(mesh), lamp=sheet, receiver=receiver),
        PhotonTracing(until="landed", landed=1_500_000),
        seed=10,
    )
    share = result.caustic.sum(axis=0, dtype=np.float64)
    return share / share.sum(), np.linspace(-0.05, 0.05, columns + 1)


def test_a_smooth_bead_converges_to_its_exact_fan():
    """L1 distance at 4, 8 and 16 strips; a faceted bead is far off at any of them."""
    errors = []
    for rows in (4, 8, 16):
        found, edges = profile(rows)
        errors.append(np.abs(found - exact_profile(edges)).sum())
    assert errors[2] < 0.7 * errors[1] < 0.5 * errors[0]
    assert errors[2] < 0.02
    faceted, edges = profile(16, facets=True)
    assert np.abs(faceted - exact_profile(edges)).sum() > 10 * errors[2]
