"""Members between displaced nodes, to be drawn."""

import numpy as np

from ..core.scene import Vector
from .frame import Frame


def bent_members(frame: Frame, displacements: Vector, stations: Vector) -> tuple[Vector, Vector]:
    """Where the members' axes go, and how their ends turn, when the nodes move.

    ``displacements`` (N, 6) in m and rad, world axes; ``stations`` (S,) in 0..1 of the length.
    Returns deflections (M, S, 3) in m and rotations (M, 2, 3) in rad, world axes, by Hermite's
    cubic between the ends: what a load between them adds is left out, releases are not followed. As
    `Response.deflections` without loads for Euler–Bernoulli beams.
    """
    ends = displacements[frame.members]
    shifts, turns = ends[..., :3].copy(), ends[..., 3:]
    if frame.offsets is not None:
        shifts += np.cross(turns, frame.offsets)
    along = frame.axes()[:, 0]
    slopes = np.cross(turns, along[:, None]) * frame.lengths()[:, None, None]
    stretch = np.einsum("mi,mi->m", shifts[:, 1] - shifts[:, 0], along)[:, None, None]
    t = np.asarray(stations, dtype=np.float64)[:, None]
    deflections = (
        (1 - 3 * t**2 + 2 * t**3) * shifts[:, :1]
        + (3 * t**2 - 2 * t**3) * shifts[:, 1:]
        + (t - 2 * t**2 + t**3) * slopes[:, :1]
        + (t**3 - t**2) * slopes[:, 1:]
    )
    even = t - (3 * t**2 - 2 * t**3)  # along the axis a member stretches evenly
    return deflections + even * stretch * along[:, None], turns
