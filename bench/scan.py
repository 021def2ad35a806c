"""Reading a scan: time a stage, memory and fidelity against the number of points, beside a peer.

    python bench/scan.py [--points 100000 1000000 5000000] [--peer 100000 1000000]
        [--quick] [--out out/bench]
    python bench/scan.py --coverage [--seeds 20]

Every line is a process of its own. The scans are those of tests/scan/generator.py: both faces of a
piece of 16 × 73 × 49 mm with beads of 5 mm, 0.933 mm deep, noise of 0.05 mm, roughness, doubled
shells, torn faces, holes and strays. Errors are against what the generator wrote down: the bead's
height and slope, the normals of the patch with all the roughness, the layers' direction.

The peer is the obvious route with the same library: the mesh cleaned, smoothed (Taubin ×10) or
rebuilt (screened Poisson, depth 8) by pymeshlab, then cut along the axis. It is given the true axis
and the true layer height, and its section is folded with a median; what is left is what smoothing
does to the bead.

With ``--coverage``, how often the 95 % intervals hold the truth: scans of 60 000 points, of beads
with rounded valleys, on a face with long waves, and with valleys that end in an edge.
"""

import argparse
import json
import resource
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
from _shared import OUT, save, table

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "scan"))

SEED = 1
POINTS = [100_000, 1_000_000, 5_000_000]
PEER = [100_000, 1_000_000]
KINDS = {
    "rounded": {},
    "long waves": {"period": 4.6, "sag": 0.9, "depth": 0.7, "roughness": 0.06, "corner": 18.0},
    "cusped": {"period": 4.6, "sag": 0.7, "depth": 0.7, "shells": 0.0},
}
STAGES = {
    "clean": ("Taking", "Cleaning", "Closing", "Handing"),
    "frame": ("Finding the piece", "Finding the faces"),
    "layers": ("Finding the layers", "Aligning"),
    "fold": ("Folding",),
    "roughness": ("Measuring",),
    "patch": ("Rebuilding", "Comparing"),
}


def memory() -> float:
    """The most that this process held, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def reading(points: int) -> dict:
    """Read a scan of so many points; seconds a stage, memory, and errors."""
    from generator import Piece, scan
    from heliform.engines.scan import ScanReading, read
    from heliform.engines.scan.load import scan_of

    vertices, faces, truth = scan(Piece(seed=SEED, points=points))
    before = memory()
    marks: list[tuple[float, str]] = []
    given = scan_of("bench.ply", vertices, faces, "mm")
    found = read(given, ScanReading(), progress=lambda _, t: marks.append((time.time(), t)))
    stages = dict.fromkeys(STAGES, 0.0)
    for (start, text), (end, _) in pairwise(marks):
        stages[next(s for s, words in STAGES.items() if text.startswith(words))] += end - start
    return {
        "points": len(vertices),
        **stages,
        "seconds": marks[-1][0] - marks[0][0],
        "memory_before": before,
        "memory": memory(),
        **errors(found, truth),
    }


def errors(found, truth) -> dict:
    """What a reading says against the truth: mm and degrees."""
    from generator import profile

    style, frame, piece = found.style, found.meta["frame"], truth.piece
    way = np.sign(np.dot(frame["up"], truth.axis))
    phase = np.arange(len(style.profile.offsets)) / len(style.profile.offsets)
    miss = style.profile.offsets * style.depth * 1e3 - profile(piece, way * phase)
    mesh = found.faces[0].patch
    arc, z, _ = truth.to_piece(mesh.vertices * 1e3)
    slant = piece.arc * (0.5 - piece.missing * (1 + 2 * z / piece.height))
    seen = (np.abs(z) < piece.height / 2 - 2) & (arc > 2 - piece.arc / 2) & (arc < slant - 2)
    normals = np.zeros_like(mesh.vertices)
    normals[mesh.faces.ravel()] = mesh.normals.reshape(-1, 3)
    cosine = np.sum(normals * (truth.normals(arc, z) @ truth.pose.T), axis=1)[seen]
    angle = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    figures = found.figures()
    return {
        "profile_mm": float(np.std(miss)),
        "normals_deg": float(np.sqrt(np.mean(angle**2))),
        "period_percent": 100 * abs(figures["layer_height"]["value"] * 1e3 / piece.period - 1),
        "tilt_deg": abs(figures["tilt"]["value"] - piece.tilt),
    }


def peer(points: int) -> dict:
    """Both obvious routes on the same scan: seconds and profile error in mm."""
    import pymeshlab
    from generator import Piece, scan
    from heliform.engines.scan.clean import clean
    from heliform.engines.scan.load import scan_of

    vertices, faces, truth = scan(Piece(seed=SEED, points=points))
    cleaned = clean(scan_of("bench.ply", vertices, faces, "mm"))
    done = {"points": len(vertices)}
    for name in ("taubin", "poisson"):
        work = pymeshlab.MeshSet()
        work.add_mesh(pymeshlab.Mesh(cleaned.points * 1e3, cleaned.faces))
        start = time.perf_counter()
        if name == "taubin":
            work.apply_coord_taubin_smoothing(stepsmoothnum=10)
        else:
            work.generate_surface_reconstruction_screened_poisson(depth=8, threads=1)
        done[f"{name}_seconds"] = time.perf_counter() - start
        mesh = work.current_mesh()
        done[f"{name}_mm"] = section_error(mesh.vertex_matrix(), mesh.face_matrix(), truth)
    return done


def section_error(vertices, faces, truth) -> float:
    """RMS in mm of the bead in a section along the axis, folded by medians, against the truth."""
    import trimesh
    from generator import profile

    mesh = trimesh.Trimesh(vertices, faces, process=False)
    across = truth.pose @ [0.0, 1.0, 0.0]
    lines = trimesh.intersections.mesh_plane(mesh, across, truth.to_file(np.zeros((1, 3)))[0])
    arc, z, out = truth.to_piece(lines.mean(axis=1))
    face = (np.abs(z) < truth.piece.height / 2 - 2) & (out > -1) & (out < 2)
    arc, z, out = arc[face], z[face], out[face]
    out = out - np.polyval(np.polyfit(z, out, 3), z)
    phase = truth.phase(arc, z) % 1.0
    bins = np.minimum((phase * 64).astype(int), 63)
    folded = np.array(
        [np.median(out[bins == b]) if (bins == b).any() else np.nan for b in range(64)]
    )
    return float(np.nanstd(folded - profile(truth.piece, (np.arange(64) + 0.5) / 64)))


def coverage(seeds: int) -> list[dict]:
    """A line a kind of piece and figure: how often its interval held the truth, and how wide."""
    from generator import Piece, scan
    from heliform.engines.scan import ScanReading, read
    from heliform.engines.scan.load import scan_of

    lines = []
    for kind, given in KINDS.items():
        misses: dict[str, list[tuple[float, float]]] = {}
        for seed in range(seeds):
            tilt = float(np.random.default_rng(seed).uniform(-4, 4))
            vertices, faces, truth = scan(Piece(seed=100 + seed, points=60_000, tilt=tilt, **given))
            found = read(scan_of("bench.ply", vertices, faces, "mm"), ScanReading()).figures()
            for name, true in truth.figures().items():
                scale = 1.0 if name == "tilt" else 1e3
                miss = found[name]["value"] * scale - true
                misses.setdefault(name, []).append((miss, found[name]["uncertainty"] * scale))
        for name, pairs in misses.items():
            miss, half = np.array(pairs).T
            held = int(np.count_nonzero(np.abs(miss) <= half))
            rms = float(np.sqrt(np.mean(miss**2)))
            row = {"kind": kind, "figure": name, "held": held, "of": seeds}
            lines.append(row | {"mean": miss.mean(), "rms": rms, "half_width": np.median(half)})
    return lines


def apart(job: str, points: int) -> dict:
    """The figures of one job in a process of its own."""
    command = [sys.executable, __file__, "--job", job, "--points", str(points)]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description="Reading scans of growing size, beside a peer")
    parser.add_argument("--points", type=int, nargs="+", default=POINTS)
    parser.add_argument("--peer", type=int, nargs="+", default=PEER)
    parser.add_argument("--quick", action="store_true", help="a tenth of the points")
    parser.add_argument("--coverage", action="store_true", help="the intervals, and nothing else")
    parser.add_argument("--seeds", type=int, default=20, help="scans of a kind for the coverage")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    parser.add_argument("--job", choices=("reading", "peer"), help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.job:
        print(json.dumps({"reading": reading, "peer": peer}[asked.job](asked.points[0])))
        return
    if asked.coverage:
        rows = coverage(asked.seeds)
        names = list(rows[0])
        table(names, [[row[n] for n in names] for row in rows], "95 % intervals (mm, degrees)")
        save("scan_coverage", {"coverage": rows}, asked.out)
        return
    share = 10 if asked.quick else 1
    rows = [apart("reading", count // share) for count in asked.points]
    names = ["points", *STAGES, "seconds", "memory_before", "memory"]
    table(names, [[row[n] for n in names] for row in rows], "Reading a scan (s, MB)")
    names = ["points", "profile_mm", "normals_deg", "period_percent", "tilt_deg"]
    table(names, [[row[n] for n in names] for row in rows], "Against the truth")
    peers = [apart("peer", count // share) for count in asked.peer]
    ours = {row["points"]: row["profile_mm"] for row in rows}
    for row in peers:
        for name in ("taubin", "poisson"):
            row[f"{name}_over_ours"] = row[f"{name}_mm"] / ours.get(row["points"], np.nan)
    names = [
        f"{n}_{what}" for n in ("taubin", "poisson") for what in ("seconds", "mm", "over_ours")
    ]
    head = ["points", *names]
    table(head, [[row[n] for n in head] for row in peers], "Peer: smooth, then cut (profile error)")
    save("scan", {"reading": rows, "peer": peers}, asked.out)


if __name__ == "__main__":
    main()
