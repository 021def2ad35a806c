"""Families of sections in one grade, from which sizing chooses."""

from dataclasses import dataclass

from .grade import Grade
from .sections import Sections


@dataclass(frozen=True, slots=True)
class Family:
    """Sections of one grade, ordered by area from light to heavy; sizing takes the first that suffices."""

    name: str
    grade: Grade
    sections: Sections
