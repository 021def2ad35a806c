"""Colours: a prism against rays through it, line by line, and what must stay neutral."""

import numpy as np
import pytest
from heliform.engines.core.scene import Body, Material, Mesh, Scene
from heliform.engines.light import PhotonTracing, finish, spectrum
from light import scenes
from light.test_slab import through

GLASSES = ("soda-lime", "crown", "flint", "water")
APEX = np.radians(60)
FAR = 0.2
"""m from the prism to the screen."""
TEXEL, BEAM = 2.5e-4, 2e-4
FINE = np.linspace(380, 780, 8001)
RED = 0.003
"""m: where the red end of flint's spectrum begins on the screen."""


def prism(side=0.04, length=0.04) -> Mesh:
    """An equilateral prism along Y about the origin, its base below."""
    x, z = side / 2, side / 2 / np.sqrt(3)
    triangle = np.array([[-x, -z], [x, -z], [0.0, 2 * z]])
    ends = [np.insert(triangle, 1, y, axis=1) for y in (-length / 2, length / 2)]
    faces = [[0, 1, 2], [3, 5, 4]]
    for a, b in ((0, 1), (1, 2), (2, 0)):
        faces += [[a, a + 3, b + 3], [a, b + 3, b]]
    faces = np.array(faces, np.int32)
    mesh = Mesh(np.concatenate(ends), faces)
    return mesh if volume(mesh) > 0 else scenes.inward(mesh)


def volume(mesh):
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def deviation(ior, incidence):
    """By how much a prism of 60° turns light that meets it at ``incidence``, radians."""
    inside = np.arcsin(np.sin(incidence) / ior)
    leaving = np.arcsin(ior * np.sin(APEX - inside))
    return incidence + leaving - APEX


def transmitted(ior, incidence):
    """Averaged Fresnel through both faces."""
    share = 1.0
    inside = np.arcsin(np.sin(incidence) / ior)
    for start, end in (
        (incidence, inside),
        (APEX - inside, np.arcsin(ior * np.sin(APEX - inside))),
    ):
        r_s = (np.sin(start - end) / np.sin(start + end)) ** 2
        r_p = (np.tan(start - end) / np.tan(start + end)) ** 2
        share = share * (1 - (r_s + r_p) / 2)
    return share


def spread_out(glass, colour="equal-energy", landed=400_000, slit=False, **own):
    """A thin beam at minimum deviation for d onto a screen across the deviated light.

    Returns the result, how high its texels lie (m), and for the wavelengths FINE where each lands
    and which share of it.
    """
    material = Material(glass=glass, **own)
    middle = float(spectrum.ior_at(material, spectrum.LINES["d"]))
    incidence = np.arcsin(middle * np.sin(APEX / 2))
    turn = deviation(middle, incidence)
    # Inside the prism light runs along X; before it climbs, after it falls, by half the turn.
    before = np.array([np.cos(turn / 2), 0.0, np.sin(turn / 2)])
    after = np.array([np.cos(turn / 2), 0.0, -np.sin(turn / 2)])
    entry = np.array([-0.01, 0.0, 0.04 / 2 / np.sqrt(3) * 0.5])
    lamp = scenes.sheet(1000.0, BEAM, BEAM, scenes.at(*(entry - 0.1 * before), axis=before))
    exit_point = entry * [-1, 1, 1]
    screen = scenes.at(*(exit_point + FAR * after), axis=after)
    receiver = scenes.floor(0.1, 400, screen, length=0.01)
    if abs(receiver.u @ [0, 1, 0]) > 0.5 * np.linalg.norm(receiver.u):
        receiver = scenes.floor(0.01, 400, screen, length=0.1)
    down = np.cross(after, [0.0, 1.0, 0.0])
    if slit:
        middle = exit_point + FAR * after + (RED + 0.01) * down
        receiver = scenes.floor(0.02, 8, scenes.at(*middle, axis=after))
    scene = Scene((Body("Prism", prism(), material),), (lamp,), (receiver,))
    tracing = PhotonTracing(until="landed", landed=landed, colour=colour)
    result = scenes.traced(scene, tracing, seed=3)
    heights = (scenes.texel_centres(receiver) - (exit_point + FAR * after)) @ down

    ior = spectrum.ior_at(material, FINE)
    turned = deviation(ior, incidence) - turn
    # The way inside turns too: where light leaves shifts along the exit face.
    bent = np.arcsin(np.sin(incidence) / ior) - APEX / 2
    normal_in = np.array([-np.cos(APEX / 2), 0.0, np.sin(APEX / 2)])
    normal_out = np.array([np.cos(APEX / 2), 0.0, np.sin(APEX / 2)])
    places = []
    for lean, more in zip(bent, turned, strict=True):
        along = np.array([np.cos(lean), 0.0, np.sin(lean)])
        way = ((exit_point - entry) @ normal_out) / (along @ normal_out)
        leaves = entry + way * along
        angle = turn / 2 + more
        ray = np.array([np.cos(angle), 0.0, -np.sin(angle)])
        ahead = ((exit_point + FAR * after - leaves) @ after) / (ray @ after)
        places.append((leaves + ahead * ray - exit_point - FAR * after) @ down)
    assert normal_in @ before < 0
    return result, heights, np.array(places), transmitted(ior, incidence)


def stimulus(colour):
    """X, Y and Z (3, L) of a spectrum at FINE."""
    shown = spectrum.spectrum(colour)[:, None] * spectrum.MATCHING
    return np.array([np.interp(FINE, spectrum.WAVELENGTHS, column) for column in shown.T])


@pytest.mark.parametrize("glass", GLASSES)
@pytest.mark.parametrize("colour", ["equal-energy", "incandescent"])
def test_the_spectrum_of_a_prism(glass, colour):
    """Mean and width of the illuminance on the screen: each wavelength where its ray lands."""
    result, heights, places, share = spread_out(glass, colour)
    power = stimulus(colour)[1] * share
    power /= power.sum()
    mean = (power * places).sum()
    width = np.sqrt((power * (places - mean) ** 2).sum())
    light = result.caustic.astype(float)
    # Some light goes astray between the prism's faces, most of it far from here.
    near = (heights > places.min() - 1e-3) & (heights < places.max() + 1e-3)
    light = np.where(near, light, 0.0)
    found = (light * heights).sum() / light.sum()
    spread = np.sqrt((light * (heights - found) ** 2).sum() / light.sum())
    blur = np.sqrt((TEXEL**2 + BEAM**2) / 12)
    error = width / np.sqrt(result.meta["photons"]["landed"])
    assert found == pytest.approx(mean, abs=5 * error + 5e-6)
    assert spread == pytest.approx(np.hypot(width, blur), rel=0.01)
    if glass == "flint":
        assert width > 2e-3


@pytest.mark.parametrize("glass", GLASSES)
def test_the_spectrum_s_profile_and_its_colours(glass):
    """The illuminance along the screen is the quadrature's, and red is turned least."""
    result, heights, places, share = spread_out(glass, landed=1_000_000)
    rows = np.unique(np.round(heights, 7))
    edges = np.append(rows - TEXEL / 2, rows[-1] + TEXEL / 2)
    beam = (np.arange(20) - 9.5) / 20 * BEAM
    light = stimulus("equal-energy")[1] * share
    truth = sum(np.histogram(places + o, edges, weights=light)[0] for o in beam)
    found = np.histogram(heights, edges, weights=result.caustic.astype(float))[0]
    near = (rows > places.min() - 1e-3) & (rows < places.max() + 1e-3)
    truth, found = truth / truth.sum(), found * near / (found * near).sum()
    # Of flint's light 0.6 % is reflected at each of the three faces and lands on it undispersed.
    assert np.abs(truth - found).sum() / 2 < 0.01

    colours = {name: getattr(result, name).astype(float) for name in ("red", "green", "blue")}
    where = {name: (c * heights).sum() / c.sum() for name, c in colours.items()}
    assert where["blue"] < where["green"] < where["red"]


def test_x_y_and_z_in_the_sums_are_the_quadrature(monkeypatch):
    """The sums themselves, before they are made displayable."""
    tallies = []
    maps_of = finish.maps_of

    def kept(tally, *rest):
        tallies.append(tally)
        return maps_of(tally, *rest)

    monkeypatch.setattr(finish, "maps_of", kept)
    _, heights, places, share = spread_out("flint", "daylight", landed=1_000_000)
    (tally,) = tallies
    stack = [tally.colour[0], tally.total, tally.colour[1]]
    near = (heights > places.min() - 1e-3) & (heights < places.max() + 1e-3)
    weights = stimulus("daylight") * share
    for found, weight in zip(stack, weights, strict=True):
        light = np.where(near, found.reshape(heights.shape), 0.0)
        mean = (weight * places).sum() / weight.sum()
        width = np.sqrt((weight * (places - mean) ** 2).sum() / weight.sum())
        at = (light * heights).sum() / light.sum()
        error = width / np.sqrt(tally.landed / 3)
        # The share that is reflected at all three faces lands undispersed, at 0.
        assert at == pytest.approx(mean, abs=5 * error + 0.0065 * abs(mean))
    whole = [np.where(near, s.reshape(heights.shape), 0).sum() for s in stack]
    truth = weights.sum(axis=1)
    np.testing.assert_allclose(np.array(whole) / whole[1], truth / truth[1], rtol=0.01)


@pytest.mark.parametrize("colour", ["equal-energy", "incandescent", "daylight", "led"])
def test_a_plane_slab_keeps_light_neutral(colour):
    slab = Body("Slab", scenes.box(0.2, 0.2, 0.01), Material(glass="flint"))
    lamp = scenes.beam(1000.0, 0.05, scenes.at(z=0.2))
    scene = Scene((slab,), (lamp,), (scenes.floor(0.06, 4, scenes.at(z=-0.1)),))
    tracing = PhotonTracing(until="landed", landed=1_000_000, colour=colour)
    result = scenes.traced(scene, tracing, seed=2)
    # What little colour it takes on is that of the reflectance over the spectrum.
    ior = spectrum.ior_at(slab.material, FINE)
    xyz = (stimulus(colour) * through(((ior - 1) / (ior + 1)) ** 2)).sum(axis=1)
    whole = stimulus(colour).sum(axis=1)
    truth = 1000.0 * spectrum.to_rgb(xyz / whole[1], whole / whole[1])
    for name, light in zip(("red", "green", "blue"), truth, strict=True):
        assert light == pytest.approx(1000.0 * xyz[1] / whole[1], rel=0.03)
        assert getattr(result, name)[1:3, 1:3].mean() == pytest.approx(light, rel=0.015)


@pytest.mark.parametrize("colour", ["equal-energy", "incandescent", "daylight", "led"])
def test_glass_that_does_not_disperse_has_the_same_light_in_colours(colour):
    ball = scenes.glass(scenes.sphere(0.02, 5))
    lamp = scenes.beam(1000.0, 0.036, scenes.at(z=0.1))
    scene = Scene((ball,), (lamp,), (scenes.floor(0.04, 24, scenes.at(z=-0.03)),))
    plain, coloured = (
        scenes.traced(scene, PhotonTracing(until="landed", landed=400_000, colour=c), seed=seed)
        for seed, c in ((1, "none"), (2, colour))
    )
    assert plain.red.max() == 0.0
    spread = np.hypot(plain.half_width, coloured.half_width)
    apart = np.abs(plain.illuminance - coloured.illuminance)
    lit = plain.illuminance > 0
    assert (apart <= spread)[lit].mean() > 0.92
    both = np.hypot(plain.meta["traced_half_width"], coloured.meta["traced_half_width"])
    assert plain.mean == pytest.approx(coloured.mean, abs=1.5 * both)
    # Neutral within the noise of its colours.
    total = [float((getattr(coloured, c) * coloured.area).sum()) for c in ("red", "green", "blue")]
    whole = float((coloured.illuminance * coloured.area).sum())
    np.testing.assert_allclose(np.array(total) / whole, 1.0, rtol=0.01)


def test_an_abbe_number_disperses_own_glass():
    crown = spectrum.ior_at(Material(glass="crown"), list(spectrum.LINES.values()))
    abbe = (crown[0] - 1) / (crown[1] - crown[2])
    own = spread_out("own", ior=float(crown[0]), abbe=float(abbe))
    named = spread_out("crown")
    at_lines = [np.interp(list(spectrum.LINES.values()), FINE, run[2]) for run in (own, named)]
    apart = [at[2] - at[1] for at in at_lines]
    assert apart[0] == pytest.approx(apart[1], rel=1e-3)
    light = [np.asarray(r[0].caustic, float) for r in (own, named)]
    means = [(x * r[1]).sum() / x.sum() for x, r in zip(light, (own, named), strict=True)]
    assert means[0] == pytest.approx(means[1], abs=3e-5)
    flat = spread_out("own", ior=float(crown[0]), abbe=0.0)
    assert np.ptp(flat[2]) < 1e-12


def test_what_lands_counts_in_lumens_of_its_colour():
    """A slit that only takes the red end: account and map agree on its light."""
    result, _, places, share = spread_out("flint", landed=60_000, slit=True)
    flux = result.meta["flux"]
    held = float((result.illuminance.astype(float) * result.area).sum())
    assert flux["landed"] == pytest.approx(held, rel=1e-4)
    parts = sum(flux[k] for k in ("landed", "absorbed", "escaped", "cut_off"))
    assert parts == pytest.approx(flux["emitted"], rel=1e-4)
    y = stimulus("equal-energy")[1]
    truth = (y * share)[places > RED].sum() / y.sum()
    assert flux["landed"] / flux["emitted"] == pytest.approx(truth, rel=0.03)
