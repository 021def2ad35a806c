"""The deviation of scans whose deviation is known."""

import numpy as np
import pytest
import trimesh
from heliform.engines.core.scene import Mesh
from heliform.engines.scan.around import around_of
from heliform.engines.scan.beads import beads_of, strip_of
from heliform.engines.scan.closest import closest, target_of
from heliform.engines.scan.deviation import picture_of, spread, statistics
from heliform.engines.scan.found import Sides, layers_of
from scan.printed_piece import ROUND, Piece, Scanner

NOISE = 5e-5


@pytest.fixture(scope="module")
def ball():
    body = trimesh.creation.icosphere(subdivisions=5, radius=0.05)
    return target_of(Mesh(body.vertices, body.faces.astype(np.int32)))


def on_ball(count, out, seed=0):
    """Points over a ball of 50 mm, ``out`` of it by a function of the direction."""
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(count, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return way * (0.05 + out(way) + rng.normal(0, NOISE, count))[:, None]


def deviation_of(points, target, near=5e-3):
    return spread(closest(points, target, near), target, near)


def test_what_stands_out_evenly_stands_out_everywhere(ball):
    found = deviation_of(on_ball(100_000, lambda way: 3e-4), ball)
    figures = statistics(found, ball.mesh.vertices, 1e-3)
    assert figures.mean == pytest.approx(3e-4, abs=1e-5)
    assert figures.rms == pytest.approx(3e-4, abs=2e-5)
    assert figures.coverage == 1.0
    assert figures.within == 1.0
    assert found.noise == pytest.approx(NOISE, rel=0.1)
    assert found.area.sum() == pytest.approx(4 * np.pi * 0.05**2, rel=1e-3)


def test_a_bulge_is_found_in_its_place_and_height(ball):
    """1 mm high and 10 mm wide (σ), at the pole."""

    def bulge(way):
        return 1e-3 * np.exp(-((0.05 * np.arccos(np.clip(way[:, 2], -1, 1)) / 0.01) ** 2) / 2)

    found = deviation_of(on_ball(300_000, bulge), ball)
    truth = bulge(ball.mesh.vertices / 0.05)
    np.testing.assert_allclose(found.vertices, truth, atol=5e-5)
    figures = statistics(found, ball.mesh.vertices, 5e-4)
    assert figures.largest == pytest.approx(1e-3, abs=5e-5)
    np.testing.assert_allclose(figures.place, [0, 0, 0.05], atol=3e-3)
    wide = 0.01 * np.sqrt(2 * np.log(2))  # where it is half as high
    assert 1 - figures.within == pytest.approx((1 - np.cos(wide / 0.05)) / 2, abs=1e-3)
    assert figures.percentile_95 == pytest.approx(np.quantile(truth, 0.95), abs=3e-5)


def test_inward_is_negative_and_what_was_not_scanned_is_nan(ball):
    points = on_ball(100_000, lambda way: np.full(len(way), -2e-4))
    found = deviation_of(points[points[:, 2] > 0], ball)
    height = ball.mesh.vertices[:, 2]
    np.testing.assert_allclose(found.vertices[height > 2e-3], -2e-4, atol=7e-5)
    assert np.isnan(found.vertices[height < -6e-3]).all()
    assert statistics(found, ball.mesh.vertices, 1e-3).coverage == pytest.approx(0.5, abs=0.06)


def test_strays_do_not_count(ball):
    points = on_ball(50_000, lambda way: 0.0)
    strays = np.random.default_rng(5).uniform(-0.06, 0.06, (5000, 3))
    found = deviation_of(np.concatenate([points, strays]), ball)
    assert found.belongs[:50_000].mean() > 0.999
    assert found.belongs[50_000:].mean() < 0.02
    assert np.abs(found.vertices).max() < 3e-4


def test_nothing_seen_is_no_figure(ball):
    found = deviation_of(np.full((100, 3), 1.0), ball)
    figures = statistics(found, ball.mesh.vertices, 1e-3)
    assert figures.coverage == 0
    assert np.isnan(figures.mean)


def test_a_side_unrolled_has_its_values_in_their_places_and_gaps():
    rng = np.random.default_rng(0)
    turn, z = rng.random(40_000), rng.uniform(0, 0.1, 40_000)
    seen = (turn < 0.5) | (turn > 0.7)
    picture = picture_of(turn[seen], z[seen], turn[seen] + z[seen], girth=0.4)
    rows, columns = picture.shape
    assert rows / columns == pytest.approx(0.25, rel=0.05)
    x, y = (np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows * 0.1
    expected = np.where((x > 0.53) & (x < 0.67), np.nan, x + y[:, None])
    inner = (x > 0.05) & (x < 0.95) & ~((x > 0.47) & (x <= 0.53)) & ~((x >= 0.67) & (x < 0.73))
    np.testing.assert_allclose(picture[:, inner], expected[:, inner], atol=0.03)


def unposed(piece, **how):
    """A scan of the sides in the design's own place, without strays."""
    return Scanner(turned=False, outliers=0.0, rims=False, **how).scan(piece)


def test_unrolled_along_the_outline_a_turn_is_even_in_length_and_offsets_are_normal():
    piece = Piece(sag=0.0, taper=0.0)
    around = around_of(Mesh(*piece.mesh()))
    angle = np.linspace(0, 2 * np.pi, 200_001)
    for out in (-1.0, 0.0, 1.0):
        line = piece.face(angle, np.full_like(angle, 0.03), np.full_like(angle, out))
        turn, offset = around.unroll(line)
        np.testing.assert_allclose(offset, (out - 1) * piece.wall / 2, atol=1e-5)  # the facets'
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    assert around.girth == pytest.approx(length[-1], rel=1e-4)
    expected = turn[0] + length / length[-1]
    gap = np.mod(turn - expected + 0.5, 1.0) - 0.5
    np.testing.assert_allclose(gap, 0.0, atol=1e-4)


def test_layers_of_uneven_height_are_found_one_by_one():
    piece = Piece(uneven=1.5e-4)
    around = around_of(Mesh(*Piece().mesh()), Piece().layer)
    points = unposed(piece, points=200_000, missing=0.3)
    found = layers_of(Sides(points[:, 2], np.ones(len(points)), *around.unroll(points)))
    floors = piece.floors
    np.testing.assert_allclose(found.layers.height, np.diff(floors)[1:-1], atol=5e-5)
    np.testing.assert_allclose(found.layers.z, (floors[1:-2] + floors[2:-1]) / 2, atol=5e-5)
    assert found.pitch == pytest.approx(np.diff(floors)[2:-2].mean(), abs=1e-5)
    assert np.isnan(found.width)
    assert found.rise == 0


def test_a_spiral_climbs_a_layer_in_a_turn():
    rng = np.random.default_rng(0)
    turn, z = rng.random(200_000), rng.uniform(0, 0.1, 200_000)
    offset = 1e-3 * np.abs(np.sin(np.pi * (z / 5e-3 - turn))) + rng.normal(0, NOISE, len(z))
    beads = beads_of(strip_of(turn, z, offset, 0.0, 0.1))
    assert beads.rise == 1
    assert beads.pitch == pytest.approx(5e-3, rel=2e-3)
    sectors = (np.arange(len(beads.floors)) + 0.5) / len(beads.floors)
    phase = beads.floors / 5e-3 - sectors[:, None]
    np.testing.assert_allclose((phase - np.round(phase))[np.isfinite(phase)], 0.0, atol=0.03)


def test_a_wall_without_relief_has_a_width_and_no_layers():
    piece = Piece(sag=0.0)
    around = around_of(Mesh(*piece.mesh()))
    points = unposed(piece, points=100_000, inside=True, missing=0.2)
    turn, offset = around.unroll(points)
    side = np.where(offset > -piece.wall / 2, 1.0, -1.0)
    found = layers_of(Sides(points[:, 2], side, turn, offset))
    assert not found.rhythmic
    assert found.width == pytest.approx(piece.wall, abs=2e-5)
    assert len(found.layers.z) == 0


def test_what_is_no_wall_has_no_outline():
    vertices, faces = ROUND.mesh(around=64, steps=2)
    assert around_of(Mesh(vertices * [1, 1, 0], faces)) is None
