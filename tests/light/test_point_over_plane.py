"""Light in free space: CIE 171:2006, cases 5.2 and 5.4, with every photon traced."""

import numpy as np
import pytest
from heliform.engines.core.scene import Body, Lamp, Luminaire, Material, Mesh
from heliform.engines.light import PhotonTracing
from light import scenes

TRACED = PhotonTracing(until="landed", landed=4_000_000, direct="traced")


def test_lambertian_point_over_a_plane_gives_the_published_illuminances():
    """CIE 171 5.2: 1000 cd at 3 m; A 111.11, D 71.11, J 49.39 lx."""
    receiver = scenes.floor(4.0, 80)
    result = scenes.traced(
        scenes.scene(lamp=scenes.lambertian_point(1000.0, 3.0), receiver=receiver), TRACED, seed=1
    )
    place = scenes.texel_centres(receiver)
    truth = 1000.0 * 9.0 / ((place**2).sum(axis=2) + 9.0) ** 2
    off = (result.illuminance - truth) / (result.half_width / 1.96)
    assert np.mean(np.abs(off) < 1.96) == pytest.approx(0.95, abs=0.01)
    assert np.abs(off).max() < 5.5
    for x, y, lux in ((0.0, 0.0, 111.11), (1.5, 0.0, 71.11), (1.5, 1.5, 49.39)):
        here = np.hypot(place[..., 0] - x, place[..., 1] - y) < 0.04
        assert truth[here].mean() == pytest.approx(lux, rel=2e-3)
        near = np.hypot(place[..., 0] - x, place[..., 1] - y) < 0.25
        sigma = np.sqrt(np.square(result.half_width[near] / 1.96).sum()) / near.sum()
        assert result.illuminance[near].mean() == pytest.approx(truth[near].mean(), abs=3.3 * sigma)


def test_computed_direct_light_is_the_closed_form():
    receiver = scenes.floor(4.0, 80)
    result = scenes.traced(
        scenes.scene(lamp=scenes.lambertian_point(1000.0, 3.0), receiver=receiver), PhotonTracing()
    )
    place = scenes.texel_centres(receiver)
    truth = 1000.0 * 9.0 / ((place**2).sum(axis=2) + 9.0) ** 2
    np.testing.assert_allclose(result.direct, truth, rtol=5e-4)


@pytest.mark.parametrize("source", ["disk", "ies"])
@pytest.mark.parametrize("opening", ["round", "rectangular"])
def test_near_field_of_an_opening_traced_and_computed_agree(source, opening):
    lamp = Lamp(source=source, flux=800.0, opening=opening, width=0.08, length=0.2)
    luminaire = Luminaire("Near", lamp, scenes.at(0.03, -0.02, 0.15, axis=(0.3, 0.1, -1.0)))
    receiver = scenes.floor(0.6, 48)
    scene = scenes.scene(lamp=luminaire, receiver=receiver)
    traced, computed = scenes.traced(scene, TRACED, seed=2), scenes.traced(scene, PhotonTracing())
    off = (traced.illuminance - computed.illuminance) / (traced.half_width / 1.96)
    counted = computed.illuminance > 0.01 * computed.mean
    assert np.mean(np.abs(off[counted]) < 1.96) == pytest.approx(0.95, abs=0.02)


def test_shadow_of_a_black_disk_traced_and_computed_agree():
    """The penumbra of an opening, where visibility is sampled, within the stated interval."""
    lamp = Luminaire("Disk", Lamp(source="disk", flux=500.0, width=0.1), scenes.at(z=0.5))
    blocker = Body(
        "Blocker", scenes.box(0.2, 0.2, 0.002, (0.02, 0.0, 0.2)), Material(kind="absorber")
    )
    scene = scenes.scene(blocker, lamp=lamp, receiver=scenes.floor(1.0, 64))
    traced, computed = (
        scenes.traced(scene, TRACED, seed=3),
        scenes.traced(scene, PhotonTracing(), seed=3),
    )
    spread = np.hypot(traced.half_width, computed.half_width) / 1.96
    counted = computed.direct > 0.05 * computed.mean
    off = (traced.direct - computed.direct)[counted] / spread[counted]
    assert np.mean(np.abs(off) < 1.96) == pytest.approx(0.95, abs=0.02)
    for part in ("landed", "absorbed", "escaped"):
        assert traced.meta["flux"][part] == pytest.approx(computed.meta["flux"][part], abs=1.0)


def test_flux_in_a_black_room_is_all_found_again():
    """CIE 171 5.4: 10 klm in a closed black room; nothing is lost, nothing is counted twice."""
    walls = scenes.box(4.0, 4.0, 3.0, (0.0, 0.0, 1.5))
    inward = Mesh(walls.vertices, np.ascontiguousarray(walls.faces[:, ::-1]))
    room = Body("Room", inward, Material(kind="absorber"))
    lamp = Luminaire("Lamp", Lamp(source="point", flux=10_000.0), scenes.at(z=2.0))
    receiver = scenes.floor(3.9, 32, scenes.at(z=0.01, axis=(0, 0, -1)))
    flux = scenes.traced(scenes.scene(room, lamp=lamp, receiver=receiver), TRACED, seed=4).meta[
        "flux"
    ]
    parts = [flux[k] for k in ("landed", "absorbed", "escaped", "cut_off")]
    assert sum(parts) == pytest.approx(10_000.0, rel=1e-4)
    assert flux["escaped"] == 0.0
    half = 1.95 / 1.99
    solid_angle = 4 * np.arcsin(half**2 / (1 + half**2))
    assert flux["landed"] == pytest.approx(10_000.0 * solid_angle / (4 * np.pi), rel=0.003)
