"""How time and memory grow with the mesh and with the photons.

    python bench/scaling.py [--faces 5000 50000 264000 500000 2000000]
        [--landed 10000 200000 10000000 200000000]
        [--quick] [--out out/bench]

Every line is a process of its own, on the tube of Table 1 at that many faces under the sample lamp,
256² texels. Photons a second are those of a second run, when the kernel is compiled. Memory is the
most that the process held, imports included; with the photons it must not grow. `averaged` and
`polarised` are timed in turn in one process, three times each, and the fastest counts.
"""

import argparse
from pathlib import Path

from _shared import OUT, save, table, work

SIZE = 256
WARM_UP = {"until": "landed", "landed": 50_000}
LANDED = 1_000_000
TABLE_1_FACES = 263_783
FACES = [5_000, 50_000, TABLE_1_FACES, 500_000, 2_000_000]
COUNTS = [10_000, 200_000, 10_000_000, 200_000_000]


def one(faces: int, landed: int) -> dict:
    """A fresh process: make the mesh, trace a little, trace ``landed`` photons."""
    done = work(faces, SIZE, [WARM_UP, {"until": "landed", "landed": landed, "seed": 1}])
    run = done["runs"][1]
    seconds = run["steps"]["photons"]
    return {
        "faces": done["faces"],
        "mesh_seconds": done["mesh"],
        "build_seconds": run["steps"]["build"],
        "direct_seconds": run["steps"]["direct"],
        "photon_seconds": seconds,
        "landed": run["photons"]["landed"],
        "emitted_per_second": run["photons"]["emitted"] / seconds,
        "landed_per_second": run["photons"]["landed"] / seconds,
        "memory_before": done["memory"],
        "memory": run["memory"],
    }


def fresnel(landed: int) -> dict:
    """Fastest of three for both ways to treat polarisation, in turn."""
    ways = ("averaged", "polarised")
    runs = [{**WARM_UP, "fresnel": way} for way in ways]
    runs += [
        {"until": "landed", "landed": landed, "seed": seed, "fresnel": way}
        for seed in (1, 2, 3)
        for way in ways
    ]
    done = work(TABLE_1_FACES, SIZE, runs)["runs"][len(ways) :]
    per_photon = [run["steps"]["photons"] / run["photons"]["emitted"] for run in done]
    best = {way: min(per_photon[k :: len(ways)]) for k, way in enumerate(ways)}
    return {way: 1 / value for way, value in best.items()} | {
        "polarised_over_averaged": best["polarised"] / best["averaged"]
    }


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description="Time and memory against faces and photons")
    parser.add_argument("--faces", type=int, nargs="+", default=FACES)
    parser.add_argument("--landed", type=int, nargs="+", default=COUNTS)
    parser.add_argument("--quick", action="store_true", help="a tenth of the photons")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    share = 10 if asked.quick else 1
    by_faces = [one(faces, LANDED // share) for faces in asked.faces]
    names = ["faces", "mesh_seconds", "build_seconds", "direct_seconds", "photon_seconds"]
    names += ["emitted_per_second", "landed_per_second", "memory_before", "memory"]
    table(names, [[r[n] for n in names] for r in by_faces], f"{LANDED // share:,} landed (s, MB)")
    by_landed = [one(TABLE_1_FACES, landed // share) for landed in asked.landed]
    names = ["landed", "photon_seconds", "emitted_per_second", "landed_per_second", "memory"]
    table(names, [[r[n] for n in names] for r in by_landed], f"{TABLE_1_FACES:,} faces (s, MB)")
    cost = fresnel(3 * LANDED // share)
    head = ["averaged /s", "polarised /s", "polarised ÷ averaged (time)"]
    table(head, [list(cost.values())], "Fresnel: photons emitted a second")
    save("scaling", {"by_faces": by_faces, "by_landed": by_landed, "fresnel": cost}, asked.out)


if __name__ == "__main__":
    main()
