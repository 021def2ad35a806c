"""The pictures of a reading: the face laid flat, the fold, and the roughness by wavelength."""

from pathlib import Path

import numpy as np

from ..core.colour import ColourScale, Display
from ..core.picture import false_colour_png, section_png
from .result import FaceReading, Reading, named

_TALL = 512  # pixels of the fold


def draw(result: Reading, folder: Path, display: Display) -> list[str]:
    """Write the pictures of every face, see `draw_face`; returns their names.

    Raises FileError where they cannot be written.
    """
    return [name for face in result.faces for name in draw_face(result, face, folder, display)]


def draw_face(result: Reading, face: FaceReading, folder: Path, display: Display) -> list[str]:
    """Write heights.png, roughness.png, fold.png, profile.png and octaves.png of a face.

    Heights are in millimetres and their colours linear, whatever ``display`` says of scales; its
    palette counts. Returns the files' names.
    """
    files = [
        named(face.name, f"{name}.png")
        for name in ("heights", "roughness", "fold", "profile", "octaves")
    ]
    note = summary(result, face.name)
    maps = (
        (files[0], face.height, "Height over the base", "unrolled, trend taken off"),
        (files[1], face.roughness, "Height over the bead", "roughness and noise"),
    )
    for file, values, quantity, title in maps:
        shown = 1e3 * values.astype(np.float64)
        low, high = np.nanpercentile(shown, [0.5, 99.5])
        scale = ColourScale(low, max(high, low + 1e-6), False, display.palette, quantity, "mm")
        heading = f"{result.meta['scan']}: {face.name} face, {title}"
        false_colour_png(folder / file, shown, scale, heading, note)
    _draw_fold(result, face, folder / files[2], display)
    _draw_profile(result, face, folder / files[3])
    middle = np.sqrt(face.octaves["shortest"] * face.octaves["longest"])[::-1]
    curves = [
        ("Surface", 1e3 * face.octaves["signal"][::-1], None, None),
        ("Noise", 1e3 * face.octaves["noise"][::-1], None, None),
    ]
    if len(middle) > 1:
        path, quantity = folder / files[4], "RMS of an octave"
        section_png(path, 1e3 * middle, curves, quantity, "mm", True, "Wavelength (mm)")
        return files
    return files[:4]


def _draw_fold(result: Reading, face: FaceReading, path: Path, display: Display) -> None:
    """All points in one layer, by phase and height, as dense as they lie; the bead in grey."""
    counts = face.density
    rows = np.linspace(0, len(counts) - 1e-9, _TALL // 2 * 2).astype(int)
    columns = np.linspace(0, counts.shape[1] - 1e-9, 2 * _TALL).astype(int)
    shown = counts[rows][:, columns].astype(np.float64)
    height = np.interp(
        np.linspace(0, 1, shown.shape[1]),
        face.folded["phase"],
        face.folded["profile"],
        period=1.0,
    )
    level = (height - face.lowest) / (face.highest - face.lowest) * len(shown)
    bead = np.abs(np.arange(len(shown))[:, None] - level) < 1.5
    shown[bead] = np.nan
    scale = ColourScale.automatic(shown, False, display.palette, "Points", "a cell")
    reach = 1e3 * (face.highest - face.lowest)
    layer = 1e3 * result.style.height
    title = f"{face.name} face: all points in one layer, {layer:.4g} mm wide, {reach:.3g} mm high"
    false_colour_png(
        path, shown, scale, f"{result.meta['scan']}: {title}", summary(result, face.name)
    )


def _draw_profile(result: Reading, face: FaceReading, path: Path) -> None:
    order = np.argsort(face.folded["phase"])
    phase, median, error, profile = (
        face.folded[name][order] for name in ("phase", "median", "error", "profile")
    )
    curves = [
        ("Median of the points (95 %)", *(1e3 * (median + k * error) for k in (0, -1.96, 1.96))),
        ("Bead", 1e3 * profile, None, None),
    ]
    up = 1e3 * phase * result.style.height
    section_png(path, up, curves, "Height over the valley", "mm", False, "Up the layer (mm)")


def summary(result: Reading, face: str = "outer") -> str:
    """The line below a picture of a face: layer height, depth, tilt, roughness and noise."""
    figures = {name: figure["value"] for name, figure in result.figures().items()}

    def own(name: str) -> float:
        first = face == result.faces[0].name
        return figures[name if first else f"{name}_{face}"]

    return ", ".join(
        [
            f"layers of {1e3 * figures['layer_height']:.4g} mm",
            f"{1e3 * own('depth'):.3g} mm deep",
            f"tilted {figures['tilt']:z.2f}°",
            f"roughness {_microns(own('roughness'))} RMS",
            f"noise {_microns(own('noise'))}",
        ]
    )


def _microns(metres: float) -> str:
    return f"{1e6 * metres:.{0 if metres >= 1e-5 else 1}f} µm"
