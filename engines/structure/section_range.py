"""The thesis's families of sections: boxes of steel and boards of timber over a range of sizes."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.errors import ParameterError
from ..core.parameters import param
from ..core.scene import Vector
from .family import Family, by_area
from .grade import grades
from .sections import rectangle, rectangular_hollow

_MOST = 50_000


@dataclass(frozen=True, slots=True, kw_only=True)
class SectionRange:
    """Sizes to choose from: hollow boxes, the thesis's of steel unless said otherwise."""

    height_low: float = param(0.05, "m", 0.005, 5.0, "Smallest height")
    height_high: float = param(2.0, "m", 0.005, 5.0, "Greatest height")
    width_low: float = param(0.05, "m", 0.005, 2.0, "Smallest width")
    width_high: float = param(0.2, "m", 0.005, 2.0, "Greatest width")
    step: float = param(0.05, "m", 0.001, 1.0, "From one size to the next, in height and width")
    thickness: float = param(0.01, "m", 0.0, 0.1, "Thickness of the walls; 0 is solid")


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardRange(SectionRange):
    """Sizes to choose from: solid boards, the thesis's of timber unless said otherwise."""

    height_low: float = param(0.1, "m", 0.005, 5.0, "Smallest height")
    height_high: float = param(2.0, "m", 0.005, 5.0, "Greatest height")
    width_low: float = param(0.02, "m", 0.005, 2.0, "Smallest width")
    width_high: float = param(0.1, "m", 0.005, 2.0, "Greatest width")
    step: float = param(0.02, "m", 0.001, 1.0, "From one size to the next, in height and width")
    thickness: float = param(0.0, "m", 0.0, 0.1, "Thickness of the walls; 0 is solid")


def thesis_family(
    kind: Literal["steel", "timber"],
    height_low: float,
    height_high: float,
    width_low: float,
    width_high: float,
    step: float,
    thickness: float,
) -> Family:
    """Every height with every width of a range, by area, in the thesis's material (Table 4).

    Lengths in m. Sizes start at the low bound and go up by ``step`` as far as the high one. Steel
    is boxes with sharp corners, timber solid boards; a ``thickness`` of 0 is solid, and timber is
    so whatever it says.

    Raises ParameterError where the range is none, has too many sizes, or the walls fill a box.
    """
    heights = _sizes("height", height_low, height_high, step)
    widths = _sizes("width", width_low, width_high, step)
    if len(heights) * len(widths) > _MOST:
        raise ParameterError(
            f"A range of {len(heights)} heights and {len(widths)} widths is more than {_MOST} "
            "sections; take a larger step."
        )
    height, width = (grid.ravel() for grid in np.meshgrid(heights, widths, indexing="ij"))
    if kind == "steel" and thickness > 0:
        sections = rectangular_hollow(height, width, thickness, 0.0)
    else:
        sections = rectangle(height, width)
    name = f"thesis-{kind}"
    about = "Boxes of steel" if kind == "steel" else "Boards of timber"
    return Family(name, grades()[name], by_area(sections), f"{about} as in the thesis, Table 4")


def family_of_range(kind: Literal["steel", "timber"], sizes: SectionRange) -> Family:
    """`thesis_family` of a record."""
    return thesis_family(
        kind,
        sizes.height_low,
        sizes.height_high,
        sizes.width_low,
        sizes.width_high,
        sizes.step,
        sizes.thickness,
    )


def _sizes(what: str, low: float, high: float, step: float) -> Vector:
    if not 0 < low <= high:
        raise ParameterError(
            f"A {what} range from {low:g} to {high:g} m holds no section; make the smallest the "
            "smaller one, above 0."
        )
    if not step > 0:
        raise ParameterError(f"A step of {step:g} m leads nowhere; make it larger than 0.")
    count = int(min((high - low) / step + 1e-6, _MOST)) + 1
    return np.asarray(np.round(low + step * np.arange(count), 9), dtype=np.float64)
