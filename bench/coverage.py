"""Is the interval honest? How often it holds the truth, over many seeds after an automatic stop.

    python bench/coverage.py [--seeds 200] [--size 64] [--error 0.3] [--out out/bench]

A small printed tube under a disk lamp, traced until the asked error. The truth is the mean of
independent runs that together hold some fifty times the photons of one; what chance is left in it
widens the deviations by 1 %, which takes 0.2 points off the coverage of an exact interval.

Texels that expect 25 hits or more should lie within both bounds in 95 % of cases; 93 to 97 % will
do. Texels that expect fewer should be below the upper bound in at least 95 %: the exact Poisson
bounds that they get hold more than they promise.

The smooth map's noise and bias together should hold the truth in 90 % of the texels above 5 % of
the mean.
"""

import argparse
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from heliform.engines.core.scene import Lamp, Luminaire, Scene
from heliform.engines.glass import GlassObject, glass_object
from heliform.engines.light import PhotonTracing
from light import scenes

MANY = 25
FLOOR = 0.05
CLASSES = (0, 1, 3, 10, 25, 50, 100, np.inf)
REFERENCES = 50
"""Runs that make the truth, each with the photons of one that is judged; none shares its seed."""


def small_tube(size: int) -> Scene:
    """A tube of 60 mm and 3000 faces, 1 mm above a plane of 160 mm."""
    shift = np.eye(4)
    shift[2, 3] = 1e-3
    mesh = glass_object(GlassObject(width=0.06, depth=0.06, height=0.03, faces=3000))
    lamp = Lamp(source="disk", flux=500.0, opening="round", width=0.05)
    return scenes.scene(
        scenes.glass(mesh.moved(shift)),
        lamp=Luminaire("Lamp", lamp, scenes.at(z=0.1)),
        receiver=scenes.floor(0.16, size),
    )


def measure(seeds: int, size: int, error: float, references: int = REFERENCES) -> dict:
    """Coverage by expected hits: a row a class, and over ``many`` and ``few`` hits."""
    scene = small_tube(size)
    settings = PhotonTracing(until="error", error=error)
    landed = scenes.traced(scene, settings, seed=0).meta["photons"]["landed"]
    longer = PhotonTracing(until="landed", landed=landed)
    truth, caustic = np.zeros((size, size)), np.zeros((size, size))
    for k in range(references):
        found = scenes.traced(scene, longer, seed=10_000 + k)
        truth += found.illuminance / references
        caustic += found.caustic / references
    hits, below, above, smooth, noise = [], [], [], [], []
    for seed in range(1, seeds + 1):
        found = scenes.traced(scene, settings, seed=seed)
        hits.append(caustic / caustic.sum() * found.meta["photons"]["landed"])
        below.append(truth < found.lower)
        above.append(truth > found.upper)
        off = np.abs(found.smooth - truth)
        noise.append(off <= found.smooth_half_width)
        smooth.append(off <= found.smooth_half_width + found.smooth_bias)
    hits, below, above = np.array(hits), np.array(below), np.array(above)
    bright = caustic > FLOOR * caustic.mean()

    def of(chosen) -> dict:
        return {
            "cases": int(chosen.sum()),
            "within": float(1 - (below | above)[chosen].mean()),
            "below_upper": float(1 - above[chosen].mean()),
        }

    bounds = pairwise(CLASSES)
    return {
        "seeds": seeds,
        "landed": landed,
        "classes": [
            {"hits": f"{low:g}–{high:g}", **of(chosen)}
            for low, high in bounds
            if (chosen := (hits >= low) & (hits < high)).any()
        ],
        "many": of(hits >= MANY),
        "few": of(hits < MANY),
        "smooth": float(np.array(smooth)[:, bright].mean()),
        "smooth_noise_alone": float(np.array(noise)[:, bright].mean()),
    }


def main() -> None:
    """Run the bench and print its table."""
    from _shared import OUT, save, table

    parser = argparse.ArgumentParser(description="Coverage of the 95 % interval")
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--size", type=int, default=64, help="texels a side")
    parser.add_argument("--error", type=float, default=0.3, help="at which the runs stop")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    figures = measure(asked.seeds, asked.size, asked.error)
    rows = [*figures["classes"], {"hits": f"≥ {MANY}", **figures["many"]}]
    rows.append({"hits": f"< {MANY}", **figures["few"]})
    percent = [[r["hits"], r["cases"], 100 * r["within"], 100 * r["below_upper"]] for r in rows]
    head = ["expected hits", "cases", "within %", "below upper %"]
    table(head, percent, f"Coverage over {asked.seeds} seeds, {figures['landed']:,} photons each")
    print(
        f"Smooth map: noise and bias hold {100 * figures['smooth']:.1f} %, noise alone "
        f"{100 * figures['smooth_noise_alone']:.1f} %"
    )
    save("coverage", figures, asked.out)


if __name__ == "__main__":
    main()
