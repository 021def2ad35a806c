"""The level function, the materials it chooses, and members turned by it."""

from dataclasses import fields

import numpy as np
import pytest
from geomdl import BSpline
from heliform.engines.structure.level_set import Nine, is_steel, level_at, turn_at, turned
from heliform.engines.structure.roof import Roof, roof_model

RNG = np.random.default_rng(5)
VALUES = RNG.uniform(-1, 1, (3, 3))
PLACES = RNG.uniform(size=(50, 2))


def nine_of(values):
    names = [f.name for f in fields(Nine)]
    return Nine(**dict(zip(names, np.ravel(values).tolist(), strict=True)))


def test_the_level_is_geomdls_quadratic_bezier_surface():
    surface = BSpline.Surface()
    surface.degree_u = surface.degree_v = 2
    grid = np.stack([*np.meshgrid([0, 0.5, 1], [0, 0.5, 1], indexing="ij"), VALUES], axis=-1)
    surface.ctrlpts2d = grid.tolist()
    surface.knotvector_u = surface.knotvector_v = [0.0] * 3 + [1.0] * 3
    truth = [surface.evaluate_single((u, v))[2] for u, v in PLACES]
    assert level_at(nine_of(VALUES), PLACES) == pytest.approx(truth, abs=1e-14)


def test_corners_of_the_surface_have_the_corner_values():
    corners = np.array([[0, 0], [0, 1], [1, 0], [1, 1.0]])
    assert level_at(nine_of(VALUES), corners) == pytest.approx(VALUES[::2, ::2].ravel())


def test_the_level_stays_within_its_values():
    level = level_at(nine_of(VALUES), PLACES)
    assert VALUES.min() <= level.min() <= level.max() <= VALUES.max()


def test_all_is_steel_by_default_and_all_timber_at_minus_one():
    surface = roof_model(Roof()).surface
    assert is_steel(Nine(), surface).all()
    columns = np.isnan(surface[:, 0])
    assert columns.sum() == 4
    assert np.array_equal(is_steel(nine_of(np.full(9, -1.0)), surface), columns)


def test_a_level_that_falls_along_u_changes_material_at_its_zero():
    falling = nine_of([[1] * 3, [0.25] * 3, [-0.5] * 3])  # 1 − 1.5 u
    u = np.array([0.1, 0.66, 0.67, 0.9])
    found = is_steel(falling, np.column_stack([u, np.full(4, 0.3)]))
    assert found.tolist() == [True, True, False, False]


def test_turned_members_keep_their_axes_and_lean_by_the_angle():
    model = roof_model(Roof())
    angle = RNG.uniform(-np.pi, np.pi, len(model.frame.members))
    before, after = model.frame.axes(), turned(model, angle).frame.axes()
    assert after[:, 0] == pytest.approx(before[:, 0], abs=1e-12)
    assert np.einsum("mi,mi->m", before[:, 2], after[:, 2]) == pytest.approx(np.cos(angle))
    right = np.einsum("mi,mi->m", np.cross(before[:, 2], after[:, 2]), before[:, 0])
    assert right == pytest.approx(np.sin(angle), abs=1e-12)


def test_turning_there_and_back_changes_nothing():
    model = roof_model(Roof())
    angle = np.full(len(model.frame.members), 0.7)
    back = turned(turned(model, angle), -angle)
    assert back.frame.axes() == pytest.approx(model.frame.axes(), abs=1e-12)


def test_the_surface_turns_members_by_its_level_and_columns_not_at_all():
    model = roof_model(Roof())
    angle = turn_at(nine_of(np.full(9, 0.5)), model.surface, np.radians(60))
    assert angle[:-4] == pytest.approx(np.radians(30))
    assert not angle[-4:].any()
