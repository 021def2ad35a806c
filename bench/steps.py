"""Where the time of a short trace goes: each step on its own, the fastest of three.

    python bench/steps.py [--landed 186000] [--size 256] [--out out/bench]

Table 1's tube under the sample lamp. In a trace the check and the cover run beside the tree, so the
scene takes less than the sum of its steps.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np
from _shared import OUT, save, table

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from heliform.engines.core import solid
from heliform.engines.core.runtime import mitsuba
from peers import tube

TIMES = 3


def fastest(step):
    """The step's result and the seconds of its fastest run."""
    spent = []
    for _ in range(TIMES):
        began = time.perf_counter()
        result = step()
        spent.append(time.perf_counter() - began)
    return result, min(spent)


def main() -> None:
    """Run the steps and print their table."""
    parser = argparse.ArgumentParser(description="Seconds of every step of a trace")
    parser.add_argument("--landed", type=int, default=186_000)
    parser.add_argument("--size", type=int, default=256, help="texels a side")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    mitsuba()
    from heliform.engines.light import emission, kernel, photons, stage
    from heliform.engines.light.luminaires import source

    mesh = tube.tube()
    scene = tube.scene(mesh, asked.size)
    spent = {}
    lamp, spent["lamp file"] = fastest(lambda: source(scene.luminaires[0]))
    centre = mesh.vertices.mean(axis=0)
    soup, spent["triangle soup"] = fastest(lambda: stage._soup(scene, centre))
    _, spent["ray-tracing tree"] = fastest(lambda: stage._tree(soup.vertices, soup.faces))
    _, spent["solid check"] = fastest(lambda: solid.require_solid("Tube", mesh))
    _, spent["cover"] = fastest(lambda: stage._cover(scene, soup, centre))
    staged, spent["whole scene"] = fastest(lambda: stage.build(scene))
    aimed, spent["aiming"] = fastest(lambda: emission.emission(lamp, staged))
    emitter = emission.Emitter(aimed, staged)
    pilot = photons.trace_batch(staged, emitter, 1 << 17, False, (0,))
    share = np.mean((pilot.fate == 1) & (pilot.route == 1))
    count = int(asked.landed / share)
    landing, spent[f"{count:,} photons"] = fastest(
        lambda: photons.trace_batch(staged, emitter, count, False, (1,))
    )
    hit = (landing.fate == 1) & (landing.route == 1)
    texels = asked.size**2
    total = np.bincount(landing.texel[hit], landing.weight[hit], texels).reshape(asked.size, -1)
    square = np.bincount(landing.texel[hit], landing.weight[hit] ** 2, texels).reshape(total.shape)
    _, spent["smoothing"] = fastest(lambda: kernel.smoothed(total, square))
    table(["step", "s"], [list(row) for row in spent.items()], f"{len(mesh.faces):,} faces")
    save("steps", {"faces": len(mesh.faces), "seconds": spent}, asked.out)


if __name__ == "__main__":
    main()
