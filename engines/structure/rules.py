"""How the members of a structure are chosen: by which check, from which sections, for whom."""

from dataclasses import dataclass
from typing import Literal

from ..core.parameters import nested, param
from .combinations import CombinationRules
from .deflection import DeflectionLimits
from .section_range import BoardRange, SectionRange
from .steel_resistance import SteelRules
from .timber_rules import TimberRules

Mode = Literal["thesis", "eurocode"]
Choose = Literal["first sufficient", "least mass", "least energy"]
Per = Literal["member", "group", "all"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """By which rules sections are chosen and checked."""

    mode: Mode = param(  # noqa: RUF009
        "thesis", help="Checks as the thesis's Karamba did, or by EN 1993 and EN 1995"
    )
    choose: Choose = param(  # noqa: RUF009
        "first sufficient",
        help="The first section of the member's own family that suffices, or the one of least mass "
        "or embodied energy of both families, whatever the level set says",
    )
    per: Per = param("member", help="A section for each member, each group, or one for all")  # noqa: RUF009
    steel: str = param(
        "thesis",
        help="Steel family: “thesis” for the range below, or its name",
        suggest=("thesis", "rhs", "shs", "chs", "ipe", "hea", "heb"),
    )
    timber: str = param(
        "thesis",
        help="Timber family: “thesis” for the range below, or its name",
        suggest=("thesis", "timber", "glulam"),
    )
    steel_grade: str = param("", help="Grade of the steel; empty is the family's own")
    timber_grade: str = param("", help="Grade of the timber; empty is the family's own")
    catalogue_file: str = param("", help="Catalogue of your own, a TOML file of families")
    steel_range: SectionRange = nested(SectionRange, "Sections of the thesis's steel")  # noqa: RUF009
    timber_range: BoardRange = nested(BoardRange, "Sections of the thesis's timber")  # noqa: RUF009
    sizes: int = param(0, "", 0, 1000, "Most different sections of each family; 0 is any number")
    stations: int = param(5, "", 3, 101, "Places along each member at which it is checked")
    rounds: int = param(100, "", 1, 1000, "Most rounds of analysing and choosing")
    turns: int = param(
        6,
        "",
        1,
        1000,
        "Times a section may turn from growing to shrinking or back before it is held",
    )
    utilisation: float = param(1.0, "", 0.05, 1.0, "Share of its resistance a member may use")
    second_order: bool = param(False, help="Forces by second-order theory, P-Δ and P-δ")
    service: bool = param(False, help="Stiffen the structure until its deflections are in limits")
    stability: float = param(
        0.0,
        *("", 0.0, 100.0),
        help="Times the loads at which the whole may buckle at the earliest, for which it is "
        "stiffened; 0 does not ask",
    )
    deflection: DeflectionLimits = nested(DeflectionLimits, "Limits of deflection")  # noqa: RUF009
    modes: int = param(
        *(0, "", 0, 50),
        help="Natural frequencies, of the members with the mass of permanent loads, and buckling "
        "modes of each combination, to work out",
    )
    buckling_y: float = param(1.0, "", 0.0, 20.0, "Buckling length about y over member length")
    buckling_z: float = param(1.0, "", 0.0, 20.0, "Buckling length about z over member length")
    lateral: float = param(1.0, "", 0.0, 20.0, "Length between lateral restraints over the same")
    combinations: CombinationRules = nested(CombinationRules, "How load cases act together")  # noqa: RUF009
    steel_rules: SteelRules = nested(SteelRules, "What EN 1993-1-1 leaves open")  # noqa: RUF009
    timber_rules: TimberRules = nested(TimberRules, "What EN 1995-1-1 leaves open")  # noqa: RUF009
