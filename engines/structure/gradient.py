"""How a result changes with members' rigidities and nodes' positions, by the adjoint method.

With K u = f a result J(u) changes by λᵀ(∂f − ∂K u), where K λ = ∂J/∂u: one more right-hand side for
all derivatives at once [Haftka and Gürdal 1992, ch. 7]. Released ends follow by themselves: what
acts on them is zero.
"""

from dataclasses import dataclass, fields, replace

import numpy as np

from ..core.scene import Vector
from .frame import Frame, Rigidities
from .linear import System, solve_system
from .loads import Loads
from .member_work import MemberWork
from .response import Response


@dataclass(frozen=True, slots=True)
class Gradient:
    """Derivatives of one number J on a frame of N nodes and M members.

    ``rigidities``: ∂J/∂ each of the members' rigidities, in units of J over theirs; ``nodes``
    (N, 3): ∂J/∂ the nodes' positions, in units of J per m; members' lengths and axes follow.
    """

    rigidities: Rigidities
    nodes: Vector

    def by_scale(self, rigidities: Rigidities) -> Vector:
        """∂J/∂s (M,) at s = 1, where s multiplies everything a member resists with and weighs."""
        total = np.zeros(len(rigidities.axial))
        for field in fields(Rigidities):
            value = getattr(rigidities, field.name)
            total += getattr(self.rigidities, field.name) * np.where(np.isinf(value), 0.0, value)
        return total


def compliance_gradient(
    system: System, response: Response, loads: Loads, weights: Vector | None = None
) -> tuple[float, Gradient]:
    """Σ w fᵀu over the cases in J, and its gradient; ``weights`` w (C,), 1 unless told.

    f are the loads on the nodes and those that stand for the loads on members. ``response`` is
    that of ``system`` to ``loads``; nothing more is solved, as λ = w u.
    """
    weights = np.ones(len(loads.names)) if weights is None else np.asarray(weights, dtype=float)
    each = weights[:, None, None]
    adjoint = replace(
        response,
        displacements=each * response.displacements,
        end_displacements=each * response.end_displacements,
    )
    members = _member_work(system, response, adjoint, loads, share=2.0)
    on_nodes = float(np.einsum("cni,cni", adjoint.displacements, loads.nodal))
    return on_nodes + members.of_lines(), _gradient(members)


def displacement_gradient(
    system: System, response: Response, loads: Loads, functional: Vector
) -> tuple[float, Gradient]:
    """Σ aᵀu over cases and nodes, and its gradient; ``functional`` a (C, N, 6) picks and weighs.

    ``response`` is that of ``system`` to ``loads``.
    """
    value = float(np.einsum("cni,cni", functional, response.displacements))
    alone = replace(
        loads,
        gravity=np.zeros_like(loads.gravity),
        nodal=functional,
        line=np.zeros_like(loads.line),
    )
    adjoint = solve_system(system, alone)
    return value, _gradient(_member_work(system, response, adjoint, loads, share=1.0))


def mass_gradient(frame: Frame, rigidities: Rigidities) -> tuple[float, Gradient]:
    """The members' mass in kg, and its gradient."""
    lengths, x = frame.lengths(), frame.axes()[:, 0]
    none = Rigidities(*(np.zeros_like(lengths) for _ in fields(Rigidities)))
    pull = _at_nodes(frame, rigidities.mass[:, None] * x)
    return float(rigidities.mass @ lengths), Gradient(replace(none, mass=lengths), pull)


def _member_work(
    system: System, response: Response, adjoint: Response, loads: Loads, share: float
) -> MemberWork:
    """The members as they move in a response and in its adjoint."""
    return MemberWork(
        system.frame,
        system.rigidities,
        loads,
        response.lengths,
        response.axes,
        response.end_displacements,
        adjoint.end_displacements,
        _apart(system.frame, response),
        _apart(system.frame, adjoint),
        share,
    )


def _apart(frame: Frame, response: Response) -> Vector:
    """What members' ends move beyond their nodes (C, M, 12), local axes: nothing but released."""
    ends = response.end_displacements
    if frame.releases is None:
        return np.zeros(12)
    moved = response.displacements[:, frame.members].reshape(*ends.shape[:2], 4, 3)
    if frame.offsets is not None:
        moved[:, :, ::2] += np.cross(moved[:, :, 1::2], frame.offsets)
    return ends - (moved @ response.axes.transpose(0, 2, 1)).reshape(ends.shape)


def _gradient(members: MemberWork) -> Gradient:
    """The derivatives of members' work by rigidities and nodes."""
    return Gradient(members.by_rigidities(), _at_nodes(members.frame, members.by_spans()))


def _at_nodes(frame: Frame, pull: Vector) -> Vector:
    """Derivatives by the vectors from start to end (M, 3) as those by the nodes (N, 3)."""
    found = np.zeros_like(frame.nodes)
    np.add.at(found, frame.members[:, 1], pull)
    np.subtract.at(found, frame.members[:, 0], pull)
    return found
