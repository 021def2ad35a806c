"""Outlines: even by length, the right way around, and clear words for curves that cannot be."""

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.glass.outline import outline
from scipy.special import ellipe, ellipeinc

A, B = 0.12, 0.05


def ellipse(count, start=0.0):
    t = start + np.arange(count) * (2 * np.pi / count)
    return np.column_stack([A * np.cos(t), B * np.sin(t)])


def ellipse_arc(points):
    """Share of the ellipse's length from (A, 0) counter-clockwise, by Legendre's integral."""
    t = np.unwrap(np.arctan2(points[:, 1] / B, points[:, 0] / A))
    m = 1 - B**2 / A**2
    return (ellipeinc(t + np.pi / 2, m) - ellipe(m)) / (4 * ellipe(m))


def test_points_stand_evenly_along_an_ellipse_drawn_unevenly():
    found = outline(ellipse(3000), 512)
    assert ellipse_arc(found.points) == pytest.approx(np.arange(512) / 512, abs=1e-9)
    assert found.length == pytest.approx(4 * A * ellipe(1 - B**2 / A**2), rel=1e-8)


def test_a_circle_drawn_in_a_few_points_is_still_round():
    t = np.arange(48) * (2 * np.pi / 48)
    found = outline(0.1 * np.column_stack([np.cos(t), np.sin(t)]))
    assert np.hypot(*found.points.T) == pytest.approx(0.1, rel=1e-5)
    position, speed, change = found.at(np.linspace(-1.3, 2.1, 777))
    assert np.abs(position) == pytest.approx(0.1, rel=1e-5)
    bend = (speed.conj() * change).imag / np.abs(speed) ** 3
    assert bend == pytest.approx(10.0, rel=2e-2)


def test_turns_go_on_beyond_one_and_derivatives_are_those_of_the_position():
    found = outline(ellipse(400), 256)
    turn = np.random.default_rng(3).uniform(-2, 3, 500)
    assert np.abs(found.at(turn)[0] - found.at(turn + 4)[0]).max() < 1e-12
    step = 1e-6
    above, below = found.at(turn + step), found.at(turn - step)
    speed = (above[0] - below[0]) / (2 * step)
    change = (above[1] - below[1]) / (2 * step)
    assert np.abs(speed - found.at(turn)[1]).max() < 1e-7
    assert np.abs(change - found.at(turn)[2]).max() < 1e-3


def test_a_clockwise_curve_is_turned_about_and_keeps_its_start():
    drawn = ellipse(500, start=1.0)
    found, turned = outline(drawn, 200), outline(np.roll(drawn[::-1], 1, axis=0), 200)
    assert turned.points == pytest.approx(found.points, abs=1e-9)
    assert found.points[0] == pytest.approx(drawn[0])


def test_a_repeated_last_point_and_a_third_coordinate_make_no_difference():
    drawn = ellipse(300)
    closed = np.column_stack([np.vstack([drawn, drawn[:1]]), np.full(301, 0.3)])
    assert outline(closed).points == pytest.approx(outline(drawn).points, abs=1e-12)


def test_a_polygon_keeps_its_straight_sides():
    side = np.linspace(-0.1, 0.1, 5)[:-1]
    square = np.vstack(
        [
            np.column_stack([side, np.full(4, -0.1)]),
            np.column_stack([np.full(4, 0.1), side]),
            np.column_stack([-side, np.full(4, 0.1)]),
            np.column_stack([np.full(4, -0.1), -side]),
        ]
    )
    found = outline(square, 800)
    away = 0.1 - np.abs(found.points).max(axis=1)
    corner = np.abs(found.points).min(axis=1) > 0.098
    assert np.abs(away[~corner]).max() < 1e-12
    assert np.abs(away).max() < 5e-4
    assert found.length == pytest.approx(0.8, rel=2e-3)


def circle(share=1.0, count=60):
    t = np.linspace(0, 2 * np.pi * share, count, endpoint=False)
    return np.column_stack([np.cos(t), np.sin(t)]) * 0.1


EIGHT = np.linspace(0, 2 * np.pi, 101)[:-1] + 0.01
BAD = {
    "open": (circle(0.7), "open: its ends are .* mm apart"),
    "crossing": (
        np.column_stack([0.05 + np.cos(EIGHT) / 10, 0.02 + np.sin(2 * EIGHT) / 20]),
        "crosses itself near x 50 mm, y 20 mm",
    ),
    "few": (circle(count=7), "has 7 different points"),
    "one place": (np.zeros((20, 2)), "has 0 different points"),
    "nothing": (np.zeros((0, 2)), "has 0 different points"),
    "line": (np.column_stack([np.linspace(0, 1, 30), np.zeros(30)]), "open|no area|crosses"),
    "not a number": (np.where(circle() > 0.099, np.nan, circle()), "no numbers"),
    "endless": (np.where(circle() > 0.099, np.inf, circle()), "no numbers"),
    "tilted": (np.column_stack([circle(), circle()[:, 0] / 5]), "rises by 40 mm"),
    "flat list": (np.arange(20.0), "points in plan"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_curve_that_cannot_be_a_plan_is_refused_in_a_sentence(name):
    points, said = BAD[name]
    with pytest.raises(ParameterError, match=said) as refused:
        outline(points)
    assert str(refused.value).startswith("[glass.wall] ")
    assert "\n" not in str(refused.value)
