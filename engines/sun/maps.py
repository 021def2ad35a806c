"""What sun and sky give to the receivers of a scene: maps, hourly means and figures."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import exr
from ..core.errors import FileError
from ..core.files import BROKEN, written
from ..core.scene import Vector
from .tables import save_hourly

QUANTITIES: dict[str, tuple[str, str, str]] = {
    "sun_hours": ("Sun hours", "h", "How long the sun is up and nothing but glass hides it."),
    "direct": ("Direct irradiation", "kWh/m²", "What comes straight from the sun."),
    "diffuse": ("Diffuse irradiation", "kWh/m²", "What comes from the sky and off the ground."),
    "reflected": ("Reflected irradiation", "kWh/m²", "What comes off bodies and receivers."),
    "total": (
        "Irradiation",
        "kWh/m²",
        "From sun, sky and ground, and off bodies where that is followed.",
    ),
    "open": ("Irradiation without buildings", "kWh/m²", "The same in an open field."),
    "shading": ("Shading", "", "What share of the irradiation in an open field is kept off."),
    "daylight_factor": ("Daylight factor", "%", "Illuminance over that outdoors, overcast."),
    "illuminance": ("Illuminance", "lx", "The mean over the period."),
    "open_illuminance": ("Illuminance without buildings", "lx", "The same in an open field."),
    "daylight_autonomy": ("Daylight autonomy", "%", "Share of the hours that reach the target."),
    "continuous_autonomy": ("Continuous autonomy", "%", "The same, with part of it for part."),
    "udi_low": ("Too dark", "%", "Share of the hours with too little to be useful."),
    "udi_supplementary": ("Dim", "%", "Share of the hours in which lamps help."),
    "udi_useful": ("Useful daylight", "%", "Share of the hours with useful illuminance."),
    "udi_high": ("Too bright", "%", "Share of the hours with more than is useful."),
    "direct_hours": ("Hours of direct sun", "h", "Hours with more than 1000 lx from the sun."),
}
"""Name of a map → its title, its unit, and what it is in a sentence."""

DATA = "hourly.npz"
_AREA = "area"
_SIDES = ("front", "back")


@dataclass(frozen=True, slots=True)
class SunMap:
    """One receiver's maps.

    ``maps``: name of `QUANTITIES` → (rows, columns) float32, row 0 at v = 0, NaN where no sensor
    is; (2, rows, columns) where front and back both gather. ``area`` (rows, columns) float32 in m²
    that each texel stands for, 0 where there is no surface.
    """

    receiver: str
    maps: dict[str, NDArray[np.float32]]
    area: NDArray[np.float32]

    def sides(self) -> Iterator[tuple[str, dict[str, NDArray[np.float32]]]]:
        """“front” and “back”, or "" where only one side gathers, with their (rows, columns)."""
        first = next(iter(self.maps.values()))
        if first.ndim == 2:
            yield "", self.maps
            return
        for index, side in enumerate(_SIDES):
            yield side, {name: values[index] for name, values in self.maps.items()}

    def mean(self, name: str) -> float:
        """A map's mean over the area that has a value, both sides together; NaN without any."""
        values = self.maps[name].astype(np.float64)
        area = np.where(np.isfinite(values), self.area, 0.0)
        total = area.sum()
        return float(np.nansum(values * area) / total) if total else float("nan")

    def integral(self, name: str) -> float:
        """Σ value · area: kWh for an irradiation."""
        return float(np.nansum(self.maps[name].astype(np.float64) * self.area))


@dataclass(frozen=True, slots=True)
class SunMaps:
    """The maps of all receivers, in their order, and how the period went.

    ``times`` (T,) datetime64[s], UTC: the middles of the intervals that count. ``hourly``: name of
    `tables.HOURLY` → (T,) float64, means over all sensors by area; empty where not asked for.

    ``meta`` says figures (name → value and unit), quantities (name → title and unit), parameters,
    site, source (of the weather), period, notes, seed, version and seconds.
    """

    maps: tuple[SunMap, ...]
    times: NDArray[np.datetime64]
    hourly: dict[str, Vector]
    meta: dict[str, Any]

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the report: name → value and unit."""
        return self.meta["figures"]

    def save(self, folder: Path) -> list[str]:
        """Write an EXR a receiver, the hourly means and their table; returns the files' names.

        A side's map is a channel “name”, or “front.name” and “back.name”. Raises FileError where
        they cannot be written.
        """
        files = []
        for index, one in enumerate(self.maps):
            files.append(f"sun{'' if len(self.maps) == 1 else f' {index + 1}'}.exr")
            channels = {
                f"{side}.{name}".lstrip("."): values
                for side, maps in one.sides()
                for name, values in maps.items()
            }
            meta = {**self.meta, "receiver": one.receiver}
            exr.save(folder / files[-1], {**channels, _AREA: one.area}, meta)
        text = np.array(json.dumps(self.meta, ensure_ascii=False))
        with written(folder / DATA) as draft, draft.open("wb") as stream:
            hourly = {f"hourly_{name}": values for name, values in self.hourly.items()}
            np.savez_compressed(
                stream, allow_pickle=False, meta=text, times=self.times.astype("int64"), **hourly
            )
        files.append(DATA)
        if len(self.times):
            files.append(save_hourly(folder, self.times, self.hourly, self.meta))
        return files

    @classmethod
    def load(cls, folder: Path) -> "SunMaps":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        one = folder / "sun.exr"
        files = [one] if one.exists() else sorted(folder.glob("sun *.exr"), key=_number)
        if not files:
            raise FileError(f"“{folder}” holds no sun study; do it again.")
        try:
            with np.load(folder / DATA, allow_pickle=False) as held:
                meta = json.loads(str(held["meta"]))
                times = held["times"].astype("datetime64[s]")
                hourly = {
                    name.removeprefix("hourly_"): held[name]
                    for name in held.files
                    if name.startswith("hourly_")
                }
        except BROKEN as failed:
            raise FileError(f"“{folder}” holds no whole sun study; do it again.") from failed
        return cls(tuple(map(_loaded, files)), times, hourly, meta)


def figures_of(maps: tuple[SunMap, ...]) -> dict[str, dict[str, Any]]:
    """Mean by area, least and greatest of every map, and kWh of every irradiation.

    Under “receiver.” where there are several.
    """
    table: dict[str, dict[str, Any]] = {}
    for one in maps:
        prefix = f"{one.receiver}." if len(maps) > 1 else ""
        for name, values in one.maps.items():
            unit = QUANTITIES[name][1]
            if not np.isfinite(values).any():
                continue
            ends = {"min": float(np.nanmin(values)), "max": float(np.nanmax(values))}
            for kind, value in {"mean": one.mean(name), **ends}.items():
                table[f"{prefix}{kind}_{name}"] = {"value": value, "unit": unit}
            if unit == "kWh/m²":
                table[f"{prefix}sum_{name}"] = {"value": one.integral(name), "unit": "kWh"}
    return table


def quantities_of(maps: tuple[SunMap, ...]) -> dict[str, list[str]]:
    """Title and unit of each map that there is."""
    return {name: list(QUANTITIES[name][:2]) for one in maps for name in one.maps}


def _loaded(file: Path) -> SunMap:
    channels, meta = exr.load(file)
    area = channels.pop(_AREA)
    fronts = [name for name in channels if name.startswith("front.")]
    if not fronts:
        return SunMap(meta["receiver"], _ordered(channels), area)
    both = {
        name.removeprefix("front."): np.stack(
            [channels[name], channels[name.replace("front.", "back.", 1)]]
        )
        for name in fronts
    }
    return SunMap(meta["receiver"], _ordered(both), area)


def _ordered(maps: dict[str, NDArray[np.float32]]) -> dict[str, NDArray[np.float32]]:
    """An EXR sorts its channels; here they come in the order of `QUANTITIES`."""
    return {name: maps[name] for name in QUANTITIES if name in maps}


def _number(file: Path) -> int:
    return int(file.stem.split()[-1])
