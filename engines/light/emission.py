"""Where photons leave: cells of direction and opening, or of a parallel beam's cross-section.

A luminaire's emission is cut into cells. Those from which no light can meet a body are left out;
the rest are drawn in proportion to their flux. A batch first draws how many photons each cell
sends and then emits them cell by cell: neighbours in the batch travel together and trace faster.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from . import aim, photometry
from .luminaires import Source
from .photometry import Photometry
from .stage import MM, Stage

FINEST, COARSEST = 0.1, 0.5
"""Step of the grid of intensities in degrees of γ: no finer than the one, no coarser than the
other."""
AZIMUTHS = 360
"""Steps of the grid of intensities along C."""
PATCHES = 256
"""Cells along each side of a parallel beam."""
WIDEST = 2.0
"""Largest height of a cell of directions in degrees."""
FINER = 16
"""Cells of directions that a step of the grid is cut into at most."""
OPENINGS = 4
"""Patches of the opening along each side at most."""
CELLS = 1 << 22
"""Cells to choose from."""
MORTON = 6
"""Bits along each axis that the cells are ordered by."""
ROW = 8
"""Floats a cell: low corner (2), steps (2), low corner on the opening (2), measure ÷ chance, and
the size of a patch of the opening. The first coordinate of a direction is sin²(γ/2): even over it
is even over solid angle, and exact in float32 where cos γ is not."""


@dataclass(frozen=True, slots=True)
class Emission:
    """Cells that a luminaire's photons leave from.

    ``flux`` (C,) float64 is about each cell's in lm, and what they are drawn by; ``cells`` (C, ROW)
    float32 what their photons need: radians and sin²(γ/2) for directions, metres for a beam, shares
    of the square that becomes the opening. ``intensity`` (rows + 1, AZIMUTHS + 1) float64 in cd is
    None for a beam.
    """

    source: Source
    flux: NDArray[np.float64]
    cells: NDArray[np.float32]
    intensity: NDArray[np.float64] | None

    @property
    def aimed(self) -> float:
        """Flux in lm that the cells hold, 0 where no light can meet a body."""
        return float(self.flux.sum())


def emission(source: Source, stage: Stage, *, everywhere: bool = False) -> Emission:
    """The cells of ``source`` that can meet a body, or, ``everywhere``, all that emit."""
    cover = None if everywhere else stage.cover
    if cover is not None and not len(cover[0]):
        return Emission(source, np.zeros(0), np.zeros((0, ROW), np.float32), None)
    if source.distribution is None:
        intensity = None
        flux, cells = _beam(source, cover)
    else:
        intensity = intensity_grid(source.distribution)
        flux, cells = _directions(source, intensity, cover)
    cells[:, 6] /= flux / flux.sum()
    return Emission(source, flux, cells.astype(np.float32), intensity)


def intensity_grid(distribution: Photometry) -> NDArray[np.float64]:
    """Luminous intensity (rows + 1, AZIMUTHS + 1) in cd at even steps of γ 0..π and C 0..2π.

    Scaled to the distribution's own flux: a cut-off between two steps becomes a ramp.
    """
    finest = float(np.diff(distribution.vertical).min(initial=180.0))
    rows = round(180.0 / np.clip(finest, FINEST, COARSEST))
    gamma, turn = np.linspace(0, 180, rows + 1), np.linspace(0, 360, AZIMUTHS + 1)
    intensity = photometry.intensity_at(distribution, gamma[:, None], turn[None, :])
    even = replace(distribution, vertical=gamma, horizontal=turn, intensity=intensity.T)
    flux = photometry.luminous_flux(even)
    return intensity * (photometry.luminous_flux(distribution) / flux) if flux else intensity


Cover = tuple[NDArray[np.float64], float]
Cells = tuple[NDArray[np.float64], NDArray[np.float64]]


def _directions(source: Source, intensity: NDArray[np.float64], cover: Cover | None) -> Cells:
    """Cells of direction × patch of the opening, as fine as what they are aimed at asks for."""
    angle, side = np.radians(WIDEST), 1
    if cover is not None:
        angle, side = _fineness(source, cover)
    rows = _cut(intensity.shape[0] - 1, np.pi, angle)
    columns = _cut(AZIMUTHS, 2 * np.pi, 2 * angle)
    side = min(side, int(np.sqrt(CELLS / (rows * columns))) or 1)
    # Means over cells of intensities that are linear between the grid's steps.
    mean = _means(_means(intensity, rows).T, columns).T
    gamma = np.linspace(0, np.pi, rows + 1)
    height = np.sin(gamma / 2) ** 2
    solid = -np.diff(np.cos(gamma)) * (2 * np.pi / columns)
    flux = np.broadcast_to(mean * solid[:, None] / side**2, (side**2, rows, columns))
    emitting = flux > 0
    points, slack = aim.patches_of(source, side)
    if cover is not None:
        emitting = emitting & aim.directions(source, points, slack, cover, rows, columns)
    cell, flux = np.argwhere(emitting), flux[emitting]
    if cover is not None:
        down, around = (gamma[:-1] + gamma[1:]) / 2, 2 * np.pi / columns * np.arange(0.5, columns)
        target = points[cell[:, 0]], down[cell[:, 1]], around[cell[:, 2]]
        order = _by_target(source, cover, *target)
        cell, flux = cell[order], flux[order]
    patch, row, column = cell.T
    cells = np.zeros((len(patch), ROW))
    cells[:, 0], cells[:, 2] = height[row], np.diff(height)[row]
    cells[:, 1], cells[:, 3] = column * (2 * np.pi / columns), 2 * np.pi / columns
    cells[:, 4], cells[:, 5] = patch % side / side, patch // side / side
    cells[:, 6], cells[:, 7] = solid[row] / side**2, 1 / side
    return flux, cells


def _by_target(
    source: Source,
    cover: Cover,
    opening: NDArray[np.float64],
    gamma: NDArray[np.floating],
    turn: NDArray[np.floating],
) -> NDArray[np.int64]:
    """An order of rays from ``opening`` (N, 2) m along γ and C by where they come at the bodies.

    Along a Morton curve: neighbours in it meet the same faces, which are still in the cache.
    """
    distance = np.median(np.linalg.norm(cover[0] - source.origin, axis=1))
    sine = np.sin(gamma)
    target = np.stack([sine * np.cos(turn), sine * np.sin(turn), -np.cos(gamma)], axis=1) * distance
    target[:, :2] += opening
    low = target.min(axis=0)
    size = max(float((target.max(axis=0) - low).max()), 1e-9)
    place = ((target - low) / size * (2**MORTON - 1)).astype(np.int64)
    key = np.zeros(len(place), np.int64)
    for bit in range(MORTON):
        for axis in range(3):
            key |= ((place[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(key, kind="stable")


def _fineness(source: Source, cover: Cover) -> tuple[float, int]:
    """Height of a cell of directions in radians, and patches along each side of the opening.

    Cells as high as the balls of the cover look, patches that blur no more than that.
    """
    centres, radius = cover
    near = float(np.linalg.norm(centres - source.origin, axis=1).min()) - radius
    if near <= radius:
        return np.radians(WIDEST), OPENINGS if source.shape != "point" else 1
    angle = min(radius / near, np.radians(WIDEST))
    blur = max(source.width, source.length) / 2 / near
    return angle, int(np.clip(np.ceil(blur / angle), 1, OPENINGS))


def _cut(steps: int, whole: float, angle: float) -> int:
    """Cells of about ``angle`` in the ``whole``: so many steps each, or so many to a step."""
    wanted = max(whole / angle, 1.0)
    if wanted >= steps:
        return steps * min(round(wanted / steps), FINER)
    return next(n for n in range(int(wanted), steps + 1) if steps % n == 0)


def _means(values: NDArray[np.float64], cells: int) -> NDArray[np.float64]:
    """Means over ``cells`` even cells along the first axis of values at even steps; linear between.

    Above 0 wherever a value in the cell is.
    """
    steps = len(values) - 1
    if cells <= steps:
        between = (values[:-1] + values[1:]) / 2
        return between.reshape(cells, steps // cells, -1).mean(axis=1)
    share = (np.arange(cells // steps) + 0.5) / (cells // steps)
    low, high = values[:-1, None], values[1:, None]
    return (low + (high - low) * share[:, None]).reshape(cells, -1)


def _beam(source: Source, cover: Cover | None) -> Cells:
    step = np.array([source.length, source.width]) / PATCHES
    low = np.arange(PATCHES) / PATCHES - 0.5
    exitance = source.flux / source.area
    share = np.ones((PATCHES, PATCHES))
    if source.shape == "round":
        fine = (np.arange(PATCHES * 8) + 0.5) / (PATCHES * 4) - 1
        inside = fine[:, None] ** 2 + fine[None, :] ** 2 < 1
        share = inside.reshape(PATCHES, 8, PATCHES, 8).mean(axis=(1, 3))
    flux = share * exitance * step.prod()
    if cover is not None:
        flux *= aim.patches(source, *cover, PATCHES)
    row, column = np.nonzero(flux)
    cells = np.zeros((len(row), ROW))
    cells[:, 0], cells[:, 1] = low[column] * source.length, low[row] * source.width
    cells[:, 2:4] = step
    cells[:, 6] = exitance * step.prod()
    return flux[row, column], cells


def draw(emission: Emission, count: int, random: np.random.Generator) -> NDArray[np.uint32]:
    """The cell that each of ``count`` photons leaves from (count,): independent, in cell order."""
    sent = random.multinomial(count, emission.flux / emission.flux.sum())
    return np.repeat(np.arange(len(sent), dtype=np.uint32), sent)


class Emitter:
    """An emission on the device: turns cells and random numbers into photons."""

    def __init__(self, emission: Emission, stage: Stage) -> None:
        mi = runtime.mitsuba()
        import drjit as dr

        source = emission.source
        self.emission = emission
        self._cells = mi.Float(emission.cells.ravel())
        if emission.intensity is not None:
            self._steps = [dr.opaque(mi.UInt32, n) for n in emission.intensity.shape]
            self._intensity = mi.Float(emission.intensity.astype(np.float32).ravel())
        self._pose = [
            mi.Vector3f(*(dr.opaque(mi.Float, float(c)) for c in a)) for a in source.axes.T
        ]
        self._origin = mi.Point3f(
            *(dr.opaque(mi.Float, float(c)) for c in stage.place(source.origin))
        )
        # Half the opening along X and Y in mm.
        self._half = [dr.opaque(mi.Float, s * MM / 2) for s in (source.length, source.width)]

    def emit(self, cell: Any, random: Any) -> tuple[Any, Any, Any]:
        """Origins (mm) and directions of photons out of the cells ``cell``, and the flux (lm) that
        one would carry if it were the only one."""
        mi = runtime.mitsuba()
        import drjit as dr

        row = dr.gather(mi.ArrayXf, self._cells, cell, shape=(ROW, dr.width(cell)))
        s, t = random.next_float32(), random.next_float32()
        weight = row[6]
        if self.emission.intensity is None:
            x, y = (row[0] + s * row[2]) * MM, (row[1] + t * row[3]) * MM
            if self.emission.source.shape == "round":
                inside = (x / self._half[0]) ** 2 + (y / self._half[1]) ** 2 < 1
                weight = dr.select(inside, weight, 0)
            local = mi.Vector3f(0, 0, -1)
        else:
            height, turn = row[0] + s * row[2], row[1] + t * row[3]
            gamma = 2 * dr.safe_asin(dr.sqrt(height))
            sin = 2 * dr.safe_sqrt(height * (1 - height))
            sin_turn, cos_turn = dr.sincos(turn)
            local = mi.Vector3f(sin * cos_turn, sin * sin_turn, 2 * height - 1)
            weight *= bilinear(self._intensity, self._steps, gamma, turn)
            x, y = self._opening(row, random)
        across, along, up = self._pose
        origin = self._origin + across * x + along * y
        return origin, dr.normalize(across * local.x + along * local.y + up * local.z), weight

    def _opening(self, row: Any, random: Any) -> tuple[Any, Any]:
        """A place on the cell's patch of the opening, in mm from the opening's centre."""
        mi = runtime.mitsuba()
        shape = self.emission.source.shape
        if shape == "point":
            return 0.0, 0.0
        point = mi.Point2f(
            row[4] + row[7] * random.next_float32(), row[5] + row[7] * random.next_float32()
        )
        if shape == "round":
            point = mi.warp.square_to_uniform_disk_concentric(point)
        else:
            point = 2 * point - 1
        return point.x * self._half[0], point.y * self._half[1]


def bilinear(table: Any, steps: list[Any], gamma: Any, turn: Any) -> Any:
    """A grid of intensities, (rows + 1) × (AZIMUTHS + 1) = ``steps``, at γ 0..π and C 0..2π."""
    mi = runtime.mitsuba()
    import drjit as dr

    rows, columns = steps
    down = gamma * dr.inv_pi * mi.Float(rows - 1)
    around = turn * dr.inv_two_pi * mi.Float(columns - 1)
    i, j = dr.minimum(mi.UInt32(down), rows - 2), dr.minimum(mi.UInt32(around), columns - 2)
    u, v = down - mi.Float(i), around - mi.Float(j)
    low, high = i * columns + j, (i + 1) * columns + j
    near = dr.lerp(dr.gather(mi.Float, table, low), dr.gather(mi.Float, table, low + 1), v)
    far = dr.lerp(dr.gather(mi.Float, table, high), dr.gather(mi.Float, table, high + 1), v)
    return dr.lerp(near, far, u)
