"""Members as solids: closed, of the right volume, meeting at their nodes, and coloured singly."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.scene import Mesh
from heliform.engines.structure.fins import deformed, fin_vertices, member_solids
from heliform.engines.structure.joints import node_normals
from heliform.engines.structure.member_texture import LARGEST, image_of, layout_of
from heliform.engines.structure.sections import (
    circular_hollow,
    i_section,
    joined_sections,
    rectangle,
    rectangular_hollow,
)
from structure.waffles import model, prism, waffle

FLAT = waffle(3, 3, 3.0, 3.0)
DOME = waffle(6, 6, 12.0, 12.0, lambda x, y: 0.03 * (x * (12 - x) + y * (12 - y)))


def fins_of(frame, height=0.4, width=0.1, **options):
    count = len(frame.members)
    return member_solids(frame, rectangle(np.full(count, height), np.full(count, width)), **options)


def volumes(fins):
    """Volume of each member's solid by the divergence theorem."""
    triangles = fins.mesh.triangles()
    a, b, c = np.moveaxis(triangles.vertices[triangles.faces], 1, 0)
    parts = np.einsum("ti,ti->t", a, np.cross(b, c)) / 6
    return np.bincount(np.repeat(fins.member, 2), parts)


def all_shapes():
    """Four members of 3 m, far apart, one of each shape, tilted and with slanted normals."""
    rng = np.random.default_rng(2)
    along = rng.normal(size=(4, 3))
    along *= 3 / np.linalg.norm(along, axis=1)[:, None]
    starts = np.arange(4)[:, None] * [10.0, 0, 0]
    nodes = np.stack([starts, starts + along], axis=1).reshape(-1, 3)
    made = model(nodes, np.arange(8).reshape(4, 2), [], rng.normal(size=(4, 3)))
    sections = joined_sections(
        [
            i_section(0.3, 0.15, 0.01, 0.02, 0.0),
            rectangle(0.4, 0.08),
            circular_hollow(0.2, 0.01),
            rectangular_hollow(0.3, 0.2, 0.01),
        ]
    )
    return made.frame, sections


@pytest.mark.parametrize("joint", ["mitred", "overlapped"])
@pytest.mark.parametrize("stations", [2, 5])
@pytest.mark.parametrize("frame", [FLAT.frame, DOME.frame, prism().frame, all_shapes()[0]])
def test_every_solid_is_closed_and_its_faces_look_out(frame, stations, joint):
    fins = fins_of(frame, joint=joint, stations=stations)
    edges = np.stack([fins.mesh.faces, np.roll(fins.mesh.faces, -1, axis=1)], -1).reshape(-1, 2)
    there, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 1).all()
    assert np.array_equal(there, np.unique(edges[:, ::-1], axis=0))
    owner = fins.vertex_member[fins.mesh.faces]
    assert (owner == fins.member[:, None]).all()
    assert (volumes(fins) > 0).all()


def test_prisms_of_every_shape_have_the_volume_of_their_outline():
    frame, sections = all_shapes()
    fins = member_solids(frame, sections)
    flanged = sections.area[0]
    twelve_corners = 12 / 2 * 0.1**2 * np.sin(np.pi / 6)
    expected = 3 * np.array([flanged, 0.4 * 0.08, twelve_corners, 0.3 * 0.2])
    assert volumes(fins) == pytest.approx(expected, rel=1e-12)
    assert np.unique(fins.member).tolist() == [0, 1, 2, 3]


def test_the_height_is_measured_along_the_normal():
    made = model([[0, 0, 0], [2, 0, 0.0]], [(0, 1)], [], np.array([[0.0, 1.0, 0.0]]))
    extent = np.ptp(fins_of(made.frame, 0.6, 0.1).mesh.vertices, axis=0)
    assert extent == pytest.approx([2.0, 0.6, 0.1])


def test_mitred_ribs_fill_a_flat_waffle_once():
    # Crossings are square, ends of ribs reach the outer faces of the edge ribs.
    found = volumes(fins_of(FLAT.frame)).sum()
    assert found == pytest.approx(0.4 * (3.1**2 - 9 * 0.9**2), rel=1e-12)
    overlapping = volumes(fins_of(FLAT.frame, joint="overlapped")).sum()
    assert overlapping == pytest.approx(0.4 * 0.1 * 24, rel=1e-12)


def end_faces(fins, node, frame):
    """The end faces at a node as sets of their corners, rounded to 0.1 µm."""
    stations = fins.vertex_station[fins.mesh.faces]
    caps = (stations == stations[:, :1]).all(axis=1)
    end = stations[:, 0] > 0
    at = caps & (frame.members[fins.member, end.astype(int)] == node)
    corners = np.round(fins.mesh.vertices[fins.mesh.faces[at]] * 1e7).astype(int)
    return [frozenset(map(tuple, face)) for face in corners]


@pytest.mark.parametrize(("made", "node"), [(FLAT, 5), (DOME, 24)])
def test_faces_of_neighbours_coincide_at_a_mitred_crossing(made, node):
    fins = fins_of(made.frame, normals=node_normals(made.frame, made.cells))
    faces = end_faces(fins, node, made.frame)
    assert len(faces) == 8
    assert sorted(faces.count(face) for face in faces) == [2] * 8


def test_ribs_of_unlike_widths_meet_without_a_gap():
    frame = FLAT.frame
    along = np.abs(frame.axes()[:, 0, 0]) > 0.5
    widths = np.where(along, 0.06, 0.15)
    fins = member_solids(frame, rectangle(np.full(len(widths), 0.4), widths))
    faces = end_faces(fins, 5, frame)
    assert sorted(faces.count(face) for face in faces) == [2] * 8
    openings = (0.85 * 0.94) * 9
    outer = (3 + 0.15) * (3 + 0.06)
    assert volumes(fins).sum() == pytest.approx(0.4 * (outer - openings), rel=1e-12)


@pytest.mark.parametrize("degrees", [30.0, 60.0, 72.0, 90.0, 144.0, 179.9])
def test_two_members_of_equal_width_meet_in_the_bisecting_plane(degrees):
    turn = np.radians(degrees)
    nodes = [[2, 0, 0], [0, 0, 0], [2 * np.cos(turn), 2 * np.sin(turn), 0]]
    made = model(nodes, [(0, 1), (1, 2)], [])
    fins = fins_of(made.frame, 0.3, 0.1)
    faces = end_faces(fins, 1, made.frame)
    assert sorted(faces.count(face) for face in faces) == [2] * 4
    # What a mitre takes inside it adds outside.
    assert volumes(fins) == pytest.approx([0.06, 0.06], rel=1e-12)


def test_a_mitre_that_would_be_too_sharp_stops_short():
    turn = np.radians(2.0)
    nodes = [[2, 0, 0], [0, 0, 0], [2 * np.cos(turn), 2 * np.sin(turn), 0]]
    made = model(nodes, [(0, 1), (1, 2)], [])
    fins = fins_of(made.frame, 0.3, 0.1)
    assert fins.mesh.vertices[:, 0].min() >= -0.21
    assert (volumes(fins) > 0).all()


def test_a_column_ends_square_under_the_ribs_it_carries():
    nodes = np.concatenate([FLAT.frame.nodes, [[1, 1, -3.0]]])
    members = np.concatenate([FLAT.frame.members, [[16, 5]]])
    normals = np.concatenate([FLAT.frame.normals, [[1.0, 0, 0]]])
    made = model(nodes, members, FLAT.cells, normals)
    fins = fins_of(made.frame)
    alone = fins_of(FLAT.frame)
    assert volumes(fins)[:-1] == pytest.approx(volumes(alone), rel=1e-12)
    assert volumes(fins)[-1] == pytest.approx(0.4 * 0.1 * 3)


def test_turned_members_stay_closed_and_near_their_axes():
    rolled = DOME.frame.axes()
    normals = np.cos(1.0) * rolled[:, 2] + np.sin(1.0) * rolled[:, 1]
    frame = replace(DOME.frame, normals=normals)
    fins = fins_of(frame, normals=node_normals(DOME.frame, DOME.cells))
    assert (volumes(fins) > 0).all()
    ends = frame.ends()[fins.vertex_member]
    nearest = np.linalg.norm(ends - fins.mesh.vertices[:, None], axis=2).min(axis=1)
    assert nearest.max() < 0.9


def test_normals_of_nodes_are_those_of_the_cells_or_of_the_members():
    expected = np.array([0, 0, 1.0])
    assert node_normals(FLAT.frame, FLAT.cells) == pytest.approx(np.tile(expected, (16, 1)))
    nodes = np.concatenate([FLAT.frame.nodes, [[1, 1, -3.0]]])
    members = np.concatenate([FLAT.frame.members, [[16, 5]]])
    normals = np.concatenate([FLAT.frame.normals, [[1.0, 0, 0]]])
    made = model(nodes, members, [], normals)
    assert node_normals(made.frame)[5] == pytest.approx(expected)
    assert node_normals(made.frame)[16] == pytest.approx([1, 0, 0])


def test_positions_alone_are_those_of_the_mesh():
    frame, sections = all_shapes()
    for joint in ("mitred", "overlapped"):
        fins = member_solids(frame, sections, joint, 4)
        assert np.array_equal(fin_vertices(frame, sections, joint, 4), fins.mesh.vertices)


@pytest.mark.parametrize(("members", "rows", "columns"), [(7, 7, 5), (LARGEST + 1, LARGEST, 10)])
def test_each_member_shows_its_own_values(members, rows, columns):
    layout = layout_of(members, 5)
    assert (layout.rows, layout.columns) == (rows, columns)
    values = np.random.default_rng(1).uniform(size=(members, 5))
    image = image_of(values, layout)
    assert image.shape == (rows, columns)
    member = np.array([0, members // 2, members - 1])
    for along, expected in [(0.0, values[:, 0]), (0.75, values[:, 3]), (1.0, values[:, 4])]:
        u, v = layout.coordinates(member, np.full(3, along)).T
        # In the middle of its texel an interpolated image shows that texel alone.
        row, column = v * rows - 0.5, u * columns - 0.5
        assert row == pytest.approx(np.round(row), abs=1e-6)
        assert column == pytest.approx(np.round(column), abs=1e-6)
        shown = image[np.round(row).astype(int), np.round(column).astype(int)]
        assert np.array_equal(shown, expected[member])


def test_the_textures_of_faces_run_along_their_member():
    frame, sections = all_shapes()
    fins = member_solids(frame, sections, stations=3, layout=layout_of(4, 9))
    along = fins.vertex_station[fins.mesh.faces] / 2
    expected = (0.5 + along * 8) / 9
    assert fins.texture[..., 0] == pytest.approx(expected)
    assert fins.texture[..., 1] == pytest.approx((fins.member[:, None] + 0.5) / 4 + 0 * along)


def test_more_members_than_an_image_holds_are_refused():
    with pytest.raises(ParameterError, match="show at most"):
        layout_of(10_000_000, 11)


def test_without_displacements_nothing_moves():
    fins = fins_of(DOME.frame, stations=4)
    count = len(DOME.frame.members)
    still = deformed(fins, DOME.frame, np.zeros((count, 4, 3)), np.zeros((count, 2, 3)), 50.0)
    assert still == pytest.approx(fins.mesh.vertices, abs=1e-12)


def test_a_rigid_motion_moves_solids_rigidly():
    fins = fins_of(DOME.frame, stations=5)
    turn, shift = np.array([0.02, -0.01, 0.03]) * 1e-3, np.array([0.1, 0.2, -0.3])
    ends = DOME.frame.ends()
    t = np.linspace(0, 1, 5)[:, None]
    axis = ends[:, :1] + t * (ends[:, 1:] - ends[:, :1])
    rotations = np.broadcast_to(turn, (len(ends), 2, 3))
    found = deformed(fins, DOME.frame, shift + np.cross(turn, axis), rotations)
    expected = fins.mesh.vertices + shift + np.cross(turn, fins.mesh.vertices)
    assert found == pytest.approx(expected, abs=1e-8)


def test_solids_that_meet_stay_together_when_they_bend():
    fins = fins_of(FLAT.frame, stations=3)
    rng = np.random.default_rng(3)
    shifts, turns = rng.normal(size=(2, 16, 3)) * 0.02
    members = FLAT.frame.members
    deflections = np.stack(
        [shifts[members[:, 0]], rng.normal(size=(24, 3)) * 0.02, shifts[members[:, 1]]], axis=1
    )
    moved = deformed(fins, FLAT.frame, deflections, turns[members], 5.0)
    bent = replace(fins, mesh=Mesh(moved, fins.mesh.faces))
    faces = end_faces(bent, 5, FLAT.frame)
    assert sorted(faces.count(face) for face in faces) == [2] * 8


def test_cross_sections_follow_the_slope_of_a_bent_member():
    made = model([[0, 0, 0], [4, 0, 0.0]], [(0, 1)], [])
    fins = fins_of(made.frame, 0.2, 0.1, stations=101)
    x = np.linspace(0, 4, 101)
    bend, slope = 1e-4 * x**2 * (4 - x), 1e-4 * (8 * x - 3 * x**2)
    deflections = np.stack([0 * x, 0 * x, bend], -1)[None]
    rotations = np.array([[[0, -slope[0], 0], [0, -slope[-1], 0]]])
    moved = deformed(fins, made.frame, deflections, rotations)
    r = fins.mesh.vertices
    expected = -slope[fins.vertex_station] * r[:, 2]
    assert moved[:, 0] - r[:, 0] == pytest.approx(expected, abs=2e-7)
