"""Ground glass and satin mirrors against the integral over GGX's facets.

Facets are laid out evenly in the distribution of their normals, D(m) cos m: a rule of a million
points, apart from the way in which the tracer draws them [Walter et al. 2007; Heitz 2014].
"""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.scene import Body, Material, Scene
from heliform.engines.light import PhotonTracing, trace
from light import scenes
from light.test_slab import reflectances

IOR = 1.5
DEPTH = 0.05


def facets(alpha, angle, across=1200, around=720):
    """Normals of facets (N, 3), how much of the light coming at ``angle`` each meets, and that
    light's direction to where it comes from."""
    left = 1 - (np.arange(across) + 0.5) / across  # squared: what is steep counts much
    u, chance = 1 - left**2, 2 * left
    turn = (np.arange(around) + 0.5) / around * 2 * np.pi
    lean = np.arctan(alpha * np.sqrt(u / (1 - u)))
    chance = np.tile(chance, around)
    lean, turn = (a.ravel() for a in np.meshgrid(lean, turn))
    normal = np.stack(
        [np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), np.cos(lean)], axis=1
    )
    tilt = np.radians(angle)
    back = np.array([-np.sin(tilt), 0.0, np.cos(tilt)])
    facing = np.maximum(normal @ back, 0)
    met = facing * unshaded(back, normal, alpha) / (back[2] * normal[:, 2])
    met *= chance / len(normal)
    return normal, met, back


def unshaded(way, normal, alpha):
    """Smith's G₁: the share of facets that are not hidden along ``way`` (…, 3)."""
    up = way[..., 2]
    tan2 = np.maximum(1 / up**2 - 1, 0)
    seen = (way * normal).sum(axis=-1) * up > 0
    return np.where(seen, 2 / (1 + np.sqrt(1 + alpha**2 * tan2)), 0.0)


def fresnel(cosine):
    """Reflectance of glass averaged over polarisations."""
    inside = np.sqrt(1 - (1 - cosine**2) / IOR**2)
    r_s = (cosine - IOR * inside) / (cosine + IOR * inside)
    r_p = (IOR * cosine - inside) / (IOR * cosine + inside)
    return (r_s**2 + r_p**2) / 2


def reflected(alpha, angle):
    """Directions (N, 3) up from the surface and, for a perfect mirror, the share of each."""
    normal, met, back = facets(alpha, angle)
    way = 2 * (normal @ back)[:, None] * normal - back
    return way, np.where(way[:, 2] > 0, met * unshaded(way, normal, alpha), 0.0), normal @ back


def refracted(alpha, angle):
    """Directions (N, 3) into the glass and the share of each."""
    normal, met, back = facets(alpha, angle)
    cosine = normal @ back
    inside = np.sqrt(1 - (1 - np.minimum(cosine, 1) ** 2) / IOR**2)
    way = -back / IOR + (cosine / IOR - inside)[:, None] * normal
    share = met * (1 - fresnel(np.clip(cosine, 0, 1))) * unshaded(way, normal, alpha)
    return way, np.where(way[:, 2] < 0, share, 0.0)


def lit(material, angle, landed=400_000, resolution=64, width=0.25, fresnel="averaged"):
    """A thin beam onto a block's top: what lands above it, and on a plane within it."""
    block = Body("Block", scenes.box(4.0, 4.0, 0.2, (0, 0, -0.1)), material)
    tilt = np.radians(angle)
    axis = np.array([np.sin(tilt), 0.0, -np.cos(tilt)])
    lamp = scenes.beam(1000.0, 1e-3, scenes.at(*(-0.3 * axis), axis=axis))
    sky = replace(scenes.floor(400.0, 1, scenes.at(z=0.5, axis=(0, 0, 1.0))), name="Sky")
    within = replace(
        scenes.floor(width, resolution, scenes.at(z=-DEPTH)), name="Within", sides="front"
    )
    tracing = PhotonTracing(until="landed", landed=landed, fresnel=fresnel)
    return trace(Scene((block,), (lamp,), (sky, within)), tracing, seed=7)


def share_on(result, index):
    one = result.maps[index]
    return float((one.caustic.astype(float) * one.area).sum()) / result.meta["flux"]["emitted"]


def bound(share, result):
    """Four standard deviations of a share."""
    return 4 * np.sqrt(share * (1 - share) / result.meta["photons"]["emitted"]) + 2e-4


def test_the_rule_is_the_textbook_s():
    """All facets seen along the light make up all of it, and smooth glass is Fresnel's."""
    for alpha in (0.1, 0.3, 0.6):
        for angle in (0, 60):
            assert facets(alpha, angle)[1].sum() == pytest.approx(1, abs=1e-4)
    for angle in (0, 60):
        _, share, cosine = reflected(1e-3, angle)
        truth = sum(reflectances(angle)) / 2
        assert (share * fresnel(cosine)).sum() == pytest.approx(truth, abs=1e-3)


@pytest.mark.parametrize("alpha", [0.1, 0.3, 0.6])
@pytest.mark.parametrize("angle", [0, 60])
def test_a_ground_surface_returns_and_passes_its_share(alpha, angle):
    result = lit(Material(ior=IOR, roughness=alpha), angle, width=3.9)
    _, share, cosine = reflected(alpha, angle)
    back = float((share * fresnel(np.clip(cosine, 0, 1))).sum())
    through = float(refracted(alpha, angle)[1].sum())
    assert share_on(result, 0) == pytest.approx(back, abs=bound(back, result) + 2e-3 * back)
    assert share_on(result, 1) == pytest.approx(through, abs=bound(through, result))
    assert back + through < 1
    flux = result.meta["flux"]
    assert flux["absorbed"] / flux["emitted"] == pytest.approx(1 - back - through, abs=4e-3)


@pytest.mark.parametrize("alpha", [0.1, 0.3, 0.6])
@pytest.mark.parametrize("angle", [0, 60])
def test_a_satin_mirror_returns_its_share(alpha, angle):
    mirror = Material(kind="mirror", reflectance=0.9, roughness=alpha)
    result = lit(mirror, angle, landed=200_000)
    truth = 0.9 * float(reflected(alpha, angle)[1].sum())
    assert share_on(result, 0) == pytest.approx(truth, abs=bound(truth, result) + 2e-3)


@pytest.mark.parametrize("alpha", [0.1, 0.3])
@pytest.mark.parametrize("angle", [0, 60])
@pytest.mark.parametrize("fresnel", ["averaged", "polarised"])
def test_the_lobe_behind_a_ground_surface(alpha, angle, fresnel):
    """Light of a thin beam on a plane in the glass, texel by texel against the rule."""
    result = lit(
        Material(ior=IOR, roughness=alpha), angle, resolution=48, width=0.2, fresnel=fresnel
    )
    within = result.maps[1]
    way, share = refracted(alpha, angle)
    places = way[:, :2] * (DEPTH / np.maximum(-way[:, 2], 1e-9))[:, None]
    edges = np.linspace(-0.1, 0.1, 49)
    truth = np.histogram2d(places[:, 1], places[:, 0], (edges, edges), weights=share)[0]
    lux = truth * result.meta["flux"]["emitted"] / within.area
    covered = (within.lower <= lux * 1.02) & (lux * 0.98 <= within.upper)
    lit_texels = lux > 0.02 * lux.max()
    assert covered[lit_texels].mean() > 0.93
    # By rings about the brightest place, where the counts are large.
    heart = (truth.sum(0) @ edges[:-1], truth.sum(1) @ edges[:-1]) / truth.sum()
    x, y = np.meshgrid(edges[:-1], edges[:-1])
    ring = (np.hypot(x - heart[0], y - heart[1]) / 0.008).astype(int)
    whole = result.meta["flux"]["emitted"]
    found = np.bincount(ring.ravel(), (within.caustic * within.area).ravel()) / whole
    expected = np.bincount(ring.ravel(), truth.ravel())
    sigma = np.sqrt(expected / result.meta["photons"]["emitted"])
    dense = expected > 1e-3
    assert (np.abs(found - expected)[dense] < 4 * sigma[dense] + 0.01 * expected[dense]).all()


def test_the_lobe_of_a_satin_mirror():
    """What a rough mirror sends up from 60°, over the whole of its upper side."""
    mirror = Material(kind="mirror", reflectance=1.0, roughness=0.2)
    block = Body("Block", scenes.box(4.0, 4.0, 0.2, (0, 0, -0.1)), mirror)
    axis = np.array([np.sin(np.radians(60)), 0.0, -np.cos(np.radians(60))])
    lamp = scenes.beam(1000.0, 1e-3, scenes.at(*(-0.05 * axis), axis=axis))
    sky = scenes.floor(2.0, 40, scenes.at(0.5, 0.0, 0.3, axis=(0, 0, 1.0)))
    result = scenes.traced(
        Scene((block,), (lamp,), (sky,)), PhotonTracing(until="landed", landed=400_000), seed=2
    )
    way, share, _ = reflected(0.2, 60)
    places = way[:, :2] * (0.3 / np.maximum(way[:, 2], 1e-9))[:, None]
    at = scenes.texel_centres(sky)
    step = 0.05
    centre = np.array([0.5, 0.0])
    edges = [centre[k] + np.linspace(-1, 1, 41) for k in (0, 1)]
    truth = np.histogram2d(*places.T, edges, weights=share)[0]
    column = ((at[..., 0] - edges[0][0]) / step).astype(int)
    row = ((at[..., 1] - edges[1][0]) / step).astype(int)
    lux = truth[column, row] * result.meta["flux"]["emitted"] / result.area
    bright = lux > 0.02 * lux.max()
    covered = (result.lower <= lux * 1.02) & (lux * 0.98 <= result.upper)
    assert covered[bright].mean() > 0.93


@pytest.mark.parametrize("kind", ["dielectric", "mirror"])
@pytest.mark.parametrize("angle", [0, 60])
def test_hardly_rough_is_smooth(kind, angle):
    results = [
        lit(Material(kind=kind, ior=IOR, roughness=alpha), angle, width=0.2)
        for alpha in (0.0, 1e-3)
    ]
    for index in range(2):
        smooth, rough = (share_on(r, index) for r in results)
        assert rough == pytest.approx(smooth, abs=2 * bound(smooth, results[0]))
    if kind == "dielectric":
        places = [
            np.unravel_index(r.maps[1].caustic.argmax(), r.maps[1].caustic.shape) for r in results
        ]
        assert np.abs(np.subtract(*places)).max() <= 1  # the beam's middle is a texel's corner


@pytest.mark.parametrize("kind", ["dielectric", "mirror"])
@pytest.mark.parametrize("fresnel", ["averaged", "polarised"])
def test_ground_and_smooth_bodies_in_one_scene_keep_their_account(kind, fresnel):
    """A smooth block beside a ground one loses nothing."""
    smooth = Body(
        "Smooth", scenes.box(0.05, 0.05, 0.01, (0.1, 0, 0)), Material(kind=kind, reflectance=1.0)
    )
    ground = Body("Ground", scenes.box(0.05, 0.05, 0.01), Material(kind=kind, roughness=0.5))
    lamp = scenes.beam(1000.0, 0.02, scenes.at(0.1, 0, 0.2))
    scene = Scene(
        (smooth, ground),
        (lamp,),
        (
            scenes.floor(1.0, 8, scenes.at(z=0.3, axis=(0, 0, 1))),
            scenes.floor(1.0, 8, scenes.at(z=-0.1)),
        ),
    )
    flux = trace(
        scene, PhotonTracing(until="landed", landed=100_000, fresnel=fresnel), seed=1
    ).meta["flux"]
    assert flux["absorbed"] == pytest.approx(0, abs=1e-9)
    assert flux["landed"] == pytest.approx(flux["emitted"], rel=5e-3)
