"""What sensors see of sun and sky, against closed forms and rays traced by hand."""

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Body, Mesh, Plane, Scene, plane_receiver
from heliform.engines.sun import bits, rays, visibility
from heliform.engines.sun.occlusion import Occluders, bodies_of
from heliform.engines.sun.remembered import Remembered
from heliform.engines.sun.sensors import at_points, of_receiver, on_mesh, on_plane
from heliform.engines.sun.visibility import visible, weighted
from scipy.sparse import csr_array
from sun.shades import MATTE, box, dome, level, sheet, sky_view, unit

UP = [0.0, 0.0, 1.0]
SKY = dome(4001)  # not a multiple of 8
RNG = np.random.default_rng(7)


def soup(count, seed=3):
    """Triangles at random between 1 and 4 m up."""
    rng = np.random.default_rng(seed)
    centres = rng.uniform([-4, -4, 1], [4, 4, 4], (count, 1, 3))
    vertices = (centres + rng.normal(0, 0.6, (count, 3, 3))).reshape(-1, 3)
    return Body("Soup", Mesh(vertices, np.arange(3 * count, dtype=np.int32).reshape(-1, 3)), MATTE)


# Closed forms


def test_an_open_plane_sees_all_of_the_sky():
    seen = visible(Occluders(()), on_plane(np.eye(4), 4, 3, 0.5), SKY)
    assert seen.values().all()
    assert sky_view(seen) == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("slope", [30, 90, 140])
def test_a_tilted_plane_sees_the_sky_in_front_of_it(slope):
    lean = np.radians(slope)
    sensor = at_points([[0, 0, 0]], [[np.sin(lean), 0, np.cos(lean)]])
    seen = visible(Occluders(()), sensor, SKY)
    assert sky_view(seen) == pytest.approx((1 + np.cos(lean)) / 2, abs=2e-3)


@pytest.fixture(scope="module")
def wall():
    """4 m high along the Y axis, as good as without ends."""
    return Occluders([sheet("Wall", [[0, -4e3, 0], [0, 4e3, 0], [0, 4e3, 4], [0, -4e3, 4]])])


def test_sky_beside_a_long_wall(wall):
    away = np.array([0.5, 2.0, 4.0, 20.0])
    sensors = at_points(away[:, None] * [1, 0, 0], np.tile(UP, (4, 1)), offset=1e-4)
    truth = (1 + np.cos(np.arctan2(4, away))) / 2
    assert sky_view(visible(wall, sensors, SKY)) == pytest.approx(truth, abs=2e-3)


def test_sun_hours_beside_a_long_wall(wall):
    """A sun that rises behind the wall at 15° an hour, square to it."""
    hours = (np.arange(12 * 60) + 0.5) / 60
    turn = np.radians(15 * hours)
    suns = np.stack([-np.cos(turn), 0 * turn, np.sin(turn)], axis=1)
    away = np.array([1.0, 3.0, 9.0])
    sensors = at_points(away[:, None] * [1, 0, 0], np.tile(UP, (3, 1)), offset=1e-6)
    seen = visible(wall, sensors, suns)
    truth = 12 - np.degrees(np.arctan2(4, away)) / 15
    assert seen.dot(np.full(len(suns), 1 / 60), cosine=False) == pytest.approx(truth, abs=1 / 60)


def test_a_window_under_an_overhang():
    """The sun is hidden where its profile angle is above that of the overhang's edge."""
    overhang = Occluders(
        [sheet("Overhang", [[-1e3, 0, 1], [1e3, 0, 1], [1e3, -2, 1], [-1e3, -2, 1]])]
    )
    seen = visible(overhang, at_points([[0, 0, 0]], [[0, -1, 0]], offset=1e-6), SKY).values()[0]
    front = SKY[:, 1] < -0.01
    assert (seen[front] == (2 * SKY[front, 2] < -SKY[front, 1])).all()
    assert not seen[SKY[:, 1] > 0].any()


def test_slats_let_through_what_their_spacing_leaves():
    spacing, height = 0.25, 0.4
    at = np.arange(-40, 41) * spacing
    corners = np.array([[0, -50, 2], [0, 50, 2], [0, 50, 2 + height], [0, -50, 2 + height]])
    vertices = (at[:, None, None] * [1, 0, 0] + corners).reshape(-1, 3)
    faces = np.arange(len(vertices), dtype=np.int32).reshape(-1, 4)
    x = (np.arange(500) + 0.5) / 500 * 2 * spacing
    sensors = at_points(x[:, None] * [1, 0, 0], np.tile(UP, (500, 1)))
    steep = SKY[SKY[:, 2] > 0.5]
    seen = visible(Occluders([Body("Slats", Mesh(vertices, faces), MATTE)]), sensors, steep)
    truth = np.maximum(0, 1 - height * np.abs(steep[:, 0]) / steep[:, 2] / spacing)
    assert seen.values().mean(axis=0) == pytest.approx(truth, abs=4 / 500)


def test_a_box_with_one_opening():
    """Under the middle of a square opening [Howell, configuration factor B-3]."""
    half, height = 1.0, 1.5
    floor = at_points([[0, 0, 0]], [UP], offset=1e-6)
    ring = [
        box("Room", (10, 10, 0.1), (0, 0, -0.06)),
        *(box("Wall", (0.1, 10, height), (5 * side, 0, height / 2)) for side in (-1, 1)),
        *(box("Wall", (10, 0.1, height), (0, 5 * side, height / 2)) for side in (-1, 1)),
        *(
            sheet("Roof", [[x, y, height] for x, y in ((a, b), (c, b), (c, d), (a, d))])
            for a, b, c, d in ((-5, -5, 5, -1), (-5, 1, 5, 5), (-5, -1, -1, 1), (1, -1, 5, 1))
        ),
    ]
    a = half / height
    root = np.sqrt(1 + a * a)
    truth = 4 * 2 * a / root * np.arctan(a / root) / (2 * np.pi)
    seen = visible(Occluders(ring), floor, dome(20_000))
    assert sky_view(seen)[0] == pytest.approx(truth, abs=1e-3)
    assert not visible(Occluders([*ring, level("Lid", 2, 2, height)]), floor, SKY).values().any()


# Rays by hand


def hit_by_hand(mesh, origins, directions, margin):
    """Möller & Trumbore in double precision: hit, and whether it is that by ``margin`` or more."""
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    e, f = b - a, c - a
    hit, sure = np.zeros((2, len(origins), len(directions)), bool)
    for j, direction in enumerate(directions):
        p = np.cross(direction, f)
        inverse = 1 / np.einsum("ti,ti->t", e, p)
        from_a = origins[:, None] - a
        u = np.einsum("nti,ti->nt", from_a, p) * inverse
        q = np.cross(from_a, e)
        v = q @ direction * inverse
        t = np.einsum("nti,ti->nt", q, f) * inverse
        least = np.minimum(np.minimum(u, v), np.minimum(1 - u - v, t))
        hit[:, j] = (least > 0).any(axis=1)
        sure[:, j] = (np.abs(least) > margin).all(axis=1)
    return hit, sure


def test_rays_meet_what_they_meet_in_double_precision():
    body = soup(150)
    count = 40
    sensors = at_points(RNG.uniform(-3, 3, (count, 3)) * [1, 1, 0.1], RNG.normal(size=(count, 3)))
    directions = unit(RNG.normal(size=(203, 3)))
    seen = visible(Occluders([body]), sensors, directions).values() > 0
    hit, sure = hit_by_hand(body.mesh, sensors.origins, directions, 1e-4)
    front = sensors.normals @ directions.T > 1e-6
    assert sure.mean() > 0.98
    assert (seen == (front & ~hit))[sure].all()


def test_a_scene_far_from_the_origin_is_seen_as_well():
    shift = np.array([4.5e5, 5.2e6, 300.0])
    body, sensors = soup(150), on_plane(np.eye(4), 4, 4, 0.25)
    far = np.eye(4)
    far[:3, 3] = shift
    moved = Body("Soup", body.mesh.moved(far), MATTE)
    here = visible(Occluders([body]), sensors, SKY).values()
    there = visible(Occluders([moved]), on_plane(far, 4, 4, 0.25), SKY).values()
    assert (here != there).mean() < 1e-5


@pytest.mark.parametrize("far", [1e3, 2e4, 1e5])
def test_what_is_far_away_hides_nothing_that_is_near(far):
    """A slab 4 cm over the sensors, on ground that begins 50 m beside them."""
    slab, sensors = level("Slab", 4, 4, 0.04), on_plane(np.eye(4), 2, 2, 0.5)
    hill = level("Hill", far, far, 0)
    aside = Body("Hill", hill.mesh.moved(_moved(far / 2 + 50)), MATTE)
    seen = visible(Occluders([slab, aside]), sensors, [UP])
    told = any("rays start" in note for note in seen.notes)
    assert told == (far > 5e3)
    assert told or not seen.values().any()
    below = level("Ground", far, far, -5)
    seen = visible(Occluders([slab, below]), sensors, [UP])
    assert not seen.notes
    assert not seen.values().any()


def _moved(along):
    matrix = np.eye(4)
    matrix[0, 3] = along
    return matrix


def test_a_sheet_shades_its_sensors_on_one_side_only():
    """Rays start off the surface, and a thin plate is not skipped."""
    plate = box("Plate", (50, 50, 5e-4), (0, 0, 0))
    above = visible(Occluders([plate]), on_mesh("Plate", plate.mesh), SKY)
    up = above.normals[:, 2] > 0.9
    assert above.values()[up].all()
    below = at_points([[0, 0, -1e-3]], [UP], offset=0.0)
    assert not visible(Occluders([plate]), below, SKY).values().any()


# Sums


def test_sums_are_those_of_what_is_seen():
    sensors = at_points(RNG.uniform(-3, 3, (37, 3)) * [1, 1, 0.1], RNG.normal(size=(37, 3)))
    seen = visible(Occluders([soup(80)]), sensors, SKY)
    weights = RNG.random((len(SKY), 20))
    weights[RNG.random(len(SKY)) < 0.6] = 0
    cosines = np.maximum(sensors.normals @ SKY.T, 0)
    values = seen.values()
    assert seen.dot(weights, cosine=False) == pytest.approx(values @ weights, rel=1e-5)
    assert seen.dot(weights) == pytest.approx((values * cosines) @ weights, rel=1e-5)
    assert seen.dot(weights[:, :4]) == pytest.approx(seen.dot(weights)[:, :4], rel=1e-5)
    assert seen.dot(weights[:, 0]) == pytest.approx(seen.dot(weights)[:, 0], rel=1e-5)
    assert seen.dot(csr_array(weights)) == pytest.approx(seen.dot(weights), rel=1e-5)
    few = np.where(np.arange(len(SKY)) < len(SKY) - 3, 0.0, 1.0)
    assert seen.dot(few, cosine=False) == pytest.approx(values[:, -3:].sum(axis=1))


def test_sums_without_keeping_are_the_same(monkeypatch):
    monkeypatch.setattr(visibility, "_STREAMED", 50_000)
    occluders, sensors = Occluders([soup(80)]), on_plane(np.eye(4), 4, 4, 0.5)
    weights = RNG.random((len(SKY), 2))
    kept = visible(occluders, sensors, SKY)
    monkeypatch.setattr(rays, "BATCH", 30_000)
    streamed, notes = weighted(occluders, sensors, SKY, weights)
    assert streamed == pytest.approx(kept.dot(weights), rel=1e-6)
    assert notes == kept.notes


def test_what_is_told_counts_all_sensors_that_are_summed_in_parts(monkeypatch):
    monkeypatch.setattr(visibility, "_STREAMED", 2 * len(SKY))
    block = Occluders([box("Block", (3, 3, 1), (0, 0, 0))])
    notes = weighted(block, on_plane(np.eye(4), 4, 4, 0.5), SKY, np.ones(len(SKY)))[1]
    assert [n.split(" and see")[0] for n in notes] == ["36 of 64 sensors lie inside “Block”"]


def test_what_would_not_fit_is_refused(monkeypatch):
    monkeypatch.setattr(visibility, "MOST_BYTES", 1000)
    with pytest.raises(SceneError, match="sum without keeping"):
        visible(Occluders(()), on_plane(np.eye(4), 4, 4, 0.5), SKY)


def test_bits_come_back():
    seen = RNG.random((5, 77)) < 0.3
    packed = bits.packed(seen)
    assert packed.shape == (5, 10)
    assert (bits.unpacked(packed, 77) == seen).all()


# What moves


@pytest.fixture
def traced(monkeypatch):
    """The heaps that rays are sent into, as they are."""
    heaps = []
    unblocked = rays.unblocked

    def noted(soup, *rest, **named):
        if soup.scene is not None:
            heaps.append(soup)
        return unblocked(soup, *rest, **named)

    monkeypatch.setattr(rays, "unblocked", noted)
    return heaps


def test_what_moves_is_traced_alone(traced):
    still, sensors, remembered = soup(60), on_plane(np.eye(4), 4, 4, 0.5), Remembered()
    fin = [box("Fin", (3, 0.1, 0.5), (0, y, 1)) for y in (-1, 0, 0.4, 1)]
    occluders = Occluders([still, fin[0]], moving=["Fin"])
    remembered.visible(occluders, sensors, SKY)
    for body in fin[1:]:
        traced.clear()
        occluders.update([still, body])
        seen = remembered.visible(occluders, sensors, SKY)
        assert traced == [occluders.moving]
        fresh = visible(Occluders([still, body]), sensors, SKY)
        assert (seen.seen == fresh.seen).all()
    traced.clear()
    occluders.update([soup(60), box("Fin", (3, 0.1, 0.5), (0, 1, 1))])
    assert remembered.visible(occluders, sensors, SKY) is seen
    assert not traced


@pytest.mark.parametrize("change", ["other faces", "added", "removed", "far", "first"])
def test_what_changes_is_seen_anew(change):
    sensors, remembered = on_plane(np.eye(4), 4, 4, 0.5), Remembered()
    before = [soup(60), box("Fin", (3, 0.1, 0.5), (0, 0, 1))]
    after = {
        "other faces": [before[0], soup(20, seed=5)],
        "added": [*before, box("Fin", (3, 0.1, 0.5), (0, 1, 1))],
        "removed": before[:1],
        "far": [before[0], box("Fin", (3, 0.1, 0.5), (200, 1, 1))],
        "first": [soup(60, seed=9), before[1]],
    }[change]
    occluders = Occluders(before)
    first = remembered.visible(occluders, sensors, SKY)
    occluders.update(after)
    second = remembered.visible(occluders, sensors, SKY)
    fresh = visible(Occluders(after), sensors, SKY)
    assert (second.seen != first.seen).any()
    assert (second.seen != fresh.seen).sum() <= 2  # about another centre, rays round otherwise


def test_what_is_remembered_stays_within_bounds():
    remembered, occluders = Remembered(most=1), Occluders([soup(5)])
    one = on_plane(np.eye(4), 4, 4, 1)
    first = remembered.visible(occluders, one, SKY)
    remembered.visible(occluders, one, SKY[:100])
    assert remembered.visible(occluders, one, SKY) is not first


# What is said


def test_sensors_inside_a_solid_are_told():
    solid = box("Block", (1, 1, 1), (0, 0, 0))
    sensors = at_points([[0, 0, 0], [0.2, 0, 0.3], [2, 0, 0]], np.tile(UP, (3, 1)))
    (note,) = visible(Occluders([solid]), sensors, SKY).notes
    assert note.startswith("2 of 3 sensors lie inside “Block”")


@pytest.mark.parametrize("inside_out", [False, True])
def test_sensors_on_faces_that_look_inward_are_told(inside_out):
    """As those of a body that is inside out; whether the one that shades is does not matter."""
    solid = box("Block", (1, 1, 1), (0, 0, 0))
    turned = Mesh(solid.mesh.vertices, solid.mesh.faces[:, ::-1].copy())
    there = Body("Block", turned, MATTE) if inside_out else solid
    seen = visible(Occluders([there]), on_mesh("Block", turned), SKY)
    assert any(n.startswith("5 of 6 sensors lie inside “Block”") for n in seen.notes)
    assert any(n.startswith("1 of 6 sensors face away") for n in seen.notes)


def test_sensors_under_a_solid_roof_are_not_inside_it():
    """Also where it is inside out, so that they see the backs of its faces."""
    roof = box("Roof", (90, 90, 1), (0, 0, 2))
    turned = Body("Roof", Mesh(roof.mesh.vertices, roof.mesh.faces[:, ::-1].copy()), MATTE)
    for body in (roof, turned):
        assert not visible(Occluders([body]), on_plane(np.eye(4), 2, 2, 1), SKY).notes


def test_a_grid_that_looks_down_is_told():
    down = np.diag([1.0, -1.0, -1.0, 1.0])
    (note,) = visible(Occluders(()), on_plane(down, 2, 2, 1), SKY).notes
    assert note.startswith("All 4 sensors face away from every direction")


@pytest.mark.parametrize(
    ("body", "said"),
    [
        (
            Body("Bad", Mesh(np.full((3, 3), np.nan), np.array([[0, 1, 2]], np.int32)), MATTE),
            "not finite",
        ),
        (Body("Bad", Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32)), MATTE), "no faces"),
    ],
)
def test_a_body_that_cannot_be_traced_is_named(body, said):
    with pytest.raises(SceneError, match=f"“Bad”.*{said}"):
        Occluders([body])


def test_directions_are_unit_vectors():
    with pytest.raises(SceneError, match="Direction 1 is 2 long"):
        visible(Occluders(()), on_plane(np.eye(4), 2, 2, 1), np.array([[0, 0, 1], [0, 0, 2]]))


def test_there_is_a_weight_for_each_direction():
    seen = visible(Occluders(()), on_plane(np.eye(4), 2, 2, 1), SKY)
    with pytest.raises(SceneError, match="5 weights for 4001 directions"):
        seen.dot(np.ones(5))


def test_receivers_shade_one_another():
    pose = np.eye(4)
    pose[2, 3] = 1.0
    table = plane_receiver("Table", Plane(width=50, length=50, resolution=2), pose)
    floor = plane_receiver("Floor", Plane(width=1, length=1, resolution=2), np.eye(4))
    occluders = Occluders(bodies_of(Scene(receivers=(table, floor))))
    assert visible(occluders, of_receiver(table), SKY).values().all()
    assert visible(occluders, of_receiver(floor), SKY).values()[:, SKY[:, 2] > 0.1].sum() == 0
