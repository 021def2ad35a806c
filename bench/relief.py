"""The relief of printed layers: the live modifier, the arrays, and Blender's own Displace.

    python bench/relief.py [--faces 10000 250000 2000000] [--quick] [--out out/bench]

A closed tube of so many quadrilaterals, both faces with relief, evaluated in this process; the
fastest of several. The modifier's time includes smooth shading with creases found anew. `displace`
is Blender's own Displace modifier with a float picture of the same profile, placed by UV: the peer,
which has no spiral, no roughness and no creases. Errors are the farthest that a vertex is from the
arc of a circle in closed form, in µm; where it is rough, from the arrays.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from _shared import OUT, save, table
from heliform.addon.bridge.meshes import places_of, to_blender
from heliform.addon.bridge.print_layers import add_modifier, skin_from_blender, skin_to_blender
from heliform.engines.core.scene import Mesh
from heliform.engines.glass.bead import Bead
from heliform.engines.glass.bead import relief as bead_relief
from heliform.engines.glass.profile import Style, scalloped, texture_of
from heliform.engines.glass.relief import Relief, relieve, relieved
from heliform.engines.glass.skin import Skin

FACES = [10_000, 250_000, 2_000_000]
HEIGHT, RADIUS, WALL = 0.2, 0.1, 8e-3
BEAD = Bead(height=5e-3, sag=1.2e-3)
PIXELS = 1024


def tube(faces: int) -> tuple[Mesh, Skin]:
    """Both faces of a tube, closed by rims one face wide, and its skin."""
    rows = max(2, round(np.sqrt(faces / 4)))
    around = max(3, round(faces / (2 * rows)))
    angle = np.arange(around) * (2 * np.pi / around)
    plan = np.column_stack([np.cos(angle), np.sin(angle)])
    z = np.linspace(0, HEIGHT, rows)
    points = np.empty((2 * rows, around, 3))
    points[..., :2] = np.repeat([RADIUS, RADIUS - WALL], rows)[:, None, None] * plan
    points[..., 2] = np.concatenate([z, z[::-1]])[:, None]
    here = np.arange(2 * rows, dtype=np.int32)[:, None] * around + np.arange(around, dtype=np.int32)
    above = np.roll(here, -1, axis=0)
    corners = [here, np.roll(here, -1, axis=1), np.roll(above, -1, axis=1), above]
    skin = Skin(
        normal=np.tile(plan, (2 * rows, 1)),
        side=np.repeat([1.0, -1.0], rows * around),
        turn=np.tile(angle / (2 * np.pi), 2 * rows),
        girth=2 * np.pi * RADIUS,
    )
    return Mesh(points.reshape(-1, 3), np.stack(corners, -1).reshape(-1, 4)), skin


def style() -> Style:
    """The scallop with a texture of 512 × 256."""
    texture, _ = texture_of(np.random.default_rng(1).normal(size=(256, 512)), (0.05, 0.025))
    bead = scalloped(BEAD.height, BEAD.sag)
    return Style("Bench", bead.profile, bead.inner, texture, bead.height, bead.depth, 5e-5)


def closed_form(places: np.ndarray, skin: Skin) -> np.ndarray:
    """The stacked relief, crests on the wall, from the circle itself."""
    across = np.mod(places[:, 2], BEAD.height)
    offset = skin.side * (bead_relief(BEAD, across)[0] - BEAD.sag)
    moved = places.copy()
    moved[:, :2] += offset[:, None] * skin.normal
    return moved


def fastest(call: Callable[[], object], times: int) -> float:
    """The least seconds that a call took."""
    best = np.inf
    for _ in range(times):
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best


def evaluated(obj: bpy.types.Object, times: int) -> tuple[float, np.ndarray]:
    """Seconds of the last modifier alone, and where the vertices come to lie."""
    graph = bpy.context.evaluated_depsgraph_get()
    seconds = []
    for _ in range(times):
        obj.update_tag()
        graph.update()
        seconds.append(obj.evaluated_get(graph).modifiers[-1].execution_time)
    return min(seconds), places_of(obj.evaluated_get(graph).data)


def displace(obj: bpy.types.Object, skin: Skin) -> None:
    """Blender's own: a picture of the profile, by UV, along the vertex normals."""
    picture = bpy.data.images.new("Profile", 4, PIXELS, float_buffer=True, is_data=True)
    offset = bead_relief(BEAD, (np.arange(PIXELS) + 0.5) / PIXELS * BEAD.height)[0] / BEAD.sag
    colour = np.column_stack([offset, offset, offset, np.ones(PIXELS)])
    picture.pixels.foreach_set(np.repeat(colour, 4, axis=0).astype(np.float32).ravel())
    picture.pack()
    texture = bpy.data.textures.new("Profile", "IMAGE")
    texture.image, texture.extension = picture, "REPEAT"
    texture.use_interpolation = True
    texture.filter_size = 0.1
    block = obj.data
    uv = np.empty((len(block.loops), 2), np.float32)
    corner = np.empty(len(block.loops), np.int32)
    block.loops.foreach_get("vertex_index", corner)
    uv[:, 0], uv[:, 1] = 0.5, (places_of(block)[:, 2] / BEAD.height)[corner]
    block.uv_layers.new().uv.foreach_set("vector", uv.ravel())
    modifier = obj.modifiers.new("Displace", "DISPLACE")
    modifier.texture, modifier.texture_coords = texture, "UV"
    modifier.direction, modifier.mid_level, modifier.strength = "NORMAL", 1.0, BEAD.sag


def one(faces: int, times: int) -> list[dict]:
    """All ways at one size."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    mesh, skin = tube(faces)
    block = to_blender(mesh, "Tube")
    obj = bpy.data.objects.new("Tube", block)
    bpy.context.collection.objects.link(obj)
    places, look = places_of(block), style()
    inside = (places[:, 2] > 0) & (places[:, 2] < HEIGHT)  # Displace leans at the rims
    truth = closed_form(places, skin)
    smooth, rough = Relief(spiral=False), Relief(spiral=False, roughness=5e-5, seed=7)
    rows = []

    def told(way: str, seconds: float, found: np.ndarray | None, against: np.ndarray) -> None:
        error = "" if found is None else float(np.abs(found - against)[inside].max() * 1e6)
        rows.append({"faces": len(mesh.faces), "way": way, "ms": seconds * 1e3, "error_um": error})

    seconds = fastest(lambda: relieve(places, skin, smooth, look), times)
    told("arrays", seconds, relieve(places, skin, smooth, look), truth)
    seconds = fastest(lambda: relieve(places, skin, rough, look), times)
    told("arrays, rough", seconds, None, truth)
    bare = Mesh(places, mesh.faces)
    seconds = fastest(lambda: relieved(bare, skin, smooth, look), min(times, 3))
    told("arrays, creased", seconds, None, truth)
    for skinned in (False, True):
        if skinned:
            skin_to_blender(skin, block)
        made = relieve(places, skin_from_blender(block), rough, look)
        for name, relief, against in (("", smooth, truth), (", rough", rough, made)):
            add_modifier(obj, relief, look)
            which = "modifier on a wall" if skinned else "modifier on any mesh"
            told(which + name, *evaluated(obj, times), against)
            obj.modifiers.clear()
    displace(obj, skin)
    told("displace", *evaluated(obj, times), truth)
    return rows


def main() -> None:
    """Run the bench and print its table."""
    parser = argparse.ArgumentParser(description="The relief: modifier, arrays, Displace")
    parser.add_argument("--faces", type=int, nargs="+", default=FACES)
    parser.add_argument("--quick", action="store_true", help="fewer repeats")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    rows = [row for faces in asked.faces for row in one(faces, 4 if asked.quick else 15)]
    peer = {row["faces"]: row["ms"] for row in rows if row["way"] == "displace"}
    for row in rows:
        row["times_displace"] = row["ms"] / peer[row["faces"]]
    head = ["faces", "way", "ms", "error_um", "times_displace"]
    table(
        head, [[row[key] for key in head] for row in rows], "Relief of a tube (fastest of several)"
    )
    save("relief", {"rows": rows}, asked.out)


if __name__ == "__main__":
    main()
