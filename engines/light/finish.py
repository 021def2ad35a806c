"""From the sums over photons to maps in lx with their intervals."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Receiver
from . import interval, kernel, spectrum
from .grid import Grid
from .irradiance import IrradianceMap
from .tally import Tally
from .targets import Side

Light = tuple[NDArray[np.float64], NDArray[np.float64]]
"""Direct light (T,) in lx and its 95 % half-width."""


def maps_of(
    tally: Tally,
    grid: Grid,
    light: Light,
    white: NDArray[np.float64] | None,
    smooth: bool,
    meta: dict[str, Any],
) -> tuple[IrradianceMap, ...]:
    """The maps of all sides.

    ``white`` (3,) is the lamps' X, Y and Z where colour was traced. ``smooth`` asks for the
    kernel's map beside the texel means; a mesh has none, for its charts are neighbours on the map
    but not in space, so its texel means stand in for it.
    """
    sums = {
        "routes": np.array([grid.gathered(r) for r in tally.routes]),
        "total": grid.gathered(tally.total),
        "square": grid.gathered(tally.square),
        "colour": np.array([grid.gathered(c) for c in tally.colour]),
    }
    return tuple(
        _map(tally, side, index, grid, sums, light, white, smooth, meta)
        for index, side in enumerate(grid.sides)
    )


def _map(
    tally: Tally,
    side: Side,
    index: int,
    grid: Grid,
    sums: dict[str, NDArray[np.float64]],
    light: Light,
    white: NDArray[np.float64] | None,
    smooth: bool,
    common: dict[str, Any],
) -> IrradianceMap:
    shape = side.receiver.rows, side.receiver.columns

    def own(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return values[..., side.texels].reshape(*values.shape[:-1], *shape)

    area, total, square = own(grid.area), own(sums["total"]), own(sums["square"])
    lux = own(grid.scale) * tally.per_photon(1.0)
    computed, spread = own(light[0]), own(light[1])
    direct, caustic, indirect = own(sums["routes"]) * lux
    direct = direct + computed
    illuminance = direct + caustic + indirect
    low, high = interval.interval(total, square, tally.typical)
    lower = illuminance - np.hypot((total - low) * lux, spread)
    upper = illuminance + np.hypot((high - total) * lux, spread)
    lower, upper = np.where(area > 0, lower, 0.0), np.where(area > 0, upper, 0.0)
    half_width = (upper - lower) / 2

    meta = {"quantity": "Illuminance", "unit": "lx", "receiver": side.receiver.name, **common}
    if side.receiver.sides == "both":
        meta["side"] = "back" if side.back else "front"
    meta["size"] = _size(side, float(area.sum()))
    chosen = illuminance, half_width, np.zeros(shape)
    if smooth and grid.charts[index] is None:
        found = kernel.smoothed(total, square)
        noise = np.hypot(found.half_width * lux, spread)
        chosen = illuminance + (found.value - total) * lux, noise, found.bias * lux
        meta["gathered"] = found.gathered
    whole = area.sum()
    traced = interval.Z * np.sqrt(np.sum(square * (lux * area) ** 2)) / whole
    meta["traced_half_width"] = float(traced)
    meta["mean_half_width"] = float(np.hypot(traced, np.sqrt(((spread * area) ** 2).sum()) / whole))
    colour = np.zeros((3, *shape))
    if white is not None:
        xyz = np.stack([own(sums["colour"][0]), total, own(sums["colour"][1])]) * lux
        neutral = illuminance - total * lux
        colour = np.moveaxis(spectrum.to_rgb(np.moveaxis(xyz, 0, -1), white), -1, 0) + neutral
    fields = (
        illuminance,
        direct,
        caustic,
        indirect,
        half_width,
        lower,
        upper,
        *chosen,
        area,
        *colour,
    )
    return IrradianceMap(*(m.astype(np.float32) for m in fields), meta=meta)


def _size(side: Side, area: float) -> list[float]:
    """The sides in m of a plane, or of a square as large as a mesh."""
    receiver = side.receiver
    if isinstance(receiver, Receiver):
        return [float(np.linalg.norm(e)) for e in (receiver.u, receiver.v)]
    return [float(np.sqrt(area))] * 2
