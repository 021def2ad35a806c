"""Pictures of the print gate: the wall unrolled and in plan, with the worst place marked."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..core.colour import ColourScale, Display, scale_for
from ..core.picture import false_colour_png
from ..core.scene import Vector
from .checks import Check
from .printing import Printed
from .toolpath import Toolpath

Map = NDArray[np.float64]

_COLUMNS = 960  # pixels around the wall
_PLAN = 800  # pixels along the plan's longer side
_RING = 14  # pixels, radius of the mark


def draw(result: Printed, folder: Path, display: Display) -> list[str]:
    """Write gate.png and plan.png, the largest share of any limit on the wall unrolled and from
    above, and an unrolled picture of each check that is not passed; returns their names.

    A ring marks the worst place. Raises FileError where they cannot be written.
    """
    verdict, path = result.verdict, result.path
    worst = verdict.worst
    share = verdict.utilisation()
    scale = share_scale(share, display)
    word = "passes" if verdict.passed else "does not pass"
    title = f"Print gate: the wall {word}"
    unrolled = marked(unroll(path, share), *_spot(path, worst))
    false_colour_png(folder / "gate.png", unrolled, scale, title, worst.sentence)
    above, corner, pixel = plan(path, share)
    if worst.point is not None:
        column, row = ((np.array(worst.point[:2]) - corner) / pixel).tolist()
        above = marked(above, column, row)
    false_colour_png(folder / "plan.png", above, scale, f"{title}, in plan", worst.sentence)
    files = ["gate.png", "plan.png"]
    for one in verdict.failed:
        if one.utilisation is not None:
            files.append(f"gate {one.name}.png")
            shown = marked(unroll(path, one.utilisation), *_spot(path, one))
            scale = share_scale(one.utilisation, display)
            false_colour_png(folder / files[-1], shown, scale, one.label, one.sentence)
    return files


def share_scale(share: Vector, display: Display) -> ColourScale:
    """The scale of shares of a limit: linear, to 1 at least, unless it is set by hand."""
    if not display.automatic:
        return scale_for(share, display, "Share of the limit", "")
    scale = ColourScale.automatic(share, False, display.palette, "Share of the limit", "")
    return ColourScale(0.0, max(scale.high, 1.0), False, scale.palette, scale.quantity, scale.unit)


def unroll(path: Toolpath, values: Vector) -> Map:
    """``values`` (N,) along the path as a picture (rows, 960): around to the right, turns upward.

    Its sides are as the wall's length and height, but for thin ones.
    """
    turns = round(path.turns)
    girth = path.arc[-1] / turns
    rows = int(np.clip(_COLUMNS * path.points[:, 2].max() / girth, 2 * turns, 4 * _COLUMNS))
    around = (np.arange(_COLUMNS) + 0.5) / _COLUMNS
    layer = np.arange(rows) * turns // rows
    each = np.interp(around + np.arange(turns)[:, None], path.turn, values)
    return each[layer]


def plan(path: Toolpath, values: Vector) -> tuple[Map, Vector, float]:
    """``values`` (N,) seen from above: the largest of all turns, NaN beside the wall.

    Returns the picture, the place (2,) of its corner and the size of a pixel in m.
    """
    low, high = path.points[:, :2].min(axis=0), path.points[:, :2].max(axis=0)
    room = path.width.max()
    corner = low - room
    size = high - low + 2 * room
    pixel = float(size.max() / _PLAN)
    columns, rows = (np.ceil(size / pixel).astype(int) + 1).tolist()
    arc = np.arange(0.0, path.arc[-1], pixel / 2)
    x, y, out_x, out_y, wide, value = (
        np.interp(arc, path.arc, v)
        for v in (*path.points[:, :2].T, *path.sides.T, path.width, values)
    )
    picture = np.full((rows, columns), -np.inf)
    steps = max(2, int(np.ceil(2 * room / pixel)))
    for share in np.linspace(-0.5, 0.5, steps):
        column = ((x + share * wide * out_x - corner[0]) / pixel).astype(int)
        row = ((y + share * wide * out_y - corner[1]) / pixel).astype(int)
        np.maximum.at(picture, (row, column), value)
    picture[np.isinf(picture)] = np.nan
    return picture, corner, pixel


def marked(picture: Map, column: float, row: float) -> Map:
    """The picture with a ring, and lines from it to the borders, that have no value."""
    rows, columns = np.indices(picture.shape)
    across, up = np.abs(columns - column), np.abs(rows - row)
    away = np.hypot(across, up)
    ring = np.abs(away - _RING) < 2
    lines = (away > _RING) & ((across < 0.75) | (up < 0.75))
    return np.where(ring | lines, np.nan, picture)


def _spot(path: Toolpath, one: Check) -> Sequence[float]:
    """Where a check is worst in the unrolled picture: column and row, far outside for nowhere."""
    if one.turn is None:
        return -1e6, -1e6
    turns = round(path.turns)
    turn = min(one.turn, turns - 1e-9)
    rows = len(unroll(path, path.turn))
    return turn % 1 * _COLUMNS, (turn // 1 + 0.5) * rows / turns
