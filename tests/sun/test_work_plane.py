"""Work planes by closed forms: areas of rooms less their margins, columns, walls and courtyards."""

import re
import time

import numpy as np
import pytest
from heliform.engines.core.atlas import texels
from heliform.engines.core.copies import joined
from heliform.engines.core.errors import ParameterError, SceneError
from heliform.engines.core.scene import Mesh, Surface
from heliform.engines.sun.work_plane import WorkPlane, over_faces, over_rooms
from sun.shades import box, sheet

ROOM = box("Room", (6, 4, 3), (3, 2, 1.5)).mesh


def block(x, y, z, width, length, height):
    """A box that stands at a corner."""
    size = width, length, height
    return box("Block", size, np.array([x, y, z]) + np.array(size) / 2).mesh


def plane(*meshes, over=over_rooms, **record):
    return over("Raum ä", joined(meshes), WorkPlane(**record))


def area(found):
    mesh = found.textured.mesh
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a) / 2
    assert (normals[:, 2] > 0).all()
    assert np.abs(normals[:, :2]).max() < 1e-9
    return normals[:, 2].sum()


def heights(found):
    return sorted(set(found.textured.mesh.vertices[:, 2].round(4)))


def inside_out(mesh):
    return Mesh(mesh.vertices, mesh.faces[:, ::-1].copy())


@pytest.mark.parametrize("room", [ROOM, inside_out(ROOM)])
@pytest.mark.parametrize("margin", [0.0, 0.5, 1.0])
def test_a_box_less_its_margin(room, margin):
    found = plane(room, margin=margin)
    assert area(found) == pytest.approx((6 - 2 * margin) * (4 - 2 * margin), rel=1e-5)
    assert heights(found) == [0.8]
    assert found.texels == 12 - 4 * margin


def test_where_it_stands_and_how_it_is_turned_do_not_matter():
    turn, shift = np.radians(37), np.array([1000.0, -2000, 50])
    about = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    moved = Mesh(ROOM.vertices @ about.T + shift, ROOM.faces)
    found = plane(moved)
    assert area(found) == pytest.approx(15, rel=1e-3)
    assert heights(found) == [50.8]
    assert found.texels == 10


def test_walls_of_thickness_have_an_inside():
    """The underside, the roof and the outer walls are no floor."""
    shell = joined([block(-0.3, -0.3, -0.3, 6.6, 4.6, 3.6), inside_out(ROOM)])
    assert area(plane(shell)) == pytest.approx(15, rel=1e-5)


def test_a_slab_alone_is_stood_on():
    found = plane(block(0, 0, 0, 6, 4, 0.2))
    assert (area(found), heights(found)) == (pytest.approx(15), [1.0])


def test_a_sheet_alone_is_stood_on():
    assert area(plane(sheet("F", [[0, 0, 0], [6, 0, 0], [6, 4, 0], [0, 4, 0]]).mesh)) == 15


def test_an_l_shaped_room():
    x, y = np.array([0, 6, 6, 2, 2, 0.0]), np.array([0, 0, 2, 2, 4, 4.0])
    low = np.stack([x, y, 0 * x], 1)
    floor = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], np.int32)
    vertices = np.concatenate([low, low + np.array([0, 0, 3])])
    k = np.arange(6)
    walls = np.stack([k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6], 1).astype(np.int32)
    room = joined([Mesh(vertices, np.concatenate([floor, floor + 6])), Mesh(vertices, walls)])
    # An inset by mitres takes the margin along all sides and gives it back at the inner corner.
    assert area(plane(room)) == pytest.approx(16 - 0.5 * 20 + 4 * 0.25, rel=1e-5)


@pytest.mark.parametrize("foot", [0.0, 0.002])
def test_a_column_is_kept_off(foot):
    column = block(2.5, 1.5, foot, 0.6, 0.4, 3 - foot)
    expected = 5 * 3 - 1.6 * 1.4
    assert area(plane(ROOM, column)) == pytest.approx(expected, rel=1e-4)


def test_a_table_and_a_carpet_are_not():
    table, carpet = block(2, 1, 0.7, 1.6, 0.8, 0.04), block(1, 1, 0, 2, 2, 0.02)
    found = plane(ROOM, table, carpet)
    assert (area(found), heights(found)) == (pytest.approx(15), [0.8])


def test_an_inner_wall_parts_the_room():
    wall = sheet("W", [[3, 0, 0], [3, 4, 0], [3, 4, 3], [3, 0, 3]]).mesh
    assert area(plane(ROOM, wall)) == pytest.approx(2 * 2 * 3, rel=1e-4)
    assert area(plane(ROOM, block(2.9, 0, 0, 0.2, 4, 3))) == pytest.approx(2 * 1.9 * 3, rel=1e-4)


def test_walls_on_a_slab_have_a_room_between_them():
    slab = block(-2, -2, -0.3, 10, 8, 0.3)
    walls = [block(0, 0, 0, 6, 0.2, 3), block(0, 3.8, 0, 6, 0.2, 3)]
    walls += [block(0, 0.2, 0, 0.2, 3.6, 3), block(5.8, 0.2, 0, 0.2, 3.6, 3)]
    within = (6 - 0.4 - 1) * (4 - 0.4 - 1)
    around = 9 * 7 - 7 * 5
    assert area(plane(slab, *walls)) == pytest.approx(within + around, rel=1e-4)


def test_a_courtyard_is_left_open():
    ring = [(0, 0, 9, 2), (0, 7, 9, 2), (0, 2, 2, 5), (7, 2, 2, 5)]
    floors = [
        sheet("F", [[x, y, 0], [x + w, y, 0], [x + w, y + d, 0], [x, y + d, 0]]).mesh
        for x, y, w, d in ring
    ]
    assert area(plane(*floors)) == pytest.approx(8 * 8 - 6 * 6, rel=1e-5)


def test_faces_that_are_there_twice_or_overlap_count_once():
    floor = sheet("F", [[0, 0, 0], [6, 0, 0], [6, 4, 0], [0, 4, 0]]).mesh
    beside = sheet("F", [[4, 0, 0], [8, 0, 0], [8, 4, 0], [4, 4, 0]]).mesh
    assert area(plane(floor, inside_out(floor))) == pytest.approx(15)
    assert area(plane(floor, beside, over=over_faces, margin=0.0)) == pytest.approx(40)


def test_a_floor_of_many_faces_is_as_quick(record_property):
    count = 100
    x, y = np.meshgrid(np.linspace(0, 6, count + 1), np.linspace(0, 4, count + 1))
    vertices = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    first = np.arange(count * (count + 1)).reshape(count, -1)[:, :count].ravel()
    corners = [first, first + 1, first + count + 2, first + count + 1]
    started = time.perf_counter()
    found = plane(Mesh(vertices, np.stack(corners, axis=1).astype(np.int32)))
    record_property("seconds", time.perf_counter() - started)
    assert area(found) == pytest.approx(15, rel=1e-4)
    assert time.perf_counter() - started < 3


def test_rooms_at_two_levels_side_by_side():
    higher = block(6, 0, 0.45, 6, 4, 3)
    found = plane(ROOM, higher)
    assert (area(found), heights(found)) == (pytest.approx(30), [0.8, 1.25])


def test_chosen_faces_are_the_floor_whatever_is_over_them():
    upper = sheet("F", [[0, 0, 3], [6, 0, 3], [6, 4, 3], [0, 4, 3]]).mesh
    lower = sheet("F", [[0, 0, 0], [6, 0, 0], [6, 4, 0], [0, 4, 0]]).mesh
    found = plane(lower, upper, over=over_faces, height=0.1, margin=0.0)
    assert (area(found), heights(found)) == (pytest.approx(48), [0.1, 3.1])


@pytest.mark.parametrize("spacing", [0.5, 0.4, 0.3])
def test_sensors_are_as_far_apart_as_was_asked_for(spacing):
    found = plane(ROOM, block(2.5, 1.5, 0, 0.6, 0.4, 3), spacing=spacing)
    mesh, texture = found.textured.mesh, found.textured.texture
    surface = Surface("Plane", mesh, texture, found.texels, found.texels)
    grid = texels(surface)
    assert grid.area.sum() == pytest.approx(area(found), rel=1e-4)
    assert grid.area.max() == pytest.approx(spacing**2, rel=1e-3)
    assert np.isfinite(texture).all()


@pytest.mark.parametrize(
    ("meshes", "record", "error", "said"),
    [
        (
            [sheet("W", [[0, 0, 0], [1, 0, 0], [1, 0, 3], [0, 0, 3]]).mesh],
            {},
            SceneError,
            "“Raum ä” has no horizontal floor; choose",
        ),
        ([ROOM], {"margin": 2.0}, SceneError, "A margin of 2 m leaves nothing of the floor of"),
        ([ROOM], {"spacing": 0.001}, ParameterError, "makes 5000 sensors along “Raum ä”; allowed"),
        ([Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))], {}, SceneError, "no horizontal floor"),
    ],
)
def test_what_cannot_be_is_said(meshes, record, error, said):
    with pytest.raises(error, match=re.escape(said)):
        plane(*meshes, **record)


def test_upright_faces_are_no_floor():
    wall = sheet("W", [[0, 0, 0], [1, 0, 0], [1, 0, 3], [0, 0, 3]]).mesh
    with pytest.raises(SceneError, match="are upright"):
        plane(wall, over=over_faces)
