"""False colour: which colour a value has, and what the legend beside it says.

The same `ColourScale` colours the image, the legend, the overlay and the report.
"""

import functools
import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import ParameterError
from .parameters import param

Palette = Literal["viridis", "radiance"]

_STEPS = 1024
NO_VALUE = (150, 150, 150)
"""The grey of what has no value."""
_PEAK = 99.5  # percentile of the lit values that the automatic range reaches to
_DECADES = 3  # that an automatic logarithmic range spans at most
_THIN_SPACE = "\u2009"

# Every seventeenth of the 256 colours of viridis, sRGB [van der Walt & Smith 2015, CC0].
_VIRIDIS = (
    "440154 481a6c 472f7d 414487 39568c 31688e 2a788e 23888e "
    "1f988b 22a884 35b779 54c568 7ad151 a5db36 d2e21b fde725"
)

# From linear sRGB to cone responses, and from their cube roots to OKLab [Ottosson 2020].
_CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_OKLAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


def to_oklab(srgb: ArrayLike) -> NDArray[np.float64]:
    """OKLab lightness, green–red and blue–yellow (..., 3) of sRGB colours (..., 3) in 0..1."""
    srgb = np.asarray(srgb, dtype=float)
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    return np.cbrt(linear @ _CONES.T) @ _OKLAB.T


def from_oklab(lab: ArrayLike) -> NDArray[np.float64]:
    """The sRGB colours (..., 3) in 0..1 that `to_oklab` takes to ``lab``, clipped to the gamut."""
    cones = (np.asarray(lab, dtype=float) @ np.linalg.inv(_OKLAB).T) ** 3
    return to_srgb(cones @ np.linalg.inv(_CONES).T)


def to_srgb(linear: ArrayLike) -> NDArray[np.float64]:
    """sRGB values in 0..1 of linear light, clipped to 0..1."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


@dataclass(frozen=True, slots=True)
class Axis:
    """A range of values, laid out evenly or, with ``log``, in even decades.

    Raises ParameterError when the range is empty, or a logarithmic one starts at or below zero.
    """

    low: float
    high: float
    log: bool

    def __post_init__(self) -> None:
        if not self.low < self.high:
            raise ParameterError(
                f"The scale runs from {self.low:g} to {self.high:g}; "
                "set its low end below its high end."
            )
        if self.log and self.low <= 0:
            raise ParameterError(
                f"A logarithmic scale cannot start at {self.low:g}; "
                "set its low end above zero, or switch log off."
            )

    def position(self, values: ArrayLike) -> Any:
        """Where ``values`` lie, 0 at the low end and 1 at the high end and beyond; NaN stays NaN.

        In the shape of ``values``; float32 in gives float32, anything else float64.
        """
        values = np.asarray(values)
        if values.dtype != np.float32:
            values = values.astype(np.float64)
        values = np.clip(values, self.low, self.high)
        if self.log:
            # The base of the logarithm cancels; log2 is the quick one.
            low, high = math.log2(self.low), math.log2(self.high)
            return np.clip((np.log2(values) - low) * (1 / (high - low)), 0.0, 1.0)
        return np.clip((values - self.low) * (1 / (self.high - self.low)), 0.0, 1.0)

    def ticks(self, most: int = 8) -> list[tuple[float, str]]:
        """At most ``most`` round numbers in the range: each one's position, 0..1, and label."""
        values = _decade_ticks(self.low, self.high, most) if self.log else []
        if len(values) >= min(3, most):
            return [(float(self.position(v)), _label(v, _decimals(v))) for v in values]
        values, decimals = _even_ticks(self.low, self.high, most)
        return [(float(self.position(v)), _label(v, decimals)) for v in values]


def _even_ticks(low: float, high: float, most: int) -> tuple[list[float], int]:
    """Multiples of 1, 2 or 5 times a power of ten, and the decimals that they need."""
    coarsest = math.ceil(math.log10(high - low))
    for decade in range(coarsest - math.ceil(math.log10(most)) - 1, coarsest + 1):
        for step in (1, 2, 5):
            size = step * 10.0**decade
            first, last = math.ceil(low / size - 1e-6), math.floor(high / size + 1e-6)
            if last - first < most:
                return [k * size for k in range(first, last + 1)], max(0, -decade)
    raise AssertionError("one step of the coarsest size spans the range")


def _decade_ticks(low: float, high: float, most: int) -> list[float]:
    """Powers of ten in the range, with as many round numbers between them as there is room for."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    for between in ((1, 2, 3, 5), (1, 2, 5), (1, 3), (1,)):
        values = [m * 10.0**decade for decade in range(first, last + 1) for m in between]
        inside = [v for v in values if low * (1 - 1e-6) <= v <= high * (1 + 1e-6)]
        if len(inside) <= most:
            return inside
    return inside[:: -(-len(inside) // most)]


def _decimals(value: float) -> int:
    return max(0, -math.floor(math.log10(value) + 1e-6))


def _label(value: float, decimals: int) -> str:
    """0.5, 1200, 12 000 with a thin space, −3, 2e9."""
    size = abs(value)
    if size < 1e-12 * 10.0**-decimals or value == 0:
        return "0"
    sign = "−" if value < 0 else ""
    if not 1e-4 <= size < 1e7:
        mantissa, exponent = f"{size:.6e}".split("e")
        return f"{sign}{float(mantissa):g}e{int(exponent)}"
    grouping = "," if size >= 10_000 else ""
    return sign + f"{size:{grouping}.{decimals}f}".replace(",", _THIN_SPACE)


@dataclass(frozen=True, slots=True)
class ColourScale(Axis):
    """The range of a quantity and the palette it is drawn with."""

    palette: Palette
    quantity: str
    unit: str

    @classmethod
    def automatic(
        cls, values: ArrayLike, log: bool, palette: Palette, quantity: str, unit: str
    ) -> "ColourScale":
        """The scale that suits ``values``, of any shape.

        Linear from zero to the 99.5th percentile of the positive values, rounded up to two
        digits (and down to that of the negative ones, where there are any); logarithmic over one
        to three decades below it. NaN and infinities do not count. Without any value but zero it
        reaches to 1.
        """
        values = np.asarray(values)
        lit = values[np.isfinite(values) & (values > 0)]
        high = _two_digits(np.percentile(lit, _PEAK), math.ceil) if lit.size else 0.0
        if log:
            high = high or 1.0
            low = _two_digits(np.percentile(lit, 100 - _PEAK), math.floor) if lit.size else 0.0
            low = min(max(low, high / 10**_DECADES), high / 10)
        else:
            below = -values[np.isfinite(values) & (values < 0)]
            low = -_two_digits(np.percentile(below, _PEAK), math.ceil) if below.size else 0.0
            high = high if low < high else 1.0
        return cls(low, high, log, palette, quantity, unit)

    def colours(self, values: ArrayLike) -> NDArray[np.uint8]:
        """The sRGB colours (..., 3) of ``values`` (...): ends beyond the range, grey for NaN."""
        position = self.position(values)
        index = np.where(np.isnan(position), _STEPS, position * (_STEPS - 1) + 0.5)
        return np.take(_lookup(self.palette), index.astype(np.int32), axis=0, mode="clip")

    def table(self) -> NDArray[np.uint8]:
        """The palette as 256 sRGB colours (256, 3), the low end first."""
        return _bytes(_PALETTES[self.palette](np.linspace(0.0, 1.0, 256)))


def _two_digits(value: float, towards: Any) -> float:
    """A positive ``value`` rounded to two digits by math.ceil or math.floor."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{towards(round(value / step, 4)) * step:.2g}")


def _viridis(position: NDArray[np.float64]) -> NDArray[np.float64]:
    anchors = np.array([list(bytes.fromhex(colour)) for colour in _VIRIDIS.split()]) / 255
    places = np.linspace(0.0, 1.0, len(anchors))
    lab = [np.interp(position, places, channel) for channel in to_oklab(anchors).T]
    return from_oklab(np.stack(lab, axis=-1))


def _radiance(position: NDArray[np.float64]) -> NDArray[np.float64]:
    """The "spec" palette of Radiance's falsecolor [Ward 1994].

    Its formula gives linear light, as Radiance pictures hold it; here it is encoded for a screen.
    """
    red = 1.6 * position - 0.6
    green = np.where(position < 0.375, 8 / 3 * position, 1.6 - 1.6 * position)
    blue = 1 - 8 / 3 * position
    return to_srgb(np.stack([red, green, blue], axis=-1))


_PALETTES = {"viridis": _viridis, "radiance": _radiance}


@functools.cache
def _lookup(palette: Palette) -> NDArray[np.uint8]:
    """The palette finely, and after it the colour of no value."""
    return np.vstack([_bytes(_PALETTES[palette](np.linspace(0.0, 1.0, _STEPS))), NO_VALUE]).astype(
        np.uint8
    )


def _bytes(srgb: NDArray[np.float64]) -> NDArray[np.uint8]:
    return (srgb * 255 + 0.5).astype(np.uint8)


@dataclass(frozen=True, slots=True, kw_only=True)
class Display:
    """How a result is shown in false colour."""

    palette: Literal["viridis", "radiance"] = param(
        "viridis", help="Even and safe for the colour-blind, or that of Radiance's falsecolor"
    )
    log: bool = param(True, help="Space the colours evenly over decades, as caustics need")
    automatic: bool = param(True, help="Take the range from the result")
    low: float = param(0.0, "", help="Value of the first colour; on a log scale 0 is high / 1000")
    high: float = param(1000.0, "", help="Value of the last colour")


def scale_for(values: ArrayLike, display: Display, quantity: str, unit: str) -> ColourScale:
    """The scale that ``display`` asks for, for ``values`` of any shape.

    Raises ParameterError when the range is set by hand and is empty.
    """
    if display.automatic:
        return ColourScale.automatic(values, display.log, display.palette, quantity, unit)
    low = display.low
    if display.log and low == 0:
        low = display.high / 10**_DECADES
    return ColourScale(low, display.high, display.log, display.palette, quantity, unit)
