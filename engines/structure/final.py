"""The last pass over a sized structure: every check, displacement and figure of what was chosen."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..core.scene import Vector
from .assembly import Pattern
from .buckling import buckles_below, buckling_factors
from .candidates import Index
from .catalogue import weights_of
from .checking import Checked
from .combinations import Combinations
from .figures import FIRM, Stability, figures_of, notes_on
from .frame import Rigidities
from .linear import solve_frame
from .member_checks import check_members
from .model import Model
from .response import Response
from .second_order import solve_second_order
from .sections import Sections
from .service import service_of
from .sized import BENT, MEMBER, Rows, Sized
from .sizing import Chosen, rigidities_for
from .tasks import Task
from .vibration import carried_mass, natural_frequencies

_SLACK = 1e-9  # of the utilisation, for rounding


def final_of(
    model: Model, task: Task, chosen: Chosen, pattern: Pattern, meta: dict[str, Any]
) -> Sized:
    """Everything that is known of a structure whose sections are ``chosen``.

    ``meta`` is what the result says besides: parameters, seed, version, notes. Raises SceneError
    where the frame cannot stand.
    """
    rules, combinations, pool = task.rules, task.combinations, task.pool
    ultimate = np.flatnonzero(combinations.limit == "ultimate")
    service = np.flatnonzero(combinations.limit == "service")
    sections = pool.sections.take(chosen.sections)
    rigidities = rigidities_for(task, chosen.sections)
    first = solve_frame(task.frame, rigidities, task.loads, pattern)
    response = first.combined(combinations.factors)
    if rules.second_order:
        response = solve_second_order(
            task.frame,
            rigidities,
            task.loads,
            combinations.factors,
            pattern,
            names=combinations.names,
        )
    demand = chosen.demand
    checked = _renumbered(check_members(demand, pool, chosen.sections, rules), ultimate)
    served = _renumbered(service_of(task, chosen.sections, first, pattern), service)
    rows = _rows(model, task, chosen, checked, sections)
    frequencies, buckling = _modes(task, rigidities, first, combinations.factors[ultimate])
    stability = _stability(task, rigidities, first, ultimate, pattern)
    bent, worst = _farthest(response)
    meta = meta | {
        "worst": worst,
        "group_names": list(model.group_names),
        "model_notes": list(model.notes),
        "checks": list(checked.names),
        "service_checks": list(served.names),
        "combinations": _printed(combinations),
        "combination_notes": list(combinations.notes),
        "families": [one.name for one in pool.families],
    }
    result = Sized(
        model,
        rows,
        checked,
        served,
        response.displacements,
        response.reactions,
        bent,
        np.stack([demand.forces.min(axis=0), demand.forces.max(axis=0)]),
        stress_of(demand.forces, sections),
        frequencies,
        buckling,
        meta,
    )
    meta["figures"] = figures_of(result, chosen, stability)
    meta["notes"] = [*model.notes, *notes_on(result, chosen, rules, stability), *meta["notes"]]
    return result


def _farthest(response: Response) -> tuple[Vector, int]:
    """Where members go (M, BENT, 3) in m in the combination that moves one farthest, and which."""
    moved = response.deflections(np.linspace(0.0, 1.0, BENT))
    reach = np.linalg.norm(moved, axis=-1).reshape(len(moved), -1).max(axis=1)
    worst = int(reach.argmax())
    return moved[worst], worst


def stress_of(forces: Vector, sections: Sections) -> Vector:
    """The least and the greatest elastic normal stress (2, M, S) in Pa of K combinations.

    ``forces`` (K, M, S, 6). N/A ± M_y/W_y ± M_z/W_z: that of the corners; what a round section has
    is less.
    """
    axial = forces[..., 0] / sections.area[:, None]
    bending = np.abs(forces[..., 4]) / sections.elastic_y[:, None]
    bending = bending + np.abs(forces[..., 5]) / sections.elastic_z[:, None]
    return np.stack([(axial - bending).min(axis=0), (axial + bending).max(axis=0)])


def _renumbered(checked: Checked, combinations: Index) -> Checked:
    """A check whose combinations are numbered among all."""
    return replace(checked, combination=combinations[checked.combination].astype(np.int32))


def _rows(model: Model, task: Task, chosen: Chosen, checked: Checked, sections: Sections) -> Rows:
    pool, of = task.pool, chosen.sections
    weights = weights_of(pool.families, pool.family[of], pool.section[of])
    lengths = task.frame.lengths()
    rows = np.zeros(len(of), MEMBER)
    rows["group"], rows["slot"] = model.groups, task.slot
    rows["family"], rows["section"] = pool.family[of], pool.section[of]
    rows["material"] = np.array([one.grade.kind for one in pool.families])[pool.family[of]]
    rows["grade"] = np.array([one.grade.name for one in pool.families])[pool.family[of]]
    rows["name"] = sections.name
    rows["height"], rows["width"] = sections.height, sections.width
    rows["thickness"], rows["area"] = sections.web, sections.area
    rows["length"] = lengths
    for name in ("mass", "energy", "carbon"):
        rows[name] = getattr(weights, name) * lengths
    rows["check"] = checked.utilisation.argmax(axis=0)
    members = np.arange(len(of))
    for name in ("utilisation", "combination", "station"):
        rows[name] = getattr(checked, name)[rows["check"], members]
    rows["failing"] = rows["utilisation"] > task.rules.utilisation * (1 + _SLACK)
    return rows


def _modes(
    task: Task, rigidities: Rigidities, first: Response, factors: Vector
) -> tuple[Vector, Vector]:
    """The least natural frequencies (n,) in Hz, the members and permanent loads swinging, and the
    least buckling factors of all ultimate combinations (n,)."""
    count = task.rules.modes
    if not count:
        return np.zeros(0), np.zeros(0)
    mass = carried_mass(task.frame, task.loads)
    frequencies, _ = natural_frequencies(task.frame, rigidities, count, mass)
    found = [
        buckling_factors(task.frame, rigidities, first.combined(row[None]), count, pieces=2)[0]
        for row in factors
    ]
    return frequencies, np.sort(np.concatenate(found))[:count]


def _stability(
    task: Task, rigidities: Rigidities, first: Response, ultimate: Index, pattern: Pattern
) -> Stability:
    """Which ultimate combinations buckle the whole; by second-order theory all that stand do."""
    if task.rules.second_order:
        return Stability((), True)
    response = first.combined(task.combinations.factors[ultimate])
    away = ultimate[buckles_below(task.frame, rigidities, response, 1.0, pattern)]
    firm = (
        not len(away) and not buckles_below(task.frame, rigidities, response, FIRM, pattern).any()
    )
    return Stability(tuple(task.combinations.names[k] for k in away), firm)


def _printed(combinations: Combinations) -> list[dict[str, str]]:
    """The combinations as the result says them."""
    parts = zip(
        combinations.names,
        combinations.limit.tolist(),
        combinations.kind.tolist(),
        combinations.duration.tolist(),
        strict=True,
    )
    return [dict(zip(("name", "limit", "kind", "duration"), one, strict=True)) for one in parts]
