"""What in a frame can move without resistance: found, and named by nodes, members and freedoms."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr
from scipy.sparse import diags_array
from scipy.sparse.linalg import splu

from ..core.errors import SceneError
from ..core.scene import Vector
from .assembly import Pattern
from .check_frame import listed, named
from .factor import Factor
from .frame import Frame, Rigidities
from .stiffness import Members, local_stiffness

# Least eigenvalue of the matrix scaled to a unit diagonal. Mechanisms come out at 1e-17 to 4e-15,
# whatever their size; below the limit rounding would leave fewer than two digits of a solution.
_FREE = 2e-14
_SUSPECT = 1e-12  # one random probe overestimates it
_FREE_END = 1e-9  # the same of a member's released ends alone
_MODES, _ROUNDS, _SHIFT = 6, 6, 1e-11
_STILL = 1e-4  # of the greatest movement
_STRAIN = 1e-5  # a mechanism found to rounding leaves members a hundredth of it
_AXES = ("x", "y", "z")


def check_ends(frame: Frame, rigidities: Rigidities) -> None:
    """Refuse members that move by themselves because too much is released at their ends.

    Raises SceneError which names the member and how it moves.
    """
    if frame.releases is None:
        return
    some = np.flatnonzero(frame.releases.any(axis=1))
    local = local_stiffness(rigidities, frame.lengths())[some]
    scale = 1.0 / np.sqrt(local[:, np.arange(12), np.arange(12)])
    both = frame.releases[some, :, None] & frame.releases[some, None, :]
    alone = np.where(both, local * scale[:, :, None] * scale[:, None, :], 0.0)
    alone[:, np.arange(12), np.arange(12)] = 1.0
    least, modes = np.linalg.eigh(alone)
    loose = np.flatnonzero(least[:, 0] < _FREE_END)
    if not len(loose):
        return
    member = int(some[loose[0]])
    mode = np.abs(modes[loose[0], :, 0] * scale[loose[0]])
    freedom = int(np.argmax(mode)) % 6
    if freedom == 0:
        moves, reason = "slide along its own axis", "axial force is released at both ends"
    elif freedom == 3:
        moves, reason = "spin about its own axis", "torsion is released at both ends"
    else:
        moves = f"swing along its local {'y' if freedom in (1, 5) else 'z'}"
        reason = "shear and bending are released at too many of its ends"
    raise SceneError(f"{named(frame, member)} can {moves}: its {reason}; release fewer.")


def check_factor(frame: Frame, pattern: Pattern, members: Members, factor: Factor | None) -> None:
    """Refuse members whose stiffness lets something move freely.

    ``factor`` is that of the whole matrix, or None where it was not positive definite. A random
    load is solved for; only if the answer is very large, the smallest eigenvalue of the matrix
    scaled to a unit diagonal is looked for.

    Raises SceneError which names the nodes and how they move; or the members that deform in such a
    motion beside those that are far stiffer, where rounding would leave no digit of an answer.
    """
    count, world = len(pattern.free), members.world
    if not count:
        return
    scale = np.sqrt(np.maximum(pattern.diagonal_of(world, frame.springs), 0.0))
    if factor is not None and (scale > 0.0).all():
        probe = np.random.default_rng(0).standard_normal(count)
        for limit in (_SUSPECT, _FREE, _FREE):
            probe /= np.linalg.norm(probe)
            probe = scale * factor.solve((scale * probe)[:, None])[:, 0]
            if np.linalg.norm(probe) * limit < 1.0:
                return
    motion = _free_motion(frame, pattern, world, scale)
    strain = _strain(frame, members, motion)
    if strain.max() > _STRAIN:
        soft = int(np.argmax(strain))
        hard = int(np.argmax(np.abs(world[:, :3, :3]).max(axis=(1, 2))))
        raise SceneError(
            f"{named(frame, soft)} gives way so easily beside {named(frame, hard).lower()} that "
            "rounding leaves no digit of the answer; bring their lengths and stiffness closer "
            "together."
        )
    raise SceneError(_explained(frame, motion))


def _free_motion(frame: Frame, pattern: Pattern, world: Vector, scale: Vector) -> Vector:
    """One motion (N, 6) that meets no resistance, of as few nodes as can be found."""
    alone = _alone(frame, pattern, world)
    if alone is not None:
        return alone
    inverse = 1.0 / scale
    scaled = diags_array(inverse) @ pattern.matrix(world, frame.springs) @ diags_array(inverse)
    scaled = scaled.tocsc()
    count = len(scale)
    factor = splu(scaled + _SHIFT * diags_array(np.ones(count), format="csc"))
    modes = np.random.default_rng(0).standard_normal((count, min(_MODES, count)))
    for _ in range(_ROUNDS):
        modes = np.linalg.qr(factor.solve(modes))[0]
    values, mix = np.linalg.eigh(modes.T @ (scaled @ modes))
    free = modes @ mix[:, values <= max(10.0 * abs(values[0]), _FREE)]
    first = qr(free.T, mode="r", pivoting=True)[-1][: free.shape[1]]
    sparse = free @ np.linalg.inv(free[first])  # each motion alone moves its own first freedom
    motions = pattern.spread(sparse * inverse[:, None])
    moving = [_moving(frame, motion).sum() for motion in motions]
    return motions[int(np.argmin(moving))]


def _strain(frame: Frame, members: Members, motion: Vector) -> Vector:
    """By how much each member (M,) deforms in a motion (N, 6), over the greatest movement."""
    at_nodes = motion[frame.members].reshape(1, -1, 12)
    ends = members.end_displacements(at_nodes, np.zeros_like(at_nodes))[0]
    across = (ends[:, 6:] - ends[:, :6]) / members.coefficients.lengths[:, None]
    turns = np.stack([ends[:, 3:6], ends[:, 9:12]], axis=1)
    turns[:, :, 1] += across[:, None, 2]  # rotations against the chord
    turns[:, :, 2] -= across[:, None, 1]
    turns[:, :, 0] = turns[:, 1:, 0] - turns[:, :1, 0]
    deformed = np.maximum(np.abs(turns).max(axis=(1, 2)), np.abs(across[:, 0]))
    size = np.abs(motion[:, :3]).max() / _lever(frame) + np.abs(motion[:, 3:]).max()
    return deformed / size


def _alone(frame: Frame, pattern: Pattern, world: Vector) -> Vector | None:
    """A motion (N, 6) of a kind that single nodes make by themselves, of all that make it."""
    count = len(frame.nodes)
    own = np.zeros((count, 6, 6))
    np.add.at(own, frame.members[:, 0], world[:, :6, :6])
    np.add.at(own, frame.members[:, 1], world[:, 6:, 6:])
    diagonal = np.arange(6)
    if frame.springs is not None:
        own[:, diagonal, diagonal] += frame.springs
    free = ~frame.held
    own = np.where(free[:, :, None] & free[:, None, :], own, 0.0)
    size = own[:, diagonal, diagonal]
    scale = np.sqrt(np.where(free & (size > 0.0), size, 1.0))
    own /= scale[:, :, None] * scale[:, None, :]
    own[:, diagonal, diagonal] += frame.held
    values, modes = np.linalg.eigh(own)
    loose = np.flatnonzero(values[:, 0] < _FREE)
    if not len(loose):
        return None
    motion = np.zeros((count, 6))
    motion[loose] = modes[loose, :, 0] / scale[loose]
    first = motion[loose[0]]
    if (frame.held[loose] != frame.held[loose[0]]).any():
        loose = loose[:1]
    same = np.abs(motion[loose] @ first) > 0.999 * np.linalg.norm(first) * np.linalg.norm(
        motion[loose], axis=1
    )
    others = np.setdiff1d(np.arange(count), loose[same])
    motion[others] = 0.0
    return motion


def _lever(frame: Frame) -> float:
    """The length that makes rotations comparable with displacements, in m."""
    return float(frame.lengths().mean())


def _moving(frame: Frame, motion: Vector) -> NDArray[np.bool_]:
    """Which nodes (N,) take part in a motion (N, 6)."""
    size = np.abs(motion * np.repeat([1.0, _lever(frame)], 3)).max(axis=1)
    return size > _STILL * size.max()


def _explained(frame: Frame, motion: Vector) -> str:
    """The sentence: who moves, how, and what would hold it."""
    moving = np.flatnonzero(_moving(frame, motion))
    size = np.linalg.norm(motion[:, :3], axis=1), np.linalg.norm(motion[:, 3:], axis=1)
    shifts = size[0].max() > _STILL * size[1].max() * _lever(frame)
    worst = int(np.argmax(size[0] if shifts else size[1]))
    others = moving[moving != worst]
    who, held = f"Node {worst}", "it"
    if len(moving) == len(frame.nodes):
        who = f"The whole frame, node {worst} most,"
    elif len(others) == 1:
        who, held = f"Node {worst} and node {others[0]}", "one of them"
    elif len(others):
        who, held = f"Node {worst} and {len(others)} others ({listed(others)})", "one of them"
    direction = motion[worst, :3] if shifts else motion[worst, 3:]
    how = "move along" if shifts else "turn about"
    return (
        f"{who} can {how} {_axis(frame, worst, direction)}: nothing resists it; "
        f"hold {held}{_remedy(frame, moving)}."
    )


def _axis(frame: Frame, node: int, direction: Vector) -> str:
    """A direction as x, y or z, as a member's axis, or as numbers."""
    unit = direction / np.linalg.norm(direction)
    if np.abs(unit).max() > 1.0 - 1e-6:
        return _AXES[int(np.argmax(np.abs(unit)))]
    at = np.flatnonzero((frame.members == node).any(axis=1))
    along = np.abs(frame.axes()[at, 0] @ unit)
    if len(at) and along.max() > 1.0 - 1e-6:
        return f"the axis of {named(frame, int(at[np.argmax(along)])).lower()}"
    unit = unit * np.sign(unit[np.argmax(np.abs(unit))])
    return "({:.2f}, {:.2f}, {:.2f})".format(*(unit + 0.0))


def _remedy(frame: Frame, moving: NDArray[np.intp]) -> str:
    """What else would help: a release less of the members at the nodes that move."""
    if frame.releases is None:
        return ""
    near = np.isin(frame.members, moving).any(axis=1)
    members = np.flatnonzero(near & frame.releases.any(axis=1))
    if not len(members):
        return ""
    many = "a release of members" if len(members) > 1 else "a release of member"
    return f", or remove {many} {listed(members, 4)}"
