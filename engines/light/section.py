"""Illuminance along a line across a receiver, as the sections of measured images are compared."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.picture import section_png
from ..core.table import save_csv
from .irradiance import IrradianceMap

CURVES = ("illuminance", "lower", "upper", "direct", "caustic")
Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Section:
    """Values along a line: ``distance`` (N,) in m from its start, the others (N,) in lx.

    ``lower`` and ``upper`` bound ``illuminance`` with 95 % confidence. Outside the receiver all
    are NaN. ``meta`` is that of the map, with the line's ``start`` and ``end`` in (u, v).
    """

    distance: NDArray[np.float64]
    illuminance: NDArray[np.float32]
    lower: NDArray[np.float32]
    upper: NDArray[np.float32]
    direct: NDArray[np.float32]
    caustic: NDArray[np.float32]
    meta: dict[str, Any]

    def save_csv(self, path: Path) -> None:
        """Write a row a sample. Raises FileError where the file cannot be written."""
        unit = self.meta["unit"]
        named = {f"{name.capitalize()} ({unit})": getattr(self, name) for name in CURVES}
        save_csv(path, {"Distance (m)": self.distance, **named}, self.meta)

    def save_png(self, path: Path, log: bool = False) -> None:
        """Draw the curves with their interval. Raises FileError where it cannot be written."""
        curves = [
            ("All light", self.illuminance, self.lower, self.upper),
            ("Caustic", self.caustic, None, None),
            ("Direct", self.direct, None, None),
        ]
        section_png(path, self.distance, curves, self.meta["quantity"], self.meta["unit"], log)


def section(
    result: IrradianceMap,
    start: Place = (0.0, 0.5),
    end: Place = (1.0, 0.5),
    samples: int | None = None,
) -> Section:
    """The section of a map from ``start`` to ``end``, in texture coordinates (u, v).

    Each sample is that of the texel it lies in, nothing is blended, so that the interval stays
    what it says. ``samples`` spread evenly, each in the middle of its stretch; left out, there is
    one for every texel along the longer way.

    Raises SceneError where the line has no length or does not meet the receiver.
    """
    rows, columns = result.illuminance.shape
    begin, way = np.asarray(start, float), np.subtract(end, start)
    texels = np.abs(way) * (columns, rows)
    length = float(np.hypot(*(way * result.meta["size"])))
    if length == 0:
        raise SceneError("The section line has no length; draw its ends apart.")
    count = samples or max(2, int(np.ceil(texels.max() - 1e-6)))
    share = (np.arange(count) + 0.5) / count
    u, v = begin[:, None] + way[:, None] * share
    inside = (u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)
    if not inside.any():
        raise SceneError(
            f"The section line does not cross “{result.meta['receiver']}”; move it over it."
        )
    column = np.clip((u * columns).astype(int), 0, columns - 1)
    row = np.clip((v * rows).astype(int), 0, rows - 1)
    values = {
        name: np.where(inside, getattr(result, name)[row, column], np.float32(np.nan))
        for name in CURVES
    }
    meta = result.meta | {"start": list(map(float, start)), "end": list(map(float, end))}
    return Section(share * length, **values, meta=meta)
