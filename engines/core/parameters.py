"""Parameters, each written once.

A record is a frozen dataclass whose fields are made by `param` (or hold another record, by
`nested`). Its default, bounds, unit and help stand nowhere else: Blender's property groups, the
tables of a study file, the command line's checks and the explorer's design variables are read
off the record by `fields_of`.
"""

import dataclasses
import difflib
import functools
import hashlib
import json
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from .errors import ParameterError

Kind = Literal["float", "int", "bool", "text", "enum", "record"]


@dataclass(frozen=True, slots=True)
class Field:
    """What is known of one parameter. ``low``/``high`` are inclusive, None where unbounded."""

    name: str
    kind: Kind
    default: Any
    unit: str
    low: float | None
    high: float | None
    help: str
    choices: tuple[str, ...] = ()
    record: Any = None
    suggestions: tuple[str, ...] = ()

    @property
    def names_file(self) -> bool:
        """Whether it is the path of a file, which is looked for beside the study."""
        return self.kind == "text" and self.name.rpartition("_")[2] == "file"

    @property
    def label(self) -> str:
        """The name as a person reads it: ``layer_height`` → ``Layer Height``."""
        return self.name.replace("_", " ").title()


def param(
    default: Any,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    help: str = "",
    suggest: tuple[str, ...] = (),
) -> Any:
    """A dataclass field with unit (SI, or "deg"), inclusive bounds and one line of help.

    ``suggest`` are texts that a panel offers for one that may be another, too.
    """
    meta = {"unit": unit, "low": low, "high": high, "help": help, "suggest": suggest}
    return dataclasses.field(default=default, metadata=meta)


def nested(record: type, help: str = "") -> Any:
    """A dataclass field that holds another record with its defaults."""
    return dataclasses.field(default_factory=record, metadata={"help": help})


@functools.cache
def fields_of(record: type) -> tuple[Field, ...]:
    """The parameters of a record type, in their written order."""
    hints = typing.get_type_hints(record)
    return tuple(_field(f, hints[f.name]) for f in dataclasses.fields(record))


def _field(field: dataclasses.Field, hint: Any) -> Field:
    meta = field.metadata
    kind, choices, inner = _kind_of(hint)
    default = field.default_factory() if inner else field.default  # type: ignore[misc]
    return Field(
        name=field.name,
        kind=kind,
        default=default,
        unit=meta.get("unit", ""),
        low=meta.get("low"),
        high=meta.get("high"),
        help=meta.get("help", ""),
        choices=choices,
        record=inner,
        suggestions=meta.get("suggest", ()),
    )


def _kind_of(hint: Any) -> tuple[Kind, tuple[str, ...], type | None]:
    if typing.get_origin(hint) is Literal:
        return "enum", typing.get_args(hint), None
    if dataclasses.is_dataclass(hint):
        return "record", (), typing.cast(type, hint)
    kinds: dict[Any, Kind] = {bool: "bool", int: "int", float: "float", str: "text"}
    return kinds[hint], (), None


def canonical(value: float) -> float:
    """``value`` at the 7 digits that a float32 keeps: 0.00499999989 → 0.005."""
    return float(f"{value:.7g}")


def to_table(record: Any) -> dict[str, Any]:
    """A record as a plain nested table, floats canonical; `from_table` reads it back equal."""
    table = {}
    for field in fields_of(type(record)):
        value = getattr(record, field.name)
        if field.kind == "record":
            value = to_table(value)
        elif field.kind == "float":
            value = canonical(value)
        table[field.name] = value
    return table


def from_table[R](record: type[R], table: Mapping[str, Any], where: str) -> R:
    """The record that ``table`` describes; keys left out keep their defaults.

    ``where`` names the table in messages. Raises ParameterError for an unknown key, a value of
    the wrong type, or one out of bounds.
    """
    if not isinstance(table, Mapping):
        raise ParameterError(f"[{where}] should be a table of parameters, not {table!r}.")
    fields = {f.name: f for f in fields_of(record)}
    check_keys(table, fields, where)
    return record(**{k: check_value(fields[k], v, where) for k, v in table.items()})


def check_keys(table: Mapping[str, Any], known: typing.Iterable[str], where: str) -> None:
    """Raise ParameterError for the first key of ``table`` that is not ``known``."""
    known = list(known)
    for key in table:
        if key not in known:
            near = difflib.get_close_matches(key, known, 1)
            hint = f"did you mean “{near[0]}”?" if near else f"known are: {', '.join(known)}."
            raise ParameterError(f"[{where}] has no key “{key}”; {hint}")


def check_value(field: Field, value: Any, where: str) -> Any:
    """``value`` as the field's type, or ParameterError with the allowed range."""
    said = f"[{where}] {field.name} = {value!r}"
    if field.kind == "record":
        if not isinstance(value, Mapping):
            raise ParameterError(f"{said} should be a table of parameters.")
        return from_table(field.record, value, f"{where}.{field.name}")
    if field.kind == "enum":
        if value not in field.choices:
            raise ParameterError(f"{said} is not a choice; take one of {', '.join(field.choices)}.")
        return value
    accepted = {"float": (int, float), "int": int, "bool": bool, "text": str}[field.kind]
    is_flag = isinstance(value, bool)
    if not isinstance(value, accepted) or (is_flag and field.kind != "bool"):
        kind = {"float": "a number", "int": "a whole number", "bool": "true or false"}
        raise ParameterError(f"{said} should be {kind.get(field.kind, 'text')}.")
    if field.kind == "float":
        value = canonical(value)
    low = field.low if field.low is not None else value
    high = field.high if field.high is not None else value
    if field.kind in ("float", "int") and not low <= value <= high:
        raise ParameterError(f"{said} is out of bounds; allowed is {bounds_text(field)}.")
    return value


def bounds_text(field: Field) -> str:
    """The allowed range as a person reads it, with its unit."""
    unit = f" {field.unit}" if field.unit else ""
    if field.low is None:
        return f"at most {field.high:g}{unit}"
    if field.high is None:
        return f"at least {field.low:g}{unit}"
    return f"{field.low:g} to {field.high:g}{unit}"


def digest(record: Any) -> str:
    """Sixteen hex digits that name this record's values, the same on every machine."""
    text = json.dumps([type(record).__name__, to_table(record)], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """``base`` with the values of ``over`` laid on top, table by table."""
    result = dict(base)
    for key, value in over.items():
        below = result.get(key)
        if isinstance(below, Mapping) and isinstance(value, Mapping):
            value = merged(below, value)
        result[key] = value
    return result
