"""The print library: every candidate of a grid of plans, accepted or rejected with its reason."""

import contextlib
import hashlib
import json
import os
import time
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .. import VERSION
from ..core.crew import Crew
from ..core.errors import FileError
from ..core.parameters import from_table, to_table
from ..core.progress import SILENT, Progress
from ..core.scene import Scene
from ..core.table import load_csv, save_csv
from .candidates import WHERE, PrintLibrary, asked_plans, drawn, folded
from .judging import ACCEPTED, Rows, checks_of, judged, row_type, table_of
from .machine import Machine, chosen_machine
from .store import Store, clear_old, store_path

FILE = "library.csv"
_CHUNK = 32  # candidates handed out at a time: some tenths of a second
_UNITS = {"offset": "m", "bend": "m", "length": "m", "time": "s", "mass": "kg"}
_UNITS |= {"phase_1": "deg", "phase_2": "deg"}
_JUDGED = f"{judged.__module__}:{judged.__name__}"


@dataclass(frozen=True, slots=True)
class Library:
    """A row for each candidate, see `judging.row_type`; ``meta`` says what they were made from.

    ``meta``: parameters, seed, version, machine, asked (plans of the grid), unique (shapes among
    them), judged (in this run), seconds, processes and notes.
    """

    rows: Rows
    meta: dict[str, Any]

    @property
    def accepted(self) -> Rows:
        """The rows of the walls that the machine can print."""
        return self.rows[self.rows["reason"] == ACCEPTED]

    def reasons(self) -> dict[str, int]:
        """How many were rejected for each reason, the commonest first."""
        names, counts = np.unique(self.rows["reason"], return_counts=True)
        order = np.argsort(-counts, kind="stable")
        found = {str(names[i]): int(counts[i]) for i in order}
        found.pop(ACCEPTED, None)
        return found

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the report: name → value and unit."""
        meta, accepted = self.meta, len(self.accepted)
        rate = meta["judged"] / max(meta["seconds"], 1e-9)
        numbers = {
            "asked": (meta["asked"], ""),
            "unique": (meta["unique"], ""),
            "candidates": (len(self.rows), ""),
            "accepted": (accepted, ""),
            "rejected": (len(self.rows) - accepted, ""),
            **{f"rejected_{name}": (count, "") for name, count in self.reasons().items()},
            "overlaps_resolved": (int(self.rows["resolved"].sum()), ""),
            "judged_now": (meta["judged"], ""),
            "judging": (meta["seconds"], "s"),
            "processes": (meta["processes"], ""),
            "rate": (rate, "1/s"),
            "rate_per_process": (rate / meta["processes"], "1/s"),
        }
        return {name: {"value": value, "unit": unit} for name, (value, unit) in numbers.items()}

    def save(self, folder: Path) -> list[str]:
        """Write library.csv into ``folder``; returns the file's name.

        Raises FileError where it cannot be written.
        """
        columns = {}
        for name in self.rows.dtype.names or ():
            values = self.rows[name]
            if values.dtype == np.bool_:
                values = values.astype(np.int8)
            columns[f"{name} ({_UNITS[name]})" if name in _UNITS else name] = values
        save_csv(folder / FILE, columns, self.meta)
        return [FILE]

    @classmethod
    def load(cls, folder: Path) -> "Library":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        columns, meta = load_csv(folder / FILE)
        columns = {name.partition(" (")[0]: values for name, values in columns.items()}
        kind = row_type([name.removesuffix(" share") for name in columns if " share" in name])
        if tuple(columns) != kind.names:
            raise FileError(f"“{folder / FILE}” is not a print library; make it anew.")
        rows = np.zeros(len(columns["reason"]), kind)
        for name, values in columns.items():
            rows[name] = values
        return cls(rows, meta)


def print_library(
    scene: Scene, record: PrintLibrary, *, seed: int = 0, progress: Progress = SILENT
) -> Library:
    """Judge every wall of a grid of plans by the print gate.

    Plans of one shape are judged once. Nothing of ``scene`` is used; ``seed`` draws where
    ``limit`` asks for a part. The rows are the same for any number of processes. They are kept in
    the record's store as they come, so that a run that was stopped goes on where it was. A store in
    the cache folder stays a week, one that the record names for good.

    Raises ParameterError and FileError for a record, a machine profile or a store that cannot be,
    Cancelled when ``progress`` is asked to stop.
    """
    record = from_table(PrintLibrary, to_table(record), WHERE)
    progress(0.0, "Reading the machine profile")
    machine = chosen_machine(record.machine, record.machine_file)
    checks = checks_of(record, machine)
    progress(0.0, "Laying out the grid")
    asked = asked_plans(record)
    progress(0.0, "Folding symmetries")
    unique = folded(asked)
    plans = drawn(unique, record.limit, seed)
    inputs = _inputs(record, seed, machine.digest)
    path = store_path(record.store_file, f"library-{inputs}")
    if not record.store_file and not path.exists():
        clear_old(path.parent)
    store = Store(path, inputs, len(plans), row_type(checks))
    left = store.left
    processes = min(record.processes or os.cpu_count() or 1, max(1, -(-len(left) // _CHUNK)))
    started = time.perf_counter()
    setting = {"record": to_table(record), "checks": checks}
    chunks = [left[i : i + _CHUNK] for i in range(0, len(left), _CHUNK)]
    tasks = [[table_of(plans[i]) for i in chunk] for chunk in chunks]
    try:
        with contextlib.closing(_worked(setting, tasks, processes)) as work:
            for news in work:
                if news is not None:
                    store.put(chunks[news[0]], news[1])
                _report(progress, store, len(left), time.perf_counter() - started)
    finally:
        store.keep()
    meta: dict[str, Any] = {
        "parameters": to_table(record),
        "seed": seed,
        "version": VERSION,
        "machine": machine.name,
        "asked": len(asked),
        "unique": len(unique),
        "judged": len(left),
        "seconds": time.perf_counter() - started,
        "processes": processes,
    }
    meta["notes"] = _notes(meta, record, machine, store.rows)
    return Library(store.rows, meta)


def _worked(
    setting: dict[str, Any], tasks: list[Any], processes: int
) -> Generator[tuple[int, Rows] | None]:
    """Index and rows of each task as they come, and None now and then."""
    if processes == 1:
        for index, task in enumerate(tasks):
            yield index, judged(setting, task)
        return
    with Crew(_JUDGED, setting, processes) as crew:
        yield from crew.work(tasks)


def _report(progress: Progress, store: Store, left: int, seconds: float) -> None:
    done, count = int(store.done.sum()), len(store.done)
    accepted = int((store.rows["reason"] == ACCEPTED).sum())
    rate = (done - count + left) / max(seconds, 1e-9)
    text = f"{done:,} of {count:,} walls, {accepted:,} accepted, {rate:.0f} a second"
    progress(done / max(count, 1), text)


def _inputs(record: PrintLibrary, seed: int, machine: str) -> str:
    """Sixteen hex digits that name what the rows are made from; not how they are shared out."""
    table = to_table(record) | {"processes": 0, "store_file": "", "machine": machine}
    text = json.dumps([VERSION, seed if record.limit else 0, table], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _notes(meta: dict[str, Any], record: PrintLibrary, machine: Machine, rows: Rows) -> list[str]:
    """What a reader of the library should know, a sentence each."""
    count, accepted = len(rows), int((rows["reason"] == ACCEPTED).sum())
    doubtful = sum(not figure.confirmed for figure in machine.limits)
    notes = [f"{accepted:,} of {count:,} walls can be printed, by the machine's own limits."]
    if doubtful:
        notes.append(
            f"{doubtful} of {len(machine.limits)} limits of {machine.name} are unconfirmed."
        )
    if meta["unique"] < meta["asked"]:
        notes.append(f"{meta['asked']:,} plans of the grid are {meta['unique']:,} shapes.")
    if count < meta["unique"]:
        notes.append(
            f"The {count:,} walls are a part of all {meta['unique']:,}, drawn by the seed "
            f"{meta['seed']}."
        )
    if resolved := int(rows["resolved"].sum()):
        how = "clipped" if record.overlap == "clip" else "replaced by their convex hull"
        notes.append(
            f"{resolved:,} outlines would run into themselves as asked (overlaps_resolved); they "
            f"were {how}, and that was judged."
        )
    if meta["judged"] < count:
        notes.append(f"{count - meta['judged']:,} walls were judged by an earlier run.")
    return notes
