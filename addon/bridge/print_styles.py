"""Relief styles and skins as Blender's data: what the nodes of “Print Layers” read."""

import bpy
import numpy as np

from ...engines.core.errors import SceneError
from ...engines.core.parameters import canonical
from ...engines.core.scene import Vector
from ...engines.glass.profile import Profile, Style, Texture, profile_of
from ...engines.glass.skin import Skin, skin_from
from . import print_graph as layout
from .meshes import places_of

_DIGEST = "heliform_style"
_NUMBERS = ("height", "depth", "roughness")
_NO_LINE = "“{}” is not one open line; draw a curve, or edges, from one end to the other."


def style_object(style: Style, name: str = "", scale: float = 1.0) -> bpy.types.Object:
    """The hidden object that holds a style, made where the file has none that holds the same.

    It is in no scene: modifiers keep it. ``scale`` is the metres in a Blender unit.
    """
    key = style.digest if style.texture is None else f"{style.digest}-{scale:.7g}"
    for obj in bpy.data.objects:
        if obj.get(_DIGEST) == key and not obj.library:
            return obj
    name = name or f"Relief {style.name}"
    values = _values(style, scale)
    block = bpy.data.meshes.new(name)
    block.vertices.add(len(values))
    block.attributes.new(layout.VALUES, "FLOAT", "POINT").data.foreach_set(
        "value", values.astype(np.float32)
    )
    obj = bpy.data.objects.new(name, block)
    obj.hide_render = True
    obj[_DIGEST] = key
    obj["style"], obj["scale"] = style.name, scale
    for number in _NUMBERS:
        obj[number] = float(getattr(style, number))
    return obj


def style_of(obj: bpy.types.Object | None) -> Style:
    """The style that an object holds, at float32. Raises SceneError where it holds none."""
    stored = getattr(getattr(obj, "data", None), "attributes", {}).get(layout.VALUES)
    if obj is None or stored is None or _DIGEST not in obj:
        raise SceneError(
            f"“{obj.name if obj else 'None'}” holds no relief style; choose one in the modifier, "
            "or make one from a scan or a drawn curve."
        )
    held = np.empty(len(stored.data), dtype=np.float32)
    stored.data.foreach_get("value", held)
    values = held.astype(np.float64)
    head = values[: layout.HEADER]
    samples, outer, inner, wide, high, start = head[: layout.LONG].astype(int)
    texture = None
    if wide:
        heights = values[start:].reshape(high + 1, wide + 1)[:high, :wide]
        size = head[[layout.LONG, layout.TALL]] * obj["scale"]
        texture = Texture(heights, np.array([canonical(length) for length in size]))
    profiles = [Profile(values[at : at + samples]) for at in (outer, inner)]
    numbers = {number: obj[number] for number in _NUMBERS}
    return Style(obj["style"], profiles[0], profiles[1], texture, **numbers)


def style_from_curve(obj: bpy.types.Object, scale: float = 1.0) -> Style:
    """The style whose profile is a drawn line: a curve, or a mesh of edges that make one line.

    X says how far the surface stands out, Z (or Y, where the line is longer that way) runs along
    the layer, from end to end; sizes are the object's own times its scale.

    Raises SceneError where it is not one open line, ParameterError where it cannot be a profile.
    """
    if obj.type not in ("CURVE", "MESH"):
        raise SceneError(_NO_LINE.format(obj.name))
    graph = bpy.context.evaluated_depsgraph_get()
    evaluated = obj.evaluated_get(graph)
    block = evaluated.to_mesh()
    try:
        order = _line(obj.name, block)
        points = places_of(block)[order] * np.array(obj.matrix_world.to_scale()) * scale
    finally:
        evaluated.to_mesh_clear()
    along = 2 if np.ptp(points[:, 2]) >= np.ptp(points[:, 1]) else 1
    profile, height, depth = profile_of(points[:, [0, along]], f"“{obj.name}”")
    return Style(obj.name, profile, profile, None, height, depth, 0.0)


def skin_to_blender(skin: Skin, block: bpy.types.Mesh, scale: float = 1.0) -> None:
    """Let a mesh carry a wall's skin, for the modifier to use. Its vertices must be the wall's."""
    angle = 2 * np.pi * skin.turn
    circle = np.column_stack([np.cos(angle), np.sin(angle)]) * (skin.girth / (2 * np.pi * scale))
    _write(block, layout.NORMAL, np.column_stack([skin.normal, np.zeros(len(angle))]))
    _write(block, layout.SIDE, skin.side)
    _write(block, layout.TURN, np.column_stack([circle, np.zeros(len(angle))]))


def skin_from_blender(block: bpy.types.Mesh, scale: float = 1.0) -> Skin:
    """The skin of a mesh: the one that it carries, or its own as `skin_of`; the girth in m."""
    if layout.NORMAL not in block.attributes:
        return skin_from(places_of(block) * scale, _true_normals(block))
    x, y, _ = _read(block, layout.TURN, 3).T * scale
    turn = np.arctan2(y, x) / (2 * np.pi)
    return Skin(
        normal=_read(block, layout.NORMAL, 3)[:, :2],
        side=_read(block, layout.SIDE, 1)[:, 0],
        turn=turn - np.floor(turn),
        girth=float(2 * np.pi * np.hypot(x, y).mean()) if len(x) else 0.0,
    )


def _true_normals(block: bpy.types.Mesh) -> Vector:
    """The vertices' normals (V, 3) by the faces alone, whatever custom normals say."""
    free = block.attributes.get("custom_normal")
    bare = block.copy() if free is not None else block
    try:
        if free is not None:
            bare.attributes.remove(bare.attributes["custom_normal"])
        normals = np.empty((len(bare.vertices), 3), dtype=np.float32)
        bare.vertex_normals.foreach_get("vector", normals.ravel())
        return normals.astype(np.float64)
    finally:
        if bare != block:
            bpy.data.meshes.remove(bare)


def _values(style: Style, scale: float) -> Vector:
    """Header, outer and inner profile and texture, one after another; the periodic ones go on over
    their end, so that nothing wraps."""
    samples = len(style.profile.offsets)
    place = np.arange(samples + 2) / samples
    head = np.zeros(layout.HEADER)
    head[layout.SAMPLES] = samples
    head[layout.OUTER], head[layout.INNER] = len(head), len(head) + len(place)
    parts = [head, style.profile.at(place), style.inner.at(place)]
    if style.texture is not None:
        heights = style.texture.heights
        head[[layout.HIGH, layout.WIDE]] = heights.shape
        head[layout.TEXTURE] = len(head) + 2 * len(place)
        head[[layout.LONG, layout.TALL]] = style.texture.size / scale
        high, wide = (np.arange(n + 1) % n for n in heights.shape)
        parts.append(heights[np.ix_(high, wide)].ravel())
    return np.concatenate(parts)


def _line(name: str, block: bpy.types.Mesh) -> list[int]:
    """The vertices of a line from end to end."""
    edges = np.empty(2 * len(block.edges), dtype=np.int32)
    block.edges.foreach_get("vertices", edges)
    beside: dict[int, list[int]] = {}
    for a, b in edges.reshape(-1, 2).tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    ends = [vertex for vertex, others in beside.items() if len(others) == 1]
    order: list[int] = []
    ahead = min(ends, default=-1)
    while ahead >= 0:
        before = order[-1] if order else -1
        order.append(ahead)
        ahead = next((v for v in beside[ahead] if v != before), -1)
        if len(order) > len(beside):
            break
    if len(ends) != 2 or len(order) != len(beside):
        raise SceneError(_NO_LINE.format(name))
    return order


def _write(block: bpy.types.Mesh, name: str, values: Vector) -> None:
    kind, key = ("FLOAT", "value") if values.ndim == 1 else ("FLOAT_VECTOR", "vector")
    stored = block.attributes.get(name) or block.attributes.new(name, kind, "POINT")
    stored.data.foreach_set(key, values.astype(np.float32).ravel())


def _read(block: bpy.types.Mesh, name: str, wide: int) -> Vector:
    values = np.empty((len(block.vertices), wide), dtype=np.float32)
    block.attributes[name].data.foreach_get("value" if wide == 1 else "vector", values.ravel())
    return values.astype(np.float64)
