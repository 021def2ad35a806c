"""The figures of a comparison, and what is to be said of them."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..core.scene import Vector
from .design import Design
from .deviation import Spread, statistics
from .found import Found
from .judge import Registration

_TO_95 = 1.96  # standard errors
_OFF = 0.3  # of what is near: an RMS above it may be that of another piece


@dataclass(frozen=True, slots=True)
class Measured:
    """All that was measured: the design, the pose on it, the deviation and the layers."""

    design: Design
    pose: Registration
    deviation: Spread
    found: Found | None
    points: int


def figures_of(measured: Measured, tolerance: float) -> dict[str, dict[str, Any]]:
    """The figures: name → value, unit and, where known, the 95 % half-width."""
    table = _of_pose(measured) | _of_deviation(measured, tolerance) | _of_layers(measured)
    return {
        name: {"value": float(value), "unit": unit}
        | ({} if error is None or not np.isfinite(error) else {"uncertainty": float(error)})
        for name, (value, unit, error) in table.items()
        if np.isfinite(value)
    }


Table = dict[str, tuple[float, str, float | None]]


def _of_pose(measured: Measured) -> Table:
    """How the scan had to be moved, and how surely: 180° or the design's size where it is loose."""
    pose, design = measured.pose, measured.design
    turns = np.degrees(np.minimum(_TO_95 * pose.turn_deviation, np.pi))
    shifts = np.minimum(_TO_95 * pose.shift_deviation, 2 * design.size)
    turned = pose.matrix[:3, :3] / pose.scale
    table: Table = {
        "registration_rms": (pose.rms, "m", None),
        "inliers": (pose.inliers, "", None),
        "overlap": (pose.overlap, "", None),
        "pose_tilt": (_degrees(np.arccos(np.clip(turned[2, 2], -1, 1))), "deg", max(turns[:2])),
        "pose_turn": (_degrees(np.arctan2(turned[1, 0], turned[0, 0])), "deg", turns[2]),
        "pose_aside": (float(np.hypot(*pose.matrix[:2, 3])), "m", max(shifts[:2])),
        "pose_height": (pose.matrix[2, 3], "m", shifts[2]),
    }
    if pose.scale_deviation:
        table["scale"] = (pose.scale, "", _TO_95 * pose.scale_deviation)
    return table


def _degrees(angle: float) -> float:
    return float(np.degrees(angle))


def _of_deviation(measured: Measured, tolerance: float) -> Table:
    found = statistics(measured.deviation, measured.design.target.mesh.vertices, tolerance)
    belongs = measured.deviation.belongs
    table: Table = {
        "points": (measured.points, "", None),
        "strays": (1 - float(belongs.mean()), "", None),
        "noise": (measured.deviation.noise, "m", None),
        "coverage": (found.coverage, "", None),
        "deviation_mean": (found.mean, "m", _TO_95 * found.mean_deviation),
        "deviation_rms": (found.rms, "m", _TO_95 * found.rms_deviation),
        "deviation_95": (found.percentile_95, "m", None),
        "deviation_max": (found.largest, "m", None),
        "within_tolerance": (found.within, "", None),
    }
    places = zip("xyz", found.place, strict=True)
    return table | {f"deviation_max_{axis}": (value, "m", None) for axis, value in places}


def _of_layers(measured: Measured) -> Table:
    found, meant = measured.found, measured.design.found
    if found is None or meant is None:
        return {}
    heights = found.layers.height[np.isfinite(found.layers.height)]
    alike = found.rhythmic == meant.rhythmic  # else one is from crest to crest, and one a mean
    table: Table = {
        "layers": (len(heights), "", None),
        "layer_height": (found.pitch, "m", _TO_95 * found.pitch_error),
        "layer_height_spread": (_spread(heights), "m", None),
        "layer_height_design": (meant.pitch, "m", None),
        "bead_depth": (found.depth if found.rhythmic else np.nan, "m", None),
        "wall_width": (found.width if alike else np.nan, "m", _TO_95 * found.width_error),
        "wall_width_design": (meant.width, "m", None),
        "shrinkage_height": (
            *(1 - found.pitch / meant.pitch, ""),
            _TO_95 * float(np.hypot(found.pitch_error, meant.pitch_error)) / meant.pitch,
        ),
    }
    around = measured.design.around
    if around is not None:
        radius = around.girth / (2 * np.pi)
        table["shrinkage_plan"] = (
            *((meant.front - found.front) / radius, ""),
            _TO_95 * float(np.hypot(found.front_error, meant.front_error)) / radius,
        )
    return table


def _spread(values: Vector) -> float:
    return float(values.std(ddof=1)) if len(values) > 1 else np.nan


def remarks(measured: Measured, near: float) -> list[str]:
    """What a person should know of a comparison that took points as far as ``near`` in m."""
    notes = list(measured.pose.notes)
    found, design = measured.found, measured.design
    if measured.pose.rms > _OFF * near:
        notes.append(
            f"The scan lies {measured.pose.rms * 1e3:.2g} mm (RMS) off “{design.name}”: it may be "
            "of another piece, or of another size; see whether the pictures show one."
        )
    if design.around is None:
        notes.append(
            f"“{design.name}” is no wall that stands upright: layers and widths were not measured."
        )
    elif found is None:
        notes.append("The scan shows no side of the wall: layers were not measured.")
    elif not found.rhythmic:
        notes.append(
            "The scan shows no layers: no rhythm explains a tenth of its relief, so layer heights "
            "are not given, nor is the wall's width where the design has layers."
        )
    if found is not None and not np.isfinite(found.width):
        notes.append("The width of the wall was not measured: only one side of it was scanned.")
    return notes
