"""The numbers of a sized structure, and what a reader of it should know."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .rules import Rules
    from .sized import Sized
    from .sizing import Chosen

_GIGA = 1e9
_OUTSIDE = 1e6  # utilisation of what no code covers, infinite to the check
FIRM = 10.0
"""Times the loads at which the whole buckles, from which on first-order theory will do: EN 1993-1-1
5.2.1(3)."""
_NAMED = 5  # members at most that a note names


@dataclass(frozen=True, slots=True)
class Stability:
    """Whether the whole keeps its place: the names of the combinations that buckle it, and
    whether it is ``firm``, so that none does at `FIRM` times its loads."""

    away: tuple[str, ...]
    firm: bool


def figures_of(
    result: "Sized", chosen: "Chosen", stability: Stability
) -> dict[str, dict[str, Any]]:
    """Name → value and unit: mass, energy and carbon, use, displacement, convergence."""
    rows = result.rows
    steel = rows["material"] == "steel"
    moved = np.linalg.norm(result.deflections, axis=-1)
    used = np.minimum(rows["utilisation"], _OUTSIDE)
    pieces = {(str(row["grade"]), str(row["name"])) for row in rows}
    numbers: dict[str, tuple[float, str]] = {
        "mass": (rows["mass"].sum(), "kg"),
        "mass_steel": (rows["mass"][steel].sum(), "kg"),
        "mass_timber": (rows["mass"][~steel].sum(), "kg"),
        "embodied_energy": (rows["energy"].sum() / _GIGA, "GJ"),
        "carbon": (rows["carbon"].sum(), "kg CO2e"),
        "volume": ((rows["area"] * rows["length"]).sum(), "m³"),
        "members": (len(rows), ""),
        "members_steel": (steel.sum(), ""),
        "members_timber": ((~steel).sum(), ""),
        "sections": (len(pieces), ""),
        "max_utilisation": (used.max(), ""),
        "mean_utilisation": (used.mean(), ""),
        "failing": (rows["failing"].sum(), ""),
        "buckling_combinations": (len(stability.away), ""),
        "max_displacement": (moved.max(), "m"),
        "rounds": (len(chosen.changes), ""),
        "converged": (chosen.converged, ""),
        "still_changing": (chosen.changes[-1], ""),
        "held": (chosen.held, ""),
    }
    for number, name in enumerate(result.model.group_names):
        if (rows["group"] == number).any():
            key = f"mass_{name.replace(' ', '_')}"
            numbers[key] = (rows["mass"][rows["group"] == number].sum(), "kg")
    if len(result.served.names):
        numbers["max_service_utilisation"] = (result.served.utilisation.max(), "")
    if len(result.frequencies):
        numbers["first_frequency"] = (result.frequencies[0], "Hz")
    if len(result.buckling):
        numbers["buckling_factor"] = (result.buckling[0], "")
    return {name: {"value": float(value), "unit": unit} for name, (value, unit) in numbers.items()}


def notes_on(result: "Sized", chosen: "Chosen", rules: "Rules", stability: Stability) -> list[str]:
    """What a reader should know, a sentence each: what fails, what moves, whether it converged."""
    notes = []
    rows, members = result.rows, result.model.frame.members
    if rules.mode == "eurocode" and rules.combinations.rule == "characteristic":
        notes.append(
            "Checked by Eurocode, but under loads without partial factors, which is unsafe; set "
            "the combinations' rule to eurocode."
        )
    if failing := int(rows["failing"].sum()):
        worst = np.argsort(-rows["utilisation"], kind="stable")[: min(failing, _NAMED)]
        said = ", ".join(
            f"{m} (nodes {members[m, 0]} and {members[m, 1]}, {rows['utilisation'][m]:.3g})"
            for m in worst.tolist()
        )
        even = " even with the largest section" if chosen.converged else ""
        more = " and others" if failing > _NAMED else ""
        steel = "steel or " if (rows["material"][rows["failing"]] == "timber").any() else ""
        notes.append(
            f"{failing} of {len(rows)} members fail{even}: member {said}"
            f"{more}; widen their range, give them {steel}a shorter span, or set turns "
            "to 1, which lets fewer sections shrink."
        )
    if not chosen.converged:
        notes.append(
            f"Not converged: {chosen.changes[-1]} sections still changed in round "
            f"{len(chosen.changes)}; allow more rounds."
        )
    if chosen.held:
        notes.append(
            f"{chosen.held} sections went to and fro between two sizes and keep the larger."
        )
    given_up = ", although stiffened as far as it went" if rules.service else ""
    for name, used in zip(result.served.names, result.served.utilisation, strict=True):
        if used.max() > 1:
            m = int(used.argmax())
            notes.append(
                f"{name}: {used[m]:.3g} times what is allowed at member {m} (nodes "
                f"{members[m, 0]} and {members[m, 1]}){given_up}."
            )
    notes += _on_buckling(result, stability)
    if slender := int((result.checked.section_class == 4).sum()):
        notes.append(
            f"{slender} members have sections of class 4, whose walls buckle (EN 1993-1-5)."
        )
    return notes + list(result.meta["combination_notes"])


def _on_buckling(result: "Sized", stability: Stability) -> list[str]:
    """What the buckling of the whole asks for."""
    exactly = f" (the least factor is {result.buckling[0]:.3g})" if len(result.buckling) else ""
    if stability.away:
        others = len(stability.away) - 1
        more = f" and {others} other combinations" if others else ""
        return [
            f"The whole buckles before all of “{stability.away[0]}”{more} acts{exactly}, although "
            "its members, checked for buckling between their nodes, may suffice; brace it with "
            "diagonals, raise its surface, or make buckling_y and buckling_z, over a member's "
            "length, those of the whole."
        ]
    if not stability.firm:
        return [
            f"The whole would buckle at less than {FIRM:g} times its loads{exactly}, so that "
            "first-order forces are too small (EN 1993-1-1 5.2.1); tick second_order."
        ]
    return []
