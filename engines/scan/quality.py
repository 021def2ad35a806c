"""The quality report of a reading: its figures, and what is to be said of them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from ..core.scene import Mesh, Vector
from .align import FIT_CELL, Aligned
from .fold import Fold
from .frame import Frame
from .roughness import Roughness
from .unroll import Face, cells_of

_COMPARED = 20_000  # points, for the distance from scan to patch
_TO_95 = 1.96  # standard errors
_SEEN = 0.7  # share of the piece's rectangle below which the gaps are told
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

    ``valley`` is its phase, ``folds`` and ``found`` are those of its faces, ``patch`` is the first
    face rebuilt, ``points`` how many the scan has.
    """
    frame, layers, first, rough = piece.frame, piece.layers, folds[0], found[0]
    table: dict[str, tuple[float, str, float | None]] = {
        "layer_height": (layers.period, "m", _TO_95 * layers.period_error),
        "tilt": (float(np.degrees(layers.tilt)), "deg", None),
        "phase": (valley, "layers", None),
        "confidence": (layers.confidence, "", None),
        "strength": (layers.strength, "dB", None),
        "depth": (first.depth, "m", _TO_95 * np.sqrt(2) * float(np.median(first.error))),
        "profile_error": (float(np.sqrt(np.mean(first.error**2))), "m", None),
        "fold_scatter": (first.spread, "m", None),
        "roughness": (rough.rms, "m", None),
        "noise": (rough.noise, "m", None),
        "points": (points, "", None),
        "points_used": (sum(one.points for one in folds), "", None),
        "coverage": (float(np.mean(np.isfinite(rough.raw))), "", None),
        "scan_to_patch": (_distance(piece.faces[0], patch), "m", None),
    }
    if frame.curvature:
        error = _TO_95 * piece.tilt_error
        table["tilt"] = (table["tilt"][0], "deg", float(np.degrees(error)))
        table["radius"] = (frame.radius, "m", None)
        around = 2 * np.pi * frame.radius / layers.period
        table["rise_of_a_turn"] = (np.tan(layers.tilt) * around, "layers", error * around)
    if len(folds) > 1:
        table["depth_inner"] = (folds[1].depth, "m", None)
        table["roughness_inner"] = (found[1].rms, "m", None)
        wall = _walls(piece.faces, frame)
        table["wall_thickness"] = (float(np.mean(wall)), "m", None)
        table["wall_thickness_min"] = (float(np.percentile(wall, 1)), "m", None)
    return {
        name: {"value": float(value), "unit": unit}
        | ({} if error is None else {"uncertainty": float(error)})
        for name, (value, unit, error) in table.items()
    }


def remarks(piece: Aligned, figures: dict[str, dict[str, Any]]) -> list[str]:
    """What a person should know of a reading with these ``figures``."""
    notes = [_which_way(piece.frame)]
    if piece.frame.curvature:
        notes.append(_climb(**figures["rise_of_a_turn"]))
    else:
        notes.append("A flat piece has no axis: up is square to the layers, and the tilt is 0.")
    if figures.get("wall_thickness_min", {"value": 1.0})["value"] <= 0:
        notes.append("The faces meet or cross: the wall has no thickness somewhere; scan it anew.")
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
    said = f"{value:.2f} ± {uncertainty:.2f} {unit} a turn"
    near = max(_NEAR, uncertainty)
    if abs(value) < near:
        return f"The layers are level on the axis ({said}): stacked rings, or no telling."
    if abs(abs(value) - 1) < near:
        return f"The layers climb by about one a turn ({said}): a spiral."
    return (
        f"The layers are tilted against the piece's axis ({said}): neither rings nor a spiral of "
        "one layer; the tilt is taken out."
    )


def _walls(faces: Sequence[Face], frame: Frame) -> Vector:
    """The wall's thickness in m wherever both faces were seen (N,)."""
    outer, inner = (cells_of(face, FIT_CELL) for face in faces)
    tree = KDTree(np.column_stack([inner.arc, inner.z]))
    away, beside = tree.query(np.column_stack([outer.arc, outer.z]))
    near = away < FIT_CELL
    wall = frame.thickness + outer.height[near] + inner.height[beside[near]]
    return wall if len(wall) else np.array([frame.thickness])


def _distance(face: Face, patch: Mesh) -> float:
    """RMS distance in m from the face's points to the patch, by pymeshlab's Hausdorff filter."""
    import pymeshlab

    points = face.points[:: max(1, len(face.points) // _COMPARED)]
    work = pymeshlab.MeshSet()  # pyright: ignore[reportAttributeAccessIssue]
    cloud = pymeshlab.Mesh(points)  # pyright: ignore[reportAttributeAccessIssue]
    surface = patch.triangles()
    target = pymeshlab.Mesh(  # pyright: ignore[reportAttributeAccessIssue]
        surface.vertices, surface.faces
    )
    work.add_mesh(cloud)
    work.add_mesh(target)
    done = work.get_hausdorff_distance(
        sampledmesh=0,
        targetmesh=1,
        samplevert=True,
        sampleedge=False,
        sampleface=False,
        samplenum=len(points),
        maxdist=pymeshlab.PureValue(5e-3),  # pyright: ignore[reportAttributeAccessIssue]
    )
    return float(done["RMS"])
