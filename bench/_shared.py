"""What the benches share: a worker process, tables, and the JSON next to them."""

import json
import os
import platform
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
OUT = HERE.parent / "out" / "bench"


def work(
    mesh: Path | int, size: int, runs: list[dict], cache: Path | None = None, lamp: str = ""
) -> dict:
    """The figures of `_worker` for these runs; ``cache``, if named, is where kernels are kept."""
    job = {"mesh": mesh if isinstance(mesh, int) else str(mesh), "size": size, "runs": runs}
    job["lamp"] = lamp
    job["spawned"] = time.time()
    environment = dict(os.environ) | ({"DRJIT_CACHE_DIR": str(cache)} if cache else {})
    command = [sys.executable, str(HERE / "_worker.py"), json.dumps(job)]
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def machine() -> dict:
    """What the figures were measured on."""
    model = platform.processor() or platform.machine()
    information = Path("/proc/cpuinfo")
    if information.exists():
        lines = information.read_text().splitlines()
        model = next((x.split(":")[1].strip() for x in lines if x.startswith("model name")), model)
    return {"processor": model, "threads": os.cpu_count(), "system": platform.system()}


def table(head: list[str], rows: list[list], title: str) -> None:
    """Print columns as wide as their widest cell."""
    text = [head, *([cell(value) for value in row] for row in rows)]
    width = [max(len(row[i]) for row in text) for i in range(len(head))]
    print(f"\n{title}")
    for row in text:
        print("  " + "  ".join(value.rjust(w) for value, w in zip(row, width, strict=True)))


def cell(value) -> str:
    """A number as a person reads it."""
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 100 else f"{value:.0f}"
    return f"{value:,}" if isinstance(value, int) else str(value)


def save(name: str, figures: dict, folder: Path) -> None:
    """Write ``name``.json into ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"machine": machine(), **figures}, indent=1)
    (folder / f"{name}.json").write_text(text + "\n", encoding="utf-8")
    print(f"\n{name}.json is in {os.path.relpath(folder)}.")
