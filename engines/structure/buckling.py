"""Linear buckling: by how much a combination of loads could grow before the frame gives way."""

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .assembly import Pattern, pattern_of
from .beam_shapes import local_geometric
from .factor import factor_of
from .frame import Frame, Rigidities
from .linear import factorise
from .modes import Modes, greatest_eigenpairs, scaled
from .response import Response
from .stiffness import members_of
from .subdivision import along_members, repeated, subdivided

PIECES = 4
_NOTHING = 1e-12
"""Axial forces below this share of the greatest are the solver's rounding."""


def buckling_factors(
    frame: Frame, rigidities: Rigidities, response: Response, count: int, *, pieces: int = PIECES
) -> tuple[Vector, Vector]:
    """`buckling_modes`, of which the factors (n,) and the nodes' displacements (n, N, 6)."""
    modes = buckling_modes(frame, rigidities, response, count, pieces=pieces)
    return modes.values, modes.nodes


def buckling_modes(
    frame: Frame, rigidities: Rigidities, response: Response, count: int, *, pieces: int = PIECES
) -> Modes:
    """The ``count`` smallest factors of a combination's loads at which the frame buckles, rising.

    (K + λ K_g) φ = 0 with K_g of the axial forces of ``response``, which is of one combination: by
    bending of members between and with their nodes, and by twist [McGuire, Gallagher and Ziemian
    2000, ch. 9]. Members are divided into ``pieces``: with four, a column's factor is at most 0.1 %
    too high with hinged and 0.8 % with clamped ends. Lateral-torsional buckling is no part of it.

    There are fewer factors, or none, where fewer exist: nothing buckles where all is in tension.
    Raises ParameterError for a response of several combinations, SceneError as `factorise`.
    """
    if len(response.displacements) != 1:
        raise ParameterError(
            f"Buckling is of one combination, but {len(response.displacements)} were given; "
            "choose one."
        )
    axial = response.forces(np.linspace(0, 1, pieces + 1))[0, ..., 0]
    axial = np.stack([axial[:, :-1], axial[:, 1:]], axis=-1).reshape(-1, 2)
    axial = np.where(np.abs(axial) > _NOTHING * np.abs(axial).max(initial=0.0), axial, 0.0)
    fine = subdivided(frame, pieces)
    if not (axial < 0).any():
        return _none(frame, pieces)

    pattern = pattern_of(fine)
    system = factorise(fine, repeated(rigidities, pieces), pattern)
    turn = system.members.transforms()
    geometric = local_geometric(axial, system.rigidities, system.members.coefficients.lengths)
    world = turn.transpose(0, 2, 1) @ geometric @ turn
    inverse, vectors = greatest_eigenpairs(
        -pattern.matrix(world),
        pattern.matrix(system.members.world, fine.springs),
        system.factor,
        count,
    )
    buckles = inverse > _NOTHING * np.abs(inverse).max(initial=0.0)
    if not buckles.any():
        return _none(frame, pieces)
    moved = pattern.spread(vectors[:, buckles])
    shapes = scaled(moved[:, : len(frame.nodes)], along_members(frame, moved, pieces))
    return Modes(1 / inverse[buckles], *shapes)


def buckles_below(
    frame: Frame, rigidities: Rigidities, response: Response, times: float, pattern: Pattern
) -> NDArray[np.bool_]:
    """Whether the frame buckles below ``times`` the loads of each of K combinations (K,).

    ``pattern`` is that of the frame. Where K + times · K_g is not positive definite, a factor of
    `buckling_modes` is less [Sylvester's law of inertia]; that takes no more than a factorisation
    for each. Members are not divided: what bends as a whole is found, not a member between nodes.
    """
    members = members_of(frame, rigidities)
    turn = members.transforms()
    axial = response.forces(np.array([0.0, 1.0]))[..., 0]
    found = np.zeros(len(axial), dtype=bool)
    for number, force in enumerate(axial):
        geometric = local_geometric(times * force, rigidities, members.coefficients.lengths)
        world = members.world + turn.transpose(0, 2, 1) @ geometric @ turn
        found[number] = factor_of(pattern, world, frame.springs) is None
    return found


def _none(frame: Frame, pieces: int) -> Modes:
    """No mode of a frame."""
    many = len(frame.members)
    nodes = np.zeros((0, len(frame.nodes), 6))
    return Modes(np.zeros(0), nodes, np.zeros((0, many, pieces + 1, 3)))
