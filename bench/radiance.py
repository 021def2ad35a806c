"""Time from mesh file to caustic map of equal error: Radiance's photon map against ours.

    python bench/radiance.py [--glass tube plate prism] [--targets 25 12.5 6 3] [--size 256]
                             [--most 10000000] [--quick] [--out out/bench]

Table 1's tube, a wavy plate and a prism under the sample lamp; both programs on two threads, one
after the other. The error is the root mean square over texels above 5 % of the mean of
(map − reference) ÷ reference, everything counted: noise, blur, and the bright ring where the tube
all but touches the plane. The reference is a long run of ours, averaged over the symmetries that
glass, lamp and plane share; what noise it has left is known and taken off. It is checked against
Radiance's own photons. Plate and prism get the lamp with a square opening (`peers.glass`).

Radiance: obj2mesh, oconv, mkpmap and rtrace at every cell of a grid of photons × bandwidths; for
each target the fastest cell that reaches it counts, or the best of all where none does. Its caustic
is read from the plane alone, so rtrace casts no shadow rays, and its emission is set as finely as
it needs to be (see `peers.radiance`).

Ours: `trace`, its unfiltered texel means and the smooth map that it also makes. How many photons a
target needs follows from the reference; the error printed is that of the run itself. “caustic” is
mesh file, scene and photons; “whole” adds what Radiance is not asked for or starts without:
process, imports and direct light. Cold is without compiled kernels on disk.
"""

import argparse
import hashlib
import sys
import tempfile
from pathlib import Path

import numpy as np
from _shared import OUT, cell, save, table, work

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from heliform.engines.core.meshes import save_mesh
from heliform.engines.light import kernel
from heliform.engines.light.ies import sample_path
from peers import radiance, tube
from peers.glass import GLASSES

PHOTONS = (100_000, 300_000, 1_000_000, 3_000_000, 10_000_000)
BANDWIDTHS = ((20,), (50,), (100,), (200,), (400,), (800,), (20, 200))
MOST = 170
"""Steps of 5 % in photons, from 20,000 to 80 million."""
RAW = 20_000_000
"""Photons above which unfiltered texels are not traced: seconds per target without news."""
FLOOR = 0.05
REFERENCE = 60_000_000
BLOCKS = 64


def block_mean(values, count: int):
    """Means over ``count`` × ``count`` equal blocks."""
    side = len(values) // count
    return values.reshape(count, side, count, side).mean(axis=(1, 3))


class Reference:
    """The truth to compare with: the mean of a long run's map and of those as likely as it."""

    def __init__(self, raw, landed: int, alike) -> None:
        self.landed = landed
        maps = alike(raw)
        self.texels = np.mean(maps, axis=0, dtype=np.float64)
        self.bright = self.texels > FLOOR * self.texels.mean()
        hits = len(maps) * landed * self.texels / self.texels.sum()
        self.noise = float(np.mean(1 / hits[self.bright]))
        self.weight = len(maps) * landed

    def error(self, values) -> float:
        """RMS relative error of a map at ``size``, less the reference's own noise."""
        ratio = values[self.bright] / self.texels[self.bright] - 1
        return float(np.sqrt(max(np.mean(ratio**2) - self.noise, 0.0)))

    def expected_error(self, landed: int, how: str) -> float:
        """The error that ``landed`` photons will have: Poisson counts, drawn and smoothed."""
        unit = self.texels.sum() / landed
        found = np.random.default_rng(7).poisson(self.texels / unit) * unit
        if how == "smooth":
            found = kernel.smoothed(found, found * unit).value
        ratio = found[self.bright] / self.texels[self.bright] - 1
        return float(np.sqrt(np.mean(ratio**2)))

    def photons_for(self, target: float, how: str) -> int | None:
        """The fewest photons, in steps of 5 %, or None where blur alone is more than ``target``."""
        steps = (20_000 * 1.05 ** np.arange(MOST)).astype(int)
        if self.expected_error(int(steps[-1]), how) > target:
            return None
        low, high = 0, len(steps) - 1
        while low < high:
            middle = (low + high) // 2
            if self.expected_error(int(steps[middle]), how) <= target:
                high = middle
            else:
                low = middle + 1
        return int(1.02 * steps[low])


def reference(mesh: Path, lamp: Path, size: int, landed: int, alike, folder: Path) -> Reference:
    """The long run, kept in ``folder`` for the next bench of the same scene, size and count.

    Delete it when the engine's physics changes: that is not in its name.
    """
    placed = repr((tube.LAMP, tube.PLANE, tube.IOR)).encode()
    scene = hashlib.sha256(mesh.read_bytes() + placed + lamp.read_bytes()).hexdigest()
    file = folder / f"reference_{scene[:8]}_{size}_{landed}.npy"
    if not file.exists():
        print(f"Tracing the reference, {landed / 1e6:.0f} M photons landed …", flush=True)
        settings = {"until": "landed", "landed": landed, "seed": 1, "out": str(file)}
        work(mesh, size, [settings], lamp=str(lamp))
    return Reference(np.load(file).astype(np.float64), landed, alike)


def radiance_grid(folder: Path, photons, truth: Reference, size: int, least: float) -> list[dict]:
    """Time and error of every cell, up to the count of photons at which one has ``least`` error.

    More photons than that only take longer.
    """
    receiver = tube.receiver(size)
    radiance.describe(folder, folder / "lamp.ies", tube.LAMP, receiver, tube.IOR)
    _, built = radiance.timed(radiance.build, folder)
    rays, cells = radiance.points(receiver, size, size), []
    for count in photons:
        _, mapped = radiance.timed(radiance.caustic_map, folder, count, 1)
        for bandwidth in BANDWIDTHS:
            found, read = radiance.timed(radiance.caustic, folder, rays, (size, size), bandwidth)
            cells.append(
                {
                    "photons": count,
                    "bandwidth": "–".join(map(str, bandwidth)),
                    "build": built,
                    "mkpmap": mapped,
                    "rtrace": read,
                    "seconds": built + mapped + read,
                    "error": truth.error(found),
                    "mean": float(found.mean() / truth.texels.mean()),
                }
            )
        best = min(cell["error"] for cell in cells)
        print(f"mkpmap {count:,}: {mapped:.1f} s, least error {100 * best:.1f} %", flush=True)
        if best <= least:
            break
    return cells


def cross_check(folder: Path, truth: Reference, size: int) -> dict:
    """The last photon map's own photons in blocks against the reference."""
    receiver = tube.receiver(size)
    count, photon = radiance.stored_photons(folder, receiver, BLOCKS)
    expected = block_mean(truth.texels, BLOCKS) * (tube.PLANE / BLOCKS) ** 2
    bright = expected > FLOOR * expected.mean()
    ours = expected.sum() / truth.weight
    ratio = (count * photon)[bright] / expected[bright] - 1
    noise = np.mean((photon + ours) / expected[bright])
    return {
        "photons": int(count.sum()),
        "flux": float(count.sum() * photon / expected.sum()),
        "blocks_rms": float(np.sqrt(np.mean(ratio**2))),
        "blocks_rms_by_chance": float(np.sqrt(noise)),
    }


def ours(mesh: Path, truth: Reference, target: float, size: int, how: str, landed: int) -> dict:
    """One run from the mesh file, without kernels on disk and again with them."""
    with tempfile.TemporaryDirectory() as cache:
        out = Path(cache) / "map.npy"
        settings = {"until": "landed", "landed": landed, "seed": 2, "filter": how}
        settings["out"] = str(out)
        lamp = str(mesh.with_name("lamp.ies"))
        cold, warm = (work(mesh, size, [settings], Path(cache), lamp) for _ in range(2))
        error = truth.error(np.load(out).astype(np.float64))
    figures = {
        "target": target,
        "filter": how,
        "landed": warm["runs"][0]["photons"]["landed"],
        "error": error,
        "start": warm["start"],
        "steps": {"mesh": warm["mesh"], **warm["runs"][0]["steps"]},
        "memory": warm["runs"][0]["memory"],
    }
    for name, run in (("cold", cold), ("warm", warm)):
        steps = run["runs"][0]["steps"]
        whole = run["start"] + run["mesh"] + sum(steps.values())
        figures[f"{name}_whole"] = whole
        figures[f"{name}_caustic"] = whole - run["start"] - steps["direct"]
    return figures


def plan(truth: Reference, target: float) -> list[tuple[str, int]]:
    """Ways and photons for a target; those that do not reach it are left out."""
    plans = [(how, truth.photons_for(target, how)) for how in ("none", "smooth")]
    return [(how, count) for how, count in plans if count and (how == "smooth" or count <= RAW)]


def fastest(cells: list[dict], target: float) -> dict | None:
    """The fastest cell of the grid that reaches ``target``."""
    good = [c for c in cells if c["error"] <= target]
    return min(good, key=lambda c: c["seconds"]) if good else None


def report(cells: list[dict], runs: list[dict], targets) -> list[dict]:
    """Print all tables; returns the ratios."""
    names = ["photons", "bandwidth", "mkpmap", "rtrace", "seconds", "error", "mean"]
    table(names, [[c[n] for n in names] for c in cells], "Radiance: every cell (s, error, mean)")
    names = ["target", "filter", "landed", "error", "start"]
    names += ["warm_caustic", "warm_whole", "cold_caustic", "cold_whole", "memory"]
    table(names, [[r[n] for n in names] for r in runs], "Ours (s, MB)")
    rows, ratios = [], []
    for target in targets:
        peer = fastest(cells, target)
        best = min(cells, key=lambda c: c["error"])
        used = peer or best
        said = f"{used['photons']:,} × {used['bandwidth']}" + ("" if peer else " (not reached)")
        for run in (r for r in runs if r["target"] == target):
            times = [run[n] for n in ("warm_caustic", "warm_whole", "cold_caustic", "cold_whole")]
            ratio = [used["seconds"] / t for t in times]
            mark = "" if peer else "> "
            rows.append([f"{100 * target:g} %", said, used["seconds"], used["error"]])
            rows[-1] += [run["filter"], run["error"], *(f"{mark}{cell(r)}×" for r in ratio)]
            ratios.append(
                {"target": target, "radiance": used, "reached": bool(peer), "ours": run}
                | {"ratios": dict(zip(names[5:9], ratio, strict=True))}
            )
    head = ["target", "Radiance", "s", "error", "ours", "error", *names[5:9]]
    table(head, rows, "Radiance's time ÷ ours")
    return ratios


def compare(name: str, asked: argparse.Namespace) -> dict:
    """Both programs on one glass."""
    photons = [n for n in PHOTONS if n <= (1_000_000 if asked.quick else asked.most)]
    targets = [t / 100 for t in asked.targets]
    make, alike, changed = GLASSES[name]
    mesh = make()
    print(f"\n{name}, {len(mesh.faces):,} faces", flush=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        file = folder / f"{name}.npz"
        save_mesh(file, mesh)
        radiance.write_obj(folder / "glass.obj", mesh)
        lamp = folder / "lamp.ies"
        lamp.write_text(changed(sample_path().read_text(encoding="utf-8")), encoding="utf-8")
        landed = REFERENCE // 6 if asked.quick else REFERENCE
        truth = reference(file, lamp, asked.size, landed, alike, asked.out)
        print(f"The reference's own noise, taken off: {100 * truth.noise**0.5:.2f} %")
        cells = radiance_grid(folder, photons, truth, asked.size, min(targets))
        check = cross_check(folder, truth, asked.size)
        print(
            f"Radiance's {check['photons']:,} photons in {BLOCKS}² blocks differ from the reference"
            f" by {100 * check['blocks_rms']:.2f} % RMS, {100 * check['blocks_rms_by_chance']:.2f}"
            f" % of it by chance; flux {100 * check['flux']:.2f} % of ours."
        )
        runs = [
            ours(file, truth, target, asked.size, how, count)
            for target in targets
            for how, count in plan(truth, target)
        ]
    ratios = report(cells, runs, targets)
    figures = {"faces": len(mesh.faces), "reference_noise": truth.noise**0.5, "cross_check": check}
    return figures | {"radiance": cells, "ours": runs, "ratios": ratios}


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description="Equal-error time against Radiance's photon map")
    parser.add_argument("--glass", nargs="+", default=list(GLASSES), choices=GLASSES)
    targets = [25.0, 12.5, 6.0, 3.0]
    parser.add_argument("--targets", type=float, nargs="+", default=targets, help="in %%")
    parser.add_argument("--size", type=int, default=256, help="texels a side")
    parser.add_argument("--most", type=int, default=PHOTONS[-1], help="photons of Radiance's")
    parser.add_argument("--quick", action="store_true", help="small grid, short reference")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    figures = {name: compare(name, asked) for name in asked.glass}
    save("radiance", {"size": asked.size, "reference_landed": REFERENCE, **figures}, asked.out)


if __name__ == "__main__":
    main()
