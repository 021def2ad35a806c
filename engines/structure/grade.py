"""What a member is made of: stiffness, density, strengths, and what it costs the climate."""

import functools
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ..core.errors import ParameterError

DATA = Path(__file__).parent / "data"

_STRESS, _ENERGY = 1e6, 1e6  # Pa in N/mm², J in MJ
_NEEDED = {"youngs": _STRESS, "shear": _STRESS, "density": 1.0, "energy": _ENERGY, "carbon": 1.0}
_YIELD = {"yield_strength": _STRESS}
_TIMBER = dict.fromkeys(
    ("bending", "tension", "compression", "shear_strength", "youngs_low", "shear_low"), _STRESS
)
_NUMBERS = {**_NEEDED, **_YIELD, **_TIMBER}
_TEXTS = ("source", "climate")
_BOUNDS = {
    "youngs": (500.0, 1e6, "N/mm²"),
    "shear": (20.0, 1e6, "N/mm²"),
    "density": (50.0, 3e4, "kg/m³"),
    "energy": (0.0, 1e4, "MJ/kg"),
    "carbon": (0.0, 1e3, "kg of CO₂ equivalent per kg"),
    "yield_strength": (1.0, 1e4, "N/mm²"),
    **dict.fromkeys(("bending", "tension", "compression"), (1.0, 1e3, "N/mm²")),
    "shear_strength": (0.1, 1e3, "N/mm²"),
    "youngs_low": (500.0, 1e6, "N/mm²"),
    "shear_low": (20.0, 1e6, "N/mm²"),
}
"""What each number lies between, so that one in another unit is found out."""


@dataclass(frozen=True, slots=True)
class Grade:
    """A grade of steel or a strength class of timber.

    ``youngs`` E and ``shear`` G in Pa (means); ``density`` in kg/m³; ``energy`` embodied energy in
    J/kg; ``carbon`` in kg of CO₂ equivalent per kg; ``source``: where the figures are from, and
    ``climate``: where those of energy and carbon are.

    Steel: ``yield_strength`` f_y in Pa. Timber, characteristic strengths in Pa: ``bending`` f_m,k,
    ``tension`` f_t,0,k, ``compression`` f_c,0,k, ``shear_strength`` f_v,k; ``youngs_low`` E_0,05
    and ``shear_low`` G_05 in Pa; ``glued`` for glued laminated timber. Zero where it says nothing:
    the thesis's timber has a yield strength as Karamba3D gives it, and no others.
    """

    name: str
    kind: Literal["steel", "timber"]
    youngs: float
    shear: float
    density: float
    energy: float
    carbon: float
    source: str
    yield_strength: float = 0.0
    bending: float = 0.0
    tension: float = 0.0
    compression: float = 0.0
    shear_strength: float = 0.0
    youngs_low: float = 0.0
    shear_low: float = 0.0
    glued: bool = False
    climate: str = ""


@functools.cache
def grades() -> Mapping[str, Grade]:
    """The shipped grades by name."""
    tables = tomllib.loads((DATA / "grades.toml").read_text(encoding="utf-8"))["grade"]
    return {name: grade_of(name, table) for name, table in tables.items()}


def grade_of(name: str, table: Any) -> Grade:
    """The grade in a table of a catalogue, stresses in N/mm² and energy in MJ/kg.

    Raises ParameterError that begins with the grade's name, for a key that is unknown, missing, or
    not what it should be.
    """
    said = f"grade “{name}”"
    if not isinstance(table, Mapping):
        raise ParameterError(f"{said} should be a table, [grade.{name}].")
    kind = table.get("kind")
    if kind not in ("steel", "timber"):
        raise ParameterError(f'{said} needs kind = "steel" or kind = "timber".')
    glued = table.get("glued", False)
    if not isinstance(glued, bool):
        raise ParameterError(f"{said}: glued should be true or false.")
    strengths = _YIELD if kind == "steel" else _TIMBER
    if kind == "timber" and "yield_strength" in table:
        strengths = _YIELD
    known = [*_NEEDED, *_YIELD, *_TIMBER, *_TEXTS, "kind", "glued"]
    allowed = {*_NEEDED, *strengths, *_TEXTS, "kind", *(("glued",) if kind == "timber" else ())}
    for key in table:
        if key not in known:
            raise ParameterError(
                f"{said} has an unknown key “{key}”; known are {', '.join(known)}."
            )
        if key not in allowed:
            raise ParameterError(f"{said} is {kind} and cannot have “{key}”; take that line out.")
    numbers = {key: _number(said, key, table) * _NUMBERS[key] for key in (*_NEEDED, *strengths)}
    texts = {key: table.get(key, "") for key in _TEXTS}
    for key, text in texts.items():
        if not isinstance(text, str):
            raise ParameterError(f"{said}: {key} should be text in quotes.")
    return Grade(name=name, kind=kind, glued=glued, **numbers, **texts)


def table_of(grade: Grade) -> dict[str, Any]:
    """The grade as a table of a catalogue; `grade_of` reads it back equal."""
    numbers = {key: float(f"{getattr(grade, key) / by:.12g}") for key, by in _NUMBERS.items()}
    stated = {k: v for k, v in numbers.items() if k in _NEEDED or v}
    texts = {key: getattr(grade, key) for key in _TEXTS}
    glued = {"glued": True} if grade.glued else {}
    return {"kind": grade.kind, **glued, **stated, **texts}


def _number(said: str, key: str, table: Mapping[str, Any]) -> float:
    if key not in table:
        raise ParameterError(f"{said} has no “{key}”; add it.")
    value = table[key]
    good = isinstance(value, int | float) and not isinstance(value, bool)
    low, high, unit = _BOUNDS[key]
    if not good or not low <= value <= high:
        raise ParameterError(
            f"{said}: {key} = {value!r} should be a number of {unit}, from {low:g} to {high:g}."
        )
    return float(value)
