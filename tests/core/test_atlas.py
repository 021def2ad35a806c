"""What the texels of a map cover, how a surface without a map gets one, and values on it."""

import numpy as np
import pytest
from heliform.engines.core.atlas import (
    at_vertices,
    overlapping,
    padded,
    require_chart,
    texels,
)
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Mesh, Surface
from heliform.engines.core.unwrap import unwrap

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)


def sheet(u, v, f, wrap=False):
    """A grid of u × v squares, in triangles, its points at f(0..1, 0..1); ``wrap`` closes u."""
    along = np.arange(u if wrap else u + 1)
    across, up = np.meshgrid(along / u, np.arange(v + 1) / v, indexing="ij")
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(u), np.arange(v), indexing="ij"))
    k = (i + 1) % len(along)
    faces = np.stack([i * (v + 1) + j, k * (v + 1) + j, k * (v + 1) + j + 1, i * (v + 1) + j + 1])
    points = np.stack(np.broadcast_arrays(*f(across.ravel(), up.ravel())), axis=1)
    return Mesh(points, faces.T.astype(np.int32)).triangles()


def cylinder(u=64, v=16, radius=0.1, height=0.3):
    def at(a, b):
        return radius * np.cos(2 * np.pi * a), radius * np.sin(2 * np.pi * a), height * b

    return sheet(u, v, at, wrap=True)


def sphere(u=96, v=48, radius=0.1):
    """With faces without area at its poles."""

    def at(a, b):
        ring = radius * np.sin(np.pi * b)
        down = -radius * np.cos(np.pi * b)
        return ring * np.cos(2 * np.pi * a), ring * np.sin(2 * np.pi * a), down

    return sheet(u, v, at, wrap=True)


def waffle(fins):
    """Separate boxes of 1 m × 2 mm × 30 mm, half of them across, all turned by 45°."""
    box = np.array([[x, y, z] for z in (0, 1) for x, y in SQUARE])
    sides = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    sizes = np.array([[1.0, 2e-3, 0.03], [2e-3, 1.0, 0.03]])
    points = [
        box * sizes[k % 2] + [k % 2 * k * 0.01, (1 - k % 2) * k * 0.01, 0] for k in range(fins)
    ]
    turn = np.array([[1, -1, 0], [1, 1, 0], [0, 0, np.sqrt(2)]]) / np.sqrt(2)
    faces = np.concatenate([np.array(sides, dtype=np.int32) + 8 * k for k in range(fins)])
    return Mesh(np.concatenate(points) @ turn.T, faces).triangles()


def helix():
    """A ramp that winds ten times over itself."""

    def at(a, b):
        reach = 0.05 + 0.05 * b
        return reach * np.cos(20 * np.pi * a), reach * np.sin(20 * np.pi * a), 0.5 * a

    return sheet(400, 6, at)


def mapped(mesh, texture, columns, rows=None, name="Vase ä/1"):
    return Surface(name, mesh, np.asarray(texture, dtype=float), columns, rows or columns)


def unwrapped(mesh, resolution, padding=2):
    return mapped(mesh, unwrap(mesh, resolution, padding), resolution)


def flat_square(corners, columns, rows=None, size=1.0):
    """A square of ``size`` with the texture coordinates ``corners`` (4, 2)."""
    corners = np.asarray(corners, dtype=float)
    mesh = Mesh(np.column_stack([size * SQUARE, np.zeros(4)]), np.arange(4, dtype=np.int32)[None])
    return mapped(mesh.triangles(), corners[[[0, 1, 2], [0, 2, 3]]], columns, rows)


def area_of(mesh):
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def density(surface):
    """Area in the map over area of the face, for faces that have any, over the mean."""
    a, b, c = surface.texture.transpose(1, 2, 0)
    there = area_of(surface.mesh) > 1e-15
    ratio = ((b - a)[0] * (c - a)[1] - (c - a)[0] * (b - a)[1]) / 2
    ratio = ratio[there] / area_of(surface.mesh)[there]
    return ratio / ratio.mean()


# Clipping


def test_a_square_fills_its_map_evenly():
    got = texels(flat_square(SQUARE, 8, 4, size=2.0))
    assert got.area == pytest.approx(np.full((4, 8), 4 / 32), abs=1e-14)
    v, u = np.meshgrid((np.arange(4) + 0.5) / 4, (np.arange(8) + 0.5) / 8, indexing="ij")
    assert got.place == pytest.approx(np.stack([2 * u, 2 * v, 0 * u], axis=-1), abs=1e-14)
    assert got.normal == pytest.approx(np.broadcast_to([0, 0, 1], (4, 8, 3)))
    assert got.inside.all()
    assert np.array_equal(got.home.ravel(), np.arange(32))


def test_a_diagonal_halves_the_texels_it_crosses():
    triangle = Mesh(
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float), np.array([[0, 1, 2]], np.int32)
    )
    got = texels(mapped(triangle, [[[0, 0], [1, 0], [0, 1]]], 4))
    crossed = np.flipud(np.eye(4, dtype=bool))
    assert got.area[crossed] == pytest.approx(np.full(4, 1 / 32))
    below = np.fliplr(np.triu(np.ones((4, 4), bool), 1))
    assert got.area[below] == pytest.approx(np.full(6, 1 / 16))
    assert got.area.sum() == pytest.approx(0.5)
    assert got.place[3, 0] == pytest.approx([1 / 12, 0.75 + 1 / 12, 0])
    assert got.face[3, 0] == 0
    assert got.face[3, 3] == -1
    assert not got.place[3, 3].any()


def clipped_by_hand(polygon, column, row):
    """Sutherland and Hodgman's clipping of one polygon with one texel: area and centroid."""
    for axis, sign, bound in ((0, 1, column), (0, -1, column + 1), (1, 1, row), (1, -1, row + 1)):
        kept = []
        for p, q in zip(polygon, polygon[1:] + polygon[:1], strict=True):
            inside_p, inside_q = sign * (p[axis] - bound) >= 0, sign * (q[axis] - bound) >= 0
            if inside_p:
                kept.append(p)
            if inside_p != inside_q:
                kept.append(p + (q - p) * (bound - p[axis]) / (q[axis] - p[axis]))
        polygon = kept
    if len(polygon) < 3:
        return 0.0, np.zeros(2)
    points, following = np.array(polygon), np.roll(polygon, -1, axis=0)
    cross = points[:, 0] * following[:, 1] - following[:, 0] * points[:, 1]
    total = cross.sum() / 2
    if total == 0:
        return 0.0, np.zeros(2)
    return abs(total), ((points + following) * cross[:, None]).sum(axis=0) / (6 * total)


@pytest.mark.parametrize("seed", range(12))
def test_any_triangle_is_clipped_as_by_hand(seed):
    random = np.random.default_rng(seed)
    corners = random.uniform(0, 1, (3, 2))
    if seed % 3 == 0:  # upright, level or on the grid's own lines
        corners = np.round(corners * 7) / 7
    points = np.column_stack([corners * [7, 5], np.zeros(3)])
    got = texels(mapped(Mesh(points, np.array([[0, 1, 2]], np.int32)), corners[None], 7, 5))
    truth = [[clipped_by_hand(list(points[:, :2]), c, r) for c in range(7)] for r in range(5)]
    area = np.array([[cell[0] for cell in line] for line in truth])
    moment = np.array([[cell[0] * cell[1] for cell in line] for line in truth])
    home = got.home.ravel()
    assert got.area.ravel() == pytest.approx(np.bincount(home, area.ravel(), 35), abs=1e-12)
    for axis in (0, 1):
        brought = np.bincount(home, moment[..., axis].ravel(), 35)
        assert (got.area * got.place[..., axis]).ravel() == pytest.approx(brought, abs=1e-11)


def test_a_turned_square_covers_what_its_size_says():
    angle = np.radians(30)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = (SQUARE - 0.5) @ turn.T * 0.6 + 0.5
    surface = flat_square(corners, 64, size=3.0)
    got = texels(surface)
    whole = 9.0 / (0.6 * 64) ** 2
    assert got.area.sum() == pytest.approx(9.0, rel=1e-12)
    assert np.median(got.area[got.inside]) == pytest.approx(whole, rel=1e-9)
    row, column = np.nonzero(np.isclose(got.area, whole, rtol=1e-9))
    centre = (np.column_stack([column, row]) + 0.5) / 64
    back = (centre - 0.5) @ turn / 0.6 + 0.5
    assert got.place[row, column, :2] == pytest.approx(3 * back, abs=1e-9)


def test_a_mirrored_map_covers_as_much():
    straight = texels(flat_square(SQUARE, 16))
    mirrored = texels(flat_square(SQUARE[[1, 0, 3, 2]], 16))
    assert mirrored.area == pytest.approx(straight.area)
    assert mirrored.place[..., 0] == pytest.approx(straight.place[:, ::-1, 0])
    assert mirrored.normal[..., 2] == pytest.approx(np.ones((16, 16)))


def test_the_face_with_most_of_a_texel_is_told():
    surface = flat_square(SQUARE, 1)
    uneven = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0.2, 0]], dtype=float)
    mesh = Mesh(uneven, surface.mesh.faces)
    assert texels(mapped(mesh, surface.texture, 1)).face[0, 0] == 0
    assert texels(mapped(Mesh(uneven, mesh.faces[::-1]), surface.texture[::-1], 1)).face[0, 0] == 1


def test_one_texel_holds_a_whole_mesh():
    mesh = sphere()
    got = texels(unwrapped(mesh, 64))
    one = texels(mapped(mesh, unwrap(mesh, 64), 1))
    assert one.area[0, 0] == pytest.approx(area_of(mesh).sum(), rel=1e-12)
    assert got.area.sum() == pytest.approx(one.area[0, 0], rel=1e-12)


# Slivers and seams


def strip(width, texture_left=0.0):
    """A rectangle of 8 texels' height and ``width`` texels, from a column's left edge."""
    corners = (SQUARE * [width, 8] + [texture_left, 0]) / 8
    mesh = Mesh(
        np.column_stack([SQUARE * [width, 8], np.zeros(4)]), np.arange(4, dtype=np.int32)[None]
    )
    return mesh.triangles(), corners[[[0, 1, 2], [0, 2, 3]]]


def test_slivers_give_their_area_and_light_to_their_neighbour():
    mesh, texture = strip(3.03)
    got = texels(mapped(mesh, texture, 8))
    assert got.area[:, 2].sum() == pytest.approx(8 * 1.03)
    assert not got.area[:, 3].any()
    assert np.array_equal(got.inside, np.tile(np.arange(8) < 3, (8, 1)))
    assert (got.home[:, 3] % 8 == 2).all()
    assert got.place[:, 2, 0].mean() == pytest.approx((2.5 + 0.03 * 3.015) / 1.03)
    assert np.array_equal(got.home.ravel()[got.home], got.home)
    flux = np.random.default_rng(4).uniform(size=(8, 8))
    assert got.gathered(flux).sum() == pytest.approx(flux.sum())
    even = got.gathered(
        np.where(np.arange(8) < 3, 5.0, 0.0)
        + np.where(np.arange(8) == 3, 0.15, 0.0)
        + np.zeros((8, 1))
    )
    assert even[got.inside] / got.area[got.inside] == pytest.approx(np.full(24, 5.0))


def test_a_sliver_stays_in_its_chart():
    (left, near), (right, far) = strip(2.03), strip(4.0, texture_left=2.5)
    mesh = Mesh(
        np.concatenate([left.vertices, right.vertices + 10]),
        np.concatenate([left.faces, right.faces + 4]),
    )
    got = texels(mapped(mesh, np.concatenate([near, far]), 8))
    assert got.area[:, :2].sum() == pytest.approx(8 * 2.0)
    shared = texels(mapped(mesh, np.concatenate([near, far - [0.5 / 8, 0]]), 8))
    assert shared.area[:, 2].sum() == pytest.approx(8 * 1.03)  # a texel of both charts is one
    alone, thin = strip(0.03)
    lonely = texels(mapped(alone, thin, 8))
    assert lonely.inside[:, 0].all()
    assert lonely.area.sum() == pytest.approx(0.24)


def test_dust_is_kept_but_not_shown():
    mesh, texture = strip(5e-4)
    got = texels(mapped(mesh, texture, 8))
    assert got.area.sum() == pytest.approx(8 * 5e-4)
    assert not got.inside.any()


def test_light_that_rounding_lands_beside_a_chart_comes_home():
    got = texels(flat_square(0.25 + SQUARE / 2, 8))
    outside = (got.area == 0) & (got.home.ravel() != np.arange(64)).reshape(8, 8)
    assert np.count_nonzero(outside) == 6 * 6 - 4 * 4
    assert got.gathered(outside.astype(float))[got.area > 0].sum() == 20


def test_even_light_stays_even_over_seams():
    got = texels(unwrapped(cylinder(), 100))
    random = np.random.default_rng(5)
    flux = random.poisson(50 * 16 * got.area / got.area.max()) / 16
    value = got.gathered(flux)[got.inside] / got.area[got.inside] * got.area.max()
    assert value.mean() == pytest.approx(50, rel=0.02)
    assert value.max() < 50 * 1.6  # a sliver of 1 % would now and then be seen at 300


# Unwrapping

SHAPES = {
    "cylinder": cylinder(),
    "fine cylinder": cylinder(500, 100),
    "sphere": sphere(),
    "quad": sheet(1, 1, lambda a, b: (a, b, 0 * a)),
    "tilted quad": sheet(1, 1, lambda a, b: (a - b, a + b, 0.7 * a)),
    "waffle": waffle(200),
    "helix": helix(),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("resolution", [256, 512])
def test_every_shape_gets_a_map_without_overlap(shape, resolution):
    surface = unwrapped(SHAPES[shape], resolution)
    assert surface.texture.min() >= 0
    assert surface.texture.max() <= 1
    assert overlapping(surface) == 0
    require_chart(surface)
    assert density(surface).min() > 0.3  # none mirrored, none far from the mean
    assert density(surface).max() < 3
    got = texels(surface)
    assert got.area.sum() == pytest.approx(area_of(surface.mesh).sum(), rel=1e-9)
    assert np.array_equal(got.home.ravel()[got.home], got.home)


def test_the_texels_of_a_sphere_are_a_sphere():
    mesh = sphere(192, 96)
    got = texels(unwrapped(mesh, 256))
    assert got.area.sum() == pytest.approx(4 * np.pi * 0.1**2, rel=2e-3)
    place, normal = got.place[got.inside], got.normal[got.inside]
    assert np.linalg.norm(normal, axis=1) == pytest.approx(np.ones(len(normal)))
    assert np.linalg.norm(place, axis=1) == pytest.approx(np.full(len(place), 0.1), rel=2e-3)
    assert np.einsum("ij,ij->i", normal, place).min() > 0.0995
    middle = (got.area[..., None] * got.place).sum(axis=(0, 1))
    assert middle == pytest.approx(np.zeros(3), abs=1e-12)


def test_flat_faces_keep_their_shape_and_share_one_density():
    surface = unwrapped(SHAPES["waffle"], 1024)
    assert density(surface) == pytest.approx(np.ones(len(surface.mesh.faces)), rel=1e-6)
    edges = np.linalg.norm(np.roll(surface.texture, -1, axis=1) - surface.texture, axis=2)
    corners = surface.mesh.vertices[surface.mesh.faces]
    true = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    assert edges / true == pytest.approx(np.full_like(true, (edges / true).mean()), rel=1e-6)


@pytest.mark.parametrize("padding", [1, 2, 5])
def test_charts_keep_their_distance_also_across_the_border(padding):
    surface = unwrapped(cylinder(), 200, padding)
    face = texels(surface).face
    normal = np.cross(
        *np.diff(surface.mesh.vertices[surface.mesh.faces], axis=1).transpose(1, 0, 2)
    )
    chart = np.where(face >= 0, np.argmax([*normal.T, *-normal.T], axis=0)[face], -1)
    assert len(np.unique(chart)) == 5
    for other in range(6):
        grown = chart == other
        for axis in (0, 1):
            grown = np.any([np.roll(grown, k, axis) for k in range(-padding, padding + 1)], axis=0)
        assert not (grown & (chart >= 0) & (chart != other)).any()


def test_a_quad_stands_on_whole_texels():
    got = texels(unwrapped(SHAPES["quad"], 64))
    assert np.count_nonzero(got.area) == 62 * 62
    assert got.area[got.inside] == pytest.approx(np.full(62 * 62, 1 / 62**2))


def test_noise_in_the_normals_does_not_break_a_wall_up():
    wall = sheet(80, 80, lambda a, b: (a, 0 * a, b))
    random = np.random.default_rng(6)
    rough = Mesh(wall.vertices + random.normal(0, 0.0015, wall.vertices.shape), wall.faces)
    surface = unwrapped(rough, 256)
    assert overlapping(surface) == 0
    assert texels(surface).inside.mean() > 0.9


def test_triangles_that_share_no_vertices_still_share_charts():
    mesh = cylinder(32, 4)
    loose = Mesh(
        mesh.vertices[mesh.faces].reshape(-1, 3),
        np.arange(3 * len(mesh.faces), dtype=np.int32).reshape(-1, 3),
    )
    assert unwrap(loose, 256) == pytest.approx(unwrap(mesh, 256))


def test_faces_without_area_lie_on_the_chart_they_touch():
    quad = sheet(1, 1, lambda a, b: (a, b, 0 * a))
    faces = np.concatenate([quad.faces, [[0, 0, 1], [2, 2, 2], [4, 4, 4]]]).astype(np.int32)
    mesh = Mesh(np.concatenate([quad.vertices, [[9, 9, 9]]]), faces)
    surface = unwrapped(mesh, 64)
    require_chart(surface)
    assert np.array_equal(surface.texture[:2], unwrap(quad, 64))
    assert (surface.texture[2:] == surface.texture[2:, :1]).all()
    assert (surface.texture[2, 0] == surface.texture[:2].reshape(-1, 2)).all(axis=1).any()
    assert texels(surface).area.sum() == pytest.approx(1.0)


def test_where_charts_are_many_they_stand_closer():
    surface = unwrapped(waffle(200), 64)
    assert overlapping(surface) == 0
    with pytest.raises(SceneError, match=r"1200 separate pieces .* 32 texels a side; raise"):
        unwrap(waffle(200), 32)


@pytest.mark.parametrize("points", [np.zeros((3, 3)), np.eye(3) * np.nan])
def test_what_cannot_be_unwrapped_is_said(points):
    with pytest.raises(SceneError, match="cannot be unwrapped"):
        unwrap(Mesh(points, np.array([[0, 1, 2]], np.int32)), 64)


@pytest.mark.parametrize("place", [0.0, 0.5, 7.0, np.nan])
def test_where_a_face_without_area_is_in_the_map_does_not_matter(place):
    good = flat_square(SQUARE, 16)
    mesh = Mesh(good.mesh.vertices, np.concatenate([good.mesh.faces, [[0, 1, 1]]]).astype(np.int32))
    spread = place + np.array([[[0.0, 0.0], [0.4, 0.0], [0.0, 0.4]]])
    surface = mapped(mesh, np.concatenate([good.texture, spread]), 16)
    require_chart(surface)
    got = texels(surface)
    assert got.area == pytest.approx(texels(good).area)
    assert got.face.max() == 1
    values = got.place[..., 0]
    truth = at_vertices(good, values, texels(good))
    assert at_vertices(surface, values, got) == pytest.approx(truth)


# Whether it is a map


def two_squares(shift):
    (left, texture), (right, _) = strip(4.0), strip(4.0)
    mesh = Mesh(
        np.concatenate([left.vertices, right.vertices]),
        np.concatenate([left.faces, right.faces + 4]),
    )
    return mapped(mesh, np.concatenate([texture, texture + np.array([shift, 0])]), 64)


@pytest.mark.parametrize(("shift", "share"), [(0.5, 0.0), (0.25, 1 / 3), (0.0, 1.0)])
def test_overlap_is_found_and_measured(shift, share):
    assert overlapping(two_squares(shift)) == pytest.approx(share, abs=1e-9)


def test_each_fault_of_a_map_has_its_sentence():
    good = flat_square(SQUARE, 16)
    require_chart(good)
    require_chart(flat_square(SQUARE + 1e-6, 16))
    collapsed = np.concatenate([good.texture[:1], np.full((1, 3, 2), 0.5)])
    faults = {
        "has overlapping UVs \\(33 % of its map\\); unwrap it anew or clear": two_squares(0.25),
        "has UVs outside its map, from -0.5 to 1.5 where": flat_square(2 * SQUARE - 0.5, 16),
        "has UVs that are not numbers": flat_square(SQUARE * [np.nan, 1], 16),
        "has no area": flat_square(SQUARE, 16, size=0.0),
        "has vertices that are nowhere": flat_square(SQUARE, 16, size=np.nan),
        "no place in its UV map for 50 % of": mapped(good.mesh, collapsed, 16),
        "no place in its UV map for 100 % of": flat_square(0 * SQUARE, 16),
    }
    for sentence, surface in faults.items():
        with pytest.raises(SceneError, match=f"Receiver “Vase ä/1” .*{sentence}"):
            require_chart(surface)


def test_a_face_without_place_in_the_map_keeps_its_area():
    good = flat_square(SQUARE, 4)
    collapsed = np.concatenate([good.texture[:1], np.full((1, 3, 2), 0.9)])
    got = texels(mapped(good.mesh, collapsed, 4))
    assert got.area.sum() == pytest.approx(1.0)
    assert got.area[3, 3] == pytest.approx(0.5 + 1 / 32)


# Values


def test_padding_carries_the_nearest_value_as_far_as_asked():
    values = np.zeros((7, 9))
    inside = np.zeros((7, 9), dtype=bool)
    inside[3, 2], inside[3, 7] = True, True
    values[3, 2], values[3, 7], values[0, 0] = 5.0, 7.0, 99.0
    truth = np.zeros((7, 9))
    truth[1:6, 0:5], truth[1:6, 5:9] = 5.0, 7.0
    assert np.array_equal(padded(values, inside, 2), truth)
    colours = padded(np.stack([values, 2 * values], axis=-1), inside, 2)
    assert np.array_equal(colours, np.stack([truth, 2 * truth], axis=-1))
    assert np.array_equal(padded(values, inside, 0), np.where(inside, values, 0))
    assert not padded(values, np.zeros_like(inside), 3).any()


def test_a_linear_field_is_itself_at_the_vertices():
    mesh = sheet(40, 40, lambda a, b: (a, b, 0.3 * a))
    surface = unwrapped(mesh, 512)
    got = texels(surface)
    field = got.place @ [1.0, 2.0, 3.0] + 4.0
    truth = mesh.vertices @ [1.0, 2.0, 3.0] + 4.0
    value = at_vertices(surface, field, got)
    within = (np.abs(mesh.vertices[:, :2] - 0.5) < 0.49).all(axis=1)
    assert value[within] == pytest.approx(truth[within], abs=2e-3)
    assert value == pytest.approx(truth, abs=0.05)  # the border's lean inward by part of a face


@pytest.mark.parametrize("resolution", [24, 200])
def test_values_at_the_vertices_keep_the_flux(resolution):
    mesh = sphere(48, 24)
    surface = unwrapped(mesh, resolution)
    got = texels(surface)
    values = np.random.default_rng(7).uniform(100, 200, got.area.shape)
    share = np.bincount(mesh.faces.ravel(), np.repeat(area_of(mesh) / 3, 3), len(mesh.vertices))
    value = at_vertices(surface, values, got)
    assert value @ share == pytest.approx((values * got.area).sum(), rel=1e-9)
    assert value.min() >= 100
    assert value.max() <= 200


def test_a_vertex_without_faces_takes_the_nearest_value():
    quad = flat_square(SQUARE, 8)
    vertices = np.concatenate([quad.mesh.vertices, [[0.9, 0.1, 0.5]]])
    surface = mapped(Mesh(vertices, quad.mesh.faces), quad.texture, 8)
    got = texels(surface)
    value = at_vertices(surface, got.place[..., 0], got)
    assert value[4] == pytest.approx(15 / 16)
