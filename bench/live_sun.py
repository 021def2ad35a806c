"""Live Sun without drawing: how often a second colours follow a roof that moves, in Blender.

    python bench/live_sun.py [--moves 40] [--out out/bench]

The roof of structure's preset stands over a receiver half as long again. Either one of its control
points is lifted step by step, and it is built, analysed and sized in haste as while a hand drags;
or the whole roof is lifted. Then Live Sun reads the scene, asks the worker and colours the
receiver, for the whole year. What a window adds is drawing, and that is its graphics card's.
"""

import argparse
import os
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from unittest import mock

os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(prefix="heliform-blender-")

import bpy
import heliform
import numpy as np
from _shared import OUT, save, table

TEXELS = (32, 64, 128)


def spent(work: Callable[[], object]) -> float:
    """Milliseconds that it took."""
    begun = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - begun)


def measured(texels: int, moves: int) -> list[dict]:
    """Median times with so many texels along the receiver's longer side."""
    from heliform.addon import live_sun, structures
    from heliform.addon.bridge.handles import handles_of

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    bpy.ops.heliform.add_structure(preset="roof")
    roof = bpy.context.object
    bpy.context.view_layer.update()
    bpy.ops.heliform.add_receiver()
    receiver = bpy.context.object
    plane = receiver.heliform.plane
    plane.width, plane.length = 1.5 * roof.dimensions.x, 1.5 * roof.dimensions.y
    plane.resolution = texels
    receiver.location.z = 0.02
    roof.heliform.controls = True
    scene.heliform.live_texels = texels
    scene.heliform.live_sun = True
    handle = handles_of(roof)["net.p22"]
    haste = partial(structures.rebuild, hasty=True)  # as in a window

    def lift(step: int) -> list[float]:
        handle.location.z += 0.05
        bpy.context.view_layer.update()
        with mock.patch.object(structures, "change", haste):
            built = spent(lambda: structures.follow_handles(roof, scene))
        return [built, spent(lambda: live_sun.changed(scene))]

    def move(step: int) -> list[float]:
        roof.location.z = 0.02 * (step + 1)
        bpy.context.view_layer.update()
        return [0.0, spent(lambda: live_sun.changed(scene))]

    rows = []
    for what, act in (("a control point", lift), ("the whole roof", move)):
        act(0)
        times = np.array([act(step) for step in range(moves)])
        assert not live_sun.state.problem, live_sun.state.problem
        structure, sun = np.median(times, axis=0)
        rows.append(
            {
                "moved": what,
                "texels": f"{texels} × {round(texels * plane.length / plane.width)}",
                "structure (ms)": float(structure),
                "sun (ms)": float(sun),
                "sun, slowest in 20 (ms)": float(np.quantile(times[:, 1], 0.95)),
                "a second": float(1e3 / np.median(times.sum(axis=1))),
            }
        )
    scene.heliform.live_sun = False
    return rows


def main() -> None:
    """Run the bench and print its table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--moves", type=int, default=40, help="steps of each kind")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    heliform.register()
    rows = [row for texels in TEXELS for row in measured(texels, asked.moves)]
    head = list(rows[0])
    table(head, [[row[key] for key in head] for row in rows], "Live, without drawing")
    save("live_sun", {"moves": asked.moves, "rows": rows}, asked.out)
    heliform.unregister()


if __name__ == "__main__":
    main()
