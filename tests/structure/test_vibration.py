"""Natural frequencies against closed forms of beams, rods and rings."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure import modes as modes_module
from heliform.engines.structure.frame import Frame
from heliform.engines.structure.loads import GRAVITY, Loads
from heliform.engines.structure.vibration import (
    carried_mass,
    natural_frequencies,
    vibration_modes,
)
from structure.lines import LENGTH, STIFF, line_of, rigid

MASS = 12.0
UNIT = np.sqrt(STIFF / MASS) / LENGTH**2 / (2 * np.pi)
"""Hz; times the square of a beam's βL a natural frequency about local y."""
OUT_OF_PLANE = (1, 3, 5)


def plane(frame):
    """The same frame, moving in the plane of x and z alone."""
    held = frame.held.copy()
    held[:, OUT_OF_PLANE] = True
    return replace(frame, held=held)


BEAMS = {
    "cantilever": (range(6), (), (1.8751041, 4.6940911, 7.8547574)),
    "hinged": ((0, 1, 2, 5), (0, 1, 2), (np.pi, 2 * np.pi, 3 * np.pi)),
    "clamped": (range(6), range(6), (4.7300407, 7.8532046, 10.9956079)),
    "clamped and hinged": (range(6), (0, 1, 2), (3.9266023, 7.0685827, 10.2101761)),
}


@pytest.mark.parametrize("ends", BEAMS)
def test_a_beam_swings_as_its_closed_form_says(ends):
    start, end, roots = BEAMS[ends]
    frame = plane(line_of(10, start, end))
    found = natural_frequencies(frame, rigid(10, mass=MASS), 3)[0]
    assert found == pytest.approx(UNIT * np.square(roots), rel=1e-4)


@pytest.mark.parametrize("ends", ["cantilever", "hinged", "clamped"])
def test_dividing_members_converges_with_the_fourth_power_from_above(ends):
    start, end, roots = BEAMS[ends]
    frame = plane(line_of(1, start, end))
    away = [
        natural_frequencies(frame, rigid(1, mass=MASS), 1, pieces=n)[0][0] / UNIT / roots[0] ** 2
        - 1
        for n in (3, 6, 12)
    ]
    assert 0 < away[2] < 3e-5
    assert away[0] / away[1] == pytest.approx(16, rel=0.2)
    assert away[1] / away[2] == pytest.approx(16, rel=0.1)


def test_a_beam_released_at_its_ends_swings_as_one_with_hinges():
    frame = plane(line_of(1, range(6), range(6)))
    releases = np.zeros((1, 12), dtype=bool)
    releases[0, [4, 10]] = True
    released = replace(frame, releases=releases)
    found = natural_frequencies(released, rigid(1, mass=MASS), 3, pieces=16)[0]
    aside = np.sqrt(2) * 4.7300407**2  # about local z, where nothing is released
    truth = UNIT * np.array([np.pi**2, aside, 4 * np.pi**2])
    assert found == pytest.approx(truth, rel=1e-3)


def test_a_free_beam_moves_in_six_ways_without_any_frequency_and_then_swings():
    frame = line_of(8, (), ())
    modes = vibration_modes(frame, rigid(8, mass=MASS, rotary=1e-4), 10, pieces=4)
    bending = UNIT * np.array([4.7300407, 7.8532046]) ** 2
    assert modes.values[:6] == pytest.approx(0, abs=1e-4 * bending[0])
    truth = np.sort(np.concatenate([bending, np.sqrt(2) * bending]))
    assert modes.values[6:] == pytest.approx(truth, rel=1e-5)


def test_a_hinged_beam_that_shears_is_timoshenkos():
    shear, rotary = 2e6, 3.0
    # ρA ρI ω⁴ − ((ρA EI + ρI GA) k² + ρA GA) ω² + GA EI k⁴ = 0 for a sine of wave number k
    inertia = rotary / 3  # EI about y is half of that about z
    k = np.pi / LENGTH
    middle = (MASS * STIFF + inertia * shear) * k**2 + MASS * shear
    squares = np.roots([MASS * inertia, -middle, shear * STIFF * k**4])
    truth = np.sqrt(squares.min()) / (2 * np.pi)
    frame, stiff = (
        plane(line_of(8, *BEAMS["hinged"][:2])),
        rigid(8, STIFF, 1e10, 1e6, shear, MASS, rotary),
    )
    away = [natural_frequencies(frame, stiff, 1, pieces=n)[0][0] / truth - 1 for n in (2, 4, 8)]
    assert 0 < away[2] < 2e-5
    assert away[0] / away[1] == pytest.approx(4, rel=0.02)
    assert away[1] / away[2] == pytest.approx(4, rel=0.02)


def test_rods_stretch_and_twist_at_quarter_waves():
    frame = line_of(64, range(6), ())
    rod = rigid(64, axial=3e6, torsion=2e5, mass=MASS, rotary=0.7)
    for free, stiff, density in ((2, 3e6, MASS), (5, 2e5, 0.7)):
        held = frame.held.copy()
        held[:, np.arange(6) != free] = True
        found = natural_frequencies(replace(frame, held=held), rod, 2, pieces=1)[0]
        truth = np.array([1, 3]) / (4 * LENGTH) * np.sqrt(stiff / density)
        assert found == pytest.approx(truth, rel=3e-4)


def test_a_mass_on_a_light_cantilever_is_a_mass_on_a_spring():
    frame = plane(line_of(2))
    added = np.array([7.0, 0.0, 500.0])  # what is added at a support does nothing
    found = natural_frequencies(frame, rigid(2, mass=1e-6), 1, added)[0][0]
    assert found == pytest.approx(np.sqrt(3 * STIFF / LENGTH**3 / 500) / (2 * np.pi), rel=1e-6)


def ring(count=40, radius=2.0):
    angle = np.arange(count) * 2 * np.pi / count
    nodes = radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    members = np.column_stack([np.arange(count), np.roll(np.arange(count), -1)]).astype(np.int32)
    up = np.tile((0.0, 0.0, 1.0), (count, 1))
    return Frame(nodes, members, up, np.zeros((count, 6), dtype=bool))


def test_a_free_ring_swings_in_and_out_of_its_plane():
    radius, torsion = 2.0, 4e5
    frame = ring(radius=radius)
    found = natural_frequencies(frame, rigid(40, torsion=torsion, mass=MASS, rotary=1e-6), 14)[0]
    n = np.array([2, 3])
    # Timoshenko, Young and Weaver 1974, art. 5.18: inextensional, two modes each
    inward = 2 * STIFF / MASS * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)
    ratio = STIFF / torsion
    outward = STIFF / MASS * n**2 * (n**2 - 1) ** 2 / (n**2 + ratio)
    truth = np.sqrt(np.sort(np.repeat([inward, outward], 2))) / radius**2 / (2 * np.pi)
    assert found[:6] == pytest.approx(0, abs=1e-4 * truth[0])
    assert found[6:] == pytest.approx(np.sort(truth.ravel()), rel=8e-3)


def test_lanczos_finds_what_the_whole_matrix_has(monkeypatch):
    frame = replace(ring(), held=ring().held.copy())
    frame.held[0] = True
    stiff = rigid(40, shear=1e8, mass=MASS, rotary=0.5)
    few = vibration_modes(frame, stiff, 8)
    monkeypatch.setattr(modes_module, "_DENSE", 10_000)
    whole = vibration_modes(frame, stiff, 8)
    assert few.values == pytest.approx(whole.values, rel=1e-8)
    assert np.linalg.norm(few.along, axis=-1).max(axis=(1, 2)) == pytest.approx(1)
    for one, other in zip(few.along, whole.along, strict=True):
        agree = np.sum(one * other) ** 2 / np.sum(one**2) / np.sum(other**2)
        assert agree == pytest.approx(1, abs=1e-6)


def test_frequencies_do_not_depend_on_where_a_frame_stands():
    frame = ring()
    frame.held[0] = True
    stiff = rigid(40, mass=MASS)
    turned = replace(
        frame,
        nodes=np.roll(frame.nodes, 1, axis=1) + 3.0,
        normals=np.roll(frame.normals, 1, axis=1),
    )
    found = natural_frequencies(turned, stiff, 4)[0]
    assert found == pytest.approx(natural_frequencies(frame, stiff, 4)[0], rel=1e-8)


@pytest.mark.parametrize(
    ("mass", "added", "said"),
    [
        (0.0, None, "Member 0 has no mass"),
        (1.0, np.array([0, -1.0, 0]), "Node 1 is given a mass of -1 kg"),
        (1.0, np.zeros(5), "added to 3 nodes"),
    ],
)
def test_masses_that_cannot_be_are_refused(mass, added, said):
    with pytest.raises(SceneError, match=said):
        natural_frequencies(line_of(2), rigid(2, mass=mass), 1, added)


def test_permanent_loads_swing_with_the_members():
    frame = line_of(2)
    count = len(frame.members)
    line = np.zeros((3, count, 2, 3))
    line[0, :, 0, 2], line[1, :, :, 2], line[2, :, :, 2] = -60.0, -1e3, 40.0
    nodal = np.zeros((3, len(frame.nodes), 6))
    nodal[0, 1, 2] = -500.0
    actions = ("permanent", "imposed", "permanent")
    loads = Loads(("glass", "snow", "lift"), actions, np.zeros((3, 3)), nodal, line)
    only = Loads(("glass",), ("permanent",), np.zeros((1, 3)), nodal[:1], line[:1])
    mass = carried_mass(frame, only)
    weight = 500.0 + 30.0 * frame.lengths().sum()
    assert mass.sum() * GRAVITY == pytest.approx(weight)
    assert mass[0] * GRAVITY == pytest.approx(60.0 * frame.lengths()[0] / 3)  # the lever rule
    assert (carried_mass(frame, loads) <= mass).all()  # what lifts takes off, none is negative
    assert (carried_mass(frame, loads) >= 0).all()
