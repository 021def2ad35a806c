"""Free vibration: the frequencies and shapes in which an unloaded frame swings."""

from dataclasses import replace

import numpy as np

from ..core.errors import SceneError
from ..core.scene import Vector
from .assembly import pattern_of
from .beam_shapes import local_mass
from .check_frame import check_frame
from .frame import Frame, Rigidities
from .linear import factor_of, factorise
from .loads import GRAVITY, Loads
from .modes import Modes, greatest_eigenpairs, scaled
from .stiffness import members_of
from .subdivision import along_members, repeated, subdivided

PIECES = 2


def natural_frequencies(
    frame: Frame,
    rigidities: Rigidities,
    count: int,
    added_mass: Vector | None = None,
    *,
    pieces: int = PIECES,
) -> tuple[Vector, Vector]:
    """`vibration_modes`, of which the values in Hz (n,) and the nodes' displacements (n, N, 6)."""
    modes = vibration_modes(frame, rigidities, count, added_mass, pieces=pieces)
    return modes.values, modes.nodes


def vibration_modes(
    frame: Frame,
    rigidities: Rigidities,
    count: int,
    added_mass: Vector | None = None,
    *,
    pieces: int = PIECES,
) -> Modes:
    """The ``count`` lowest natural frequencies in Hz, rising, with their modes.

    K φ = ω² M φ with the consistent mass of the members, rotary inertia and shear included, and
    ``added_mass`` (N,) in kg at the nodes. Members are divided into ``pieces``: two put the first
    frequency of a hinged beam 0.4 % too high, four 0.03 %. A frame that nothing holds has six
    frequencies of 0 first.

    Raises SceneError as `factorise` where something holds the frame; for members without mass and
    masses that are negative or no numbers.
    """
    _check_mass(frame, rigidities, added_mass)
    fine, fine_rigidities = subdivided(frame, pieces), repeated(rigidities, pieces)
    pattern = pattern_of(fine)
    held = frame.held.any() or (frame.springs is not None and (frame.springs > 0).any())
    if held:
        system = factorise(fine, fine_rigidities, pattern)
        members, factor, shift = system.members, system.factor, 0.0
    else:
        check_frame(replace(frame, held=np.ones_like(frame.held)), rigidities)
        members, factor = members_of(fine, fine_rigidities), None
        shift = _elastic(frame, rigidities)

    turn = members.transforms()
    mass = local_mass(fine_rigidities, members.coefficients.lengths)
    mass = turn.transpose(0, 2, 1) @ mass @ turn
    nodal = np.zeros(fine.held.shape)
    if added_mass is not None:
        nodal[: len(frame.nodes), :3] = added_mass[:, None]
    springs = np.zeros(fine.held.shape) if fine.springs is None else fine.springs
    stiff, ground = members.world + shift * mass, springs + shift * nodal
    factor = factor or factor_of(pattern, stiff, ground)
    assert factor is not None
    inverse, vectors = greatest_eigenpairs(
        pattern.matrix(mass, nodal), pattern.matrix(stiff, ground), factor, count
    )
    moved = pattern.spread(vectors)
    shapes = scaled(moved[:, : len(frame.nodes)], along_members(frame, moved, pieces))
    squares = np.maximum(1 / inverse - shift, 0.0)
    return Modes(np.sqrt(squares) / (2 * np.pi), *shapes)


def carried_mass(frame: Frame, loads: Loads) -> Vector:
    """What the permanent load cases weigh besides the members, as masses (N,) in kg at the nodes.

    The downward part of loads on nodes and on members, these by the lever rule, over standard
    gravity. Variable loads are left out.
    """
    lasting = np.array([action == "permanent" for action in loads.actions], dtype=bool)
    down = -loads.nodal[lasting, :, 2].sum(axis=0)
    start, end = -loads.line[lasting, :, :, 2].sum(axis=0).T * frame.lengths() / 6
    np.add.at(down, frame.members[:, 0], 2 * start + end)
    np.add.at(down, frame.members[:, 1], start + 2 * end)
    return np.maximum(down, 0.0) / GRAVITY


def _elastic(frame: Frame, rigidities: Rigidities) -> float:
    """About the ω² in 1/s² of a free beam as long as the frame, from which rigid motion is told."""
    extent = float(np.linalg.norm(np.ptp(frame.nodes, axis=0)))
    return 500 * float(np.mean(rigidities.bending_y) / np.mean(rigidities.mass)) / extent**4


def _check_mass(frame: Frame, rigidities: Rigidities, added_mass: Vector | None) -> None:
    """Every member and no node has less mass than none."""
    without = np.flatnonzero(~(rigidities.mass > 0))
    if len(without):
        raise SceneError(
            f"Member {without[0]} has no mass, so that it has no natural frequency; give it a "
            "density."
        )
    if added_mass is None:
        return
    if added_mass.shape != (len(frame.nodes),):
        raise SceneError(
            f"{added_mass.shape} masses are added to {len(frame.nodes)} nodes; give one for each."
        )
    wrong = np.flatnonzero(~(added_mass >= 0) | ~np.isfinite(added_mass))
    if len(wrong):
        raise SceneError(
            f"Node {wrong[0]} is given a mass of {added_mass[wrong[0]]:g} kg; it must be zero or "
            "more."
        )
