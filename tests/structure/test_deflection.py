"""Limits of deflection and creep against closed forms and a textbook example."""

from dataclasses import fields, replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.structure.combinations import CombinationRules, combinations_of
from heliform.engines.structure.creep import crept_rigidities, final_deflections
from heliform.engines.structure.deflection import (
    STATIONS,
    DeflectionLimits,
    check_deflections,
    deflection_check,
)
from heliform.engines.structure.frame import FIXED, Frame, Rigidities
from heliform.engines.structure.grade import grades
from heliform.engines.structure.linear import solve_frame
from heliform.engines.structure.loads import Loads
from heliform.engines.structure.sections import rectangle
from heliform.engines.structure.timber_rules import TimberRules, creep_factor

NONE = DeflectionLimits(member=0.0)
MIDDLE = len(STATIONS) // 2


def frame_of(nodes, members, held, normal=(0.0, 0.0, 1.0)):
    """``held``: node → freedoms that are held."""
    fixed = np.zeros((len(nodes), 6), bool)
    for node, freedoms in held.items():
        fixed[node] = freedoms
    count = len(members)
    return Frame(
        np.array(nodes, float), np.array(members, np.int32), np.tile(normal, (count, 1)), fixed
    )


def rigidities_of(bending, count=1, shear=np.inf):
    one = np.ones(count)
    return Rigidities(
        *(1e9 * one, bending * one, bending * one, 1e6 * one, shear * one, shear * one, one, one)
    )


def loads_of(frame, actions, nodal=None, line=None):
    cases, count = len(actions), len(frame.members)
    return Loads(
        tuple(actions),
        tuple(actions),
        np.zeros((cases, 3)),
        np.zeros((cases, len(frame.nodes), 6)) if nodal is None else nodal,
        np.zeros((cases, count, 2, 3)) if line is None else line,
    )


def c24_beam():
    """Benoit, Legrand and Tastet, example 2.3.1: C24, 75 × 200 mm over 4.5 m, every 0.5 m."""
    c24, section = grades()["C24"], rectangle(0.2, 0.075)
    frame = frame_of(
        [[0, 0, 0], [4.5, 0, 0]],
        [[0, 1]],
        {0: [True, True, True, True, False, False], 1: [False, True, True, True, False, False]},
    )
    rigid = Rigidities(
        c24.youngs * section.area,
        c24.youngs * section.inertia_y,
        c24.youngs * section.inertia_z,
        c24.shear * section.torsion,
        c24.shear * section.shear_y,
        c24.shear * section.shear_z,
        c24.density * section.area,
        c24.density * (section.inertia_y + section.inertia_z),
    )
    line = np.zeros((2, 1, 2, 3))
    line[0, ..., 2], line[1, ..., 2] = -0.5 * 0.5e3, -0.5 * 1.5e3
    return frame, rigid, loads_of(frame, ("permanent", "imposed"), line=line)


def crossed_beams():
    """A beam along x and one along y, joined in the middle, 4 m each."""
    ends = {n: [True, True, True, False, False, False] for n in range(4)}
    nodes = [[-2, 0, 0], [2, 0, 0], [0, -2, 0], [0, 2, 0], [0, 0, 0]]
    return frame_of(nodes, [[0, 4], [4, 1], [2, 4], [4, 3]], ends)


def test_a_textbook_beam_sags_as_published_and_creeps_by_equations_2_2_to_2_5():
    frame, rigid, loads = c24_beam()
    rules = CombinationRules(rule="eurocode", imposed="dwelling")
    service = combinations_of(loads, rules).of("service")
    response = solve_frame(frame, rigid, loads)
    at_once = response.combined(service.factors).deflections(STATIONS)[:, 0, MIDDLE, 2]
    whole = int(np.flatnonzero((service.factors == 1.0).all(axis=1))[0])
    assert at_once[whole] == pytest.approx(-10.0014e-3, rel=1e-4)

    creep = creep_factor(grades()["C24"], TimberRules())
    crept = solve_frame(frame, crept_rigidities(rigid, np.array([creep])), loads)
    final = final_deflections(response, crept, service, STATIONS)
    by_hand = 10.0014e-3 * (0.25 * (1 + 0.6) + 0.75 * (1 + 0.3 * 0.6))
    assert final[whole, 0, MIDDLE, 2] == pytest.approx(-by_hand, rel=1e-4)
    quasi = service.kind == "quasi-permanent"
    np.testing.assert_allclose(final[quasi, 0, MIDDLE, 2], at_once[quasi] * 1.6, rtol=1e-9)

    limits = DeflectionLimits(member=300.0, span=4.5, whole=250.0)
    checked = check_deflections(final, frame, limits)
    assert checked.utilisation[:, 0] == pytest.approx([by_hand / 0.015, by_hand / 0.018], rel=1e-4)
    assert (checked.combination == whole).all()
    assert (checked.station == MIDDLE).all()


@pytest.mark.parametrize(
    ("service_class", "factor"),
    [("1 heated indoors", 0.6), ("2 under cover", 0.8), ("3 exposed", 2.0)],
)
def test_creep_factors_are_those_of_table_3_2_and_steel_does_not_creep(service_class, factor):
    rules = TimberRules(service_class=service_class)
    assert creep_factor(grades()["C24"], rules) == factor
    assert creep_factor(grades()["GL24h"], rules) == factor
    assert creep_factor(grades()["S355"], rules) == 0.0


def test_timber_that_creeps_leaves_its_load_to_the_steel_it_crosses():
    frame, load = crossed_beams(), 12e3
    steel, timber, creep = 5e5, 8e5, 2.0
    bending = np.array([steel, steel, timber, timber])
    rigid = rigidities_of(bending, 4)
    nodal = np.zeros((1, 5, 6))
    nodal[0, 4, 2] = -load
    loads = loads_of(frame, ("permanent",), nodal)
    service = combinations_of(loads, CombinationRules()).of("service")
    response = solve_frame(frame, rigid, loads)
    slow = crept_rigidities(rigid, np.array([0, 0, creep, creep]))
    crept = solve_frame(frame, slow, loads)

    def sag(of_timber):
        return -load / (48 * (steel + of_timber) / 4.0**3)

    at_once = response.deflections(STATIONS)[0, 0, -1, 2]
    final = final_deflections(response, crept, service, STATIONS)[0, :, :, 2]
    assert at_once == pytest.approx(sag(timber), rel=1e-6)
    np.testing.assert_allclose([final[0, -1], final[2, -1]], sag(timber / (1 + creep)), rtol=1e-6)
    # The moment in the middle of the steel grows to its share of what then is the stiffness.
    moment = np.abs(crept.forces(STATIONS)[0, 0, -1, 4])
    share = steel / (steel + timber / (1 + creep))
    assert moment == pytest.approx(share * load * 4.0 / 4.0, rel=1e-6)


def test_creep_softens_every_rigidity_and_leaves_the_mass():
    values = [np.array([n, 10.0 * n]) for n in range(1, 9)]
    slow = crept_rigidities(Rigidities(*values), np.array([0.6, 0.0]))
    for number, field in enumerate(fields(Rigidities)):
        share = [1.0, 1.0] if field.name in ("mass", "rotary") else [1 / 1.6, 1.0]
        np.testing.assert_allclose(getattr(slow, field.name), values[number] * share)


def test_without_creep_the_final_deflections_are_the_first_ones():
    frame, rigid, loads = c24_beam()
    service = combinations_of(loads, CombinationRules(rule="eurocode")).of("service")
    response = solve_frame(frame, rigid, loads)
    same = final_deflections(response, response, service, STATIONS)
    np.testing.assert_allclose(
        same, response.combined(service.factors).deflections(STATIONS), atol=1e-15
    )


def test_a_mast_sways_as_a_cantilever():
    height, bending, force = 30.0, 4e8, 5e3
    frame = frame_of([[0, 0, 2.0], [0, 0, 2.0 + height]], [[0, 1]], {0: FIXED}, (1.0, 0, 0))
    nodal = np.zeros((2, 2, 6))
    nodal[0, 1, :2] = np.array([3.0, 4.0]) / 5.0 * force
    nodal[1, 1, 2] = -force
    response = solve_frame(frame, rigidities_of(bending), loads_of(frame, ("wind", "wind"), nodal))
    tip = force * height**3 / (3 * bending)
    limits = replace(NONE, sway=500.0, storey=300.0)
    checked = deflection_check(response, frame, limits)
    assert checked.names == ("Sway, 30 m/500", "Storey drift, h/300")
    assert checked.utilisation[:, 0] == pytest.approx(
        [tip / (height / 500), tip / (height / 300)], rel=1e-6
    )
    assert (checked.combination == 0).all()
    assert (checked.station == len(STATIONS) - 1).all()


def test_each_storey_drifts_by_itself_and_flat_members_do_not_count():
    nodes = [[0, 0, 0], [0, 0, 4], [0.5, 0, 8], [6, 0, 4.5]]
    frame = frame_of(nodes, [[0, 1], [1, 2], [1, 3]], {0: FIXED}, (0, 1.0, 0))
    moved = np.array([[0, 0, 0], [0.004, 0.003, 0], [0.004, 0.013, 0], [0.1, 0, 0.0]])
    part = STATIONS[None, :, None]
    ends = moved[frame.members]
    displacements = (1 - part) * ends[:, :1] + part * ends[:, 1:]
    checked = check_deflections(displacements[None], frame, replace(NONE, storey=400.0))
    np.testing.assert_allclose(
        checked.utilisation[0], [0.005 / (4 / 400), 0.010 / (4 / 400), 0.0], rtol=1e-12
    )


def test_rigid_motion_and_stretching_are_no_deflection_of_members():
    rng = np.random.default_rng(3)
    nodes = rng.normal(size=(8, 3))
    frame = frame_of(nodes, [[n, n + 1] for n in range(7)], {0: FIXED})
    part = STATIONS[None, :, None]
    ends = frame.ends()
    points = (1 - part) * ends[:, :1] + part * ends[:, 1:]
    spin = rng.normal(size=3) * 1e-3
    rigid = rng.normal(size=3) + np.cross(spin, points)
    stretch = (part * (1 - part)) * (ends[:, 1:] - ends[:, :1])
    checked = check_deflections((rigid + stretch)[None], frame, DeflectionLimits())
    assert checked.utilisation.max() < 1e-10


def test_stricter_limits_use_more_in_proportion():
    frame, rigid, loads = c24_beam()
    response = solve_frame(frame, rigid, loads)
    loose = deflection_check(response, frame, DeflectionLimits(member=200.0, span=4.5, whole=100.0))
    tight = deflection_check(response, frame, DeflectionLimits(member=500.0, span=4.5, whole=250.0))
    np.testing.assert_allclose(tight.utilisation, 2.5 * loose.utilisation, rtol=1e-12)
    assert loose.names == ("Deflection between ends, L/200", "Vertical deflection, 4.5 m/100")


def test_no_limit_at_all_is_refused():
    frame, rigid, loads = c24_beam()
    with pytest.raises(ParameterError, match="No limit of deflection"):
        deflection_check(solve_frame(frame, rigid, loads), frame, NONE)
