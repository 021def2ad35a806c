"""How much material a wider choice of sections saves: the thesis's Figure 29."""

import json
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import VERSION
from ..core.colour import Display
from ..core.errors import FileError, ParameterError
from ..core.files import BROKEN, written
from ..core.parameters import nested, param, to_table
from ..core.picture import section_png
from ..core.progress import SILENT, Progress, part
from ..core.scene import Scene
from ..core.table import save_csv
from .section_range import SectionRange
from .sized import Sized
from .structure import Structure, design

DATA, TABLE, CHART = "ranges.json", "ranges.csv", "ranges.png"
_COLUMNS = {
    "reach": "Range of heights below the single section's",
    "lowest_steel": "Lowest steel section (m)",
    "lowest_timber": "Lowest timber section (m)",
    "mass": "Mass (kg)",
    "share": "Share of the single section's mass",
    "energy": "Embodied energy (GJ)",
    "sections": "Different sections",
    "utilisation": "Mean utilisation",
    "failing": "Members that fail",
    "displacement": "Greatest displacement (m)",
    "rounds": "Rounds",
    "converged": "Converged",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Ranges:
    """One structure sized again and again, each member from a wider range of sections."""

    structure: Structure = nested(Structure, "The structure; its families are the thesis's ranges")  # noqa: RUF009
    steps: int = param(8, "", 1, 100, "Ranges from the narrowest to the whole one")


@dataclass(frozen=True, slots=True)
class RangeSweep:
    """What each range led to.

    ``rows``: for each, the first with one section for all, the columns of the table. ``meta``:
    parameters, figures, seed, version, seconds, notes.
    """

    rows: list[dict[str, float]]
    meta: dict[str, Any]

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the report: name → value and unit."""
        return self.meta["figures"]

    def save(self, folder: Path) -> list[str]:
        """Write the sweep as JSON and its table as CSV; returns their names.

        Raises FileError where they cannot be written.
        """
        text = json.dumps({"rows": self.rows, "meta": self.meta}, indent=1, ensure_ascii=False)
        with written(folder / DATA) as draft:
            draft.write_text(text + "\n", encoding="utf-8")
        columns = {_COLUMNS[name]: np.array([row[name] for row in self.rows]) for name in _COLUMNS}
        save_csv(folder / TABLE, columns, {"title": "Section ranges"})
        return [DATA, TABLE]

    @classmethod
    def load(cls, folder: Path) -> "RangeSweep":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        try:
            held = json.loads((folder / DATA).read_text(encoding="utf-8"))
            return cls(held["rows"], held["meta"])
        except BROKEN as failed:
            raise FileError(
                f"“{folder}” holds no sweep of section ranges; make it again."
            ) from failed


def sweep_ranges(
    scene: Scene, record: Ranges, *, seed: int = 0, progress: Progress = SILENT
) -> RangeSweep:
    """Size a structure with one section for all, then each member from wider and wider ranges.

    The single section of each material is the first that suffices for all its members. The ranges
    go from its height, and the greatest of the record, down to the least in even steps; the last is
    the whole range of the record. Each is sized from a cold start. Nothing of ``seed`` is used.

    Raises ParameterError where the families are not the thesis's ranges, and as `design`.
    """
    began = time.perf_counter()
    structure, rules = record.structure, record.structure.rules
    if rules.steel != "thesis" or rules.timber != "thesis":
        raise ParameterError(
            "Section ranges are widened in the thesis's families; set the rules' steel and timber "
            "to “thesis”."
        )
    count = record.steps + 2
    single = design(
        replace(structure, rules=replace(rules, per="all")),
        scene,
        progress=part(progress, 0.0, 1 / count, "One section for all: "),
    )
    heights = {
        kind: single.rows["height"][single.rows["material"] == kind].max(initial=0.0)
        for kind in ("steel", "timber")
    }
    rows = [_row(single, single, 0.0, heights["steel"], heights["timber"])]
    for step in range(record.steps + 1):
        reach = step / record.steps
        steel = _lowered(rules.steel_range, heights["steel"], reach)
        timber = _lowered(rules.timber_range, heights["timber"], reach)
        chosen = replace(rules, per="member", steel_range=steel, timber_range=timber)
        share = part(progress, (step + 1) / count, (step + 2) / count, f"Range {step + 1}: ")
        sized = design(replace(structure, rules=chosen), scene, progress=share)
        rows.append(_row(sized, single, reach, steel.height_low, timber.height_low))
    notes = [
        f"Range {number}: {row['failing']:.0f} members fail."
        for number, row in enumerate(rows)
        if row["failing"]
    ]
    notes += [
        f"Range {number}: not converged." for number, row in enumerate(rows) if not row["converged"]
    ]
    widest = rows[-1]
    numbers = {
        "mass_single": (rows[0]["mass"], "kg"),
        "mass_widest": (widest["mass"], "kg"),
        "share": (widest["share"], ""),
        "energy_single": (rows[0]["energy"], "GJ"),
        "energy_widest": (widest["energy"], "GJ"),
        "failing": (max(row["failing"] for row in rows), ""),
        "displacement_single": (rows[0]["displacement"], "m"),
        "displacement_widest": (widest["displacement"], "m"),
    }
    meta = {
        "parameters": to_table(record),
        "seed": seed,
        "version": VERSION,
        "seconds": time.perf_counter() - began,
        "figures": {name: {"value": v, "unit": unit} for name, (v, unit) in numbers.items()},
        "notes": notes,
    }
    return RangeSweep(rows, meta)


def draw(result: RangeSweep, folder: Path, display: Display) -> list[str]:
    """Write ranges.png, the share of the single section's mass over the reach of the range.

    Nothing of ``display`` is used. Raises FileError where it cannot be written.
    """
    swept = result.rows[1:]
    reach = np.array([100 * row["reach"] for row in swept])
    share = np.array([100 * row["share"] for row in swept])
    curves = [("A section for each member", share, None, None)]
    curves.append(("One section for all", np.full_like(share, 100.0), None, None))
    across = "Range of heights, from the single section's down (%)"
    section_png(folder / CHART, reach, curves, "Mass", "% of one section for all", False, across)
    return [CHART]


def _lowered(sizes: SectionRange, height: float, reach: float) -> Any:
    """The range from ``height``, or lower by ``reach`` of the way down to its least, up."""
    if not height:
        return sizes
    low = height - reach * (height - sizes.height_low)
    steps = round((low - sizes.height_low) / sizes.step)
    return replace(sizes, height_low=sizes.height_low + steps * sizes.step)


def _row(
    sized: Sized, single: Sized, reach: float, steel: float, timber: float
) -> dict[str, float]:
    figures = {name: figure["value"] for name, figure in sized.figures().items()}
    return {
        "reach": reach,
        "lowest_steel": float(steel),
        "lowest_timber": float(timber),
        "mass": figures["mass"],
        "share": figures["mass"] / single.figures()["mass"]["value"],
        "energy": figures["embodied_energy"],
        "sections": figures["sections"],
        "utilisation": figures["mean_utilisation"],
        "failing": figures["failing"],
        "displacement": figures["max_displacement"],
        "rounds": figures["rounds"],
        "converged": figures["converged"],
    }
