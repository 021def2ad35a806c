"""Sizing: analyse, choose every section anew, and again until nothing changes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.progress import SILENT, Progress
from ..core.scene import Vector
from .assembly import Pattern, pattern_of
from .candidates import Index, Menu, Pool
from .catalogue import rigidities_of
from .checking import Demand
from .combinations import Combinations
from .frame import Frame
from .linear import solve_frame
from .loads import Loads
from .member_checks import worst_of
from .response import Response
from .rules import Rules
from .search import NONE, first_sufficient
from .second_order import solve_second_order

_REVERSALS = 2  # times a slot may turn between growing and shrinking before it is held


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


@dataclass(frozen=True, slots=True)
class Chosen:
    """What sizing came to.

    ``sections`` (M,) in the pool and ``failing`` (M,), where even the last of the menu does not
    suffice. ``changes`` (rounds,): how many slots changed in each round, 0 in the last where it
    converged. ``held`` counts the slots that were kept from shrinking because they went to and fro.
    ``response`` and ``forces`` (K, M, S, 6) are those of the sections in the ultimate combinations.
    """

    sections: Index
    failing: NDArray[np.bool_]
    changes: tuple[int, ...]
    held: int
    response: Response
    demand: Demand

    @property
    def converged(self) -> bool:
        """Whether the last round changed nothing."""
        return self.changes[-1] == 0


def size_members(
    task: Task,
    *,
    start: Index | None = None,
    pattern: Pattern | None = None,
    progress: Progress = SILENT,
) -> Chosen:
    """Choose for every slot the first section of its menu that suffices for all its members.

    The forces depend on the sections, so they are chosen, the frame is solved anew, and so on,
    until nothing changes or after ``rules.rounds``. Plain repetition goes to and fro between
    sections of which each shifts forces to the other; a slot that has turned twice is not let below
    the larger of its last two sections again, so it ends.

    ``start`` (M,) are sections of the pool to begin with, by default the middle of each menu; what
    comes out may depend on them. Raises SceneError for a frame that cannot stand, Cancelled when
    ``progress`` is asked to stop.
    """
    pattern = pattern or pattern_of(task.frame)
    sizes = np.array([len(menu.order) for menu in task.menus])[task.menu]
    place = _first_places(task, start, sizes)
    floor, turns, heading = (np.zeros(len(place), dtype=np.intp) for _ in range(3))
    changes: list[int] = []
    while True:
        number = len(changes)
        progress(number / (task.rules.rounds + 1), f"Round {number + 1}: analysing and choosing")
        demand, response = demand_of(task, _sections(task, place), pattern)
        if number == task.rules.rounds or (changes and not changes[-1]):
            break
        wanted = _wanted(task, demand, place, floor)
        wanted = np.where(wanted == NONE, sizes - 1, wanted)
        moved = wanted != place
        changes.append(int(moved.sum()))
        if not changes[-1]:
            break
        way = np.sign(wanted - place)
        turns += moved & (heading == -way)
        heading = np.where(moved, way, heading)
        held = moved & (turns >= _REVERSALS)
        floor[held] = np.maximum(wanted, place)[held]
        place = np.maximum(wanted, floor)
    return Chosen(_sections(task, place), tuple(changes), int((floor > 0).sum()), response, demand)


def demand_of(task: Task, sections: Index, pattern: Pattern) -> tuple[Demand, Response]:
    """What the ultimate combinations demand of members of ``sections`` (M,), and the response."""
    pool, rules, frame = task.pool, task.rules, task.frame
    rigidities = rigidities_of(pool.families, pool.family[sections], pool.section[sections])
    ultimate = task.combinations.limit == "ultimate"
    factors = task.combinations.factors[ultimate]
    if rules.second_order:
        response = solve_second_order(frame, rigidities, task.loads, factors, pattern)
    else:
        response = solve_frame(frame, rigidities, task.loads, pattern).combined(factors)
    lengths = response.lengths
    demand = Demand(
        response.forces(np.linspace(0.0, 1.0, rules.stations)),
        lengths,
        rules.buckling_y * lengths,
        rules.buckling_z * lengths,
        rules.lateral * lengths,
        task.combinations.durations[ultimate],
    )
    return demand, response


def _sections(task: Task, place: Index) -> Index:
    """The sections of the pool (M,) that the slots' places (G,) in their menus stand for."""
    chosen = np.empty(len(place), dtype=np.intp)
    for number, menu in enumerate(task.menus):
        here = task.menu == number
        chosen[here] = menu.order[place[here]]
    return chosen[task.slot]


def _first_places(task: Task, start: Index | None, sizes: Index) -> Index:
    """Where each slot begins in its menu: at ``start`` (M,) where that is on it, else midway."""
    place = sizes // 2
    if start is None:
        return place
    begin = np.full(len(sizes), NONE)
    begin[task.slot] = start
    for number, menu in enumerate(task.menus):
        here = np.flatnonzero(task.menu == number)
        places = np.full(len(task.pool.family), NONE)
        places[menu.order] = np.arange(len(menu.order))
        known = places[begin[here]]
        place[here] = np.where(known == NONE, place[here], known)
    return place


def _wanted(task: Task, demand: Demand, place: Index, floor: Index) -> Index:
    """Each slot's first sufficient place in its menu, from its ``floor`` on; NONE for none."""
    order = np.argsort(task.slot, kind="stable")
    counts = np.bincount(task.slot, minlength=len(place))
    first = np.cumsum(counts) - counts
    wanted = np.full(len(place), NONE)
    for number, menu in enumerate(task.menus):

        def suffices(slots: Index, places: Index, menu: Menu = menu) -> NDArray[np.bool_]:
            holds = places >= floor[slots]
            open_ = np.flatnonzero(holds)
            row = np.repeat(open_, counts[slots[open_]])
            within = np.arange(len(row)) - np.repeat(
                np.cumsum(counts[slots[open_]]) - counts[slots[open_]], counts[slots[open_]]
            )
            members = order[first[slots[row]] + within]
            worst = worst_of(demand.of(members), task.pool, menu.order[places[row]], task.rules)
            np.logical_and.at(holds, row, worst <= task.rules.utilisation)
            return holds

        slots = np.flatnonzero(task.menu == number)
        wanted[slots] = first_sufficient(menu, slots, place[slots], suffices)
    return wanted
