"""Families of sections in one grade, from which sizing chooses."""

import difflib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..core.errors import ParameterError
from .grade import Grade
from .sections import Sections


@dataclass(frozen=True, slots=True)
class Family:
    """Sections of one grade, ordered by area from light to heavy.

    Sizing takes the first that suffices. ``about``: what they are, for a person.
    """

    name: str
    grade: Grade
    sections: Sections
    about: str = ""

    def index(self, section: str) -> int:
        """Where the section of that name is. Raises ParameterError where there is none."""
        names = [str(name) for name in self.sections.name]
        if section not in names:
            raise ParameterError(
                f"The family “{self.name}” has no section “{section}”; {nearest(section, names)}"
            )
        return names.index(section)


def by_area(sections: Sections) -> Sections:
    """The sections from light to heavy, of equal ones the stiffer about y first."""
    area = np.round(sections.area, 10)  # equal sums of lengths differ in their last digit
    return sections.take(np.lexsort((-sections.inertia_y, area)))


def nearest(name: str, known: Iterable[str]) -> str:
    """The end of a message about an unknown name: the nearest one, or some of those there are."""
    known = list(known)
    folded = {k.casefold(): k for k in known}
    near = difflib.get_close_matches(name.casefold(), folded, 1)
    if near:
        return f"did you mean “{folded[near[0]]}”?"
    shown = ", ".join(known[:12]) + (", …" if len(known) > 12 else "")
    return f"there are: {shown}."
