"""What sun and sky meet in the comparisons with Radiance, and how Radiance is asked about it."""

from pathlib import Path

import numpy as np
from heliform.engines.core.scene import Body, Material, Mesh
from heliform.engines.sun.sensors import on_plane
from peers.radiance import run

DEGREE = 20.0
"""The suns' width, which does not count as shadow rays go to their centres. Radiance sends none
where solid angle × cosine is below 1e-6: suns of their own 0.533° lower than 0.8° would be lost."""
SUN = 0.533
"""Its own width in degrees: a wider one would hide the bright sky around it from ambient rays."""
_SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]], np.int32
)
_UNIT = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def matte(reflectance):
    return Material(kind="diffuse", reflectance=reflectance)


def blocks(name, sizes, centres, reflectance=0.5):
    """Closed boxes, all one body."""
    sizes, centres = np.asarray(sizes, float), np.asarray(centres, float)
    vertices = (_UNIT * sizes[:, None] + centres[:, None]).reshape(-1, 3)
    faces = (_SIDES + 8 * np.arange(len(sizes))[:, None, None]).reshape(-1, 4)
    return Body(name, Mesh(vertices, faces.astype(np.int32)), matte(reflectance))


def sheets(name, corners, reflectance=0.5):
    """Rectangles of four corners each (n, 4, 3), all one body."""
    corners = np.asarray(corners, float)
    faces = np.arange(4 * len(corners), dtype=np.int32).reshape(-1, 4)
    return Body(name, Mesh(corners.reshape(-1, 3), faces), matte(reflectance))


def waffle(pitch=1.5, height=0.6, thickness=0.1, level=3.0, cells=(8, 6)):
    """A roof of fins that cross at right angles, over a floor at z = 0."""
    length, width = (np.array(cells) * pitch).tolist()
    middle = level + height / 2
    x = (np.arange(cells[0] + 1) - cells[0] / 2) * pitch
    y = (np.arange(cells[1] + 1) - cells[1] / 2) * pitch
    sizes = [(thickness, width + thickness, height)] * len(x)
    # A little lower and higher than those that they cross, so that no two faces coincide.
    sizes += [(length + 2 * thickness, thickness, height + 0.002)] * len(y)
    centres = [(a, 0.013, middle) for a in x] + [(0.007, b, middle) for b in y]
    return blocks("Waffle", sizes, centres)


def under_waffle(columns):
    """``columns``² sensors on the floor under `waffle`."""
    return on_plane(np.eye(4), 10.0, 10.0, 10.0 / columns)


def shell(size, opening, reflectances=(0.2, 0.5, 0.7)):
    """A box of sheets of ``size`` m on z = 0 whose lid has an ``opening`` (x, y) m.

    It is a little off the middle, so that no edge is in line with sensors. Reflectances of floor,
    walls and lid.
    """
    a, b = size[0] / 2, size[1] / 2
    h = size[2]
    c, e = opening[0] / 2 + 0.0131, opening[0] / 2 - 0.0131
    d, f = opening[1] / 2 + 0.0061, opening[1] / 2 - 0.0061

    def level(x0, y0, x1, y1, z):
        return [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]

    def wall(x0, y0, x1, y1):
        return [(x0, y0, 0), (x1, y1, 0), (x1, y1, h), (x0, y0, h)]

    lid = [level(-a, -b, a, -d, h), level(-a, f, a, b, h)]
    lid += [level(-a, -d, -c, f, h), level(e, -d, a, f, h)]
    walls = [wall(-a, -b, a, -b), wall(a, -b, a, b), wall(a, b, -a, b), wall(-a, b, -a, -b)]
    floor, sides, top = reflectances
    return (
        sheets("Floor", [level(-a, -b, a, b, 0)], floor),
        sheets("Walls", walls, sides),
        sheets("Lid", lid, top),
    )


def enclosure():
    """72 × 102 × 21 cm, with an opening of 40 × 50 cm in its lid."""
    return shell((0.72, 1.02, 0.21), (0.4, 0.5))


def in_enclosure(spacing):
    """Sensors on the enclosure's floor."""
    return on_plane(np.eye(4), 0.72, 1.02, spacing)


def write_scene(folder: Path, bodies) -> None:
    """scene.rad and scene.oct of the bodies, as triangles of Radiance's matte plastic."""
    lines = []
    for number, body in enumerate(bodies):
        rho = body.material.reflectance
        lines.append(f"void plastic m{number} 0 0 5 {rho} {rho} {rho} 0 0")
        triangles = body.mesh.triangles()
        for index, corners in enumerate(triangles.vertices[triangles.faces].reshape(-1, 9)):
            numbers = " ".join(f"{c:.9g}" for c in corners)
            lines.append(f"m{number} polygon p{number}.{index} 0 0 9 {numbers}")
    (folder / "scene.rad").write_text("\n".join(lines) + "\n")
    run(folder, "oconv", "scene.rad", out="scene.oct")


def rays(sensors) -> bytes:
    """Sensors as rtrace -I and rcontrib -I read them."""
    return np.hstack([sensors.origins, sensors.normals]).astype("<f4").tobytes()


def disc(width: float = DEGREE) -> float:
    """The solid angle in sr of a sun so wide in degrees."""
    return float(2 * np.pi * (1 - np.cos(np.radians(width / 2))))


def write_suns(folder: Path, directions, normal=None) -> None:
    """suns.rad and suns.oct: the scene with a sun in each direction.

    Each gives ``normal`` (S,) W/m² at right angles; without it, the radiance of each is 1 and its
    modifier its own, named in suns.mod.
    """
    lines = []
    for index, (x, y, z) in enumerate(directions):
        bright = 1.0 if normal is None else normal[index] / disc()
        lines.append(f"void light sun{index} 0 0 3 {bright:.9g} {bright:.9g} {bright:.9g}")
        lines.append(f"sun{index} source s{index} 0 0 4 {x:.9g} {y:.9g} {z:.9g} {DEGREE}")
    (folder / "suns.rad").write_text("\n".join(lines) + "\n")
    (folder / "suns.mod").write_text("\n".join(f"sun{i}" for i in range(len(directions))) + "\n")
    run(folder, "oconv", "-i", "scene.oct", "suns.rad", out="suns.oct")


def free(bodies, origins, directions):
    """Whether rays (n,) meet no triangle, one by one in double precision [Möller–Trumbore 1997]."""
    meshes = [body.mesh.triangles() for body in bodies]
    first, second, third = np.concatenate([m.vertices[m.faces] for m in meshes]).swapaxes(0, 1)
    u, v = second - first, third - first
    found = np.empty(len(origins), bool)
    for k, (origin, direction) in enumerate(zip(origins, directions, strict=True)):
        across = np.cross(direction, v)
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = 1 / np.einsum("ij,ij->i", u, across)
            offset = origin - first
            a = np.einsum("ij,ij->i", offset, across) * scale
            turned = np.cross(offset, u)
            b = turned @ direction * scale
            distance = np.einsum("ij,ij->i", v, turned) * scale
            found[k] = not ((a >= 0) & (b >= 0) & (a + b <= 1) & (distance > 0)).any()
    return found


DIRECT = ("-h", "-fff", "-I", "-ab", 0, "-dt", 0, "-dj", 0, "-ds", 0)


def sun_coefficients(folder: Path, sensors, count: int, threads=2):
    """What each sun of `write_suns` gives at a radiance of 1 to each sensor (N, S)."""
    command = ("rcontrib", "-n", threads, *DIRECT, "-V-", "-M", "suns.mod", "suns.oct")
    found = run(folder, *command, data=rays(sensors))
    return np.frombuffer(found, "<f4").reshape(len(sensors), count, 3)[..., 1]


def sun_irradiance(folder: Path, sensors, threads=2):
    """What all suns of `write_suns` together give to each sensor (N,)."""
    command = ("rtrace", "-n", threads, *DIRECT, "suns.oct")
    found = run(folder, *command, data=rays(sensors))
    return np.frombuffer(found, "<f4").reshape(-1, 3)[:, 1]


def write_sky(folder: Path) -> None:
    """sky.oct: the scene under a glow all around it, whose patches rcontrib tells apart."""
    (folder / "sky.rad").write_text("void glow sky 0 0 4 1 1 1 0\nsky source all 0 0 4 0 0 1 360\n")
    run(folder, "oconv", "-i", "scene.oct", "sky.rad", out="sky.oct")


def patch_coefficients(folder: Path, sensors, subdivision, samples, bounces=0, threads=2):
    """What each of Reinhart's patches gives at a radiance of 1 to each sensor (N, P).

    As rfluxmtx asks rcontrib for it: by ``samples`` rays over the hemisphere, after up to
    ``bounces`` reflections.
    """
    count = 144 * subdivision**2 + 2
    command = (
        *("rcontrib", "-n", threads, "-h", "-fff", "-I", "-ab", bounces + 1, "-ad", samples),
        *("-lw", 1e-4 / samples, "-as", 0, "-aa", 0, "-V-", "-e", f"MF:{subdivision}"),
        *("-f", "reinhart.cal", "-bn", count, "-b", "rbin", "-m", "sky", "sky.oct"),
    )
    found = run(folder, *command, data=rays(sensors))
    return np.frombuffer(found, "<f4").reshape(len(sensors), count, 3)[:, 1:, 1]


def write_daylight(folder: Path, brightness: str, sun=None, normal=0.0) -> None:
    """day.oct: the scene under a sky of ``brightness``, an expression of Dx, Dy and Dz, and a sun.

    In photometric units ÷ 179 lm/W, of which `illuminance` knows.
    """
    (folder / "day.cal").write_text(f"day_bright = {brightness};\n")
    text = "void brightfunc dayf 2 day_bright day.cal 0 0\ndayf glow dayg 0 0 4 1 1 1 0\n"
    text += "dayg source all 0 0 4 0 0 1 360\n"
    if sun is not None:
        bright = normal / disc(SUN)
        text += f"void light sunl 0 0 3 {bright:.9g} {bright:.9g} {bright:.9g}\n"
        text += f"sunl source suns 0 0 4 {sun[0]:.9g} {sun[1]:.9g} {sun[2]:.9g} {SUN}\n"
    (folder / "day.rad").write_text(text)
    run(folder, "oconv", "-i", "scene.oct", "day.rad", out="day.oct")


def illuminance(folder: Path, sensors, bounces, samples, threads=2):
    """Illuminance (N,) of `write_daylight` after up to ``bounces`` reflections, without caching.

    That of a sky; a sun, whose own light needs no ambient bounce, is reflected once more.
    """
    command = (
        *("rtrace", "-n", threads, "-h", "-fff", "-I", "-ab", bounces + 1, "-ad", samples),
        *("-as", 0, "-aa", 0, "-lw", 1e-4 / samples, "-lr", 20, "-dt", 0, "-dj", 0, "-ds", 0),
        "day.oct",
    )
    found = run(folder, *command, data=rays(sensors))
    return np.frombuffer(found, "<f4").reshape(-1, 3)[:, 1].astype(float)


def perez_brightness(skies, scale: float) -> str:
    """One of our `Skies`, times ``scale``, as an expression for `write_daylight`."""
    (a, b, g), (f, c, d, e) = skies.gradation[0], skies.indicatrix[0]
    x, y, z = skies.sun[0]
    cosine = f"(Dx*({x:.9g}) + Dy*({y:.9g}) + Dz*({z:.9g}))"
    gamma = f"acos(max(min({cosine}, 1), -1))"
    height = f"(1 + ({a:.9g})*exp(({b:.9g})/max(Dz, .01)) + ({g:.9g})*Dz)"
    spread = f"(({f:.9g}) + ({c:.9g})*exp(({d:.9g})*{gamma}) + ({e:.9g})*{cosine}*{cosine})"
    return f"{scale:.9g} * max({height} * {spread}, 0)"
