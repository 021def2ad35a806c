"""Few sizes for fabrication: which sections to keep so that all members together weigh least."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..core.progress import SILENT, Progress, part
from ..core.scene import Vector
from .assembly import Pattern
from .candidates import Index, menu_of
from .choosing import no_bounds, places_from, sections_at, wanted_places
from .member_checks import worst_of
from .sizing import Chosen, size_members
from .tasks import Task

_MOST = 8  # times that sections to keep are chosen anew with the forces that they lead to
_BARRED = 1e6  # how much costlier than the costliest what does not suffice counts


def size_with_few(
    task: Task,
    count: int,
    size: Callable[..., Chosen] = size_members,
    *,
    start: Index | None = None,
    pattern: Pattern,
    progress: Progress = SILENT,
) -> Chosen:
    """Size with at most ``count`` different sections from each menu.

    The members are sized freely; of the sections that came up, those are kept with which all
    members together weigh least at these forces, each with one that suffices. Then they are sized
    from the kept ones, and so on until the same are kept; the lightest of these is the result.
    ``size`` is what sizes them. Raises as `size_members`.
    """
    free = size(task, start=start, pattern=pattern, progress=part(progress, 0.0, 0.5))
    best, chosen = None, free
    kept: list[Index] = []
    for number in range(_MOST):
        places = places_from(task, chosen.sections)
        wanted = wanted_places(task, chosen.demand, places, no_bounds(task))
        offered = np.union1d(free.sections, sections_at(task, wanted))
        found = [_kept(task, chosen, offered, menu, count) for menu in range(len(task.menus))]
        if kept and all(np.array_equal(old, new) for old, new in zip(kept, found, strict=True)):
            break
        kept = found
        few = replace(task, menus=tuple(menu_of(task.pool, order) for order in kept))
        share = 0.5 + 0.5 * number / _MOST
        report = part(progress, share, share + 0.5 / _MOST)
        chosen = size(few, start=chosen.sections, pattern=pattern, progress=report)
        if best is None or _standing(task, chosen) < _standing(task, best):
            best = chosen
    assert best is not None
    return replace(best, changes=free.changes + best.changes)


def few_sizes(cost: Vector, count: int) -> Index:
    """Which ``count`` of D sizes to keep so that the sum over the rows of the least cost is least.

    ``cost`` (R, D): of each size for each row. Sizes are taken one by one, each time the one that
    saves most, and then exchanged one for one as long as that saves (Teitz and Bart 1968).
    """
    kept: list[int] = []
    least = np.full(len(cost), np.inf)
    for _ in range(min(count, cost.shape[1])):
        sums = np.minimum(least[:, None], cost).sum(axis=0)
        sums[kept] = np.inf
        kept.append(int(sums.argmin()))
        least = np.minimum(least, cost[:, kept[-1]])
    total, better = least.sum(), True
    while better:
        better = False
        for place in range(len(kept)):
            others = [size for number, size in enumerate(kept) if number != place]
            rest = cost[:, others].min(axis=1, initial=np.inf)
            sums = np.minimum(rest[:, None], cost).sum(axis=0)
            if sums.min() < total * (1 - 1e-12):
                kept[place] = int(sums.argmin())
                total, better = sums.min(), True
    return np.unique(kept)


def _kept(task: Task, chosen: Chosen, offered: Index, number: int, count: int) -> Index:
    """The sections of those ``offered`` that the menu of that ``number`` keeps, in its order."""
    menu = task.menus[number]
    members = np.flatnonzero(task.menu[task.slot] == number)
    if not members.size:
        return menu.order[:1]
    sizes = menu.order[np.isin(menu.order, offered)]
    pool = task.pool
    weight = pool.sections.area[sizes] * pool.density()[sizes]
    row = np.repeat(members, len(sizes))
    tried = np.tile(sizes, len(members))
    used = worst_of(chosen.demand.of(row), pool, tried, task.rules).reshape(len(members), -1)
    enough = used <= task.rules.utilisation
    lengths = chosen.demand.lengths[members]
    # What a slot's members need together, each slot's row is the sum of theirs.
    cost = np.where(enough, weight, _BARRED * weight.max() * np.maximum(used, 1.0))
    slots, row_of = np.unique(task.slot[members], return_inverse=True)
    summed = np.zeros((len(slots), len(sizes)))
    np.add.at(summed, row_of, cost * lengths[:, None])
    return sizes[few_sizes(summed, count)]


def _standing(task: Task, chosen: Chosen) -> tuple[int, float]:
    """How good a choice is: the members that fail, then the mass in kg."""
    used = worst_of(chosen.demand, task.pool, chosen.sections, task.rules)
    area, density = task.pool.sections.area[chosen.sections], task.pool.density()[chosen.sections]
    failing = int((used > task.rules.utilisation).sum())
    return failing, float((area * density * chosen.demand.lengths).sum())
