"""Blender's properties, derived from the engines' parameter records.

Lengths are kept in Blender units, as every length in Blender is; `read` and `write` take the
scene's ``scale``, the metres in one of them (see `scale_of`). Angles are radians in Blender and
degrees in a record.
"""

import functools
import math
import re
import zlib
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..engines.core.parameters import Field, bounds_text, canonical, fields_of

Update = Callable[[Any, bpy.types.Context], None]

_ACRONYMS = {"ies": "IES", "ior": "IOR", "led": "LED", "utc_offset": "UTC Offset"}
_quiet = 0


def scale_of(scene: bpy.types.Scene) -> float:
    """Metres in one Blender unit of ``scene``."""
    return canonical(scene.unit_settings.scale_length)


# From a record to properties


def group_for(record: type, update: Update | None = None) -> type[bpy.types.PropertyGroup]:
    """The PropertyGroup that holds a record; ``update`` is called when a person changes it.

    Made once for each record and update, when a module is imported: `register` registers it.
    """
    return _group_for(record, update)


@functools.cache
def _group_for(record: type, update: Update | None) -> type[bpy.types.PropertyGroup]:
    annotations = annotations_for(record, update)
    name = f"HELIFORM_PG_{record.__name__}{'_live' if update else ''}"
    group = type(
        name,
        (bpy.types.PropertyGroup,),
        {"__doc__": record.__doc__, "__annotations__": annotations},
    )
    groups.append(group)
    return group


groups: list[type[bpy.types.PropertyGroup]] = []
"""Every group made, in the order in which they can be registered."""


def annotations_for(record: type, update: Update | None = None) -> dict[str, Any]:
    """A property for each field of a record, to be the annotations of a group or an operator."""
    return {field.name: _property(field, update) for field in fields_of(record)}


def with_properties[C: type](record: type) -> Callable[[C], C]:
    """A class decorator: an operator gets a property for each field of a record."""

    def given(cls: C) -> C:
        cls.__annotations__ = {**cls.__annotations__, **annotations_for(record)}
        return cls

    return given


def _property(field: Field, update: Update | None) -> Any:
    if field.kind == "record":
        return PointerProperty(
            type=group_for(field.record, update), name=label_of(field), description=field.help
        )
    options: dict[str, Any] = {
        "name": label_of(field),
        "description": _description(field),
        "default": field.default,
    }
    if update:
        options["update"] = _unless_quiet(update)
    match field.kind:
        case "bool":
            return BoolProperty(**options)
        case "enum":
            return EnumProperty(items=enum_items(field.choices, field.help), **options)
        case "text" if field.names_file:
            return StringProperty(
                subtype="FILE_PATH", options={"PATH_SUPPORTS_BLEND_RELATIVE"}, **options
            )
        case "text":
            if field.suggestions:
                options["search"] = _offer(field.suggestions)
            return StringProperty(**options)
        case "int":
            return IntProperty(**options, **_bounds(field, "min", "max"))
    return FloatProperty(**options | _number(field))


def _offer(suggestions: tuple[str, ...]) -> Callable[[Any, Any, str], list[str]]:
    """What Blender asks for suggestions while a text is typed."""
    return lambda group, context, text: [s for s in suggestions if text.lower() in s.lower()]


def label_of(field: Field) -> str:
    """A field's name as a person reads it."""
    return _ACRONYMS.get(field.name, field.label)


def _number(field: Field) -> dict[str, Any]:
    """How a float is shown and held: lengths, angles and times as Blender's own."""
    match field.unit:
        case "m":  # bounds are metres and hold in a scene of metres only: soft, the engine checks
            step = 0.1 if field.default >= 0.05 else 0.01
            display = {"subtype": "DISTANCE", "unit": "LENGTH", "step": step, "precision": 5}
            return display | _bounds(field, "soft_min", "soft_max")
        case "deg":
            bounds = _bounds(field, "min", "max")
            radians = {key: math.radians(value) for key, value in bounds.items()}
            default = math.radians(field.default)
            angle = {"subtype": "ANGLE", "unit": "ROTATION", "precision": 4}
            return angle | {"default": default, **radians}
        case "s":
            timed = {"subtype": "TIME_ABSOLUTE", "unit": "TIME_ABSOLUTE"}
            return timed | _bounds(field, "min", "max")
    name = f"{label_of(field)} ({field.unit})" if field.unit else label_of(field)
    span = (field.high or 100.0) - (field.low or 0.0)
    fine = {"step": 1, "precision": 4} if span <= 10 else {"step": 100, "precision": 2}
    return {"name": name, **fine, **_bounds(field, "min", "max")}


def _bounds(field: Field, low: str, high: str) -> dict[str, Any]:
    ends = {low: field.low, high: field.high}
    return {key: value for key, value in ends.items() if value is not None}


def _description(field: Field) -> str:
    """The help, the default and the bounds; Blender adds the full stop."""
    if field.kind not in ("float", "int"):
        return field.help
    unit = f" {field.unit}" if field.unit else ""
    bounded = field.low is not None or field.high is not None
    allowed = f"; {bounds_text(field)}" if bounded else ""
    return f"{field.help}.\nDefault {field.default:g}{unit}{allowed}"


def enum_items(choices: Collection[str], help: str = "") -> list[tuple[str, str, str, int]]:
    """Items whose numbers come from the words: saved files outlive a new or moved choice."""
    return [(c, _label(c), help, enum_number(c)) for c in choices]


def enum_number(choice: str) -> int:
    """The number by which a saved file knows a choice."""
    return zlib.crc32(choice.encode()) & 0x7FFFFFFF


def _label(choice: str) -> str:
    return _ACRONYMS.get(choice) or choice.replace("_", " ").replace("-", " ").capitalize()


# Between properties and records


def group_name(record: type) -> str:
    """Where a scene keeps its record of this type: PhotonTracing in ``photon_tracing``."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", record.__name__).lower()


def parameters[R](scene: bpy.types.Scene, record: type[R]) -> R:
    """The record of this type that ``scene`` holds."""
    return read(getattr(scene.heliform, group_name(record)), record, scale_of(scene))


def read[R](group: Any, record: type[R], scale: float = 1.0) -> R:
    """The record that a group or operator holds, its floats at the 7 digits that Blender keeps.

    A length that nobody has set is the record's own, whatever a Blender unit is.
    """
    return record(
        **{
            f.name: f.default
            if _is_unset_length(group, f)
            else _read(f, getattr(group, f.name), scale)
            for f in fields_of(record)
        }
    )


def _is_unset_length(group: Any, field: Field) -> bool:
    if field.kind != "float" or field.unit != "m":
        return False
    held = group.properties if isinstance(group, bpy.types.Operator) else group
    return not held.is_property_set(field.name)


def settle(group: Any, record: type, scale: float) -> None:
    """Set the lengths of a group that nobody has set to what they are in Blender units."""
    with _hushed():
        for field in fields_of(record):
            if field.kind == "record":
                settle(getattr(group, field.name), field.record, scale)
            elif _is_unset_length(group, field):
                _write(group, field, field.default, scale)


def _read(field: Field, value: Any, scale: float) -> Any:
    match field.kind, field.unit:
        case "record", _:
            return read(value, field.record, scale)
        case "float", "m":
            return canonical(canonical(value) * scale)
        case "float", "deg":
            return canonical(math.degrees(value))
        case "float", _:
            return canonical(value)
    return value


def write(group: Any, record: Any, scale: float = 1.0) -> None:
    """Set a group or operator to a record's values; updates are not called."""
    with _hushed():
        for field in fields_of(type(record)):
            _write(group, field, getattr(record, field.name), scale)


def write_unset(operator: Any, record: Any, scale: float = 1.0) -> None:
    """Set those properties of an operator that nobody has set yet."""
    for field in fields_of(type(record)):
        if not operator.properties.is_property_set(field.name):
            _write(operator, field, getattr(record, field.name), scale)


def _write(group: Any, field: Field, value: Any, scale: float) -> None:
    if field.kind == "record":
        write(getattr(group, field.name), value, scale)
        return
    if field.kind == "float" and field.unit == "m":
        value /= scale
    elif field.kind == "float" and field.unit == "deg":
        value = math.radians(value)
    setattr(group, field.name, value)


def _unless_quiet(update: Update) -> Update:
    def called(group: Any, context: bpy.types.Context) -> None:
        if not _quiet:
            update(group, context)

    return called


@contextmanager
def _hushed() -> Iterator[None]:
    global _quiet
    _quiet += 1
    try:
        yield
    finally:
        _quiet -= 1


def draw(
    layout: bpy.types.UILayout, group: Any, record: type, without: Collection[str] = ()
) -> None:
    """Draw the fields of a record; those of a nested one in a box below."""
    column = layout.column()
    for field in fields_of(record):
        if field.name in without:
            continue
        if field.kind != "record":
            column.prop(group, field.name)
            continue
        box = layout.box()
        box.label(text=label_of(field))
        draw(box, getattr(group, field.name), field.record)
        column = layout.column()
