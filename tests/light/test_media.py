"""Media inside, beside and over one another: which is there, and what is refused."""

import numpy as np
import pytest
import trimesh
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Body, Lamp, Luminaire, Material, Mesh, Scene
from heliform.engines.light import PhotonTracing, trace
from light import scenes

LANDED = PhotonTracing(until="landed", landed=400_000)
GLASS, WATER = 1.5, 1.333


def body(name, mesh, ior, priority=0, **more):
    return Body(name, mesh, Material(ior=ior, priority=priority, **more))


def reflectance(one, other):
    return ((one - other) / (one + other)) ** 2


def stacked(*reflectances):
    """Transmittance of parallel surfaces at normal incidence with all orders of reflection."""
    through, back = 1.0, 0.0
    for r in reflectances:
        # Add a surface behind a stack that passes `through` and reflects `back` from behind.
        between = 1 / (1 - back * r)
        through, back = through * between * (1 - r), r + (1 - r) ** 2 * back * between
    return through


def transmitted(*bodies, lux=1000.0, width=0.004):
    """Share of a thin vertical beam that arrives below, and one standard deviation."""
    lamp = scenes.beam(lux, width, scenes.at(z=0.2))
    receiver = scenes.floor(0.2, 32, scenes.at(z=-0.1))
    meta = scenes.traced(Scene(bodies, (lamp,), (receiver,)), LANDED, seed=3).meta
    share = meta["flux"]["landed"] / meta["flux"]["emitted"]
    return share, np.sqrt(share * (1 - share) / meta["photons"]["emitted"])


def slab(thickness, z=0.0, side=0.1, turn=0.0):
    made = trimesh.creation.box((side, side, thickness))
    made.apply_transform(trimesh.transformations.rotation_matrix(turn, (0, 0, 1)))
    made.apply_translation((0.0, 0.0, z))
    return Mesh(np.asarray(made.vertices), np.asarray(made.faces, np.int32))


def test_water_that_reaches_into_the_glass_around_it():
    """A glass trough of 2 mm walls, filled with water 0.1 mm into its floor and walls."""
    outer = trimesh.creation.box((0.06, 0.06, 0.04))
    hollow = trimesh.creation.box((0.056, 0.056, 0.04))
    hollow.apply_translation((0, 0, 0.002))
    trough = trimesh.Trimesh(
        np.concatenate([outer.vertices, hollow.vertices]),
        np.concatenate([outer.faces, hollow.faces[:, ::-1] + len(outer.vertices)]),
        process=False,
    )
    # The hollow's top is the glass's: cut the two lids out and join their rims.
    vertices = np.round(np.asarray(trough.vertices), 9)
    vertices[len(outer.vertices) :, 2] = np.minimum(vertices[len(outer.vertices) :, 2], 0.02)
    top = (vertices[trough.faces][:, :, 2] == 0.02).all(axis=1)
    faces = list(np.asarray(trough.faces)[~top])
    rim = {}
    for part, half in (("out", 0.03), ("in", 0.028)):
        ring = [(half, half), (-half, half), (-half, -half), (half, -half)]
        rim[part] = [
            int(np.flatnonzero(np.abs(vertices - (*p, 0.02)).max(axis=1) < 1e-9)[0]) for p in ring
        ]
    for k in range(4):
        a, b = rim["out"][k], rim["out"][(k + 1) % 4]
        c, d = rim["in"][(k + 1) % 4], rim["in"][k]
        faces += [[a, b, c], [a, c, d]]
    glass = Mesh(vertices, np.array(faces, np.int32))
    water = scenes.box(0.0562, 0.0562, 0.0281, (0.0, 0.0, -0.00395 - 0.0001))
    share, sigma = transmitted(
        body("Trough", glass, GLASS, priority=1), body("Water", water, WATER)
    )
    truth = stacked(reflectance(1, WATER), reflectance(WATER, GLASS), reflectance(GLASS, 1))
    assert share == pytest.approx(truth, abs=4 * sigma)


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_water_inside_glass_at_normal_incidence(turn):
    """The inner one of equal priority is there: glass, water, glass."""
    share, sigma = transmitted(
        body("Glass", slab(0.03), GLASS), body("Water", slab(0.02, side=0.08, turn=turn), WATER)
    )
    outer, inner = reflectance(1, GLASS), reflectance(GLASS, WATER)
    assert share == pytest.approx(stacked(outer, inner, inner, outer), abs=4 * sigma)


def test_overlapping_slabs_meet_where_the_harder_one_ends():
    """Glass above, water below, 0.1 mm of both: the surface is the glass's."""
    glass, water = slab(0.01, 0.0099 / 2), slab(0.01, -0.0099 / 2, side=0.09)
    truth = stacked(reflectance(1, GLASS), reflectance(GLASS, WATER), reflectance(WATER, 1))
    for hard, soft in ((1, 0), (0, 0), (-1, -2)):
        share, sigma = transmitted(
            body("Glass", glass, GLASS, hard), body("Water", water, WATER, soft)
        )
        assert share == pytest.approx(truth, abs=4 * sigma)


def test_priority_says_where_the_surface_lies():
    """Tinted water and clear glass over 5 mm of each other: the tint is in what is left of it."""
    sigma = 100.0
    glass, water = slab(0.01, 0.005), slab(0.01, 0.0, side=0.09)
    for priority, length in ((1, 0.005), (-1, 0.010)):
        share, spread = transmitted(
            body("Glass", glass, 1.0, priority), body("Water", water, 1.0, absorption=sigma)
        )
        assert share == pytest.approx(np.exp(-sigma * length), abs=4 * spread)


def test_a_bubble_is_a_body_of_air_or_a_void():
    """A ball of air in glass: as a body of index 1, or as an inward face of the glass."""
    ball = scenes.sphere(0.008, 5)
    ball = Mesh(ball.vertices, ball.faces)
    block = slab(0.03)
    void = Mesh(
        np.concatenate([block.vertices, ball.vertices]),
        np.concatenate([block.faces, ball.faces[:, ::-1] + len(block.vertices)]).astype(np.int32),
    )
    ways = [
        (body("Block", block, GLASS), body("Air", ball, 1.0)),
        (body("Block", block, GLASS, -2), body("Air", ball, 1.0, -1)),
        (body("Block", void, GLASS),),
    ]
    shares = [transmitted(*bodies, width=0.014) for bodies in ways]
    outer = reflectance(1, GLASS)
    assert shares[0][0] < 0.97 * stacked(outer, outer)
    for share, sigma in shares[1:]:
        assert share == pytest.approx(shares[0][0], abs=4 * np.hypot(sigma, shares[0][1]))


def test_overlapping_boxes_of_one_glass_are_one():
    upper, lower = slab(0.012, 0.005), slab(0.012, -0.005, side=0.09)
    share, sigma = transmitted(body("Upper", upper, GLASS), body("Lower", lower, GLASS))
    outer = reflectance(1, GLASS)
    assert share == pytest.approx(stacked(outer, outer), abs=4 * sigma)


def test_overlapping_rough_boxes_of_one_glass_are_ground_only_outside():
    """Rough faces that lie within the other body of the same glass take no light."""
    upper, lower = slab(0.012, 0.005), slab(0.012, -0.005, side=0.09)
    two = transmitted(
        body("Upper", upper, GLASS, 1, roughness=0.3), body("Lower", lower, GLASS, roughness=0.3)
    )
    one = transmitted(body("One", slab(0.022), GLASS, roughness=0.3))
    # Only the lower one's buried face is no surface; the upper's is one between equal glasses.
    three = transmitted(body("Upper", upper, GLASS, 1), body("Lower", lower, GLASS, roughness=0.3))
    assert two[0] < one[0] + 4 * np.hypot(one[1], two[1])
    half = transmitted(body("Upper", upper, GLASS), body("Lower", lower, GLASS))
    assert three[0] < half[0]


def test_what_hides_another_is_named():
    inner, outer = slab(0.01, side=0.05), slab(0.03)
    scene = [body("Inner ä", inner, WATER, 0), body("Outer ß", outer, GLASS, 1)]
    with pytest.raises(SceneError, match="“Inner ä” lies wholly inside “Outer ß”"):
        transmitted(*scene)


@pytest.mark.parametrize(
    "other",
    [
        slab(0.01, -0.01),  # the same square
        slab(0.01, -0.01, side=0.3),  # a larger one
        slab(0.01, -0.01, turn=0.4),  # a turned one
        scenes.box(0.1, 0.1, 0.01, (0.05, 0.05, -0.01)),  # a quarter of it
        scenes.box(0.1, 0.1, 0.03, (0.05, 0.0, 0.01)),  # reaching into it, one face in common
    ],
)
def test_glass_that_touches_glass_face_to_face_is_named(other):
    with pytest.raises(SceneError, match=r"“.*” touches “.*” face to face"):
        transmitted(body("Upper", slab(0.01), GLASS), body("Lower", other, WATER))


def test_a_round_one_that_fits_its_sleeve_exactly_is_named():
    pipe = trimesh.creation.annulus(0.01, 0.012, 0.04, sections=64)
    core = trimesh.creation.cylinder(0.01, 0.02, sections=64)
    tube, rod = (Mesh(np.asarray(m.vertices), np.asarray(m.faces, np.int32)) for m in (pipe, core))
    with pytest.raises(SceneError, match="face to face"):
        transmitted(body("Tube", tube, GLASS), body("Rod", rod, WATER))


@pytest.mark.parametrize(
    "other",
    [
        slab(0.01, -0.0101),  # 0.1 mm below
        slab(0.01, -0.0099, side=0.09),  # 0.1 mm into it
        scenes.box(0.1, 0.1, 0.01, (0.0, 0.2, 0.0)),  # beside it, at one level
        scenes.box(0.1, 0.1, 0.01, (0.0, 0.101, 0.0)),  # 1 mm beside it, at one level
    ],
)
def test_glass_that_only_comes_near_is_taken(other):
    share, _ = transmitted(body("Upper", slab(0.01), GLASS), body("Lower", other, WATER))
    assert 0.8 < share < 1.0


def test_touching_is_found_quickly_in_fine_meshes():
    """Two spheres of 80,000 faces, one 0.1 mm inside the other."""
    import time

    from heliform.engines.light import media

    bodies = (
        body("Outer", scenes.sphere(0.05, 6), GLASS),
        body("Inner", scenes.sphere(0.0499, 6), WATER),
    )
    began = time.perf_counter()
    media.media_of(bodies, None)
    assert time.perf_counter() - began < 3.0


def test_a_lamp_inside_glass_is_named():
    lamp = Luminaire("Lämp/1", Lamp(source="point", flux=100.0), np.eye(4))
    scene = Scene((body("Vase ä/1", slab(0.03), GLASS),), (lamp,), (scenes.floor(0.2, 8),))
    with pytest.raises(SceneError, match="Lamp “Lämp/1” lies inside the glass of “Vase ä/1”"):
        trace(scene, LANDED)


def test_a_lamp_in_the_hollow_of_a_glass_is_none_inside_it():
    ball, hollow = scenes.sphere(0.02, 4), scenes.sphere(0.018, 4)
    shell = Mesh(
        np.concatenate([ball.vertices, hollow.vertices]),
        np.concatenate([ball.faces, hollow.faces[:, ::-1] + len(ball.vertices)]).astype(np.int32),
    )
    lamp = Luminaire("Bulb", Lamp(source="point", flux=100.0), np.eye(4))
    scene = Scene((body("Globe", shell, GLASS),), (lamp,), (scenes.floor(0.2, 8, scenes.at(z=-1)),))
    flux = trace(scene, PhotonTracing(until="landed", landed=2000), seed=1).meta["flux"]
    assert flux["absorbed"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("count", [31, 32])
def test_there_are_31_media_at_most(count):
    places = [(0.01 * (k % 8), 0.01 * (k // 8), 0.0) for k in range(count)]
    cubes = tuple(
        body(f"Cube {k}", scenes.box(0.005, 0.005, 0.005, place), 1.0, absorption=500.0)
        for k, place in enumerate(places)
    )
    lamp = scenes.sheet(100.0, 0.005, 0.005, scenes.at(*places[-1][:2], 0.1))
    scene = Scene(cubes, (lamp,), (scenes.floor(0.2, 8, scenes.at(z=-0.1)),))
    if count > 31:
        with pytest.raises(SceneError, match="32 transparent bodies; join some, 31 can be"):
            trace(scene, LANDED)
        return
    flux = trace(scene, LANDED, seed=1).meta["flux"]
    # The last one's bit is the highest that there is.
    assert flux["landed"] / flux["emitted"] == pytest.approx(np.exp(-2.5), rel=0.02)
