"""Which members hold a structure up when it buckles, and by how much they are to be stiffer."""

import numpy as np

from ..core.scene import Vector
from .buckling import buckling_modes
from .frame import Frame, Rigidities
from .response import Response
from .stiffness import members_of

_ROUNDS = 60  # of halving, to the rounding of float64


def weakest_mode(
    frame: Frame, rigidities: Rigidities, first: Response, factors: Vector
) -> tuple[float, Vector]:
    """The least factor at which one of K combinations buckles the whole, and its strain energy.

    ``first``: the response to the load cases, ``factors`` (K, C). The energy (M,) is that of each
    member in the mode, in any unit. Members are not divided: what bends as a whole is found, not a
    member between its nodes. Infinity, and no energy, where nothing buckles.
    """
    least, shape = np.inf, np.zeros((len(frame.nodes), 6))
    for row in factors:
        found = buckling_modes(frame, rigidities, first.combined(row[None]), 1, pieces=1)
        if len(found.values) and found.values[0] < least:
            least, shape = float(found.values[0]), found.nodes[0]
    ends = shape[frame.members].reshape(len(frame.members), 12)
    stiffness = members_of(frame, rigidities).world
    return least, np.einsum("mi,mij,mj->m", ends, stiffness, ends) / 2


def bracing_factors(energy: Vector, weight: Vector, times: float) -> Vector:
    """By how much the stiffness of each member (M,) grows so that a mode's energy grows ``times``.

    Where it does most for its mass: by s √(U/w) where that is above 1, as the optimality criterion
    of Berke and Venkayya [1974] has it. 1 where ``times`` is no more or there is no energy.
    """
    if times <= 1 or not energy.max(initial=0.0) > 0:
        return np.ones(len(energy))
    density = np.sqrt(np.maximum(energy, 0.0) / weight)
    goal = times * energy.sum()
    low, high = 0.0, 1e6 / density.max()
    for _ in range(_ROUNDS):
        middle = (low + high) / 2
        grown = (energy * np.maximum(1.0, middle * density)).sum()
        low, high = (middle, high) if grown < goal else (low, middle)
    return np.maximum(1.0, high * density)
