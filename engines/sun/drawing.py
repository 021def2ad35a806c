"""Pictures of a sun study: its maps in false colour, and how the period went."""

from pathlib import Path

import numpy as np

from ..core.colour import ColourScale, Display, scale_for
from ..core.picture import false_colour_png
from .maps import QUANTITIES, SunMap, SunMaps
from .temporal import save_hours


def draw(result: SunMaps, folder: Path, display: Display) -> list[str]:
    """Write a picture a map and side on `scale_of`, and `save_hours`; returns their names.

    Raises FileError where they cannot be written.
    """
    files = []
    for index, one in enumerate(result.maps):
        for side, maps in one.sides():
            for name, values in maps.items():
                if not np.isfinite(values).any():
                    continue
                stem = f"{index + 1} " if len(result.maps) > 1 else ""
                files.append(f"{stem}{name}{f' {side}' if side else ''}.png")
                title, unit, _ = QUANTITIES[name]
                heading = f"{one.receiver}{f' ({side})' if side else ''}: {title.lower()}"
                scale = scale_of(result, name, display)
                note = f"{summary(one, name, unit)}, {result.meta['period']}"
                false_colour_png(folder / files[-1], values, scale, heading, note)
    return [*files, *save_hours(folder, result, display)]


def scale_of(result: SunMaps, name: str, display: Display) -> ColourScale:
    """The scale of one map's name, the same for all receivers.

    Per cent reach to 100; these, shares and hours are evenly spaced. Irradiation with and without
    buildings is on one scale, that of the latter.
    """
    title, unit, _ = QUANTITIES[name]
    if unit == "%":
        return ColourScale(0.0, 100.0, False, display.palette, title, unit)
    shown = "open" if name == "total" and "open" in result.maps[0].maps else name
    values = np.concatenate([one.maps[shown].ravel() for one in result.maps])
    if unit in ("", "h"):
        return ColourScale.automatic(values, False, display.palette, title, unit)
    return scale_for(values, display, title, unit)


def summary(one: SunMap, name: str, unit: str) -> str:
    """The line below a picture: mean, least and greatest."""
    values = one.maps[name]
    texts = (f"{v:.4g}" for v in (one.mean(name), np.nanmin(values), np.nanmax(values)))
    mean, least, most = (f"{text} {unit}".strip() for text in texts)
    return f"mean {mean}, least {least}, greatest {most}"
