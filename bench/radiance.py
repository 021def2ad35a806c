"""Time from mesh file to caustic map of equal error: Radiance's photon map against ours.

    python bench/radiance.py [--targets 25 12.5 6] [--size 256] [--quick] [--out out/bench]

The tube of Table 1 under the sample lamp; both programs on two threads, one after the other. The
error is the root mean square over texels above 5 % of the mean of (map − reference) ÷ reference,
everything counted: noise, blur, and the bright ring where the tube all but touches the plane. The
reference is a long run of ours, averaged over the eight symmetries that tube, lamp and plane share;
what noise it has left is known and taken off. It is checked against Radiance's own photons.

Radiance: obj2mesh, oconv, mkpmap and rtrace at every cell of a grid of photons × bandwidths; for
each target the fastest cell that reaches it counts, or the best of all where none does. Its caustic
is read from the plane alone, so rtrace casts no shadow rays, and its emission is set as finely as
it needs to be (see `peers.radiance`).

Ours: `trace` with unfiltered texel means; at twice the resolution with the smooth map that it also
makes; and at twice the resolution under one Gaussian, the best of the published widths, as simple a
kernel as Radiance's. How many photons a target needs follows from the reference; the error printed
is that of the run itself. “caustic” is mesh file, scene and photons; “whole” adds what Radiance is
not asked for or starts without: process, imports and direct light. Cold is without compiled kernels
on disk.
"""

import argparse
import hashlib
import sys
import tempfile
from pathlib import Path

import numpy as np
from _shared import OUT, cell, save, table, work
from scipy.ndimage import gaussian_filter

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from heliform.engines.core.meshes import save_mesh
from heliform.engines.light import kernel
from heliform.engines.light.ies import sample_path
from peers import radiance, tube

PHOTONS = (100_000, 300_000, 1_000_000, 2_000_000)
BANDWIDTHS = ((20,), (50,), (100,), (200,), (400,), (20, 200))
WIDTHS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 5.6)
MOST = 170
"""Steps of 5 % in photons, from 20,000 to 80 million."""
FLOOR = 0.05
REFERENCE = 60_000_000
BLOCKS = 64
Filter = str | float
"""“none”, “smooth”, or the width of a Gaussian in texels of half the size."""


def block_mean(values, count: int):
    """Means over ``count`` × ``count`` equal blocks."""
    side = len(values) // count
    return values.reshape(count, side, count, side).mean(axis=(1, 3))


def folded(values):
    """The mean over the four turns of a map and of its mirror image."""
    turned = [np.rot90(v, k) for v in (values, values.T) for k in range(4)]
    return np.mean(turned, axis=0, dtype=np.float64)


class Reference:
    """The truth to compare with: ``fine`` twice ``size`` texels a side, ``texels`` at ``size``."""

    def __init__(self, raw, landed: int, size: int) -> None:
        self.landed = landed
        self.fine = folded(raw)
        self.texels = block_mean(self.fine, size)
        self.bright = self.texels > FLOOR * self.texels.mean()
        hits = 8 * landed * self.texels / self.texels.sum()
        self.noise = float(np.mean(1 / hits[self.bright]))

    def error(self, values) -> float:
        """RMS relative error of a map at ``size``, less the reference's own noise."""
        ratio = values[self.bright] / self.texels[self.bright] - 1
        return float(np.sqrt(max(np.mean(ratio**2) - self.noise, 0.0)))

    def expected_error(self, landed: int, how: Filter) -> float:
        """The error that ``landed`` photons will have: Poisson counts, drawn and filtered."""
        unit = self.fine.sum() / landed
        found = np.random.default_rng(7).poisson(self.fine / unit) * unit
        if how == "smooth":
            found = kernel.smoothed(found, found * unit)
        elif how != "none":
            found = gaussian_filter(found, how, mode="nearest")
        ratio = block_mean(found, len(self.texels))[self.bright] / self.texels[self.bright] - 1
        return float(np.sqrt(np.mean(ratio**2)))

    def photons_for(self, target: float, how: Filter) -> int | None:
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


def reference(mesh: Path, size: int, landed: int, folder: Path) -> Reference:
    """The long run, kept in ``folder`` for the next bench of the same scene, size and count.

    Delete it when the engine's physics changes: that is not in its name.
    """
    placed = repr((tube.LIFT, tube.LAMP, tube.PLANE, tube.IOR)).encode()
    scene = hashlib.sha256(mesh.read_bytes() + placed + sample_path().read_bytes()).hexdigest()
    file = folder / f"reference_{scene[:8]}_{size}_{landed}.npy"
    if not file.exists():
        print(f"Tracing the reference, {landed / 1e6:.0f} M photons landed …", flush=True)
        settings = {"until": "landed", "landed": landed, "seed": 1, "out": str(file)}
        work(mesh, 2 * size, [settings])
    return Reference(np.load(file).astype(np.float64), landed, size)


def radiance_grid(folder: Path, photons, truth: Reference, size: int, least: float) -> list[dict]:
    """Time and error of every cell, up to the count of photons at which one has ``least`` error.

    More photons than that only take longer.
    """
    receiver = tube.scene(tube.tube(), size).receivers[0]
    radiance.describe(folder, sample_path(), tube.LAMP, receiver, tube.IOR)
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
    receiver = tube.scene(tube.tube(), size).receivers[0]
    count, photon = radiance.stored_photons(folder, receiver, BLOCKS)
    expected = block_mean(truth.texels, BLOCKS) * (tube.PLANE / BLOCKS) ** 2
    bright = expected > FLOOR * expected.mean()
    ours = expected.sum() / (8 * truth.landed)
    ratio = (count * photon)[bright] / expected[bright] - 1
    noise = np.mean((photon + ours) / expected[bright])
    return {
        "photons": int(count.sum()),
        "flux": float(count.sum() * photon / expected.sum()),
        "blocks_rms": float(np.sqrt(np.mean(ratio**2))),
        "blocks_rms_by_chance": float(np.sqrt(noise)),
    }


def ours(mesh: Path, truth: Reference, target: float, size: int, how: Filter, landed: int) -> dict:
    """One run from the mesh file, without kernels on disk and again with them."""
    with tempfile.TemporaryDirectory() as cache:
        out = Path(cache) / "map.npy"
        settings = {"until": "landed", "landed": landed, "seed": 2, "filter": how}
        settings["out"] = str(out)
        texels = size if how == "none" else 2 * size
        cold, warm = (work(mesh, texels, [settings], Path(cache)) for _ in range(2))
        error = truth.error(block_mean(np.load(out).astype(np.float64), size))
    figures = {
        "target": target,
        "filter": how if isinstance(how, str) else f"σ {how:g}",
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


def plan(truth: Reference, target: float) -> list[tuple[Filter, int]]:
    """Filters and photons for a target; of all Gaussians the one that needs fewest photons."""
    plans = [(how, truth.photons_for(target, how)) for how in ("none", "smooth")]
    gaussians = [(width, truth.photons_for(target, width)) for width in WIDTHS]
    best = min(gaussians, key=lambda p: p[1] or np.inf)
    return [(how, count) for how, count in (*plans, best) if count]


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


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description="Equal-error time against Radiance's photon map")
    parser.add_argument("--targets", type=float, nargs="+", default=[25.0, 12.5, 6.0], help="in %%")
    parser.add_argument("--size", type=int, default=256, help="texels a side")
    parser.add_argument("--quick", action="store_true", help="small grid, short reference")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    photons = PHOTONS[:3] if asked.quick else PHOTONS
    targets = [t / 100 for t in asked.targets]
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        mesh = tube.tube()
        save_mesh(folder / "tube.npz", mesh)
        radiance.write_obj(folder / "glass.obj", mesh)
        landed = REFERENCE // 6 if asked.quick else REFERENCE
        truth = reference(folder / "tube.npz", asked.size, landed, asked.out)
        print(f"The reference's own noise, taken off: {100 * truth.noise**0.5:.2f} %")
        cells = radiance_grid(folder, photons, truth, asked.size, min(targets))
        check = cross_check(folder, truth, asked.size)
        print(
            f"Radiance's {check['photons']:,} photons in {BLOCKS}² blocks differ from the reference"
            f" by {100 * check['blocks_rms']:.2f} % RMS, {100 * check['blocks_rms_by_chance']:.2f}"
            f" % of it by chance; flux {100 * check['flux']:.2f} % of ours."
        )
        runs = [
            ours(folder / "tube.npz", truth, target, asked.size, how, count)
            for target in targets
            for how, count in plan(truth, target)
            if not (asked.quick and count > 10_000_000)
        ]
    ratios = report(cells, runs, targets)
    figures = {"size": asked.size, "faces": len(mesh.faces), "reference_landed": landed}
    figures |= {"reference_noise": truth.noise**0.5, "cross_check": check}
    save("radiance", figures | {"radiance": cells, "ours": runs, "ratios": ratios}, asked.out)


if __name__ == "__main__":
    main()
