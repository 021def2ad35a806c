"""Relief on walls, as arrays: where the beads are, which faces have them, and what does not fit."""

import numpy as np
import pytest
from heliform.engines.core import solid
from heliform.engines.core.errors import FileError, ParameterError
from heliform.engines.core.scene import Mesh
from heliform.engines.glass import GlassObject, glass_object
from heliform.engines.glass.bead import Bead, arc_radius
from heliform.engines.glass.profile import Style, flat_bead, scalloped, texture_of
from heliform.engines.glass.relief import Relief, check_relief, chosen_style, relieve, relieved
from heliform.engines.glass.skin import Skin, skin_of

RADIUS, WALL, HEIGHT = 0.1, 8e-3, 0.05
STYLE = scalloped(5e-3, 1.2e-3)


def pipe(around=120, rows=101):
    """A closed pipe with flat rims, in quadrilaterals, and its skin."""
    angle = np.arange(around) * (2 * np.pi / around)
    z = np.linspace(0, HEIGHT, rows)
    radius = np.repeat([RADIUS, RADIUS - WALL], rows)
    level = np.concatenate([z, z[::-1]])
    plan = np.column_stack([np.cos(angle), np.sin(angle)])
    points = np.empty((2 * rows, around, 3))
    points[..., :2] = radius[:, None, None] * plan
    points[..., 2] = level[:, None]
    here = np.arange(2 * rows)[:, None] * around + np.arange(around)
    ahead, above = np.roll(here, -1, axis=1), np.roll(here, -1, axis=0)
    corners = [here, ahead, np.roll(above, -1, axis=1), above]
    faces = np.stack(corners, -1).reshape(-1, 4).astype(np.int32)
    skin = Skin(
        normal=np.tile(plan, (2 * rows, 1)),
        side=np.repeat([1.0, -1.0], rows * around),
        turn=np.tile(angle / (2 * np.pi), 2 * rows),
        girth=2 * np.pi * RADIUS,
    )
    return Mesh(points.reshape(-1, 3), faces), skin


MESH, SKIN = pipe()
OUTER = SKIN.side > 0


def radii(vertices):
    return np.hypot(*vertices[:, :2].T)


def textured(size=(0.05, 0.02), shape=(40, 60)):
    random = np.random.default_rng(3)
    waves = np.hypot(*np.meshgrid(*(np.fft.fftfreq(n) * n for n in shape[::-1])))
    spectrum = np.fft.fft2(random.normal(size=shape)) * np.exp(-((waves / 8) ** 2))
    texture, _ = texture_of(np.fft.ifft2(spectrum).real, size)
    return Style("Scan", STYLE.profile, STYLE.inner, texture, 5e-3, 1.2e-3, 5e-5)


def test_beads_are_arcs_with_their_crests_on_the_wall():
    moved = relieve(MESH.vertices, SKIN, Relief(spiral=False), STYLE)
    bead = Bead(height=5e-3, sag=1.2e-3)
    middle = (np.floor(moved[:, 2] / 5e-3) + 0.5) * 5e-3
    centre = RADIUS - arc_radius(bead)
    within = OUTER & (moved[:, 2] < HEIGHT)
    away = np.hypot(radii(moved) - centre, moved[:, 2] - middle)[within]
    assert away == pytest.approx(arc_radius(bead), abs=2e-9)
    assert radii(moved)[OUTER].max() == pytest.approx(RADIUS)
    assert radii(moved)[~OUTER].min() == pytest.approx(RADIUS - WALL)


def test_a_stacked_relief_is_that_of_the_glass_object():
    """Another way to the same surface: the wall that is swept with its beads."""
    swept = glass_object(GlassObject(width=0.2, depth=0.2, height=HEIGHT, wall=WALL, faces=20_000))
    rows = np.unique(swept.vertices[:, 2])
    smooth, skin = pipe()
    moved = relieve(smooth.vertices, skin, Relief(spiral=False), STYLE)
    first = moved[skin.turn == 0]
    outside, inside = first[: len(first) // 2], first[len(first) // 2 :][::-1]
    swept_radius = radii(swept.vertices)
    for side, found in ((outside, np.maximum), (inside, np.minimum)):
        truth = [found.reduce(swept_radius[swept.vertices[:, 2] == z]) for z in rows]
        assert np.interp(rows, side[:, 2], side[:, 0]) == pytest.approx(truth, abs=2e-5)


def test_a_spiral_rises_by_a_layer_a_turn():
    stacked, spiral = (relieve(MESH.vertices, SKIN, Relief(spiral=s), STYLE) for s in (False, True))
    shifted = MESH.vertices.copy()
    shifted[:, 2] -= SKIN.turn * 5e-3
    assert radii(spiral) == pytest.approx(
        radii(relieve(shifted, SKIN, Relief(spiral=False), STYLE))
    )
    assert np.abs(radii(spiral) - radii(stacked)).max() > 5e-4


def test_base_moves_the_layers_up():
    moved = relieve(MESH.vertices, SKIN, Relief(spiral=False, base=2.5e-3), STYLE)
    at_base = OUTER & np.isclose(MESH.vertices[:, 2], 2.5e-3)
    assert radii(moved)[at_base] == pytest.approx(RADIUS - 1.2e-3)


@pytest.mark.parametrize(("sides", "still"), [("outer", ~OUTER), ("inner", OUTER)])
def test_a_face_without_relief_stays(sides, still):
    moved = relieve(MESH.vertices, SKIN, Relief(sides=sides), STYLE)
    assert np.array_equal(moved[still], MESH.vertices[still])
    assert np.abs(moved[~still] - MESH.vertices[~still]).max() == pytest.approx(1.2e-3, rel=0.01)


def test_the_crest_says_whether_the_wall_thins_or_thickens():
    thick = {
        crest: radii(v)[OUTER] - radii(v)[~OUTER].reshape(101, -1)[::-1].ravel()
        for crest in (0.0, 0.5, 1.0)
        for v in [relieve(MESH.vertices, SKIN, Relief(crest=crest, spiral=False), STYLE)]
    }
    assert thick[1.0].max() == pytest.approx(WALL)
    assert thick[0.0].min() == pytest.approx(WALL)
    assert thick[0.5] - thick[1.0] == pytest.approx(1.2e-3)


def test_the_inner_face_has_its_own_profile():
    style = Style("Two", STYLE.profile, flat_bead(5e-3, 1e-3).profile, None, 5e-3, 1e-3, 0.0)
    moved = relieve(MESH.vertices, SKIN, Relief(spiral=False), style)
    both = relieve(MESH.vertices, SKIN, Relief(spiral=False), STYLE)
    assert np.array_equal(moved[OUTER], both[OUTER])
    assert np.abs(moved[~OUTER] - both[~OUTER]).max() > 1e-4


def test_a_mask_weighs_the_relief():
    relief = Relief(roughness=1e-4)
    whole = relieve(MESH.vertices, SKIN, relief, textured()) - MESH.vertices
    mask = np.random.default_rng(0).uniform(size=len(MESH.vertices))
    part = relieve(MESH.vertices, SKIN, relief, textured(), mask) - MESH.vertices
    assert part == pytest.approx(mask[:, None] * whole)


def rough(seed=0, sides="both", **given):
    relief = Relief(amplitude=0.0, roughness=1e-4, seed=seed, sides=sides, **given)
    mesh, skin = pipe(around=780, rows=61)
    moved = relieve(mesh.vertices, skin, relief, textured())
    return (radii(moved) - radii(mesh.vertices)).reshape(2, 61, 780)


def test_roughness_has_its_rms_and_goes_round_without_a_seam():
    outer = rough()[0]
    assert np.sqrt((outer**2).mean()) == pytest.approx(1e-4, rel=0.1)
    steps = np.abs(np.diff(outer, axis=1, append=outer[:, :1]))
    assert steps[:, -1].max() <= steps[:, :-1].max()
    around = round(2 * np.pi * RADIUS / 0.05)
    strength = np.abs(np.fft.rfft(outer, axis=1)).sum(axis=0)
    assert set(np.flatnonzero(strength > 1e-3 * strength.max()) % around) <= {0}


def test_seeds_and_faces_have_roughness_of_their_own():
    patches = [rough(seed)[0] for seed in (0, 1, 2, 1000)] + [rough()[1][::-1]]
    likeness = np.corrcoef([patch.ravel() for patch in patches])
    assert np.abs(likeness - np.eye(len(patches))).max() < 0.5


def test_walls_stay_solid():
    for relief in (Relief(), Relief(spiral=False, roughness=2e-4), Relief(sides="inner")):
        mesh = relieved(MESH, SKIN, relief, textured())
        assert solid.inspect(mesh).problem == ""
        assert np.linalg.norm(mesh.normals, axis=-1) == pytest.approx(1, abs=1e-5)


def test_relief_follows_a_curved_surface():
    ball = 0.05 * np.array([[0.0, 0, 1], [0.6, 0, 0.8], [0, 1, 0], [-0.6, 0, 0.8]])
    mesh = Mesh(ball, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    moved = relieve(ball, skin_of(mesh), Relief(crest=0.0, amplitude=1e-3), flat_bead(5e-3, 1e-3))
    assert np.array_equal(moved[:, 2], ball[:, 2])
    assert np.abs(moved - ball).max() <= 1e-3


@pytest.mark.parametrize(
    ("relief", "thickness", "reason"),
    [
        (Relief(amplitude=3e-3), None, "3 mm deep, more than half its layer of 5 mm"),
        (Relief(amplitude=2e-3), 4e-3, "takes 4 mm of a wall of 4 mm, so that nothing is left"),
        (Relief(amplitude=2e-3, roughness=5e-4), 6e-3, "takes 7 mm of a wall of 6 mm"),
        (Relief(amplitude=2e-3, sides="inner"), 2e-3, "takes 2 mm of a wall of 2 mm"),
    ],
)
def test_what_does_not_fit_is_said(relief, thickness, reason):
    with pytest.raises(ParameterError, match=reason):
        check_relief(relief, thickness)


def test_what_fits_is_not():
    check_relief(Relief(amplitude=2.5e-3))
    check_relief(Relief(amplitude=2e-3, sides="outer"), 2.1e-3)
    check_relief(Relief(amplitude=2e-3, crest=0.0), 1e-3)


def test_a_style_is_built_in_or_from_a_file(tmp_path):
    assert chosen_style(Relief(height=4e-3, amplitude=1e-3)).digest == scalloped(4e-3, 1e-3).digest
    path = tmp_path / "probe.npz"
    textured().save(path)
    assert chosen_style(Relief(style="scan", file=str(path))).digest == textured().digest


def test_a_scan_without_a_file_is_said(tmp_path):
    with pytest.raises(ParameterError, match="The style “scan” needs a file"):
        chosen_style(Relief(style="scan"))
    with pytest.raises(FileError, match="There is no relief style"):
        chosen_style(Relief(style="scan", file=str(tmp_path / "gone.npz")))
