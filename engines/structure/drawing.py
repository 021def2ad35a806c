"""Pictures of a sized structure: its members by utilisation, material and height, and its mass."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from ..core.colour import ColourScale, Display
from ..core.scene import Vector
from .sheet import FAILING, Colour, bars, save_page, sheet
from .sized import Sized

MATERIALS: dict[str, Colour] = {"steel": (0, 90, 160), "timber": (217, 137, 45)}
_FINE = 3  # a view is drawn this much larger and then reduced
_LONGER = 1100  # pixels, the longer side of a view
_ROOM = 12  # pixels around a view
_LEAST, _MOST = 1.2, 7.0  # pixels, how thick the lowest and the highest sections are drawn
_FROM = np.array([-0.55, -1.0, 0.62])  # where the axonometric view looks from

Colours = NDArray[np.uint8]


def draw(result: Sized, folder: Path, display: Display) -> list[str]:
    """Write utilisation.png, material.png, height.png, plan.png or elevation.png, and mass.png.

    Utilisation is on a linear scale to 1, whatever ``display`` says, and what fails is red. Returns
    the files' names. Raises FileError where they cannot be written.
    """
    rows, ends = result.rows, result.model.frame.ends()
    failing = rows["failing"]
    used = ColourScale(0.0, 1.0, False, display.palette, "Utilisation", "")
    high = ColourScale.automatic(rows["height"], False, display.palette, "Height", "m")
    by_use = _marked(used.colours(np.minimum(rows["utilisation"], 1.0)), failing)
    by_height = _marked(high.colours(rows["height"]), failing)
    by_material = np.array([MATERIALS[str(name)] for name in rows["material"]], dtype=np.uint8)
    by_material = _marked(by_material, failing)
    failed = {"fails": FAILING} if failing.any() else {}
    present = {str(name): MATERIALS[str(name)] for name in np.unique(rows["material"])} | failed

    size = np.ptp(ends.reshape(-1, 3), axis=0)
    tall = size[2] > max(size[0], size[1])
    square = "elevation" if tall else "plan"
    axonometric = projected(ends, _FROM)
    along = projected(ends, np.array([0.0, -1.0, 0.0]) if tall else np.array([0.0, 0.0, 1.0]))
    pictures = {
        "utilisation": (axonometric, by_use, used, failed, "Utilisation"),
        "material": (axonometric, by_material, None, present, "Material"),
        "height": (axonometric, by_height, high, failed, "Section height"),
        square: (along, by_height, high, failed, f"Section height, {square}"),
    }
    for name, (lines, colours, scale, key, title) in pictures.items():
        view = lines_image(lines, colours, rows["height"])
        save_page(sheet(view, scale, key, title, summary(result)), folder / f"{name}.png")
    save_page(mass_bars(result), folder / "mass.png")
    return [*(f"{name}.png" for name in pictures), "mass.png"]


def summary(result: Sized) -> str:
    """The line below a picture: mass, energy, use, deflection and convergence."""
    figures = {name: figure["value"] for name, figure in result.figures().items()}
    parts = [
        f"{figures['mass'] / 1e3:.4g} t",
        f"{figures['embodied_energy']:.4g} GJ",
        f"utilisation at most {figures['max_utilisation']:.3g}",
        f"displacement at most {1e3 * figures['max_displacement']:.3g} mm",
    ]
    if figures["failing"]:
        parts.append(f"{figures['failing']:.0f} of {figures['members']:.0f} members fail")
    converged = "converged" if figures["converged"] else "not converged"
    parts.append(f"{converged} in {figures['rounds']:.0f} rounds")
    return ", ".join(parts)


def projected(points: Vector, toward: Vector) -> Vector:
    """Points (..., 3) as seen from the direction ``toward`` (3,): right, up and towards the eye.

    A parallel projection with z up; seen from above, y is up.
    """
    eye = toward / np.linalg.norm(toward)
    up = np.array([0.0, 1.0, 0.0]) if abs(eye[2]) > 1 - 1e-9 else np.array([0.0, 0.0, 1.0])
    right = np.cross(up, eye)
    right /= np.linalg.norm(right)
    return points @ np.stack([right, np.cross(eye, right), eye], axis=1)


def lines_image(lines: Vector, colours: Colours, heights: Vector) -> Image.Image:
    """Lines (M, 2, 3) as `projected`, in ``colours`` (M, 3), the nearest above the others.

    The higher a member's section, of ``heights`` (M,), the thicker its line.
    """
    flat = lines[..., :2]
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    scale = _FINE * (_LONGER - 2 * _ROOM) / max(*(high - low), 1e-9)
    size = np.ceil(scale * (high - low)).astype(int) + 2 * _FINE * _ROOM
    at = (flat - low) * scale + _FINE * _ROOM
    at[..., 1] = size[1] - at[..., 1]
    thick = _FINE * (_LEAST + (_MOST - _LEAST) * heights / max(heights.max(), 1e-9))
    page = Image.new("RGB", (int(size[0]), int(size[1])), (255, 255, 255))
    pen = ImageDraw.Draw(page)
    for index in np.argsort(lines[..., 2].mean(axis=1), kind="stable"):
        (x, y), (to_x, to_y) = at[index].tolist()
        red, green, blue = colours[index].tolist()
        pen.line((x, y, to_x, to_y), (red, green, blue), round(float(thick[index])))
    return page.reduce(_FINE)


def mass_bars(result: Sized) -> Image.Image:
    """The mass of each group of members, by material."""
    rows = result.rows
    parts: dict[str, Mapping[Colour, float]] = {}
    for number, name in enumerate(result.model.group_names):
        of_group = rows[rows["group"] == number]
        if len(of_group):
            parts[name] = {
                colour: float(of_group["mass"][of_group["material"] == material].sum()) / 1e3
                for material, colour in MATERIALS.items()
            }
    key = {str(name): MATERIALS[str(name)] for name in np.unique(rows["material"])}
    return bars(parts, key, "Mass in t by group and material")


def _marked(colours: Colours, failing: NDArray[np.bool_]) -> Colours:
    """Colours (M, 3) with those of the failing members red."""
    colours = colours.copy()
    colours[failing] = FAILING
    return colours
