"""Frame analysis against PyNite and OpenSees, and its cost against the number of members.

    python bench/frames.py [--members 600 1250 5000 20000] [--quick] [--out out/bench]

The comparison is on a grid of 20 × 20 fields, 441 nodes and 840 members, clamped at its corners,
under moments and forces on its nodes and loads along its members. PyNite's `analyze_linear` is
timed with its model built; ours with the pattern kept, as sizing has it, and with the pattern made
anew. OpenSees builds, solves and is read for one case. Displacements and member end forces of all
are compared in the same run. Run it with OMP_NUM_THREADS=1 on a quiet machine; the fastest of
several runs counts.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from _shared import OUT, save, table
from heliform.engines.structure.assembly import Pattern, pattern_of
from heliform.engines.structure.frame import FIXED, Frame, Rigidities
from heliform.engines.structure.linear import factor_of, solve_frame
from heliform.engines.structure.loads import Loads
from heliform.engines.structure.response import Response
from heliform.engines.structure.stiffness import members_of

MEMBERS = [600, 1250, 5000, 20000]
FIELDS = 20
Y_UP = np.array([(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)])


def grid(fields: int) -> tuple[Frame, Rigidities]:
    """A shallow vault of square fields of 1.5 m on four clamped corners."""
    x, y = np.meshgrid(*(1.5 * np.arange(fields + 1.0),) * 2, indexing="ij")
    rise = 0.1 * x.max() * np.sin(np.pi * x / x.max()) * np.sin(np.pi * y / y.max())
    index = np.arange((fields + 1) ** 2).reshape(fields + 1, fields + 1)
    along = np.stack([index[:-1].ravel(), index[1:].ravel()], axis=1)
    across = np.stack([index[:, :-1].ravel(), index[:, 1:].ravel()], axis=1)
    members = np.concatenate([along, across]).astype(np.int32)
    held = np.zeros((index.size, 6), dtype=bool)
    held[index[[0, 0, -1, -1], [0, -1, 0, -1]]] = FIXED
    nodes = np.stack([x.ravel(), y.ravel(), rise.ravel()], axis=1)
    frame = Frame(nodes, members, np.tile((0.0, 0.0, 1.0), (len(members), 1)), held)
    one, rigid = np.ones(len(members)), np.full(len(members), np.inf)
    values = (2e9 * one, 4e7 * one, 1e7 * one, 2e7 * one, rigid, rigid, 75.0 * one, one)
    return frame, Rigidities(*values)


def loads(frame: Frame, cases: int) -> Loads:
    """Snow, and wind from one side and another, all uneven."""
    generator = np.random.default_rng(0)
    line = np.zeros((cases, len(frame.members), 2, 3))
    line[..., 2] = -generator.uniform(1e3, 3e3, (cases, len(frame.members), 1))
    nodal = generator.standard_normal((cases, len(frame.nodes), 6)) * 500.0
    names = tuple(f"case {k}" for k in range(cases))
    return Loads(names, ("snow",) * cases, np.zeros((cases, 3)), nodal, line)


def fastest(times: int, action: Callable[[], object]) -> float:
    """Milliseconds of the fastest of some runs."""
    best = np.inf
    for _ in range(times):
        began = time.perf_counter()
        action()
        best = min(best, time.perf_counter() - began)
    return 1e3 * best


def apart(ours: np.ndarray, theirs: np.ndarray) -> float:
    """The greatest difference over the greatest number."""
    return float(np.abs(ours - theirs).max() / np.abs(ours).max())


def pynite(frame: Frame, rigidities: Rigidities, given: Loads, response: Response) -> dict:
    """What PyNite takes for it, and how far its numbers are from ours."""
    from Pynite import FEModel3D

    model = FEModel3D()
    model.add_material("one", 1.0, 1.0, 0.3, 0.0)
    for node, point in enumerate(frame.nodes @ Y_UP.T):
        model.add_node(str(node), *map(float, point))
        x, y, z, rx, ry, rz = map(bool, frame.held[node])
        model.def_support(str(node), x, z, y, rx, rz, ry)
        for case, name in enumerate(given.names):
            force = (given.nodal[case, node].reshape(2, 3) @ Y_UP.T).ravel()
            for axis, value in zip(("FX", "FY", "FZ", "MX", "MY", "MZ"), force, strict=True):
                model.add_node_load(str(node), axis, float(value), name)
    for member, (start, end) in enumerate(frame.members):
        name = str(member)
        bending = rigidities.bending_z[member], rigidities.bending_y[member]  # its y is our z
        section = rigidities.axial[member], *bending, rigidities.torsion[member]
        model.add_section(name, *map(float, section))
        model.add_member(name, str(start), str(end), "one", name)
        for case, of in enumerate(given.names):
            up = given.line[case, member, :, 2]
            model.add_member_dist_load(name, "FY", float(up[0]), float(up[1]), case=of)
    for name in given.names:
        model.add_load_combo(name, {name: 1.0})

    milliseconds = fastest(1, lambda: model.analyze_linear(check_stability=False))
    moved, ends = [], []
    for name in given.names:
        at = [[getattr(n, d)[name] for d in ("DX", "DY", "DZ")] for n in model.nodes.values()]
        moved.append(np.array(at) @ Y_UP)
        ends.append([member.f(name).ravel()[[0, 6]] for member in model.members.values()])
    return {
        "ms": milliseconds,
        "displacements apart": apart(response.displacements[..., :3], np.array(moved)),
        "axial forces apart": apart(response.end_forces[..., [0, 6]], np.array(ends)),
    }


def opensees(frame: Frame, rigidities: Rigidities, given: Loads, times: int) -> tuple[float, tuple]:
    """What OpenSees takes to build, solve and be read for one case, and what it answers."""
    import openseespy.opensees as ops

    local = np.einsum("mij,mj->mi", frame.axes(), given.line[0, :, 0])
    values = [rigidities.axial, np.ones(len(local)), np.ones(len(local)), rigidities.torsion]
    section = np.stack([*values, rigidities.bending_y, rigidities.bending_z], axis=1).tolist()
    nodes, ends = frame.nodes.tolist(), frame.members.tolist()
    normals, held = frame.normals.tolist(), frame.held.any(axis=1)
    forces, uniform = given.nodal[0].tolist(), local[:, [1, 2, 0]].tolist()

    def solve() -> tuple:
        ops.wipe()
        ops.model("basic", "-ndm", 3, "-ndf", 6)
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        for node, point in enumerate(nodes):
            ops.node(node, *point)
            ops.load(node, *forces[node])
            if held[node]:
                ops.fix(node, 1, 1, 1, 1, 1, 1)
        for member, pair in enumerate(ends):
            ops.geomTransf("Linear", member, *normals[member])
            ops.element("elasticBeamColumn", member, *pair, *section[member], member)
            ops.eleLoad("-ele", member, "-type", "-beamUniform", *uniform[member])
        ops.system("UmfPack")
        ops.numberer("RCM")
        ops.constraints("Plain")
        ops.integrator("LoadControl", 1.0)
        ops.algorithm("Linear")
        ops.analysis("Static", "-noWarnings")
        if ops.analyze(1):
            raise RuntimeError("OpenSees did not solve the grid.")
        moved = np.array([ops.nodeDisp(node) for node in range(len(nodes))])
        return moved, np.array([ops.eleResponse(m, "localForces") for m in range(len(ends))])

    milliseconds = fastest(times, solve)
    answer = solve()
    ops.wipe()
    return milliseconds, answer


def compared(times: int) -> list[dict]:
    """Ours and theirs on the same grid, with one case and with five."""
    frame, rigidities = grid(FIELDS)
    pattern = pattern_of(frame)
    rows = []
    for cases in (1, 5):
        given = loads(frame, cases)
        kept = fastest(times, lambda given=given: solve_frame(frame, rigidities, given, pattern))
        anew = fastest(times, lambda given=given: solve_frame(frame, rigidities, given))
        response = solve_frame(frame, rigidities, given, pattern)
        theirs = pynite(frame, rigidities, given, response)
        row = {"cases": cases, "ours, pattern kept": kept, "ours, anew": anew}
        row |= {f"PyNite, {name}": value for name, value in theirs.items()}
        row |= {"PyNite ÷ kept": theirs["ms"] / kept, "PyNite ÷ anew": theirs["ms"] / anew}
        if cases == 1:
            row |= against_opensees(frame, rigidities, given, response, times, kept)
        rows.append(row)
    return rows


def against_opensees(
    frame: Frame,
    rigidities: Rigidities,
    given: Loads,
    response: Response,
    times: int,
    kept: float,
) -> dict:
    """OpenSees on the same grid, if it is installed."""
    try:
        milliseconds, (moved, ends) = opensees(frame, rigidities, given, times)
    except ImportError:
        print("OpenSees is not installed (pip install openseespy): it is left out.")
        return {}
    return {
        "OpenSees, ms": milliseconds,
        "OpenSees, displacements apart": apart(response.displacements[0], moved),
        "OpenSees, end forces apart": apart(response.end_forces[0], ends),
        "OpenSees ÷ kept": milliseconds / kept,
    }


def cost(wanted: int, times: int) -> dict:
    """What a grid of about so many members costs with five cases, in ms, and its steps."""
    fields = round((np.sqrt(1.0 + 2.0 * wanted) - 1.0) / 2.0)
    frame, rigidities = grid(fields)
    given = loads(frame, 5)
    pattern: Pattern = pattern_of(frame)
    members = members_of(frame, rigidities)
    response = solve_frame(frame, rigidities, given, pattern)
    stations = np.linspace(0.0, 1.0, 5)
    return {
        "members": len(frame.members),
        "unknowns": len(pattern.free),
        "factor": "band" if pattern.band else "sparse",
        "pattern, once": fastest(max(1, times // 4), lambda: pattern_of(frame)),
        "stiffness": fastest(times, lambda: members_of(frame, rigidities)),
        "factorise": fastest(times, lambda: factor_of(pattern, members.world)),
        "whole": fastest(times, lambda: solve_frame(frame, rigidities, given, pattern)),
        "5 stations": fastest(times, lambda: response.forces(stations)),
        "imbalance": float(response.imbalance.max()),
    }


def main() -> None:
    """Run the bench and print its tables."""
    parser = argparse.ArgumentParser(description="Frame analysis against PyNite and OpenSees")
    parser.add_argument("--members", type=int, nargs="+", default=MEMBERS)
    parser.add_argument("--quick", action="store_true", help="three runs instead of twenty")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the JSON")
    asked = parser.parse_args()
    times = 3 if asked.quick else 20
    peers = compared(times)
    for row in peers:
        table(
            ["", "ms or ratio"],
            [[name, value] for name, value in row.items()],
            f"Grid of 840 members, {row['cases']} load case{'s' if row['cases'] > 1 else ''}",
        )
    rows = [cost(wanted, max(1, times * 1000 // max(wanted, 1000))) for wanted in asked.members]
    table(list(rows[0]), [list(row.values()) for row in rows], "Five load cases (ms)")
    save("frames", {"peers": peers, "cost": rows}, asked.out)


if __name__ == "__main__":
    main()
