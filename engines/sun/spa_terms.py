"""The periodic terms of NREL's solar position algorithm: the earth's orbit and its nutation.

Tables A4.2 and A4.3 of Reda & Andreas, *Solar Position Algorithm for Solar Radiation
Applications*, NREL/TP-560-34302, revised 2008, as ``data/spa_earth.csv`` and
``data/spa_nutation.csv``.
"""

import csv
import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from ..core.scene import Vector

DATA = Path(__file__).parent / "data"

type Coordinate = Literal["longitude", "latitude", "radius"]


@dataclass(frozen=True, slots=True)
class Orbit:
    """One heliocentric coordinate of the earth as Σₚ τᵖ Σₙ A cos(B + C τ).

    ``amplitude`` (n, 6) holds A in the column of its power p, in 10⁻⁸ rad or 10⁻⁸ AU; ``phase``
    (n,) B in rad; ``frequency`` (n,) C in rad a Julian millennium.
    """

    amplitude: Vector
    phase: Vector
    frequency: Vector


@dataclass(frozen=True, slots=True)
class Nutation:
    """Nutation as sums of (a + b T) sin θ and (c + d T) cos θ, in 0.0001″.

    ``arguments`` (63, 5): what multiplies the moon's elongation, the anomalies of sun and moon,
    the moon's argument of latitude and its node; ``longitude`` (63, 2) a and b of Δψ,
    ``obliquity`` (63, 2) c and d of Δε.
    """

    arguments: Vector
    longitude: Vector
    obliquity: Vector


@functools.cache
def orbit(coordinate: Coordinate) -> Orbit:
    """The terms of one coordinate of the earth (table A4.2)."""
    rows = [row[1:] for row in _rows("spa_earth.csv") if row[0] == coordinate]
    power, size, phase, frequency = np.array(rows, dtype=np.float64).T
    amplitude = np.zeros((len(rows), 6))
    amplitude[np.arange(len(rows)), power.astype(int)] = size
    return Orbit(amplitude, phase, frequency)


@functools.cache
def nutation() -> Nutation:
    """The terms of nutation in longitude and obliquity (table A4.3)."""
    table = np.array(_rows("spa_nutation.csv"), dtype=np.float64)
    return Nutation(table[:, :5], table[:, 5:7], table[:, 7:9])


def _rows(name: str) -> list[list[str]]:
    """The rows of a shipped table below its heading."""
    with (DATA / name).open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))[1:]
