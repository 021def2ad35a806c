"""What sees sun and sky, and how fast: rays a second, sums again, and shade that moves.

    python bench/visibility.py [--rays 3e7] [--out out/bench]

First, grids of 100 to 100,000 sensors below a diagrid roof of 2 k to 1 M triangles, with up to
4,400 directions but no more rays in all than --rays: building, the first run and a sum for another
period apart; beside it trimesh on embreex, on as many of the same rays as it does in some seconds,
which must agree on what is seen. Then 400 sensors × 300 suns below a roof of 1,000 fins (12,000
triangles) that moves: what an update takes from new vertices to kWh/m². Times in s or ms hold for
the machine that the JSON names, with nothing else running; the best of several is shown.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from _shared import OUT, save, table
from heliform.engines.core.runtime import mitsuba
from heliform.engines.core.scene import Body, Material, Mesh
from heliform.engines.sun.occlusion import Occluders
from heliform.engines.sun.remembered import Remembered
from heliform.engines.sun.sensors import Sensors, on_plane
from heliform.engines.sun.visibility import Visibility, visible

SIDE = 20.0
FACES = (2_000, 50_000, 1_000_000)
SENSORS = (100, 2_500, 100_000)
DIRECTIONS = 4_400
PEER_RAYS = 500_000
MATTE = Material(kind="diffuse")
_SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


def roof(members: int, wave: float = 0.0) -> Body:
    """Fins of 50 × 300 mm along a grid and its diagonals, 4 m up, 12 triangles each."""
    cells = max(1, round((members / 4) ** 0.5))
    at = np.linspace(-SIDE / 2, SIDE / 2, cells + 1)
    x, y = np.meshgrid(at, at, indexing="ij")
    nodes = np.stack([x, y, 4 + 0.5 * np.sin(x / 4 + wave)], axis=-1)
    a, b, c, d = nodes[:-1, :-1], nodes[1:, :-1], nodes[:-1, 1:], nodes[1:, 1:]
    start = np.concatenate([n.reshape(-1, 3) for n in (a, b, a, a)])
    end = np.concatenate([n.reshape(-1, 3) for n in (d, c, b, c)])
    side = np.cross(end - start, [0, 0, 1.0])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(side, end - start)
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    thick = min(0.05, SIDE / cells / 10)
    corners = [
        n + i * thick / 2 * side + j * 3 * thick * up
        for n in (start, end)
        for i in (-1, 1)
        for j in (-1, 1)
    ]
    vertices = np.stack(corners, axis=1).reshape(-1, 3)
    faces = (_SIDES + 8 * np.arange(len(start))[:, None, None]).reshape(-1, 4)
    return Body("Roof", Mesh(vertices, faces.astype(np.int32)), MATTE)


def suns(count: int) -> np.ndarray:
    """Directions from 3° up, evenly."""
    z = np.sin(np.radians(3)) + (np.arange(count) + 0.5) / count * 0.9
    turn = np.pi * (3 - 5**0.5) * np.arange(count)
    level = np.sqrt(1 - z * z)
    return np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=1)


def best(work: Callable[[], object], times: int) -> float:
    """The least time of several, in s."""
    spent = []
    for _ in range(times):
        began = time.perf_counter()
        work()
        spent.append(time.perf_counter() - began)
    return min(spent)


def first_runs(rays: float) -> list[dict]:
    """Every number of sensors with every number of faces."""
    rows = []
    for faces in FACES:
        body = roof(faces // 12)
        build = best(lambda body=body: Occluders([body]), 2)
        occluders = Occluders([body])
        peer, peer_build = peer_of(body)
        for count in SENSORS:
            sensors = on_plane(np.eye(4), 16, 16, 16 / count**0.5)
            directions = suns(int(min(DIRECTIONS, max(50, rays // count))))
            weights = np.random.default_rng(1).random(len(directions))
            seen = visible(occluders, sensors, directions)
            first = best(lambda s=sensors, d=directions: visible(occluders, s, d), 2)  # noqa: B023
            row = {
                "faces": 2 * len(body.mesh.faces),
                "sensors": len(sensors),
                "directions": len(directions),
                "build (s)": build,
                "first run (s)": first,
                "Mrays/s": len(sensors) * len(directions) / first / 1e6,
                "sum again (ms)": 1e3 * best(lambda v=seen, w=weights: v.dot(w), 5),
            }
            rows.append(row | peer_row(peer, peer_build, sensors, directions, seen))
    return rows


def peer_of(body: Body) -> tuple[Callable | None, float]:
    """trimesh's intersector on embreex, and the seconds it took to build; None without them."""
    try:
        import embreex  # noqa: F401
        import trimesh
        from trimesh.ray.ray_pyembree import RayMeshIntersector
    except ImportError:
        return None, 0.0
    triangles = body.mesh.triangles()
    mesh = trimesh.Trimesh(triangles.vertices, triangles.faces, process=False)
    began = time.perf_counter()
    intersector = RayMeshIntersector(mesh, scale_to_box=False)
    intersector.intersects_any([[0, 0, 0]], [[0, 0, 1]])  # builds on the first ray
    return intersector.intersects_any, time.perf_counter() - began


def peer_row(
    any_hit: Callable | None,
    build: float,
    sensors: Sensors,
    directions: np.ndarray,
    seen: Visibility,
) -> dict:
    """embreex on some of the sensors, all directions; and the share of rays that differ."""
    if any_hit is None:
        return {}
    few = np.linspace(0, len(sensors) - 1, min(len(sensors), PEER_RAYS // len(directions)))
    few = np.unique(few.astype(int))
    origins = np.repeat(sensors.origins[few], len(directions), axis=0)
    towards = np.tile(directions, (len(few), 1))
    began = time.perf_counter()
    free = ~any_hit(origins, towards)
    spent = time.perf_counter() - began
    ours = Visibility(seen.seen[few], None, sensors.normals[few], directions).values() > 0
    return {
        "embreex build (s)": build,
        "embreex Mrays/s": len(origins) / spent / 1e6,
        "differ (ppm)": 1e6 * float((free.reshape(ours.shape) != ours).mean()),
    }


def moving() -> list[dict]:
    """A roof that moves over 400 sensors and 300 suns; alone, and among 50 k faces that stay."""
    sensors, directions = on_plane(np.eye(4), 16, 16, 0.8), suns(300)
    weights = np.random.default_rng(1).random(300)
    context = roof(50_000 // 12)
    beside = np.eye(4)
    beside[0, 3] = 25.0
    context = Body("Context", context.mesh.moved(beside), MATTE)
    rows = []
    for name, still in (("alone", []), ("beside 50 k faces", [context])):
        roofs = [roof(1000, 0.02 * step) for step in range(60)]
        occluders, remembered = Occluders([*still, roofs[0]], moving=["Roof"]), Remembered()
        remembered.visible(occluders, sensors, directions)
        parts = []
        for body in roofs[1:]:
            marks = [time.perf_counter()]
            occluders.update([*still, body])
            marks.append(time.perf_counter())
            seen = remembered.visible(occluders, sensors, directions)
            marks.append(time.perf_counter())
            seen.dot(weights)
            marks.append(time.perf_counter())
            parts.append(np.diff(marks) * 1e3)
        every = np.array(parts)
        total = every.sum(axis=1)
        row = {"roof": name, "faces": 2 * len(roofs[0].mesh.faces)}
        row |= dict(zip(("scene (ms)", "rays (ms)", "sum (ms)"), every.min(axis=0), strict=True))
        row |= {"best (ms)": float(total.min()), "median (ms)": float(np.median(total))}
        rows.append({k: float(v) if isinstance(v, np.floating) else v for k, v in row.items()})
    return rows


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rays", type=float, default=3e7, help="most rays of one first run")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    mitsuba()
    moved = moving()
    table(list(moved[0]), [list(row.values()) for row in moved], "400 sensors × 300 suns, moving")
    rows = first_runs(asked.rays)
    head = list(rows[0])
    table(head, [[row[key] for key in head] for row in rows], "Below a roof")
    save("visibility", {"moving": moved, "rows": rows}, asked.out)


if __name__ == "__main__":
    main()
