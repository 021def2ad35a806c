"""Structures from the edges of a mesh."""

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure.frame import FIXED, HINGED
from heliform.engines.structure.from_mesh import Network, model_from_edges
from heliform.engines.structure.model import NO_NODE
from heliform.engines.structure.shell import Shell, shell_model

TENT = np.array([[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0], [2, 1.5, 2.0]])
EDGES = [[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]]
FACES = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]


def test_a_tent_is_held_where_it_is_lowest():
    model = model_from_edges(TENT, EDGES, FACES)
    assert np.array_equal(model.frame.members, EDGES)
    assert (model.frame.held[:4] == HINGED).all()
    assert not model.frame.held[4].any()
    assert (model.cells[:, 3] == NO_NODE).all()
    assert model.notes == ()
    higher = model_from_edges(TENT, EDGES, FACES, Network(within=2.0, base="fixed"))
    assert (higher.frame.held == FIXED).all()


def test_normals_are_those_of_the_faces_beside_a_member():
    model = model_from_edges(TENT, EDGES, FACES)
    front = np.cross([4, 0, 0], [2, 1.5, 2])
    assert model.frame.normals[0] == pytest.approx(front / np.linalg.norm(front))
    right = np.cross([0, 3, 0], [-2, 1.5, 2])
    ridge = front + right
    assert model.frame.normals[5] == pytest.approx(ridge / np.linalg.norm(ridge))
    assert np.array_equal(model_from_edges(TENT, EDGES).frame.normals, [[0, 0, 1.0]] * 8)


@pytest.mark.parametrize("pattern", ["waffle", "triangulated", "diagonal"])
def test_the_mesh_of_a_shell_gives_the_shell_back(pattern):
    shell = shell_model(Shell(pattern=pattern, spacing=1.0))
    faces = [[n for n in cell if n != NO_NODE] for cell in shell.cells.tolist()]
    model = model_from_edges(shell.frame.nodes, shell.frame.members, faces)
    assert np.array_equal(model.frame.members, shell.frame.members)
    assert np.array_equal(model.cells, shell.cells)
    assert np.array_equal(model.frame.held, shell.frame.held)
    assert np.array_equal(model.frame.nodes, shell.frame.nodes)
    near = np.einsum("mi,mi->m", model.frame.normals, shell.frame.normals)
    assert near.min() > 0.99
    assert model.surface == pytest.approx(shell.surface, abs=0.05)


def test_the_boundary_of_a_mesh_is_where_edges_have_one_face():
    shell = shell_model(Shell(cells_along=5, cells_across=4))
    model = model_from_edges(
        shell.frame.nodes, shell.frame.members, shell.cells.tolist(), Network(supports="boundary")
    )
    rim = np.isclose(np.abs(shell.frame.nodes[:, :2]) / (12, 7.5), 1).any(axis=1)
    assert np.array_equal(model.frame.held.any(axis=1), rim)
    branch = model_from_edges(TENT, [[0, 4], [1, 4], [2, 4]], network=Network(supports="boundary"))
    assert branch.frame.held.any(axis=1).tolist() == [True, True, True, False]


def test_given_nodes_are_held_by_the_indices_of_the_mesh():
    nodes = np.vstack([[[9, 9, 9]], TENT])  # a loose vertex first
    network = Network(supports="given", chosen="1, 3")
    model = model_from_edges(nodes, np.array(EDGES) + 1, network=network)
    assert np.flatnonzero(model.frame.held.any(axis=1)).tolist() == [0, 2]
    assert "Node 0 without an edge: left out." in model.notes


def test_doubles_are_merged_and_said():
    nodes = np.vstack([TENT, TENT[4] + 1e-6, [[7, 7, 7]]])
    edges = [*EDGES[:5], [1, 5], [2, 5], [3, 4], [4, 5], [1, 0], [4, 0]]
    faces = [[0, 1, 5, 4], [1, 2, 5], [2, 3, 4, 5], [3, 0, 4]]
    model = model_from_edges(nodes, edges, faces)
    assert np.array_equal(model.frame.nodes, TENT)
    assert np.array_equal(model.frame.members, EDGES)
    assert sorted(map(tuple, model.cells[:, :3].tolist())) == sorted(map(tuple, FACES))
    said = " ".join(model.notes)
    for part in ("Node 5 merged", "Edge 4–5 without length", "Edges 1–0 and 4–0 there"):
        assert part in said


def test_a_face_of_many_corners_is_cut_into_triangles_of_the_same_area():
    angle = np.arange(7) * 2 * np.pi / 7
    nodes = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(7)])
    ring = [[i, (i + 1) % 7] for i in range(7)]
    model = model_from_edges(nodes, ring, [range(7)])
    a, b, c = np.moveaxis(model.frame.nodes[model.cells[:, :3]], 1, 0)
    assert np.cross(b - a, c - a)[:, 2].sum() / 2 == pytest.approx(7 / 2 * np.sin(2 * np.pi / 7))
    assert (model.frame.normals == [0, 0, 1]).all()
    assert "Face 0 of more than four corners: cut" in model.notes[0]


def test_a_wall_has_its_places_along_and_up():
    nodes = [[0, 0, 0], [6, 0.1, 0], [0, 0, 9], [6, 0, 9]]
    model = model_from_edges(nodes, [[0, 2], [1, 3], [2, 3]])
    assert model.surface == pytest.approx(np.array([[0, 0.5], [1, 0.5], [0.5, 1]]))


def test_a_level_mesh_is_held_everywhere_and_says_so():
    square = [[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0]]
    model = model_from_edges(square, [[0, 1], [1, 2], [2, 3], [3, 0]])
    assert model.frame.held[:, :3].all()
    assert "All 4 nodes are held" in model.notes[0]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"edges": [[0, 9]]}, "Edge 0 names node 9, but there are nodes 0 to 4"),
        ({"edges": [[0, -1]]}, "Edge 0 names node -1"),
        ({"faces": [[0, 1, 7]]}, "Face 0 names node 7"),
        ({"faces": [[0, 1]]}, "Face 0 has 2 corners"),
        ({"edges": []}, "no edges"),
        ({"edges": [[2, 2]]}, "no edges"),
        ({"nodes": TENT * [1, 1, np.nan]}, "Node 0 has no place"),
        ({"faces": [[0, 1, 4], [1, 4, 2]]}, "Cells 0 and 1 face opposite ways .* nodes 1 and 4"),
        ({"network": Network(supports="given")}, "No nodes are chosen"),
        ({"network": Network(supports="given", chosen="8")}, "Node 8 is to be held"),
        ({"network": Network(supports="given", chosen="1 -2")}, "“-2” is no index of a vertex"),
        ({"nodes": 1000 * TENT}, "longer .* member . .nodes . and .. .* in millimetres; scale it"),
        ({"nodes": 0.001 * TENT}, "shorter than 0.0032.. m.* member . .nodes . and .. .* scale it"),
        (
            {"network": Network(supports="boundary"), "faces": [*FACES, [3, 2, 1, 0]]},
            "closed and has no edge",
        ),
    ],
)
def test_a_mesh_that_is_no_structure_is_refused(change, said):
    with pytest.raises(SceneError, match=said):
        model_from_edges(**({"nodes": TENT, "edges": EDGES, "faces": FACES} | change))
