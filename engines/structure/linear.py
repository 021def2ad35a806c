"""First-order analysis of a frame: every load case at once."""

from dataclasses import dataclass

import numpy as np

from ..core.errors import SceneError
from ..core.scene import Vector
from .assembly import Pattern, pattern_of
from .check_frame import check_frame
from .factor import Factor, factor_of
from .frame import Frame, Rigidities
from .loads import Loads
from .mechanism import check_ends, check_factor
from .response import Response
from .stiffness import Members, elastic_forces, equivalent_loads, members_of

TOLERANCE = 1e-9
_GAIN = 0.5  # a refinement that leaves more of the imbalance is the last


@dataclass(frozen=True, slots=True, eq=False)
class System:
    """A frame's members and its factorised stiffness, ready for loads."""

    frame: Frame
    rigidities: Rigidities
    pattern: Pattern
    members: Members
    factor: Factor


def factorise(frame: Frame, rigidities: Rigidities, pattern: Pattern | None = None) -> System:
    """The frame's stiffness, factorised, with everything needed to solve it for loads.

    Raises SceneError as `check_frame`, and for a mechanism, named; ValueError for a pattern of
    another frame.
    """
    check_frame(frame, rigidities)
    pattern = pattern_of(frame) if pattern is None else pattern
    if not pattern.fits(frame):
        raise ValueError("The pattern is that of other members or other held freedoms.")
    check_ends(frame, rigidities)
    members = members_of(frame, rigidities)
    factor = factor_of(pattern, members.world, frame.springs)
    check_factor(frame, pattern, members, factor)
    assert factor is not None
    return System(frame, rigidities, pattern, members, factor)


def solve_frame(
    frame: Frame,
    rigidities: Rigidities,
    loads: Loads,
    pattern: Pattern | None = None,
    *,
    tolerance: float = TOLERANCE,
) -> Response:
    """Displacements, reactions and member forces of all load cases, first-order elastic.

    ``pattern`` of an earlier frame with the same members and held freedoms saves working it out.
    While a residual force is above ``tolerance`` of the greatest load, the solution is refined.
    Raises SceneError for a frame that cannot be solved (`check_frame`), for a mechanism, which it
    names, and for loads that do not fit the frame.
    """
    return solve_system(factorise(frame, rigidities, pattern), loads, tolerance=tolerance)


def solve_system(system: System, loads: Loads, *, tolerance: float = TOLERANCE) -> Response:
    """The response of a factorised frame to all load cases of ``loads``.

    Refinement adds the forces of each correction to those before, so that they balance better than
    forces of the rounded displacements could (Higham, Accuracy and Stability, 2002, ch. 12).
    """
    frame, members, pattern = system.frame, system.members, system.pattern
    _check_loads(frame, loads)
    line = local_line(members, system.rigidities, loads)
    equivalent = equivalent_loads(members.coefficients, line)
    load = _greatest_load(members, loads, equivalent)
    right = loads.nodal + at_nodes(frame, members.to_nodes(equivalent))
    supported = 0.0 if frame.springs is None else np.where(frame.held, 0.0, frame.springs)

    moved = np.zeros_like(loads.nodal)
    ends = np.zeros((*line.shape[:2], 12))
    end_forces, given, free = -equivalent, np.zeros_like(moved), equivalent
    worst = np.inf
    while True:
        step = pattern.spread(system.factor.solve(np.asfortranarray(pattern.gathered(right))))
        end_step = members.end_displacements(step[:, frame.members].reshape(ends.shape), free)
        moved, ends = moved + step, ends + end_step
        end_forces = end_forces + elastic_forces(members.coefficients, end_step)
        if frame.releases is not None:
            end_forces[:, frame.releases] = 0.0
        given = given - supported * step
        lacking = at_nodes(frame, members.to_nodes(end_forces)) - loads.nodal
        residual = np.where(frame.held, 0.0, lacking - given)
        imbalance = _greatest(members, residual) / load
        before, worst = worst, imbalance.max(initial=0.0)
        if worst <= tolerance or not worst <= _GAIN * before:
            break
        right, free = -residual, np.zeros_like(equivalent)
    return Response(
        moved,
        np.where(frame.held, lacking, given),
        end_forces,
        ends,
        line,
        members.coefficients.lengths,
        members.axes,
        imbalance,
        system.rigidities,
    )


def local_line(members: Members, rigidities: Rigidities, loads: Loads) -> Vector:
    """Line loads with the members' own weight (C, M, 2, 3) in N/m, in local axes."""
    weight = loads.gravity[:, None, None, :] * rigidities.mass[:, None, None]
    return (loads.line + weight) @ members.axes.transpose(0, 2, 1)


def at_nodes(frame: Frame, ends: Vector) -> Vector:
    """Forces on the members' ends (C, M, 12), world axes, added up at the nodes (C, N, 6)."""
    cases, count = len(ends), 6 * len(frame.nodes)
    place = (6 * frame.members.astype(np.intp)[:, :, None] + np.arange(6)).ravel()
    place = (place + count * np.arange(cases)[:, None]).ravel()
    return np.bincount(place, ends.ravel(), cases * count).reshape(cases, len(frame.nodes), 6)


def _check_loads(frame: Frame, loads: Loads) -> None:
    """The loads have the rows of the frame and are numbers."""
    cases = len(loads.gravity)
    wanted = {
        "gravity": (cases, 3),
        "nodal": (cases, len(frame.nodes), 6),
        "line": (cases, len(frame.members), 2, 3),
    }
    for name, shape in wanted.items():
        values = getattr(loads, name)
        if values.shape != shape:
            raise SceneError(
                f"The {name} loads have the shape {values.shape}, but this frame with {cases} "
                f"load cases needs {shape}; make the loads anew for it."
            )
        if not np.isfinite(values).all():
            case = int(np.argwhere(~np.isfinite(values))[0, 0])
            raise SceneError(
                f"Load case “{loads.names[case]}” has a {name} load that is not a number; "
                "correct it."
            )


def _greatest(members: Members, forces: Vector) -> Vector:
    """The greatest of forces and moments (C, …, 6) of each case (C,), moments over lengths."""
    size = float(members.coefficients.lengths.mean())
    most = np.abs(forces).max(axis=1, initial=0.0)
    most = most.reshape(len(forces), forces.shape[2] // 6, 2, 3).max(axis=(1, 3))
    return np.maximum(most[:, 0], most[:, 1] / size)


def _greatest_load(members: Members, loads: Loads, equivalent: Vector) -> Vector:
    """The greatest load on nodes and members' ends (C,), 1 where there is none."""
    load = np.maximum(_greatest(members, loads.nodal), _greatest(members, equivalent))
    return np.where(load > 0.0, load, 1.0)
