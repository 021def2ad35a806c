"""Where photons leave: cells of direction, or of a parallel beam's cross-section.

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
"""Height of a direction cell in degrees of γ: no finer than the one, no coarser than the other."""
AZIMUTHS = 360
PATCHES = 256
ROW = 16
"""Floats a cell: low corner (2), steps (2), intensity at its corners (4), measure ÷ chance, γ, its
step. The first coordinate of a direction is sin²(γ/2): even over it is even over solid angle, and
exact in float32 where cos γ is not."""


@dataclass(frozen=True, slots=True)
class Emission:
    """Cells that a luminaire's photons leave from.

    ``flux`` (C,) float64 is each cell's in lm, ``cells`` (C, ROW) float32 what its photons need:
    radians and sin²(γ/2) for directions, metres for a beam.
    """

    source: Source
    flux: NDArray[np.float64]
    cells: NDArray[np.float32]

    @property
    def aimed(self) -> float:
        """Flux in lm that the cells hold, 0 where no light can meet a body."""
        return float(self.flux.sum())


def emission(source: Source, stage: Stage, *, everywhere: bool = False) -> Emission:
    """The cells of ``source`` that can meet a body, or, ``everywhere``, all that emit."""
    if everywhere:
        centres, radius = np.zeros((0, 3)), 0.0
    else:
        centres, radius = stage.cover
    build = _beam if source.distribution is None else _directions
    flux, cells = build(source, centres, radius, everywhere)
    emitting = flux > 0
    flux, cells = flux[emitting], cells[emitting]
    cells[:, 8] = cells[:, 8] / (flux / flux.sum())
    return Emission(source, flux, cells.astype(np.float32))


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


def _directions(
    source: Source, centres: NDArray[np.float64], radius: float, everywhere: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    assert source.distribution is not None
    intensity = intensity_grid(source.distribution)
    rows = len(intensity) - 1
    gamma, turn = np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, AZIMUTHS + 1)
    corners = [intensity[:-1, :-1], intensity[1:, :-1], intensity[:-1, 1:], intensity[1:, 1:]]
    solid = -np.diff(np.cos(gamma)) * (turn[1] - turn[0])
    flux = np.mean(corners, axis=0) * solid[:, None]
    if not everywhere:
        flux *= aim.directions(source, centres, radius, rows, AZIMUTHS)
    cells = np.zeros((rows, AZIMUTHS, ROW))
    height = np.sin(gamma / 2) ** 2
    cells[..., 0], cells[..., 1] = height[:-1, None], turn[None, :-1]
    cells[..., 2], cells[..., 3] = np.diff(height)[:, None], turn[1]
    cells[..., 9], cells[..., 10] = gamma[:-1, None], gamma[1]
    cells[..., 4:8] = np.stack(corners, axis=-1)
    cells[..., 8] = solid[:, None]
    return flux.ravel(), cells.reshape(-1, ROW)


def _beam(
    source: Source, centres: NDArray[np.float64], radius: float, everywhere: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    step = np.array([source.length, source.width]) / PATCHES
    low = np.arange(PATCHES) / PATCHES - 0.5
    exitance = source.flux / source.area
    share = np.ones((PATCHES, PATCHES))
    if source.shape == "round":
        fine = (np.arange(PATCHES * 8) + 0.5) / (PATCHES * 4) - 1
        inside = fine[:, None] ** 2 + fine[None, :] ** 2 < 1
        share = inside.reshape(PATCHES, 8, PATCHES, 8).mean(axis=(1, 3))
    flux = share * exitance * step.prod()
    if not everywhere:
        flux *= aim.patches(source, centres, radius, PATCHES)
    cells = np.zeros((PATCHES, PATCHES, ROW))
    cells[..., 0], cells[..., 1] = low[None, :] * source.length, low[:, None] * source.width
    cells[..., 2], cells[..., 3] = step
    cells[..., 8] = exitance * step.prod()
    return flux.ravel(), cells.reshape(-1, ROW)


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
        source = self.emission.source
        weight = row[8]
        if source.distribution is None:
            x, y = (row[0] + s * row[2]) * MM, (row[1] + t * row[3]) * MM
            if source.shape == "round":
                weight = dr.select(
                    (x / self._half[0]) ** 2 + (y / self._half[1]) ** 2 < 1, weight, 0
                )
            local = mi.Vector3f(0, 0, -1)
        else:
            height = row[0] + s * row[2]
            u = (2 * dr.safe_asin(dr.sqrt(height)) - row[9]) / row[10]
            sin = 2 * dr.safe_sqrt(height * (1 - height))
            sin_turn, cos_turn = dr.sincos(row[1] + t * row[3])
            local = mi.Vector3f(sin * cos_turn, sin * sin_turn, 2 * height - 1)
            weight *= dr.lerp(dr.lerp(row[4], row[5], u), dr.lerp(row[6], row[7], u), t)
            x, y = self._opening(random)
        across, along, up = self._pose
        origin = self._origin + across * x + along * y
        return origin, dr.normalize(across * local.x + along * local.y + up * local.z), weight

    def _opening(self, random: Any) -> tuple[Any, Any]:
        """A place on the opening, in mm from its centre, even over its area."""
        mi = runtime.mitsuba()
        shape = self.emission.source.shape
        if shape == "point":
            return 0.0, 0.0
        point = mi.Point2f(random.next_float32(), random.next_float32())
        if shape == "round":
            point = mi.warp.square_to_uniform_disk_concentric(point)
        else:
            point = 2 * point - 1
        return point.x * self._half[0], point.y * self._half[1]
