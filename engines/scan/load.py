"""Scans from files: points and faces in metres, with the unit asked, guessed and said."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError, SceneError
from ..core.scene import Vector

Unit = Literal["guess", "mm", "cm", "m", "inch"]

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "inch": 0.0254}
_GUESSED = ("mm", "inch", "m")
_LARGEST_FILE = 4 << 30  # bytes
_FEWEST = 1000


@dataclass(frozen=True, slots=True)
class Sizes:
    """How long what was scanned can be, and usually is, in m; ``what`` it is, in words."""

    smallest: float
    largest: float
    usual: float
    what: str


SAMPLE = Sizes(0.015, 1.5, 0.1, "a sample")
"""What is cut from a print to be scanned."""


@dataclass(frozen=True, slots=True)
class Scan:
    """What a scanner saw.

    ``points`` (N, 3) float64 in m, in the file's own axes; ``faces`` (F, 3) int32, empty for a
    cloud of points; ``notes`` say what was assumed and left out. ``unit`` is the one that the
    file's numbers were taken in, of those in METRES; "" where there is no file.
    """

    name: str
    points: Vector
    faces: NDArray[np.int32]
    notes: tuple[str, ...] = ()
    unit: str = ""


def load_scan(
    path: Path, unit: Unit = "guess", most: int = 20_000_000, sizes: Sizes = SAMPLE
) -> Scan:
    """The scan in a PLY, OBJ, STL or other file that trimesh reads.

    With ``unit`` "guess" the unit is the one in which the piece is nearest to its usual length in
    ``sizes``. Points that are no numbers are left out with their faces. Of more than ``most``
    points every n-th is kept, as a cloud without faces.

    Raises FileError for a missing, damaged, empty or too large file, SceneError where the piece's
    length is not within ``sizes``.
    """
    points, faces = _read(path)
    return scan_of(path.name, points, faces, unit, most, sizes)


def scan_of(
    name: str,
    points: Vector,
    faces: NDArray[Any],
    unit: Unit = "guess",
    most: int = 20_000_000,
    sizes: Sizes = SAMPLE,
) -> Scan:
    """A `Scan` of arrays, (N, 3) in ``unit`` and (F, 3); otherwise as `load_scan`."""
    notes: list[str] = []
    points = np.asarray(points, dtype=np.float64)
    faces = np.asarray(faces, dtype=np.int32).reshape(-1, 3)
    points, faces = _numbers_only(points, faces, notes)
    if len(points) < _FEWEST:
        raise FileError(
            f"The scan “{name}” has {len(points):,} points, too few for a relief; export it with "
            f"at least {_FEWEST:,}."
        )
    if len(points) > most:
        step = -(-len(points) // most)
        notes.append(
            f"The scan has {len(points):,} points, more than {most:,}: every "
            f"{step}th is kept, without faces."
        )
        points, faces = np.ascontiguousarray(points[::step]), np.zeros((0, 3), np.int32)
    if not len(faces):
        notes.append("The scan has no faces: read as a cloud of points.")
    chosen = _unit(name, _length(points), unit, sizes, notes)
    return Scan(name, points * METRES[chosen], faces, tuple(notes), chosen)


def _read(path: Path) -> tuple[Vector, NDArray[Any]]:
    if not path.is_file():
        raise FileError(f"There is no scan “{path}”; check its name and folder.")
    size = path.stat().st_size
    if size == 0:
        raise FileError(f"The scan “{path.name}” is empty; export it again.")
    if size > _LARGEST_FILE:
        raise FileError(
            f"The scan “{path.name}” has {size / 2**30:.1f} GB, more than the "
            f"{_LARGEST_FILE >> 30} GB that are read; thin it out in the scanner's program."
        )
    import trimesh

    try:
        loaded = trimesh.load(path, process=False)
        parts = list(loaded.geometry.values()) if isinstance(loaded, trimesh.Scene) else [loaded]
        return _joined([(_array(p, "vertices"), _array(p, "faces")) for p in parts])
    except Exception as failed:
        reason = " ".join(str(failed).split()) or type(failed).__name__
        raise FileError(
            f"The scan “{path.name}” cannot be read ({reason[:160]}); export it again as binary "
            "PLY, OBJ or STL."
        ) from failed


def _array(part: Any, name: str) -> NDArray[Any]:
    return np.asarray(getattr(part, name, np.zeros((0, 3)))).reshape(-1, 3)


def _joined(parts: list[tuple[Vector, NDArray[Any]]]) -> tuple[Vector, NDArray[Any]]:
    starts = np.cumsum([0] + [len(points) for points, _ in parts[:-1]])
    points = [np.zeros((0, 3)), *(points for points, _ in parts)]
    faces = [np.zeros((0, 3), int), *(f + s for (_, f), s in zip(parts, starts, strict=True))]
    return np.concatenate(points), np.concatenate(faces)


def _numbers_only(
    points: Vector, faces: NDArray[np.int32], notes: list[str]
) -> tuple[Vector, NDArray[np.int32]]:
    good = np.isfinite(points).all(axis=1)
    if good.all():
        return points, faces
    notes.append(f"Left out {np.count_nonzero(~good):,} points that are no numbers.")
    return kept(points, faces, good)


def kept(
    points: Vector, faces: NDArray[np.int32], good: NDArray[np.bool_]
) -> tuple[Vector, NDArray[np.int32]]:
    """The ``good`` (N,) points and the faces all of whose corners are among them."""
    number = np.cumsum(good, dtype=np.int32) - np.int32(1)
    if len(faces):
        faces = number[faces[good[faces].all(axis=1)]]
    return points[good], faces


def _length(points: Vector) -> float:
    """The diagonal of the box that holds the middle 98 % of the points along each axis."""
    some = points[:: max(1, len(points) // 100_000)]
    low, high = np.percentile(some, [1, 99], axis=0)
    return float(np.linalg.norm(high - low))


def _unit(name: str, length: float, unit: Unit, sizes: Sizes, notes: list[str]) -> str:
    """The unit that was asked for or is likeliest, checked against what the piece can be."""
    likely = min(_GUESSED, key=lambda u: abs(np.log(max(length, 1e-12) * METRES[u] / sizes.usual)))
    chosen = likely if unit == "guess" else unit
    size = length * METRES[chosen]
    if not sizes.smallest <= size <= sizes.largest:
        other = length * METRES[likely]
        hint = (
            f"with unit = “{likely}” it would be {_said(other)}"
            if sizes.smallest <= other <= sizes.largest and likely != chosen
            else f"scan {sizes.what} of about {_said(sizes.usual)}, or scale the file"
        )
        raise SceneError(
            f"The scan “{name}” is {_said(size)} long when its numbers are in {chosen}, and "
            f"{sizes.what} has {_said(sizes.smallest)} to {_said(sizes.largest)}; {hint}."
        )
    if unit == "guess":
        notes.append(
            f"The file does not say its unit: taken as {chosen}, in which the piece is "
            f"{_said(size)} across; set the unit if that is wrong."
        )
    return chosen


def _said(metres: float) -> str:
    return f"{metres:.3g} m" if metres >= 1 else f"{metres * 1e3:.3g} mm"
