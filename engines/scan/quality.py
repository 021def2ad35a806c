"""The quality report of a reading: its figures, and what is to be said of them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from ..core.scene import Mesh, Vector
from .align import FIT_CELL, Aligned
from .closest import closest, target_of
from .fold import Fold
from .frame import Frame
from .roughness import Roughness
from .scatter import TO_95
from .unroll import Face, cells_of

_COMPARED = 20_000  # points, for the distance from scan to patch
_FAR = 5e-3  # m, farther from the patch a point does not belong to it
_SEEN = 0.7  # share of the piece's rectangle below which the gaps are told
_BLUNT = 0.02  # share of the depth that a blunted valley may lack before it is told
_NEAR = 0.25  # layers a turn that still count as none or one


def figures_of(
    piece: Aligned,
    valley: float,
    folds: Sequence[Fold],
    found: Sequence[Roughness],
    patch: Mesh,
    points: int,
) -> dict[str, dict[str, Any]]:
    """The figures of a piece: name → value, unit and, where known, the 95 % half-width.

    Half-widths cover noise and roughness as they scatter between parts of the piece, the axis and
    radius that were fitted, and of a depth what a sharp valley loses; not the scanner's own scale.
    ``wall_thickness`` is from crest to crest, ``wall_mean`` the mean over the relief,
    ``wall_thickness_min`` the least, of which 1 % may be less. ``roughness`` is that of all waves,
    ``roughness_texture`` that of those in the relief's texture.

    ``valley`` is its phase, ``folds`` and ``found`` are those of its faces, ``patch`` is the first
    face rebuilt, ``points`` how many the scan has.
    """
    frame, layers, first, rough = piece.frame, piece.layers, folds[0], found[0]
    table: dict[str, tuple[float, str, float | None]] = {
        "layer_height": (layers.period, "m", TO_95 * piece.period_error),
        "tilt": (float(np.degrees(layers.tilt)), "deg", None),
        "phase": (valley, "layers", None),
        "confidence": (layers.confidence, "", None),
        "strength": (layers.strength, "dB", None),
        "depth": (first.depth, "m", _depth_error(first)),
        "profile_error": (float(np.sqrt(np.mean(first.error**2))), "m", None),
        "fold_scatter": (first.spread, "m", None),
        "roughness": (rough.rms, "m", None),
        "roughness_texture": (rough.held, "m", None),
        "noise": (rough.noise, "m", None),
        "points": (points, "", None),
        "points_used": (sum(one.points for one in folds), "", None),
        "coverage": (float(np.mean(np.isfinite(rough.raw))), "", None),
        "scan_to_patch": (_distance(piece.faces[0], patch), "m", None),
    }
    if frame.curvature:
        error = TO_95 * piece.tilt_error
        table["tilt"] = (table["tilt"][0], "deg", float(np.degrees(error)))
        table["radius"] = (frame.radius, "m", None)
        around = 2 * np.pi * frame.radius / layers.period
        table["rise_of_a_turn"] = (np.tan(layers.tilt) * around, "layers", error * around)
    if len(folds) > 1:
        table["depth_inner"] = (folds[1].depth, "m", _depth_error(folds[1]))
        table["roughness_inner"] = (found[1].rms, "m", None)
        table["noise_inner"] = (found[1].noise, "m", None)
        wall, crests = _walls(piece, valley, folds)
        table["wall_thickness"] = (float(np.mean(crests)), "m", None)
        table["wall_mean"] = (float(np.mean(wall)), "m", None)
        table["wall_thickness_min"] = (float(np.percentile(wall, 1)), "m", None)
    return {
        name: {"value": float(value), "unit": unit}
        | ({} if error is None else {"uncertainty": float(error)})
        for name, (value, unit, error) in table.items()
    }


def remarks(piece: Aligned, folds: Sequence[Fold], figures: dict[str, dict[str, Any]]) -> list[str]:
    """What a person should know of a reading with these ``figures`` and ``folds``."""
    notes = [_which_way(piece.frame)]
    if piece.frame.curvature:
        notes.append(_climb(**figures["rise_of_a_turn"]))
    else:
        notes.append("A flat piece has no axis: up is square to the layers, and the tilt is 0.")
    if figures.get("wall_thickness_min", {"value": 1.0})["value"] <= 0:
        notes.append("The faces meet or cross: the wall has no thickness somewhere; scan it anew.")
    if folds[0].blunt > _BLUNT * folds[0].depth:
        notes.append(
            "The valleys are as sharp as the scan can tell, or sharper: up to "
            f"{folds[0].blunt * 1e3:.2g} mm of their depth may be missing; the depth's interval "
            "includes that, more points or less noise narrow it."
        )
    seen = figures["coverage"]["value"]
    if seen < _SEEN:
        notes.append(
            f"Only {100 * seen:.0f} % of the piece's rectangle was seen; the rest of the patch is "
            "made up."
        )
    return notes


def _which_way(frame: Frame) -> str:
    up = frame.axes[2]
    axis = int(np.argmax(np.abs(up)))
    return (
        f"Up is taken toward the file's {'+' if up[axis] > 0 else '−'}{'XYZ'[axis]}; tick Upside "
        "Down if the piece stands on its head there."
    )


def _climb(value: float, unit: str, uncertainty: float) -> str:
    said = f"{value:z.2f} ± {uncertainty:.2f} {unit} a turn"
    near = max(_NEAR, uncertainty)
    if abs(value) < near:
        return f"The layers are level on the axis ({said}): stacked rings, or no telling."
    if abs(abs(value) - 1) < near:
        return f"The layers climb by about one a turn ({said}): a spiral."
    return (
        f"The layers are tilted against the piece's axis ({said}): neither rings nor a spiral of "
        "one layer; the tilt is taken out."
    )


def _depth_error(one: Fold) -> float:
    """The 95 % half-width in m of a depth: its scatter, and what a sharp valley loses."""
    return TO_95 * one.depth_error + one.blunt


def _walls(piece: Aligned, valley: float, folds: Sequence[Fold]) -> tuple[Vector, Vector]:
    """The wall's thickness in m wherever both faces were seen (N,), and from crest to crest."""
    frame = piece.frame
    outer, inner = (cells_of(face, FIT_CELL) for face in piece.faces)
    tree = KDTree(np.column_stack([inner.arc, inner.z]))
    away, beside = tree.query(np.column_stack([outer.arc, outer.z]))
    near = away < FIT_CELL
    if not near.any():
        thickness = np.array([frame.thickness])
        return thickness, thickness + sum(one.base + one.depth for one in folds)
    wall = frame.thickness + outer.height[near] + inner.height[beside[near]]
    crests = wall.copy()
    for one, cells, some in zip(folds, (outer, inner), (near, beside[near]), strict=True):
        phase = piece.layers.phases(cells.arc[some], cells.z[some]) - valley
        crests += one.depth - one.spline()(phase - np.floor(phase))
    return wall, crests


def _distance(face: Face, patch: Mesh) -> float:
    """RMS distance in m from the face's points to the patch."""
    points = face.points[:: max(1, len(face.points) // _COMPARED)]
    feet = closest(points, target_of(patch), _FAR)
    away = feet.distance[feet.face >= 0]
    return float(np.sqrt(np.mean(away**2))) if len(away) else _FAR
