"""The three coordinate systems of goniometers, and how all become Type C.

Every system is a globe [ANSI/IES LM-75-19; ANSI/IES LM-63-02, definitions]; they differ in where
its poles are and where its angles begin. With the photometric zero of Types B and C at −Z, and
the photometric horizontal, which is C0, at +X, the direction of an intensity is

- Type C, poles ∓Z: (sin γ cos C, sin γ sin C, −cos γ); the vertical angle γ counts from the nadir,
  the horizontal angle C is the half-plane, counter-clockwise seen from above.
- Type B, poles ±Y, for floodlights aimed at −Z: (sin V cos H, −sin H, −cos V cos H); the vertical
  angle V turns a plane about the level axis Y, 0 at the nadir and 90° at C0, the horizontal angle
  H is the distance from C0–C180 in that plane, clockwise: 90° is C270. In CIE 121 it is B, −β.
- Type A, poles ∓Z, for headlights aimed at +X: (cos V cos H, −cos V sin H, sin V); the vertical
  angle V is the height above the horizon, −90° at the nadir, the horizontal angle H turns the
  vertical planes, clockwise: 90° is C270.

The rows of a file belong to its horizontal angles in all of them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .numerals import Row, check_ascending, fault
from .photometry import Angles, Photometry, bilinear, luminous_flux

COARSEST, FINEST = 1.0, 0.125
"""Steps of C in degrees, and of γ in 90ths of its range, to resample Type B with: the first and
the last one tried."""
FLUX_ERROR = 1e-3
"""Share of the flux that resampling may change, unless the finest step is reached."""
EDGE = 1e-3
"""Degrees within which light ends beside the planes of a Type A table."""


class Table(NamedTuple):
    """Intensity (H, V) at horizontal and vertical angles in degrees, of any one type."""

    vertical: Angles
    horizontal: Angles
    intensity: NDArray[np.float64]


def from_type_c(name: str, vertical: Row, horizontal: Row, intensity: NDArray[np.float64]) -> Table:
    """A Type C table as it stands, its planes going once round from 0 to 360.

    A file may hold one plane, or planes from 0 to 90, 180 or 360, or from 90 to 270; the others
    are their mirror images. Raises FileError.
    """
    check_ascending(name, "vertical", vertical, 0.0, 180.0)
    check_ascending(name, "horizontal", horizontal, 0.0, 360.0)
    planes = horizontal.values
    first, last = planes[0], planes[-1]
    if len(planes) == 1 and first == 0:
        return Table(vertical.values, np.array([0.0, 360.0]), np.repeat(intensity, 2, axis=0))
    if (first, last) == (0, 90):
        planes, intensity = _mirror(planes, intensity)
        last = 180.0
    if (first, last) == (0, 180):
        planes, intensity = _mirror(planes, intensity)
        last = 360.0
    if (first, last) == (90, 270):
        planes, intensity = _mirror(planes, intensity)
        planes, intensity = _with_plane(planes, intensity, 360.0)
        k = np.searchsorted(planes, 360.0)
        planes = np.concatenate([planes[k:-1] - 360.0, planes[: k + 1]])
        intensity = np.concatenate([intensity[k:-1], intensity[: k + 1]])
        first, last = 0.0, 360.0
    if first != 0 or last <= 180:
        raise fault(
            name,
            horizontal.lines[0],
            f"has horizontal angles from {first:g}° to {last:g}°, and Type C goes from 0° to 0°, "
            "90°, 180° or 360°, or from 90° to 270°",
            "get a complete file",
        )
    if last < 360:
        planes, intensity = np.append(planes, 360.0), np.concatenate([intensity, intensity[:1]])
    return Table(vertical.values, planes, np.concatenate([intensity[:-1], intensity[:1]]))


def from_type_a(name: str, vertical: Row, horizontal: Row, intensity: NDArray[np.float64]) -> Table:
    """A Type A table as Type C: the same globe with other numbers on it, γ = V + 90 and C = −H.

    Angles that begin at 0 are mirrored there, horizontal and vertical ones. No light leaves beyond
    the first and last plane: it ends within `EDGE` of them. Raises FileError.
    """
    full = _whole(name, vertical, horizontal, intensity, "A", (90.0, 180.0))
    planes, light = _with_plane(-full.horizontal[::-1], full.intensity[::-1], 0.0)
    if planes[-1] - planes[0] < 360 - 2 * EDGE:
        dark = np.zeros_like(light[:1])
        planes = np.concatenate([[planes[0] - EDGE], planes, [planes[-1] + EDGE]])
        light = np.concatenate([dark, light, dark])
    k = int(np.searchsorted(planes, 0.0))
    left = slice(0 if planes[0] + 360 > planes[-1] else 1, k + 1)
    return Table(
        full.vertical + 90,
        np.concatenate([planes[k:], planes[left] + 360]),
        np.concatenate([light[k:], light[left]]),
    )


def from_type_b(name: str, vertical: Row, horizontal: Row, intensity: NDArray[np.float64]) -> Table:
    """A Type B table resampled as Type C, its peak and, within `FLUX_ERROR`, its flux kept.

    Between its nodes the table is bilinear in V and H, and dark beyond them. Angles that begin at
    0 are mirrored there, horizontal and vertical ones. Raises FileError.
    """
    full = _whole(name, vertical, horizontal, intensity, "B", (180.0, 90.0))
    flux = luminous_flux(Photometry(full.horizontal + 90, full.vertical, full.intensity.T, 1.0))
    h, v = np.unravel_index(np.argmax(full.intensity), full.intensity.shape)
    peak = _type_c_angles(full.vertical[v], full.horizontal[h])
    spacing = min(np.diff(full.vertical).min(), np.diff(full.horizontal).min())
    step = COARSEST
    while step > max(spacing / 2, 2 * FINEST):
        step /= 2
    while True:
        table = _resampled(full, step, peak)
        found = luminous_flux(Photometry(*table, flux=1.0))
        if step <= FINEST or abs(found - flux) <= FLUX_ERROR * flux:
            return table
        step /= 2


def _resampled(table: Table, step: float, peak: tuple[float, float]) -> Table:
    """A Type B table at steps of γ and C, the nodes next to the peak moved onto it."""
    widest = np.abs(table.vertical).max(), np.abs(table.horizontal).max()
    last = (
        widest[0] if widest[0] > 90 else np.degrees(np.arccos(np.prod(np.cos(np.radians(widest)))))
    )
    gamma = np.linspace(0.0, last, round(max(last, 90) / step) + 1)
    gamma = _through(gamma, peak[0])
    planes = _through(np.linspace(0.0, 360.0, round(360 / step) + 1), peak[1])
    g, c = np.radians(gamma), np.radians(planes)[:, None]
    x, y, z = np.sin(g) * np.cos(c), np.sin(g) * np.sin(c), -np.cos(g)
    v = np.degrees(np.arctan2(x, -z))
    h = np.degrees(np.arcsin(np.clip(-y, -1.0, 1.0)))
    v = np.where(np.abs(h) > 90 - 1e-9, np.clip(v, table.vertical[0], table.vertical[-1]), v)
    inside = np.ones(v.shape, bool)
    for at, nodes in ((v, table.vertical), (h, table.horizontal)):
        inside &= (at >= nodes[0] - 1e-9) & (at <= nodes[-1] + 1e-9)
    v = np.clip(v, table.vertical[0], table.vertical[-1])
    h = np.clip(h, table.horizontal[0], table.horizontal[-1])
    light = np.where(inside, bilinear(table.horizontal, table.vertical, table.intensity, h, v), 0.0)
    light[-1] = light[0]
    return Table(gamma, planes, light)


def _type_c_angles(v: float, h: float) -> tuple[float, float]:
    """γ and C of a Type B direction."""
    v, h = np.radians(v), np.radians(h)
    x, y, z = np.sin(v) * np.cos(h), -np.sin(h), -np.cos(v) * np.cos(h)
    gamma = np.degrees(np.arctan2(np.hypot(x, y), -z))
    return float(gamma), float(np.degrees(np.arctan2(y, x)) % 360)


def _through(nodes: Angles, at: float) -> Angles:
    """The nodes with the one next to ``at`` moved there; the first and the last one stay."""
    k = int(np.argmin(np.abs(nodes - at)))
    if abs(nodes[k] - at) < 1e-9:
        return nodes
    if k in (0, len(nodes) - 1):
        return np.sort(np.append(nodes, at))
    nodes[k] = at
    return nodes


def _whole(
    name: str,
    vertical: Row,
    horizontal: Row,
    intensity: NDArray[np.float64],
    kind: str,
    limits: tuple[float, float],
) -> Table:
    """A table of Type A or B with the half that its symmetry leaves out. Raises FileError."""
    for what, row, limit in zip(
        ("vertical", "horizontal"), (vertical, horizontal), limits, strict=True
    ):
        check_ascending(name, what, row, -limit, limit)
        if len(row.values) < 2 or row.values[0] > 0 or row.values[-1] <= 0:
            raise fault(
                name,
                row.lines[0],
                f"has {what} angles from {row.values[0]:g}° to {row.values[-1]:g}°, and Type "
                f"{kind} goes from −90° or 0° to 90°",
                "get a complete file",
            )
    v, h = vertical.values, horizontal.values
    if v[0] == 0:
        v, turned = _mirror(-v[::-1], intensity.T[::-1])
        intensity = turned.T
    if h[0] == 0:
        h, intensity = _mirror(-h[::-1], intensity[::-1])
    return Table(v, h, intensity)


def _mirror(planes: Angles, intensity: NDArray[np.float64]) -> tuple[Angles, NDArray[np.float64]]:
    """The planes followed by their mirror images in the last of them."""
    return (
        np.concatenate([planes, 2 * planes[-1] - planes[-2::-1]]),
        np.concatenate([intensity, intensity[-2::-1]]),
    )


def _with_plane(
    planes: Angles, intensity: NDArray[np.float64], at: float
) -> tuple[Angles, NDArray[np.float64]]:
    """The planes with one at ``at``, between two of them if it is not there yet."""
    if at in planes:
        return planes, intensity
    k = np.searchsorted(planes, at)
    share = (at - planes[k - 1]) / (planes[k] - planes[k - 1])
    between = (1 - share) * intensity[k - 1] + share * intensity[k]
    return np.insert(planes, k, at), np.insert(intensity, k, between, 0)
