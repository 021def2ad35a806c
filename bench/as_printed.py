"""A finished piece against its design: time a stage, memory and errors, beside a peer.

    python bench/as_printed.py [--points 100000 1000000 5000000] [--peer 100000 1000000]
        [--quick] [--out out/bench]

Every line is a process of its own. Pieces and scans are those of tests/scan/printed_piece.py: a
wall of 40 layers on a plan without symmetry, 460,000 triangles; both sides scanned from anywhere,
30 % missing, 5 % strays, noise of 0.05 mm. Layers are 5.1 mm instead of 5, the wall 8.4 mm instead
of 8. The pose is timed and judged on a piece as it was meant.

The peers are in the same process. An ICP needs a start near by: all begin 2° and 3 mm off, on the
same points. pymeshlab's is given the true normals, which a cloud of points does not have and
without which it ends farther off than it began; trimesh's goes to half a million points on the
design. Beside them, pymeshlab's signed distance of all points from the design.
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

POINTS = [100_000, 1_000_000, 5_000_000]
PEER = [100_000, 1_000_000]
STAGES = {
    "design": ("Measuring the design",),
    "register": ("Looking", "Start", "Finalist", "Counting", "Settling", "Estimating"),
    "distance": ("Deviation",),
    "spread": ("Spreading",),
    "layers": ("Measuring the layers",),
}
MEANT = {"layers": 40}


def memory() -> float:
    """The most that this process held, in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def whole(points: int) -> dict:
    """Compare a scan of so many points: seconds a stage, memory, and errors in mm."""
    from heliform.engines.core.scene import Body, Material, Mesh
    from heliform.engines.scan.as_printed import Comparison, compared
    from heliform.engines.scan.load import scan_of
    from printed_piece import Piece, Scanner, apart

    body = Body("Wall", Mesh(*Piece(**MEANT).mesh()), Material())
    marks: list[tuple[float, str]] = []
    done: dict = {"points": points, "memory_before": memory()}
    for piece in (Piece(**MEANT), Piece(**MEANT, layer=5.1e-3, wall=8.4e-3)):
        scanner = Scanner(points=points, inside=True)
        given = scan_of("bench.ply", scanner.scan(piece), np.zeros((0, 3)), "m")
        marks.clear()
        found = compared(
            given, body, Comparison(), progress=lambda _, t: marks.append((time.time(), t))
        )
        if piece.wall == Piece().wall:
            shift, turn = apart(found.matrix, scanner.pose())
            done |= {"shift_mm": 1e3 * shift, "turn_deg": float(np.degrees(turn))}
    stages = dict.fromkeys(STAGES, 0.0)
    for (start, text), (end, _) in pairwise(marks):
        stages[next(s for s, words in STAGES.items() if text.startswith(words))] += end - start
    figures = found.figures()
    return done | {
        **stages,
        "seconds": marks[-1][0] - marks[0][0],
        "memory": memory(),
        "layer_mm": 1e3 * abs(figures["layer_height"]["value"] - 5.1e-3),
        "wall_mm": 1e3 * abs(figures["wall_width"]["value"] - 8.4e-3),
    }


def peer(points: int) -> dict:
    """Both ways to the same pose and the same distances: seconds, errors, and how they agree."""
    import pymeshlab
    import trimesh
    from heliform.engines.core.scene import Mesh
    from heliform.engines.scan.closest import closest, target_of
    from heliform.engines.scan.register import register
    from heliform.engines.scan.settle import Sample
    from printed_piece import Piece, Scanner
    from scipy.spatial.transform import Rotation

    piece = Piece(**MEANT)
    vertices, faces = piece.mesh()
    mesh = Mesh(vertices, faces).triangles()
    off = np.eye(4)
    off[:3, :3] = Rotation.from_rotvec(np.radians([1.2, 1.2, 1.0])).as_matrix()
    off[:3, 3] = [2e-3, 1.5e-3, 1.5e-3]
    scan = Scanner(points=points, inside=True, turned=False).scan(piece)
    placed = scan @ off[:3, :3].T + off[:3, 3]
    done: dict = {"points": points}

    def measured(name: str, matrix) -> None:
        rest = placed @ matrix[:3, :3].T + matrix[:3, 3] - scan
        done[f"{name}_mm"] = 1e3 * float(np.sqrt((rest**2).sum(axis=1).mean()))

    start = time.perf_counter()
    target = target_of(mesh)
    found = register(Sample(placed), target, start=np.eye(4))
    done["ours_icp"] = time.perf_counter() - start
    measured("ours", found.matrix)

    normals = target.normals[closest(scan, target).face] @ off[:3, :3].T
    start = time.perf_counter()
    work = pymeshlab.MeshSet()
    work.add_mesh(pymeshlab.Mesh(1e3 * mesh.vertices, mesh.faces))
    work.add_mesh(pymeshlab.Mesh(1e3 * placed, v_normals_matrix=normals))
    settings = {"samplenum": 20_000, "samplemode": False, "trgdistabs": 1e-3, "mindistabs": 6.0}
    work.compute_matrix_by_icp_between_meshes(referencemesh=0, sourcemesh=1, **settings)
    done["pymeshlab_icp"] = time.perf_counter() - start
    matrix = np.array(work.mesh(1).transform_matrix())
    matrix[:3, 3] /= 1e3
    measured("pymeshlab", matrix)

    start = time.perf_counter()
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    goal, _ = trimesh.sample.sample_surface(surface, 500_000, seed=0)[:2]
    some = np.random.default_rng(0).permutation(points)[:20_000]
    settings = {"max_iterations": 50, "scale": False, "reflection": False}
    measured("trimesh", trimesh.registration.icp(placed[some], goal, **settings)[0])
    done["trimesh_icp"] = time.perf_counter() - start

    start = time.perf_counter()
    ours = closest(scan, target, 5e-3).distance
    done["ours_distance"] = time.perf_counter() - start
    start = time.perf_counter()
    work = pymeshlab.MeshSet()
    work.add_mesh(pymeshlab.Mesh(1e3 * mesh.vertices, mesh.faces))
    work.add_mesh(pymeshlab.Mesh(1e3 * scan))
    limit = pymeshlab.PureValue(5.0)
    settings = {"measuremesh": 1, "refmesh": 0, "signeddist": True, "maxdist": limit}
    work.compute_scalar_by_distance_from_another_mesh_per_vertex(**settings)
    done["peer_distance"] = time.perf_counter() - start
    theirs = work.mesh(1).vertex_scalar_array() / 1e3
    near = (np.abs(ours) < 2e-3) & (np.abs(theirs) < 2e-3)
    done["agree_um"] = float(1e6 * np.quantile(np.abs(ours - theirs)[near], 0.99))
    done["icp_ratio"] = done["pymeshlab_icp"] / done["ours_icp"]
    done["distance_ratio"] = done["peer_distance"] / done["ours_distance"]
    return done


def job(name: str, points: int) -> dict:
    """The figures of one job in a process of its own."""
    command = [sys.executable, __file__, "--job", name, "--points", str(points)]
    done = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description="Scans against their design, beside a peer")
    parser.add_argument("--points", type=int, nargs="+", default=POINTS)
    parser.add_argument("--peer", type=int, nargs="+", default=PEER)
    parser.add_argument("--quick", action="store_true", help="a tenth of the points")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    parser.add_argument("--job", choices=("whole", "peer"), help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.job:
        print(json.dumps({"whole": whole, "peer": peer}[asked.job](asked.points[0])))
        return
    share = 10 if asked.quick else 1
    rows = [job("whole", count // share) for count in asked.points]
    names = ["points", *STAGES, "seconds", "memory_before", "memory"]
    table(names, [[row[n] for n in names] for row in rows], "Scan against design (s, MB)")
    names = ["points", "shift_mm", "turn_deg", "layer_mm", "wall_mm"]
    table(names, [[row[n] for n in names] for row in rows], "Errors")
    peers = [job("peer", count // share) for count in asked.peer]
    names = ["points", "ours_icp", "pymeshlab_icp", "trimesh_icp", "icp_ratio"]
    names += ["ours_mm", "pymeshlab_mm", "trimesh_mm"]
    table(names, [[row[n] for n in names] for row in peers], "ICP from near by (s; RMS it is off)")
    names = ["points", "ours_distance", "peer_distance", "distance_ratio", "agree_um"]
    table(names, [[row[n] for n in names] for row in peers], "pymeshlab's signed distance (s)")
    save("as_printed", {"whole": rows, "peer": peers}, asked.out)


if __name__ == "__main__":
    main()
