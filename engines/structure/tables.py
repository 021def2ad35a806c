"""A sized structure's lists: members, what to cut, reactions, combinations."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..core.table import save_csv

if TYPE_CHECKING:
    from .sized import Sized

MEMBERS, CUTTING, REACTIONS, COMBINATIONS = (
    *("members.csv", "cutting-list.csv"),
    *("reactions.csv", "combinations.csv"),
)
_ROUNDED = 1e-3  # m, to which lengths are cut


def save_tables(folder: Path, result: "Sized") -> list[str]:
    """Write the four lists into ``folder``; returns their names.

    Members and nodes are counted from 0. Raises FileError where they cannot be written.
    """
    _save_members(folder / MEMBERS, result)
    _save_cutting(folder / CUTTING, result)
    _save_reactions(folder / REACTIONS, result)
    _save_combinations(folder / COMBINATIONS, result)
    return [MEMBERS, CUTTING, REACTIONS, COMBINATIONS]


def _save_members(path: Path, result: "Sized") -> None:
    rows, model = result.rows, result.model
    names = np.array([combination["name"] for combination in result.meta["combinations"]])
    columns = {
        "Member": np.arange(len(rows)),
        "Start node": model.frame.members[:, 0],
        "End node": model.frame.members[:, 1],
        "Group": np.array(model.group_names)[model.groups],
        "Material": rows["material"],
        "Grade": rows["grade"],
        "Section": rows["name"],
        "Class": result.checked.section_class,
        "Length (m)": rows["length"],
        "Mass (kg)": rows["mass"],
        "Utilisation": rows["utilisation"],
        "Fails": rows["failing"].astype(np.int8),
        "Governing check": np.array(result.checked.names)[rows["check"]],
        "Combination": names[rows["combination"]],
        "Place along it (m)": rows["length"] * rows["station"] / (result.forces.shape[2] - 1),
    }
    save_csv(path, columns, {"title": "Members"})


def _save_cutting(path: Path, result: "Sized") -> None:
    """Members of one section and length, to the millimetre, are one line; the lightest first."""
    rows = result.rows
    length = np.round(rows["length"] / _ROUNDED).astype(int)
    keys = np.rec.fromarrays(
        [rows["grade"], np.round(rows["area"], 9), rows["name"], length],
        names="grade,area,name,length",
    )
    pieces, which = np.unique(keys, return_inverse=True)
    columns = {
        "Grade": pieces["grade"],
        "Section": pieces["name"],
        "Length (m)": pieces["length"] * _ROUNDED,
        "Pieces": np.bincount(which),
        "Total length (m)": np.bincount(which, rows["length"]),
        "Total mass (kg)": np.bincount(which, rows["mass"]),
    }
    save_csv(path, columns, {"title": "Cutting list"})


def _save_reactions(path: Path, result: "Sized") -> None:
    nodes = np.flatnonzero(result.model.frame.held.any(axis=1))
    names = [combination["name"] for combination in result.meta["combinations"]]
    count = len(names)
    at = result.model.frame.nodes[nodes]
    columns = {"Node": np.repeat(nodes, count), "Combination": np.array(names * len(nodes))}
    columns |= {f"{axis} (m)": np.repeat(at[:, i], count) for i, axis in enumerate("XYZ")}
    values = result.reactions[:, nodes].transpose(1, 0, 2).reshape(-1, 6)
    units = ("Fx (N)", "Fy (N)", "Fz (N)", "Mx (N·m)", "My (N·m)", "Mz (N·m)")
    save_csv(path, columns | dict(zip(units, values.T, strict=True)), {"title": "Reactions"})


def _save_combinations(path: Path, result: "Sized") -> None:
    combinations = result.meta["combinations"]
    columns = {
        "Combination": np.array([one["name"] for one in combinations]),
        "Limit state": np.array([one["limit"] for one in combinations]),
        "Kind": np.array([one["kind"] for one in combinations]),
        "Duration": np.array([one["duration"] for one in combinations]),
    }
    save_csv(path, columns, {"title": "Combinations"})
