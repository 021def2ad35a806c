"""Radiance as a second opinion: the same glass, lamp and plane through its photon map.

Used by the peer tests and the bench only; every program comes from the pyradiance package.
"""

import io
import os
import subprocess
import time
from pathlib import Path

import numpy as np
import pyradiance
from heliform.engines.core.scene import Mesh, Receiver

LUMENS_PER_WATT = 179.0
LUMINANCE = np.array([0.265, 0.670, 0.065])
RAYPATH = os.pathsep.join([".", str(Path(pyradiance.__file__).parent / "lib")])
EMISSION = ("-ds", 0.1, "-dp", 40_000)
"""The lamp's opening in one piece and its directions in cells of 0.3°. With mkpmap's own 1000 cells
a steradian this narrow beam comes out 5 % too bright."""


def run(folder: Path, *command, data: bytes | None = None, out: str | None = None) -> bytes:
    """One Radiance program in ``folder``; its standard output, written to ``out`` if named."""
    done = subprocess.run(
        [str(pyradiance.BINPATH / command[0]), *map(str, command[1:])],
        cwd=folder,
        input=data,
        capture_output=True,
        env={**os.environ, "RAYPATH": RAYPATH},
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"{command[0]}: {done.stderr.decode(errors='replace')}")
    if out:
        (folder / out).write_bytes(done.stdout)
    return done.stdout


def write_obj(path: Path, mesh: Mesh) -> None:
    """The mesh as OBJ with a normal for every corner."""
    corners = mesh.faces.shape[1]
    normals = mesh.normals.reshape(-1, 3)
    number = np.arange(len(normals)).reshape(-1, corners) + 1
    with path.open("w") as file:
        np.savetxt(file, mesh.vertices, "v %.7g %.7g %.7g")
        np.savetxt(file, normals, "vn %.6g %.6g %.6g")
        pairs = np.stack([mesh.faces + 1, number], axis=-1).reshape(len(mesh.faces), -1)
        np.savetxt(file, pairs, "f " + " ".join(["%d//%d"] * corners))


def describe(folder: Path, lamp: Path, height: float, receiver: Receiver, ior: float = 1.5) -> None:
    """Lamp, glass and plane as Radiance files; the glass is glass.obj.

    The plane is as good as black: light that it scattered would come back through the glass and
    count as caustic.
    """
    run(folder, "ies2rad", "-dm", "-o", "lamp", lamp)
    o, u, v = receiver.origin, receiver.u, receiver.v
    corners = " ".join(f"{c:.7g}" for point in (o, o + u, o + u + v, o + v) for c in point)
    (folder / "plane.rad").write_text(
        f"void plastic black 0 0 5 .001 .001 .001 0 0\nblack polygon plane 0 0 12 {corners}\n"
    )
    (folder / "glass.rad").write_text(
        f"!{pyradiance.BINPATH / 'xform'} -t 0 0 {height} lamp.rad\n"
        f"void dielectric clear 0 0 5 1 1 1 {ior} 0\n"
        "clear mesh glass 1 glass.rtm 0 0\n"
    )


def build(folder: Path) -> None:
    """From glass.obj to two octrees: scene.oct of everything, plane.oct of the plane alone.

    Photons are traced in the first. Read in the second, where no lamp shines, they are the caustic
    and nothing else.
    """
    run(folder, "obj2mesh", "glass.obj", "glass.rtm")
    run(folder, "oconv", "plane.rad", "glass.rad", out="scene.oct")
    run(folder, "oconv", "plane.rad", out="plane.oct")


def caustic_map(folder: Path, photons: int, seed: int, threads: int = 2) -> None:
    """caustic.pm with about ``photons`` caustic photons."""
    command = ("mkpmap", "-n", threads, "-fo+", "-apr", seed, *EMISSION, "-apc", "caustic.pm")
    run(folder, *command, photons, "scene.oct")


def points(receiver: Receiver, columns: int, rows: int) -> bytes:
    """Rays for rtrace -I at texel centres, a hair above the plane, row 0 at v = 0."""
    s, t = (np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows
    place = receiver.origin + s[None, :, None] * receiver.u + t[:, None, None] * receiver.v
    normal = np.broadcast_to(receiver.normal, place.shape)
    rays = np.concatenate([place + 1e-5 * normal, normal], axis=-1)
    return rays.reshape(-1, 6).astype("<f4").tobytes()


def caustic(folder: Path, rays: bytes, shape, bandwidth: tuple[int, ...], threads: int = 2):
    """Illuminance (rows, columns) in lx from the photons nearest to each point.

    One ``bandwidth`` is their number; two are the bounds between which Radiance chooses it.
    """
    command = ("rtrace", "-n", threads, "-h", "-fff", "-I", "-ab", 0)
    found = run(folder, *command, "-ap", "caustic.pm", *bandwidth, "plane.oct", data=rays)
    return LUMENS_PER_WATT * np.frombuffer(found, "<f4").reshape(*shape, 3) @ LUMINANCE


def stored_photons(folder: Path, receiver: Receiver, size: int):
    """How many photons of the map lie in each of ``size``² blocks, and the flux of one in lm.

    The photons themselves, without a density estimate and its blur.
    """
    text = run(folder, "pmapdump", "-a", "-f", "-n", 10**9, "caustic.pm")
    photons = np.loadtxt(io.BytesIO(text))
    offset = photons[:, :3] - receiver.origin
    u, v = (offset @ edge / (edge @ edge) for edge in (receiver.u, receiver.v))
    count, _, _ = np.histogram2d(v, u, bins=size, range=[[0, 1], [0, 1]])
    return count, LUMENS_PER_WATT * float((photons[:, 3:] @ LUMINANCE).mean())


def timed(function, *arguments, **options):
    """The function's result and its seconds."""
    began = time.perf_counter()
    result = function(*arguments, **options)
    return result, time.perf_counter() - began
