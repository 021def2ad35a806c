"""Path, gate and G-code of printed walls, and the same wall cut layer by layer as slicers do.

    python bench/gate.py [--turns 10 40 160] [--quick] [--out out/bench]

Each wall is a rosette of 5 mm layers. `path`, `gate` and `G-code` are of the whole wall; `quick
gate` says the same of it as path and gate together, without maps; the fastest of several runs
counts. The peer is what is usually done with a mesh: trimesh cuts it at the middle of every layer,
shapely tells for each layer whether the wall keeps its width, and how far it stands over the one
below. It is run on the outer mesh of the same wall, its making not counted.
"""

import argparse
import itertools
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import shapely
import trimesh
from _shared import OUT, save, table
from heliform.engines.glass.bead import Bead
from heliform.engines.glass.fourier import Plan
from heliform.engines.glass.gate import gate, gate_loft
from heliform.engines.glass.gcode import gcode
from heliform.engines.glass.loft import Wall, wall_loft
from heliform.engines.glass.machine import load_machine
from heliform.engines.glass.printed import wall_mesh
from heliform.engines.glass.toolpath import Spiral, spiral

TURNS = [10, 40, 160]
RISE = 5e-3


def wall(turns: int, twist: float) -> Wall:
    """A rosette of so many layers."""
    plan = Plan(radius=0.1, period_1=5, amplitude_1=0.1)
    flat = Bead(style="flat")
    return Wall(plan=plan, height=turns * RISE, twist=twist, faces=1000 * turns, bead=flat)


def fastest(times: int, action: Callable[[], object]) -> float:
    """Seconds of the fastest of some runs."""
    best = np.inf
    for _ in range(times):
        began = time.perf_counter()
        action()
        best = min(best, time.perf_counter() - began)
    return best


def one(turns: int, twist: float, times: int) -> dict:
    """What a wall of so many turns costs, in ms."""
    record, machine, asked = wall(turns, twist), load_machine(), Spiral()
    loft, thick = wall_loft(record), record.thickness
    path = spiral(loft, thick, asked, machine)
    mesh = wall_mesh(record)
    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles().faces)
    seconds = {
        "path": fastest(times, lambda: spiral(loft, thick, asked, machine)),
        "gate": fastest(times, lambda: gate(loft, thick, path, machine)),
        "quick gate": fastest(times, lambda: gate_loft(loft, thick, asked, machine)),
        "G-code": fastest(max(1, times // 4), lambda: gcode(path, machine)),
        "sliced": fastest(1, lambda: sliced(solid, turns, thick)),
    }
    milliseconds = {name: 1e3 * value for name, value in seconds.items()}
    ours = milliseconds["path"] + milliseconds["gate"]
    return {
        "wall": "twisted" if twist else "upright",
        "turns": turns,
        "points": len(path.turn),
        **milliseconds,
        "sliced ÷ (path + gate)": milliseconds["sliced"] / ours,
    }


def sliced(solid: trimesh.Trimesh, turns: int, thickness: float) -> int:
    """How many layers of a mesh are narrower than the wall, or stand out over the one below."""
    heights = (np.arange(turns) + 0.5) * RISE
    sections = solid.section_multiplane([0, 0, 0], [0, 0, 1], heights)
    layers = []
    for section in sections:
        outer, inner = sorted(section.polygons_closed, key=shapely.area, reverse=True)
        layers.append(shapely.difference(outer, inner))
    thin = [shapely.buffer(layer, -0.49 * thickness).is_empty for layer in layers]
    out = [
        not shapely.difference(layer, shapely.buffer(below, RISE * np.tan(np.radians(30)))).is_empty
        for below, layer in itertools.pairwise(layers)
    ]
    return sum(thin) + sum(out)


def main() -> None:
    """Run the bench and print its table."""
    parser = argparse.ArgumentParser(description="Cost of path and print gate against turns")
    parser.add_argument("--turns", type=int, nargs="+", default=TURNS)
    parser.add_argument("--quick", action="store_true", help="two runs instead of twelve")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    times = 2 if asked.quick else 12
    rows = [one(turns, twist, times) for twist in (0.0, 30.0) for turns in asked.turns]
    table(list(rows[0]), [list(row.values()) for row in rows], "Printed walls (ms)")
    save("gate", {"walls": rows}, asked.out)


if __name__ == "__main__":
    main()
