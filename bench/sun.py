"""A year of sun and sky below a roof: Radiance's chain against ours, and how well they agree.

    python bench/sun.py [--sensors 100 2500 100000] [--cap 60] [--quick] [--out out/bench]

The roof is a diagrid as the room structure sizes it, triangle by triangle in both programs, its
sensors a grid on the floor; the year is Greensboro's typical one, with a sun for every hour in
whose middle it is up. Both programs get the same directions and energies.

Radiance, on all threads: oconv of roof and suns, then for what can be asked again rcontrib with a
modifier a sun and the sums over its matrix in numpy, or for one sum only rtrace with every sun as
bright as its year; the faster of the two is what a first run of ours is to be held against. -ab 0
and -dt 0, so that it traces nothing but shadow rays and all of them; 20° wide suns, so that it
leaves out none near the horizon. gendaymtx is not in its times. Where the first of its sensors say
that it would take longer than --cap in s, it does as many as fit and its time is in proportion.

Ours: the tree, the rays and the sums, in a process whose kernels are compiled; “again” is another
period by what is seen already. “study” is `study_radiation`'s own default: suns merged to 1° and a
sky of 577 patches, from weather to sums; beside it rtrace for the suns and rcontrib for the sky
(-ab 1, 1024 samples a sensor).
"""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from _shared import OUT, save, table

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from heliform.engines.core.runtime import mitsuba
from heliform.engines.core.scene import Body
from heliform.engines.structure.drawn import structure_mesh
from heliform.engines.structure.structure import Structure
from heliform.engines.sun.gathering import gather
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.periods import Period
from heliform.engines.sun.sensors import Sensors, on_plane
from heliform.engines.sun.visibility import visible
from heliform.engines.sun.weights import Sources, sources_of
from peers.radiance import timed
from peers.skies import typical_year
from peers.sun_scenes import (
    matte,
    patch_coefficients,
    sun_coefficients,
    sun_irradiance,
    write_scene,
    write_sky,
    write_suns,
)

SIDE = 18.0
THREADS = os.cpu_count() or 1
FEW = 25
LARGE = 10_000
MATRIX = 1 << 30
"""Bytes of rcontrib's matrix beyond which it is not asked for in one piece."""


def best(work, times: int):
    """The last result and the least time of several, in s."""
    spent = [timed(work) for _ in range(times)]
    return spent[-1][0], min(seconds for _, seconds in spent)


def some(sensors: Sensors, count: int) -> Sensors:
    """``count`` of the sensors, evenly."""
    return sensors.some(np.linspace(0, len(sensors) - 1, count).astype(int))


def capped(work, sensors: Sensors, cap: float, most: int):
    """What ``work`` gives for the sensors or for as many as fit, which, and the seconds for all."""
    few = some(sensors, min(FEW, len(sensors)))
    _, guess = timed(work, few)
    fit = min(len(sensors), most, max(len(few), int(cap / guess * len(few))))
    chosen = some(sensors, fit)
    result, seconds = timed(work, chosen)
    return result, chosen, seconds * len(sensors) / fit


def direct_run(roof: Body, sensors: Sensors, year: Sources, folder: Path, cap: float) -> dict:
    """Every hour's sun: both programs, one after the other."""
    count = len(year.suns.directions)
    directions, energy = year.directions[:count], year.direct[:count]

    def ours():
        seen = visible(Occluders([roof]), sensors, directions)
        return seen, seen.dot(energy)

    (seen, _), first = best(ours, 3 if len(sensors) < LARGE else 1)
    period = energy * np.random.default_rng(1).random(count)
    _, again = best(lambda: seen.dot(period), 5)

    _, scene = timed(write_scene, folder, [roof])
    _, bright = timed(write_suns, folder, directions, energy)
    summed, chosen, rtrace = capped(
        lambda which: sun_irradiance(folder, which, THREADS), sensors, cap, len(sensors)
    )
    mine = visible(Occluders([roof]), chosen, directions).dot(energy)
    level = float(energy @ directions[:, 2])
    lit = summed > 0.1 * level
    off = mine[lit] / summed[lit] - 1
    _, apart = timed(write_suns, folder, directions)
    most = max(FEW, MATRIX // (12 * count))
    matrix, part, rcontrib = capped(
        lambda which: sun_coefficients(folder, which, count, THREADS), sensors, cap, most
    )
    differ = (matrix > 0) != (visible(Occluders([roof]), part, directions).values() > 0)
    weights = period.astype(np.float32)
    _, product = best(lambda: matrix @ weights, 3)
    whole = {"rtrace": scene + bright + rtrace, "rcontrib": scene + apart + rcontrib}
    return {
        "sensors": len(sensors),
        "suns": count,
        "first run (s)": first,
        "Mrays/s": len(sensors) * count / first / 1e6,
        "again (ms)": 1e3 * again,
        "rcontrib (s)": whole["rcontrib"],
        "rtrace (s)": whole["rtrace"],
        "its Mrays/s": len(sensors) * count / rtrace / 1e6,
        "its again (ms)": 1e3 * product * len(sensors) / len(part),
        "× rcontrib": whole["rcontrib"] / first,
        "× rtrace": whole["rtrace"] / first,
        "done by it": f"{len(part)}, {len(chosen)}",
        "differ (ppm)": 1e6 * float(differ.mean()),
        "worst (%)": 100 * float(np.abs(off).max(initial=0.0)),
    }


def study_run(roof: Body, sensors: Sensors, true: Sources, folder: Path, cap: float) -> dict:
    """Sun and sky: our defaults, and Radiance's true suns and area-sampled patches."""
    weather = typical_year()

    def ours():
        sources = sources_of(weather, weather.site, Period(), ground_reflectance=0.0)
        return gather(Occluders([roof]), sensors, sources)

    found, first = best(ours, 2 if len(sensors) < LARGE else 1)
    count = len(true.suns.directions)
    write_scene(folder, [roof])
    write_suns(folder, true.directions[:count], true.direct[:count])
    write_sky(folder)
    sky = true.diffuse[count:] / true.patches.solid_angles

    def theirs(which):
        return sun_irradiance(folder, which, THREADS) + (
            patch_coefficients(folder, which, 2, 1024, threads=THREADS) @ sky
        )

    total, chosen, seconds = capped(theirs, sensors, cap, len(sensors))
    index = np.linspace(0, len(sensors) - 1, len(chosen)).astype(int)
    mine = (found.direct + found.diffuse)[index]
    exact = gather(Occluders([roof]), chosen, true)
    level = float((true.direct + true.diffuse) @ np.maximum(true.directions[:, 2], 0))
    lit = total > 0.1 * level
    merged, plain = (
        values[lit] / total[lit] - 1 for values in (mine, exact.direct + exact.diffuse)
    )
    return {
        "sensors": len(sensors),
        "study (s)": first,
        "Radiance (s)": seconds,
        "×": seconds / first,
        "done by it": len(chosen),
        "mean (%)": 100 * float(merged.mean()),
        "rms (%)": 100 * float(np.sqrt((merged**2).mean())),
        "worst (%)": 100 * float(np.abs(merged).max()),
        "true suns: rms (%)": 100 * float(np.sqrt((plain**2).mean())),
        "true suns: worst (%)": 100 * float(np.abs(plain).max()),
    }


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sensors", type=int, nargs="+", default=[100, 2_500, 100_000])
    parser.add_argument("--cap", type=float, default=60.0, help="s for a run of Radiance's")
    parser.add_argument("--quick", action="store_true", help="100 and 2,500 sensors, 10 s")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    sizes, cap = ([100, 2_500], 10.0) if asked.quick else (asked.sensors, asked.cap)
    mitsuba()
    roof = Body("Roof", structure_mesh(Structure()), matte(0.5))
    weather = typical_year()
    began = time.perf_counter()
    year = sources_of(weather, weather.site, Period(), accuracy=0.0, ground_reflectance=0.0)
    prepared = time.perf_counter() - began
    direct, study = [], []
    with tempfile.TemporaryDirectory() as name:
        for count in sizes:
            sensors = on_plane(np.eye(4), SIDE, SIDE, SIDE / count**0.5)
            direct.append(direct_run(roof, sensors, year, Path(name), cap))
            study.append(study_run(roof, sensors, year, Path(name), cap))
    print(f"{2 * len(roof.mesh.faces):,} triangles; weather, suns and sky took {prepared:.2g} s.")
    for rows, title in ((direct, "Every hour's sun"), (study, "Sun and sky")):
        head = list(rows[0])
        table(head, [[row[key] for key in head] for row in rows], title)
    figures = {"faces": 2 * len(roof.mesh.faces), "prepared (s)": prepared}
    save("sun", figures | {"direct": direct, "study": study}, asked.out)


if __name__ == "__main__":
    main()
