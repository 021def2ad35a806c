"""The built-in sample: a scan made up of a piece of a printed tube, for a first look and for demos.

Sixteen by 73 by 49 mm, 5 mm layers, as the thesis's sample; drawn from a formula, not scanned.
"""

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates

from ..core.scene import Vector
from .load import Scan

POINTS = 300_000
_RADIUS, _WALL = 0.1045, 7.0e-3
_ARC, _HEIGHT = 73e-3, 49e-3
_LAYER, _DEPTH = 5.0e-3, 1.0e-3
_NOISE, _ROUGH = 0.04e-3, 0.025e-3
_TILT = np.arctan(_LAYER / (2 * np.pi * _RADIUS))  # one layer a turn
_ROUND = 0.12  # how round the valleys are
_TILE = 256  # cells of the roughness, a quarter of a millimetre each


def sample_scan(points: int = POINTS, seed: int = 0) -> Scan:
    """The sample as a scanner would see it, of about so many points, in m.

    Both faces of the wall with noise, roughness, a gap and some points astray; no sawn edges.
    """
    rng = np.random.default_rng((1, seed))
    step = np.sqrt(2 * _ARC * _HEIGHT / points)
    rows, columns = int(_HEIGHT / step), int(_ARC / step)
    sheets = [_sheet(side, rows, columns, rng) for side in (1.0, -1.0)]
    place = np.concatenate(sheets)
    astray = rng.random(len(place)) < 5e-4
    place[astray] += rng.normal(0.0, 2e-3, (np.count_nonzero(astray), 3))
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (
        part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1])
    )
    outer = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    faces = np.concatenate([outer, outer[:, ::-1] + rows * columns])
    gap = ((place - place[index[rows // 3, columns // 4]]) ** 2).sum(axis=1) < 2e-3**2
    faces = faces[~gap[faces].any(axis=1)]
    notes = ("No file is named: read the built-in sample, which is made up.",)
    return Scan("Built-in sample", place, faces.astype(np.int32), notes)


def _sheet(side: float, rows: int, columns: int, rng: np.random.Generator) -> Vector:
    """The points of one face (rows × columns, 3): bead, roughness and noise on a cylinder."""
    arc, z = np.meshgrid(
        np.linspace(-_ARC / 2, _ARC / 2, columns), np.linspace(-_HEIGHT / 2, _HEIGHT / 2, rows)
    )
    turns = 2 * np.pi * (z * np.cos(_TILT) + arc * np.sin(_TILT)) / _LAYER
    # A row of half waves, |sin|, with rounded valleys, brought to 0..1.
    bead = (np.hypot(np.sin(turns / 2), _ROUND) - _ROUND) / (np.hypot(1, _ROUND) - _ROUND)
    rough = gaussian_filter(rng.normal(size=(_TILE, _TILE)), 4.0, mode="wrap")
    places = np.stack([z, arc]) / 0.25e-3
    rough = map_coordinates(rough / rough.std(), places, order=3, mode="grid-wrap")
    height = _DEPTH * bead + _ROUGH * rough + _NOISE * rng.normal(size=arc.shape)
    radius = _RADIUS + (height if side > 0 else -_WALL - height)
    angle = arc / _RADIUS
    place = [radius * np.cos(angle) - _RADIUS, radius * np.sin(angle), z]
    return np.stack(place, axis=-1).reshape(-1, 3)
