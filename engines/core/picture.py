"""Pictures for people: false-colour maps with a legend, and section profiles."""

import functools
import textwrap
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFont
from PIL.PngImagePlugin import PngInfo

from .colour import NO_VALUE, Axis, ColourScale, to_srgb
from .files import written

Curve = tuple[str, ArrayLike, ArrayLike | None, ArrayLike | None]
"""A label, values (N,), and the ends (N,) of their interval or None for no band."""

Colour = tuple[int, int, int]

_PAPER = (255, 255, 255)
_INK = (28, 32, 36)
_QUIET = (96, 103, 110)
_RULE = (228, 231, 234)
_CURVES: tuple[Colour, ...] = (  # told apart by the colour-blind [Okabe & Ito 2008]
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (230, 159, 0),
    (86, 180, 233),
)
_BAND_OPACITY = 56  # of 255
_FACES = (
    "Inter-Regular.ttf",
    "NotoSans-Regular.ttf",
    "DejaVuSans.ttf",
    "segoeui.ttf",
    "Arial.ttf",
    "LiberationSans-Regular.ttf",
)
_LAST_FACE = "Aileron"  # the one that Pillow brings, of few characters
_SMALLEST = 512  # pixels; smaller maps are enlarged
_FINE = 3  # a section is drawn this much larger and then reduced
_SECTION = (1200, 640)  # pixels
_PLOTTED_DECADES = 4  # that a logarithmic section shows at most


def false_colour_png(
    path: Path | str, values: NDArray[np.floating], scale: ColourScale, title: str, note: str
) -> None:
    """Write ``values`` (H, W), row 0 at the bottom, in false colour with title, legend and note.

    A map smaller than 512 texels shows each as a square of pixels. ``note`` is the line below,
    for the error figure; title and note may be empty, and wrap where they are long.

    Raises FileError where the file cannot be written.
    """
    picture = _enlarged(scale.colours(values[::-1]))
    size = _letter(picture)
    legend = _legend(scale, max(picture.height, 14 * size) + size // 2, size)
    save_picture(_sheet(picture, legend, title, note), path, title)


def colour_png(path: Path | str, light: NDArray[np.floating], title: str, note: str) -> None:
    """Write ``light`` (H, W, 3), linear Rec. 709, row 0 at the bottom, as an eye would see it.

    Toned as `toned`; otherwise as `false_colour_png`. Raises FileError likewise.
    """
    picture = _enlarged(toned(light[::-1], white_of(light)))
    save_picture(_sheet(picture, _blank(1, 1), title, note), path, title)


def white_of(light: NDArray[np.floating]) -> float:
    """What of ``light`` (..., 3) is shown white: all but the brightest 0.5 % are below it.

    NaN does not count; 1 where there is no light.
    """
    brightest = light.max(axis=-1)
    known = brightest[np.isfinite(brightest)]
    return float(np.quantile(known, 0.995)) or 1.0 if known.size else 1.0


def toned(light: NDArray[np.floating], white: float) -> NDArray[np.uint8]:
    """The sRGB colours (..., 3) of ``light`` (..., 3), linear Rec. 709, grey for NaN."""
    colours = (255 * to_srgb(np.nan_to_num(light / white)) + 0.5).astype(np.uint8)
    colours[np.isnan(light).any(axis=-1)] = NO_VALUE
    return colours


def _enlarged(colours: NDArray[np.uint8]) -> Image.Image:
    """A map's texels (H, W, 3) as an image, each as a square of pixels where they are few."""
    factor = -(-_SMALLEST // max(colours.shape[:2]))
    texels = Image.fromarray(colours)
    return texels.resize((texels.width * factor, texels.height * factor), Image.Resampling.NEAREST)


def _letter(picture: Image.Image) -> int:
    """The size of the letters beside a picture in pixels."""
    return max(15, min(picture.size) // 32)


def _sheet(picture: Image.Image, legend: Image.Image, title: str, note: str) -> Image.Image:
    """A picture with its legend to the right, the title above and the note below."""
    size = _letter(picture)
    gap = 3 * size // 2
    width = picture.width + gap + legend.width
    heading = _Text.fitted(title, 4 * size // 3, _INK, width)
    footing = _Text.fitted(note, size, _QUIET, picture.width)

    top = gap + heading.height + (gap // 2 if title else 0)
    below = top + picture.height + gap // 2
    page = _blank(width + 2 * gap, max(below + footing.height, top + legend.height) + gap)
    draw = ImageDraw.Draw(page)
    heading.draw(draw, gap, gap)
    page.paste(picture, (gap, top))
    page.paste(legend, (gap + picture.width + gap, top))
    footing.draw(draw, gap, below)
    return page


def legend_image(scale: ColourScale, height: int) -> NDArray[np.uint8]:
    """The legend alone, dark on white: sRGB (height, W, 3), the first row at the top.

    ``height`` is in pixels, 120 at least.
    """
    return np.asarray(_legend(scale, height, max(12, height // 32)))


def _legend(scale: ColourScale, height: int, size: int) -> Image.Image:
    """Quantity and unit above a bar of the palette, with labelled ticks to its right."""
    font = font_of(size)
    heading = _Text([scale.quantity, scale.unit], size, _INK)
    top, bottom = heading.height + size, height - size // 2 - 1
    ticks = scale.ticks(max(2, min(8, (bottom - top) // (2 * size))))
    bar = 5 * size // 4
    tick = size // 3
    stroke = max(1, size // 14)
    label = bar + tick + size // 3
    width = max(heading.width, label + max(_width(text, font) for _, text in ticks))

    legend = _blank(width, height)
    draw = ImageDraw.Draw(legend)
    heading.draw(draw, 0, 0)
    shades = np.linspace(255.5, 0.0, bottom - top).astype(int)
    strip = np.repeat(scale.table()[shades][:, None], bar, axis=1)
    legend.paste(Image.fromarray(strip), (0, top))
    for position, text in ticks:
        y = bottom - round(position * (bottom - top))
        draw.line([(bar, y), (bar + tick, y)], _QUIET, stroke)
        draw.text((label, y), drawable(text), _INK, font, anchor="lm")
    return legend


def section_png(
    path: Path | str,
    distance: ArrayLike,
    curves: Sequence[Curve],
    quantity: str,
    unit: str,
    log: bool,
    across: str = "Distance (m)",
) -> None:
    """Write the profile of a quantity along a section, a line a curve with its interval as a band.

    ``distance`` (N,), rising, two points at least, is what ``across`` names with its unit. NaN
    leaves a gap. A logarithmic plot shows the top four decades; what lies below runs along its
    foot. Colours repeat after six curves.

    Raises FileError where the file cannot be written.
    """
    along = np.asarray(distance, dtype=float)
    drawn = [_Drawn.of(*curve) for curve in curves]
    width, height = (_FINE * side for side in _SECTION)
    size = _FINE * 17
    gap = 3 * size // 2
    page = _blank(width, height)
    draw = ImageDraw.Draw(page, "RGBA")
    heading = _Text([f"{quantity} ({unit})"], size, _INK)
    heading.draw(draw, gap, gap)
    labels = [curve.label for curve in drawn]
    key = _draw_key(draw, labels, size, gap, gap + heading.height + size // 3, width - gap)

    x_axis, y_axis = Axis(along[0], along[-1], False), _value_axis(drawn, log)
    font = font_of(size)
    widest = max(_width(text, font) for _, text in y_axis.ticks())
    frame = _Frame(
        left=gap + widest + size // 2,
        top=key + size,
        right=width - 2 * gap,
        bottom=height - gap - 3 * size,
        x_axis=x_axis,
        y_axis=y_axis,
    )
    _draw_grid(draw, frame, size)
    _Text([across], size, _INK).draw(draw, frame.right, height - gap - size, anchor="ra")
    for index, curve in enumerate(drawn):
        for run in _runs(*curve.band):
            lower, upper = (frame.points(along[run], end[run]) for end in curve.band)
            draw.polygon(lower + upper[::-1], (*_colour(index), _BAND_OPACITY))
    for index, curve in enumerate(drawn):
        for run in _runs(curve.values):
            points = frame.points(along[run], curve.values[run])
            draw.line(points, _colour(index), 2 * _FINE, "curve")
    save_picture(page.reduce(_FINE), path, quantity)


@dataclass(frozen=True, slots=True)
class _Drawn:
    """A curve in arrays (N,), its ``band`` the lower and upper end of the interval or empty."""

    label: str
    values: NDArray[np.float64]
    band: tuple[NDArray[np.float64], ...]

    @classmethod
    def of(
        cls, label: str, values: ArrayLike, lower: ArrayLike | None, upper: ArrayLike | None
    ) -> "_Drawn":
        ends = () if lower is None or upper is None else (lower, upper)
        band = tuple(np.asarray(end, dtype=float) for end in ends)
        return cls(label, np.asarray(values, dtype=float), band)


@dataclass(frozen=True, slots=True)
class _Frame:
    """Where the plot lies on the page, in pixels, and what its axes are."""

    left: int
    top: int
    right: int
    bottom: int
    x_axis: Axis
    y_axis: Axis

    def x(self, position: float) -> float:
        return self.left + position * (self.right - self.left)

    def y(self, position: float) -> float:
        return self.bottom - position * (self.bottom - self.top)

    def points(self, along: ArrayLike, values: ArrayLike) -> list[tuple[float, float]]:
        across, up = self.x_axis.position(along), self.y_axis.position(values)
        return [(self.x(u), self.y(v)) for u, v in zip(across.tolist(), up.tolist(), strict=True)]


def _value_axis(drawn: Sequence[_Drawn], log: bool) -> Axis:
    """The range of every value and interval; an interval alone does not take it below zero."""
    data = np.concatenate([part for curve in drawn for part in (curve.values, *curve.band)])
    data = data[np.isfinite(data) & ((data > 0) | (not log))]
    high = data.max(initial=0.0)
    if log:
        high = high or 1.0
        low = max(data.min(initial=high), high / 10**_PLOTTED_DECADES)
        return Axis(low / 1.2, high * 1.2, True)
    low = min(c.values[np.isfinite(c.values)].min(initial=0.0) for c in drawn)
    if low == high:
        return Axis(0.0, 1.0, False)
    room = 0.05 * (high - low)
    return Axis(low - room if low < 0 else 0.0, high + room, False)


def _draw_grid(draw: ImageDraw.ImageDraw, frame: _Frame, size: int) -> None:
    """Grid lines with their labels, and the foot of the plot."""
    font = font_of(size)
    for position, text in frame.y_axis.ticks():
        y = frame.y(position)
        draw.line([(frame.left, y), (frame.right, y)], _RULE, _FINE)
        draw.text((frame.left - size // 2, y), drawable(text), _QUIET, font, anchor="rm")
    for position, text in frame.x_axis.ticks(10):
        x = frame.x(position)
        draw.line([(x, frame.top), (x, frame.bottom)], _RULE, _FINE)
        draw.text((x, frame.bottom + size // 2), drawable(text), _QUIET, font, anchor="ma")
    draw.line([(frame.left, frame.bottom), (frame.right, frame.bottom)], _QUIET, _FINE)


def _draw_key(
    draw: ImageDraw.ImageDraw, labels: Sequence[str], size: int, left: int, top: int, right: int
) -> int:
    """A dash and a label a curve, in rows from ``left`` to ``right``; returns where they end."""
    font, dash, row = font_of(size), 2 * size, 3 * size // 2
    x = left
    for index, label in enumerate(labels):
        wide = dash + size // 2 + _width(label, font)
        if x > left and x + wide > right:
            x, top = left, top + row
        draw.line([(x, top + row // 2), (x + dash, top + row // 2)], _colour(index), 3 * _FINE)
        at = (x + dash + size // 2, top + row // 2)
        draw.text(at, drawable(label), _INK, font, anchor="lm")
        x += wide + 2 * size
    return top + row


def _colour(index: int) -> Colour:
    return _CURVES[index % len(_CURVES)]


def _runs(*arrays: NDArray[np.float64]) -> Iterator[slice]:
    """The stretches over which every array is a number."""
    whole = np.isfinite(arrays).all(axis=0) if arrays else np.zeros(0, dtype=bool)
    ends = np.flatnonzero(np.diff(whole, prepend=False, append=False))
    yield from (slice(first, last) for first, last in ends.reshape(-1, 2).tolist())


@dataclass(frozen=True, slots=True)
class _Text:
    """Lines of text in one size and colour."""

    lines: list[str]
    size: int
    colour: Colour

    @classmethod
    def fitted(cls, text: str, size: int, colour: Colour, width: int) -> "_Text":
        """``text`` broken into lines of about ``width`` pixels."""
        full = max(1, _width(text, font_of(size)))
        return cls(textwrap.wrap(text, max(8, int(len(text) * width / full))), size, colour)

    @property
    def width(self) -> int:
        return max(_width(line, font_of(self.size)) for line in self.lines)

    @property
    def height(self) -> int:
        return len(self.lines) * self._pitch

    @property
    def _pitch(self) -> int:
        return 4 * self.size // 3

    def draw(self, draw: ImageDraw.ImageDraw, x: float, y: float, anchor: str = "la") -> None:
        """Put the first line at ``x``, ``y``."""
        for number, line in enumerate(self.lines):
            at = (x, y + number * self._pitch)
            draw.text(at, drawable(line), self.colour, font_of(self.size), anchor=anchor)


@functools.cache
def font_of(size: int) -> ImageFont.FreeTypeFont:
    """The best face on this machine, else the one that Pillow brings."""
    for face in _FACES:
        try:
            return ImageFont.truetype(face, size)
        except OSError:
            continue
    return cast(ImageFont.FreeTypeFont, ImageFont.load_default(size))


def drawable(text: str) -> str:
    """``text``, or what of it Pillow's own face can draw: m² → m2, ä → a, − → -, 漢 → ?."""
    if font_of(12).getname()[0] != _LAST_FACE:
        return text
    parts = unicodedata.normalize("NFKD", text.translate({ord("−"): "-", ord("–"): "-"}))
    letters = (c for c in parts if not unicodedata.combining(c))
    return "".join(c if c.isascii() or c in "±°·“”" else "?" for c in letters)


def _width(text: str, font: ImageFont.FreeTypeFont) -> int:
    return int(font.getlength(drawable(text)) + 1)


def _blank(width: int, height: int) -> Image.Image:
    return Image.new("RGB", (width, height), _PAPER)


def save_picture(page: Image.Image, path: Path | str, title: str) -> None:
    """Write a picture as PNG, which says its ``title`` itself.

    Raises FileError where the file cannot be written.
    """
    said = PngInfo()
    if title:
        said.add_itxt("Title", title)
    with written(path) as temporary:
        page.save(temporary, format="PNG", compress_level=3, pnginfo=said)
