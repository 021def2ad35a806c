"""Limits of deflection: of members between their ends, of spans, of towers and their storeys."""

from dataclasses import dataclass

import numpy as np

from ..core.errors import ParameterError
from ..core.parameters import param
from ..core.scene import Vector
from .checking import Checked
from .frame import Frame
from .response import Response

STATIONS = np.linspace(0.0, 1.0, 9)
_STEEP = 0.5  # rise over length from which on a member stands rather than spans


@dataclass(frozen=True, slots=True, kw_only=True)
class DeflectionLimits:
    """What may move how far. A divisor of 0 leaves that check out."""

    member: float = param(250.0, "", 0.0, 1e4, "n of L/n for members between their ends")
    span: float = param(0.0, "m", 0.0, 1e3, "Span of the whole; 0 leaves its deflection unchecked")
    whole: float = param(250.0, "", 0.0, 1e4, "n of span/n for the whole's vertical deflection")
    sway: float = param(0.0, "", 0.0, 1e4, "n of h/n for the sway of the whole, usually 500")
    storey: float = param(
        *(0.0, "", 0.0, 1e4), help="n of h/n for the sway over each steep member, usually 300"
    )


def deflection_check(response: Response, frame: Frame, limits: DeflectionLimits) -> Checked:
    """How much the members of a frame use of the limits in K service combinations.

    ``response``: that to the combinations, K of them. As `check_deflections`.
    """
    return check_deflections(response.deflections(STATIONS), frame, limits)


def check_deflections(displacements: Vector, frame: Frame, limits: DeflectionLimits) -> Checked:
    """The same from displacements (K, M, S, 3) in m, world axes, at evenly spaced stations.

    Between a member's ends: across its chord, over L/n. Vertical and sway (EN 1990 A1.4.3): that of
    the place itself, over span/n and over h/n, h being the frame's height above its lowest
    support. Storey: the difference of its ends' sway, over n-th of their difference in height, of
    members that rise by at least half their length.

    Raises ParameterError where no limit is set.
    """
    used: dict[str, Vector] = {}
    if limits.member:
        allowed = frame.lengths() / limits.member
        used[f"Deflection between ends, L/{limits.member:g}"] = (
            _across_chord(displacements, frame) / allowed[:, None]
        )
    if limits.span and limits.whole:
        allowed = limits.span / limits.whole
        name = f"Vertical deflection, {limits.span:g} m/{limits.whole:g}"
        used[name] = np.abs(displacements[..., 2]) / allowed
    if limits.sway:
        height = _height(frame)
        sway = np.hypot(displacements[..., 0], displacements[..., 1])
        name = f"Sway, {height:.4g} m/{limits.sway:g}"
        used[name] = sway * limits.sway / height if height > 0.0 else np.zeros_like(sway)
    if limits.storey:
        used[f"Storey drift, h/{limits.storey:g}"] = _drift(displacements, frame) * limits.storey
    if not used:
        raise ParameterError(
            "No limit of deflection is set; set one above 0, 250 for members for one."
        )
    return _worst(used)


def _across_chord(displacements: Vector, frame: Frame) -> Vector:
    """Deflection (K, M, S) in m of each station across the line between the member's moved ends."""
    part = np.linspace(0.0, 1.0, displacements.shape[2])[:, None]
    start, end = displacements[:, :, :1], displacements[:, :, -1:]
    bent = displacements - (1.0 - part) * start - part * end
    along = frame.axes()[:, 0]
    bent = bent - np.einsum("kmsi,mi->kms", bent, along)[..., None] * along[:, None]
    return np.linalg.norm(bent, axis=3)


def _height(frame: Frame) -> float:
    """The frame's height in m above its lowest support."""
    level = frame.nodes[:, 2]
    held = frame.held[:, :3].any(axis=1)
    return float(level.max() - (level[held].min() if held.any() else level.min()))


def _drift(displacements: Vector, frame: Frame) -> Vector:
    """Sway of the end against the start over the rise (K, M, S), at the last station."""
    ends = frame.ends()
    rise = np.abs(ends[:, 1, 2] - ends[:, 0, 2])
    steep = rise >= _STEEP * frame.lengths()
    apart = displacements[:, :, -1, :2] - displacements[:, :, 0, :2]
    drift = np.zeros(displacements.shape[:3])
    drift[:, steep, -1] = np.linalg.norm(apart[:, steep], axis=2) / rise[steep]
    return drift


def _worst(used: dict[str, Vector]) -> Checked:
    """The worst combination and station of each check and member."""
    values = np.stack(list(used.values()))
    checks, combinations, members, stations = values.shape
    flat = values.transpose(0, 2, 1, 3).reshape(checks, members, combinations * stations)
    where = flat.argmax(axis=2)
    return Checked(
        tuple(used),
        np.take_along_axis(flat, where[:, :, None], axis=2)[:, :, 0],
        (where // stations).astype(np.int32),
        (where % stations).astype(np.int32),
        np.zeros(members, dtype=np.int8),
    )
