"""How many designs of a frame are solved a second, in one process and in several.

    python bench/batches.py [--members 600 1250 5000] [--cases 5] [--seconds 5]
        [--processes 2] [--out out/bench]

Each design of a square shallow grid shell, held at its corners, has its own sections and its own
nodes, and bears its weight, loads along its members and on its nodes. BLAS runs on one thread.
`processor` is the processor's time for a design, which other work on the machine hardly changes.
`with all` processes is from the call to the last summary, `when started` leaves out what starting
them takes. `gradient` is the compliance's by all rigidities and all nodes of a design once solved.
"""

import argparse
import os
import time
from collections.abc import Callable
from pathlib import Path

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import numpy as np
from _shared import OUT, save, table
from heliform.engines.structure.assembly import pattern_of
from heliform.engines.structure.batch import Design, solve_batch
from heliform.engines.structure.frame import Frame, Rigidities
from heliform.engines.structure.gradient import compliance_gradient
from heliform.engines.structure.linear import factorise, solve_system
from heliform.engines.structure.loads import GRAVITY, Loads

MEMBERS = [600, 1250, 5000]
SPAN, RISE = 30.0, 3.0
E, G, DENSITY = 2.1e11, 8.1e10, 7850.0
TIMES = 5


def grid_shell(members: int) -> Frame:
    """A square grid of about so many members on a shallow dome."""
    side = max(2, round((np.sqrt(1 + 2 * members) - 1) / 2))
    t = np.linspace(0, 1, side + 1)
    x, y = np.meshgrid(SPAN * t, SPAN * t, indexing="ij")
    z = RISE * np.outer(np.sin(np.pi * t), np.sin(np.pi * t))
    number = np.arange((side + 1) ** 2).reshape(side + 1, side + 1)
    lines = [(number[:-1], number[1:]), (number[:, :-1], number[:, 1:])]
    edges = np.concatenate([np.stack(ends, axis=-1).reshape(-1, 2) for ends in lines])
    held = np.zeros((number.size, 6), dtype=bool)
    held[number[[0, 0, -1, -1], [0, -1, 0, -1]]] = True
    nodes = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    up = np.tile([0.0, 0.0, 1.0], (len(edges), 1))
    return Frame(nodes, edges.astype(np.int32), up, held)


def tubes(height: np.ndarray, thickness: float = 0.01) -> Rigidities:
    """Rectangular tubes half as wide as they are high, thin-walled formulas."""
    width = height / 2
    area = 2 * thickness * (height + width)
    about_y = thickness * height**2 * (height / 6 + width / 2)
    about_z = thickness * width**2 * (width / 6 + height / 2)
    torsion = 2 * thickness * (height * width) ** 2 / (height + width)
    return Rigidities(
        axial=E * area,
        bending_y=E * about_y,
        bending_z=E * about_z,
        torsion=G * torsion,
        shear_y=G * 2 * thickness * width,
        shear_z=G * 2 * thickness * height,
        mass=DENSITY * area,
        rotary=DENSITY * (about_y + about_z),
    )


def cases(frame: Frame, count: int) -> Loads:
    """Load cases of its own weight, loads along members and on nodes."""
    rng = np.random.default_rng(0)
    gravity = np.zeros((count, 3))
    gravity[0, 2] = -GRAVITY
    nodal = np.zeros((count, len(frame.nodes), 6))
    nodal[1:, :, :3] = rng.normal(size=(count - 1, len(frame.nodes), 3)) * 1e3
    line = np.zeros((count, len(frame.members), 2, 3))
    line[1:, :, :, 2] = -1e3
    names = tuple(f"Case {k}" for k in range(count))
    return Loads(names, ("permanent",) + ("snow",) * (count - 1), gravity, nodal, line)


def designs_of(frame: Frame, count: int) -> list[Design]:
    """Designs with other sections and other nodes, of one seed."""
    rng = np.random.default_rng(1)
    return [
        (
            frame.nodes + rng.normal(size=frame.nodes.shape) * 0.02,
            tubes(rng.uniform(0.2, 0.5, len(frame.members))),
        )
        for _ in range(count)
    ]


def fastest(step: Callable[[], object], times: int = TIMES) -> float:
    """Seconds of the fastest of several runs."""
    spent = []
    for _ in range(times):
        began = time.perf_counter()
        step()
        spent.append(time.perf_counter() - began)
    return min(spent)


def measure(members: int, count: int, seconds: float, processes: int) -> dict:
    """Designs a second of a frame of about so many members, and what one costs."""
    frame = grid_shell(members)
    loads, pattern = cases(frame, count), pattern_of(frame)
    one = designs_of(frame, 1)
    each = fastest(lambda: solve_batch(frame, one, loads, pattern))
    designs = designs_of(frame, max(2 * processes, round(seconds / each)))
    began = time.process_time()
    alone = fastest(lambda: solve_batch(frame, designs, loads, pattern), 2)
    busy = (time.process_time() - began) / (2 * len(designs))
    empty = fastest(lambda: solve_batch(frame, designs[:2], loads, processes=2), 2)
    together = fastest(lambda: solve_batch(frame, designs, loads, processes=processes), 2)
    system = factorise(frame, one[0][1], pattern)
    response = solve_system(system, loads)
    return {
        "members": len(frame.members),
        "unknowns": len(pattern.free),
        "pattern": fastest(lambda: pattern_of(frame)) * 1e3,
        "factorise": fastest(lambda: factorise(frame, one[0][1], pattern)) * 1e3,
        "solve": fastest(lambda: solve_system(system, loads)) * 1e3,
        "gradient": fastest(lambda: compliance_gradient(system, response, loads)) * 1e3,
        "processor": busy * 1e3,
        "designs": len(designs),
        "a second": len(designs) / alone,
        "with all": len(designs) / together,
        "when started": len(designs) / max(together - empty, 1e-9),
    }


def main() -> None:
    """Measure every size and print the table."""
    parser = argparse.ArgumentParser(description="Designs solved a second")
    parser.add_argument("--members", type=int, nargs="+", default=MEMBERS)
    parser.add_argument("--cases", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=5.0, help="of one process, about")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    rows = [measure(n, asked.cases, asked.seconds, asked.processes) for n in asked.members]
    title = (
        f"{asked.cases} load cases; ms a design, then designs a second, {asked.processes} processes"
    )
    table(list(rows[0]), [list(row.values()) for row in rows], title)
    save("batches", {"cases": asked.cases, "processes": asked.processes, "runs": rows}, asked.out)


if __name__ == "__main__":
    main()
