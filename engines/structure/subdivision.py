"""Members divided into equal pieces, so that they bend between their nodes in more than one way."""

from dataclasses import fields, replace

import numpy as np

from ..core.scene import Vector
from .frame import Frame, Rigidities


def subdivided(frame: Frame, pieces: int) -> Frame:
    """The frame with every member in ``pieces``, its own nodes first.

    The pieces of member m are members m · pieces onwards, from its start to its end; between them
    are the nodes N + m · (pieces − 1) onwards. Releases and offsets stay at the members' ends.
    """
    if pieces == 1:
        return frame
    count, many = len(frame.nodes), len(frame.members)
    start, end = frame.ends().transpose(1, 0, 2)
    share = (np.arange(1, pieces) / pieces)[None, :, None]
    inner = start[:, None] + share * (end - start)[:, None]
    between = count + np.arange(many * (pieces - 1)).reshape(many, pieces - 1)
    along = np.column_stack([frame.members[:, 0], between, frame.members[:, 1]])
    members = np.stack([along[:, :-1], along[:, 1:]], axis=-1).reshape(-1, 2)
    return Frame(
        np.concatenate([frame.nodes, inner.reshape(-1, 3)]),
        members.astype(np.int32),
        np.repeat(frame.normals, pieces, axis=0),
        _extended(frame.held, between.size),
        None if frame.releases is None else _at_ends(frame.releases.reshape(many, 2, 6), pieces),
        None if frame.offsets is None else _at_ends(frame.offsets, pieces).reshape(-1, 2, 3),
        None if frame.springs is None else _extended(frame.springs, between.size),
    )


def repeated(rigidities: Rigidities, pieces: int) -> Rigidities:
    """The rigidities of the pieces of every member."""
    each = {f.name: np.repeat(getattr(rigidities, f.name), pieces) for f in fields(rigidities)}
    return replace(rigidities, **each)


def along_members(frame: Frame, moved: Vector, pieces: int) -> Vector:
    """Displacements (n, M, pieces + 1, 3) of members' ends and inner nodes, in world axes.

    ``moved`` (n, N + M · (pieces − 1), 6): of the nodes of the `subdivided` ``frame``.
    """
    count, many = len(frame.nodes), len(frame.members)
    ends = moved[:, frame.members]
    at = ends[..., :3]
    if frame.offsets is not None:
        at = at + np.cross(ends[..., 3:], frame.offsets)
    inner = moved[:, count:, :3].reshape(len(moved), many, pieces - 1, 3)
    return np.concatenate([at[:, :, :1], inner, at[:, :, 1:]], axis=2)


def _extended(values: np.ndarray, more: int) -> np.ndarray:
    """Rows for more nodes, all zero."""
    return np.concatenate([values, np.zeros((more, values.shape[1]), values.dtype)])


def _at_ends(values: np.ndarray, pieces: int) -> np.ndarray:
    """Values (M, 2, n) of the members' ends as those of the pieces (M · pieces, 2n)."""
    many, _, width = values.shape
    spread = np.zeros((many, pieces, 2, width), values.dtype)
    spread[:, 0, 0], spread[:, -1, 1] = values[:, 0], values[:, 1]
    return spread.reshape(many * pieces, 2 * width)
