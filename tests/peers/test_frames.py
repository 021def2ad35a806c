"""Frames as PyNite, OpenSees and CALFEM solve them.

PyNite's beams are Euler–Bernoulli's and its Y is up: x, y, z become x, z, −y. OpenSees' take shear
and rigid arms, but loads only even along a member. CALFEM's take neither, nor hinges.
"""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.structure.linear import solve_frame
from structure.frames import random_frame, random_loads, random_rigidities

pytestmark = pytest.mark.peer
WITHIN = 1e-8
Y_UP = np.array([(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)])


def frames(count, seed, releases=0.0, even=False, shear=False):
    """So many random frames that stand, with loads and our answer."""
    generator = np.random.default_rng(seed)
    while count:
        frame = random_frame(generator, releases=releases)
        rigidities = random_rigidities(generator, len(frame.members), shear)
        loads = random_loads(generator, frame)
        loads = replace(loads, gravity=np.zeros_like(loads.gravity))
        if even:
            loads.line[:, :, 1] = loads.line[:, :, 0]
        try:
            response = solve_frame(frame, rigidities, loads)
        except SceneError:
            continue
        yield frame, rigidities, loads, response
        count -= 1


def agree(ours, theirs):
    """The greatest difference of forces, and of moments, over the greatest of them."""
    ours = ours.reshape(-1, 2, 3)
    apart = np.abs(ours - np.reshape(theirs, ours.shape)).max(axis=(0, 2))
    return float((apart / np.abs(ours).max(axis=(0, 2))).max())


def pynite_answer(pynite, frame, rigidities, loads):
    """Displacements and reactions (N, 6), and end forces (M, 12) on the same local axes."""
    model = pynite.FEModel3D()
    model.add_material("one", 1.0, 1.0, 0.3, 0.0)
    for node, point in enumerate(frame.nodes @ Y_UP.T):
        model.add_node(str(node), *map(float, point))
        x, y, z, rx, ry, rz = map(bool, frame.held[node])
        model.def_support(str(node), x, z, y, rx, rz, ry)
        force = (loads.nodal[0, node].reshape(2, 3) @ Y_UP.T).ravel()
        for name, value in zip(("FX", "FY", "FZ", "MX", "MY", "MZ"), force, strict=True):
            model.add_node_load(str(node), name, float(value))
    axes = frame.axes() @ Y_UP.T
    for member, (start, end) in enumerate(frame.members):
        name = str(member)
        stiffness = (rigidities.axial, rigidities.bending_y, rigidities.bending_z)
        section = [float(values[member]) for values in (*stiffness, rigidities.torsion)]
        model.add_section(name, *section)
        model.add_member(name, str(start), str(end), "one", name)
        zero = model.members[name].T()[:3, :3]
        roll = np.arctan2(axes[member, 1] @ zero[2], axes[member, 1] @ zero[1])
        model.members[name].rotation = float(np.degrees(roll))
        if frame.releases is not None:
            model.def_releases(name, *map(bool, frame.releases[member]))
        first, last = loads.line[0, member] @ Y_UP.T
        for axis, a, b in zip(("FX", "FY", "FZ"), first, last, strict=True):
            model.add_member_dist_load(name, axis, float(a), float(b))
    model.analyze_linear(check_stability=False)

    def read(names):
        values = [
            [getattr(node, name)["Combo 1"] for name in names] for node in model.nodes.values()
        ]
        return (np.array(values).reshape(-1, 2, 3) @ Y_UP).reshape(-1, 6)

    moved = read(("DX", "DY", "DZ", "RX", "RY", "RZ"))
    reactions = read(("RxnFX", "RxnFY", "RxnFZ", "RxnMX", "RxnMY", "RxnMZ"))
    ends = np.array([member.f().ravel() for member in model.members.values()])
    return moved, reactions, ends


def test_two_hundred_random_frames_answer_as_pynite_says():
    pynite = pytest.importorskip("Pynite")
    worst = np.zeros(3)
    for releases, seed in ((0.0, 1), (0.12, 2)):
        for frame, rigidities, loads, response in frames(100, seed, releases):
            moved, reactions, ends = pynite_answer(pynite, frame, rigidities, loads)
            found = (
                agree(response.displacements[0], moved),
                agree(response.reactions[0], reactions),
                agree(response.end_forces[0], ends),
            )
            worst = np.maximum(worst, found)
    assert worst.max() < WITHIN, worst


def opensees_answer(ops, frame, rigidities, loads, shear):
    """Displacements and reactions (N, 6), and end forces (M, 12) in local axes."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for node, point in enumerate(frame.nodes):
        ops.node(node, *map(float, point))
        ops.fix(node, *map(int, frame.held[node]))
    for member, (start, end) in enumerate(frame.members):
        arms = () if frame.offsets is None else ("-jntOffset", *frame.offsets[member].ravel())
        ops.geomTransf("Linear", member, *map(float, frame.normals[member]), *arms)
        bending = rigidities.bending_y[member], rigidities.bending_z[member]
        ends = (member, int(start), int(end))
        if shear:
            areas = rigidities.shear_y[member], rigidities.shear_z[member]
            values = (1.0, 1.0, rigidities.axial[member], rigidities.torsion[member], *bending)
            ops.element("ElasticTimoshenkoBeam", *ends, *map(float, (*values, *areas)), member)
        else:
            values = (rigidities.axial[member], 1.0, 1.0, rigidities.torsion[member], *bending)
            ops.element("elasticBeamColumn", *ends, *map(float, values), member)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    local = np.einsum("mij,mj->mi", frame.axes(), loads.line[0, :, 0])
    for node in range(len(frame.nodes)):
        ops.load(node, *map(float, loads.nodal[0, node]))
    for member, (along, across, up) in enumerate(local):
        uniform = ("-beamUniform", float(across), float(up), float(along))
        ops.eleLoad("-ele", member, "-type", *uniform)
    ops.system("FullGeneral")
    ops.numberer("Plain")
    ops.constraints("Plain")
    ops.integrator("LoadControl", 1.0)
    ops.algorithm("Linear")
    ops.analysis("Static", "-noWarnings")
    assert ops.analyze(1) == 0
    ops.reactions()
    nodes = range(len(frame.nodes))
    moved = np.array([ops.nodeDisp(node) for node in nodes])
    reactions = np.array([ops.nodeReaction(node) for node in nodes])
    forces = [ops.eleResponse(member, "localForces") for member in range(len(frame.members))]
    ops.wipe()
    return moved, reactions, np.array(forces)


@pytest.mark.parametrize("shear", [True, False])
def test_random_frames_with_shear_or_with_rigid_arms_answer_as_opensees_says(shear):
    ops = pytest.importorskip("openseespy.opensees")
    generator = np.random.default_rng(5)
    worst = np.zeros(3)
    for frame, rigidities, loads, response in frames(60, 3, even=True, shear=shear):
        if not shear:
            arms = generator.standard_normal((len(frame.members), 2, 3)) * 0.2
            frame = replace(frame, offsets=arms)
            response = solve_frame(frame, rigidities, loads)
        moved, reactions, ends = opensees_answer(ops, frame, rigidities, loads, shear)
        held = np.where(frame.held, reactions, 0.0)
        found = (
            agree(response.displacements[0], moved),
            agree(response.reactions[0], held),
            agree(response.end_forces[0], ends),
        )
        worst = np.maximum(worst, found)
    assert worst.max() < WITHIN, worst


def test_random_frames_answer_as_calfem_says(monkeypatch):
    for name in ("matrix", "asmatrix"):  # which CALFEM replaces for the whole process
        monkeypatch.setattr(np, name, getattr(np, name))
    core = pytest.importorskip("calfem.core")
    worst = np.zeros(2)
    for frame, rigidities, loads, response in frames(40, 4, even=True):
        count = 6 * len(frame.nodes)
        matrix, right = np.zeros((count, count)), loads.nodal[0].reshape(-1, 1).copy()
        local = np.einsum("mij,mj->mi", frame.axes(), loads.line[0, :, 0])
        for member, ends in enumerate(frame.members):
            x, y, z = frame.nodes[ends].T
            section = [1.0, 1.0, rigidities.axial[member], rigidities.bending_y[member]]
            section += [rigidities.bending_z[member], rigidities.torsion[member]]
            stiffness, force = core.beam3e(
                x, y, z, frame.normals[member], section, [*local[member], 0.0]
            )
            place = (6 * ends[:, None] + np.arange(6)).ravel()
            matrix[np.ix_(place, place)] += stiffness
            right[place] += force
        free = ~frame.held.ravel()
        moved = np.zeros((count, 1))
        moved[free] = np.linalg.solve(matrix[np.ix_(free, free)], right[free])
        reactions = np.where(free[:, None], 0.0, matrix @ moved - right)
        found = (
            agree(response.displacements[0], moved),
            agree(response.reactions[0], reactions),
        )
        worst = np.maximum(worst, found)
    assert worst.max() < WITHIN, worst
