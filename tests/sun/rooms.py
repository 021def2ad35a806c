"""Rooms whose light is known: spheres and boxes with an opening, and radiosity to hold them to."""

import numpy as np
from heliform.engines.core.scene import Body, Material, Mesh
from heliform.engines.sun.coefficients import Sought, daylight_coefficients
from heliform.engines.sun.dome import Dome
from heliform.engines.sun.sensors import at_points
from heliform.engines.sun.site import Site
from heliform.engines.sun.surroundings import Surroundings
from sun.shades import sheet

BOSTON = Site()


def matte(reflectance):
    return Material(kind="diffuse", reflectance=reflectance)


def even(dome: Dome):
    """A sky and a ground of luminance 1, as `Sought` has it."""
    return np.ones((3, dome.count, 1))


def traced(bodies, points, normals, bounces=4, skies=None, *, paths=1 << 14, error=1e-9, **more):
    """The coefficients of sensors among bodies on the plain dome."""
    dome = Dome(1, BOSTON)
    sought = Sought(even(dome) if skies is None else skies, error, paths)
    sensors = at_points(points, normals)
    return daylight_coefficients(
        Surroundings(tuple(bodies)), sensors, dome, bounces, sought, **more
    )


def sphere(reflectance, opening, rings=60, sectors=96):
    """A sphere of radius 1 m without the cap that is ``opening`` of its area; inward normals and
    middles of some faces below the horizon."""
    angle = np.linspace(np.arccos(1 - 2 * opening), np.pi - 1e-3, rings)
    turn = 2 * np.pi * np.arange(sectors) / sectors
    vertices = np.stack(
        [
            np.outer(np.sin(angle), np.cos(turn)),
            np.outer(np.sin(angle), np.sin(turn)),
            np.outer(np.cos(angle), np.ones(sectors)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    ring, sector = np.meshgrid(np.arange(rings - 1), np.arange(sectors), indexing="ij")
    beside = (sector + 1) % sectors
    corners = (ring, sector), (ring + 1, sector), (ring + 1, beside), (ring, beside)
    faces = np.stack([r * sectors + s for r, s in corners], axis=-1).reshape(-1, 4)
    middles = vertices[faces].mean(axis=1)
    mesh = Mesh(vertices, faces.astype(np.int32))
    return Body("sphere", mesh, matte(reflectance)), middles, -middles


def well(size, height, reflectance):
    """A square box without a lid, whose floor is at 0: five sheets."""
    s = size / 2
    ring = [(-s, -s), (s, -s), (s, s), (-s, s)]
    faces = [[(x, y, 0.0) for x, y in ring]]
    for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1], strict=True):
        faces.append([(ax, ay, 0.0), (bx, by, 0.0), (bx, by, height), (ax, ay, height)])
    return [sheet(f"side {k}", f, matte(reflectance)) for k, f in enumerate(faces)]


def form_factors(points, normals, polygons):
    """What share of the light at points (N, 3) comes from flat polygons (M, K, 3) that lie wholly
    in front: Lambert's sum over the edges."""
    towards = polygons[None] - points[:, None, None]
    length = np.linalg.norm(towards, axis=-1, keepdims=True)
    towards = np.divide(towards, length, out=np.zeros_like(towards), where=length > 0)
    following = np.roll(towards, -1, axis=2)
    cross = np.cross(towards, following)
    length = np.linalg.norm(cross, axis=-1)
    angle = np.arctan2(length, np.einsum("nmki,nmki->nmk", towards, following))
    along = np.einsum("nmki,ni->nmk", cross, normals)
    parts = np.divide(angle * along, length, out=np.zeros_like(angle), where=length > 1e-12)
    return np.abs(parts.sum(axis=-1)) / (2 * np.pi)


def well_light(size, height, reflectance, points, normals, cells=10):
    """Irradiance (N,) in a `well` under an even sky of 1, straight and in all, by radiosity."""
    quads = []
    grid = np.linspace(0, 1, cells + 1)
    for body in well(size, height, reflectance):
        a, b, _, d = body.mesh.vertices
        for i in range(cells):
            for k in range(cells):
                corners = [(grid[i], grid[k]), (grid[i + 1], grid[k])]
                corners += [(grid[i + 1], grid[k + 1]), (grid[i], grid[k + 1])]
                quads.append([a + u * (b - a) + v * (d - a) for u, v in corners])
    quads = np.array(quads)
    s = size / 2
    lid = np.array([[(-s, -s, height), (s, -s, height), (s, s, height), (-s, s, height)]])
    middles = quads.mean(axis=1)
    inward = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0])
    inward /= np.linalg.norm(inward, axis=1, keepdims=True)
    inward *= np.sign(np.einsum("ij,ij->i", [0, 0, height / 2] - middles, inward))[:, None]
    between = form_factors(middles, inward, quads)
    side = np.repeat(np.arange(5), cells**2)
    between[side[:, None] == side] = 0
    straight = np.pi * form_factors(middles, inward, lid)[:, 0]
    light = np.linalg.solve(np.eye(len(quads)) - reflectance * between, straight)
    here = np.pi * form_factors(points, normals, lid)[:, 0]
    there = form_factors(points, normals, quads)
    own = np.abs(np.einsum("nmi,ni->nm", middles[None] - points[:, None], normals)) < 1e-9
    return here, here + np.where(own, 0, there) @ (reflectance * light)
