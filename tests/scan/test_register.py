"""Where a scan is laid on its design, against poses that are known."""

import numpy as np
import pytest
import trimesh
from heliform.engines.core.errors import Cancelled, SceneError
from heliform.engines.core.scene import Mesh
from heliform.engines.scan.closest import closest, target_of
from heliform.engines.scan.register import register
from heliform.engines.scan.settle import Sample, settle
from scan.printed_piece import ROUND, Piece, Scanner, apart

PIECE = Piece()
SLIM = Piece(layers=12)


def design(piece, steps=4):
    return target_of(Mesh(*piece.mesh(around=360, steps=steps)))


@pytest.fixture(scope="module")
def wall():
    return design(PIECE, steps=8)


@pytest.fixture(scope="module")
def tube():
    return design(ROUND)


def scanned(piece, **how):
    scanner = Scanner(points=30_000, **how)
    return Sample(scanner.scan(piece)), scanner.pose()


@pytest.mark.parametrize("sections", [7, 64])
def test_closest_places_are_those_of_every_triangle_measured(sections):
    body = trimesh.creation.annulus(0.05, 0.06, 0.1, sections=sections)
    points = np.random.default_rng(0).uniform(-0.08, 0.08, (500, 3))
    feet = closest(points, target_of(Mesh(body.vertices, body.faces.astype(np.int32))))
    each = [
        trimesh.triangles.closest_point(np.repeat(triangle[None], len(points), 0), points)
        for triangle in body.triangles
    ]
    least = np.min([np.linalg.norm(place - points, axis=1) for place in each], axis=0)
    np.testing.assert_allclose(np.abs(feet.distance), least, atol=1e-12)
    np.testing.assert_allclose(feet.place + feet.distance[:, None] * feet.toward, points, atol=1e-9)
    radius, height = np.hypot(*points[:, :2].T), np.abs(points[:, 2])
    thickness = np.cos(np.pi / sections)  # of a polygon's sides
    inside = (radius < 0.06 * thickness) & (radius > 0.05) & (height < 0.05)
    outside = (radius > 0.06) | (radius < 0.05 * thickness) | (height > 0.05)
    assert (feet.distance[inside] < 0).all()
    assert (feet.distance[outside] > 0).all()


def test_points_out_of_reach_have_no_face(wall):
    feet = closest(np.array([[0.0, 0.0, 0.06], [1.0, 1.0, 1.0]]), wall, within=5e-3)
    assert (feet.face == -1).all()
    np.testing.assert_array_equal(feet.distance, 5e-3)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
def test_a_pose_from_anywhere_is_found(wall, seed):
    """0.05 mm of noise, 30 % missing, 5 % strays, the outside alone and without normals."""
    sample, pose = scanned(PIECE, seed=seed)
    found = register(sample, wall, pitch=PIECE.layer)
    shift, turn = apart(found.matrix, pose)
    assert shift < 5e-5
    assert np.degrees(turn) < 0.05
    assert not len(found.loose)
    assert found.settled
    assert found.notes == ()
    assert found.inliers == pytest.approx(0.95, abs=0.01)
    assert found.rms == pytest.approx(5e-5, rel=0.2)


def test_the_uncertainty_is_that_of_repeated_scans(wall):
    errors, said = [], []
    for seed in range(8):
        sample, pose = scanned(PIECE, seed=seed, missing=0.2)
        found = register(sample, wall, start=np.linalg.inv(pose), seed=seed)
        rest = found.matrix @ pose
        errors.append([rest[2, 1], rest[0, 2], rest[1, 0]])
        said.append(found.turn_deviation)
    ratio = np.sqrt(np.mean(np.square(errors), axis=0)) / np.mean(said, axis=0)
    assert (ratio > 0.3).all()
    assert (ratio < 3.0).all()


def test_of_a_round_piece_axis_and_height_are_found_and_the_turn_is_said_to_be_loose(tube):
    sample, pose = scanned(ROUND, seed=3)
    found = register(sample, tube, pitch=ROUND.layer)
    rest = found.matrix @ pose
    upside = rest[2, 2] < 0  # a straight tube is the same upside down
    assert np.degrees(np.arccos(abs(rest[2, 2]))) < 0.05
    assert rest[2, 3] == pytest.approx(ROUND.height if upside else 0.0, abs=5e-5)
    np.testing.assert_allclose(rest[:2, 3], 0.0, atol=5e-5)
    assert len(found.loose) == 1
    assert found.turn_deviation[2] == np.pi
    assert found.turn_deviation[:2].max() < np.radians(0.05)
    assert any("turn about the axis is not determined" in note for note in found.notes)
    assert any("upside down" in note for note in found.notes)


def test_a_smooth_tube_without_ends_is_loose_along_its_axis():
    long = Piece(waves=(), taper=0.0, sag=0.0, layers=40)
    scanner = Scanner(points=30_000, turned=False)
    points = scanner.scan(long)
    points = points[np.abs(points[:, 2] - 0.1) < 0.06]
    found = register(Sample(points), design(long), start=np.eye(4))
    assert found.shift_deviation[2] == np.inf
    assert found.shift_deviation[:2].max() < 5e-5
    assert any("height along the axis is not determined" in note for note in found.notes)


def test_poses_that_look_alike_are_said_and_the_least_turned_is_taken():
    piece = Piece(waves=((3, 0.08, 0.0),), taper=0.05)
    scanner = Scanner(points=30_000, seed=5, turned=False)
    found = register(Sample(scanner.scan(piece)), design(piece), pitch=piece.layer)
    shift, turn = apart(found.matrix, np.eye(4))
    assert shift < 5e-5
    assert np.degrees(turn) < 0.05
    (note,) = found.notes
    assert "turned by any multiple of 120°" in note
    assert "upside down" not in note


def test_a_piece_does_not_slip_by_a_layer(wall):
    """One layer up, all but the rims fit as well, and nothing pulls the scan down."""
    sample, pose = scanned(PIECE, seed=2, missing=0.1)
    lifted = np.linalg.inv(pose)
    lifted[2, 3] += PIECE.layer
    slipped = settle(sample.first(3000), wall, lifted, 20)
    assert (slipped.matrix @ pose)[2, 3] == pytest.approx(PIECE.layer, rel=0.05)
    found = register(sample, wall, pitch=PIECE.layer, seed=4)
    assert (found.matrix @ pose)[2, 3] == pytest.approx(0.0, abs=5e-5)


def test_both_sides_and_normals_lead_to_the_same_pose():
    scanner = Scanner(points=30_000, seed=6, inside=True)
    points, pose = scanner.scan(SLIM), scanner.pose()
    found = register(Sample(points), design(SLIM), pitch=SLIM.layer)
    assert apart(found.matrix, pose)[0] < 5e-5


def test_a_scale_is_fitted_where_it_is_asked_for(wall):
    scanner = Scanner(points=30_000, seed=1, turned=False)
    found = register(Sample(0.99 * scanner.scan(PIECE)), wall, start=np.eye(4), fit_scale=True)
    assert found.scale == pytest.approx(1 / 0.99, abs=2e-4)  # the facets'
    assert 0 < found.scale_deviation < 1e-4


def test_by_hand_the_pose_is_looked_for_near_by_only(wall):
    sample, pose = scanned(PIECE, seed=1)
    near = np.linalg.inv(pose)
    near[:3, 3] += [2e-3, -1e-3, 1e-3]
    assert apart(register(sample, wall, start=near).matrix, pose)[0] < 5e-5
    with pytest.raises(SceneError, match="touches the design nowhere"):
        register(sample, wall, start=np.eye(4) + np.diag([1.0, 1.0], 2) * 9)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_pose():
    sample, _ = scanned(SLIM, seed=1)
    slim = design(SLIM)
    one, other = (register(sample, slim, pitch=SLIM.layer, seed=7) for _ in range(2))
    np.testing.assert_array_equal(one.matrix, other.matrix)
    np.testing.assert_array_equal(one.covariance, other.covariance)


def test_it_can_be_cancelled(wall):
    sample, _ = scanned(PIECE)

    def cancel(fraction, text):
        if fraction > 0.2:
            raise Cancelled

    with pytest.raises(Cancelled):
        register(sample, wall, progress=cancel)
