"""The pictures of a comparison: the sides in false colour, layer heights and widths along z."""

from pathlib import Path

import numpy as np

from ..core.colour import ColourScale, Display
from ..core.picture import false_colour_png, section_png
from ..core.scene import Vector
from .found import LayerTable
from .printed_result import AsPrinted

_PEAK = 99.9  # percentile of the deviation that the colours reach to
_LEAST = 0.01  # mm, that they reach to at least
_TO_95 = 1.96


def draw(result: AsPrinted, folder: Path, display: Display) -> list[str]:
    """Write outside.png, inside.png, heights.png and widths.png, those of them that were seen.

    Deviations are in mm on a linear scale as far below zero as above, whatever ``display`` says of
    logarithms; a range set by hand is taken in mm. Returns the files' names.

    Raises FileError where they cannot be written.
    """
    files = []
    sides = {"outside": result.outside, "inside": result.inside}
    scale = _scale([1e3 * values for values in sides.values()], display)
    for name, values in sides.items():
        if np.isfinite(values).any():
            files.append(f"{name}.png")
            heading = f"{result.meta['design']}: deviation of the {name}, unrolled"
            false_colour_png(folder / files[-1], 1e3 * values, scale, heading, summary(result))
    layers, design = result.layers, result.design_layers
    for name, quantity in (("height", "Layer height"), ("width", "Wall width")):
        values = 1e3 * getattr(layers, name)
        if np.isfinite(values).sum() > 1:
            files.append(f"{name}s.png")
            meant, said = _meant(layers, design, name)
            error = _TO_95 * 1e3 * getattr(layers, f"{name}_error")
            more = values - 1e3 * meant
            curves = [("As found, 95 %", more, more - error, more + error)]
            curves.append(("Design", np.zeros_like(more), None, None))
            section_png(folder / files[-1], layers.z, curves, f"{quantity} {said}", "mm", False)
    return files


def summary(result: AsPrinted) -> str:
    """The line below a picture: deviation, tolerance, coverage and the pose's error."""
    figures = result.figures()
    tolerance = result.meta["parameters"]["tolerance"]

    def mm(name: str) -> str:
        return f"{1e3 * figures[name]['value']:.3g}"

    return (
        f"mean {mm('deviation_mean')} mm, RMS {mm('deviation_rms')} mm, "
        f"95 % within {mm('deviation_95')} mm, largest {mm('deviation_max')} mm; "
        f"{100 * figures['within_tolerance']['value']:.0f} % within {1e3 * tolerance:.3g} mm, "
        f"{100 * figures['coverage']['value']:.0f} % of the surface seen"
    )


def _scale(values: list[Vector], display: Display) -> ColourScale:
    """Colours as far below zero as above, or what was set by hand."""
    if not display.automatic:
        return ColourScale(
            display.low, display.high, False, display.palette, "Deviation, outward", "mm"
        )
    known = np.abs(np.concatenate([one[np.isfinite(one)] for one in values]))
    most = max(float(np.percentile(known, _PEAK)) if known.size else 0.0, _LEAST)
    most = float(f"{most:.1g}") if float(f"{most:.1g}") >= most else float(f"{1.3 * most:.1g}")
    return ColourScale(-most, most, False, display.palette, "Deviation, outward", "mm")


def _meant(layers: LayerTable, design: LayerTable, name: str) -> tuple[float, str]:
    """What the design has, or the mean of what was found, and how to say which."""
    known = getattr(design, name)
    if np.isfinite(known).any():
        return float(np.nanmean(known)), "less the design's"
    return float(np.nanmean(getattr(layers, name))), "less the mean"
