"""A sized structure: what every member is, how much of it is used, and what it all weighs."""

import json
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from ..core.files import BROKEN, written
from ..core.scene import Vector
from . import tables
from .checking import Checked
from .dxf import save_dxf
from .frame import Frame
from .model import Model

DATA, DRAWING = "structure.npz", "members.dxf"
MEMBER = np.dtype(
    [
        *(("group", "i4"), ("family", "i4"), ("section", "i4"), ("slot", "i4")),
        *(("material", "U8"), ("grade", "U40"), ("name", "U60")),
        *((name, "f8") for name in ("height", "width", "thickness", "area", "length")),
        *((name, "f8") for name in ("mass", "energy", "carbon", "utilisation")),
        *(("check", "i4"), ("combination", "i4"), ("station", "i4"), ("failing", "?")),
    ]
)
"""A member's row: ``family`` and ``section`` index the families that were chosen from and one's
sections, members of one ``slot`` share theirs; ``check``, ``combination`` and ``station`` say where
it is used most. m, m², kg, J, kg of CO₂ equivalent."""

BENT = 5
"""Even stations of a member at which it is kept how far it moves."""

Rows = NDArray[np.void]


@dataclass(frozen=True, slots=True)
class Sized:
    """A structure of N nodes and M members, sized and checked in K combinations.

    ``rows`` (M,) of MEMBER; ``checked``: every check of every member's strength and stability;
    ``served``: the limits of deflection, none where none was set. ``displacements`` and
    ``reactions`` (K, N, 6) in m, rad, N and N·m, in the world's axes. ``deflections`` (M, BENT, 3)
    in m: where members go in the combination that moves one of them farthest, the one numbered
    ``meta["worst"]``. ``forces`` (2, M, S, 6): the least and the greatest of each section force at
    S stations, in local axes. ``stress`` (2, M, S) in Pa: the least and the greatest elastic normal
    stress in the section. ``frequencies`` (n,) in Hz and ``buckling`` (n,), the least critical load
    factors, are empty where they were not asked.

    ``meta``: figures, parameters, combinations as they are printed, families, seed, version,
    seconds, notes.
    """

    model: Model
    rows: Rows
    checked: Checked
    served: Checked
    displacements: Vector
    reactions: Vector
    deflections: Vector
    forces: Vector
    stress: Vector
    frequencies: Vector
    buckling: Vector
    meta: dict[str, Any]

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the report: name → value and unit."""
        return self.meta["figures"]

    def save(self, folder: Path) -> list[str]:
        """Write arrays, tables and the drawing into ``folder``; returns the files' names.

        Raises FileError where they cannot be written.
        """
        text = np.array(json.dumps(self.meta, ensure_ascii=False))
        with written(folder / DATA) as draft, draft.open("wb") as stream:
            np.savez_compressed(stream, allow_pickle=False, meta=text, **self._arrays())
        save_dxf(folder / DRAWING, self.model.frame, self.rows)
        return [DATA, *tables.save_tables(folder, self), DRAWING]

    @classmethod
    def load(cls, folder: Path) -> "Sized":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        try:
            with np.load(folder / DATA, allow_pickle=False) as held:
                arrays = {name: held[name] for name in held.files}
            meta = json.loads(str(arrays.pop("meta")))
            frame = Frame(**_part(arrays, "frame_"))
            model = Model(
                frame,
                **_part(arrays, "model_"),
                group_names=tuple(meta["group_names"]),
                notes=tuple(meta["model_notes"]),
            )
            checked = Checked(tuple(meta["checks"]), **_part(arrays, "checked_"))
            served = Checked(tuple(meta["service_checks"]), **_part(arrays, "served_"))
            rest = _part(arrays, "result_")
            return cls(model=model, checked=checked, served=served, meta=meta, **rest)
        except BROKEN as failed:
            raise FileError(
                f"“{folder}” holds no sized structure; size it again ({failed})."
            ) from failed

    def _arrays(self) -> dict[str, NDArray[Any]]:
        parts = {"frame_": self.model.frame, "model_": self.model}
        parts |= {"checked_": self.checked, "served_": self.served, "result_": self}
        return {
            prefix + field.name: value
            for prefix, part in parts.items()
            for field in fields(part)
            if isinstance(value := getattr(part, field.name), np.ndarray)
        }


def _part(arrays: dict[str, NDArray[Any]], prefix: str) -> dict[str, NDArray[Any]]:
    return {k.removeprefix(prefix): v for k, v in arrays.items() if k.startswith(prefix)}
