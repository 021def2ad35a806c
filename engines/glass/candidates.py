"""Candidates of a print library: the grid of plans that is asked for, each shape once."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np

from ..core.errors import ParameterError
from ..core.parameters import from_table, nested, param, to_table
from ..core.scene import Vector
from .fourier import Plan
from .loft import Wall
from .machine import MachineName
from .symmetry import canonical
from .toolpath import Spiral

WHERE = "glass.library"


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintLibrary:
    """Every wall of a grid of two-wave plans, judged by the print gate."""

    lowest_period: int = param(2, "", 1, 23, "Fewest waves around")
    periods: int = param(10, "", 2, 24, "How many periods; two different ones make a plan")
    amplitude_low: float = param(0.01, "", -0.5, 0.5, "Lowest amplitude, over the radius")
    amplitude_high: float = param(0.07, "", -0.5, 0.5, "Highest amplitude, over the radius")
    amplitudes: int = param(7, "", 1, 100, "How many amplitudes, evenly from lowest to highest")
    offset_low: float = param(-0.006, "m", -0.05, 0.05, "Lowest offset by curvature")
    offset_high: float = param(0.009, "m", -0.05, 0.05, "Highest offset by curvature")
    offsets: int = param(31, "", 1, 1000, "How many offsets, evenly from lowest to highest")
    radius: float = param(0.12, "m", 5e-3, 2.0, "Mean radius, midway in the wall")
    height: float = param(0.2, "m", 5e-3, 2.0, "Height of the walls")
    thickness: float = param(8.0e-3, "m", 1e-3, 0.05, "Wall thickness")
    overlap: Literal["clip", "hull"] = param(
        "clip", help="Where a wall would run into itself: clip it, or take the convex hull"
    )
    spiral: Spiral = nested(Spiral, "How a wall is laid down")  # noqa: RUF009
    machine: MachineName = param(  # noqa: RUF009
        "glass-printer", help="Machine profile: shipped, or a file of your own"
    )
    machine_file: str = param("", help="Machine profile of your own, a TOML file")
    limit: int = param(0, "", 0, 10_000_000, "Judge only so many, drawn by the seed; 0 is all")
    processes: int = param(0, "", 0, 256, "Processes that share the work; 0 is one for each core")
    store_file: str = param(
        "", help="Where rows are kept to go on from after a stop; empty is the user's cache folder"
    )


def asked_plans(record: PrintLibrary) -> list[Plan]:
    """Every plan of the grid, two different periods each, as they are asked for.

    Raises ParameterError when a value is out of bounds or a range runs backward.
    """
    record = from_table(PrintLibrary, to_table(record), WHERE)
    for name, low, high in (
        ("amplitude", record.amplitude_low, record.amplitude_high),
        ("offset", record.offset_low, record.offset_high),
    ):
        if low > high:
            raise ParameterError(
                f"[{WHERE}] {name}_low = {low:g} is above {name}_high = {high:g}; exchange them."
            )
    periods = range(record.lowest_period, record.lowest_period + record.periods)
    heights = np.linspace(record.amplitude_low, record.amplitude_high, record.amplitudes)
    offsets = np.linspace(record.offset_low, record.offset_high, record.offsets)
    return [
        Plan(
            radius=record.radius,
            period_1=k1,
            amplitude_1=a1,
            period_2=k2,
            amplitude_2=a2,
            offset=offset,
        )
        for k1, k2 in combinations(periods, 2)
        for a1 in _rounded(heights)
        for a2 in _rounded(heights)
        for offset in _rounded(offsets)
    ]


def folded(plans: Iterable[Plan]) -> list[Plan]:
    """The shapes among ``plans``, each once and as its `canonical` plan, in their order."""
    return list(dict.fromkeys(map(canonical, plans)))


def drawn(plans: list[Plan], limit: int, seed: int) -> list[Plan]:
    """``limit`` of the plans at random, in their order; all where it is 0 or not below them."""
    if not 0 < limit < len(plans):
        return plans
    chosen = np.random.default_rng(seed).choice(len(plans), limit, replace=False)
    return [plans[i] for i in np.sort(chosen)]


def wall_of(plan: Plan, record: PrintLibrary) -> Wall:
    """The wall that a candidate's plan makes."""
    return Wall(plan=plan, height=record.height, thickness=record.thickness, overlap=record.overlap)


def _rounded(values: Vector) -> list[float]:
    """Values as `canonical` keeps them and as a table shows them."""
    return [round(float(v), 9) for v in values]
