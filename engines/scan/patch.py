"""The patch: a face of the piece rebuilt as a smooth surface of quadrilaterals."""

import numpy as np
from scipy.interpolate import RectBivariateSpline

from ..core.scene import Mesh, Vector
from .fold import Fold
from .frame import Frame
from .layers import Layers
from .roughness import Roughness

_TO_A_LAYER = 40  # rows
_COLUMN = 0.5e-3  # m
_STEP = 1e-6  # m, for the trend's slope


def patch_of(
    frame: Frame, layers: Layers, fold: Fold, valley: float, roughness: Roughness, inner: bool
) -> Mesh:
    """The face over the rectangle that was scanned: base, trend, bead and smooth roughness.

    Quadrilaterals of an even grid in arc and z, 40 rows a layer, in the file's own axes, in m;
    corner normals are those of the surface itself, out of the glass.
    """
    cells = roughness.cells
    arc = _even(cells.corner[0], cells.shape[1] * cells.edge, _COLUMN)
    z = _even(cells.corner[1], cells.shape[0] * cells.edge, layers.period / _TO_A_LAYER)
    height, along, up = _height(layers, fold, valley, roughness, arc, z)
    arcs, zs = np.meshgrid(arc, z)
    out, sign = height, 1.0
    if inner:
        out, sign = -frame.thickness - height, -1.0
    vertices = frame.rolled(arcs, out, zs)
    angle = arcs * frame.curvature
    lean = -sign * along / (1 + frame.curvature * out)
    tilt = -sign * up
    local = np.stack(
        [np.cos(angle) - lean * np.sin(angle), np.sin(angle) + lean * np.cos(angle), tilt], axis=-1
    )
    normals = sign * (local / np.linalg.norm(local, axis=-1, keepdims=True)) @ frame.axes
    faces = _quads(*arcs.shape)
    if inner:
        faces = faces[:, ::-1]
    corners = normals.reshape(-1, 3).astype(np.float32)[faces]
    return Mesh(vertices.reshape(-1, 3), np.ascontiguousarray(faces), corners)


def _even(start: float, length: float, step: float) -> Vector:
    return start + np.linspace(0.0, length, max(2, round(length / step) + 1))


def _height(
    layers: Layers, fold: Fold, valley: float, roughness: Roughness, arc: Vector, z: Vector
) -> tuple[Vector, Vector, Vector]:
    """Height in m over the base on the grid (z, arc), and its slopes along arc and z."""
    arcs, zs = np.meshgrid(arc, z)
    spline = fold.spline()
    phase = layers.phases(arcs, zs) - valley
    place = phase - np.floor(phase)
    bead, rise = spline(place), spline(place, 1)
    cells = roughness.cells
    rows, columns = cells.shape
    middle_z = cells.corner[1] + (np.arange(rows) + 0.5) * cells.edge
    middle_arc = cells.corner[0] + (np.arange(columns) + 0.5) * cells.edge
    left = RectBivariateSpline(middle_z, middle_arc, roughness.smooth)
    trend = layers.trend

    def slope(a: float, b: float) -> Vector:
        ahead, behind = trend.at(arcs + a, zs + b), trend.at(arcs - a, zs - b)
        return (ahead - behind) / (2 * _STEP)

    height = trend.at(arcs, zs) + fold.base + bead + left(z, arc)
    along = slope(_STEP, 0.0) + rise * layers.wave[0] + left(z, arc, dy=1)
    up = slope(0.0, _STEP) + rise * layers.wave[1] + left(z, arc, dx=1)
    return height, along, up


def _quads(rows: int, columns: int) -> np.ndarray:
    index = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
    corners = (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1])
    return np.stack(corners, axis=-1).reshape(-1, 4)
