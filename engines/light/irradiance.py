"""The result of a photon tracing: maps on a receiver, their interval, and where the flux went."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import exr

Map = NDArray[np.float32]
MAPS = (
    *("illuminance", "direct", "caustic", "indirect", "half_width", "lower", "upper"),
    *("smooth", "smooth_half_width", "smooth_bias"),
)


@dataclass(frozen=True, slots=True)
class IrradianceMap:
    """Illuminance on one receiver.

    All maps (rows, columns) float32 in lx, row 0 at v = 0. ``illuminance`` is the sum of
    ``direct`` (no body met on the way), ``caustic`` (only mirrors and glass met) and ``indirect``
    (scattered by a matte surface); texel means, unfiltered. ``lower`` and ``upper`` bound it with
    95 % confidence, ``half_width`` is half their distance. ``smooth`` is the illuminance with the
    traced light gathered over as many texels as it needs (`kernel.smoothed`): for the eye, and
    where few photons must do. ``smooth_half_width`` is the 95 % half-width of its noise,
    ``smooth_bias`` the estimate of what its blur does; the other bounds are the raw texels'.

    ``meta`` says quantity, unit, receiver, size (m), parameters, seed, version, photons, flux (lm),
    error, seconds and notes.
    """

    illuminance: Map
    direct: Map
    caustic: Map
    indirect: Map
    half_width: Map
    lower: Map
    upper: Map
    smooth: Map
    smooth_half_width: Map
    smooth_bias: Map
    meta: dict[str, Any]

    @property
    def mean(self) -> float:
        """Mean illuminance in lx."""
        return float(self.illuminance.mean(dtype=np.float64))

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the report: name → value, unit and, where there is one, uncertainty."""
        peak = np.unravel_index(np.argmax(self.illuminance), self.illuminance.shape)
        meta = self.meta
        table = {
            "mean_illuminance": (self.mean, "lx", meta["mean_half_width"]),
            "max_illuminance": (self.illuminance[peak], "lx", self.half_width[peak]),
            "mean_caustic": (self.caustic.mean(dtype=np.float64), "lx", meta["traced_half_width"]),
            "max_caustic": (self.caustic.max(), "lx", None),
            "photons_emitted": (meta["photons"]["emitted"], "", None),
            "photons_landed": (meta["photons"]["landed"], "", None),
            **{f"flux_{k}": (v, "lm", None) for k, v in meta["flux"].items()},
        }
        if meta["error"] is not None:
            table["error"] = (meta["error"], "", None)
        return {
            name: {"value": float(value), "unit": unit}
            | ({} if spread is None else {"uncertainty": float(spread)})
            for name, (value, unit, spread) in table.items()
        }

    def save(self, folder: Path) -> list[str]:
        """Write ``irradiance.exr`` into ``folder``; returns the names of the files written."""
        exr.save(folder / "irradiance.exr", {name: getattr(self, name) for name in MAPS}, self.meta)
        return ["irradiance.exr"]

    @classmethod
    def load(cls, folder: Path) -> "IrradianceMap":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        channels, meta = exr.load(folder / "irradiance.exr")
        return cls(**{name: channels[name] for name in MAPS}, meta=meta)
