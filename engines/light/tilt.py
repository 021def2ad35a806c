"""How much less a lamp gives when its luminaire is tilted [ANSI/IES LM-63-19, TILT]."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .numerals import (
    ANEW,
    Numerals,
    check_ascending,
    check_count,
    fault,
    lines_of,
    numerals,
    read_text,
)


@dataclass(frozen=True, slots=True)
class Tilt:
    """The factors on the intensity of a luminaire whose lamp depends on how it burns.

    ``geometry`` says how the lamp lies in the luminaire that looks straight down: 1 upright,
    2 level along the photometric plane C0, 3 level across it, along C90. ``angles`` (N,) float64
    in degrees ascend within 0..180, ``factors`` (N,) float64 belong to them.
    """

    geometry: int
    angles: NDArray[np.float64]
    factors: NDArray[np.float64]


def tilt_factor(tilt: Tilt | None, degrees: ArrayLike) -> NDArray[np.float64]:
    """The factor on the intensity at tilts of 0..180°; 1 where nothing is known.

    Linear between the angles, constant beyond them. Where they end at or before 90° the lamp is
    taken to be the same upside down, so that 120° counts as 60°.
    """
    degrees = np.asarray(degrees, float)
    if tilt is None:
        return np.ones_like(degrees)
    if tilt.angles[-1] <= 90:
        degrees = np.minimum(degrees, 180 - degrees)
    return np.interp(degrees, tilt.angles, tilt.factors)


def lamp_tilt(tilt: Tilt | None, axes: NDArray[np.float64]) -> float:
    """How far in degrees a lamp is tipped from how it lies in an upright luminaire.

    ``axes`` (3, 3) has the luminaire's X (C0), Y (C90) and Z as columns, in the world. An upright
    lamp is tipped by the angle between the luminaire's −Z and the world's, 0..180; a level one by
    the slope of its own axis, 0..90: turned about that axis it stays level.
    """
    if tilt is None:
        return 0.0
    x, y, z = axes[2]
    if tilt.geometry == 1:
        return float(np.degrees(np.arctan2(np.hypot(x, y), z)))
    slope = abs(x if tilt.geometry == 2 else y)
    return float(np.degrees(np.arcsin(min(slope, 1.0))))


def read_tilt(path: Path, line: int, named: str, numbers: Numerals) -> Tilt | None:
    """The tilt that a photometric file states, after TILT= in ``line``, as ``named``.

    INCLUDE takes it from ``numbers``; the name of a file from that file, which lies beside the
    photometric one whatever folder the name gives. Raises FileError.
    """
    if named.upper() == "NONE":
        return None
    if named.upper() == "INCLUDE":
        return _block(numbers)
    if not named:
        raise fault(path.name, line, "has nothing after TILT=", "write TILT=NONE if that is meant")
    found = _beside(path, line, named)
    block = numerals(found.name, lines_of(read_text(found, "tilt file")), 1)
    tilt = _block(block)
    if len(block.values):
        raise fault(
            block.name,
            block.lines[0],
            "goes on after the tilt factors",
            "remove what follows or correct the number of pairs",
        )
    return tilt


def tilt_file(path: Path, line: int, named: str) -> Path | None:
    """The file that a photometric file takes its tilt from, None where it takes it from none.

    Otherwise as `read_tilt`. Raises FileError where it is not there.
    """
    return None if named.upper() in ("", "NONE", "INCLUDE") else _beside(path, line, named)


def _beside(path: Path, line: int, named: str) -> Path:
    """The tilt file; letters' case counts only where it must."""
    name = named.replace("\\", "/").rsplit("/", 1)[-1]
    try:
        near = sorted(p for p in path.parent.iterdir() if p.name.lower() == name.lower())
    except OSError:
        near = []
    if not near:
        raise fault(
            path.name,
            line,
            f"takes its tilt factors from “{named}”, which is not beside it",
            "put that file into the same folder, or write TILT=NONE if the lamp hangs upright",
        )
    return next((p for p in near if p.name == name), near[0])


def _block(numbers: Numerals) -> Tilt:
    name = numbers.name
    head = numbers.take(2, "values that begin the tilt factors")
    geometry, pairs = head.values
    if geometry not in (1, 2, 3):
        raise fault(
            name,
            head.lines[0],
            f"states lamp-to-luminaire geometry {geometry:g}, which does not exist",
            "it should be 1 (upright), 2 (level along C0) or 3 (level across C0): correct it",
        )
    count = check_count(name, head.lines[1], "pairs of tilt angles and factors", pairs, 1)
    angles = numbers.take(count, "tilt angles")
    factors = numbers.take(count, "tilt factors")
    check_ascending(name, "tilt", angles, 0.0, 180.0)
    negative = np.flatnonzero(factors.values < 0)
    if negative.size:
        k = negative[0]
        what = f"has a tilt factor of {factors.values[k]:g}, which no lamp can have"
        raise fault(name, factors.lines[k], what, ANEW)
    return Tilt(int(geometry), angles.values, factors.values)
