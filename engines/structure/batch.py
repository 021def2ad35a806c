"""Many designs of one frame: the same members and supports, other sections or other nodes."""

import tempfile
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.crew import Crew
from ..core.errors import SceneError
from ..core.scene import Vector
from .assembly import Pattern, pattern_of
from .frame import Frame, Rigidities
from .linear import solve_frame
from .loads import Loads

Design = tuple[Vector, Rigidities]
"""Where the nodes are (N, 3) in m, and what the members resist with."""

STATIONS = np.array([0.0, 0.5, 1.0])
TOLERANCE = 1e-6
"""Residual force over the greatest load above which a solution is refined."""
_SHARES = 4
"""Tasks for each process, so that none waits long for the last."""
_SENTENCE = 400
"""Letters kept of a failure."""


@dataclass(frozen=True, slots=True)
class Summary:
    """What matters of one design of M members under C load cases.

    ``failure``: why it could not be solved, in a sentence; all else is NaN then. "" where it could.
    ``mass`` of the members in kg; ``deflection`` (C,) in m: the greatest displacement of a node,
    and ``node`` (C,): which; ``least`` and ``greatest`` (M, 6) in N and N·m: section forces over
    all cases at STATIONS, as `Demand.forces`; ``imbalance`` (C,): as of a Response.
    """

    failure: str
    mass: float
    deflection: Vector
    node: NDArray[np.int32]
    least: Vector
    greatest: Vector
    imbalance: Vector


def solve_batch(
    frame: Frame,
    designs: Sequence[Design],
    loads: Loads,
    pattern: Pattern | None = None,
    *,
    processes: int = 1,
) -> list[Summary]:
    """Summaries of all designs, in their order, by first-order theory.

    The ``pattern`` of the frame's matrix is worked out once at most. A design that cannot be solved
    says so in its summary. More ``processes`` share the designs and answer the same; they take
    about a second to start. Raises WorkerDied where one of them ends early.
    """
    if processes > 1 and len(designs) > 1:
        return _shared(frame, designs, loads, processes)
    pattern = pattern_of(frame) if pattern is None else pattern
    return [_summary(frame, design, loads, pattern) for design in designs]


def solve_share(folder: str, span: Sequence[int]) -> NDArray[Any]:
    """The summaries (D,) of designs ``span`` (first, last + 1) of those in ``folder``, as rows."""
    frame, loads, pattern = _unpacked(folder)
    nodes = np.load(Path(folder) / "nodes.npy", mmap_mode="r")[slice(*span)]
    rigidities = np.load(Path(folder) / "rigidities.npy", mmap_mode="r")[slice(*span)]
    found = [
        _summary(frame, (np.array(place), Rigidities(*np.array(values))), loads, pattern)
        for place, values in zip(nodes, rigidities, strict=True)
    ]
    return np.array([astuple(each) for each in found], _row(loads, len(frame.members)))


def _summary(frame: Frame, design: Design, loads: Loads, pattern: Pattern) -> Summary:
    """One design, solved and summed up."""
    nodes, rigidities = design
    frame = replace(frame, nodes=nodes)
    try:
        response = solve_frame(frame, rigidities, loads, pattern, tolerance=TOLERANCE)
    except SceneError as error:
        return _failed(str(error)[:_SENTENCE], len(loads.names), len(frame.members))
    moved = np.linalg.norm(response.displacements[..., :3], axis=-1)
    forces = response.forces(STATIONS)
    return Summary(
        "",
        float(rigidities.mass @ response.lengths),
        moved.max(axis=1),
        moved.argmax(axis=1).astype(np.int32),
        forces.min(axis=0).min(axis=1),
        forces.max(axis=0).max(axis=1),
        response.imbalance,
    )


def _failed(why: str, cases: int, members: int) -> Summary:
    """The summary of a design that cannot be solved."""
    case, member = np.full(cases, np.nan), np.full((members, 6), np.nan)
    return Summary(why, np.nan, case, np.full(cases, -1, np.int32), member, member, case)


def _row(loads: Loads, members: int) -> np.dtype:
    """A Summary as a row of a table."""
    cases = (len(loads.names),)
    kinds = {
        "failure": (f"U{_SENTENCE}", ()),
        "mass": ("f8", ()),
        "deflection": ("f8", cases),
        "node": ("i4", cases),
        "least": ("f8", (members, 6)),
        "greatest": ("f8", (members, 6)),
        "imbalance": ("f8", cases),
    }
    return np.dtype([(f.name, *kinds[f.name]) for f in fields(Summary)])


def _shared(frame: Frame, designs: Sequence[Design], loads: Loads, processes: int) -> list[Summary]:
    """The summaries, worked out by several processes that read the designs from a folder."""
    count = len(designs)
    edges = np.linspace(0, count, min(count, _SHARES * processes) + 1).astype(int).tolist()
    tasks = list(pairwise(edges))
    parts: list[NDArray[Any]] = [np.zeros(0)] * len(tasks)
    with tempfile.TemporaryDirectory(prefix="heliform-batch-") as folder:
        _pack(Path(folder), frame, designs, loads)
        function = f"{__name__}:{solve_share.__name__}"
        with Crew(function, folder, min(processes, len(tasks))) as crew:
            for news in crew.work(tasks):
                if news is not None:
                    parts[news[0]] = news[1]
    return [
        Summary(
            str(row["failure"]), float(row["mass"]), *(row[f.name] for f in fields(Summary)[2:])
        )
        for row in np.concatenate(parts)
    ]


def _pack(folder: Path, frame: Frame, designs: Sequence[Design], loads: Loads) -> None:
    """Write a frame, its loads and its designs into a folder."""
    np.save(folder / "nodes.npy", np.stack([nodes for nodes, _ in designs]))
    values = [np.stack(astuple(rigidities)) for _, rigidities in designs]
    np.save(folder / "rigidities.npy", np.stack(values))
    parts = {f"frame_{f.name}": getattr(frame, f.name) for f in fields(Frame)}
    parts |= {f"loads_{f.name}": np.asarray(getattr(loads, f.name)) for f in fields(Loads)}
    np.savez(folder / "frame.npz", **{k: v for k, v in parts.items() if v is not None})


def _unpacked(folder: str) -> tuple[Frame, Loads, Pattern]:
    """The frame and the loads in a folder, and the frame's pattern."""
    with np.load(Path(folder) / "frame.npz") as parts:
        frame = Frame(**{f.name: parts.get(f"frame_{f.name}") for f in fields(Frame)})
        values = {f.name: parts[f"loads_{f.name}"] for f in fields(Loads)}
    for name in ("names", "actions"):
        values[name] = tuple(values[name].tolist())
    return frame, Loads(**values), pattern_of(frame)
