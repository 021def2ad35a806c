"""Printing a wall as an analysis: from its record to path, verdict and files."""

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import VERSION
from ..core.errors import FileError
from ..core.files import BROKEN, written
from ..core.parameters import nested, param, to_table
from ..core.progress import SILENT, Progress
from ..core.scene import Mesh, Scene, Vector
from .checks import Check
from .export import export_solid
from .gate import Verdict, gate
from .gcode import write_gcode, write_path
from .loft import Wall, wall_loft
from .machine import Machine, MachineName, chosen_machine
from .printed import wall_mesh
from .toolpath import Spiral, Toolpath, spiral

PATH, GATE, CODE, TABLE, SOLID = (
    *("toolpath.npz", "gate.json", "wall.gcode", "toolpath.csv"),
    "wall.3mf",
)
_MAP = "share of "
_SHORT = 0.01  # of a layer, that relief and path may be apart at the top


@dataclass(frozen=True, slots=True, kw_only=True)
class Print:
    """A wall, how it is laid down, and by which machine.

    The layer height is the wall's, that of its bead, whatever the spiral's is.
    """

    wall: Wall = nested(Wall, "The wall")  # noqa: RUF009
    spiral: Spiral = nested(Spiral, "Its path")  # noqa: RUF009
    machine: MachineName = param(  # noqa: RUF009
        "glass-printer", help="Machine profile: shipped, or a file of your own"
    )
    machine_file: str = param("", help="Machine profile of your own, a TOML file")


@dataclass(frozen=True, slots=True)
class Printed:
    """A wall's toolpath and what the print gate says of it.

    ``meta`` says parameters, seed, version, seconds and notes. ``mesh``, ``machine`` and
    ``loft_notes`` are there to be saved, and None or empty in what was loaded.
    """

    path: Toolpath
    verdict: Verdict
    meta: dict[str, Any]
    mesh: Mesh | None = field(default=None, compare=False)
    machine: Machine | None = field(default=None, compare=False)
    loft_notes: tuple[str, ...] = field(default=(), compare=False)

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the report: those of the print, and what is taken of each limit."""
        shares = {
            f"share_{one.name}": {"value": one.share, "unit": ""} for one in self.verdict.checks
        }
        passed = {"passed": {"value": float(self.verdict.passed), "unit": ""}}
        return passed | self.verdict.figures | shares

    def save(self, folder: Path) -> list[str]:
        """Write the path (NPZ and CSV), the verdict, G-code and the solid; returns their names.

        Raises FileError where they cannot be written.
        """
        arrays = {f.name: np.asarray(getattr(self.path, f.name)) for f in fields(Toolpath)}
        for one in self.verdict.checks:
            if one.utilisation is not None:
                arrays[_MAP + one.name] = one.utilisation
        with written(folder / PATH) as draft, draft.open("wb") as stream:
            np.savez_compressed(stream, allow_pickle=False, **arrays)
        text = json.dumps(self.verdict.as_table() | self.meta, indent=2, ensure_ascii=False)
        with written(folder / GATE) as draft:
            draft.write_text(text + "\n", encoding="utf-8")
        write_path(folder / TABLE, self.path)
        files = [PATH, GATE, TABLE]
        if self.machine is not None:
            purge = self.meta["parameters"]["spiral"]["purge"]
            notes = gcode_notes(self.loft_notes, self.verdict)
            write_gcode(folder / CODE, self.path, self.machine, purge, "wall", notes)
            files.append(CODE)
        if self.mesh is not None:
            export_solid(folder / SOLID, self.mesh)
            files.append(SOLID)
        return files

    @classmethod
    def load(cls, folder: Path) -> "Printed":
        """What `save` wrote, without mesh and machine. Raises FileError where it is damaged."""
        try:
            table = json.loads((folder / GATE).read_text(encoding="utf-8"))
            with np.load(folder / PATH, allow_pickle=False) as arrays:
                parts = {f.name: arrays[f.name] for f in fields(Toolpath)}
                maps = {n: arrays[n] for n in arrays.files if n.startswith(_MAP)}
            parts = {n: v if v.ndim else v.item() for n, v in parts.items()}
            checks = tuple(
                Check(**_placed(one), utilisation=maps.get(_MAP + one["name"]))
                for one in table["checks"]
            )
            verdict = Verdict(checks, table["machine"], table["inputs"], table["figures"])
            meta = {key: table[key] for key in ("parameters", "seed", "version", "seconds")}
            return cls(Toolpath(**parts), verdict, meta | {"notes": table["notes"]})
        except BROKEN as wrong:
            raise FileError(f"“{folder}” holds no printed wall; print it anew ({wrong}).") from None


def print_wall(
    scene: Scene,
    record: Print,
    *,
    seed: int = 0,
    progress: Progress = SILENT,
    curves: Sequence[Vector] = (),
) -> Printed:
    """The toolpath of a wall, and whether the machine can lay it.

    ``curves`` replace the record's plans as in `wall_loft`. Nothing of ``scene`` or ``seed`` is
    used: a path has nothing random. A wall that does not pass has its files all the same, with the
    reasons at the top of the G-code.

    Raises ParameterError and FileError as `wall_loft`, `chosen_machine`, `spiral` and `wall_mesh`
    do, Cancelled when ``progress`` is asked to stop.
    """
    started = time.perf_counter()
    progress(0.0, "Reading the machine profile")
    machine = chosen_machine(record.machine, record.machine_file)
    layers = replace(record.spiral, layer_height=record.wall.bead.height)
    record = replace(record, spiral=layers)
    progress(0.05, "Lofting the wall")
    loft = wall_loft(record.wall, curves)
    progress(0.2, "Winding the path")
    path = spiral(loft, record.wall.thickness, record.spiral, machine)
    progress(0.4, "Checking it")
    verdict = gate(loft, record.wall.thickness, path, machine, record.spiral.purge)
    progress(0.6, "Meshing the wall")
    mesh = wall_mesh(record.wall, curves)
    meta = {
        "parameters": to_table(record),
        "seed": seed,
        "version": VERSION,
        "seconds": time.perf_counter() - started,
        "notes": [*loft.notes, *notes_on(record, path, verdict)],
    }
    return Printed(path, verdict, meta, mesh, machine, tuple(loft.notes))


def gcode_notes(loft_notes: Sequence[str], verdict: Verdict) -> list[str]:
    """What stands at the top of a wall's G-code: the loft's notes, and why it does not pass."""
    return [*loft_notes, *(f"DOES NOT PASS: {one.sentence}" for one in verdict.failed)]


def notes_on(record: Print, path: Toolpath, verdict: Verdict) -> list[str]:
    """What a reader of the result should know, a sentence each."""
    notes = [one.sentence for one in verdict.failed]
    doubtful = sorted({one.source.split(":")[0] for one in verdict.checks if not one.confirmed})
    if doubtful:
        notes.append(f"Unconfirmed limits of {verdict.machine}: {', '.join(doubtful)}.")
    given, bead = path.layer_height, record.wall.bead.height
    whole = round(record.wall.height / bead) * bead
    if abs(record.wall.height - whole) > _SHORT * bead:
        notes.append(
            f"Whole layers make the path's {given * 1e3:.4g} mm high and not {bead * 1e3:.4g} mm "
            f"as the wall's relief; make the wall {whole * 1e3:.4g} mm high."
        )
    surplus = verdict.figures["surplus"]["value"] * 1e6
    laid = verdict.figures["laid"]["value"] * 1e6
    if surplus > 1e-3 * laid:
        notes.append(
            f"The melt runs on where the path begins and ends at no height: {surplus:.2g} of "
            f"{laid:.4g} cm³ are more than the bead holds."
        )
    return notes


def _placed(table: dict[str, Any]) -> dict[str, Any]:
    """What a table of a check says of its fields; the label follows from the name."""
    point = table["point"]
    known = {name: value for name, value in table.items() if name != "label"}
    return known | {"point": None if point is None else tuple(point)}
