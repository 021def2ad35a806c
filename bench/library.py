"""How fast candidates are judged, and how that scales with processes.

    python bench/library.py [--walls 250 1000 4000] [--processes 1 2] [--out out/bench]

The default grid of `PrintLibrary`, of which so many walls are drawn. Each line is a run from an
empty store; starting the processes is counted in. Efficiency is the rate against that of one
process, over their number.
"""

import argparse
import os
import tempfile
from pathlib import Path

from _shared import OUT, save, table
from heliform.engines.core.scene import Scene
from heliform.engines.glass import PrintLibrary, print_library

WALLS = [250, 1000, 4000]


def one(walls: int, processes: int) -> dict:
    """A run of so many walls in so many processes."""
    with tempfile.TemporaryDirectory() as folder:
        record = PrintLibrary(
            limit=walls, processes=processes, store_file=str(Path(folder) / "rows.npz")
        )
        found = print_library(Scene(), record, seed=1)
    figures = {name: figure["value"] for name, figure in found.figures().items()}
    return {
        "walls": walls,
        "processes": processes,
        "seconds": figures["judging"],
        "rate": figures["rate"],
        "rate_per_process": figures["rate_per_process"],
        "accepted": figures["accepted"] / walls,
    }


def main() -> None:
    """Run the bench and print its table."""
    parser = argparse.ArgumentParser(description="Walls judged a second against processes")
    parser.add_argument("--walls", type=int, nargs="+", default=WALLS)
    cores = os.cpu_count() or 1
    parser.add_argument("--processes", type=int, nargs="+", default=sorted({1, 2, cores}))
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    one(64, 1)
    runs = []
    for walls in asked.walls:
        alone = 0.0
        for processes in asked.processes:
            run = one(walls, processes)
            alone = alone or run["rate_per_process"]
            runs.append(run | {"efficiency": run["rate_per_process"] / alone})
    names = list(runs[0])
    table(names, [[run[name] for name in names] for run in runs], "Walls judged (s, 1/s)")
    save("library", {"runs": runs}, asked.out)


if __name__ == "__main__":
    main()
