"""Light that receivers and matte bodies return: integrating cubes, white furnaces, accounts."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.core.scene import Body, Luminaire, Material, Mesh, Scene
from heliform.engines.light import PhotonTracing, trace
from light import scenes
from light.test_slab import reflectances, through

FLUX, SIDE = 10_000.0, 4.0
AREA = 6 * SIDE**2
LAMP = scenes.point(FLUX)
CIE = ((0.5, 104.0), (0.8, 417.0), (0.95, 1979.0))


def means(result, name):
    """The mean of a map over all receivers, and its standard error."""
    area = np.array([m.area.sum() for m in result.maps])
    mean = sum(a * m.mean_of(name) for a, m in zip(area, result.maps, strict=True)) / area.sum()
    error = np.sqrt(
        sum(
            (a * m.meta["traced_half_width"] / 1.96) ** 2
            for a, m in zip(area, result.maps, strict=True)
        )
    )
    return float(mean), float(error / area.sum())


def accounted(flux, rel=1e-4):
    parts = sum(flux[k] for k in ("landed", "absorbed", "escaped", "cut_off"))
    assert parts == pytest.approx(flux["emitted"], rel=rel)


@pytest.mark.parametrize(("reflectance", "published"), CIE)
@pytest.mark.parametrize("shape", ["planes", "mesh"])
def test_cie_171_integrating_cube(reflectance, published, shape):
    """CIE 171:2006 5.8: the mean indirect illuminance is ρΦ ÷ (A (1 − ρ))."""
    truth = reflectance * FLUX / (AREA * (1 - reflectance))
    assert truth == pytest.approx(published, abs=0.5)
    walls = scenes.room(SIDE, 16, reflectance=reflectance)
    if shape == "mesh":
        cube = scenes.inward(scenes.box(SIDE, SIDE, SIDE))
        walls = (scenes.surface(cube, 64, reflectance=reflectance),)
    result = trace(Scene((), (LAMP,), walls), PhotonTracing(until="landed", landed=400_000), seed=4)
    mean, error = means(result, "indirect")
    assert mean == pytest.approx(truth, abs=3 * error)
    assert error < 2.5e-3 * truth
    direct, _ = means(result, "direct")
    assert direct == pytest.approx(FLUX / AREA, rel=2e-3)
    # All light stays in the cube.
    flux = result.meta["flux"]
    accounted(flux)
    assert flux["landed"] == pytest.approx(FLUX, rel=5e-3)


@pytest.mark.parametrize("shape", ["planes", "mesh"])
def test_nothing_leaves_a_closed_cube(shape):
    """Every photon traced: what is not landed is what leaks through the edges."""
    walls = scenes.room(SIDE, 8, reflectance=0.8)
    if shape == "mesh":
        cube = scenes.inward(scenes.box(SIDE, SIDE, SIDE))
        walls = (scenes.surface(cube, 32, reflectance=0.8),)
    tracing = PhotonTracing(until="landed", landed=400_000, direct="traced")
    flux = trace(Scene((), (LAMP,), walls), tracing, seed=4).meta["flux"]
    assert flux["escaped"] < 2e-5 * FLUX
    assert flux["absorbed"] < 2e-5 * FLUX
    accounted(flux)


@pytest.mark.parametrize("direct", ["computed", "traced"])
@pytest.mark.parametrize("shape", ["planes", "mesh", "sphere"])
def test_white_furnace(shape, direct):
    """A closed room whose whole light is Φ ÷ (A (1 − ρ)) on the average; a sphere's, everywhere."""
    reflectance, area = 0.7, AREA
    if shape == "planes":
        walls = scenes.room(SIDE, 8, reflectance=reflectance)
    else:
        ball = scenes.sphere(1.0, 4)
        mesh = scenes.box(SIDE, SIDE, SIDE) if shape == "mesh" else ball
        walls = (scenes.surface(scenes.inward(mesh), 48, reflectance=reflectance),)
        area = walls[0].mesh
        corners = area.vertices[area.faces]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(cross, axis=1).sum() / 2
    tracing = PhotonTracing(until="landed", landed=400_000, direct=direct)
    result = trace(Scene((), (LAMP,), walls), tracing, seed=1)
    truth = FLUX / (area * (1 - reflectance))
    mean, error = means(result, "illuminance")
    assert mean == pytest.approx(truth, abs=3 * error + 2e-3 * FLUX / area)
    if shape == "sphere":
        only = result.maps[0]
        inside = only.inside
        covered = (only.lower <= truth) & (truth <= only.upper)
        assert covered[inside].mean() > 0.92


def test_a_black_leaf_between_two_lamps_is_lit_alike_on_both_sides():
    leaf = replace(scenes.floor(1.0, 4), name="Leaf", sides="both")
    walls = scenes.room(SIDE, 4, reflectance=0.8)
    lamps = scenes.point(FLUX, z=1.0), scenes.point(FLUX, z=-1.0)
    result = trace(
        Scene((), lamps, (*walls, leaf)), PhotonTracing(until="landed", landed=500_000), seed=2
    )
    front, back = result.maps[-2:]
    assert (front.name, back.name) == ("Leaf (front)", "Leaf (back)")
    np.testing.assert_allclose(front.direct, back.direct, rtol=1e-4)
    error = np.hypot(*(m.meta["traced_half_width"] / 1.96 for m in (front, back)))
    assert back.mean_of("indirect") == pytest.approx(front.mean_of("indirect"), abs=3 * error)
    assert error < 0.02 * back.mean_of("indirect")


@pytest.mark.parametrize("where", ["before", "behind"])
def test_a_matte_body_before_or_behind_glass_adds_indirect_light(where):
    """A lit matte plate beside the receiver, seen through a pane or lighting the pane first."""
    pane = Body("Pane", scenes.box(0.4, 0.4, 0.004, (0, 0, 0.1)), Material())
    height = 0.2 if where == "before" else 0.05
    plate = Body(
        "Plate",
        scenes.box(0.01, 0.4, 0.08, (0.15, 0, height)),
        Material(kind="diffuse", reflectance=0.8),
    )
    lamp = Luminaire(
        "Spot", scenes.beam(1000.0, 0.2, np.eye(4)).lamp, scenes.at(-0.3, 0, 0.5, (0.7, 0, -0.6))
    )
    floor = scenes.floor(0.6, 24)
    tracing = PhotonTracing(until="landed", landed=200_000)
    clear = scenes.traced(Scene((pane,), (lamp,), (floor,)), tracing, seed=1)
    assert clear.indirect.max() == 0.0
    result = scenes.traced(Scene((pane, plate), (lamp,), (floor,)), tracing, seed=1)
    assert result.indirect.sum() > 0
    assert result.caustic.sum() > 0
    accounted(result.meta["flux"])


@pytest.mark.parametrize("shape", ["plane", "mesh", "leaning"])
@pytest.mark.parametrize("gap", [1e-3, 1e-7, 0.0])
@pytest.mark.parametrize("reflectance", [0.0, 0.8])
def test_what_a_table_returns_goes_through_the_glass_on_it(shape, gap, reflectance):
    """A pane on a table under an even beam: the series of what pane and table hand over."""
    thick, side = 0.01, 8.0
    pose = scenes.at(axis=(0.3, 0.2, -0.9)) if shape == "leaning" else np.eye(4)
    if shape == "mesh":
        half = side / 2
        corners = [[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]]
        table = Mesh(np.array(corners), np.array([[0, 1, 2], [0, 2, 3]], np.int32))
        table = scenes.surface(table, 64, reflectance=reflectance)
    else:
        table = replace(scenes.floor(side, 1, pose), reflectance=reflectance)
    pane = scenes.glass(scenes.box(side, side, thick, (0, 0, thick / 2 + gap)).moved(pose))
    above = np.eye(4)
    above[2, 3] = 0.5
    lamp = scenes.sheet(1000.0, 0.2, 0.2, pose @ above)
    tracing = PhotonTracing(until="landed", landed=300_000)
    meta = scenes.traced(Scene((pane,), (lamp,), (table,)), tracing, seed=1).meta
    share = meta["flux"]["landed"] / meta["flux"]["emitted"]
    # Light meets the pane straight; what the table sends back meets it from all directions.
    straight = through(0.04)
    angle = np.degrees(np.arcsin(np.sqrt((np.arange(1000) + 0.5) / 1000)))
    diffuse = np.mean([through(sum(reflectances(a)) / 2) for a in angle])
    truth = straight * (1 - reflectance) / (1 - reflectance * (1 - diffuse))
    sigma = np.sqrt(truth * (1 - truth) / meta["photons"]["emitted"])
    assert share == pytest.approx(truth, abs=4 * sigma + 2e-4)


@pytest.mark.parametrize("shape", ["plane", "mesh"])
@pytest.mark.parametrize("reflectance", [0.0, 0.5])
def test_a_lamp_let_into_a_ceiling_shines(shape, reflectance):
    """A downlight in the very plane of the ceiling receiver."""
    ceiling = scenes.floor(2.0, 8, scenes.at(z=3.0, axis=(0, 0, 1.0)))
    ceiling = replace(ceiling, name="Ceiling", reflectance=reflectance)
    if shape == "mesh":
        half = 1.0
        corners = np.array([[-half, -half, 3], [-half, half, 3], [half, half, 3], [half, -half, 3]])
        mesh = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
        ceiling = scenes.surface(mesh, 8, reflectance=reflectance)
    floor = scenes.floor(2.0, 8)
    lamp = scenes.lambertian_point(1000.0, 3.0)
    truth = scenes.traced(Scene((), (lamp,), (floor,)), PhotonTracing()).mean
    for direct in ("computed", "traced"):
        tracing = PhotonTracing(until="landed", landed=200_000, direct=direct)
        result = trace(Scene((), (lamp,), (floor, ceiling)), tracing, seed=1)
        assert result.maps[0].mean_of("direct") == pytest.approx(truth, rel=0.02)
        assert result.maps[1].mean_of("direct") == 0.0


def test_a_receiver_that_returns_all_is_named():
    walls = scenes.room(SIDE, 4, reflectance=1.0)
    with pytest.raises(SceneError, match="“Wall 0” returns all light"):
        trace(Scene((), (LAMP,), walls), PhotonTracing())
