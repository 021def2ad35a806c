"""Sensors without sun and sky, meshes that look the wrong way: what is said, and only once."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.scene import Material, Mesh, Receiver, Scene, Surface
from heliform.engines.core.unwrap import unwrap
from heliform.engines.sun.daylight import Daylight, WorkingHours, study_daylight
from heliform.engines.sun.live import LiveSun
from heliform.engines.sun.radiation import study_radiation
from heliform.engines.sun.receivers import wound
from sun.floors import QUICK, SUMMER, floor
from sun.shades import box, level, sheet

RECORD = replace(QUICK, period=SUMMER)
EAST, _, UP = np.eye(3)
MARCH = WorkingHours(span="spring equinox")
LEFT = "What bodies reflect is left out"
SKY = "neither sun nor sky"


def house(at=(0, 0, 0)):
    """Walls and a roof over 4 m × 4 m, 3 m high, without a floor."""
    body = box("House", (4, 4, 3), (at[0], at[1], at[2] + 1.5))
    mesh = body.mesh
    low = mesh.vertices[mesh.faces][..., 2].max(axis=1) < at[2] + 1e-9
    return replace(body, mesh=Mesh(mesh.vertices, mesh.faces[~low]))


def said(about, *bodies, receivers=None, record=RECORD):
    """The notes with ``about`` in them, of a study and of a live one, which are to be the same."""
    scene = Scene(bodies, (), receivers or (floor(),))
    notes, live = (
        [note for note in result.meta["notes"] if about in note]
        for result in (study_radiation(scene, record), LiveSun().radiation(scene, record))
    )
    assert notes == live
    return notes


def test_sensors_that_see_neither_sun_nor_sky_are_said():
    (note,) = said(SKY, house())
    assert note.startswith("All 16 sensors of “Floor” see neither")
    (half,) = said(SKY, house((2, 0, 0)))
    assert half.startswith("8 of 16 sensors of “Floor” see neither")
    assert not said(SKY, level("Canopy", 2, 2, 2.0))


def test_a_wall_that_looks_into_its_house_is_said():
    wall = Receiver(
        "Wall", np.array([-2, 2.01, 0.0]), np.array([4.0, 0, 0]), 3 * np.eye(3)[2], 4, 3
    )
    (note,) = said(SKY, house(), receivers=(wall,))
    assert note.startswith("All 12 sensors of “Wall” see neither")
    outward = replace(wall, origin=wall.origin + wall.u, u=-wall.u)
    assert not said(SKY, house(), receivers=(outward,))


def test_sensors_inside_a_solid_and_those_that_look_down_are_said_once():
    solid = box("Block", (4, 4, 4), (0, 0, 0))
    assert not said(SKY, solid)
    assert said("16 of 16 sensors lie inside “Block”", solid)
    under = replace(floor(), u=floor().v, v=floor().u)
    assert not said(SKY, level("Ground", 9, 9, -0.1), receivers=(under,))


def test_sensors_inside_many_bodies_are_said_in_one_sentence():
    town = [box(f"House {k}", (0.2, 0.2, 2), (0.25 * k - 0.375, 0.125, 0)) for k in range(4)]
    scene = Scene(tuple(town), (), (floor(8),))
    (note,) = [n for n in study_radiation(scene, RECORD).meta["notes"] if "lie inside" in n]
    assert "sensors lie inside 4 bodies, most of them in “House" in note
    three = replace(scene, bodies=scene.bodies[:3])
    assert sum("lie inside “House" in n for n in study_radiation(three, RECORD).meta["notes"]) == 3


def turned(mesh, some):
    faces = mesh.faces.copy()
    faces[some] = faces[some, ::-1]
    return Mesh(mesh.vertices, faces)


def surface(mesh, **named):
    return Surface("Tower", mesh, unwrap(mesh, 16), 16, 16, **named)


CUBE = box("Tower", (2, 2, 2), (0, 0, 1)).mesh.triangles()


@pytest.mark.parametrize("count", [1, 3, 7, 11])
def test_a_body_some_of_whose_faces_are_turned_is_said_once(count):
    notes = said("“Tower”", receivers=(surface(turned(CUBE, slice(count))),))
    assert len(notes) == 1
    assert "look opposite ways" in notes[0]
    assert "Recalculate Outside" in notes[0]


def test_a_closed_receiver_that_looks_inward_is_said():
    inward = turned(CUBE, slice(None))
    (note, _) = said("“Tower”", receivers=(surface(inward),))
    assert "looks inward, so it is measured on its inner side" in note
    beside = Mesh(
        np.concatenate([CUBE.vertices, CUBE.vertices + 5 * EAST]),
        np.concatenate([CUBE.faces, inward.faces + len(CUBE.vertices)]),
    )
    assert "inward in 1 of its 2 parts" in wound(surface(beside))[0]


def test_what_looks_outward_or_is_open_is_not_said():
    for mesh in (CUBE, house().mesh.triangles(), turned(house().mesh.triangles(), slice(None))):
        assert not wound(surface(mesh))
    assert not wound(surface(turned(CUBE, slice(None)), sides="both"))
    assert wound(surface(turned(CUBE, slice(3)), sides="both"))
    assert not said("“Tower”", receivers=(surface(CUBE),))


def test_daylight_says_so_as_well():
    """Where a receiver sees no sky, though light comes in from below, and what looks inward."""
    record = Daylight(subdivision=1, accuracy=30.0, error=0.2, paths=2048, period=MARCH)
    room = floor(2, at=(0, 0, 1))
    inward = surface(turned(CUBE, slice(None)))
    scene = Scene((house(),), (), (room, inward))
    notes = study_daylight(scene, record).meta["notes"]
    (note,) = [n for n in notes if SKY in n]
    assert note.startswith("All 4 sensors of “Floor”")
    assert sum("looks inward" in n for n in notes) == 1


def test_what_is_left_out_of_a_bodys_light_is_said():
    mirror = sheet("Mirror", [2 * EAST, 2 * EAST + UP, EAST + UP, EAST], Material(kind="mirror"))
    milk = level("Milk", 1, 1, 2.0, Material(kind="dielectric", roughness=0.2))
    scene = Scene((mirror, milk), (), (floor(),))
    notes = study_radiation(scene, RECORD).meta["notes"]
    (note,) = [n for n in notes if LEFT in n]
    assert "“Mirror”" in note
    (note,) = [n for n in notes if "ground glass" in n]
    assert "“Milk”" in note
    assert "black here" in note
    notes = study_radiation(scene, replace(RECORD, bounces=1, error=0.5)).meta["notes"]
    assert not any(LEFT in n or "black here" in n for n in notes)
    live = LiveSun().radiation(scene, replace(RECORD, bounces=1))
    assert any(LEFT in n and "a study adds it" in n for n in live.meta["notes"])
    black = level("Canopy", 1, 1, 2.0, Material(kind="absorber"))
    assert not said(LEFT, black)
