"""The pictures of a print library: a sheet of accepted outlines, and the reasons as bars."""

from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ..core.colour import Display
from ..core.files import written
from ..core.parameters import from_table
from ..core.scene import Vector
from .candidates import WHERE, PrintLibrary, wall_of
from .fourier import Plan
from .judging import ACCEPTED, plan_of
from .library import Library
from .loft import wall_loft

_SHEET = 8, 5  # outlines across and down
_CELL, _CAPTION = 180, 34  # pixels
_FINE = 3  # drawn this much larger and then reduced
_AROUND = 512
_PAPER, _INK, _QUIET = (255, 255, 255), (28, 32, 36), (96, 103, 110)
_GLASS, _REFUSED, _KEPT = (86, 150, 190), (213, 94, 0), (0, 158, 115)
_BARS, _LABEL, _ROW = 900, 240, 34  # pixels: width, room for the names, height of a bar


def draw(result: Library, folder: Path, display: Display) -> list[str]:
    """Write reasons.png, and accepted.png where there are any; returns their names.

    Raises FileError where they cannot be written.
    """
    _save(bars(result), folder / "reasons.png")
    if not len(result.accepted):
        return ["reasons.png"]
    _save(sheet(result), folder / "accepted.png")
    return ["accepted.png", "reasons.png"]


def sheet(result: Library) -> Image.Image:
    """Some accepted walls in plan, taken evenly from all and to one scale."""
    record = from_table(PrintLibrary, result.meta["parameters"], WHERE)
    columns, rows = _SHEET
    count = min(columns * rows, len(result.accepted))
    shown = result.accepted[np.linspace(0, len(result.accepted) - 1, count).round().astype(int)]
    walls = [_faces(plan_of(row, record.radius), record) for row in shown]
    reach = max(float(np.abs(faces).max()) for faces in walls)
    rows = -(-count // columns)
    size = columns * _CELL * _FINE, rows * (_CELL + _CAPTION) * _FINE
    page = Image.new("RGB", size, _PAPER)
    pen, font = ImageDraw.Draw(page), ImageFont.load_default(11 * _FINE)
    scale = 0.46 * _CELL * _FINE / reach
    for index, (outer, inner) in enumerate(walls):
        y, x = divmod(index, columns)
        left, top = x * _CELL * _FINE, y * (_CELL + _CAPTION) * _FINE
        middle = np.array([left, top]) + _CELL * _FINE / 2
        for face, colour in ((outer, _GLASS), (inner, _PAPER)):
            pen.polygon([tuple(p) for p in middle + scale * face * (1, -1)], colour)
        for line, text in enumerate(_captions(shown[index])):
            at = middle[0], top + (_CELL + line * 14) * _FINE
            pen.text(at, text, _QUIET, font, anchor="ma")
    return page.reduce(_FINE)


def bars(result: Library) -> Image.Image:
    """How many walls are accepted, and how many rejected for which reason."""
    counts = {ACCEPTED: len(result.accepted)} | result.reasons()
    most = max(*counts.values(), 1)
    page = Image.new("RGB", (_BARS * _FINE, (len(counts) + 1) * _ROW * _FINE), _PAPER)
    pen, font = ImageDraw.Draw(page), ImageFont.load_default(15 * _FINE)
    room = (_BARS - _LABEL - 130) * _FINE
    for index, (name, count) in enumerate(counts.items()):
        middle = (index + 1) * _ROW * _FINE
        left, half = _LABEL * _FINE, 0.34 * _ROW * _FINE
        colour = _KEPT if name == ACCEPTED else _REFUSED
        right = left + room * count / most
        label = name if name == ACCEPTED else f"rejected: {name}"
        pen.text((left - 12 * _FINE, middle), label.replace("_", " "), _INK, font, anchor="rm")
        pen.rectangle((left, middle - half, right, middle + half), colour)
        share = 100 * count / max(len(result.rows), 1)
        said = f"{count:,} ({share:.3g} %)"
        pen.text((right + 8 * _FINE, middle), said, _INK, font, anchor="lm")
    return page.reduce(_FINE)


def _faces(plan: Plan, record: PrintLibrary) -> Vector:
    """Outer and inner face in plan (2, N, 2) in m."""
    place = wall_loft(wall_of(plan, record)).at(np.arange(_AROUND) / _AROUND, 0.0)
    half = np.array([record.thickness / 2, -record.thickness / 2])
    return place.points[:, :2] + half[:, None, None] * place.normal


def _captions(row: Any) -> tuple[str, str]:
    return (
        f"{row['period_1']} of {row['amplitude_1']:.3g}, {row['period_2']} of "
        f"{row['amplitude_2']:.3g}",
        f"offset {row['offset'] * 1e3:.3g} mm" + ", clipped" * bool(row["resolved"]),
    )


def _save(page: Image.Image, path: Path) -> None:
    with written(path) as temporary:
        page.save(temporary, format="PNG", compress_level=6)
