"""A collimated beam through a glass ball, against rays traced through the exact sphere."""

import numpy as np
import pytest
from heliform.engines.light import PhotonTracing
from light import scenes

RADIUS, IOR, LUX = 0.02, 1.5, 1000.0
ORDERS = 6


def exact_map(receiver, drop, width, rays=3000):
    """Illuminance (rows, columns) of a beam of ``width`` falling along −Z onto a ball at the origin
    and from it onto a plane at z = −``drop``, Fresnel averaged, internal reflections to ORDERS.

    In the plane of incidence a ray of impact h meets the ball at angle i = asin(h/R), refracts to
    r = asin(sin i/n), and after k internal reflections leaves turned by 2(i − r) + k(π − 2r).
    """
    h = (np.arange(rays) + 0.5) / rays * width / 2
    flux = LUX * 2 * np.pi * h * (width / 2 / rays)
    i, r = np.arcsin(h / RADIUS), np.arcsin(h / RADIUS / IOR)
    r_s = (np.sin(i - r) / np.sin(i + r)) ** 2
    r_p = (np.tan(i - r) / np.tan(i + r)) ** 2
    reflectance = (r_s + r_p) / 2
    rim = np.arange(720) * np.pi / 360
    total = np.zeros((receiver.rows, receiver.columns))
    for order in range(ORDERS + 1):
        share = (1 - reflectance) ** 2 * reflectance**order
        # Polar angle of the point of leaving, from +Z, and of the direction there.
        place = i + (order + 1) * (np.pi - 2 * r)
        turn = np.pi + 2 * (i - r) + order * (np.pi - 2 * r)
        x, z = RADIUS * np.sin(place), RADIUS * np.cos(place)
        dx, dz = np.sin(turn), np.cos(turn)
        down = dz < -1e-6
        landing = np.where(down, x + dx * (z + drop) / np.where(down, -dz, 1), 1e9)
        for angle in rim:
            u = landing * np.cos(angle) / np.linalg.norm(receiver.u) + 0.5
            v = landing * np.sin(angle) / np.linalg.norm(receiver.v) + 0.5
            on = down & (u >= 0) & (u < 1) & (v >= 0) & (v < 1)
            texel = (v[on] * receiver.rows).astype(int), (u[on] * receiver.columns).astype(int)
            np.add.at(total, texel, (share * flux)[on] / len(rim))
    return total / receiver.texel_area


@pytest.mark.parametrize("drop", [0.03, 0.045, 0.09])
def test_flux_map_of_a_beam_through_a_ball(drop):
    width = 1.9 * RADIUS
    receiver = scenes.floor(0.04, 41, scenes.at(z=-drop))
    ball = scenes.glass(scenes.sphere(RADIUS, 7))
    lamp = scenes.beam(LUX, width, scenes.at(z=0.05))
    result = scenes.traced(
        scenes.scene(ball, lamp=lamp, receiver=receiver),
        PhotonTracing(until="landed", landed=2_000_000),
        seed=7,
    )
    truth = exact_map(receiver, drop, width)
    counted = truth > 0.05 * truth.mean()
    covered = (result.lower <= truth) & (truth <= result.upper)
    assert covered[counted].mean() > 0.9
    assert result.caustic.sum() == pytest.approx(truth.sum(), rel=3e-3)


def test_a_narrow_beam_meets_in_the_focus_of_the_ball():
    """f = nR / 2(n − 1) from the centre; the spot there is the spherical aberration's."""
    focus, width = IOR * RADIUS / (2 * (IOR - 1)), 0.1 * RADIUS
    ball = scenes.glass(scenes.sphere(RADIUS, 7))
    lamp = scenes.beam(LUX, width, scenes.at(z=0.05))

    def spread(drop):
        receiver = scenes.floor(0.002, 101, scenes.at(z=-drop))
        result = scenes.traced(
            scenes.scene(ball, lamp=lamp, receiver=receiver),
            PhotonTracing(until="landed", landed=200_000),
            seed=8,
        )
        place = scenes.texel_centres(receiver)
        square = place[..., 0] ** 2 + place[..., 1] ** 2
        return np.sqrt((square * result.caustic).sum() / result.caustic.sum())

    at_focus = spread(focus)
    assert at_focus < 0.02 * width
    assert spread(0.9 * focus) > 3 * at_focus
    assert spread(1.1 * focus) > 3 * at_focus
