"""What each slot of a task wants: the first section of its menu that suffices for its members."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector
from .candidates import Index, Menu
from .checking import Demand
from .member_checks import worst_of
from .search import NONE, first_sufficient
from .tasks import Task


@dataclass(frozen=True, slots=True)
class Bounds:
    """What a slot's section must be besides sufficient.

    ``floor`` (G,): the first place of its menu that it may have. ``stiffness`` (G,): the least
    EI about y in N·m².
    """

    floor: Index
    stiffness: Vector


def no_bounds(task: Task) -> Bounds:
    """Bounds that leave everything open."""
    return Bounds(np.zeros_like(task.menu), np.zeros(len(task.menu)))


def sections_at(task: Task, places: Index) -> Index:
    """The sections of the pool (M,) that the slots' ``places`` (G,) in their menus stand for."""
    chosen = np.empty(len(places), dtype=np.intp)
    for number, menu in enumerate(task.menus):
        here = task.menu == number
        chosen[here] = menu.order[places[here]]
    return chosen[task.slot]


def places_from(task: Task, start: Index | None) -> Index:
    """Where each slot begins (G,): at ``start`` (M,) where that is on its menu, else midway."""
    places = np.array([len(menu.order) // 2 for menu in task.menus])[task.menu]
    if start is None:
        return places
    begin = np.full(len(places), NONE)
    begin[task.slot] = start
    for number, menu in enumerate(task.menus):
        here = np.flatnonzero(task.menu == number)
        place_of = np.full(len(task.pool.family), NONE)
        place_of[menu.order] = np.arange(len(menu.order))
        known = place_of[begin[here]]
        places[here] = np.where(known == NONE, places[here], known)
    return places


def wanted_places(
    task: Task, demand: Demand, places: Index, bounds: Bounds, *, thorough: bool = False
) -> Index:
    """The first place (G,) in each slot's menu that suffices within ``bounds``; the last for none.

    ``demand`` is on all M members; ``places`` (G,) are those that slots have now, from which the
    search starts, ``thorough`` as of `first_sufficient`.
    """
    order = np.argsort(task.slot, kind="stable")
    counts = np.bincount(task.slot, minlength=len(places))
    first = np.cumsum(counts) - counts
    pool = task.pool
    stiffness = pool.youngs() * pool.sections.inertia_y
    wanted = places.copy()
    for number, menu in enumerate(task.menus):

        def suffices(slots: Index, tried: Index, menu: Menu = menu) -> NDArray[np.bool_]:
            holds = tried >= bounds.floor[slots]
            holds &= stiffness[menu.order[tried]] >= bounds.stiffness[slots]
            asked = np.flatnonzero(holds)
            # A row for each member of each slot that is asked.
            sizes = counts[slots[asked]]
            row = np.repeat(asked, sizes)
            within = np.arange(len(row)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
            members = order[first[slots[row]] + within]
            worst = worst_of(demand.of(members), pool, menu.order[tried[row]], task.rules)
            np.logical_and.at(holds, row, worst <= task.rules.utilisation)
            return holds

        slots = np.flatnonzero(task.menu == number)
        found = first_sufficient(menu, slots, places[slots], suffices, thorough=thorough)
        wanted[slots] = np.where(found == NONE, len(menu.order) - 1, found)
    return wanted
