"""From a model, its loads and the rules to the task of sizing."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from .candidates import Index, Menu, Pool, menu_of, pool_of
from .catalogue import load_family, read_catalogue
from .combinations import Combinations, combinations_of
from .family import Family
from .frame import Frame
from .loads import Loads
from .model import Model
from .rules import Rules
from .section_range import family_of_range

RANGE = "thesis"
STEEL, TIMBER = 0, 1
"""The places of the two families in a task's pool."""


@dataclass(frozen=True, slots=True)
class Task:
    """What is sized: a frame of M members under its loads, and what each may be made of.

    ``slot`` (M,): members of one slot share one section; ``menu`` (G,): which of ``menus`` each
    of the G slots chooses from.
    """

    frame: Frame
    loads: Loads
    combinations: Combinations
    pool: Pool
    menus: tuple[Menu, ...]
    menu: Index
    slot: Index
    rules: Rules


def task_of(
    model: Model,
    loads: Loads,
    steel: NDArray[np.bool_],
    families: tuple[Family, Family],
    rules: Rules,
) -> Task:
    """What `size_members` is to do with a model under its loads.

    ``steel`` (M,): which members are of the first of ``families``, the others of the second. With
    “least mass” or “least energy” all choose from both.
    """
    pool = pool_of(families)
    by_family = [np.flatnonzero(pool.family == number) for number in (STEEL, TIMBER)]
    kind = np.where(steel, STEEL, TIMBER)
    if rules.choose == "first sufficient":
        menus = tuple(menu_of(pool, sections) for sections in by_family)
    else:
        cost = pool.sections.area * pool.density()
        if rules.choose == "least energy":
            cost = cost * pool.energy()
        menus = (menu_of(pool, np.concatenate(by_family), cost),)
        kind = np.zeros_like(kind)
    menu, slot = _slots(model, kind, rules)
    combinations = combinations_of(loads, rules.combinations)
    return Task(model.frame, loads, combinations, pool, menus, menu, slot, rules)


def _slots(model: Model, kind: Index, rules: Rules) -> tuple[Index, Index]:
    """The menu (G,) of each slot, and the slot (M,) of each member."""
    if rules.per == "member":
        return kind, np.arange(len(kind))
    group = model.groups.astype(np.intp) if rules.per == "group" else np.zeros_like(kind)
    pairs, slot = np.unique(np.stack([kind, group], axis=1), axis=0, return_inverse=True)
    return pairs[:, 0], slot.ravel()


def families_of(rules: Rules) -> tuple[Family, Family]:
    """The steel and the timber family that the rules name.

    Raises ParameterError where there is no such family or grade, or one is of the other material,
    FileError where the catalogue file cannot be read.
    """
    own = read_catalogue(Path(rules.catalogue_file)) if rules.catalogue_file else {}
    ranges = {
        "steel": family_of_range("steel", rules.steel_range),
        "timber": family_of_range("timber", rules.timber_range),
    }
    named = {"steel": rules.steel, "timber": rules.timber}
    grades = {"steel": rules.steel_grade, "timber": rules.timber_grade}
    found = []
    for kind, name in named.items():
        if name == RANGE:
            name, offered = ranges[kind].name, own | {ranges[kind].name: ranges[kind]}
        else:
            offered = own
        family = load_family(name, grades[kind], offered)
        if family.grade.kind != kind:
            raise ParameterError(
                f"The {kind} family “{name}” is of {family.grade.kind}; choose another for {kind}."
            )
        found.append(family)
    return found[0], found[1]
