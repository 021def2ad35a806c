"""A fresh process that traces and says what each step cost: python _worker.py '{"runs": […]}'.

The job is a JSON object: ``mesh`` a file or a number of faces, ``lamp`` an IES file or "" for the
sample, ``size`` texels a side, ``spawned``
the time of day at which it was started, ``runs`` a list of PhotonTracing settings with ``seed`` and
optionally ``filter`` ("none", or "smooth" for the smooth map) and ``out``, where the caustic map
(lx) goes.
Writes one JSON object to standard output; times in s, memory in MB.
"""

import json
import resource
import sys
import time
from pathlib import Path

BEGAN = time.time()
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

import numpy as np  # noqa: E402
from heliform.engines.core.meshes import load_mesh  # noqa: E402
from heliform.engines.core.runtime import mitsuba  # noqa: E402
from heliform.engines.light import PhotonTracing  # noqa: E402
from light.scenes import traced  # noqa: E402
from peers import tube  # noqa: E402

STEPS = {"Reading": "lamp", "Starting": "mitsuba", "Building": "build", "Direct": "direct"}


class Clock:
    """A progress that adds up the seconds of each step of `trace`; unknown steps are photons."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.step, self.since = "lamp", time.perf_counter()

    def __call__(self, fraction: float, text: str) -> None:
        now = time.perf_counter()
        self.seconds[self.step] = self.seconds.get(self.step, 0.0) + now - self.since
        self.step = next((v for k, v in STEPS.items() if text.startswith(k)), "photons")
        self.since = now


def memory() -> float:
    """Most memory held so far, in MB (Linux counts in KB, macOS in bytes)."""
    unit = 1e6 if sys.platform == "darwin" else 1e3
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def one_run(scene, settings: dict) -> dict:
    """Trace once with ``settings``."""
    seed, how = settings.pop("seed", 0), settings.pop("filter", "none")
    out = settings.pop("out", None)
    clock = Clock()
    result = traced(scene, PhotonTracing(**settings), seed=seed, progress=clock)
    clock(1.0, "")
    caustic = result.smooth - result.direct if how == "smooth" else result.caustic
    if out:
        np.save(out, caustic)
    photons, error = result.meta["photons"], result.meta["error"]
    return {"steps": clock.seconds, "photons": photons, "error": error, "memory": memory()}


def main(job: dict) -> dict:
    """The job's figures."""
    mitsuba()
    ready = time.time()
    began = time.perf_counter()
    of_faces = isinstance(job["mesh"], int)
    mesh = tube.tube(job["mesh"]) if of_faces else load_mesh(Path(job["mesh"]))
    loaded = time.perf_counter() - began
    scene = tube.scene(mesh, job["size"], lamp=job["lamp"])
    before = memory()
    return {
        "start": ready - job["spawned"],
        "mesh": loaded,
        "faces": len(mesh.faces),
        "memory": before,
        "runs": [one_run(scene, dict(settings)) for settings in job["runs"]],
    }


if __name__ == "__main__":
    print(json.dumps(main(json.loads(sys.argv[1]))))
