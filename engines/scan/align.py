"""Axis and layers found together: each is fitted with the other's share taken off."""

from dataclasses import dataclass, replace

import numpy as np

from ..core.errors import SceneError
from ..core.progress import Progress
from ..core.scene import Vector
from .frame import Frame, fit_frame, refit, turned_over
from .layers import Layers, fitted
from .load import Scan
from .scatter import jackknifed
from .search import find_layers
from .unroll import Cells, Face, cells_of, laid_flat, split_faces

FIT_CELL = 0.5e-3  # m
_ROUNDS = 3
_LEAST_SHARE = 0.45  # of the points that must lie on faces; a sample has sawn edges too
_PLACES = 4000  # of a face, that the axis is fitted to
_PARTS = 8  # of the piece, to see how far its axis scatters


@dataclass(frozen=True, slots=True)
class Search:
    """What to look for: layer heights in m, how sure they must be, which faces, which way up."""

    shortest: float = 0.5e-3
    longest: float = 20e-3
    confidence: float = 0.99
    sides: str = "both"
    upside_down: bool = False


@dataclass(frozen=True, slots=True)
class Aligned:
    """A piece with its base surface, its faces on it (the outer first) and their layers.

    ``layers`` are those of the first face. ``axis_error`` in rad is the standard error of the
    axis's turn about the direction out of the piece, ``bend_error`` that of the curvature over it,
    by which lengths along the arc are off.
    """

    frame: Frame
    faces: tuple[Face, ...]
    layers: Layers
    axis_error: float
    bend_error: float

    @property
    def layer_normal(self) -> Vector:
        """What is square to the layers in the middle of the piece (3,), in the file's own axes."""
        tilt = self.layers.tilt
        return np.sin(tilt) * self.frame.axes[1] + np.cos(tilt) * self.frame.axes[2]

    @property
    def tilt_error(self) -> float:
        """Standard error in rad of the layers' slope against the axis."""
        bent = np.sin(2 * self.layers.tilt) / 2 * self.bend_error
        return float(np.linalg.norm([self.layers.tilt_error, self.axis_error, bent]))

    @property
    def period_error(self) -> float:
        """Standard error in m of the layer height."""
        bent = np.sin(self.layers.tilt) ** 2 * self.bend_error * self.layers.period
        return float(np.hypot(self.layers.period_error, bent))

    def layers_of(self, face: Face) -> Layers:
        """The layers as ``face`` shows them: the same wave, its own relief and trend."""
        if face is self.faces[0]:
            return self.layers
        return _own(self.layers, cells_of(face, _cell_for(self.layers, face)))


def placed(scan: Scan, search: Search, seed: int, notes: list[str]) -> tuple[Frame, bool]:
    """The frame of ``scan``, and whether a single face is the inner one; adds to ``notes``."""
    frame = fit_frame(scan.points, seed)
    inward = False
    if not frame.thickness:
        inward = _looks_inward(scan, frame)
        if inward and not frame.curvature:
            out, along, up = frame.axes
            frame, inward = replace(frame, axes=np.stack([-out, -along, up])), False
        which = "inner" if inward else "outer"
        assumed = "" if len(scan.faces) else ", assumed since a cloud does not say"
        notes.append(
            f"Only one face of the wall was seen, the {which} one{assumed}: no wall thickness, and "
            "the relief is the same on both sides."
        )
    shape = (
        f"a piece of a cylinder of {frame.radius * 1e3:.4g} mm radius"
        if frame.curvature
        else "a flat piece"
    )
    notes.append(f"Found {shape}.")
    return (turned_over(frame) if search.upside_down else frame), inward


def _looks_inward(scan: Scan, frame: Frame) -> bool:
    """Whether the faces look toward the axis."""
    if not len(scan.faces):
        return False
    some = scan.faces[:: max(1, len(scan.faces) // 20_000)]
    a, b, c = (scan.points[some[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    arc, _, _ = frame.unrolled(a)
    angle = arc * frame.curvature
    out = np.cos(angle)[:, None] * frame.axes[0] + np.sin(angle)[:, None] * frame.axes[1]
    return float(np.sum(normal * out)) < 0


def align(scan: Scan, search: Search, frame: Frame, inward: bool, progress: Progress) -> Aligned:
    """Frame and layers of ``scan``, fitted in turn from the rough ``frame``.

    ``inward`` says that a single face is the inner one. Raises SceneError where there are no layers
    or not the faces that are wanted.
    """
    progress(0.0, "Finding the faces")
    faces = split_faces(scan.points, frame, inward)
    _check_share(scan, faces)
    faces = _wanted(faces, search)
    progress(0.15, "Finding the layers")
    layers = find_layers(
        cells_of(faces[0], _search_cell(faces[0], search.shortest)),
        search.shortest,
        search.longest,
        search.confidence,
        anywhere=not frame.curvature,
    )
    if not frame.curvature:
        frame, layers = _levelled(frame, layers, search)
        faces = [laid_flat(face.points, frame, face.inner) for face in faces]
    errors = 0.0, 0.0
    for turn in range(_ROUNDS):
        progress(0.3 + 0.2 * turn, "Aligning axis and layers")
        cells = [cells_of(face, _cell_for(layers, face)) for face in faces]
        layers = fitted(layers, cells[0])
        frame, errors = _refitted(frame, cells, faces, layers, turn == _ROUNDS - 1)
        faces = [laid_flat(face.points, frame, face.inner) for face in faces]
    layers = fitted(layers, cells_of(faces[0], _cell_for(layers, faces[0])), errors=True)
    return Aligned(frame, tuple(faces), layers, *errors)


def _check_share(scan: Scan, faces: list[Face]) -> None:
    share = sum(len(face.arc) for face in faces) / len(scan.points)
    if share < _LEAST_SHARE:
        raise SceneError(
            f"Only {100 * share:.0f} % of the points of “{scan.name}” lie on the faces of a wall; "
            "scan a sample of a wall alone, whose relief is less deep than its layers are high."
        )


def _wanted(faces: list[Face], search: Search) -> list[Face]:
    wanted = [face for face in faces if search.sides in ("both", face.name)]
    if not wanted:
        seen = " and the ".join(face.name for face in faces)
        raise SceneError(
            f"The scan does not show the {search.sides} face of a wall"
            + (f", only the {seen} one; choose that." if seen else "; scan one of its faces.")
        )
    return wanted


def _search_cell(face: Face, shortest: float) -> float:
    """Cells fine enough for the shortest layers, as far as there are points for them."""
    area = np.ptp(face.arc) * np.ptp(face.z)
    return float(max(shortest / 2.5, np.sqrt(3 * area / len(face.arc))))


def _cell_for(layers: Layers, face: Face) -> float:
    area = np.ptp(face.arc) * np.ptp(face.z)
    finest = float(np.sqrt(4 * area / len(face.arc)))
    return max(finest, min(FIT_CELL, layers.period / 10))


def _levelled(frame: Frame, layers: Layers, search: Search) -> tuple[Frame, Layers]:
    """A flat piece has no axis: turn its own up to be square to the layers."""
    tilt = layers.tilt
    out, along, up = frame.axes
    up, along = (
        np.cos(tilt) * up + np.sin(tilt) * along,
        np.cos(tilt) * along - np.sin(tilt) * up,
    )
    turned = replace(frame, axes=np.stack([out, along, up]))
    leading = next(up[i] for i in (2, 1, 0) if abs(up[i]) > 0.1)
    if (leading < 0) != search.upside_down:
        turned = turned_over(turned)
    start = replace(
        layers,
        wave=np.array([0.0, 1 / layers.period]),
        harmonics=np.zeros((2, 0)),
    )
    return turned, start


def _refitted(
    frame: Frame, cells: list[Cells], faces: list[Face], layers: Layers, last: bool
) -> tuple[Frame, tuple[float, float]]:
    """The frame fitted to the faces less their relief, and how far axis and curvature scatter.

    In rad, and as a share; 0 but for the ``last`` time.
    """
    places, heights, inner, block = [], [], [], []
    for one, face in zip(cells, faces, strict=True):
        relief = _own(layers, one).relief(one.arc, one.z)
        step = max(1, len(one.arc) // _PLACES)
        some = slice(None, None, step)
        out = -frame.thickness - one.height if face.inner and frame.thickness else one.height
        if face.inner and not frame.thickness:
            out, relief = -one.height, -relief
        places.append(frame.rolled(one.arc[some], out[some], one.z[some]))
        heights.append(relief[some])
        inner.append(np.full(len(heights[-1]), face.inner and bool(frame.thickness)))
        side = one.column[some] * 4 // one.shape[1] * 2 + one.row[some] * 2 // one.shape[0]
        block.append(side)
    points, height = np.concatenate(places), np.concatenate(heights)
    within, part_of = np.concatenate(inner), np.concatenate(block)
    found = refit(frame, points, height, within)
    if not last or not frame.curvature:
        return found, (0.0, 0.0)
    moved = []
    for index in range(_PARTS):
        kept = part_of != index
        if kept.all() or not kept.any():
            continue
        one = refit(found, points[kept], height[kept], within[kept])
        moved.append((one.axes[2] @ found.axes[1], one.curvature / found.curvature))
    lean, bend = jackknifed(np.array(moved).reshape(-1, 2))
    return found, (float(lean), float(bend))


def _own(layers: Layers, cells: Cells) -> Layers:
    """The relief and trend of ``cells``, fitted with the wave of ``layers`` held."""
    return fitted(replace(layers, harmonics=np.zeros((2, 0))), cells, held=True)
