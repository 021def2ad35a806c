"""What a user can get wrong, and what comes of it: one sentence that names it, or it works."""

import numpy as np
import pytest
from heliform.engines.core.errors import Cancelled, FileError, SceneError
from heliform.engines.core.scene import Body, Lamp, Luminaire, Material, Mesh, Scene
from heliform.engines.light import PhotonTracing, trace
from light import scenes

QUICK = PhotonTracing(until="landed", landed=20_000)
LAMP = Luminaire("Spot", Lamp(source="disk", flux=500.0, width=0.02), scenes.at(z=0.2))
FLOOR = scenes.floor(0.4, 32)
BALL = scenes.sphere(0.03, 4)


def lifted(mesh: Mesh) -> Mesh:
    return mesh.moved(scenes.at(z=0.05))


def with_body(mesh: Mesh, name="Vase ä/1") -> Scene:
    return Scene((Body(name, lifted(mesh), scenes.GLASS),), (LAMP,), (FLOOR,))


def opened(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces[3:], None)


def turned_inside_out(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, np.ascontiguousarray(mesh.faces[:, ::-1]), None)


def test_no_lamp():
    with pytest.raises(SceneError, match="no lamp"):
        trace(Scene((), (), (FLOOR,)), QUICK)


def test_no_receiver():
    with pytest.raises(SceneError, match="no receiver"):
        trace(Scene((), (LAMP,), ()), QUICK)


def test_no_glass_works_and_says_so():
    result = scenes.traced(Scene((), (LAMP,), (FLOOR,)), QUICK)
    assert result.mean > 0
    assert not result.caustic.any()
    assert "direct light only" in result.meta["notes"][0]


def test_a_lamp_that_shines_past_the_glass_works_and_says_so():
    lamp = Luminaire("Beam", Lamp(source="beam", flux=1.0, width=0.01), scenes.at(x=0.15, z=0.2))
    result = scenes.traced(
        Scene((Body("Ball", lifted(BALL), scenes.GLASS),), (lamp,), (FLOOR,)), QUICK
    )
    spread = result.meta["mean_half_width"] / result.mean
    assert result.meta["flux"]["landed"] == pytest.approx(1.0, rel=2 * spread)
    assert spread < 0.3
    assert "direct light only" in result.meta["notes"][0]


@pytest.mark.parametrize(
    ("broken", "said"), [(opened, "is open"), (turned_inside_out, "is inside out")]
)
def test_broken_glass_is_said_and_mended_on_request(broken, said):
    scene = with_body(broken(BALL))
    with pytest.raises(SceneError, match="Vase ä/1") as error:
        trace(scene, QUICK)
    assert said in str(error.value)
    assert "Repair" in str(error.value)
    mended = scenes.traced(
        scene, PhotonTracing(until="landed", landed=200_000, repair=True), seed=1
    )
    assert any("Vase ä/1" in note for note in mended.meta["notes"])
    whole = scenes.traced(
        with_body(Mesh(BALL.vertices, BALL.faces)),
        PhotonTracing(until="landed", landed=200_000),
        seed=1,
    )
    both = np.hypot(mended.meta["mean_half_width"], whole.meta["mean_half_width"])
    assert mended.mean == pytest.approx(whole.mean, abs=2.5 * both)


def test_a_body_without_faces_is_named():
    empty = Mesh(np.zeros((3, 3)), np.zeros((0, 3), np.int32))
    with pytest.raises(SceneError, match="Vase ä/1"):
        trace(with_body(empty), QUICK)


@pytest.mark.parametrize("material", [scenes.GLASS, Material(kind="mirror")])
def test_a_body_whose_faces_have_no_area_is_named(material):
    line = Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]], np.int32))
    with pytest.raises(SceneError, match="Vase ä/1"):
        trace(Scene((Body("Vase ä/1", line, material),), (LAMP,), (FLOOR,)), QUICK)


def test_vertices_that_are_no_numbers_are_named():
    vertices = BALL.vertices.copy()
    vertices[5] = np.nan
    with pytest.raises(SceneError, match="Vase ä/1"):
        trace(with_body(Mesh(vertices, BALL.faces)), QUICK)


def test_a_lamp_without_flux_or_opening_is_named():
    dark = Luminaire("Lämp/1", Lamp(source="disk"), LAMP.pose)
    with pytest.raises(SceneError, match="Lämp/1” has no luminous flux"):
        trace(Scene((), (dark,), (FLOOR,)), QUICK)
    thin = Luminaire("Lämp/1", Lamp(source="beam", flux=1.0, width=0.0), LAMP.pose)
    with pytest.raises(SceneError, match="Lämp/1” is a beam without an opening"):
        trace(Scene((), (thin,), (FLOOR,)), QUICK)


def test_a_missing_photometric_file_is_named():
    lamp = Luminaire("Spot", Lamp(file="nowhere ä.ies"), LAMP.pose)
    with pytest.raises(FileError, match="nowhere ä"):
        trace(Scene((), (lamp,), (FLOOR,)), QUICK)


@pytest.mark.parametrize("moment", [0.0, 0.05, 0.1, 0.2, 0.5])
def test_cancel_is_heard_at_every_stage(moment):
    def stop(fraction, text):
        if fraction >= moment:
            raise Cancelled

    with pytest.raises(Cancelled):
        trace(with_body(BALL), PhotonTracing(until="landed", landed=3_000_000), progress=stop)


def test_every_material_keeps_the_account():
    """Mirror, matte, plastic and black bodies beside glass: all light is found again."""
    kinds = ("dielectric", "mirror", "diffuse", "plastic", "absorber")
    bodies = tuple(
        Body(kind, scenes.sphere(0.02, 4).moved(scenes.at(x, 0.0, 0.06)), Material(kind=kind))
        for kind, x in zip(kinds, (-0.1, -0.05, 0.0, 0.05, 0.1), strict=True)
    )
    for fresnel in ("averaged", "polarised"):
        tracing = PhotonTracing(until="landed", landed=300_000, direct="traced", fresnel=fresnel)
        result = scenes.traced(Scene(bodies, (LAMP,), (FLOOR,)), tracing, seed=2)
        flux = result.meta["flux"]
        parts = [flux[k] for k in ("landed", "absorbed", "escaped", "cut_off")]
        assert sum(parts) == pytest.approx(flux["emitted"], rel=2e-3)
        assert all(np.isfinite(parts))
        assert result.indirect.sum() > 0
        assert result.caustic.sum() > 0
