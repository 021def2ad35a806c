"""Which actions act together, and how much of each: by EN 1990, or simply summed."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.parameters import param
from ..core.scene import Vector
from .loads import Action, Loads
from .timber_rules import DURATIONS, Duration

Limit = Literal["ultimate", "service"]
Kind = Literal["fundamental", "characteristic", "frequent", "quasi-permanent"]
Imposed = Literal[
    "dwelling", "office", "assembly", "shop", "storage", "light traffic", "traffic", "roof"
]
Snow = Literal["below 1000 m", "above 1000 m"]

_IMPOSED: dict[Imposed, tuple[tuple[float, float, float], Duration]] = {
    "dwelling": ((0.7, 0.5, 0.3), "medium"),
    "office": ((0.7, 0.5, 0.3), "medium"),
    "assembly": ((0.7, 0.7, 0.6), "medium"),
    "shop": ((0.7, 0.7, 0.6), "medium"),
    "storage": ((1.0, 0.9, 0.8), "long"),
    "light traffic": ((0.7, 0.7, 0.6), "medium"),
    "traffic": ((0.7, 0.5, 0.3), "medium"),
    "roof": ((0.0, 0.0, 0.0), "short"),
}
"""ψ0, ψ1 and ψ2 of EN 1990 Table A1.1, categories A to H, and the load-duration class."""

_SNOW: dict[Snow, tuple[tuple[float, float, float], Duration]] = {
    "below 1000 m": ((0.5, 0.2, 0.0), "short"),
    "above 1000 m": ((0.7, 0.5, 0.2), "medium"),
}
_WIND = (0.6, 0.2, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class CombinationRules:
    """How load cases are combined, with the recommended values of EN 1990 Annex A1."""

    rule: Literal["characteristic", "eurocode"] = param(
        "characteristic",
        help="Every action once with factor 1, as in the thesis, or EN 1990 with its factors",
    )
    permanent_unfavourable: float = param(1.35, "", 1.0, 3.0, "γG,sup, where it adds")
    permanent_favourable: float = param(1.0, "", 0.0, 1.0, "γG,inf, where it relieves")
    variable: float = param(1.5, "", 1.0, 3.0, "γQ of variable actions")
    imposed: Imposed = param(  # noqa: RUF009
        "roof", help="What imposed loads are from, categories A to H of EN 1991-1-1"
    )
    snow: Snow = param(  # noqa: RUF009
        "below 1000 m", help="Altitude of the site; “above” also for the Nordic countries"
    )
    wind_duration: Literal["short", "instantaneous"] = param(
        "short", help="Load-duration class of wind, EN 1995-1-1 Table 2.2"
    )


@dataclass(frozen=True, slots=True)
class Combinations:
    """K combinations of C load cases.

    ``names`` (K,): "1.35 self-weight + 1.5 roof load + 0.9 wind +x". ``factors`` (K, C).
    ``limit`` (K,) text: "ultimate" or "service". ``kind`` (K,) text: "fundamental" (equation 6.10),
    "characteristic", "frequent" or "quasi-permanent". ``duration`` (K,) text: the load-duration
    class of the shortest action. ``lasting`` (K, C): what of the factors acts for long enough to
    make timber creep, G + Σ ψ2 Q over the variable actions in the combination; zero for
    ultimate ones. ``notes``: by which rule and with which factors.
    """

    names: tuple[str, ...]
    factors: Vector
    limit: NDArray[np.str_]
    kind: NDArray[np.str_]
    duration: NDArray[np.str_]
    lasting: Vector
    notes: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.names)

    def of(self, limit: Limit) -> "Combinations":
        """Those of one limit state."""
        kept = np.flatnonzero(self.limit == limit)
        return Combinations(
            tuple(self.names[k] for k in kept),
            self.factors[kept],
            self.limit[kept],
            self.kind[kept],
            self.duration[kept],
            self.lasting[kept],
            self.notes,
        )

    def described(self) -> tuple[str, ...]:
        """Lines for a report: the rule, its factors, and every combination."""
        lines = [
            f"{limit}, {kind}, {duration}: {name}"
            for limit, kind, duration, name in zip(
                self.limit, self.kind, self.duration, self.names, strict=True
            )
        ]
        return (*self.notes, *lines)


def combinations_of(loads: Loads, rules: CombinationRules) -> Combinations:
    """The combinations of ``loads`` by ``rules``; those for strength first, then those for service.

    Permanent cases always act together, and so do imposed ones. Cases of snow exclude each other,
    as do those of wind.

    Characteristic: the permanent actions; with the imposed ones; and these with each case of snow
    and of wind, all with factor 1, for both limit states. Eurocode: equation 6.10 with permanent
    actions unfavourable and favourable, variable actions only where they act and each leading in
    turn; and 6.14b, 6.15b and 6.16b for service. Of equal combinations only one is kept.

    Raises ParameterError where there is no load case.
    """
    if not loads.names:
        raise ParameterError(
            "There is no load case to combine; switch self-weight on or give a load."
        )
    rows = list(_summed(loads) if rules.rule == "characteristic" else _by_eurocode(loads, rules))
    unique = {(row.kind, row.limit, tuple(np.round(row.factors, 9))): row for row in reversed(rows)}
    rows = list(reversed(unique.values()))
    return Combinations(
        tuple(_name(row.factors, loads.names) for row in rows),
        np.array([row.factors for row in rows]),
        np.array([row.limit for row in rows]),
        np.array([row.kind for row in rows]),
        np.array([_shortest(row.factors, loads.actions, rules) for row in rows]),
        np.array([_lasting(row, loads.actions, rules) for row in rows]),
        _notes(loads, rules),
    )


@dataclass(frozen=True, slots=True)
class _Row:
    limit: Limit
    kind: Kind
    factors: Vector


def _summed(loads: Loads) -> Iterator[_Row]:
    """Every action with factor 1, for strength and again for service."""
    permanent, imposed = _acting(loads, "permanent"), _acting(loads, "imposed")
    others = [_alone(loads, c) for c in _cases(loads, "snow") + _cases(loads, "wind")]
    sums = [permanent, permanent + imposed, *(permanent + imposed + other for other in others)]
    limits: tuple[tuple[Limit, Kind], ...] = (
        ("ultimate", "characteristic"),
        ("service", "characteristic"),
    )
    for (limit, kind), factors in itertools.product(limits, sums):
        if factors.any():
            yield _Row(limit, kind, factors)


def _by_eurocode(loads: Loads, rules: CombinationRules) -> Iterator[_Row]:
    """Equations 6.10, 6.14b, 6.15b and 6.16b of EN 1990."""
    permanent = _acting(loads, "permanent")
    choices = list(_choices(loads))
    if permanent.any():
        yield _Row("ultimate", "fundamental", rules.permanent_unfavourable * permanent)
    for partial in (rules.permanent_unfavourable, rules.permanent_favourable):
        for chosen in choices:
            for leading in range(len(chosen)):
                variable = _led(chosen, leading, rules, first=None, others=0)
                factors = partial * permanent + rules.variable * variable
                yield _Row("ultimate", "fundamental", factors)

    services: tuple[tuple[Kind, int | None, int], ...] = (
        ("characteristic", None, 0),
        ("frequent", 1, 2),
        ("quasi-permanent", 2, 2),
    )
    for kind, first, others in services:
        if permanent.any():
            yield _Row("service", kind, permanent)
        for chosen in choices:
            for leading in range(len(chosen)):
                factors = permanent + _led(chosen, leading, rules, first, others)
                if factors.any():
                    yield _Row("service", kind, factors)


def _choices(loads: Loads) -> Iterator[list[tuple[Action, Vector]]]:
    """Every choice of variable actions that can act together: at most one snow and one wind."""
    imposed = _acting(loads, "imposed")
    options: list[list[tuple[Action, Vector] | None]] = [
        [None, ("imposed", imposed)] if imposed.any() else [None],
        [None, *(("snow", _alone(loads, c)) for c in _cases(loads, "snow"))],
        [None, *(("wind", _alone(loads, c)) for c in _cases(loads, "wind"))],
    ]
    for picked in itertools.product(*options):
        chosen = [one for one in picked if one is not None]
        if chosen:
            yield chosen


def _led(
    chosen: list[tuple[Action, Vector]],
    leading: int,
    rules: CombinationRules,
    first: int | None,
    others: int,
) -> Vector:
    """Variable actions, the leading one with ψ_first (None: 1) and the others with ψ_others."""
    total = np.zeros_like(chosen[0][1])
    for index, (action, acting) in enumerate(chosen):
        which = first if index == leading else others
        total += acting * (1.0 if which is None else _psi(action, rules)[which])
    return total


def _psi(action: Action, rules: CombinationRules) -> tuple[float, float, float]:
    """ψ0, ψ1 and ψ2 of a kind of action, EN 1990 Table A1.1."""
    if action == "imposed":
        return _IMPOSED[rules.imposed][0]
    if action == "snow":
        return _SNOW[rules.snow][0]
    return _WIND if action == "wind" else (1.0, 1.0, 1.0)


def _duration(action: Action, rules: CombinationRules) -> Duration:
    """The load-duration class of a kind of action, EN 1995-1-1 Table 2.2."""
    if action == "imposed":
        return _IMPOSED[rules.imposed][1]
    if action == "snow":
        return _SNOW[rules.snow][1]
    return rules.wind_duration if action == "wind" else "permanent"


def _shortest(factors: Vector, actions: tuple[Action, ...], rules: CombinationRules) -> Duration:
    acting = {_duration(actions[c], rules) for c in np.flatnonzero(factors)}
    return next(one for one in reversed(DURATIONS) if one in acting)


def _lasting(row: _Row, actions: tuple[Action, ...], rules: CombinationRules) -> Vector:
    if row.limit == "ultimate":
        return np.zeros_like(row.factors)
    long = np.array([_psi(action, rules)[2] for action in actions])
    return np.where(row.factors > 0.0, long, 0.0)


def _cases(loads: Loads, action: Action) -> list[int]:
    return [c for c, one in enumerate(loads.actions) if one == action]


def _alone(loads: Loads, case: int) -> Vector:
    return (np.arange(len(loads.names)) == case).astype(float)


def _acting(loads: Loads, action: Action) -> Vector:
    return np.array([float(one == action) for one in loads.actions])


def _name(factors: Vector, names: tuple[str, ...]) -> str:
    return " + ".join(
        names[c] if factors[c] == 1.0 else f"{factors[c]:.4g} {names[c]}"
        for c in np.flatnonzero(factors)
    )


def _notes(loads: Loads, rules: CombinationRules) -> tuple[str, ...]:
    """The rule and the factors that were used, as lines."""
    if rules.rule == "characteristic":
        lines = ["Actions summed with factor 1, without partial factors, as in the thesis"]
    else:
        lines = [
            "EN 1990 with the recommended values of Annex A1: equation 6.10 for strength; 6.14b, "
            "6.15b and 6.16b for service",
            f"γG {rules.permanent_unfavourable:g} unfavourable, {rules.permanent_favourable:g} "
            f"favourable; γQ {rules.variable:g}",
        ]
        said: dict[Action, str] = {
            "imposed": f"imposed ({rules.imposed})",
            "snow": f"snow ({rules.snow})",
            "wind": "wind",
        }
        for action, text in said.items():
            if action in loads.actions:
                zero, one, two = _psi(action, rules)
                lines.append(f"ψ0, ψ1, ψ2 of {text}: {zero:g}, {one:g}, {two:g}")
        if "floor load" in loads.names and rules.imposed == "roof":
            lines.append(
                "The floor load counts as one on a roof, with ψ0 = 0: where wind leads it is left "
                "out; set imposed to what the floors are for"
            )
    if loads.actions.count("snow") > 1:
        lines.append("Cases of snow exclude each other")
    if loads.actions.count("wind") > 1:
        lines.append("Directions of wind exclude each other")
    return tuple(lines)
