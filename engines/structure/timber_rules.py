"""What EN 1995-1-1 makes of timber's strengths: climate, duration of load, size, creep."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.parameters import param
from ..core.scene import Vector
from .grade import Grade

Duration = Literal["permanent", "long", "medium", "short", "instantaneous"]
DURATIONS: tuple[Duration, ...] = ("permanent", "long", "medium", "short", "instantaneous")
"""The load-duration classes of Table 2.1, the longest first."""

ServiceClass = Literal["1 heated indoors", "2 under cover", "3 exposed"]

_MODIFICATION: dict[ServiceClass, tuple[float, ...]] = {
    "1 heated indoors": (0.60, 0.70, 0.80, 0.90, 1.10),
    "2 under cover": (0.60, 0.70, 0.80, 0.90, 1.10),
    "3 exposed": (0.50, 0.55, 0.65, 0.70, 0.90),
}
_CREEP: dict[ServiceClass, float] = {
    "1 heated indoors": 0.6,
    "2 under cover": 0.8,
    "3 exposed": 2.0,
}
_DENSEST = 1.2 * 700.0  # kg/m³, a mean: EN 338 takes 1.2 of the characteristic density for it


@dataclass(frozen=True, slots=True, kw_only=True)
class TimberRules:
    """What EN 1995-1-1 leaves to the site and to the country."""

    service_class: ServiceClass = param(  # noqa: RUF009
        "1 heated indoors", help="How damp the timber becomes, EN 1995-1-1 2.3.1.3"
    )
    duration: Duration = param(  # noqa: RUF009
        "permanent", help="Load-duration class of combinations that do not say theirs"
    )
    partial_solid: float = param(1.30, "", 1.0, 3.0, "γM of solid timber, Table 2.3")
    partial_glued: float = param(1.25, "", 1.0, 3.0, "γM of glued laminated timber, Table 2.3")
    crack: float = param(0.67, "", 0.2, 1.0, "kcr: share of the width that carries shear, 6.1.7")
    redistribution: float = param(0.7, "", 0.5, 1.0, "km: biaxial bending of rectangles, 6.1.6")
    lateral: float = param(
        *(1.0, "", 0.0, 5.0),
        help="Effective over real length in lateral buckling, Table 6.1: 1 for a constant moment, "
        "0.9 for a uniform load, 0.8 for a load in the middle",
    )
    critical: Literal["softwood", "general"] = param(
        "softwood", help="Critical bending stress by equation 6.32 or 6.31; hardwood needs 6.31"
    )
    load_at: Literal["axis", "compression edge", "tension edge"] = param(
        "axis",
        help="Where the load acts: adds 2h at the compression edge, takes off 0.5h at the other",
    )


def modification(durations: NDArray[np.str_], rules: TimberRules) -> Vector:
    """The factor k_mod (K,) for the load-duration classes (K,), Table 3.1: solid and glued timber.

    Raises ParameterError for a class that Table 2.1 does not have.
    """
    table = zip(DURATIONS, _MODIFICATION[rules.service_class], strict=True)
    factors: dict[str, float] = dict(table)
    for name in durations:
        if str(name) not in factors:
            raise ParameterError(
                f"“{name}” is no load-duration class of EN 1995-1-1; take one of "
                f"{', '.join(DURATIONS)}."
            )
    return np.array([factors[str(name)] for name in durations], dtype=float)


def partial_factor(grade: Grade, rules: TimberRules) -> float:
    """The material's partial factor γ_M, Table 2.3."""
    return rules.partial_glued if grade.glued else rules.partial_solid


def size_factor(depth: Vector, grade: Grade) -> Vector:
    """The factor k_h by which shallow timber is stronger, equations 3.1 and 3.2.

    ``depth`` in m: the depth in bending, or the larger side in tension. Solid timber gains below
    150 mm, unless it is denser than 700 kg/m³; glued laminated timber below 600 mm.
    """
    if grade.glued:
        return np.clip((0.6 / depth) ** 0.1, 1.0, 1.1)
    if grade.density > _DENSEST:
        return np.ones_like(depth)
    return np.clip((0.15 / depth) ** 0.2, 1.0, 1.3)


def creep_factor(grade: Grade, rules: TimberRules) -> float:
    """The factor k_def of Table 3.2 for solid and glued laminated timber; 0 for steel."""
    return _CREEP[rules.service_class] if grade.kind == "timber" else 0.0


def check_grade(grade: Grade) -> None:
    """Raise ParameterError unless the grade has all that EN 1995-1-1 asks of it."""
    if grade.kind != "timber":
        raise ParameterError(
            f"“{grade.name}” is {grade.kind}, which EN 1995-1-1 does not check; take a grade of "
            "timber, C24 for one."
        )
    needed = {
        "bending strength": grade.bending,
        "tensile strength": grade.tension,
        "compressive strength": grade.compression,
        "shear strength": grade.shear_strength,
        "E_0,05": grade.youngs_low,
        "G_05": grade.shear_low,
    }
    missing = [name for name, value in needed.items() if not value > 0.0]
    if missing:
        raise ParameterError(
            f"The grade “{grade.name}” has no {', '.join(missing)}, so EN 1995-1-1 cannot check "
            "it; take C24, or the thesis's own check."
        )
