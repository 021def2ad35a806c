"""Frames for tests: short ways to write them down, random ones, and their loads."""

from dataclasses import replace

import numpy as np
from heliform.engines.structure.frame import FIXED, Frame, Rigidities
from heliform.engines.structure.loads import Loads


def frame_of(nodes, members, held, normals=(0.0, 0.0, 1.0), **more):
    """A frame; ``held`` {node: six booleans}, ``normals`` one for all members or one each."""
    nodes, members = np.asarray(nodes, dtype=float), np.asarray(members, dtype=np.int32)
    supports = np.zeros((len(nodes), 6), dtype=bool)
    for node, freedoms in held.items():
        supports[node] = freedoms
    normals = np.broadcast_to(np.asarray(normals, dtype=float), (len(members), 3)).copy()
    return Frame(nodes, members, normals, supports, **more)


def chain_of(points, held, normals=(0.0, 0.0, 1.0), **more):
    """Members from each point to the next."""
    first = np.arange(len(points) - 1)
    return frame_of(points, np.stack([first, first + 1], axis=1), held, normals, **more)


def stiff(count, axial, bending_y, bending_z, torsion, shear=np.inf, mass=0.0, rotary=0.0):
    """The same rigidities for all members, or given for each."""
    values = (axial, bending_y, bending_z, torsion, shear, shear, mass, rotary)
    return Rigidities(*(np.broadcast_to(np.asarray(v, float), (count,)).copy() for v in values))


def cases_of(frame, *nodal, line=None, gravity=(0.0, 0.0, 0.0)):
    """A load case for each {node: six components}; ``line`` {member: (2, 3) or (3,)} in each."""
    nodal = nodal or ({},)
    loads = Loads(
        tuple(f"case {k}" for k in range(len(nodal))),
        ("imposed",) * len(nodal),
        np.tile(np.asarray(gravity, dtype=float), (len(nodal), 1)),
        np.zeros((len(nodal), len(frame.nodes), 6)),
        np.zeros((len(nodal), len(frame.members), 2, 3)),
    )
    for case, forces in enumerate(nodal):
        for node, force in forces.items():
            loads.nodal[case, node] += force
        for member, force in (line or {}).items():
            loads.line[case, member] += force
    return loads


def arc(radius, start, end, count):
    """Points on an arc about the origin in the plane of x and y, angles in rad."""
    angle = np.linspace(start, end, count + 1)
    return radius * np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)


def rotation(generator):
    """A random rotation matrix."""
    q, r = np.linalg.qr(generator.standard_normal((3, 3)))
    q = q * np.sign(np.diagonal(r))
    return q * np.linalg.det(q)


def turned(vectors, matrix):
    """Vectors, or displacements and rotations in pairs, turned by a rotation matrix."""
    pairs = vectors.reshape(*vectors.shape[:-1], -1, 3)
    return (pairs @ matrix.T).reshape(vectors.shape)


def random_rigidities(generator, count, shear=False):
    """Sections of steel between a slender and a stocky one."""
    one = generator.uniform(0.5, 2.0, (6, count))
    return Rigidities(
        axial=2e9 * one[0],
        bending_y=2e7 * one[1],
        bending_z=6e6 * one[2],
        torsion=5e6 * one[3],
        shear_y=4e8 * one[4] if shear else np.full(count, np.inf),
        shear_z=3e8 * one[5] if shear else np.full(count, np.inf),
        mass=80.0 * one[0],
        rotary=np.ones(count),
    )


def random_frame(generator, releases=0.0, rollers=True):
    """Four to nine nodes in a box of 10 m, joined at random, one held wholly and others in part.

    ``releases``: how likely a member's end is to be hinged about y, z or both, or about x too at
    its start. With many of them a frame may be a mechanism.
    """
    count = int(generator.integers(4, 10))
    nodes = generator.uniform(0.0, 10.0, (count, 3))
    tree = {(int(generator.integers(0, k)), k) for k in range(1, count)}
    extra = {tuple(sorted(generator.choice(count, 2, replace=False).tolist())) for _ in nodes}
    members = np.array(sorted(tree | extra), dtype=np.int32)
    swap = generator.random(len(members)) < 0.5
    members[swap] = members[swap, ::-1]
    held = np.zeros((count, 6), dtype=bool)
    held[0] = FIXED
    if rollers:
        held[-1] = generator.random(6) < 0.5
    frame = Frame(nodes, members, generator.standard_normal((len(members), 3)), held)
    if releases:
        let_go = np.zeros((len(members), 12), dtype=bool)
        for freedom in (4, 5, 10, 11):
            let_go[:, freedom] = generator.random(len(members)) < releases
        let_go[:, 3] = generator.random(len(members)) < releases / 2
        frame = replace(frame, releases=let_go)
    return frame


def random_loads(generator, frame, cases=1):
    """Forces and moments on every node, line loads on every member, and gravity askew."""
    return Loads(
        tuple(f"case {k}" for k in range(cases)),
        ("imposed",) * cases,
        generator.standard_normal((cases, 3)) * 5.0,
        generator.standard_normal((cases, len(frame.nodes), 6)) * 1e4,
        generator.standard_normal((cases, len(frame.members), 2, 3)) * 3e3,
    )


def grid(count, spacing=1.0, bump=0.05):
    """A square grid of count × count fields, bent a little, clamped at its corners."""
    x, y = np.meshgrid(*(np.arange(count + 1.0) * spacing,) * 2, indexing="ij")
    height = bump * count * spacing * np.sin(np.pi * x / x.max()) * np.sin(np.pi * y / y.max())
    index = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    along = np.stack([index[:-1].ravel(), index[1:].ravel()], axis=1)
    across = np.stack([index[:, :-1].ravel(), index[:, 1:].ravel()], axis=1)
    corners = index[[0, 0, -1, -1], [0, -1, 0, -1]]
    return frame_of(
        np.stack([x.ravel(), y.ravel(), height.ravel()], axis=1),
        np.concatenate([along, across]),
        dict.fromkeys(corners.tolist(), FIXED),
    )
