"""The pictures of an irradiance map: false colours with a legend, and the section along u."""

from pathlib import Path

from ..core.colour import Display, scale_for
from ..core.picture import false_colour_png
from .irradiance import IrradianceMap
from .section import section


def draw(result: IrradianceMap, folder: Path, display: Display) -> list[str]:
    """Write illuminance.png, smooth.png, caustic.png where there is any, section.png and .csv.

    Returns their names. Raises FileError where they cannot be written.
    """
    note = summary(result)
    scale = scale_for(result.illuminance, display, "Illuminance", "lx")
    title = f"{result.meta['receiver']}: illuminance"
    false_colour_png(folder / "illuminance.png", result.illuminance, scale, title, note)
    title = f"{result.meta['receiver']}: illuminance, smoothed"
    false_colour_png(folder / "smooth.png", result.smooth, scale, title, note)
    files = ["illuminance.png", "smooth.png"]
    if result.caustic.any():
        scale = scale_for(result.caustic, display, "Caustic illuminance", "lx")
        title = f"{result.meta['receiver']}: light through glass and from mirrors"
        false_colour_png(folder / "caustic.png", result.caustic, scale, title, note)
        files.append("caustic.png")
    profile = section(result)
    profile.save_png(folder / "section.png", display.log)
    profile.save_csv(folder / "section.csv")
    return [*files, "section.png", "section.csv"]


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
