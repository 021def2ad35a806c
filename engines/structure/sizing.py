"""Sizing: analyse, choose every section anew, and again until nothing changes."""

from dataclasses import dataclass, replace

import numpy as np

from ..core.progress import SILENT, Progress, part
from .assembly import Pattern, pattern_of
from .candidates import Index
from .catalogue import rigidities_of
from .checking import Demand
from .choosing import Bounds, no_bounds, places_from, sections_at, wanted_places
from .frame import Rigidities
from .linear import solve_frame
from .response import Response
from .second_order import solve_second_order
from .tasks import Task


@dataclass(frozen=True, slots=True)
class Chosen:
    """What sizing came to.

    ``sections`` (M,) in the pool; a slot for which nothing suffices has the last of its menu.
    ``changes`` (rounds,): how many slots changed in each round, 0 in the last where it converged.
    ``held``: how many slots were kept from shrinking because they went to and fro. ``demand`` and
    ``response`` are those of these sections in the ultimate combinations.
    """

    sections: Index
    changes: tuple[int, ...]
    held: int
    demand: Demand
    response: Response

    @property
    def converged(self) -> bool:
        """Whether the last round changed nothing."""
        return self.changes[-1] == 0


def size_members(
    task: Task,
    *,
    start: Index | None = None,
    pattern: Pattern | None = None,
    bounds: Bounds | None = None,
    progress: Progress = SILENT,
) -> Chosen:
    """Choose for every slot the first section of its menu that suffices for all its members.

    The forces depend on the sections, so they are chosen, the frame is solved anew, and so on,
    until nothing changes or after ``rules.rounds``. Plain repetition goes to and fro between
    sections of which each shifts forces to the other; a slot that has turned ``rules.turns`` times
    is from then on not let below the larger of its last two sections, so it ends. By second-order
    theory, the rounds begin where those by first-order theory end.

    ``start`` (M,) are sections of the pool to begin with, by default the middle of each menu; what
    comes out may depend on them. Raises SceneError for a frame that cannot stand, Cancelled when
    ``progress`` is asked to stop.
    """
    pattern = pattern or pattern_of(task.frame)
    bounds = bounds or no_bounds(task)
    if not task.rules.second_order:
        return _repeated(task, places_from(task, start), pattern, bounds, progress)
    first = replace(task, rules=replace(task.rules, second_order=False))
    begin = _repeated(first, places_from(task, start), pattern, bounds, part(progress, 0.0, 0.5))
    places = places_from(task, begin.sections)
    chosen = _repeated(task, places, pattern, bounds, part(progress, 0.5, 1.0))
    return replace(chosen, changes=begin.changes + chosen.changes)


def _repeated(
    task: Task, places: Index, pattern: Pattern, bounds: Bounds, progress: Progress
) -> Chosen:
    """The rounds of `size_members`, from ``places`` (G,) on."""
    rules = task.rules
    floor, turns, heading = bounds.floor.copy(), np.zeros_like(places), np.zeros_like(places)
    changes: list[int] = []
    thorough = False  # only at the end: where nothing suffices now, something may later
    while True:
        number = len(changes)
        progress(number / (rules.rounds + 1), f"Round {number + 1}: analysing and choosing")
        demand, response = demand_of(task, sections_at(task, places), pattern)
        if number == rules.rounds:
            break
        within = replace(bounds, floor=floor)
        wanted = wanted_places(task, demand, places, within, thorough=thorough)
        if not thorough and np.array_equal(wanted, places):
            thorough = True
            wanted = wanted_places(task, demand, places, within, thorough=True)
        moved = wanted != places
        changes.append(int(moved.sum()))
        if not changes[-1]:
            break
        way = np.sign(wanted - places)
        turns += moved & (heading == -way)
        heading = np.where(moved, way, heading)
        held = moved & (turns >= rules.turns)
        floor[held] = np.maximum(wanted, places)[held]
        places = np.maximum(wanted, floor)
    held = int((floor > bounds.floor).sum())
    return Chosen(sections_at(task, places), tuple(changes), held, demand, response)


def demand_of(task: Task, sections: Index, pattern: Pattern) -> tuple[Demand, Response]:
    """What the ultimate combinations demand of members of ``sections`` (M,), and the response."""
    rules, frame = task.rules, task.frame
    rigidities = rigidities_for(task, sections)
    ultimate = task.combinations.limit == "ultimate"
    factors = task.combinations.factors[ultimate]
    if rules.second_order:
        names = [task.combinations.names[k] for k in np.flatnonzero(ultimate)]
        response = solve_second_order(frame, rigidities, task.loads, factors, pattern, names=names)
    else:
        response = solve_frame(frame, rigidities, task.loads, pattern).combined(factors)
    lengths = response.lengths
    demand = Demand(
        response.forces(np.linspace(0.0, 1.0, rules.stations)),
        lengths,
        rules.buckling_y * lengths,
        rules.buckling_z * lengths,
        rules.lateral * lengths,
        task.combinations.duration[ultimate],
    )
    return demand, response


def rigidities_for(task: Task, sections: Index) -> Rigidities:
    """What members of ``sections`` (M,) of the pool resist with."""
    pool = task.pool
    return rigidities_of(pool.families, pool.family[sections], pool.section[sections])
