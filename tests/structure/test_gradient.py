"""Adjoint gradients against central differences and closed forms."""

from dataclasses import fields, replace

import numpy as np
import pytest
from heliform.engines.structure.frame import Rigidities
from heliform.engines.structure.gradient import (
    compliance_gradient,
    displacement_gradient,
    mass_gradient,
)
from heliform.engines.structure.linear import factorise, solve_system
from structure.lines import LENGTH, STIFF, line_of, loads_of, rigid
from structure.shells import shell

WEIGHTS = np.array([1.0, 0.3])
FRAME, RIGIDITIES, LOADS = shell()
PICKED = np.random.default_rng(7).normal(size=LOADS.nodal.shape)
NAMES = [field.name for field in fields(Rigidities)]


def both(frame, rigidities):
    """Compliance and a displacement functional, with their gradients."""
    system = factorise(frame, rigidities)
    response = solve_system(system, LOADS)
    return (
        compliance_gradient(system, response, LOADS, WEIGHTS),
        displacement_gradient(system, response, LOADS, PICKED),
    )


GRADIENTS = [gradient for _, gradient in both(FRAME, RIGIDITIES)]


def difference(vary, step):
    """Central difference of both numbers, to the fourth order."""
    values = [np.array([value for value, _ in both(*vary(k * step))]) for k in (-2, -1, 1, 2)]
    return (8 * (values[2] - values[1]) - (values[3] - values[0])) / (12 * step)


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_by_rigidities_are_central_differences(name):
    value = getattr(RIGIDITIES, name)
    for member in (0, 2, 5, 7):

        def vary(change, member=member):
            return FRAME, replace(
                RIGIDITIES, **{name: value + change * (np.arange(len(value)) == member)}
            )

        truth = difference(vary, 1e-3 * value[member])
        for gradient, slope in zip(GRADIENTS, truth, strict=True):
            greatest = np.abs(getattr(gradient.rigidities, name)).max()
            found = getattr(gradient.rigidities, name)[member]
            assert found == pytest.approx(slope, rel=1e-7, abs=1e-8 * greatest)


@pytest.mark.parametrize("node", [0, 5, 10])
@pytest.mark.parametrize("axis", range(3))
def test_derivatives_by_positions_are_central_differences(node, axis):
    def vary(change):
        nodes = FRAME.nodes.copy()
        nodes[node, axis] += change
        return replace(FRAME, nodes=nodes), RIGIDITIES

    truth = difference(vary, 1e-4)
    for gradient, slope in zip(GRADIENTS, truth, strict=True):
        greatest = np.abs(gradient.nodes).max()
        assert gradient.nodes[node, axis] == pytest.approx(slope, rel=1e-7, abs=1e-8 * greatest)


def test_scaling_all_of_a_member_is_the_sum_of_its_rigidities():
    def vary(change):
        scale = 1 + change * (np.arange(len(FRAME.members)) == 3)
        return FRAME, Rigidities(*(getattr(RIGIDITIES, name) * scale for name in NAMES))

    for gradient, slope in zip(GRADIENTS, difference(vary, 1e-3), strict=True):
        assert gradient.by_scale(RIGIDITIES)[3] == pytest.approx(slope, rel=1e-6)


def test_the_compliance_is_the_work_of_all_loads():
    system = factorise(FRAME, RIGIDITIES)
    response = solve_system(system, LOADS)
    found, _ = compliance_gradient(system, response, LOADS)
    # Work of end forces on strained members, doubled energy: without the part between clamped ends
    elastic = np.zeros(len(LOADS.names))
    for case in range(len(elastic)):
        alone = replace(
            LOADS,
            names=LOADS.names[:1],
            actions=LOADS.actions[:1],
            **{
                name: getattr(LOADS, name)[case : case + 1] for name in ("gravity", "nodal", "line")
            },
        )
        elastic[case] = compliance_gradient(system, solve_system(system, alone), alone)[0]
    assert found == pytest.approx(elastic.sum(), rel=1e-12)
    assert (elastic > 0).all()


def test_a_cantilever_has_the_derivatives_of_its_closed_form():
    frame = line_of(1)
    shear, force = 4e5, 3e3
    stiff = rigid(1, shear=shear)
    loads = loads_of(frame, {1: (force, 0, 0, 0, 0, 0)})
    system = factorise(frame, stiff)
    response = solve_system(system, loads)
    value, gradient = compliance_gradient(system, response, loads)
    assert value == pytest.approx(force**2 * (LENGTH**3 / (3 * STIFF) + LENGTH / shear))
    by = gradient.rigidities
    assert by.bending_y[0] == pytest.approx(-(force**2) * LENGTH**3 / (3 * STIFF**2))
    assert by.shear_z[0] == pytest.approx(-(force**2) * LENGTH / shear**2)
    assert by.axial[0] == by.bending_z[0] == by.torsion[0] == 0
    longer = force**2 * (LENGTH**2 / STIFF + 1 / shear)
    assert gradient.nodes[1, 2] == pytest.approx(longer)
    assert gradient.nodes[0, 2] == pytest.approx(-longer)
    pick = np.zeros((1, 2, 6))
    pick[0, 1, 0] = 1
    tip, gradient = displacement_gradient(system, response, loads, pick)
    assert tip == pytest.approx(value / force)
    assert gradient.rigidities.bending_y[0] == pytest.approx(by.bending_y[0] / force)


def test_own_weight_pulls_harder_where_a_member_weighs_more():
    frame = line_of(1, along=(1.0, 0, 0), up=(0, 0, 1.0))
    stiff = rigid(1, mass=20.0)
    loads = loads_of(frame, gravity=(0, 0, -10.0))
    system = factorise(frame, stiff)
    pick = np.zeros((1, 2, 6))
    pick[0, 1, 2] = 1
    tip, gradient = displacement_gradient(system, solve_system(system, loads), loads, pick)
    assert tip == pytest.approx(-200 * LENGTH**4 / (8 * STIFF))
    assert gradient.rigidities.mass[0] == pytest.approx(tip / 20)
    assert gradient.nodes[1, 0] == pytest.approx(4 * tip / LENGTH)
    assert gradient.by_scale(stiff)[0] == pytest.approx(0, abs=1e-12)  # heavier as it is stiffer


def test_moving_the_whole_frame_changes_nothing():
    for gradient in GRADIENTS:
        assert gradient.nodes.sum(axis=0) == pytest.approx(
            0, abs=1e-9 * np.abs(gradient.nodes).max()
        )


def test_the_mass_changes_with_weights_and_lengths():
    mass, gradient = mass_gradient(FRAME, RIGIDITIES)
    assert mass == pytest.approx((RIGIDITIES.mass * FRAME.lengths()).sum())
    assert gradient.rigidities.mass == pytest.approx(FRAME.lengths())
    assert gradient.by_scale(RIGIDITIES).sum() == pytest.approx(mass)
    step = np.random.default_rng(3).normal(size=FRAME.nodes.shape)
    ahead, behind = (
        mass_gradient(replace(FRAME, nodes=FRAME.nodes + change * step), RIGIDITIES)[0]
        for change in (1e-5, -1e-5)
    )
    assert (gradient.nodes * step).sum() == pytest.approx((ahead - behind) / 2e-5, rel=1e-7)


def test_normals_along_their_members_do_as_the_axes_do():
    frame, rigidities, loads = shell(special=False)
    frame.normals[4] = frame.nodes[frame.members[4, 1]] - frame.nodes[frame.members[4, 0]]
    system = factorise(frame, rigidities)
    _, gradient = compliance_gradient(system, solve_system(system, loads), loads)
    assert np.isfinite(gradient.nodes).all()
