"""The node group “Print Layers”: the relief of `engines.glass.relief`, live, on any mesh.

It is the add-on's own asset, drawn by this module: built once into a file, found there by its
stamp, and built anew in place where an older version of the add-on left it.
"""

import contextlib
from collections.abc import Iterator
from typing import Any

import bpy

from ...engines.core.parameters import Field, fields_of
from ...engines.glass.relief import Relief, chosen_style
from .print_graph import INPUTS, MASK, STYLE, connect, word_of
from .print_styles import style_object

NAME = "Print Layers"
VERSION = 1
STAMP = "heliform_print_layers"
"""What the group carries: the version of this file that built it."""


def node_group() -> bpy.types.NodeTree:
    """The file's node group, made or brought up to date where needed."""
    found = [t for t in bpy.data.node_groups if STAMP in t and not t.library]
    tree = max(found, key=lambda t: t[STAMP], default=None)
    if tree is None:
        tree = bpy.data.node_groups.new(NAME, "GeometryNodeTree")
        _build(tree)
    elif tree[STAMP] < VERSION:
        held = [(modifier, _values(modifier)) for modifier in _modifiers(tree)]
        _build(tree)
        for modifier, values in held:
            _restore(modifier, values)
    return tree


def sockets_of(modifier: bpy.types.Modifier) -> dict[str, Any]:
    """What holds a modifier's inputs, by their names."""
    inputs = modifier.properties.inputs
    return {
        item.name: getattr(inputs, item.identifier)
        for item in modifier.node_group.interface.items_tree
        if item.item_type == "SOCKET"
        and item.in_out == "INPUT"
        and hasattr(inputs, item.identifier)
    }


def _modifiers(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Modifier]:
    for obj in bpy.data.objects:
        yield from (m for m in obj.modifiers if m.type == "NODES" and m.node_group == tree)


def _values(modifier: bpy.types.Modifier) -> dict[str, dict[str, Any]]:
    keys = ("type", "attribute_name", "value")
    sockets = sockets_of(modifier).items()
    return {name: {k: getattr(s, k) for k in keys if hasattr(s, k)} for name, s in sockets}


def _restore(modifier: bpy.types.Modifier, values: dict[str, dict[str, Any]]) -> None:
    """Give inputs back what they held; those that are new take their default."""
    items = [i for i in modifier.node_group.interface.items_tree if i.item_type == "SOCKET"]
    defaults = {i.name: {"value": i.default_value} for i in items if hasattr(i, "default_value")}
    for name, socket in sockets_of(modifier).items():
        for key, value in values.get(name, defaults.get(name, {})).items():
            with contextlib.suppress(TypeError):  # a word that the menu no longer has
                setattr(socket, key, value)


def _build(tree: bpy.types.NodeTree) -> None:
    tree.nodes.clear()
    tree.interface.clear()
    tree.is_modifier = True
    tree.description = "Relief of printed layers on a wall, from a style"
    _declare(tree)
    connect(tree)
    inputs = {i.name: i for i in tree.interface.items_tree if i.item_type == "SOCKET"}
    inputs[INPUTS["sides"]].default_value = word_of(Relief().sides)
    inputs[STYLE].default_value = style_object(chosen_style(Relief()))
    tree.asset_mark()
    tree[STAMP] = VERSION


# What the modifier asks for


def _declare(tree: bpy.types.NodeTree) -> None:
    face = tree.interface
    face.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    face.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    style = face.new_socket(STYLE, in_out="INPUT", socket_type="NodeSocketObject")
    style.description = "What holds the profile of a layer and the roughness"
    fields = {field.name: field for field in fields_of(Relief)}
    layers, rough, where = (face.new_panel(title) for title in ("Layers", "Roughness", "Where"))
    for name, field in fields.items():
        if name in INPUTS:
            special = {"roughness": rough, "seed": rough, "sides": where}
            _declare_field(face, field, special.get(name, layers))
    inputs = {"in_out": "INPUT", "socket_type": "NodeSocketFloat", "parent": where}
    mask = face.new_socket(MASK, **inputs)
    mask.description = "How much of the relief there is; a vertex group or attribute may say it"
    mask.subtype, mask.min_value, mask.max_value, mask.default_value = "FACTOR", 0.0, 1.0, 1.0


def _declare_field(face: Any, field: Field, panel: Any) -> None:
    kinds = {"float": "Float", "int": "Int", "bool": "Bool", "enum": "Menu"}
    socket = face.new_socket(
        INPUTS[field.name],
        in_out="INPUT",
        socket_type=f"NodeSocket{kinds[field.kind]}",
        parent=panel,
    )
    socket.description = field.help
    if field.kind == "enum":
        return  # its default is one of the words of the node that it is linked to
    socket.structure_type = "SINGLE"
    if field.unit == "m":
        # Bounds in m hold in a scene of metres only: only what is impossible is kept out.
        socket.subtype = "DISTANCE"
        socket.min_value = 1e-6 if field.name == "height" else 0.0 if field.low == 0 else -1e6
        socket.max_value = 1e6
    elif field.kind != "bool":
        socket.min_value, socket.max_value = field.low, field.high
        if field.kind == "float":
            socket.subtype = "FACTOR"
    socket.default_value = field.default
