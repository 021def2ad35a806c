"""Pictures of a sun study: its maps in false colour, and how the period went."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..core.colour import ColourScale, Display, scale_for
from ..core.picture import false_colour_png
from .maps import SunMap, SunMaps
from .tables import QUANTITIES
from .temporal import save_hours
from .words import number_text

_ITS_OWN = ("daylight_factor", "shading")
"""Per cent that need not come near 100."""
_NEARLY_ALL = 95  # per cent of the texels


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
    """The scale of one map's name, the same for all receivers and evenly spaced.

    An automatic one of shares of the time reaches to 100 %. Irradiation with and without buildings
    is on one scale, that of the latter, unless nearly all of what is shown is below half of that,
    as in a room: then the scale is of nearly all, and a sunny spot by a window is off it.

    Raises ParameterError as `scale_for`.
    """
    title, unit, _ = QUANTITIES[name]
    display = replace(display, log=False)
    if display.automatic and unit == "%" and name not in _ITS_OWN:
        return ColourScale(0.0, 100.0, False, display.palette, title, unit)
    values = _values(result, name)
    if display.automatic and name == "total" and "open" in result.maps[0].maps:
        free = scale_for(_values(result, "open"), display, title, unit)
        most = np.nanpercentile(values, _NEARLY_ALL) if np.isfinite(values).any() else 0.0
        if most >= free.high / 2:
            return free
        values = np.minimum(values, most)
    return scale_for(values, display, title, unit)


def _values(result: SunMaps, name: str) -> NDArray[np.float32]:
    return np.concatenate([one.maps[name].ravel() for one in result.maps])


def summary(one: SunMap, name: str, unit: str) -> str:
    """The line below a picture: mean, least and greatest."""
    values = one.maps[name]
    texts = (number_text(float(v)) for v in (one.mean(name), np.nanmin(values), np.nanmax(values)))
    mean, least, most = (f"{text} {unit}".strip() for text in texts)
    return f"mean {mean}, least {least}, greatest {most}"
