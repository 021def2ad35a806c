"""Judging candidates: a row for each wall, with the gate's verdict on it."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.parameters import from_table
from .candidates import PrintLibrary, wall_of
from .fourier import Plan
from .gate import gate_loft
from .loft import wall_loft
from .machine import Machine, chosen_machine

Rows = NDArray[np.void]

ACCEPTED, NO_ROOM = "accepted", "no_room"
_PLAN = ("period_1", "amplitude_1", "phase_1", "period_2", "amplitude_2", "phase_2", "offset")
_PLACES = 1024  # around the outline, where its bends are looked at


def row_type(checks: Sequence[str]) -> np.dtype[np.void]:
    """What a row holds: the plan, what became of it, and its share of each limit.

    ``reason`` is the first check that failed, `ACCEPTED` or `NO_ROOM`; ``resolved`` says that
    overlaps were taken out; ``bend`` in m is the smallest radius of the wall's middle; ``length``
    in m, ``time`` in s and ``mass`` in kg are the print's. A ``share`` above 1 is beyond the limit.
    """
    plan = [(name, np.int16 if "period" in name else np.float64) for name in _PLAN]
    sums = [(name, np.float32) for name in ("bend", "length", "time", "mass")]
    shares = [(share_of(name), np.float32) for name in checks]
    return np.dtype([*plan, ("reason", "U24"), ("resolved", np.bool_), *sums, *shares])


def share_of(check: str) -> str:
    """The column of a check's share of its limit."""
    return f"{check} share"


def plan_of(row: Any, radius: float) -> Plan:
    """The plan in a row."""
    return Plan(radius=radius, **{name: row[name].item() for name in _PLAN})


def table_of(plan: Plan) -> dict[str, float]:
    """What `judged` takes of a plan."""
    return {name: getattr(plan, name) for name in _PLAN}


def checks_of(record: PrintLibrary, machine: Machine) -> tuple[str, ...]:
    """The names of the gate's checks on walls of this kind, in their order.

    Raises ParameterError where not even a plain tube of these sizes can be made a path for.
    """
    loft = wall_loft(wall_of(Plan(radius=record.radius), record))
    verdict = gate_loft(loft, record.thickness, record.spiral, machine)
    return tuple(one.name for one in verdict.checks)


def judged(setting: Mapping[str, Any], plans: Sequence[Mapping[str, Any]]) -> Rows:
    """A row for each of the ``plans``, which are tables.

    ``setting`` holds the library's ``record`` as a table and the names of the ``checks``. An
    outline that leaves no room for its wall is a row like any other.
    """
    record = from_table(PrintLibrary, setting["record"], "parameters")
    machine = chosen_machine(record.machine, record.machine_file)
    rows = np.zeros(len(plans), row_type(setting["checks"]))
    for row, table in zip(rows, plans, strict=True):
        plan = Plan(radius=record.radius, **table)
        for name in _PLAN:
            row[name] = getattr(plan, name)
        _judge(row, plan, record, machine)
    return rows


def _judge(row: Any, plan: Plan, record: PrintLibrary, machine: Machine) -> None:
    try:
        loft = wall_loft(wall_of(plan, record))
    except ParameterError:
        row["reason"] = NO_ROOM
        for name in row.dtype.names:
            if row.dtype[name] == np.float32:
                row[name] = np.nan
        return
    verdict = gate_loft(loft, record.thickness, record.spiral, machine)
    failed = verdict.failed
    row["reason"] = failed[0].name if failed else ACCEPTED
    row["resolved"] = bool(loft.notes)
    turn = np.arange(_PLACES) / _PLACES
    row["bend"] = 1 / np.abs(loft.at(turn, 0.0).curvature).max()
    row["length"] = verdict.figures["length"]["value"]
    row["time"] = verdict.figures["time"]["value"]
    row["mass"] = verdict.figures["mass"]["value"]
    for one in verdict.checks:
        row[share_of(one.name)] = one.share
