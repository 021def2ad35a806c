"""What a frame must be before it is solved."""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from ..core.errors import SceneError
from .frame import Frame, Rigidities

_SHORT = 1e-9  # of the frame's extent
_POSITIVE = ("axial", "bending_y", "bending_z", "torsion", "shear_y", "shear_z")
_WEIGHTS = ("mass", "rotary")


def check_frame(frame: Frame, rigidities: Rigidities | None = None) -> None:
    """Refuse a frame that cannot be solved, with what is wrong and where.

    Raises SceneError for arrays of the wrong shape, numbers that are not finite, node indices out
    of range, members without length or drawn twice, nodes without a member, parts that are not
    supported, and rigidities that are not positive.
    """
    _check_shapes(frame)
    _check_numbers(frame)
    _check_members(frame)
    _check_supports(frame)
    if rigidities is not None:
        _check_rigidities(frame, rigidities)


def named(frame: Frame, member: int) -> str:
    """“Member 12 (nodes 3 and 4)”, as errors name it."""
    start, end = frame.members[member]
    return f"Member {member} (nodes {start} and {end})"


def listed(items: np.ndarray, most: int = 8) -> str:
    """“3, 4 and 12”, cut after ``most``."""
    words = [str(item) for item in items[:most]]
    if len(items) > most:
        return ", ".join(words) + f" and {len(items) - most} more"
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def _check_shapes(frame: Frame) -> None:
    """Every array has the rows it should have."""
    nodes, members = len(frame.nodes), len(frame.members)
    if not members:
        raise SceneError("The frame has no members: draw at least one between two nodes.")
    wanted = {
        "nodes": (nodes, 3),
        "members": (members, 2),
        "normals": (members, 3),
        "held": (nodes, 6),
        "releases": (members, 12),
        "offsets": (members, 2, 3),
        "springs": (nodes, 6),
    }
    for name, shape in wanted.items():
        values = getattr(frame, name)
        if values is not None and values.shape != shape:
            raise SceneError(
                f"The frame's {name} have the shape {values.shape}; with {nodes} nodes and "
                f"{members} members it must be {shape}."
            )


def _check_numbers(frame: Frame) -> None:
    """Indices exist, and coordinates are numbers."""
    out = (frame.members < 0) | (frame.members >= len(frame.nodes))
    if out.any():
        member, end = np.argwhere(out)[0]
        raise SceneError(
            f"Member {member} refers to node {frame.members[member, end]}, but there are only "
            f"nodes 0 to {len(frame.nodes) - 1}; correct its end."
        )
    for name, what in (
        ("nodes", "Node {} has a coordinate"),
        ("normals", "Member {} has a normal"),
        ("offsets", "Member {} has an offset"),
        ("springs", "Node {} has a spring"),
    ):
        values = getattr(frame, name)
        if values is not None and not np.isfinite(values).all():
            first = np.argwhere(~np.isfinite(values))[0, 0]
            raise SceneError(f"{what.format(first)} that is not a number; correct it.")
    if frame.springs is not None and (frame.springs < 0.0).any():
        first = np.argwhere(frame.springs < 0.0)[0, 0]
        raise SceneError(f"Node {first} has a negative spring; make its stiffness positive.")


def _check_members(frame: Frame) -> None:
    """Members have a length, and no two of them are the same."""
    extent = float(np.ptp(frame.nodes, axis=0).max())
    short = np.flatnonzero(frame.lengths() <= _SHORT * extent)
    if len(short):
        raise SceneError(f"{named(frame, short[0])} has no length; remove it or merge its nodes.")
    low, high = np.sort(frame.members, axis=1).T.astype(np.int64)
    keys = low * len(frame.nodes) + high
    first, count = np.unique(keys, return_counts=True)
    for key in first[count > 1]:
        twice = np.flatnonzero(keys == key)
        middle = frame.ends()[twice].mean(axis=1)  # offsets may keep them apart
        same = np.linalg.norm(middle[1:] - middle[0], axis=1) <= _SHORT * extent
        if same.any():
            other = twice[1:][same][0]
            raise SceneError(
                f"{named(frame, other)} is drawn twice: member {twice[0]} joins the same nodes; "
                "remove one of them."
            )


def _check_supports(frame: Frame) -> None:
    """Every node has a member, and every part that hangs together has supports."""
    count = len(frame.nodes)
    used = np.zeros(count, dtype=bool)
    used[frame.members] = True
    if not used.all():
        alone = np.flatnonzero(~used)
        held = frame.held[alone].any(axis=1)
        if held.any():
            raise SceneError(
                f"Node {alone[held][0]} is held but has no member: the support holds nothing; "
                "remove it or join a member to it."
            )
        raise SceneError(
            f"{'Node' if len(alone) == 1 else 'Nodes'} {listed(alone)} "
            f"{'has' if len(alone) == 1 else 'have'} no member; remove "
            f"{'it' if len(alone) == 1 else 'them'} or join a member."
        )
    resisted = frame.held if frame.springs is None else frame.held | (frame.springs > 0.0)
    if not resisted.any():
        raise SceneError("The frame has no supports: hold at least one node.")
    start, end = frame.members.T
    graph = csr_matrix((np.ones(len(start)), (start, end)), shape=(count, count))
    parts, label = connected_components(graph, directed=False)
    supports = np.bincount(label, resisted.sum(axis=1), parts)
    loose = np.flatnonzero(supports < 6)
    if len(loose):
        nodes = np.flatnonzero(label == loose[0])
        if parts > 1:
            raise SceneError(
                f"The part of the frame with node{'s' if len(nodes) > 1 else ''} {listed(nodes)} "
                f"is apart from the rest and only {int(supports[loose[0]])} of its freedoms are "
                "held; join it to the rest, or hold at least six."
            )
        raise SceneError(
            f"Only {int(supports[loose[0]])} freedoms of the frame are held, so that it can move "
            "as a whole; hold at least six, such as all those of one node."
        )


def _check_rigidities(frame: Frame, rigidities: Rigidities) -> None:
    """Every member resists, by a positive and finite rigidity; shear may be rigid."""
    for name in _POSITIVE + _WEIGHTS:
        values = getattr(rigidities, name)
        if values.shape != (len(frame.members),):
            raise SceneError(
                f"There are {values.shape} values of {name} for {len(frame.members)} members; "
                "give one for each."
            )
        fine = values >= 0.0 if name in _WEIGHTS else values > 0.0
        if not name.startswith("shear"):
            fine &= np.isfinite(values)
        if not fine.all():
            member = int(np.flatnonzero(~fine)[0])
            what = name if name in _WEIGHTS else f"{name.replace('_', ' ')} rigidity"
            kind = "zero or more" if name in _WEIGHTS else "positive"
            raise SceneError(
                f"{named(frame, member)} has {what} {values[member]:g}; it must be {kind}."
            )
