"""The check that the rules ask for, of members of several materials at once."""

import numpy as np

from ..core.scene import Vector
from .candidates import Index, Pool
from .checking import Checked, Demand
from .grade import Grade
from .rules import Rules
from .sections import Sections
from .steel_check import check_steel
from .thesis_check import check_thesis
from .timber_check import check_timber


def check_members(demand: Demand, pool: Pool, chosen: Index, rules: Rules) -> Checked:
    """Every check of members whose sections are ``chosen`` (M,) in the pool.

    Each is checked by the rules of its own material; a check that is not made of a member counts 0.
    """
    parts = _by_grade(demand, pool, chosen, rules)
    names = tuple(dict.fromkeys(name for _, part in parts for name in part.names))
    shape = len(names), len(chosen)
    utilisation = np.zeros(shape)
    combination, station = np.zeros(shape, np.int32), np.zeros(shape, np.int32)
    section_class = np.zeros(len(chosen), np.int8)
    for members, part in parts:
        rows = np.array([names.index(name) for name in part.names])[:, None]
        utilisation[rows, members] = part.utilisation
        combination[rows, members] = part.combination
        station[rows, members] = part.station
        section_class[members] = part.section_class
    return Checked(names, utilisation, combination, station, section_class)


def worst_of(demand: Demand, pool: Pool, chosen: Index, rules: Rules) -> Vector:
    """The greatest utilisation (M,) of members whose sections are ``chosen`` (M,)."""
    worst = np.zeros(len(chosen))
    for members, part in _by_grade(demand, pool, chosen, rules):
        worst[members] = part.worst()
    return worst


def _by_grade(
    demand: Demand, pool: Pool, chosen: Index, rules: Rules
) -> list[tuple[Index, Checked]]:
    """Each grade's members and their checks."""
    grades = list({one.grade.name: one.grade for one in pool.families}.values())
    names = [one.name for one in grades]
    which = np.array([names.index(one.grade.name) for one in pool.families])[pool.family[chosen]]
    found = []
    for number, grade in enumerate(grades):
        members = np.flatnonzero(which == number)
        if members.size:
            part = demand if members.size == len(chosen) else demand.of(members)
            sections = pool.sections.take(chosen[members])
            found.append((members, _check(part, sections, grade, rules)))
    return found


def _check(demand: Demand, sections: Sections, grade: Grade, rules: Rules) -> Checked:
    if rules.mode == "thesis":
        return check_thesis(demand, sections, grade)
    if grade.kind == "steel":
        return check_steel(demand, sections, grade, rules.steel_rules)
    return check_timber(demand, sections, grade, rules.timber_rules)
