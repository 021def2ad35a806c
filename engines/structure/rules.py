"""How the members of a structure are chosen: by which check, from which sections, for whom."""

from dataclasses import dataclass
from typing import Literal

from ..core.parameters import nested, param

Mode = Literal["thesis", "eurocode"]
Choose = Literal["first sufficient", "least mass", "least energy"]
Per = Literal["member", "group", "all"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SteelRange:
    """Rectangular hollow sections in even steps, as in the thesis's Table 4."""

    height_low: float = param(0.05, "m", 0.02, 5.0, "Least height")
    height_high: float = param(2.0, "m", 0.02, 5.0, "Greatest height")
    width_low: float = param(0.05, "m", 0.02, 2.0, "Least width")
    width_high: float = param(0.2, "m", 0.02, 2.0, "Greatest width")
    step: float = param(0.05, "m", 0.001, 1.0, "Step of height and width")
    thickness: float = param(0.01, "m", 0.001, 0.1, "Wall thickness")


@dataclass(frozen=True, slots=True, kw_only=True)
class TimberRange:
    """Solid rectangular sections in even steps, as in the thesis's Table 4."""

    height_low: float = param(0.1, "m", 0.01, 5.0, "Least height")
    height_high: float = param(2.0, "m", 0.01, 5.0, "Greatest height")
    width_low: float = param(0.02, "m", 0.005, 2.0, "Least width")
    width_high: float = param(0.1, "m", 0.005, 2.0, "Greatest width")
    step: float = param(0.02, "m", 0.001, 1.0, "Step of height and width")


@dataclass(frozen=True, slots=True, kw_only=True)
class Rules:
    """By which rules sections are chosen and checked."""

    mode: Mode = param(
        "thesis", help="Checks as the thesis's Karamba did, or by EN 1993 and EN 1995"
    )
    choose: Choose = param(
        "first sufficient",
        help="The first section of the member's own family that suffices, or the one of least mass "
        "or embodied energy of both families, whatever the level set says",
    )
    per: Per = param("member", help="A section for each member, each group, or one for all")
    steel: str = param("thesis", help="Steel family: “thesis” for the range below, or its name")
    timber: str = param("thesis", help="Timber family: “thesis” for the range below, or its name")
    catalogue_file: str = param("", help="Catalogue of your own, a TOML file of families")
    steel_range: SteelRange = nested(SteelRange, "Sections of the thesis's steel")  # noqa: RUF009
    timber_range: TimberRange = nested(TimberRange, "Sections of the thesis's timber")  # noqa: RUF009
    stations: int = param(5, "", 2, 101, "Places along each member at which it is checked")
    rounds: int = param(60, "", 1, 1000, "Most rounds of analysing and choosing")
    utilisation: float = param(1.0, "", 0.05, 1.0, "Share of its resistance a member may use")
    second_order: bool = param(False, help="Forces by second-order theory, P-Δ and P-δ")
    service: bool = param(False, help="Stiffen the structure until its deflections are in limits")
    buckling_y: float = param(1.0, "", 0.0, 20.0, "Buckling length about y over member length")
    buckling_z: float = param(1.0, "", 0.0, 20.0, "Buckling length about z over member length")
    lateral: float = param(1.0, "", 0.0, 20.0, "Length between lateral restraints over the same")
