"""Second-order theory: equilibrium of the deformed frame, P-Δ and P-δ, for each combination."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.scene import Vector
from .assembly import Pattern
from .beam_column import BeamColumns
from .buckling import buckling_modes
from .check_frame import named
from .frame import Frame, Rigidities
from .linear import System, at_nodes, factor_of, factorise, solve_system
from .loads import Loads
from .response import Response
from .stiffness import Members, released, transform

TOLERANCE = 1e-6
MOST = 30


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondOrderResponse(Response):
    """K combinations by second-order theory; forces are along the undeformed axes.

    ``axial_force`` (K, M) in N: the mean of each member, tension positive, that stiffens or softens
    it; ``rounds`` (K,): how often it was found anew.
    """

    axial_force: Vector
    rounds: NDArray[np.int32]

    def combined(self, factors: Vector) -> Response:
        """Not to be had: second-order responses do not add up. Raises ValueError."""
        raise ValueError("Second-order responses do not add up; solve each combination.")

    def forces(self, stations: Vector) -> Vector:
        """Section forces (K, M, S, 6) at ``stations`` (S,) in 0..1 of the length, P-δ included."""
        forces = super(SecondOrderResponse, self).forces(stations)
        x = _from_middle(stations, self.lengths)
        for along, sign, motion in self._columns().motions(self.end_displacements, self.line):
            forces[..., along] = np.moveaxis(motion.across(x), 0, -1)
            forces[..., 6 - along] = sign * np.moveaxis(motion.moment(x), 0, -1)
        return forces

    def deflections(self, stations: Vector) -> Vector:
        """Displacements (K, M, S, 3) in m, world axes, at ``stations`` (S,) in 0..1 of a length."""
        local = super(SecondOrderResponse, self).deflections(stations)
        local = local @ self.axes.transpose(0, 2, 1)
        x = _from_middle(stations, self.lengths)
        for along, _, motion in self._columns().motions(self.end_displacements, self.line):
            local[..., along] = np.moveaxis(motion.deflection(x), 0, -1)
        return local @ self.axes

    def _columns(self) -> BeamColumns:
        """The members under their axial forces."""
        assert self.rigidities is not None
        return BeamColumns(self.rigidities, self.lengths, self.axial_force)


def solve_second_order(
    frame: Frame,
    rigidities: Rigidities,
    loads: Loads,
    factors: Vector,
    pattern: Pattern | None = None,
    *,
    tolerance: float = TOLERANCE,
    most: int = MOST,
    names: Sequence[str] | None = None,
) -> SecondOrderResponse:
    """Displacements, reactions and forces of K combinations ``factors`` (K, C), second order.

    Every member bends exactly as its mean axial force makes it (`beam_column`), so that it need not
    be divided; where that force varies along a member, as a column's own weight does, dividing it
    is closer. The forces are found again until none changes by more than ``tolerance`` of the
    greatest, at most ``most`` times. Displacements are small: members do not shorten by bowing, and
    rigid offsets keep their direction.

    Raises SceneError as `linear.solve_frame`; for a combination that buckles, called by its
    ``names`` (K,) or number; and for one that does not settle.
    """
    system = factorise(frame, rigidities, pattern)
    factors = np.atleast_2d(np.asarray(factors, dtype=np.float64))
    first = solve_system(system, loads).combined(factors)
    nodal = np.tensordot(factors, loads.nodal, 1)
    numbers = range(len(factors))
    called = numbers if names is None else [f"“{name}”" for name in names]
    settled = [
        _settled(system, _one(first, k), nodal[k : k + 1], f"Combination {name}", tolerance, most)
        for k, name in zip(numbers, called, strict=True)
    ]
    changing = ("displacements", "reactions", "end_forces", "end_displacements", "imbalance")
    joined = {
        name: np.concatenate([getattr(part, name) for part in settled])
        for name in (*changing, "line", "axial_force", "rounds")
    }
    return replace(settled[0], **joined)


def mean_axial_force(end_forces: Vector, line: Vector, lengths: Vector) -> Vector:
    """The mean over each member (…, M) in N, tension positive, from its ends and its line load."""
    along = lengths * (line[..., 0, 0] / 3 + line[..., 1, 0] / 6)
    return -end_forces[..., 0] - along


def _settled(
    system: System, first: Response, nodal: Vector, name: str, tolerance: float, most: int
) -> SecondOrderResponse:
    """One combination: solved again until the axial forces are those it was solved with."""
    line, lengths = first.line, first.lengths
    axial = mean_axial_force(first.end_forces, line, lengths)
    change = np.inf
    for count in range(1, most + 1):
        found = _solved(system, axial, line, nodal, name)
        if found is None:
            raise SceneError(_buckles(name, _weakest(system, first)))
        change = float(np.abs(found.axial_force - axial).max())
        axial = found.axial_force
        if change <= tolerance * float(np.abs(axial).max()):
            return replace(found, rounds=np.array([count], dtype=np.int32))
    raise SceneError(
        f"{name} does not settle in second-order theory: after {most} rounds axial forces still "
        f"change by {change:.3g} N; it is close to buckling, so stiffen the frame."
    )


def _solved(
    system: System, axial: Vector, line: Vector, nodal: Vector, name: str
) -> SecondOrderResponse | None:
    """The response under given ``axial`` forces (1, M); its own are those that it brings about.

    None where the nodes have no stable place.
    """
    frame, pattern, lengths = system.frame, system.pattern, system.members.coefficients.lengths
    columns = BeamColumns(system.rigidities, lengths, axial[0])
    away = np.flatnonzero(columns.buckled())
    if len(away):
        raise SceneError(_buckles(name, named(frame, int(away[0]))))
    local = columns.stiffness()
    members = _members_under(system, local, name)
    factor = factor_of(pattern, members.world, frame.springs)
    if factor is None:
        return None

    equivalent = columns.equivalent_loads(line)
    forces = nodal + at_nodes(frame, members.to_nodes(equivalent))
    moved = pattern.spread(factor.solve(np.asfortranarray(pattern.gathered(forces))))
    ends = members.end_displacements(moved[:, frame.members].reshape(1, -1, 12), equivalent)
    end_forces = np.einsum("mij,cmj->cmi", local, ends) - equivalent
    if frame.releases is not None:
        end_forces[:, frame.releases] = 0.0

    lacking = at_nodes(frame, members.to_nodes(end_forces)) - nodal
    given = np.where(frame.held, lacking, 0.0)
    if frame.springs is not None:
        given = given - np.where(frame.held, 0.0, frame.springs * moved)
    residual = np.abs((lacking - given)[..., :3]).max()
    return SecondOrderResponse(
        moved,
        given,
        end_forces,
        ends,
        line,
        lengths,
        system.members.axes,
        np.atleast_1d(residual / max(np.abs(end_forces[..., :3]).max(initial=0.0), 1e-300)),
        system.rigidities,
        axial_force=mean_axial_force(end_forces, line, lengths),
        rounds=np.ones(1, dtype=np.int32),
    )


def _members_under(system: System, local: Vector, name: str) -> Members:
    """The members with another local stiffness (M, 12, 12), releases and offsets as they are."""
    frame, members = system.frame, system.members
    turn = transform(members.axes, frame.offsets)
    special, flexible = members.special, members.flexible
    if frame.releases is not None:
        both = frame.releases[special, :, None] & frame.releases[special, None, :]
        alone = np.where(both, local[special], np.where(both, 0.0, np.eye(12)))
        away = np.flatnonzero(np.linalg.eigvalsh(alone)[:, 0] <= 0)
        if len(away):
            raise SceneError(_buckles(name, named(frame, int(special[away[0]]))))
        keep, flexible = released(local[special], frame.releases[special])
        turn[special] = keep @ turn[special]
    world = turn.transpose(0, 2, 1) @ local @ turn
    return replace(members, world=world, follow=turn[special], flexible=flexible)


def _one(response: Response, combination: int) -> Response:
    """One of several responses, still with an axis of combinations."""
    one = slice(combination, combination + 1)
    return replace(
        response,
        **{
            name: getattr(response, name)[one]
            for name in ("displacements", "reactions", "end_forces", "end_displacements")
        },
        line=response.line[one],
        imbalance=response.imbalance[one],
    )


def _from_middle(stations: Vector, lengths: Vector) -> Vector:
    """Where stations (S,) in 0..1 are, in m from the members' middles (S, 1, M)."""
    return (np.asarray(stations, dtype=np.float64)[:, None, None] - 0.5) * lengths


def _weakest(system: System, first: Response) -> str:
    """What gives way first by linear buckling under the forces of a first-order response."""
    modes = buckling_modes(system.frame, system.rigidities, first, 1, pieces=2)
    if not len(modes.values):
        return "the frame"
    size = np.linalg.norm(modes.along[0], axis=-1).max(axis=1)
    member = named(system.frame, int(size.argmax()))
    return f"the frame, which gives way most at {member} by {modes.values[0]:.3g} of these loads,"


def _buckles(name: str, what: str) -> str:
    """The sentence for a combination that has no equilibrium."""
    return (
        f"{name} buckles: {what} has no stiffness left under its axial forces; take stiffer "
        "sections, shorten or brace the members, or reduce the load."
    )
