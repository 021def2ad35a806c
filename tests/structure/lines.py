"""Small frames whose answers are known: straight lines of members, portals, and their loads."""

from itertools import pairwise

import numpy as np
from heliform.engines.structure.frame import Frame, Rigidities
from heliform.engines.structure.loads import Loads

LENGTH, STIFF = 5.0, 1e6
"""m and N·m² about local y; about z a section is twice as stiff, so that bending is along z."""


def rigid(count, stiff=STIFF, axial=1e10, torsion=1e6, shear=np.inf, mass=0.0, rotary=0.0):
    one = np.ones(count)
    return Rigidities(
        axial=one * axial,
        bending_y=one * stiff,
        bending_z=one * 2 * stiff,
        torsion=one * torsion,
        shear_y=one * shear,
        shear_z=one * shear,
        mass=one * mass,
        rotary=one * rotary,
    )


def line_of(count, start=range(6), end=(), length=LENGTH, along=(0.0, 0.0, 1.0), up=(1.0, 0, 0)):
    """A straight line of members with freedoms held at its start and its end."""
    nodes = np.linspace(0, length, count + 1)[:, None] * np.asarray(along, dtype=float)
    members = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1).astype(np.int32)
    held = np.zeros((count + 1, 6), dtype=bool)
    held[0, list(start)] = True
    held[-1, list(end)] = True
    return Frame(nodes, members, np.tile(up, (count, 1)), held)


def loads_of(frame, nodal=None, line=None, gravity=(0.0, 0.0, 0.0)):
    """One load case: ``nodal`` {node: six components}, ``line`` on all members, in N/m."""
    forces = np.zeros((1, len(frame.nodes), 6))
    for node, force in (nodal or {}).items():
        forces[0, node] += force
    along = np.zeros((1, len(frame.members), 2, 3))
    along[:] = (0.0, 0.0, 0.0) if line is None else line
    return Loads(("case",), ("permanent",), np.array([gravity], dtype=float), forces, along)


def portal(fixed, height=1.0, count=1):
    """Two columns and a beam as long, in the plane of x and z, every member in ``count`` pieces."""
    corners = np.array(
        [(0, 0, 0), (0, 0, height), (height, 0, height), (height, 0, 0)], dtype=float
    )
    nodes = [corners[0]]
    for start, end in pairwise(corners):
        nodes += [start + (k + 1) / count * (end - start) for k in range(count)]
    many = len(nodes) - 1
    members = np.stack([np.arange(many), np.arange(1, many + 1)], axis=1).astype(np.int32)
    held = np.zeros((many + 1, 6), dtype=bool)
    held[:, [1, 3, 5]] = True
    held[[0, -1], :3] = True
    held[[0, -1], 4] = fixed
    return Frame(np.array(nodes), members, np.tile((0.0, 1.0, 0.0), (many, 1)), held)
