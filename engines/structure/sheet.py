"""A page with a drawing, its legend or key, title and note; and bars with their numbers."""

import textwrap
from collections.abc import Mapping
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from ..core.colour import ColourScale
from ..core.files import written
from ..core.picture import legend_image

Colour = tuple[int, int, int]

FAILING: Colour = (214, 39, 40)
_PAPER, _INK, _QUIET = (255, 255, 255), (28, 32, 36), (96, 103, 110)
_TITLE, _TEXT = 26, 18  # pixels
_GAP = 24
_LEGEND = 540  # pixels, how high a legend is
_NARROWEST = 640  # pixels that a view takes with its margin
_BARS, _LABEL, _ROW = 900, 200, 40  # pixels: width, room for the names, height of a bar


def sheet(
    view: Image.Image, scale: ColourScale | None, key: Mapping[str, Colour], title: str, note: str
) -> Image.Image:
    """A view with the legend of ``scale`` and the ``key`` of colours to its right."""
    side = _side(scale, key)
    letters = int(max(view.width, _NARROWEST) / (0.52 * _TEXT))
    lines = textwrap.wrap(note, letters)
    head = _GAP + _TITLE + _GAP // 2
    width = max(view.width, _NARROWEST) + side.width + 3 * _GAP
    height = head + max(view.height, side.height) + (len(lines) + 1) * (_TEXT + 6) + _GAP
    page = Image.new("RGB", (width, height), _PAPER)
    pen = ImageDraw.Draw(page)
    pen.text((_GAP, _GAP), title, _INK, _font(_TITLE))
    page.paste(view, (_GAP, head))
    page.paste(side, (width - side.width - _GAP, head))
    for number, line in enumerate(lines):
        below = head + max(view.height, side.height) + _GAP // 2 + number * (_TEXT + 6)
        pen.text((_GAP, below), line, _QUIET, _font(_TEXT))
    return page


def _side(scale: ColourScale | None, key: Mapping[str, Colour]) -> Image.Image:
    legend = None if scale is None else Image.fromarray(legend_image(scale, _LEGEND))
    top = 0 if legend is None else legend.height + _GAP
    width = max([0 if legend is None else legend.width, *(40 + 11 * len(name) for name in key)])
    page = Image.new("RGB", (width, max(1, top + 30 * len(key))), _PAPER)
    if legend is not None:
        page.paste(legend, (0, 0))
    pen = ImageDraw.Draw(page)
    for number, (name, colour) in enumerate(key.items()):
        y = top + 30 * number
        pen.rectangle((0, y, 22, y + 18), colour)
        pen.text((32, y), name, _INK, _font(_TEXT))
    return page


def bars(
    parts: Mapping[str, Mapping[Colour, float]], key: Mapping[str, Colour], title: str
) -> Image.Image:
    """A bar for each of ``parts``, of stretches in their colours, with its sum at the end."""
    head = _GAP + _TITLE + 2 * _GAP
    page = Image.new("RGB", (_BARS, head + len(parts) * _ROW + _GAP), _PAPER)
    pen = ImageDraw.Draw(page)
    pen.text((_GAP, _GAP), title, _INK, _font(_TITLE))
    x = _GAP
    for name, colour in key.items():
        pen.rectangle((x, head - 26, x + 16, head - 12), colour)
        pen.text((x + 24, head - 30), name, _INK, _font(_TEXT))
        x += 60 + 11 * len(name)
    most = max([sum(stretches.values()) for stretches in parts.values()], default=0.0) or 1.0
    room = _BARS - _LABEL - 130
    for number, (name, stretches) in enumerate(parts.items()):
        middle = head + number * _ROW + _ROW // 2
        pen.text((_LABEL - 12, middle), name, _INK, _font(_TEXT), anchor="rm")
        left = float(_LABEL)
        for colour, value in stretches.items():
            right = left + room * value / most
            if value > 0:
                pen.rectangle((left, middle - 12, right, middle + 12), colour)
            left = right
        text = f"{sum(stretches.values()):.4g}"
        pen.text((left + 12, middle), text, _QUIET, _font(_TEXT), anchor="lm")
    return page


def save_page(page: Image.Image, path: Path) -> None:
    """Write a page as PNG. Raises FileError where it cannot be written."""
    with written(path) as temporary:
        page.save(temporary, format="PNG", compress_level=6)


def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)
