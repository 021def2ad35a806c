"""Where sensors stand, and the area they stand for."""

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError, SceneError
from heliform.engines.core.scene import Mesh, Plane, Receiver, Scene, Surface, plane_receiver
from heliform.engines.core.unwrap import unwrap
from heliform.engines.sun.periods import Period
from heliform.engines.sun.radiation import Radiation, study_radiation
from heliform.engines.sun.sensors import at_points, joined, of_receiver, on_mesh, on_plane
from sun.shades import box


def test_a_grid_covers_its_plane():
    pose = np.eye(4)
    pose[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    pose[:3, 3] = 1, 2, 3
    grid = on_plane(pose, 6, 4, 0.5, offset=0.01)
    assert grid.shape == (8, 12)
    assert grid.areas.sum() == pytest.approx(24)
    assert grid.points.mean(axis=0) == pytest.approx([1, 2, 3])
    assert (grid.normals == pose[:3, 2]).all()
    assert grid.origins[0] == pytest.approx(grid.points[0] + 0.01 * pose[:3, 2])
    along = grid.spread(grid.points)
    assert along[0, 1] - along[0, 0] == pytest.approx(0.5 * pose[:3, 0])
    assert along[1, 0] - along[0, 0] == pytest.approx(0.5 * pose[:3, 1])


@pytest.mark.parametrize("sizes", [(0, 1, 1), (1, 1, 0), (1, -1, 1), (1, 1, np.nan)])
def test_a_grid_without_cells_is_refused(sizes):
    with pytest.raises(ParameterError, match="no cells"):
        on_plane(np.eye(4), *sizes)


def test_faces_have_a_sensor_at_their_centroid():
    mesh = box("Box", (2, 3, 4), (5, 5, 5)).mesh
    for some in (on_mesh("Box", mesh), on_mesh("Box", mesh.triangles())):
        assert some.areas.sum() == pytest.approx(52)
        outward = np.einsum("ni,ni->n", some.normals, some.points - 5)
        assert sorted(np.unique(outward.round(9))) == [1, 1.5, 2]
    trapezium = np.array([[0, 0, 0], [4, 0, 0], [2, 2, 0], [0, 2, 0.0]])
    one = on_mesh("Face", Mesh(trapezium, np.array([[0, 1, 2, 3]], np.int32)))
    assert one.points[0] == pytest.approx([28 / 18, 8 / 9, 0])
    assert one.areas == pytest.approx(6)


def test_vertices_share_the_area():
    mesh = box("Box", (1, 1, 1), (0, 0, 0)).mesh
    some = on_mesh("Box", mesh, per="vertex")
    assert some.areas.sum() == pytest.approx(6)
    assert (np.sign(some.normals) == np.sign(some.points)).all()
    assert np.linalg.norm(some.normals, axis=1) == pytest.approx(1)


def test_faces_without_area_are_left_out_and_said():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], float)
    mesh = Mesh(vertices, np.array([[0, 1, 3], [0, 1, 2], [2, 2, 1]], np.int32))
    some = on_mesh("Roof", mesh)
    assert some.home.tolist() == [1]
    assert some.notes == ("“Roof”: 2 faces have no area and no sensor.",)
    assert np.isnan(some.spread(np.array([5.0]))).tolist() == [True, False, True]
    assert on_mesh("Roof", mesh, per="vertex").home.tolist() == [0, 1, 2]
    with pytest.raises(SceneError, match="“Flat” has no face with an area"):
        on_mesh("Flat", Mesh(vertices, np.array([[0, 1, 3]], np.int32)))


def test_a_mesh_that_is_nowhere_is_refused():
    mesh = Mesh(np.array([[0, 0, 0], [1, 0, 0], [0, np.inf, 0]]), np.array([[0, 1, 2]], np.int32))
    with pytest.raises(SceneError, match="“Roof” has vertices that are not finite"):
        on_mesh("Roof", mesh)


def test_points_without_a_direction_are_refused():
    with pytest.raises(SceneError, match=r"Sensor 1 \(1 in all\)"):
        at_points(np.zeros((2, 3)), [[0, 0, 2], [0, 0, 0]])
    assert at_points([[0, 0, 0]], [[0, 0, 2]]).normals.tolist() == [[0, 0, 1]]


def test_a_receiver_has_a_sensor_a_texel():
    plane = Plane(width=2, length=1, resolution=8, sides="both")
    some = of_receiver(plane_receiver("Floor", plane, np.eye(4)))
    assert some.shape == (2, 4, 8)
    sides = some.spread(some.normals)
    assert (sides[0] == [0, 0, 1]).all()
    assert (sides[1] == [0, 0, -1]).all()
    assert some.areas.sum() == pytest.approx(4)


def test_a_mesh_has_a_sensor_where_its_map_shows_something():
    """A right triangle on the lower half of its map, upright in space."""
    corners = np.array([[0, 0, 0], [2, 0, 0], [0, 0, 2.0]])
    mesh = Mesh(corners, np.array([[0, 1, 2]], np.int32))
    surface = Surface("Sail", mesh, corners[None, :, [0, 2]] / 2, 4, 4)
    some = of_receiver(surface)
    assert some.areas.sum() == pytest.approx(2)
    assert some.normals == pytest.approx(np.tile([0, -1, 0], (len(some), 1)))
    places = some.spread(some.points)
    assert places[0, 0] == pytest.approx([0.25, 0, 0.25])
    assert places[1, 2] == pytest.approx([1 + 1 / 6, 0, 0.5 + 1 / 6])
    assert np.isnan(places[3, 3]).all()
    with pytest.raises(SceneError, match="“Sail” has no place in its UV map"):
        of_receiver(Surface("Sail", mesh, np.zeros((1, 3, 2)), 4, 4))


def test_sensors_are_joined_in_order():
    receiver = Receiver("A", np.zeros(3), np.eye(3)[0], np.eye(3)[1], 2, 2)
    both = joined(of_receiver(receiver), at_points([[9, 9, 9]], [[1, 0, 0]], offset=0.5))
    assert len(both) == 5
    assert both.offset == 0.5
    assert both.points[-1].tolist() == [9, 9, 9]
    assert both.some(slice(4, None)).normals.tolist() == [[1, 0, 0]]


def dome(panels, texels):
    """A ball's cap of 10 m, 20 m across, its map that of its plan; quadrilaterals are warped."""
    across = np.linspace(-10, 10, panels + 1)
    x, y = (grid.ravel() for grid in np.meshgrid(across, across, indexing="ij"))
    points = np.stack([x, y, np.sqrt(400 - x**2 - y**2)], axis=1)
    i, j = (grid.ravel() for grid in np.meshgrid(range(panels), range(panels), indexing="ij"))
    first = i * (panels + 1) + j
    faces = np.stack([first, first + panels + 1, first + panels + 2, first + 1], axis=1)
    mesh = Mesh(points, faces.astype(np.int32))
    triangles = mesh.triangles()
    texture = (points[:, :2] / 20 + 0.5)[triangles.faces]
    return mesh, Surface("Dome", triangles, texture, texels, texels)


@pytest.mark.parametrize("texels", [1, 7, 16, 33])
def test_sensors_lie_on_a_surface_that_bends(texels):
    mesh, surface = dome(8, texels)
    for some in (of_receiver(surface), on_mesh("Dome", mesh)):
        apart = distance(some.points, surface.mesh, some.normals)
        assert apart == pytest.approx(np.zeros(len(some)), abs=1e-12)
    assert some.areas.sum() == pytest.approx(of_receiver(surface).areas.sum())


@pytest.mark.parametrize("texels", [7, 16, 33])
def test_nothing_hides_the_sky_from_a_surface_that_bends_outward(texels):
    _, surface = dome(8, texels)
    period = Period(span="summer solstice")
    maps = study_radiation(Scene((), (), (surface,)), Radiation(period=period)).maps[0].maps
    there = np.isfinite(maps["total"])
    assert maps["total"][there] == pytest.approx(maps["open"][there], rel=2e-3)


def distance(points, mesh, normals):
    """From points (N, 3) to the nearest of the triangles that look as they do, and hold them."""
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    upright = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    found = np.full((len(points), len(a)), np.inf)
    held = normals @ upright.T > 1 - 1e-12
    for one, two in ((a, b), (b, c), (c, a)):
        side = np.cross(two - one, points[:, None] - one)
        held &= np.einsum("nfi,fi->nf", side, upright) > -1e-9
    off = np.abs(np.einsum("nfi,fi->nf", points[:, None] - a, upright))
    found[held] = off[held]
    return found.min(axis=1)


@pytest.mark.parametrize("texels", [256, 64, 32])
def test_a_map_read_coarsely_keeps_every_sensor_on_its_face(texels):
    """The sides of a box share texels where its map was made for finer ones."""
    mesh = box("Box", (10, 6, 4), (0, 0, 0)).mesh.triangles()
    some = of_receiver(Surface("Box", mesh, unwrap(mesh, 256), texels, texels))
    sides = np.abs(some.points) / [5, 3, 2]
    axis = np.abs(some.normals).argmax(axis=1)
    assert sides[np.arange(len(some)), axis] == pytest.approx(np.ones(len(some)))
    assert sides.max() <= 1 + 1e-12
    assert some.areas.sum() == pytest.approx(248)
    upward = some.areas[some.normals[:, 2] > 0.5].sum()
    assert upward == pytest.approx(60, rel=0.02)


def test_a_warped_quadrilateral_is_measured_on_its_larger_triangle():
    corners = np.array([[0, 0, 0], [3, 0, 0], [2, 2, 0], [0, 2, 1.0]])
    some = on_mesh("Panel", Mesh(corners, np.array([[0, 1, 2, 3]], np.int32)))
    assert some.normals[0] == pytest.approx([0, 0, 1])
    assert some.points[0, 2] == pytest.approx(0)
    assert some.areas[0] == pytest.approx(3 + np.linalg.norm(np.cross([2, 2, 0], [0, 2, 1])) / 2)


def test_faces_without_area_have_no_texel_and_are_said():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], float)
    mesh = Mesh(vertices, np.array([[0, 1, 3], [0, 1, 2], [2, 2, 1]], np.int32))
    some = of_receiver(Surface("Roof", mesh, vertices[mesh.faces][..., :2] / 2, 4, 4, "both"))
    assert some.notes == ("“Roof”: 2 faces have no area and no sensor.",)


@pytest.mark.parametrize("texels", [4, 16, 300])
def test_a_map_whose_faces_share_their_place_is_refused(texels):
    """As a mirror modifier leaves them: half the faces would have no sensor of their own."""
    mesh = box("Box", (1, 1, 1), (0, 0, 0)).mesh.triangles()
    texture = np.tile(np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1.0]]]), (6, 1, 1))
    with pytest.raises(SceneError, match=r"“Box” has overlapping UVs \(100 % of its map\)"):
        of_receiver(Surface("Box", mesh, texture, texels, texels))
    with pytest.raises(SceneError, match="“Box” has UVs outside its map"):
        of_receiver(Surface("Box", mesh, texture + 1, texels, texels))


def test_a_mesh_without_faces_is_refused():
    nothing = Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    with pytest.raises(SceneError, match="“Nothing” has no area"):
        of_receiver(Surface("Nothing", nothing, np.zeros((0, 3, 2)), 4, 4))
