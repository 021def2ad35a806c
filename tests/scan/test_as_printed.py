"""A finished piece against its design, from file to figures, with what goes wrong on the way."""

import numpy as np
import pytest
import trimesh
from heliform.engines.core.colour import Display
from heliform.engines.core.errors import Cancelled, FileError, SceneError
from heliform.engines.core.scene import Body, Material, Mesh, Scene
from heliform.engines.core.table import load_csv
from heliform.engines.scan.as_printed import Comparison, Placement, compare
from heliform.engines.scan.printed_drawing import draw
from heliform.engines.scan.printed_result import AsPrinted
from scan.printed_piece import Piece, Scanner, apart

DESIGN = Piece()
PRINTED = Piece(layer=5.1e-3, wall=8.4e-3)
BULGED = Piece(bulge=(2.0, 0.06, 1e-3, 0.012))
NAME = "Vase ä/1"


def scene(piece=DESIGN, steps=6):
    return Scene(bodies=(Body(NAME, Mesh(*piece.mesh(around=360, steps=steps)), Material()),))


def written(folder, points, name="piece ö.ply", faces=None):
    path = folder / name
    if faces is None:
        trimesh.PointCloud(points).export(path)
    else:
        trimesh.Trimesh(points, faces, process=False).export(path)
    return str(path)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("scans")


@pytest.fixture(scope="module")
def printed(folder):
    """A piece whose layers and wall came out too large, both sides seen, in millimetres."""
    scanner = Scanner(points=200_000, inside=True)
    file = written(folder, 1e3 * scanner.scan(PRINTED))
    return compare(scene(), Comparison(file=file), seed=1)


@pytest.fixture(scope="module")
def bulged(folder):
    """A piece with a bulge, the outside seen, in inches."""
    scanner = Scanner(points=300_000, missing=0.15, seed=1)
    file = written(folder, scanner.scan(BULGED) / 0.0254, "bulged.ply")
    return compare(scene(), Comparison(file=file), seed=1), scanner


def value(result, name):
    return result.figures()[name]["value"]


def test_layers_and_wall_are_as_they_were_printed(printed):
    assert value(printed, "layer_height") == pytest.approx(5.1e-3, abs=5e-5)
    assert value(printed, "layer_height_design") == pytest.approx(5e-3, abs=5e-6)
    assert value(printed, "wall_width") == pytest.approx(8.4e-3, abs=5e-5)
    assert value(printed, "wall_width_design") == pytest.approx(8e-3, abs=5e-5)
    assert value(printed, "shrinkage_height") == pytest.approx(-0.02, abs=1e-3)
    assert value(printed, "layers") == PRINTED.layers
    inner = slice(1, -1)
    np.testing.assert_allclose(printed.layers.height[inner], 5.1e-3, atol=5e-5)
    np.testing.assert_allclose(printed.layers.width[inner], 8.4e-3, atol=5e-5)
    assert printed.layers.points.min() > 1000


def test_a_bulge_is_in_the_map_where_it_is(bulged):
    result, _ = bulged
    angle, z, height, width = BULGED.bulge
    place = BULGED.face(np.array([angle]), np.array([z]), np.array([1.0]))[0]
    assert value(result, "deviation_max") == pytest.approx(height, abs=5e-5)
    found = np.array([value(result, f"deviation_max_{axis}") for axis in "xyz"])
    assert np.linalg.norm(found - place) < 6e-3
    outer = np.hypot(*result.vertices[:, :2].T) > np.hypot(*DESIGN.plan(angle, z)[0])
    near = np.linalg.norm(result.vertices - place, axis=1) < 2e-3
    across = 2 * (result.vertices[near & outer, 2] / DESIGN.layer % 1) - 1
    lean = np.arctan(4 * DESIGN.sag / DESIGN.layer * across)  # the map is along the bead's normal
    truth = height * np.cos(lean)
    np.testing.assert_allclose(result.deviation[near & outer].mean(), truth.mean(), atol=5e-5)
    far = np.linalg.norm(result.vertices - place, axis=1) > 5 * width
    assert abs(np.nanmean(result.deviation[far])) < 3e-5
    assert 0.2 * 1e-3 < np.nanmax(result.outside) < 1.05 * height


def test_coverage_is_what_was_seen(bulged):
    result, _ = bulged
    side, rims = 2 * np.pi * 0.1 * DESIGN.height, 2 * np.pi * 0.1 * DESIGN.wall
    seen = 0.85 * (side + 2 * rims) / (2 * side + 2 * rims)
    assert value(result, "coverage") == pytest.approx(seen, abs=0.04)
    assert value(result, "strays") == pytest.approx(0.05, abs=0.01)
    assert "wall_width" not in result.figures()
    assert result.inside.size == 0
    assert any("only one side" in note for note in result.meta["notes"])


def test_the_unit_is_guessed_by_the_design_and_said(bulged):
    result, scanner = bulged
    assert apart(result.matrix, scanner.pose())[0] < 5e-5
    assert any("inch" in note for note in result.meta["notes"])


def test_files(printed, tmp_path):
    names = printed.save(tmp_path) + draw(printed, tmp_path, Display())
    assert {p.name for p in tmp_path.iterdir()} == set(names)
    again = AsPrinted.load(tmp_path)
    assert again.meta == printed.meta
    for name in ("deviation", "outside", "inside", "matrix", "vertices"):
        np.testing.assert_array_equal(getattr(again, name), getattr(printed, name))
    np.testing.assert_array_equal(again.layers.height, printed.layers.height)
    columns, meta = load_csv(tmp_path / "layers.csv")
    np.testing.assert_allclose(columns["Height (m)"], printed.layers.height, rtol=1e-6)
    assert meta["design"] == NAME
    columns, _ = load_csv(tmp_path / "deviation.csv")
    assert len(columns["Deviation (m)"]) == np.isfinite(printed.deviation).sum()
    for picture in ("outside.png", "inside.png", "heights.png", "widths.png"):
        assert (tmp_path / picture).stat().st_size > 2000
    (tmp_path / "as_printed.npz").write_bytes(b"PK")
    with pytest.raises(FileError, match="compare again"):
        AsPrinted.load(tmp_path)


def test_every_figure_has_a_unit_and_is_a_number(printed):
    for figure in printed.figures().values():
        assert np.isfinite(figure["value"])
        assert figure["unit"] in ("m", "deg", "")
        assert figure.get("uncertainty", 0.0) >= 0


@pytest.fixture(scope="module")
def plain(folder):
    """A quick scan in its place, in metres, of a low and coarse piece."""
    low = Piece(layers=8)
    points = Scanner(points=20_000, turned=False).scan(low)
    return scene(low, steps=4), points, written(folder, points, "plain.ply")


def test_by_hand_it_begins_where_it_was_placed(plain, folder):
    low, points, _ = plain
    turned = points[:, [1, 0, 2]] * [1, -1, 1] - [0.3, 0.0, 0.1]  # by −90° about Z, then moved
    file = written(folder, turned, "placed.ply")
    placed = Placement(x=0.001, y=0.3, z=0.099, turn_z=90.0)
    record = Comparison(file=file, unit="m", start="as placed", placed=placed)
    result = compare(low, record)
    assert result.matrix[1, 3] == pytest.approx(0.3, abs=2e-4)
    assert result.matrix[0, 1] == pytest.approx(-1.0, abs=1e-4)
    far = Comparison(file=file, unit="m", start="as placed", placed=Placement(x=5.0))
    with pytest.raises(SceneError, match=r"closer|nowhere"):
        compare(low, far)


def test_a_mesh_inside_a_thin_wall_is_told_by_its_normals(folder):
    """A scan of the outside, dented so that it comes to lie nearer to the inside, as a mesh."""
    thin = Piece(layers=8, wall=3.2e-3, sag=4e-4)
    vertices, faces = thin.mesh(around=300, steps=6)
    radius = np.hypot(*vertices[:, :2].T)
    outer = radius > np.hypot(*thin.plan(np.arctan2(*vertices[:, 1::-1].T), vertices[:, 2])[0].T)
    faces = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    faces = faces[outer[faces].all(axis=1)]
    used, faces = np.unique(faces, return_inverse=True)
    file = written(folder, vertices[used], "thin.ply", faces.reshape(-1, 3))
    result = compare(scene(thin, steps=6), Comparison(file=file, unit="m"))
    assert abs(value(result, "deviation_mean")) < 2e-5
    assert result.inside.size == 0


def test_two_runs_agree(plain):
    low, _, file = plain
    record = Comparison(file=file, unit="m", start="as placed")
    one, other = (compare(low, record, seed=3) for _ in range(2))
    np.testing.assert_array_equal(one.deviation, other.deviation)
    assert one.figures() == other.figures()


def test_it_can_be_cancelled(plain):
    low, _, file = plain
    heard = []

    def cancel(fraction, text):
        heard.append(fraction)
        if fraction > 0.6:
            raise Cancelled

    with pytest.raises(Cancelled):
        compare(low, Comparison(file=file, unit="m", start="as placed"), progress=cancel)
    assert heard == sorted(heard)


def test_another_unit_is_said_with_the_remedy(plain, folder):
    low, points, _ = plain
    file = written(folder, points / 0.0254, "inches.ply")
    with pytest.raises(SceneError, match=r"smaller than “Vase ä/1”; set the unit to inch"):
        compare(low, Comparison(file=file, unit="cm"))
    with pytest.raises(SceneError, match=r"with unit = “inch” it would be"):
        compare(low, Comparison(file=file, unit="mm"))


def test_a_scan_of_something_else_is_said(plain, folder):
    low, _, _ = plain
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.08)
    file = written(folder, ball.vertices, "ball.ply")
    with pytest.raises(SceneError, match=r"Only \d+ % of the scan “ball.ply” lies within 5 mm"):
        compare(low, Comparison(file=file, unit="m"))


def test_a_scan_full_of_other_things_is_said(plain, folder):
    low, points, _ = plain
    room = np.random.default_rng(0).uniform(-0.4, 0.4, (60_000, 3))
    file = written(folder, np.concatenate([points, room]), "room.ply")
    with pytest.raises(SceneError, match=r"times larger than|Only \d+ % of the scan"):
        compare(low, Comparison(file=file, unit="m"))


@pytest.mark.parametrize(
    ("bodies", "asked", "said"),
    [
        (0, {}, "no design"),
        (2, {}, "Several bodies may be the design"),
        (1, {"body": "Lamp"}, "no body “Lamp”"),
        (1, {"file": ""}, "no scan to compare with"),
    ],
)
def test_what_is_missing_is_said(plain, bodies, asked, said):
    low, _, file = plain
    body = low.bodies[0]
    some = (body, Body("Other", body.mesh, body.material))[:bodies]
    with pytest.raises(SceneError, match=said):
        compare(Scene(bodies=some), Comparison(**({"file": file} | asked)))


@pytest.mark.parametrize("content", [b"", b"ply\nformat nonsense"])
def test_a_broken_file_is_said(plain, tmp_path, content):
    path = tmp_path / "broken ß.ply"
    path.write_bytes(content)
    with pytest.raises(FileError, match="broken ß"):
        compare(plain[0], Comparison(file=str(path)))


def test_a_design_without_faces_is_said(plain):
    empty = Body("Empty", Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32)), Material())
    with pytest.raises(SceneError, match="“Empty” has no faces"):
        compare(Scene(bodies=(empty,)), Comparison(file=plain[2]))
