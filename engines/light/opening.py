"""Luminous openings: the shapes of LM-63 as the level opening that light leaves from."""

from typing import Literal, NamedTuple

OpeningShape = Literal["round", "rectangular", "point"]


class Opening(NamedTuple):
    """A level opening, its size in the file's unit, and the solid it stands for, or ""."""

    shape: OpeningShape
    width: float
    length: float
    solid: str


def level_opening(year: int, width: float, length: float, height: float) -> Opening:
    """The opening as seen from below [ANSI/IES LM-63-19, table 1, and the editions before it].

    A negative size is that of a rounded shape. Up to 1995 a circle has no length (−d, 0, 0) and
    (−d, 0, −d) is a sphere; from 2002 on a circle is (−d, −d, 0), (−d, 0, −d) a disc that stands
    upright, and rounded sizes across a straight one are those of a lying cylinder.

    What has a height, or rounded sides, is taken as its outline seen from below: an upright
    cylinder and a sphere are round, a lying cylinder is a rectangle, an upright face a line.
    """
    w, l, h = abs(width), abs(length), abs(height)  # noqa: E741
    if width == 0 and length == 0:
        return Opening("point", 0.0, 0.0, "an upright line" if h else "")
    flat, rounded = w * l == 0, (width < 0) + (length < 0)
    if height < 0 and flat and not rounded:
        return Opening("rectangular", w or h, l or h, "a lying cylinder")
    if h and flat and (year >= 2002 or not rounded):
        return Opening("rectangular", w, l, f"an upright {'disc' if height < 0 else 'face'}")
    if year >= 2002 and height < 0 and rounded == 1:
        return Opening("rectangular", w, l, "a lying cylinder")
    if rounded:
        solid = "a sphere" if height < 0 else "an upright cylinder"
        return Opening("round", w or l, l or w, solid if h else "")
    return Opening("rectangular", w, l, "a box with luminous sides" if h else "")
