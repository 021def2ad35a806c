"""The glass object: size, closedness, normals, volume, and what it says of bad values."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from heliform.engines.core.analysis import find_form
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.solid import require_solid
from heliform.engines.glass import TABLE_1, Bead, GlassObject, glass_object
from heliform.engines.glass.base import base_curve
from heliform.engines.glass.bead import arc_radius
from hypothesis import given, settings
from hypothesis import strategies as st

SMALL = GlassObject(height=0.032, faces=20_000)


def as_trimesh(mesh):
    return trimesh.Trimesh(mesh.vertices, mesh.triangles().faces, process=False)


def beads_area(height, bead):
    """Area in m² between a beaded side and its layer boundaries: circular segments."""
    if bead.depth == 0:
        return 0.0
    radius = arc_radius(bead)

    def below(z):  # the integral of the arc's offset from the layer's boundary up to z
        x = z - bead.height / 2
        return (x * np.sqrt(radius**2 - x**2) + radius**2 * np.arcsin(x / radius)) / 2 - x * (
            radius - bead.depth
        )

    layers, rest = divmod(height + 1e-9, bead.height)
    return layers * (below(bead.height) - below(0)) + below(rest) - below(0)


def closed_form_volume(record):
    """Two curves offset by a and b enclose (a − b) (L + π (a + b)) between them."""
    length = base_curve(record.width, record.depth, record.lobes, record.lobe, 64).length
    bead = record.bead
    section = (record.wall - 2 * bead.depth) * record.height + 2 * beads_area(record.height, bead)
    return section * (length - np.pi * record.wall)


@pytest.mark.parametrize("name", TABLE_1)
def test_the_objects_of_table_1_have_their_sizes_and_faces_and_are_solid(name):
    record = TABLE_1[name]
    mesh = glass_object(record)
    size = (record.width, record.depth, record.height)
    assert np.ptp(mesh.vertices, axis=0) == pytest.approx(size, abs=1e-4)
    assert mesh.vertices[:, 2].min() == 0
    assert len(mesh.faces) == pytest.approx(record.faces, rel=0.02)
    solid = as_trimesh(mesh)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.volume == pytest.approx(closed_form_volume(record), rel=0.01)
    require_solid(name, mesh)


def test_the_form_is_found_by_its_name():
    assert find_form("glass.object", "here").build is glass_object


@pytest.mark.parametrize("bead", [Bead(), Bead(style="flat"), Bead(sag=2e-3)])
@pytest.mark.parametrize("lobes", [0, 3])
def test_corner_normals_approach_the_faces_as_the_mesh_is_refined(lobes, bead):
    record = replace(SMALL, lobes=lobes, bead=bead)
    errors = [worst_lean(glass_object(replace(record, faces=f))) for f in (10_000, 160_000)]
    assert errors[1] < 0.45 * errors[0]


def worst_lean(mesh):
    """The largest angle in radians between a face and one of its corner normals."""
    a, b, c, d = (mesh.vertices[corner] for corner in mesh.faces.T)
    flat = np.cross(c - a, d - b)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    cosine = np.einsum("fci,fi->fc", mesh.normals.astype(float), flat)
    return np.arccos(np.clip(cosine, -1, 1)).max()


def test_corner_normals_are_the_arcs_own():
    mesh = glass_object(SMALL)
    corner = mesh.vertices[mesh.faces]
    radius = np.hypot(corner[..., 0], corner[..., 1])
    outside = (radius > SMALL.width / 2 - SMALL.bead.sag - 1e-9).all(axis=1)
    side = outside & (np.abs(mesh.normals[..., 2]).max(axis=1) < 0.99)
    middle = corner[side].mean(axis=1)[:, 2:]
    apex = (np.floor(middle / 5e-3) + 0.5) * 5e-3
    expected = (corner[side][..., 2] - apex) / arc_radius(SMALL.bead)
    assert mesh.normals[side][..., 2] == pytest.approx(expected, abs=1e-6)
    assert np.linalg.norm(mesh.normals, axis=-1) == pytest.approx(1, abs=1e-6)


def test_layer_boundaries_are_creased_and_rims_are_flat():
    mesh = glass_object(SMALL)
    z = mesh.vertices[mesh.faces][..., 2]
    for level, up in ((0.0, -1.0), (SMALL.height, 1.0)):
        rim = (np.abs(z - level) < 1e-12).all(axis=1)
        assert rim.any()
        assert (mesh.normals[rim] == [0, 0, up]).all()
    boundary = mesh.normals[np.abs(z - 0.01) < 1e-9][:, 2]
    steep = 2.5e-3 / arc_radius(SMALL.bead)
    assert np.abs(boundary) == pytest.approx(steep, abs=1e-6)
    assert (boundary > 0).mean() == 0.5


@settings(max_examples=30, deadline=None)
@given(
    width=st.floats(0.1, 0.5),
    stretch=st.floats(0.7, 1.4),
    height=st.floats(0.01, 0.1),
    lobes=st.integers(0, 4),
    lobe=st.floats(0.0, 0.1),
    wall=st.floats(4e-3, 10e-3),
    bead=st.builds(
        Bead,
        height=st.floats(2e-3, 10e-3),
        sag=st.just(0.0) | st.floats(1e-5, 1e-3),
        style=st.sampled_from(["scalloped", "flat"]),
    ),
)
def test_any_valid_object_is_a_solid_of_the_volume_of_the_closed_form(
    width, stretch, height, lobes, lobe, wall, bead
):
    record = GlassObject(
        width=width,
        depth=width * stretch,
        height=height,
        lobes=lobes,
        lobe=lobe,
        wall=wall,
        faces=20_000,
        bead=bead,
    )
    mesh = glass_object(record)
    require_solid("any", mesh)
    assert len(mesh.faces) == pytest.approx(record.faces, rel=0.02)
    assert np.isfinite(mesh.normals).all()
    # Chords across an arc cut off a share of it that falls with the square of their number.
    step = height / (len(np.unique(mesh.vertices[:, 2])) - 1)
    cut = bead.depth * 0.4 * (step / (bead.height / 2)) ** 2 / (wall - 2 * bead.depth)
    volume = as_trimesh(mesh).volume
    assert volume == pytest.approx(closed_form_volume(record), rel=0.01 + cut)


@pytest.mark.parametrize(
    ("record", "sentence"),
    [
        (GlassObject(bead=Bead(sag=2.6e-3)), r"bulges 2\.6 mm, more than half its height of 5 mm"),
        (GlassObject(wall=2.4e-3), r"leave nothing of a wall of 2\.4 mm"),
        (GlassObject(height=6e-3, bead=Bead(height=0.02)), r"6 mm holds no whole layer of 20 mm"),
        (GlassObject(lobes=12, lobe=0.3), r"tightest bend has a radius of .* wall of 8 mm"),
        (GlassObject(width=0.02, depth=0.02, wall=0.01), r"tightest bend has a radius of 10 mm"),
        (GlassObject(width=0.02, depth=1, lobes=6), r"tightest bend has a radius of 0\.\d+ mm"),
        (GlassObject(faces=1000), r"1000 faces are too few for 42 layers; take at least 4080"),
        (GlassObject(width=217.0), r"width = 217\.0 is out of bounds; allowed is 0\.02 to 2 m"),
        (GlassObject(height=float("nan")), r"height = nan is out of bounds"),
    ],
)
def test_bad_values_are_told_in_a_sentence(record, sentence):
    with pytest.raises(ParameterError, match=sentence) as told:
        glass_object(record)
    assert str(told.value).endswith((".", "?"))


def test_as_many_faces_as_the_message_asks_for_are_enough():
    glass_object(GlassObject(faces=4080))
