"""Many receivers, both sides, meshes: each gathers what the closed form says."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Body, Lamp, Luminaire, Material, Mesh, Scene, Surface
from heliform.engines.light import PhotonTracing, trace
from light import scenes

QUICK = PhotonTracing(until="landed", landed=200_000)
CANDELA = 1000.0
POINT = 4 * np.pi * CANDELA


def as_mesh(receiver, cuts=1):
    """A plane as a mesh of cuts² squares whose map is the plane's own."""
    t = np.linspace(0, 1, cuts + 1)
    u, v = (a.ravel() for a in np.meshgrid(t, t))
    vertices = receiver.origin + u[:, None] * receiver.u + v[:, None] * receiver.v
    row, column = np.divmod(np.arange(cuts * cuts), cuts)
    a = row * (cuts + 1) + column
    b, c, d = a + 1, a + cuts + 2, a + cuts + 1
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    texture = np.stack([u, v], axis=1)[faces]
    return Surface(
        receiver.name,
        Mesh(vertices, faces),
        texture,
        receiver.columns,
        receiver.rows,
        receiver.sides,
        receiver.reflectance,
    )


def within(result, truth, slack=0.0):
    """Share of the surface's texels whose interval, widened by ``slack``, holds the truth."""
    low, high = result.lower * (1 - slack), result.upper * (1 + slack)
    return float(((low <= truth) & (truth <= high))[result.inside].mean())


def test_planes_that_do_not_see_each_other_are_each_as_alone():
    ball = scenes.glass(scenes.sphere(0.03, 5))
    lamp = scenes.point(POINT, x=0.05, z=0.1)
    planes = [
        replace(scenes.floor(0.2, 16, scenes.at(0, 0, -0.1)), name="Below"),
        replace(scenes.floor(0.2, 16, scenes.at(-0.2, 0, 0, (-1, 0, 0))), name="Left"),
        replace(scenes.floor(0.2, 16, scenes.at(0, 0.2, 0, (0, 1, 0))), name="Behind"),
    ]
    tracing = PhotonTracing(until="landed", landed=20_000)
    together = trace(Scene((ball,), (lamp,), tuple(planes)), tracing, seed=1)
    assert [m.name for m in together.maps] == ["Below", "Left", "Behind"]
    assert "Below.mean_illuminance" in together.figures()
    for plane, shared in zip(planes, together.maps, strict=True):
        alone = scenes.traced(Scene((ball,), (lamp,), (plane,)), tracing, seed=2)
        spread = np.hypot(shared.half_width, alone.half_width) + 1e-4 * alone.direct
        assert (np.abs(shared.illuminance - alone.illuminance) <= spread).mean() > 0.93
        both = np.hypot(shared.meta["traced_half_width"], alone.meta["traced_half_width"])
        assert shared.mean_of("caustic") == pytest.approx(alone.mean_of("caustic"), abs=1.5 * both)
        assert shared.mean_of("caustic") > 3 * both


@pytest.mark.parametrize("direct", ["computed", "traced"])
@pytest.mark.parametrize("shape", ["plane", "mesh"])
def test_the_nearer_plane_shades_the_farther(direct, shape):
    """A square of 0.4 m halfway under a point: on the floor a shadow of 0.8 m."""
    upper, lower = scenes.floor(0.4, 16, scenes.at(z=0.5)), scenes.floor(2.0, 40)
    upper = replace(upper, name="Upper")
    receivers = (upper, lower) if shape == "plane" else (as_mesh(upper), as_mesh(lower))
    tracing = PhotonTracing(until="landed", landed=1_500_000, direct=direct)
    result = trace(Scene((), (scenes.point(POINT, z=1.0),), receivers), tracing, seed=1)
    for found, plane, height in zip(result.maps, (upper, lower), (0.5, 1.0), strict=True):
        places = scenes.texel_centres(plane)
        across = np.hypot(places[..., 0], places[..., 1])
        truth = CANDELA * height / (across**2 + height**2) ** 1.5
        if found.name == "Floor":
            truth[np.abs(places[..., :2]).max(axis=-1) < 0.4] = 0.0
        if direct == "computed":
            np.testing.assert_allclose(found.illuminance, truth, rtol=4e-3, atol=1e-3)
        else:
            assert within(found, truth, 4e-3) > 0.93


@pytest.mark.parametrize("direct", ["computed", "traced"])
@pytest.mark.parametrize("shape", ["plane", "mesh"])
def test_each_side_has_its_own_lamp(direct, shape):
    plane = replace(scenes.floor(1.0, 20), sides="both")
    lamps = scenes.point(POINT, z=1.0), scenes.point(POINT / 2, z=-0.5)
    receiver = plane if shape == "plane" else as_mesh(plane)
    tracing = PhotonTracing(until="landed", landed=1_000_000, direct=direct)
    result = trace(Scene((), lamps, (receiver,)), tracing, seed=1)
    places = scenes.texel_centres(plane)
    square = places[..., 0] ** 2 + places[..., 1] ** 2
    for found, height, candela in zip(result.maps, (1.0, 0.5), (CANDELA, CANDELA / 2), strict=True):
        truth = candela * height / (square + height**2) ** 1.5
        if direct == "computed":
            np.testing.assert_allclose(found.illuminance, truth, rtol=4e-3)
        else:
            assert within(found, truth, 2e-3) > 0.93


def test_the_back_of_a_one_sided_plane_is_black():
    """Light from behind neither passes nor counts."""
    scene = Scene((), (scenes.point(POINT, z=-0.5),), (scenes.floor(1.0, 4),))
    for direct in ("computed", "traced"):
        tracing = PhotonTracing(until="landed", landed=100_000, direct=direct, at_most=5.0)
        result = scenes.traced(scene, tracing, seed=1)
        assert result.illuminance.max() == 0.0
    assert result.meta["flux"]["absorbed"] > 0


@pytest.mark.parametrize("direct", ["computed", "traced"])
@pytest.mark.parametrize(("subdivisions", "resolution"), [(4, 64), (4, 24), (2, 128)])
def test_inside_of_a_sphere_around_a_point(direct, subdivisions, resolution):
    """I ÷ r² everywhere; a ball of flat faces has I cos ÷ d² at most a little off."""
    radius = 0.5
    ball = scenes.inward(scenes.sphere(radius, subdivisions))
    receiver = scenes.surface(ball, resolution)
    tracing = PhotonTracing(until="landed", landed=1_000_000, direct=direct)
    result = scenes.traced(Scene((), (scenes.point(POINT),), (receiver,)), tracing, seed=1)
    truth = CANDELA / radius**2
    flat = {4: 0.01, 2: 0.1}[subdivisions]
    if direct == "computed":
        inside = result.illuminance[result.inside]
        assert np.abs(inside / truth - 1).max() < flat
        assert result.half_width[result.inside].max() < flat * truth
    else:
        assert within(result, truth, flat) > 0.93
    # A texel a fifth of the radius wide is taken for flat.
    assert result.meta["flux"]["landed"] == pytest.approx(POINT, rel=6e-3)
    assert (result.illuminance * result.area).sum() == pytest.approx(POINT, rel=6e-3)


@pytest.mark.parametrize("direct", ["computed", "traced"])
def test_outside_of_a_sphere_beside_a_point(direct):
    """I cos θ ÷ d² on the lit part, nothing behind its edge, and all that the ball subtends."""
    radius, distance = 0.3, 0.9
    receiver = scenes.surface(scenes.sphere(radius, 5), 96)
    lamp = scenes.point(POINT, x=distance)
    tracing = PhotonTracing(until="landed", landed=1_000_000, direct=direct)
    result = scenes.traced(Scene((), (lamp,), (receiver,)), tracing, seed=1)
    from heliform.engines.core import atlas

    chart = atlas.texels(receiver)
    normal = chart.place / np.maximum(np.linalg.norm(chart.place, axis=-1, keepdims=True), 1e-9)
    ray = [distance, 0.0, 0.0] - chart.place
    reach = np.linalg.norm(ray, axis=-1)
    cosine = (normal * ray).sum(axis=-1) / reach
    truth = CANDELA * np.maximum(cosine, 0) / reach**2
    inside = result.inside
    # What the texels at the very edge of the light have is neither.
    clear = inside & (np.abs(cosine) > 0.06)
    assert result.illuminance[clear & (cosine < 0)].max() == 0.0
    if direct == "computed":
        error = np.abs(result.illuminance - truth)[clear]
        assert error.max() < 0.012 * truth.max()
    else:
        low, high = result.lower - 0.012 * truth.max(), result.upper + 0.012 * truth.max()
        assert ((low <= truth) & (truth <= high))[clear].mean() > 0.95
    subtended = POINT * (1 - np.sqrt(1 - (radius / distance) ** 2)) / 2
    assert result.meta["flux"]["landed"] == pytest.approx(subtended, rel=6e-3)


@pytest.mark.parametrize("side", ["inner", "outer"])
def test_a_cylinder_about_the_axis_of_a_point(side):
    """Inside: I r ÷ (r² + z²)^1.5; outside, nothing."""
    radius, height = 0.3, 0.8
    made = trimesh.creation.cylinder(radius, height, sections=256)
    made.update_faces(np.abs(made.face_normals[:, 2]) < 0.5)
    mesh = Mesh(np.asarray(made.vertices), np.asarray(made.faces, np.int32))
    if side == "inner":
        mesh = scenes.inward(mesh)
    receiver = scenes.surface(mesh, 128)
    result = scenes.traced(Scene((), (scenes.point(POINT),), (receiver,)), QUICK, seed=1)
    if side == "outer":
        assert result.illuminance.max() == 0.0
        return
    from heliform.engines.core import atlas

    z = atlas.texels(receiver).place[..., 2]
    truth = CANDELA * radius / (radius**2 + z**2) ** 1.5
    inside = result.inside
    np.testing.assert_allclose(result.illuminance[inside], truth[inside], rtol=0.01)
    whole = POINT * (height / 2) / np.hypot(height / 2, radius)
    assert result.meta["flux"]["landed"] == pytest.approx(whole, rel=3e-3)


@pytest.mark.parametrize("cuts", [1, 7])
@pytest.mark.parametrize("sides", ["front", "both"])
def test_a_rectangle_as_a_mesh_is_the_plane(cuts, sides):
    """Behind a glass ball: the same caustic and the same shadow, each in its own interval."""
    ball = scenes.glass(scenes.sphere(0.02, 5))
    plane = replace(scenes.floor(0.08, 24, scenes.at(z=-0.04)), sides=sides)
    lamp = scenes.lambertian_point(CANDELA, 0.15)
    maps = [
        trace(Scene((ball,), (lamp,), (receiver,)), QUICK, seed=seed).maps
        for seed, receiver in ((1, plane), (2, as_mesh(plane, cuts)))
    ]
    flat, mesh = maps[0][0], maps[1][0]
    np.testing.assert_allclose(mesh.area, flat.area, rtol=1e-5)
    spread = 2 * np.hypot(flat.half_width, mesh.half_width) + 1e-3 * flat.illuminance
    assert (np.abs(mesh.illuminance - flat.illuminance) <= spread).mean() > 0.99
    assert (np.abs(mesh.illuminance - flat.illuminance) <= spread / 2).mean() > 0.9
    if sides == "both":
        assert maps[0][1].illuminance.max() == maps[1][1].illuminance.max() == 0.0


@pytest.mark.parametrize("tilt", [(0, 0, -1.0), (0.3, 0.2, -1.0)])
def test_traced_light_is_the_computed_light_beside_glass(tilt):
    ball = scenes.glass(scenes.sphere(0.02, 4).moved(scenes.at(z=0.05)))
    lamp = Luminaire("Disk", Lamp(source="disk", flux=500.0, width=0.03), scenes.at(z=0.2))
    half = scenes.surface(scenes.sphere(0.05, 4).moved(scenes.at(0.1, 0.0, 0.05)), 48)
    receivers = (scenes.floor(0.3, 16, scenes.at(z=-0.02, axis=tilt)), half)
    results = [
        trace(
            Scene((ball,), (lamp,), receivers),
            PhotonTracing(until="landed", landed=400_000, direct=direct),
            seed=3,
        )
        for direct in ("computed", "traced")
    ]
    for computed, traced in zip(results[0].maps, results[1].maps, strict=True):
        inside = computed.inside
        apart = np.abs(computed.illuminance - traced.illuminance)[inside]
        spread = np.hypot(computed.half_width, traced.half_width)[inside]
        spread += 0.01 * computed.illuminance[inside] + 1e-3 * computed.illuminance.max()
        assert (apart <= spread).mean() > 0.93
        assert (apart <= 2.5 * spread).mean() > 0.995
        flux = [(m.illuminance * m.area).sum() for m in (computed, traced)]
        assert flux[0] == pytest.approx(flux[1], rel=0.01)
    accounts = [r.meta["flux"] for r in results]
    assert accounts[0]["landed"] == pytest.approx(accounts[1]["landed"], rel=0.01)


@pytest.mark.parametrize("resolution", [16, 64])
def test_flux_on_a_mesh_is_the_flux_on_its_map(resolution):
    """A printed-like tube as a receiver: what the account says is what the map holds."""
    made = trimesh.creation.annulus(0.03, 0.032, 0.1, sections=96)
    mesh = Mesh(np.asarray(made.vertices), np.asarray(made.faces, np.int32))
    receiver = scenes.surface(mesh, resolution)
    lamp = scenes.point(POINT, 0.02, 0.01, 0.09)
    tracing = PhotonTracing(until="landed", landed=200_000, direct="traced")
    result = scenes.traced(Scene((), (lamp,), (receiver,)), tracing, seed=1)
    flux = result.meta["flux"]
    found = (result.illuminance.astype(float) * result.area).sum()
    assert found == pytest.approx(flux["landed"], rel=1e-3)
    assert result.area.sum() == pytest.approx(made.area, rel=1e-5)
    assert flux["absorbed"] == 0.0


@pytest.mark.parametrize("resolution", [8, 64])
def test_a_thin_plate_on_a_coarse_mesh_keeps_its_shadow(resolution):
    """A black plate 1 mm thick that lies on a table: the table is dark below it."""
    table = as_mesh(scenes.floor(1.6, resolution))
    plate = Body("Plate", scenes.box(0.8, 0.8, 1e-3, (0, 0, 5e-4)), Material(kind="absorber"))
    lamp = scenes.point(POINT, z=1.0)
    result = scenes.traced(Scene((plate,), (lamp,), (table,)), QUICK, seed=1)
    places = scenes.texel_centres(scenes.floor(1.6, resolution))
    under = np.abs(places[..., :2]).max(axis=-1) < 0.39
    assert result.illuminance[under].max() < 1e-3
    assert result.illuminance[~under & (np.abs(places[..., :2]).max(axis=-1) > 0.41)].min() > 100


@pytest.mark.parametrize("resolution", [48, 96])
def test_the_walls_of_a_box_are_lit_into_their_corners(resolution):
    """Inside of a cube as one mesh: E = I h ÷ d³ at each texel's middle, to its very edge."""
    side = 1.0
    receiver = scenes.surface(scenes.inward(scenes.box(side, side, side)), resolution)
    result = scenes.traced(Scene((), (scenes.point(POINT),), (receiver,)), QUICK, seed=1)
    from heliform.engines.core import atlas

    place = atlas.texels(receiver).place
    truth = CANDELA * (side / 2) / np.maximum(np.linalg.norm(place, axis=-1), 1e-9) ** 3
    inside = result.inside
    np.testing.assert_allclose(result.illuminance[inside], truth[inside], rtol=0.02)
    assert (result.illuminance * result.area).sum() == pytest.approx(POINT, rel=2e-3)


def test_a_large_leaning_plane_does_not_shade_itself():
    plane = scenes.floor(200.0, 32, scenes.at(0, 0, 0, (0.36, 0.48, -0.8)))
    other = replace(scenes.floor(1.0, 2, scenes.at(500.0, 0, 0)), name="Other")
    lamp = Luminaire(
        "Point", Lamp(source="point", flux=POINT), scenes.at(*(-20 * np.array((0.36, 0.48, -0.8))))
    )
    alone = scenes.traced(Scene((), (lamp,), (plane,)), QUICK)
    both = scenes.traced(Scene((), (lamp,), (plane, other)), QUICK)
    np.testing.assert_allclose(both.illuminance, alone.illuminance, rtol=1e-3)


# What cannot be traced


def square(texture=None, **more):
    made = as_mesh(scenes.floor(1.0, 8))
    return replace(
        made, name="Tisch ä/1", **({} if texture is None else {"texture": texture}), **more
    )


def refused(receiver, said):
    with pytest.raises(SceneError, match=said) as error:
        trace(Scene((), (scenes.point(POINT, z=1.0),), (receiver,)), QUICK)
    assert "Tisch ä/1" in str(error.value)


def test_overlapping_uvs_are_named():
    texture = square().texture.copy()
    texture[1] = texture[0]
    refused(square(texture), "overlapping UVs")


def test_uvs_outside_the_map_are_named():
    refused(square(square().texture * 1.5), "outside its map")


def test_a_receiver_without_area_is_named():
    made = square()
    refused(
        replace(made, mesh=Mesh(made.mesh.vertices * [1.0, 0.0, 0.0], made.mesh.faces)), "no area"
    )
    refused(
        replace(
            made,
            mesh=Mesh(made.mesh.vertices, np.zeros((0, 3), np.int32)),
            texture=np.zeros((0, 3, 2)),
        ),
        "no area",
    )


def test_a_receiver_of_no_numbers_is_named():
    made = square()
    vertices = made.mesh.vertices.copy()
    vertices[1] = np.nan
    refused(replace(made, mesh=Mesh(vertices, made.mesh.faces)), "not a number")


def test_faces_without_area_do_no_harm():
    """A square with a needle and a point among its faces gathers as without."""
    whole = square()
    faces = np.concatenate([[[0, 0, 1], [2, 2, 2]], whole.mesh.faces]).astype(np.int32)
    corners = np.zeros((2, 3, 2))
    thin = replace(
        whole,
        mesh=Mesh(whole.mesh.vertices, faces),
        texture=np.concatenate([corners, whole.texture]),
    )
    tracing = PhotonTracing(until="landed", landed=100_000, direct="traced")
    maps = [
        scenes.traced(Scene((), (scenes.point(POINT, z=1.0),), (one,)), tracing, seed=1)
        for one in (whole, thin)
    ]
    np.testing.assert_allclose(maps[0].illuminance, maps[1].illuminance, rtol=1e-4)
    np.testing.assert_allclose(maps[0].area, maps[1].area)


def test_a_lamp_that_is_dimmed_to_nothing_is_named():
    lit = Luminaire("Hell", Lamp(source="disk", flux=100.0), scenes.at(z=1.0))
    dark = Luminaire(
        "Dunkel ö/2", Lamp(source="disk", flux=100.0, multiplier=0.0), scenes.at(z=1.0)
    )
    with pytest.raises(SceneError, match="“Dunkel ö/2” has a multiplier of 0"):
        trace(Scene((), (lit, dark), (scenes.floor(1.0, 4),)), QUICK)


def test_more_texels_than_fit_are_refused():
    plane = replace(scenes.floor(1.0, 4), columns=20_000, rows=20_000)
    with pytest.raises(SceneError, match="lower their resolution"):
        trace(Scene((), (scenes.point(POINT, z=1.0),), (plane,)), QUICK)
