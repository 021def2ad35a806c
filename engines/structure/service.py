"""Stiffness: what of its limits of deflection a structure uses, and making it stiff enough."""

from dataclasses import replace

import numpy as np

from ..core.progress import SILENT, Progress, part
from ..core.scene import Vector
from .assembly import Pattern
from .bracing import bracing_factors, weakest_mode
from .candidates import Index
from .checking import Checked
from .choosing import Bounds, no_bounds
from .creep import crept_rigidities, final_deflections
from .deflection import STATIONS, check_deflections
from .linear import solve_frame
from .response import Response
from .sizing import Chosen, rigidities_for, size_members
from .tasks import Task
from .timber_rules import creep_factor

_MOST = 25  # times the structure is stiffened and sized again
_PACE = 0.5  # power of what is lacking that one turn makes up for, since sections round up
_LEAST = 1.05  # that it makes up for at least
_BETTER, _PATIENCE = 0.99, 4  # what counts as progress, and turns without it before giving up


def service_of(task: Task, sections: Index, first: Response, pattern: Pattern) -> Checked:
    """How much members of ``sections`` (M,) use of the limits of deflection in the service
    combinations, numbered among themselves.

    ``first``: the response to the load cases. By Eurocode timber creeps. No check where no limit is
    set.
    """
    rules, combinations = task.rules, task.combinations.of("service")
    limits = rules.deflection
    if not (limits.member or (limits.span and limits.whole) or limits.sway or limits.storey):
        empty = np.zeros((0, len(sections)), np.int32)
        return Checked((), empty.astype(float), empty, empty, np.zeros(len(sections), np.int8))
    crept = first
    if rules.mode == "eurocode":
        grades = [creep_factor(one.grade, rules.timber_rules) for one in task.pool.families]
        creep = np.array(grades)[task.pool.family[sections]]
        assert first.rigidities is not None
        slow = crept_rigidities(first.rigidities, creep)
        crept = solve_frame(task.frame, slow, task.loads, pattern) if creep.any() else first
    moved = final_deflections(first, crept, combinations, STATIONS)
    return check_deflections(moved, task.frame, limits)


def size_stiff(
    task: Task,
    *,
    start: Index | None = None,
    pattern: Pattern,
    progress: Progress = SILENT,
) -> Chosen:
    """As `size_members`, and stiff enough: for the rules' limits of deflection, and not to buckle.

    Members that bend too far between their ends get the stiffness that they lack. For what the
    structure does as a whole, stiffness goes where it does most for its mass: with strain energy U
    and mass w of a member in the worst combination, its EI grows by s √(U/w) where that is above 1,
    with s such that the energy falls part of the way that the deflection must (optimality criterion
    of Berke and Venkayya 1974); against buckling it goes where the weakest mode has its energy.
    Sections that suffice are then chosen again, and so on; it gives up after turns that bring
    nothing, and the result says what is left.
    """
    chosen = size_members(task, start=start, pattern=pattern, progress=part(progress, 0.0, 0.3))
    bounds, least, idle = no_bounds(task), np.inf, 0
    for number in range(_MOST):
        rigidities = rigidities_for(task, chosen.sections)
        first = solve_frame(task.frame, rigidities, task.loads, pattern)
        used, factor = _lacking(task, chosen.sections, first, pattern)
        if used < _BETTER * least:
            least, idle = used, 0
        idle += 1
        if used <= 1 or idle > _PATIENCE:
            break
        needed = np.zeros_like(bounds.stiffness)
        np.maximum.at(needed, task.slot, rigidities.bending_y * factor)
        grown = np.zeros(len(needed), dtype=bool)
        grown[task.slot[factor > 1]] = True
        stiffness = np.maximum(bounds.stiffness, np.where(grown, needed, 0.0))
        bounds = Bounds(bounds.floor, np.minimum(stiffness, _stiffest(task)))
        share = 0.3 + 0.7 * number / _MOST
        report = part(progress, share, share + 0.7 / _MOST)
        sized = size_members(
            task, start=chosen.sections, pattern=pattern, bounds=bounds, progress=report
        )
        chosen = replace(sized, changes=chosen.changes + sized.changes)
    return chosen


def _lacking(
    task: Task, sections: Index, first: Response, pattern: Pattern
) -> tuple[float, Vector]:
    """How much more than it may is used of a limit, and by what EI of each member (M,) grows."""
    rules, used, factor = task.rules, 0.0, np.ones(len(sections))
    if rules.service:
        served = service_of(task, sections, first, pattern)
        used = float(served.utilisation.max(initial=0.0))
        factor = _factors(task, first, served)
    if rules.stability:
        assert first.rigidities is not None
        factors = task.combinations.of("ultimate").factors
        least, energy = weakest_mode(task.frame, first.rigidities, first, factors)
        short = rules.stability / least
        used = max(used, short)
        weight = first.rigidities.mass * first.lengths
        factor = np.maximum(factor, bracing_factors(energy, weight, short**_PACE))
    return used, factor


def _factors(task: Task, first: Response, served: Checked) -> Vector:
    """By how much the bending stiffness of each member (M,) is to grow, at least 1."""
    factor = np.ones(len(task.slot))
    used = served.utilisation
    whole = np.arange(len(used))
    if task.rules.deflection.member:  # the first check is that of the members for themselves
        factor = np.maximum(factor, used[0])
        whole = whole[1:]
    if not whole.size or used[whole].max() <= 1:
        return factor
    check, member = np.unravel_index(used[whole].argmax(), used[whole].shape)
    combination = served.combination[whole[check], member]
    factors = task.combinations.of("service").factors[combination]
    energy = _energy(first.combined(factors[None]))
    assert first.rigidities is not None
    weight = first.rigidities.mass * first.lengths
    density = np.sqrt(energy / weight)
    goal = energy.sum() / max(used[whole].max() ** _PACE, _LEAST)
    low, high = 0.0, 1e3 / density.max()
    for _ in range(60):
        middle = (low + high) / 2
        left = (energy / np.maximum(1.0, middle * density)).sum()
        low, high = (middle, high) if left > goal else (low, middle)
    return np.maximum(factor, high * density)


def _energy(response: Response) -> Vector:
    """The strain energy of axial force and bending (M,) in J in one combination."""
    assert response.rigidities is not None
    forces = response.forces(np.linspace(0.0, 1.0, 5))[0]
    weights = np.array([7.0, 32.0, 12.0, 32.0, 7.0]) / 90.0  # Boole's rule
    squares = np.einsum("msi,s->mi", forces**2, weights) * response.lengths[:, None] / 2
    resist = response.rigidities
    return (
        squares[:, 0] / resist.axial
        + squares[:, 4] / resist.bending_y
        + squares[:, 5] / resist.bending_z
    )


def _stiffest(task: Task) -> Vector:
    """The greatest EI about y (G,) in N·m² on each slot's menu."""
    stiffness = task.pool.youngs() * task.pool.sections.inertia_y
    return np.array([stiffness[menu.order].max() for menu in task.menus])[task.menu]
