"""Noise against time: Mitsuba's own light tracer, which sees the plane from below, and ours.

    python bench/ptracer.py [--samples 4 16 64] [--size 256] [--out out/bench]

Table 1's tube under a Lambertian disk lamp, 256² texels. `ptracer` joins every photon that reaches
the plane to a camera under it, where the plane passes light on evenly; ours counts landings, once
with all light traced and once as it does by default, direct light computed. Both trace in
millimetres with the same glass. The noise is the relative difference of two seeds over √2, root
mean square over texels above 5 % of the mean; since it falls as 1 ÷ √time, time × noise² is what a
picture costs, and the ratio of the two is printed. Our smooth map is left out: `ptracer` has none.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np
from _shared import OUT, save, table

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from heliform.engines.core.runtime import mitsuba
from heliform.engines.core.scene import Body, Lamp, Luminaire, Material, Mesh
from light import scenes
from peers import tube

WIDTH, FLUX = 0.05, 500.0
LANDED = (250_000, 1_000_000, 4_000_000)
DEPTH = 32
FLOOR = 0.05
MM = 1000.0
FAR = 5000.0
"""mm from the plane down to the camera, which has to be one with a point of view."""


def noise(one, other) -> float:
    """Relative noise of either map."""
    mean = (one + other) / 2
    bright = mean > FLOOR * mean.mean()
    return float(np.sqrt(np.mean(((one - other)[bright] / mean[bright]) ** 2) / 2))


def peer_scene(mesh: Mesh, size: int):
    """The scene for `ptracer`, in millimetres."""
    mi = mitsuba()
    mesh = mesh.triangles()
    glass = mi.Mesh("tube", 3 * len(mesh.faces), len(mesh.faces), has_vertex_normals=True)
    handle = mi.traverse(glass)
    corners = (mesh.vertices * MM)[mesh.faces].astype(np.float32)
    handle["vertex_positions"] = corners.ravel()
    handle["vertex_normals"] = mesh.normals.astype(np.float32).ravel()
    handle["faces"] = np.arange(corners[..., 0].size, dtype=np.uint32)
    handle.update()
    glass.set_bsdf(mi.load_dict({"type": "dielectric", "int_ior": tube.IOR, "ext_ior": 1.0}))
    to = mi.ScalarTransform4f
    half = tube.PLANE * MM / 2
    thin = {"type": "principledthin", "diff_trans": 2.0, "base_color": {"type": "rgb", "value": 1}}
    return mi.load_dict(
        {
            "type": "scene",
            "glass": glass,
            "plane": {"type": "rectangle", "to_world": to().scale([half, half, 1]), "bsdf": thin},
            "lamp": {
                "type": "disk",
                "to_world": to().translate([0, 0, tube.LAMP * MM]).rotate([1, 0, 0], 180)
                @ to().scale(WIDTH * MM / 2),
                "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 1}},
            },
            "camera": {
                "type": "perspective",
                "fov": float(np.degrees(2 * np.arctan(half / FAR))),
                "near_clip": 10.0,
                "far_clip": 2 * FAR,
                "to_world": to().look_at([0, 0, -FAR], [0, 0, 0], [0, 1, 0]),
                "film": {
                    "type": "hdrfilm",
                    "width": size,
                    "height": size,
                    "rfilter": {"type": "box"},
                    "pixel_format": "luminance",
                },
            },
        }
    )


def peer(mesh: Mesh, size: int, samples: tuple[int, ...]) -> list[dict]:
    """Time and noise of `ptracer` at several samples a pixel."""
    mi = mitsuba()
    scene = peer_scene(mesh, size)
    integrator = mi.load_dict({"type": "ptracer", "max_depth": DEPTH})
    rows = []
    np.asarray(mi.render(scene, integrator=integrator, spp=1, seed=9))
    for spp in samples:
        maps, began = [], time.perf_counter()
        for seed in (1, 2):
            maps.append(np.asarray(mi.render(scene, integrator=integrator, spp=spp, seed=seed)))
        seconds = (time.perf_counter() - began) / 2
        rows.append({"way": "ptracer", "photons": spp * size * size, "seconds": seconds})
        rows[-1]["noise"] = noise(*(m[..., 0].astype(np.float64) for m in maps))
    return rows


def ours(mesh: Mesh, size: int, direct: str) -> list[dict]:
    """Time and noise of `trace`, building the scene left out as it is for the peer."""
    from heliform.engines.light import PhotonTracing

    lamp = Lamp(source="disk", flux=FLUX, opening="round", width=WIDTH)
    scene = scenes.scene(
        Body("Tube", mesh, Material(kind="dielectric", ior=tube.IOR)),
        lamp=Luminaire("Disk", lamp, scenes.at(z=tube.LAMP)),
        receiver=tube.receiver(size),
    )
    rows = []
    for landed in LANDED:
        maps, spent = [], []
        for seed in (1, 2):
            marks: list[float] = []

            def heard(fraction: float, text: str, marks: list[float] = marks) -> None:
                if fraction >= 0.2:
                    marks.append(time.perf_counter())

            tracing = PhotonTracing(until="landed", landed=landed, direct=direct, kernel="none")
            result = scenes.traced(scene, tracing, seed=seed, progress=heard)
            spent.append(time.perf_counter() - marks[0])
            maps.append(result.illuminance.astype(np.float64))
        rows.append({"way": f"ours, direct {direct}", "photons": result.meta["photons"]["emitted"]})
        rows[-1] |= {"seconds": float(np.mean(spent)), "noise": noise(*maps)}
    return rows


def main() -> None:
    """Run the bench and print its table."""
    parser = argparse.ArgumentParser(description="Noise against time beside Mitsuba's ptracer")
    parser.add_argument("--samples", type=int, nargs="+", default=[4, 16, 64], help="a pixel")
    parser.add_argument("--size", type=int, default=256, help="texels a side")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    mesh = tube.tube()
    rows = peer(mesh, asked.size, tuple(asked.samples))
    cost = min(r["seconds"] * r["noise"] ** 2 for r in rows)
    for direct in ("traced", "computed"):
        rows += ours(mesh, asked.size, direct)
    for row in rows:
        row["ratio"] = cost / (row["seconds"] * row["noise"] ** 2)
    names = ["way", "photons", "seconds", "noise", "ratio"]
    table(names, [[r[n] for n in names] for r in rows], "ptracer's best time × noise² ÷ each one's")
    save("ptracer", {"faces": len(mesh.faces), "rows": rows}, asked.out)


if __name__ == "__main__":
    main()
