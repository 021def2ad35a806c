"""Reading a scan as an analysis: its parameters and its steps."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .. import VERSION
from ..core.errors import SceneError
from ..core.parameters import param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Mesh, Scene
from ..glass.profile import Profile, Style
from .align import Aligned, Search, align, placed
from .clean import clean
from .fold import Fold, fold
from .layers import Layers
from .load import Scan, Unit, load_scan
from .patch import patch_of
from .quality import figures_of, remarks
from .result import FaceReading, Reading
from .roughness import Roughness, find_roughness
from .sample import sample_scan

_LEAST_SHARE = 0.2  # of a face's relief that its layers must explain


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanReading:
    """How a scanned sample is read."""

    file: str = param("", help="PLY, OBJ or STL of the sample; empty takes the built-in one")
    unit: Unit = param(  # noqa: RUF009
        "guess", help="Unit of the file's numbers; “guess” goes by the size of the piece"
    )
    repair: bool = param(True, help="Clean the mesh first: doubled, torn, loose and missing faces")
    sides: Literal["both", "outer", "inner"] = param(
        "both", help="Which faces of the wall to read, where the scan shows them"
    )
    upside_down: bool = param(False, help="Take the other end of the piece as up")
    shortest: float = param(0.5e-3, "m", 0.1e-3, 0.05, "Least layer height to look for")
    longest: float = param(20e-3, "m", 0.5e-3, 0.1, "Greatest layer height to look for")
    confidence: float = param(
        0.99, "", 0.5, 1.0, "How sure the layers must be; below it there are none"
    )
    most: int = param(
        20_000_000, "", 10_000, 100_000_000, "Points to read at most; a larger scan is thinned"
    )


def read_scan(
    scene: Scene, record: ScanReading, *, seed: int = 0, progress: Progress = SILENT
) -> Reading:
    """The relief of the scanned sample in ``record.file``; the scene is not looked at.

    Raises FileError for a file that cannot be read, SceneError where the scan has no layers or no
    faces or cannot be a sample, Cancelled when ``progress`` is asked to stop.
    """
    progress(0.0, "Reading the file")
    if record.file:
        scan = load_scan(Path(record.file), record.unit, record.most)
    else:
        scan = sample_scan(seed=seed)
    return read(scan, record, seed=seed, progress=part(progress, 0.1, 1.0))


def read(scan: Scan, record: ScanReading, *, seed: int = 0, progress: Progress = SILENT) -> Reading:
    """The relief of a scan that is in memory; otherwise as `read_scan`."""
    started = time.perf_counter()
    if record.shortest >= record.longest:
        raise SceneError(
            f"The layer heights to look for run from {record.shortest * 1e3:.3g} to "
            f"{record.longest * 1e3:.3g} mm; set the least below the greatest."
        )
    if record.repair:
        scan = clean(scan, progress=part(progress, 0.0, 0.5))
    notes = list(scan.notes)
    progress(0.5, "Finding the piece")
    search = Search(
        *(record.shortest, record.longest, record.confidence, record.sides, record.upside_down)
    )
    frame, inward = placed(scan, search, seed, notes)
    piece = align(scan, search, frame, inward, part(progress, 0.58, 0.76))
    valley, folds, found, patches = _measured(piece, seed, part(progress, 0.76, 0.97))
    progress(0.97, "Comparing with the scan")
    figures = figures_of(piece, valley, folds, found, patches[0], len(scan.points))
    meta = {
        "quantity": "Relief",
        "unit": "m",
        "scan": scan.name,
        "figures": figures,
        "frame": _frame_table(piece, valley),
        "parameters": to_table(record),
        "seed": seed,
        "version": VERSION,
        "seconds": time.perf_counter() - started,
        "notes": notes + remarks(piece, folds, figures),
    }
    every = zip(piece.faces, folds, found, patches, strict=True)
    readings = tuple(_face_reading(f.name, one, rough, patch) for f, one, rough, patch in every)
    progress(1.0, "Done")
    return Reading(_style(scan.name, folds, found[0], piece.layers.period), readings, meta)


def _measured(
    piece: Aligned, seed: int, progress: Progress
) -> tuple[float, list[Fold], list[Roughness], list[Mesh]]:
    """Phase of the valley, and fold, roughness and patch of each face.

    The first face says where a layer begins.
    """
    folds: list[Fold] = []
    found: list[Roughness] = []
    patches: list[Mesh] = []
    valley: float | None = None
    for index, face in enumerate(piece.faces):
        share = part(progress, index / len(piece.faces), (index + 1) / len(piece.faces))
        share(0.0, f"Folding the {face.name} face")
        layers = piece.layers_of(face)
        one, valley = fold(face, layers, valley)
        _check_depth(one, layers)
        share(0.4, f"Measuring the roughness of the {face.name} face")
        rough = find_roughness(face, layers, one, valley, seed)
        if index == 0:
            _check_share(one, rough, layers)
        share(0.8, f"Rebuilding the {face.name} face")
        patches.append(patch_of(piece.frame, layers, one, valley, rough, face.inner))
        folds.append(one)
        found.append(rough)
    assert valley is not None
    return valley, folds, found, patches


def _frame_table(piece: Aligned, valley: float) -> dict[str, Any]:
    frame, layers = piece.frame, piece.layers
    return {
        "origin": frame.origin.tolist(),
        "out": frame.axes[0].tolist(),
        "along": frame.axes[1].tolist(),
        "up": frame.axes[2].tolist(),
        "curvature": frame.curvature,
        "thickness": frame.thickness,
        "layer_normal": piece.layer_normal.tolist(),
        "wave": layers.wave.tolist(),
        "valley": valley,
    }


def _check_depth(one: Fold, layers: Layers) -> None:
    if one.depth > layers.period:
        raise SceneError(
            f"The relief is {one.depth * 1e3:.3g} mm deep, more than the layer height of "
            f"{layers.period * 1e3:.3g} mm that was found: no bead is; check the unit, the piece "
            "and the range of layer heights."
        )


def _check_share(one: Fold, rough: Roughness, layers: Layers) -> None:
    layered = float(np.var(one.profile))
    share = layered / (layered + rough.rms**2)
    if share < _LEAST_SHARE:
        raise SceneError(
            f"There is no layer period: the likeliest, {layers.period * 1e3:.3g} mm, explains "
            f"{100 * share:.0f} % of the relief, where layers explain more than "
            f"{100 * _LEAST_SHARE:g} %; check the unit and the range of layer heights, or scan a "
            "piece that shows its layers."
        )


def _face_reading(name: str, one: Fold, rough: Roughness, patch: Mesh) -> FaceReading:
    spline = one.spline()
    folded = {
        "phase": one.phase,
        "median": one.median,
        "error": one.error,
        "profile": spline(one.phase),
    }
    octaves = {
        key: np.array([getattr(octave, key) for octave in rough.octaves])
        for key in ("shortest", "longest", "signal", "noise")
    }
    missing = np.isnan(rough.raw)
    return FaceReading(
        name=name,
        folded=folded,
        octaves=octaves,
        height=rough.height.astype(np.float32),
        roughness=rough.raw.astype(np.float32),
        smooth=np.where(missing, np.nan, rough.smooth).astype(np.float32),
        edge=rough.cells.edge,
        density=one.density.astype(np.float32),
        lowest=one.lowest,
        highest=one.highest,
        patch=patch,
    )


def _style(name: str, folds: list[Fold], rough: Roughness, height: float) -> Style:
    """The relief; the depth is that of the deeper face, so that the other's stays what it is.

    Its roughness is what the texture holds, so that every octave on a wall is as it was measured.
    """
    depth = max(one.depth for one in folds)
    profiles = [Profile((one.profile - one.profile.min()) / depth) for one in folds]
    return Style(
        name=Path(name).stem,
        profile=profiles[0],
        inner=profiles[-1],
        texture=rough.texture,
        height=height,
        depth=depth,
        roughness=rough.held,
    )
