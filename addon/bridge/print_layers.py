"""The modifier “Print Layers”: put on an object, read, written, and given to others.

Lengths in the modifier are Blender units of the object's own axes: an object that is scaled has its
relief scaled with it. ``scale`` is the metres in a Blender unit.
"""

from collections.abc import Iterable
from typing import Any

import bpy

from ...engines.core.errors import SceneError
from ...engines.core.parameters import Field, canonical, fields_of
from ...engines.glass.loft import Wall
from ...engines.glass.profile import STYLES, Style
from ...engines.glass.relief import Relief
from .print_graph import INPUTS, MASK, STYLE, word_of
from .print_nodes import NAME, STAMP, node_group, sockets_of
from .print_styles import (
    skin_from_blender,
    skin_to_blender,
    style_from_curve,
    style_object,
    style_of,
)

__all__ = [
    "add_modifier",
    "copy_to",
    "is_print_layers",
    "node_group",
    "read_modifier",
    "relief_of_wall",
    "set_settings",
    "settings_of",
    "skin_from_blender",
    "skin_to_blender",
    "style_from_curve",
    "style_object",
    "style_of",
    "write_modifier",
]


Settings = dict[str, dict[str, Any]]
"""What each input of a modifier is set to, by the input's name."""

_KEYS = ("type", "attribute_name", "value")


def relief_of_wall(wall: Wall) -> Relief:
    """The relief of a wall that has no other: its beads, in level layers as its rows are."""
    return Relief(height=wall.bead.height, amplitude=wall.bead.depth, spiral=False)


def is_print_layers(modifier: bpy.types.Modifier) -> bool:
    """Whether a modifier puts the relief of printed layers on its object."""
    group = modifier.node_group if modifier.type == "NODES" else None
    return group is not None and STAMP in group


def add_modifier(
    obj: bpy.types.Object, relief: Relief, style: Style, scale: float = 1.0, mask: str = ""
) -> bpy.types.Modifier:
    """Put the relief on an object, after its other modifiers.

    ``mask`` names a vertex group or attribute that says how much of it there is. Raises SceneError
    where the object is no mesh.
    """
    if obj.type != "MESH":
        raise SceneError(f"“{obj.name}” is no mesh; convert it to one to print layers on it.")
    modifier = obj.modifiers.new(NAME, "NODES")
    modifier.node_group = node_group()
    write_modifier(modifier, relief, style, scale, mask)
    return modifier


def write_modifier(
    modifier: bpy.types.Modifier,
    relief: Relief,
    style: Style,
    scale: float = 1.0,
    mask: str | None = None,
) -> None:
    """Set what a modifier does; ``mask`` as in `add_modifier`, None leaves it as it is."""
    sockets = sockets_of(modifier)
    for field in _fields():
        value = getattr(relief, field.name)
        if field.unit == "m":
            value /= scale
        elif field.kind == "enum":
            value = word_of(value)
        sockets[INPUTS[field.name]].value = value
    sockets[STYLE].value = style_object(style, scale=scale)
    if mask is not None:
        sockets[MASK].type = "ATTRIBUTE" if mask else "VALUE"
        sockets[MASK].attribute_name = mask
    _refresh(modifier)


def read_modifier(modifier: bpy.types.Modifier, scale: float = 1.0) -> tuple[Relief, Style]:
    """What a modifier does. Raises SceneError where its style is none.

    Of a style that is not built in, the record says “scan” and no file: the style itself is here.
    """
    sockets = sockets_of(modifier)
    style = style_of(sockets[STYLE].value)
    values = {f.name: _read(f, sockets[INPUTS[f.name]].value, scale) for f in _fields()}
    known = style.name.lower()
    values["style"] = known if known in STYLES else "scan"
    return Relief(**values), style


def copy_to(
    modifier: bpy.types.Modifier, objects: Iterable[bpy.types.Object]
) -> list[bpy.types.Modifier]:
    """Give other mesh objects the same modifier; those that have one already take its settings.

    They share the style; each keeps its settings for itself from then on.
    """
    held = settings_of(modifier)
    made = []
    for obj in objects:
        if obj.type != "MESH" or obj == modifier.id_data:
            continue
        mine = next((m for m in obj.modifiers if is_print_layers(m)), None)
        if mine is None:
            mine = obj.modifiers.new(modifier.name, "NODES")
            mine.node_group = modifier.node_group
        set_settings(mine, held)
        made.append(mine)
    return made


def settings_of(modifier: bpy.types.Modifier) -> Settings:
    """All that a modifier is set to, as `set_settings` takes it."""
    return {
        name: {key: getattr(socket, key) for key in _KEYS if hasattr(socket, key)}
        for name, socket in sockets_of(modifier).items()
    }


def set_settings(modifier: bpy.types.Modifier, settings: Settings) -> None:
    """Set a modifier to what it, or another one, was set to."""
    sockets = sockets_of(modifier)
    for name, held in settings.items():
        for key, value in held.items():
            setattr(sockets[name], key, value)
    _refresh(modifier)


def _refresh(modifier: bpy.types.Modifier) -> None:
    """Have Blender look anew at which objects a modifier needs: setting an input does not."""
    modifier.node_group = modifier.node_group
    modifier.id_data.update_tag()


def _fields() -> list[Field]:
    return [field for field in fields_of(Relief) if field.name in INPUTS]


def _read(field: Field, value: Any, scale: float) -> Any:
    if field.kind == "enum":
        return str(value).lower()
    if field.kind != "float":
        return value
    value = canonical(value)
    return canonical(value * scale) if field.unit == "m" else value
