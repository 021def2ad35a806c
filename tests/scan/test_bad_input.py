"""What a scan can be that is none, and what is said then: one sentence, with a remedy."""

import numpy as np
import pytest
import trimesh
from heliform.engines.core.errors import Cancelled, FileError, HeliformError, SceneError
from heliform.engines.core.scene import Scene
from heliform.engines.scan import ScanReading, load_scan, read, read_scan
from heliform.engines.scan.load import SAMPLE, Sizes, scan_of
from scan.generator import Piece, profile, scan

SMALL = Piece(seed=1, points=50_000, broken=0, outliers=0, shells=0)


@pytest.fixture(scope="module")
def small():
    return scan(SMALL)


def said(error: pytest.ExceptionInfo) -> str:
    text = str(error.value)
    assert "\n" not in text
    assert text.endswith(".")
    return text


@pytest.mark.parametrize(("roughness", "seed"), [(0.0, 1), (0.02, 2), (0.1, 3), (0.1, 4)])
def test_without_layers_there_is_none_and_the_confidence_is_said(roughness, seed):
    smooth = Piece(seed=seed, points=60_000, depth=0.0, roughness=roughness + 1e-9)
    vertices, faces, _ = scan(smooth)
    with pytest.raises(SceneError) as error:
        read(scan_of("smooth.ply", vertices, faces), ScanReading())
    text = said(error)
    assert "no layer period" in text
    assert "confidence of" in text
    assert "99 %" in text


def test_layers_outside_the_range_are_not_found(small):
    vertices, faces, _ = small
    with pytest.raises(SceneError, match="no layer period between 7 and 20 mm"):
        read(scan_of("small.ply", vertices, faces), ScanReading(shortest=7e-3))


def test_an_empty_range_is_named(small):
    vertices, faces, _ = small
    with pytest.raises(SceneError) as error:
        read(scan_of("s.ply", vertices, faces), ScanReading(shortest=20e-3, longest=5e-3))
    assert "below the greatest" in said(error)


@pytest.mark.parametrize(
    ("scale", "unit"), [(1.0, "mm"), (1 / 25.4, "inch"), (1e-3, "m")], ids=["mm", "inch", "m"]
)
def test_the_unit_is_guessed_and_said(small, scale, unit):
    vertices, faces, _ = small
    read_in = scan_of("s.ply", vertices * scale, faces)
    assert np.ptp(read_in.points, axis=0) == pytest.approx(np.ptp(vertices, axis=0) * 1e-3)
    assert any(f"taken as {unit}," in note for note in read_in.notes)
    assert read_in.unit == unit


def test_inches_taken_for_millimetres_are_named_with_the_likely_unit(small):
    vertices, faces, _ = small
    with pytest.raises(SceneError) as error:
        scan_of("inch.ply", vertices / 25.4, faces, "mm")
    text = said(error)
    assert "numbers are in mm" in text
    assert "unit = “inch”" in text


def test_millimetres_taken_for_metres_are_named_too(small):
    vertices, faces, _ = small
    with pytest.raises(SceneError, match=r"numbers are in m, .*unit = “mm”"):
        scan_of("mm.ply", vertices, faces, "m")


def test_a_wall_of_two_metres_is_no_sample_but_may_be_a_piece(small):
    vertices, faces, _ = small
    wall = vertices * (2000 / np.linalg.norm(np.ptp(vertices, axis=0)))
    with pytest.raises(SceneError, match=r"a sample has 15 mm to 1\.5 m") as error:
        scan_of("wall.ply", wall, faces, "mm")
    said(error)
    found = scan_of("wall.ply", wall, faces, sizes=Sizes(0.015, 10.0, 2.0, "a piece"))
    assert found.unit == "mm"
    assert SAMPLE.largest == 1.5


@pytest.mark.parametrize("suffix", ["ply", "obj", "stl"])
def test_files_of_each_kind_are_the_same_piece(small, tmp_path, suffix):
    vertices, faces, _ = small
    path = tmp_path / f"Scan ä 1.{suffix}"
    trimesh.Trimesh(vertices, faces, process=False).export(path)
    found = load_scan(path, "mm")
    reading = read(found, ScanReading())
    assert reading.figures()["layer_height"]["value"] == pytest.approx(5e-3, rel=0.002)
    assert reading.style.name == "Scan ä 1"


@pytest.mark.parametrize("suffix", ["ply", "obj", "stl"])
def test_an_empty_file_is_named(tmp_path, suffix):
    path = tmp_path / f"empty.{suffix}"
    path.touch()
    with pytest.raises(FileError, match="is empty; export it again") as error:
        load_scan(path)
    said(error)


@pytest.mark.parametrize("suffix", ["ply", "obj", "stl", "xyzw"])
def test_a_damaged_file_is_named(tmp_path, suffix):
    path = tmp_path / f"damaged.{suffix}"
    path.write_bytes(bytes(range(256)) * 40)
    with pytest.raises(FileError) as error:
        load_scan(path)
    assert f"damaged.{suffix}" in said(error)


def test_a_cut_off_file_is_named(small, tmp_path):
    vertices, faces, _ = small
    path = tmp_path / "cut.ply"
    trimesh.Trimesh(vertices, faces, process=False).export(path)
    path.write_bytes(path.read_bytes()[:200_000])
    with pytest.raises(FileError) as error:
        load_scan(path)
    assert "export it again" in said(error)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileError, match="There is no scan"):
        read_scan(Scene(), ScanReading(file=str(tmp_path / "none.ply")))


def test_a_handful_of_points_is_too_few(tmp_path):
    path = tmp_path / "cube.stl"
    trimesh.creation.box((50, 50, 50)).export(path)
    with pytest.raises(FileError, match="too few for a relief") as error:
        load_scan(path)
    said(error)


def test_a_huge_scan_is_thinned_and_that_is_said(small):
    vertices, faces, _ = small
    found = scan_of("huge.ply", vertices, faces, "mm", most=20_000)
    assert len(found.points) <= 20_000
    assert len(found.faces) == 0
    assert any("more than 20,000" in note for note in found.notes)
    reading = read(found, ScanReading())
    assert reading.figures()["layer_height"]["value"] == pytest.approx(5e-3, rel=0.002)


def test_a_file_of_gigabytes_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "vast.ply"
    path.write_bytes(b"ply")
    monkeypatch.setattr("heliform.engines.scan.load._LARGEST_FILE", 2)
    with pytest.raises(FileError, match="thin it out") as error:
        load_scan(path)
    said(error)


def test_points_that_are_no_numbers_are_left_out(small):
    vertices, faces, _ = small
    broken = vertices.copy()
    broken[::50] = np.nan
    broken[7] = np.inf
    found = scan_of("nan.ply", broken, faces, "mm")
    assert np.isfinite(found.points).all()
    assert any("no numbers" in note for note in found.notes)
    reading = read(found, ScanReading())
    assert reading.figures()["layer_height"]["value"] == pytest.approx(5e-3, rel=0.002)


def _corrugated(deep: float, high: float) -> np.ndarray:
    """A cloud, mm: a flat sheet in waves so deep and so high."""
    arc, z = np.meshgrid(np.linspace(-30, 30, 400), np.linspace(-20, 20, 700))
    out = deep / 2 * np.sin(2 * np.pi * z / high)
    out += 0.02 * np.random.default_rng(0).normal(size=arc.shape)
    return np.column_stack([out.ravel(), arc.ravel(), z.ravel()])


@pytest.mark.parametrize(("deep", "high"), [(2.4, 2.0), (6.0, 5.0)])
def test_a_relief_deeper_than_its_layer_is_no_bead(deep, high):
    text = "more than the layer height|less deep than its layers"
    cloud = _corrugated(deep, high)
    with pytest.raises(SceneError, match=text) as error:
        read(scan_of("deep.ply", cloud, np.zeros((0, 3), int), "mm"), ScanReading())
    said(error)


def test_a_face_that_was_not_scanned_cannot_be_read():
    vertices, faces, _ = scan(Piece(seed=2, points=50_000, inner=False))
    with pytest.raises(SceneError, match="only the outer one; choose that"):
        read(scan_of("outer.ply", vertices, faces), ScanReading(sides="inner"))


def test_points_on_a_line_are_no_piece():
    line = np.zeros((5000, 3))
    line[:, 0] = np.linspace(0, 80, 5000)
    with pytest.raises(SceneError, match="lie on a line"):
        read(scan_of("line.ply", line, np.zeros((0, 3), int)), ScanReading())


def test_a_shape_that_is_no_wall_is_not_read_as_one():
    ball = trimesh.creation.icosphere(6, radius=40)
    with pytest.raises(HeliformError) as error:
        read(scan_of("ball.ply", ball.vertices, ball.faces), ScanReading())
    said(error)


def test_noise_in_a_box_is_no_piece():
    cloud = np.random.default_rng(0).uniform(-30, 30, (50_000, 3))
    with pytest.raises(HeliformError) as error:
        read(scan_of("fog.ply", cloud, np.zeros((0, 3), int)), ScanReading())
    said(error)


def test_a_reading_stops_when_asked(small):
    vertices, faces, _ = small

    def stop(fraction: float, text: str) -> None:
        if fraction > 0.6:
            raise Cancelled

    with pytest.raises(Cancelled):
        read(scan_of("s.ply", vertices, faces), ScanReading(), progress=stop)


def test_progress_rises_from_nothing_to_all(small):
    vertices, faces, _ = small
    told: list[float] = []
    read(scan_of("s.ply", vertices, faces), ScanReading(), progress=lambda f, _: told.append(f))
    assert told == sorted(told)
    assert told[0] >= 0
    assert told[-1] == 1
    assert len(told) > 15


def test_the_generator_draws_the_bead_that_it_says():
    places = np.linspace(0, 1, 10_001)
    bead = profile(Piece(), places)
    assert np.ptp(bead) == pytest.approx(0.933)
    assert bead.argmin() in (0, 10_000)
    slope = np.gradient(bead, 5.0 / 10_000)
    assert np.abs(np.diff(slope)).max() < 2e-3  # no edge: the fillet meets the arcs tangentially
