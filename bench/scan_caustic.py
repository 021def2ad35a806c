"""From a scan to the caustic: a wall rebuilt from the scan of a sample, against the wall itself.

    python bench/scan_caustic.py [--points 300000 60000] [--faces 260000 800000 3200000]
                                 [--landed 1000000] [--quick] [--out out/bench]

The truth is written down by the independent generator of the tests (`tests/scan/generator.py`): a
bead 0.933 mm deep in layers of 5 mm, roughness of 0.02 mm, wound around a tube and around a rosette
of five lobes, 200 mm high, under the lamp of the demo. The sample of 73 × 49 mm through the wall is
cut from the tube; its scan has noise of 0.05 mm, doubled shells, holes, strays, broken faces, and
lies anyhow.

“as read” goes the way of a user: `scan.read`, its style on a smooth wall, creased normals. The
smoothed ones differ only by MeshLab's filter between cleaning and reading, and are folded all the
same. “bead as written” has the generator's own bead in the place of the one read, “other roughness”
is the true wall with another piece of the same roughness: another print by the same printer.

Distances are RMS differences of the caustic flux in blocks of the plane over the RMS of the truth,
in %; chance is what two seeds of the truth make. “beyond” is the distance less chance, by squares.
"""

import argparse
import sys
from pathlib import Path

from _shared import OUT, save, table

sys.path.pop(0)  # scan.py beside this file is not the tests' folder scan
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from heliform.engines.glass.profile import Style
from peers import rebuilt

SIDES = (2, 8, 16)
"""Texels of 3.125 mm along a block."""
HEAD = ["wall", "points", "faces", "bead off (µm)", "flux", "6 mm", "25 mm", "50 mm", "beyond 25"]


def styles(points: list[int]) -> list[tuple[str, int, Style]]:
    """What is read from the scans, as they are and smoothed, with the points of each."""
    found = []
    for count in points:
        scan, _ = rebuilt.scan_it(rebuilt.print_of(1, count))
        found.append(("as read", count, rebuilt.style_of(scan)))
        for how in rebuilt.SMOOTHINGS:
            smooth = rebuilt.smoothed(scan, how)
            found.append((how, count, rebuilt.style_of(smooth, repair=False)))
    return found


def compared(base: rebuilt.Base, read: list, faces: list[int], landed: int) -> list[list]:
    """A row a wall on one base curve."""
    _, truth = rebuilt.scan_it(rebuilt.print_of(1, 3000))
    _, another = rebuilt.scan_it(rebuilt.print_of(2, 3000))
    against = rebuilt.Comparison(rebuilt.true_wall(base, truth), landed)
    rows = [["chance", "", "", "", 1.0, *(100 * against.chance(s) for s in SIDES), ""]]

    def told(name: str, points, mesh, style: Style | None) -> None:
        found = rebuilt.caustic(mesh, landed, seed=13)
        off = "" if style is None else 1e3 * rebuilt.profile_error(style)
        away = [100 * against.away(found, side) for side in SIDES]
        beyond = 100 * against.beyond(found, SIDES[1])
        rows.append(
            [name, points, len(mesh.faces), off, f"{against.flux(found):.4f}", *away, beyond]
        )

    told("other roughness", "", rebuilt.true_wall(base, another), None)
    _, count, best = read[0]
    for few in faces[:-1]:
        told("as read", count, rebuilt.rebuilt_wall(base, best, few), best)
    for name, count, style in read:
        told(name, count, rebuilt.rebuilt_wall(base, style, faces[-1]), style)
    written = rebuilt.true_style(best)
    told("bead as written", "", rebuilt.rebuilt_wall(base, written, faces[-1]), written)
    told("no relief", "", rebuilt.rebuilt_wall(base, None, faces[-1]), None)
    return rows


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description="From a scan to the caustic")
    parser.add_argument("--points", type=int, nargs="+", default=[300_000, 60_000])
    parser.add_argument("--faces", type=int, nargs="+", default=[260_000, 800_000, 3_200_000])
    parser.add_argument("--landed", type=int, default=1_000_000)
    parser.add_argument("--quick", action="store_true", help="rosette alone, fewer faces, photons")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    bases = [rebuilt.ROSETTE, rebuilt.TUBE]
    if asked.quick:
        bases, asked.points, asked.faces, asked.landed = bases[:1], [60_000], [800_000], 200_000
    read = styles(asked.points)
    figures = {}
    for base in bases:
        rows = compared(base, read, asked.faces, asked.landed)
        table(HEAD, rows, f"Caustic of the {base.name}: distance from the truth in %, by blocks")
        figures[base.name] = [dict(zip(HEAD, row, strict=True)) for row in rows]
    save("scan_caustic", {"landed": asked.landed, "walls": figures}, asked.out)


if __name__ == "__main__":
    main()
