"""The result of a photon tracing: maps on receivers, their intervals, and where the flux went."""

import shutil
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import exr
from ..core.errors import FileError

Map = NDArray[np.float32]
COLOURS = ("red", "green", "blue")
MAPS = (
    *("illuminance", "direct", "caustic", "indirect", "half_width", "lower", "upper"),
    *("smooth", "smooth_half_width", "smooth_bias", "area", *COLOURS),
)
SUMS = "sums.npz"


@dataclass(frozen=True, slots=True)
class IrradianceMap:
    """Illuminance on one side of a receiver.

    All maps (rows, columns) float32 in lx, row 0 at v = 0. ``illuminance`` is the sum of
    ``direct`` (no body met on the way), ``caustic`` (only mirrors and glass met) and ``indirect``
    (scattered by a matte surface); texel means, unfiltered. ``lower`` and ``upper`` bound it with
    95 % confidence, ``half_width`` is half their distance. ``smooth`` is the illuminance with the
    traced light gathered over as many texels as it needs (`kernel.smoothed`): for the eye, and
    where few photons must do. ``smooth_half_width`` is the 95 % half-width of its noise,
    ``smooth_bias`` the estimate of what its blur does; the other bounds are the raw texels'.

    ``area`` is that of the surface in each texel in m², 0 where a mesh's map has none. ``red``,
    ``green`` and ``blue`` are the light's colour in linear Rec. 709 whose luminance is the
    illuminance, equal where the lamp's own colour is unchanged; all 0 where no colour was traced.

    ``meta`` says quantity, unit, receiver, side, size (m), parameters, seed, version, photons, flux
    (lm), error, seconds and notes.
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
    area: Map
    red: Map
    green: Map
    blue: Map
    meta: dict[str, Any]

    @property
    def name(self) -> str:
        """The receiver's name, with the side where both gather."""
        side = self.meta.get("side")
        return f"{self.meta['receiver']} ({side})" if side else self.meta["receiver"]

    @property
    def inside(self) -> NDArray[np.bool_]:
        """Where there is surface (rows, columns)."""
        return self.area > 0

    @property
    def mean(self) -> float:
        """Mean illuminance over the surface in lx."""
        return self.mean_of("illuminance")

    def mean_of(self, name: str) -> float:
        """The mean of a map over the surface, in the map's unit."""
        area = self.area.astype(np.float64)
        return float((getattr(self, name) * area).sum() / area.sum())

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the report: name → value, unit and, where there is one, uncertainty."""
        peak = np.unravel_index(np.argmax(self.illuminance), self.illuminance.shape)
        meta = self.meta
        table = {
            "mean_illuminance": (self.mean, "lx", meta["mean_half_width"]),
            "max_illuminance": (self.illuminance[peak], "lx", self.half_width[peak]),
            "mean_caustic": (self.mean_of("caustic"), "lx", meta["traced_half_width"]),
            "max_caustic": (self.caustic.max(), "lx", None),
            "mean_indirect": (self.mean_of("indirect"), "lx", None),
        }
        return _listed(table)


@dataclass(frozen=True, slots=True)
class Irradiance:
    """The irradiance maps of all receivers, in their order, and what they have in common.

    ``meta`` is that of every map without what is a receiver's own. ``sums`` is the file of the
    sums behind the maps, with which `trace` goes on, or None.
    """

    maps: tuple[IrradianceMap, ...]
    meta: dict[str, Any]
    sums: Path | None = field(default=None, compare=False)

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of all maps, each under its receiver's name where there are several."""
        several = len(self.maps) > 1
        table = {}
        for one in self.maps:
            prefix = f"{one.name}." if several else ""
            table |= {prefix + name: figure for name, figure in one.figures().items()}
        meta = self.meta
        common = {
            "photons_emitted": (meta["photons"]["emitted"], "", None),
            "photons_landed": (meta["photons"]["landed"], "", None),
            **{f"flux_{k}": (v, "lm", None) for k, v in meta["flux"].items()},
        }
        if meta["error"] is not None:
            common["error"] = (meta["error"], "", None)
        return table | _listed(common)

    def save(self, folder: Path) -> list[str]:
        """Write an EXR a map and the sums into ``folder``; returns the names of the files.

        Raises FileError where they cannot be written.
        """
        files = []
        for index, one in enumerate(self.maps):
            file = f"irradiance{'' if len(self.maps) == 1 else f' {index + 1}'}.exr"
            exr.save(folder / file, {name: getattr(one, name) for name in MAPS}, one.meta)
            files.append(file)
        if self.sums is not None:
            try:
                shutil.move(self.sums, folder / SUMS)
            except OSError as failed:
                raise FileError(
                    f"“{folder / SUMS}” cannot be written: {failed.strerror}; choose another "
                    "folder."
                ) from None
            files.append(SUMS)
        return files

    @classmethod
    def load(cls, folder: Path) -> "Irradiance":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        one = folder / "irradiance.exr"
        files = [one] if one.exists() else sorted(folder.glob("irradiance *.exr"), key=_number)
        if not files:
            raise FileError(f"“{folder}” holds no irradiance map; trace photons again.")
        maps = []
        for file in files:
            channels, meta = exr.load(file)
            maps.append(IrradianceMap(**{name: channels[name] for name in MAPS}, meta=meta))
        own = ("receiver", "side", "size", "mean_half_width", "traced_half_width", "gathered")
        meta = {k: v for k, v in maps[0].meta.items() if k not in own}
        sums = folder / SUMS
        return cls(tuple(maps), meta, sums if sums.exists() else None)


def _number(file: Path) -> int:
    return int(file.stem.split()[-1])


def _listed(table: dict[str, tuple[Any, str, Any]]) -> dict[str, dict[str, Any]]:
    return {
        name: {"value": float(value), "unit": unit}
        | ({} if spread is None else {"uncertainty": float(spread)})
        for name, (value, unit, spread) in table.items()
    }
