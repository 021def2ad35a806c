"""The pictures of an irradiance map: false colours with a legend, and the section along u."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.atlas import padded
from ..core.colour import Display, scale_for
from ..core.picture import colour_png, false_colour_png
from .irradiance import COLOURS, Irradiance, IrradianceMap
from .section import section


def draw(result: Irradiance, folder: Path, display: Display) -> list[str]:
    """Write the pictures of every map, see `draw_map`; returns their names.

    Those of several receivers begin with the number of the map. Raises FileError where they cannot
    be written.
    """
    files = []
    for index, one in enumerate(result.maps):
        prefix = f"{index + 1} " if len(result.maps) > 1 else ""
        files += draw_map(one, folder, display, prefix)
    return files


def draw_map(result: IrradianceMap, folder: Path, display: Display, prefix: str = "") -> list[str]:
    """Write illuminance.png, smooth.png, caustic.png and colour.png where there is any light of
    that kind, and section.png and .csv of a plane; returns their names.
    """
    note = summary(result)
    files = []

    def picture(name: str, values: Any, quantity: str, title: str) -> None:
        values = shown(values, result.inside)
        scale = scale_for(values, display, quantity, "lx")
        files.append(f"{prefix}{name}.png")
        false_colour_png(folder / files[-1], values, scale, f"{result.name}: {title}", note)

    picture("illuminance", result.illuminance, "Illuminance", "illuminance")
    if result.smooth_bias.any():
        picture("smooth", result.smooth, "Illuminance", "illuminance, smoothed")
    if result.caustic.any():
        title = "light through glass and from mirrors"
        picture("caustic", result.caustic, "Caustic illuminance", title)
    if result.indirect.any():
        picture("indirect", result.indirect, "Indirect illuminance", "light from matte surfaces")
    colour = np.stack([getattr(result, name) for name in COLOURS], axis=-1)
    if colour.any():
        files.append(f"{prefix}colour.png")
        light = shown(colour, result.inside)
        colour_png(folder / files[-1], light, f"{result.name}: colour", note)
    if is_plane(result):
        profile = section(result)
        profile.save_png(folder / f"{prefix}section.png", display.log)
        profile.save_csv(folder / f"{prefix}section.csv")
        files += [f"{prefix}section.png", f"{prefix}section.csv"]
    return files


def is_plane(result: IrradianceMap) -> bool:
    """Whether a map is that of a rectangle: all of it is surface, in texels of one size."""
    return bool(0 < result.area.min() == result.area.max())


def shown(
    values: NDArray[np.floating], inside: NDArray[np.bool_], gutter: int = 0
) -> NDArray[np.floating]:
    """A map (rows, columns[, k]) as it is shown: NaN where there is no surface.

    ``inside`` (rows, columns) is where there is some; around it, values are carried ``gutter``
    texels on, for a viewport that draws a chart's border just beyond it.
    """
    if inside.all():
        return values
    there = inside
    if gutter:
        there = padded(inside.astype(np.float32), inside, gutter) > 0
        values = padded(values, inside, gutter)
    return np.where(there[(...,) + (None,) * (values.ndim - 2)], values, np.nan)


def summary(result: IrradianceMap) -> str:
    """The line below a picture: error, photons, mean and peak."""
    meta, figures = result.meta, result.figures()
    photons = meta["photons"]
    parts = [
        f"mean {figures['mean_illuminance']['value']:.4g} lx",
        f"peak {figures['max_illuminance']['value']:.4g} lx",
    ]
    if meta["error"]:
        parts += [
            f"error {100 * meta['error']:.0f} % (95 %)",
            f"{photons['landed'] / 1e6:.3g} M of {photons['emitted'] / 1e6:.3g} M photons landed",
        ]
    return ", ".join(parts)
