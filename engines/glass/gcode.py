"""G-code: a toolpath in the dialect of a machine, and a strict reader of the same."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import VERSION
from ..core.errors import FileError
from ..core.files import written
from ..core.scene import Vector
from ..core.table import save_csv
from .machine import Machine, filled
from .reach import axes_of, beside
from .toolpath import Toolpath

BEGIN, END = "path begins", "path ends"
"""Comments between which the path itself lies."""

_WORD = re.compile(r"([A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
_COMMENT = re.compile(r"\(([^)]*)\)|;(.*)")
_KNOWN = {0, 1, 4, 21, 28, 90, 93, 94}


def gcode(
    path: Toolpath, machine: Machine, purge: float = 0.0, name: str = "", notes: Sequence[str] = ()
) -> str:
    """The G-code that lays ``path``: start lines, purge, the path in one go, end lines.

    Millimetres, absolute; E counts move by move. ``purge`` is how far outside the start the purge
    lies in m; 0 leaves it out. ``notes`` are put at the top, a comment each. Coordinates have four
    decimals and angles five, so that reading back gives the path within a tenth of a micrometre.
    """
    return "\n".join(_lines(path, machine, purge, name, notes)) + "\n"


def write_gcode(
    file: Path | str,
    path: Toolpath,
    machine: Machine,
    purge: float = 0.0,
    name: str = "",
    notes: Sequence[str] = (),
) -> None:
    """Write what `gcode` gives. Raises FileError where the file cannot be written."""
    with written(file) as temporary:
        temporary.write_text(
            gcode(path, machine, purge, name, notes), encoding="utf-8", newline="\n"
        )


def write_path(file: Path | str, path: Toolpath) -> None:
    """Write every point of ``path`` as CSV, a named column with its unit for each quantity.

    Raises FileError where the file cannot be written.
    """
    x, y, z = path.points.T
    columns = {
        "Turn": path.turn,
        "X (m)": x,
        "Y (m)": y,
        "Z (m)": z,
        "Arc (m)": path.arc,
        "Rotary (rad)": path.rotary,
        "Width (m)": path.width,
        "Height (m)": path.height,
        "Speed (m/s)": path.speed,
        "Flow (m³/s)": path.flow,
        "Time (s)": path.time,
    }
    save_csv(file, columns, {"heliform": VERSION, "inputs": path.inputs})


@dataclass(frozen=True, slots=True)
class Motion:
    """What a machine is told to do, move by move, all arrays float64 and M long.

    ``axes`` (M, 4) are X, Y and Z in mm and C in degrees after each move, ``extruded`` (M,) what E
    says of it, ``seconds`` (M,) how long it takes, NaN where no feed says it. ``path`` are the
    indices of the first point and of the last of what the file marks as the path.
    """

    axes: Vector
    extruded: Vector
    seconds: Vector
    path: tuple[int, int]

    def points(self, machine: Machine) -> Vector:
        """The marked path (N, 3) in m, on the piece, its axis at x = y = 0."""
        axes = self.axes[self.path[0] : self.path[1] + 1]
        x = axes[:, 0] * 1e-3 - machine.value("origin_x")
        y = axes[:, 1] * 1e-3 - machine.value("origin_y")
        c, s = np.cos(np.radians(axes[:, 3])), np.sin(np.radians(axes[:, 3]))
        return np.column_stack([c * x + s * y, c * y - s * x, axes[:, 2] * 1e-3])

    def volume(self, machine: Machine) -> float:
        """What the marked path extrudes in m³; 0 for a machine without an extruder."""
        said = float(self.extruded[self.path[0] + 1 : self.path[1] + 1].sum())
        return said * 1e-9 * _section(machine)


def read_gcode(text: str) -> Motion:
    """The moves of G-code as `gcode` writes it: straight, absolute, in millimetres.

    Lines of M and T are passed over. Raises FileError, naming the line, for what else is none of
    that, and where nothing marks a path.
    """
    now = dict.fromkeys("XYZCEF", 0.0)
    inverse = False
    moves: list[tuple[float, ...]] = []
    marks: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        code, comment = _parted(line)
        if comment in (BEGIN, END):
            marks[comment] = len(moves) - 1
        if not code or re.match(r"[MT]\d", code):
            continue
        (letter, command), *words = _words(code, number)
        if letter != "G" or command not in _KNOWN:
            raise FileError(
                f"Line {number} asks for {letter}{command:g}, which is not read here; write "
                "straight moves in absolute millimetres."
            )
        inverse = command == 93 or (inverse and command != 94)
        if command not in (0, 1):
            continue
        before = (now["X"], now["Y"], now["Z"])
        now["E"] = 0.0
        for letter, value in words:
            if letter not in now:
                raise FileError(f"Line {number} moves {letter}, an axis that there is not.")
            now[letter] = value
        moves.append((*(now[a] for a in "XYZCE"), _seconds(before, now, inverse)))
    if BEGIN not in marks or END not in marks or not 0 <= marks[BEGIN] <= marks[END]:
        raise FileError(
            f"This G-code marks no path: it has no comments “{BEGIN}” and “{END}” around one."
        )
    table = np.array(moves, dtype=np.float64)
    return Motion(table[:, :4], table[:, 4], table[:, 5], (marks[BEGIN], marks[END]))


def _seconds(before: tuple[float, ...], now: dict[str, float], inverse: bool) -> float:
    if now["F"] <= 0:
        return np.nan
    if inverse:
        return 60 / now["F"]
    way = (now[a] - b for a, b in zip("XYZ", before, strict=True))
    return 60 * float(np.sqrt(sum(w * w for w in way))) / now["F"]


def _parted(line: str) -> tuple[str, str]:
    """A line's code in capitals and its comment, in either style."""
    comment = " ".join(f"{a}{b}".strip() for a, b in _COMMENT.findall(line))
    return _COMMENT.sub(" ", line).strip().upper(), comment


def _words(code: str, number: int) -> list[tuple[str, float]]:
    words = _WORD.findall(code)
    if not words or _WORD.sub("", code).strip():
        raise FileError(f"Line {number}, “{code[:40]}”, is no G-code; remove or mend it.")
    return [(letter, float(value)) for letter, value in words]


def _lines(
    path: Toolpath, machine: Machine, purge: float, name: str, notes: Sequence[str]
) -> Iterator[str]:
    dialect = machine.dialect

    def said(text: str) -> str:
        plain = " ".join(text.encode("ascii", "replace").decode().split()).translate(_BRACKETS)
        return f"; {plain}" if dialect.comment == ";" else f"({plain})"

    columns = _columns(path, machine)
    values = _values(path, machine, columns, purge, name)
    yield said(f"Heliform {VERSION}: {name}" if name else f"Heliform {VERSION}")
    yield said(f"machine {machine.name}, inputs {path.inputs}")
    yield said("{turns} turns, {minutes} min, {grams} g".format(**values))
    yield from (said(note) for note in notes)
    yield from ("G21", "G90")
    if dialect.feed == "inverse-time":
        yield "G94"
    if machine.extrusion != "none":
        yield "M83"
    yield from filled(dialect.start, values)
    if purge:
        yield from filled(dialect.purge, values)
    place = [f"{letter}{column[0]}" for letter, column in columns.items() if letter != "Z"]
    yield f"G1 {' '.join(place)} F{values['feed']}"
    yield f"G1 Z{values['z']} F{values['feed']}"
    if dialect.feed == "inverse-time":
        yield "G93"
    yield said(BEGIN)
    yield from _moves(path, machine, columns)
    yield said(END)
    if dialect.feed == "inverse-time":
        yield "G94"
    yield from filled(dialect.end, values)


_BRACKETS = str.maketrans("()", "[]")


def _columns(path: Toolpath, machine: Machine) -> dict[str, list[str]]:
    """The text of each axis at every point, by its letter."""
    x, y = ((axes_of(path, machine) + _origin(machine)) * 1e3).T
    columns = {"X": _texts(x, 4), "Y": _texts(y, 4), "Z": _texts(path.points[:, 2] * 1e3, 4)}
    if machine.axes == "four":
        columns["C"] = _texts(-np.degrees(path.rotary), 5)
    return columns


def _moves(path: Toolpath, machine: Machine, columns: dict[str, list[str]]) -> Iterator[str]:
    seconds = np.diff(path.time)
    if machine.dialect.feed == "inverse-time":
        feeds = [_plain(f) for f in (60 / seconds).tolist()]
    else:
        feeds = _texts(np.diff(path.arc) / seconds * 60e3, 3)
    words = [[f" {letter}{text}" for text in column[1:]] for letter, column in columns.items()]
    if machine.extrusion != "none":
        # Rounded sums, not rounded steps: nothing adds up over ten thousand moves.
        gone = np.round(np.cumsum(path.laid()) * 1e9 / _section(machine), 5)
        words.append([f" E{text}" for text in _texts(np.diff(gone, prepend=0.0), 5)])
    words.append([f" F{text}" for text in feeds])
    for row in zip(*words, strict=True):
        yield "G1" + "".join(row)


def _section(machine: Machine) -> float:
    """How many mm³ one unit of E is; 0 without an extruder."""
    if machine.extrusion == "relative":
        return float(np.pi / 4 * (machine.value("filament_diameter") * 1e3) ** 2)
    return 1.0 if machine.extrusion == "volumetric" else 0.0


def _values(
    path: Toolpath, machine: Machine, columns: dict[str, list[str]], purge: float, name: str
) -> dict[str, str]:
    """The text of every placeholder."""
    place, clear = beside(path, machine, purge)
    x, y = _texts((place + _origin(machine)) * 1e3, 4)
    grams = float(path.laid().sum()) * machine.value("density") * 1e3
    return {
        "name": "".join(c for c in name if c.isascii() and (c.isalnum() or c in " _-.")),
        "inputs": path.inputs,
        "x": columns["X"][0],
        "y": columns["Y"][0],
        "z": columns["Z"][0],
        "c": columns["C"][0] if "C" in columns else "0",
        "purge_x": x,
        "purge_y": y,
        "feed": f"{path.speed[0] * 60e3:.3f}",
        "clearance": f"{clear * 1e3:.4f}",
        "turns": f"{path.turns:.0f}",
        "minutes": f"{path.seconds / 60:.0f}",
        "grams": f"{grams:.0f}",
    }


def _origin(machine: Machine) -> Vector:
    """Where the piece's axis stands (2,), in m."""
    return np.array([machine.value("origin_x"), machine.value("origin_y")])


def _plain(value: float) -> str:
    """A number at seven digits, never with an exponent: many controllers read none."""
    return np.format_float_positional(value, 7, unique=False, fractional=False, trim="-")


def _texts(values: Vector, decimals: int) -> list[str]:
    """Numbers as text with so many decimals, zero without a sign."""
    rounded = np.round(values, decimals) + 0.0
    return [f"{v:.{decimals}f}" for v in rounded.tolist()]
