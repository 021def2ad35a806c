"""What a finished piece is like beside its design: the deviation, the layers, the pose."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..core.errors import FileError
from ..core.files import BROKEN, written
from ..core.scene import Vector
from ..core.table import save_csv
from .found import LayerTable

DATA, DEVIATION, LAYERS, DESIGN_LAYERS = (
    *("as_printed.npz", "deviation.csv"),
    *("layers.csv", "design layers.csv"),
)
_ARRAYS = ("vertices", "deviation", "area", "outside", "inside", "matrix")


@dataclass(frozen=True, slots=True)
class AsPrinted:
    """A scan of a finished piece against its design.

    ``vertices`` (V, 3) float64 in m are the design's as they are in the scene, ``deviation`` (V,)
    how far in m the piece stands out of it there, NaN where it was not seen; ``area`` (V,) in m²
    the vertices' shares of the surface. ``outside`` and ``inside`` (rows, columns) are the wall's
    sides unrolled, in m, row 0 at the bottom, columns counter-clockwise from +X; of no size where
    nothing was seen. ``matrix`` (4, 4) takes the scan's points in m to the scene. ``layers`` and
    ``design_layers`` are measured alike on the scan and on the design.

    ``meta`` says the figures (name → value, unit and, where known, the 95 % half-width),
    parameters, pose, seed, version, seconds and notes.
    """

    vertices: Vector
    deviation: Vector
    area: Vector
    outside: Vector
    inside: Vector
    matrix: Vector
    layers: LayerTable
    design_layers: LayerTable
    meta: dict[str, Any]

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the report: name → value, unit and, where there is one, uncertainty."""
        return self.meta["figures"]

    def save(self, folder: Path) -> list[str]:
        """Write arrays and tables into ``folder``; returns the files' names.

        Raises FileError where they cannot be written.
        """
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        arrays |= self.layers.arrays("layers_") | self.design_layers.arrays("design_layers_")
        text = np.array(json.dumps(self.meta, ensure_ascii=False))
        with written(folder / DATA) as draft, draft.open("wb") as stream:
            np.savez_compressed(stream, allow_pickle=False, meta=text, **arrays)
        seen = np.isfinite(self.deviation)
        columns = {f"{axis} (m)": self.vertices[seen, i] for i, axis in enumerate("XYZ")}
        columns["Deviation (m)"] = self.deviation[seen]
        about = {"title": self.meta["quantity"], "scan": self.meta["scan"]}
        save_csv(folder / DEVIATION, columns, about | {"design": self.meta["design"]})
        _save_layers(folder / LAYERS, self.layers, "Layers as found", self.meta)
        _save_layers(folder / DESIGN_LAYERS, self.design_layers, "Layers of the design", self.meta)
        return [DATA, DEVIATION, LAYERS, DESIGN_LAYERS]

    @classmethod
    def load(cls, folder: Path) -> "AsPrinted":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        try:
            with np.load(folder / DATA, allow_pickle=False) as held:
                return cls(
                    **{name: held[name] for name in _ARRAYS},
                    layers=LayerTable.of(held, "layers_"),
                    design_layers=LayerTable.of(held, "design_layers_"),
                    meta=json.loads(str(held["meta"])),
                )
        except BROKEN as failed:
            raise FileError(
                f"“{folder}” holds no comparison of a scan with its design; compare again."
            ) from failed


def _save_layers(path: Path, layers: LayerTable, title: str, meta: dict[str, Any]) -> None:
    columns = {
        "Layer": np.arange(1, len(layers.z) + 1),
        "Middle (m)": layers.z,
        "Height (m)": layers.height,
        "Height, spread around (m)": layers.height_spread,
        "Height, standard error (m)": layers.height_error,
        "Width (m)": layers.width,
        "Width, spread around (m)": layers.width_spread,
        "Width, standard error (m)": layers.width_error,
        "Crest before the outline (m)": layers.front,
        "Points": layers.points.astype(int),
    }
    save_csv(path, columns, {"title": title, "scan": meta["scan"], "design": meta["design"]})
