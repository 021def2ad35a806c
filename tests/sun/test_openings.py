"""The points behind panes on which EN 17037 counts sunlight."""

import numpy as np
import pytest
from heliform.engines.core.scene import Body, Material, Mesh
from heliform.engines.sun.en17037 import sunlight_hours
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.openings import panes_of, reference_points
from heliform.engines.sun.probing import distances, floor_below
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.site import Site
from sun.shades import box, level
from sun.test_daylight_places import room

MARCH = (2019, 3, 21)
GLASS = Material(kind="dielectric", ior=1.52)
DESK = at_points([[0, 0, 0.8], [1, 1, 0.8]], [[0, 0, 1.0]] * 2)


def points(bodies, sensors=DESK):
    return reference_points(bodies, Occluders(bodies), sensors)


def test_a_pane_is_told_by_its_middle_its_large_faces_and_its_thickness():
    (pane,) = panes_of((box("pane", [2.0, 0.01, 1.0], [3, 4, 5], GLASS),))
    assert pane.middle == pytest.approx([3, 4, 5])
    assert np.abs(pane.normal) == pytest.approx([0, 1, 0], abs=1e-9)
    assert (pane.thickness, pane.top) == pytest.approx((0.005, 0.5))


def test_two_panes_in_one_mesh_are_two_and_loose_faces_of_one_are_one():
    a, b = (box("pane", [1, 0.01, 1], [x, 0, 0], GLASS).mesh for x in (0, 3))
    both = Mesh(np.concatenate([a.vertices, b.vertices]), np.concatenate([a.faces, b.faces + 8]))
    assert len(panes_of((Body("panes", both, GLASS),))) == 2
    loose = Mesh(
        a.vertices[a.faces.ravel()], np.arange(a.faces.size, dtype=np.int32).reshape(-1, 4)
    )
    assert len(panes_of((Body("pane", loose, GLASS),))) == 1


def test_the_point_is_behind_the_pane_and_looks_out():
    found = points(room())
    assert found is not None
    assert found.points == pytest.approx(np.array([[0, -2.1 + 0.005, 1.5]]), abs=1e-6)
    assert found.normals == pytest.approx(np.array([[0, -1, 0]]), abs=1e-9)


def test_the_point_of_a_low_pane_is_raised_to_a_metre_and_a_fifth():
    low = [b for b in room() if b.name != "pane"]
    low += [
        box("pane", [4, 0.006, 1.6], [0, -2.1, 0.8], GLASS),
        box("lintel", [4, 0.2, 1.4], [0, -2.1, 2.3]),
    ]
    found = points(tuple(low))
    assert found is not None
    assert found.points[0, 2] == pytest.approx(1.2)
    low[-2] = box("pane", [4, 0.006, 1.0], [0, -2.1, 0.5], GLASS)
    found = points(tuple(low))
    assert found is not None
    assert found.points[0, 2] == pytest.approx(0.95)  # the glass ends at 1 m


def test_both_leaves_of_a_double_glazing_look_out():
    second = box("inner leaf", [4, 0.006, 3], [0, -2.0, 1.5], GLASS)
    found = points((*room(), second))
    assert found is not None
    assert found.normals == pytest.approx(np.array([[0, -1, 0]] * 2), abs=1e-9)


def test_a_rooflight_looks_up():
    bodies = tuple(b for b in room() if b.name not in ("ceiling", "pane"))
    south = box("south", [4.4, 0.2, 3], [0, -2.1, 1.5])
    found = points((*bodies, south, level("rooflight", 4, 4, 3.0, GLASS)))
    assert found is not None
    assert found.normals == pytest.approx(np.array([[0, 0, 1.0]]), abs=1e-9)
    assert found.points[0, 2] == pytest.approx(3 - 0.002)


def test_panes_of_another_room_do_not_count():
    far = box("far pane", [2, 0.006, 1], [0, 20, 1.5], GLASS)
    closed = box("south", [4.4, 0.2, 3], [0, -2.1, 1.5])
    assert points((*room(glazed=False), closed, far)) is None
    assert points(room(glazed=False)) is None


@pytest.mark.parametrize(("north", "expected"), [(0.0, 12.0), (180.0, 0.0), (90.0, 6.0)])
def test_on_the_equinox_a_flush_pane_has_the_hours_of_its_side(north, expected):
    # Nothing stands before the pane's face, so its sun is that of half of the sky.
    bodies = tuple(b for b in room() if b.name != "pane")
    bodies = (*bodies, box("pane", [4, 0.006, 3], [0, -2.003, 1.5], GLASS))
    found = points(bodies)
    assert found is not None
    hours = sunlight_hours(Occluders(bodies), found, Site(north=north), MARCH, 0.0)
    assert hours == pytest.approx([expected], abs=0.35)


def test_the_nearest_surface_is_found_and_nothing_is_far():
    bodies = Occluders((level("a", 2, 2, 1.0), level("b", 2, 2, 3.0)))
    origins = np.array([[0, 0, 2.0], [0, 0, 2.0], [9, 9, 2.0]]) - bodies.centre
    directions = np.array([[0, 0, 1.0], [0, 0, -1.0], [0, 0, -1.0]])
    assert distances((bodies.still,), origins, directions).tolist() == pytest.approx(
        [1.0, 1.0, np.inf]
    )
    sensors = at_points([[0, 0, 2.0], [9, 9, 2.0]], [[0, 0, 1.0]] * 2, offset=0.001)
    assert floor_below(bodies, sensors) == pytest.approx([1.001, np.inf], abs=1e-4)
