"""The printed wall's mesh: sizes, closedness, volume, normals, and its skin."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
import trimesh
from heliform.engines.core.analysis import find_form
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.solid import require_solid
from heliform.engines.glass import (
    PRESETS,
    TABLE_1,
    Bead,
    Plan,
    Wall,
    glass_object,
    wall_loft,
    wall_mesh,
    wall_skin,
)
from heliform.engines.glass.base import base_curve
from heliform.engines.glass.bead import relief
from scipy.integrate import quad

FLAT = Bead(style="flat")
SMALL = Wall(plan=Plan(radius=0.06, amplitude_1=0.08), height=0.042, faces=20_000)
SLANTED = {
    "twisted": replace(SMALL, twist=30.0),
    "tapered": replace(SMALL, scale=0.7),
    "blended": replace(SMALL, to_top=True, top=Plan(radius=0.055, period_1=5, amplitude_1=0.05)),
}


def as_trimesh(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.triangles().faces, process=False)


@pytest.mark.parametrize("name", TABLE_1)
def test_the_objects_of_table_1_have_their_sizes_and_faces_and_are_solid(name):
    wanted, mesh = TABLE_1[name], wall_mesh(PRESETS[name])
    size = (wanted.width, wanted.depth, wanted.height)
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx(size, abs=1e-4)
    assert mesh.vertices[:, 2].min() == 0
    assert len(mesh.faces) == pytest.approx(wanted.faces, rel=0.02)
    solid = as_trimesh(mesh)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    require_solid(name, mesh)


@pytest.mark.parametrize("name", sorted(set(PRESETS) - set(TABLE_1)))
def test_every_other_preset_is_solid_and_has_its_faces(name):
    wall = replace(PRESETS[name], faces=30_000)
    mesh = wall_mesh(wall)
    assert as_trimesh(mesh).is_watertight
    assert as_trimesh(mesh).volume > 0
    assert len(mesh.faces) == pytest.approx(wall.faces, rel=0.02)
    require_solid(name, mesh)


def distance(mesh, other):
    """The largest distance in m of a vertex from the other mesh's rings at the same height."""
    worst = 0.0
    for z in np.unique(mesh.vertices[:, 2])[1:-1]:
        rings = []
        for one in (mesh, other):
            level = one.vertices[np.abs(one.vertices[:, 2] - z) < 1e-9, :2]
            half = len(level) // 2
            rings.append(
                (level, shapely.multilinestrings([_ring(level[:half]), _ring(level[half:])]))
            )
        worst = max(worst, shapely.distance(shapely.points(rings[0][0]), rings[1][1]).max())
    return worst


def _ring(points):
    return shapely.linestrings(np.vstack([points, points[:1]]))


@pytest.mark.parametrize("name", TABLE_1)
def test_a_wall_on_the_objects_own_middle_is_that_object(name):
    wanted = replace(TABLE_1[name], faces=40_000)
    outer = base_curve(wanted.width, wanted.depth, wanted.lobes, wanted.lobe, 4096)
    middle = outer.points - wanted.wall / 2 * outer.normals
    wall = Wall(height=wanted.height, thickness=wanted.wall, faces=wanted.faces, bead=wanted.bead)
    mesh, known = wall_mesh(wall, [middle]), glass_object(wanted)
    assert len(mesh.faces) == pytest.approx(len(known.faces), rel=0.02)
    columns = np.array([one.faces[0, 3] for one in (mesh, known)])
    sagitta = (outer.length / columns.min()) ** 2 / (8 * (outer.bend - wanted.wall))
    assert distance(mesh, known) < sagitta


@pytest.mark.parametrize("name", TABLE_1)
def test_the_presets_of_table_1_come_close_to_those_objects(name):
    wanted, wall = TABLE_1[name], replace(PRESETS[name], faces=40_000)
    assert distance(wall_mesh(wall), glass_object(replace(wanted, faces=40_000))) < 2.5e-4


def test_the_tube_is_the_closed_form_at_every_corner():
    wall = PRESETS["tube"]
    mesh, bead = wall_mesh(wall), wall.bead
    corner = mesh.vertices[mesh.faces]
    radius, z = np.hypot(corner[..., 0], corner[..., 1]), corner[..., 2]
    floor = np.floor(z.mean(axis=1, keepdims=True) / bead.height) * bead.height
    offset, tilt = relief(bead, z - floor)
    side = np.where(radius.mean(axis=1, keepdims=True) > (wall.width - wall.thickness) / 2, 1, -1)
    face = (wall.width - wall.thickness) / 2 + side * (wall.thickness / 2 - bead.depth + offset)
    upright = np.ptp(z, axis=1) > 0  # not on a rim
    assert np.abs(radius - face)[upright].max() < 1e-9
    out = corner[..., :2] / radius[..., None] * (side * np.cos(tilt))[..., None]
    exact = np.concatenate([out, -np.sin(tilt)[..., None]], axis=-1)
    assert np.abs(mesh.normals - exact)[upright].max() < 1e-6


def closed_form_volume(wall):
    """∫ width · length dz: to both sides of a curve, what widens on one narrows on the other."""
    loft, bead = wall_loft(wall), wall.bead

    def slice_area(z):
        width = wall.thickness - 2 * (bead.depth - relief(bead, np.fmod(z, bead.height))[0])
        return float(width * loft.length(z))

    breaks = np.arange(bead.height, wall.height, bead.height)
    return quad(slice_area, 0, wall.height, points=breaks, limit=200)[0]


@pytest.mark.parametrize("wall", [SMALL, *SLANTED.values(), replace(SMALL, bead=FLAT)])
def test_the_volume_is_the_closed_form(wall):
    mesh = wall_mesh(replace(wall, faces=200_000))
    assert as_trimesh(mesh).volume == pytest.approx(closed_form_volume(wall), rel=2e-3)


def worst_lean(mesh):
    """The largest angle in radians between a face and one of its corner normals."""
    a, b, c, d = (mesh.vertices[corner] for corner in mesh.faces.T)
    flat = np.cross(c - a, d - b)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    cosine = np.einsum("fci,fi->fc", mesh.normals.astype(float), flat)
    return np.arccos(np.clip(cosine, -1, 1)).max()


@pytest.mark.parametrize("bead", [Bead(), FLAT, Bead(sag=2e-3)])
@pytest.mark.parametrize("name", SLANTED)
def test_corner_normals_approach_the_faces_as_the_mesh_is_refined(name, bead):
    wall = replace(SLANTED[name], bead=bead)
    errors = [worst_lean(wall_mesh(replace(wall, faces=f))) for f in (40_000, 640_000)]
    assert errors[1] < 0.45 * errors[0]


def test_corner_normals_of_a_smooth_cone_are_those_of_a_cone():
    wall = Wall(plan=Plan(radius=0.1), scale=0.6, height=0.1, bead=FLAT, faces=20_000)
    mesh = wall_mesh(wall)
    slope = -0.04 / 0.1
    side = np.abs(mesh.normals[..., 2]) < 0.9
    places = mesh.vertices[mesh.faces][side]
    out = places[:, :2] / np.hypot(*places[:, :2].T)[:, None]
    middle = 0.1 + slope * places[:, 2]
    sign = np.where(np.hypot(*places[:, :2].T) > middle, 1.0, -1.0)
    known = sign[:, None] * np.column_stack([out, np.full(len(out), -slope)]) / np.hypot(1, slope)
    assert np.abs(mesh.normals[side] - known).max() < 1e-5


@pytest.mark.parametrize("wall", [SMALL, *SLANTED.values()])
def test_the_skin_carries_the_relief_onto_the_smooth_wall(wall):
    mesh, (smooth, skin) = wall_mesh(wall), wall_skin(wall)
    assert np.array_equal(mesh.faces, smooth.faces)
    z = smooth.vertices[:, 2]
    bead = wall.bead
    phase = np.fmod(z + 1e-9, bead.height) - 1e-9
    sunk = relief(bead, phase)[0] - bead.depth
    moved = smooth.vertices.copy()
    moved[:, :2] += (skin.side * sunk)[:, None] * skin.normal
    assert moved == pytest.approx(mesh.vertices, abs=1e-8)
    assert np.hypot(*skin.normal.T) == pytest.approx(1.0)
    assert 0 <= skin.turn.min() <= skin.turn.max() < 1
    assert skin.side.min() == pytest.approx(-1.0)
    assert skin.side.max() == pytest.approx(1.0)
    loft = wall_loft(wall)
    assert skin.girth == pytest.approx(
        loft.length(np.linspace(0, loft.height, 99)).mean(), rel=1e-2
    )


def test_a_plain_wall_is_its_own_skin():
    wall = replace(SLANTED["twisted"], bead=FLAT)
    mesh, (smooth, _) = wall_mesh(wall), wall_skin(wall)
    assert np.array_equal(mesh.vertices, smooth.vertices)
    assert np.array_equal(mesh.normals, smooth.normals)


def test_a_stack_of_curves_becomes_a_solid_of_its_own_height():
    t = np.arange(300) * (2 * np.pi / 300)
    ring = np.column_stack([np.cos(t), np.sin(t)])
    stack = [
        np.column_stack([r * ring, np.full(300, z)])
        for r, z in ((0.05, 0.0), (0.06, 0.02), (0.045, 0.06))
    ]
    mesh = wall_mesh(replace(SMALL, height=0.5), stack)
    assert np.ptp(mesh.vertices[:, 2]) == pytest.approx(0.06)
    assert as_trimesh(mesh).is_watertight


def test_the_form_is_found_by_its_name():
    assert find_form("glass.wall", "here").build is wall_mesh


RING = np.column_stack([np.cos(np.arange(200) * np.pi / 100), np.sin(np.arange(200) * np.pi / 100)])
WILD = [
    np.column_stack([r * RING, np.full(200, z)])
    for r, z in ((0.1, 0.0), (0.1, 0.02), (0.02, 0.022), (0.1, 0.2))
]


@pytest.mark.parametrize(
    ("wall", "curves", "said"),
    [
        (replace(SMALL, thickness=2e-3), [], "on both sides leave nothing of a wall of 2 mm"),
        (replace(SMALL, thickness=2.4e-3), [], "take a wall above 2.4 mm"),
        (replace(SMALL, bead=Bead(sag=4e-3)), [], "more than half its height"),
        (replace(SMALL, height=5e-3, bead=Bead(height=6e-3)), [], "no whole layer"),
        (replace(SMALL, height=0.5, faces=1000), [], "too few for 100 layers"),
        (SMALL, WILD, "runs into itself at z"),
    ],
)
def test_a_wall_that_cannot_be_is_refused_in_a_sentence(wall, curves, said):
    with pytest.raises(ParameterError, match=said) as refused:
        wall_mesh(wall, curves)
    assert str(refused.value).startswith("[glass.wall] ")


def test_the_skin_of_a_wall_asks_nothing_of_the_sag():
    """Its relief comes later: a sag beyond half a layer, or half the wall, is the mesh's alone."""
    for bead, thickness in ((Bead(height=2e-3), 8e-3), (Bead(sag=2.4e-3), 4e-3)):
        wall = replace(SMALL, bead=bead, thickness=thickness)
        with pytest.raises(ParameterError):
            wall_mesh(wall)
        smooth, skin = wall_skin(wall)
        middle = wall_loft(wall).at(skin.turn, smooth.vertices[:, 2]).points[:, :2]
        stands = ((smooth.vertices[:, :2] - middle) * skin.normal).sum(axis=1)
        assert stands == pytest.approx(skin.side * thickness / 2, abs=1e-9)
