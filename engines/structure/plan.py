"""The outline of a building in plan: a superellipse, or a polygon from a file."""

import csv
import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from ..core.errors import FileError
from ..core.scene import Vector

_DENSE = 8192


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """A closed curve, counter-clockwise, walked by its length.

    ``shares`` (K,) of the length gone, 0 to 1, at ``places`` (K,): polar angles in rad of a
    superellipse of the half axes ``size`` and ``exponent``, or positions along the polygon
    ``corners`` (K, 2), whose ``outward`` (K, 2) directions are those of its corners.
    """

    shares: Vector
    places: Vector
    size: tuple[float, float] = (1.0, 1.0)
    exponent: float = 2.0
    corners: Vector | None = None
    outward: Vector | None = None

    def at(self, u: Vector) -> tuple[Vector, Vector]:
        """Positions (M, 2) in m and outward unit vectors (M, 2) at shares ``u`` (M,) of the length.

        Those of a superellipse are exact but for where along it they stand; between the corners of
        a polygon the outward direction turns evenly, so that a curve beside it has no jumps.
        """
        u = u % 1.0
        if self.corners is None or self.outward is None:
            return self._superellipse(np.interp(u, self.shares, self.places))
        points, outward = (
            np.column_stack([np.interp(u, self.shares, column) for column in values.T])
            for values in (self.corners, self.outward)
        )
        return points, outward / np.linalg.norm(outward, axis=1, keepdims=True)

    def _superellipse(self, angle: Vector) -> tuple[Vector, Vector]:
        ray = np.column_stack([np.cos(angle), np.sin(angle)])
        share = np.abs(ray / self.size)
        radius = (share**self.exponent).sum(axis=1) ** (-1 / self.exponent)
        points = radius[:, None] * ray
        slope = np.sign(ray) * (radius[:, None] * share) ** (self.exponent - 1) / self.size
        return points, slope / np.linalg.norm(slope, axis=1, keepdims=True)


@functools.lru_cache(maxsize=16)
def superellipse(width: float, depth: float, exponent: float) -> Plan:
    """|2x ÷ width|ⁿ + |2y ÷ depth|ⁿ = 1 with n = ``exponent``, from the +X axis on; lengths in m.

    2 is an ellipse, 1 a rhombus, and the larger the exponent the nearer a rectangle.
    """
    angles = np.linspace(0.0, 2 * np.pi, _DENSE + 1)
    shape = Plan(np.zeros(1), np.zeros(1), (width / 2, depth / 2), exponent)
    quarter = shape._superellipse(angles[: _DENSE // 4 + 1])[0]
    steps = np.linalg.norm(np.diff(quarter, axis=0), axis=1)
    gone = np.concatenate([steps, steps[::-1], steps, steps[::-1]]).cumsum()
    shares = np.concatenate([[0.0], gone / gone[-1]])
    return Plan(shares, angles, (width / 2, depth / 2), exponent)


def polygon(points: Vector, name: str = "The plan") -> Plan:
    """The plan through ``points`` (K, 2) in m, counter-clockwise whichever way they run.

    The last point may repeat the first. Raises FileError, naming it, where there are fewer than
    three points, two in a row are the same, or the outline crosses itself.
    """
    points = np.asarray(points, dtype=np.float64)
    if len(points) > 1 and np.array_equal(points[0], points[-1]):
        points = points[:-1]
    if len(points) < 3:
        raise FileError(f"{name} has {len(points)} corners; an outline has three or more.")
    steps = np.roll(points, -1, axis=0) - points
    still = np.linalg.norm(steps, axis=1) == 0
    if still.any():
        raise FileError(f"{name} has point {np.argmax(still)} twice in a row; take one out.")
    area = shapely.Polygon(points)
    if not area.is_valid or area.area == 0:
        raise FileError(f"{name} crosses or touches itself; draw an outline that does not.")
    if not area.exterior.is_ccw:
        points = np.concatenate([points[:1], points[:0:-1]])
        steps = np.roll(points, -1, axis=0) - points

    length = np.linalg.norm(steps, axis=1)
    sides = np.column_stack([steps[:, 1], -steps[:, 0]]) / length[:, None]
    outward = sides + np.roll(sides, 1, axis=0)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    shares = np.concatenate([[0.0], length.cumsum() / length.sum()])
    return Plan(
        shares,
        shares,
        corners=np.concatenate([points, points[:1]]),
        outward=np.concatenate([outward, outward[:1]]),
    )


def read_plan(path: Path | str) -> Plan:
    """The plan in a CSV of two columns, x and y in m; a first row “x,y” may name them.

    Raises FileError where the file is missing or a row is not two finite numbers, and as `polygon`.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError as error:
        raise FileError(
            f"There is no plan “{path.name}” in the folder “{path.parent}”; choose another file."
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"“{path}” cannot be read as a plan; save it as CSV in UTF-8.") from error
    points = []
    for number, row in enumerate(csv.reader(text.splitlines()), start=1):
        if number == 1 and [cell.strip().lower() for cell in row] == ["x", "y"]:
            continue
        try:
            x, y = (float(cell) for cell in row)
        except ValueError:
            x = y = np.nan
        if not np.isfinite([x, y]).all():
            raise FileError(
                f"Row {number} of “{path.name}” is {','.join(row)!r}, not an x and a y in m; "
                "mend that row."
            )
        points.append((x, y))
    return polygon(np.array(points).reshape(-1, 2), f"“{path.name}”")
